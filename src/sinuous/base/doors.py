"""Doors of nouns to rooms above them: `robot.to_urdf()` calls an exporter that the robot does not import.

Imports between rooms go one way, downwards, also those for types. A method that is a door names the module that does
its work, which is imported when the method is called; its types come from the front door, `sinuous`.
"""

from importlib import import_module
from typing import Any


def door(module: str) -> Any:
    """Return a module of the package by its name without `sinuous.`, imported now."""
    return import_module(f"sinuous.{module}")
