"""Routes of a ball through free space."""
