"""Distances and occupancy on grids."""
