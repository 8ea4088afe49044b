"""`python -m benchmarks segments`: how time grows with the number of segments."""
