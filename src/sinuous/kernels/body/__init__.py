"""The whole body against obstacles."""
