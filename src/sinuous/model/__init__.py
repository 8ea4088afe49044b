"""The robot: segments, limits, actuators."""
