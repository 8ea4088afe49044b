"""The question: targets, tolerances, preferences."""
