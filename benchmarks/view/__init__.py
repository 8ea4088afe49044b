"""How quickly pages follow, and how large they are."""
