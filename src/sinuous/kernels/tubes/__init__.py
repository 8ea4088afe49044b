"""Tubes: places where the obstacles lie all around, and the line through their middle.

Lengths in the length unit of the robot, angles in rad.
"""
