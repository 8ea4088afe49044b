"""Independent judges: kinematics, distances and collisions by code that shares nothing with the kernels."""
