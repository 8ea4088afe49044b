"""Forward and backward reaching: FABRIKc and FABRIKx."""
