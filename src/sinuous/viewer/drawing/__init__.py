"""What stands on a page: robots, obstacles and targets as meshes."""
