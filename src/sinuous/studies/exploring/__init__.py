"""Exploring: a memory is filled ahead with shapes, and with proved motions between them."""
