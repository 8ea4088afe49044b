"""Many targets at once: files, workers, deaths, and maps of the workspace."""
