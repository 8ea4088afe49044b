"""Pictures of what robots reach, and of what they can do of a set of tasks."""
