"""Random search from a shrinking range."""
