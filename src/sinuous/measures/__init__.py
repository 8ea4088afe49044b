"""Distances to obstacles by slow and plain NumPy and SciPy, to check what the kernels say. No kernel is used."""
