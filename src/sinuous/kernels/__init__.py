"""Compiled arithmetic: arrays and tuples in, arrays and tuples out; no classes, no files, no printing."""
