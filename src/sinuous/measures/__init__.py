"""Independent measurements, slow and plain: distances, places of the body, bounds on its reach. No kernel is used."""
