"""What a robot can reach: a grid of voxels, directions in each, and the reason of every hole."""
