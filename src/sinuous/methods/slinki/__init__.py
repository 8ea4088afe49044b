"""SLInKi: A* over motion primitives, then FABRIKc."""
