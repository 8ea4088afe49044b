"""Robots, scenes and solutions as pictures."""
