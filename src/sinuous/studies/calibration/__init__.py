"""Robots as they stand on the table: parameters fitted to measurements, and what is left of errors."""
