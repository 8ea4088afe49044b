"""One tick of a control loop: the damped step within limits, rates, contacts and self-contacts, proved clear."""
