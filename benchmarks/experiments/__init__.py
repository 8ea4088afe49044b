"""Experiments that put all methods on the same problems, in turns; what was measured survives an interrupt."""
