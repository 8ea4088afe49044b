"""How questions and answers are written down: problem files in YAML or JSON, paths in CSV, results as JSON lines.

Robots for other programs, too: URDF, MJCF and ROS. The names below are imported when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sinuous.files.joint_chain import JointChain as JointChain
    from sinuous.files.mjcf import DrivenChain as DrivenChain
else:
    _HOMES = {"JointChain": "joint_chain", "DrivenChain": "mjcf"}

    def __getattr__(name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module 'sinuous.files' has no attribute {name!r}")
        return getattr(import_module(f"sinuous.files.{_HOMES[name]}"), name)
