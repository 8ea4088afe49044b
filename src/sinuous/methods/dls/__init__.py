"""Damped least squares."""
