"""What the commands answer, and where that goes."""
