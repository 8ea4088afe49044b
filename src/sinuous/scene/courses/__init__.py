"""Obstacles that move: where they are at which time."""
