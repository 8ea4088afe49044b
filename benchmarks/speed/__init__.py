"""`python -m benchmarks speed`: every file but `experiment` measures one thing, and yields its lines."""
