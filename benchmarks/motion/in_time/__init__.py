"""Motions and control loops among obstacles that move."""
