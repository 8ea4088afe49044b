"""What other programs read: a chain of joints instead of arcs (URDF), and trajectories of its joints (ROS)."""
