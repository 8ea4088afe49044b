"""Ways through space and time, past obstacles that move."""
