"""Plans motions of a continuum robot and streams them to its motors."""
