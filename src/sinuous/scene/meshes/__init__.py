"""Triangle meshes: reading, mending, bodies."""
