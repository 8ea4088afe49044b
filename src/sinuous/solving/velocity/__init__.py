"""Control loops: one step at a time, and the best that is reached within given changes."""
