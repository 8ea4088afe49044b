"""Planners: what they are asked, RRT-Connect, retraction, and paths in time."""
