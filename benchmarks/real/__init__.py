"""`python -m benchmarks real`: robots as they stand on the table, against what was measured."""
