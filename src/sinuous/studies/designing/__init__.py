"""Robots for sets of tasks: which number of segments, lengths, limits and base they need."""
