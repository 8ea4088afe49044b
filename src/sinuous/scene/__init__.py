"""What stands around the robot."""
