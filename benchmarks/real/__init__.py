"""Robots as they are: calibrated from measurements, and under load; beside what others published."""
