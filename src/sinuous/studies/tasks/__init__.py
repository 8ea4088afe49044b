"""What robots can do of a set of tasks, and sweeps over what a robot is."""
