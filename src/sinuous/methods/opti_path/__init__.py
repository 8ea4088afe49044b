"""The method of Sun & Wang: a path of arcs, moved until it fits."""
