"""Signed distances to obstacles."""
