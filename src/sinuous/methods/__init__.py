"""Algorithms for inverse kinematics, one folder each, all called the same way."""
