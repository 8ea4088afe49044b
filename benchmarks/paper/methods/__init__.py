"""`python -m benchmarks methods`: all methods on common random problems."""
