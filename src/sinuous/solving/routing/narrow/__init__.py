"""Tubes that routes lead through: found by their mouths, and passed by chains that are laid in them."""
