"""Equilibrium of a body of arcs under loads: bending, torsion, stretch, weights, forces, moments and tendons."""
