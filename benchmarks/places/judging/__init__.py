"""Kinds of places that judge the strategy: no constant is tuned on them, and no mechanism is written for them.

Whoever looks into one of them to mend a failure moves its family to the others and writes a new one here.
"""
