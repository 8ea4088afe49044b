"""Chains grown segment by segment through free space, along a route that the body may not be able to follow.

The door is `grow.grow_chains`.
"""
