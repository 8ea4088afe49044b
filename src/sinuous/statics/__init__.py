"""Shapes of robots under load."""
