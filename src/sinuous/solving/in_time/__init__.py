"""Motions among obstacles that move."""
