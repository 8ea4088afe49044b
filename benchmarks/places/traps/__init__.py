"""Places that are narrow where a search begins or ends: pipes, bores, cells, doors."""
