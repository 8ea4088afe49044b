"""How answers change with what they depend on: targets, the robot, where it stands, obstacles."""
