"""Doors of nouns to rooms that import them: `robot.to_urdf()` calls an exporter that the robot does not import.

A room imports only from rooms that docs/design.md lists before it, also for types. A method that is a door names the
module that does its work, which is imported when the method is called; its types come from the front door, `sinuous`.
"""

from importlib import import_module
from typing import Any


def door(module: str) -> Any:
    """Return a module of the package by its name without `sinuous.`, imported now."""
    return import_module(f"sinuous.{module}")
