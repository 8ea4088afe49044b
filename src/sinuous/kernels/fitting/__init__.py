"""The chain laid along a curve."""
