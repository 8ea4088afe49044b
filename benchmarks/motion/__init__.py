"""Motions: planned, tracked, along a leader; each judged at 50 configurations a step."""
