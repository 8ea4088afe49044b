"""Kinematics: one arc, and the chain of all segments."""
