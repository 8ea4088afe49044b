"""From waypoint to waypoint: what `track` does."""
