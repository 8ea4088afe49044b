"""Experiments that measure this library against its goals and against others, every answer checked by other code."""
