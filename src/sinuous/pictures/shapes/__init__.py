"""Surfaces of robots and obstacles as facets, where they are seen from, and how they are painted."""
