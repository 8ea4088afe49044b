"""`python -m benchmarks table1`: the paper's four poses, every method a hundred times."""
