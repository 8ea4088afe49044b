"""Derivatives of answers: what they cost, and whether they agree with differences."""
