"""What places are made of: robots, hidden shapes, and closed surfaces."""
