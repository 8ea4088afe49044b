"""The Newton step of the whole robot: sweeps, rows and limits."""
