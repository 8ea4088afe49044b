"""Where starts come from, and in what order."""
