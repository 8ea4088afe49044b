"""Robots for sets of tasks: how good, against random ones and the template, and how long it takes."""
