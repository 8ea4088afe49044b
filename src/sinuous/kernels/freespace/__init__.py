"""Routes of a ball through free space: weighted A* on a grid of cells, and elastic bands.

Nothing here knows of robots: the door is `find.find_routes`, which takes a scene and a query.
"""
