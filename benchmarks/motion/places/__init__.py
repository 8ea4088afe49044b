"""Plans into narrow places: those of `clutter`, and those around a hidden motion."""
