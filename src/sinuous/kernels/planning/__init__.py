"""Paths of configurations from a start to a goal, every edge proved clear."""
