"""Trees and samples of large obstacles."""
