"""What a plan needs of the kernels."""
