"""A network that has learned from solutions: from a target to a shape, in a few microseconds."""
