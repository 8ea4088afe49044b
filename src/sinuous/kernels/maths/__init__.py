"""Small vectors and matrices."""
