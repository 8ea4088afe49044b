"""What the kernels read of large obstacles: trees, and samples kept on disk."""
