"""How questions and answers are written down: problem files in YAML or JSON, paths in CSV, results as JSON lines.

Robots for other programs, too: URDF, MJCF and ROS.
"""

from sinuous.base.entrance import entrance

__getattr__, __dir__, __all__ = entrance(
    __name__, {"sinuous.files.joint_chain": "JointChain", "sinuous.files.mjcf": "DrivenChain"}
)
