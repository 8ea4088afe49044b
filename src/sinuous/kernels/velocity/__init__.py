"""One control step: the damped step within limits, rates, contacts and self-contacts, proved clear."""
