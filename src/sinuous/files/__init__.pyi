"""The names of `__init__.py` for type checkers."""

from sinuous.files.joint_chain import JointChain as JointChain
from sinuous.files.mjcf import DrivenChain as DrivenChain

__all__: list[str]
