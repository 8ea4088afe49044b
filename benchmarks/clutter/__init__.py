"""`python -m benchmarks clutter`: intricate places, each of which is known to be possible."""
