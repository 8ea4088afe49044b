"""Elbows in tubes: a target that the end of a segment has to be at, and a tube that it lies in."""
