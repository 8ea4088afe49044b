"""Forward and backward reaching among obstacles."""
