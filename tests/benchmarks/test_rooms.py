"""Lines by room: code is counted without comments, docstrings and blanks."""

from benchmarks.rooms import code_lines, sizes

SOURCE = '''"""A module.

Two lines more.
"""

# a comment
LENGTH = 1.0  # mm
"""Length of a segment, mm."""


def double(x: float) -> float:
    """Return twice a number."""
    return (
        2.0
        * x
    )
'''

PACKAGE = {
    "src/sinuous/__init__.py": "from sinuous.model.arm import Arm\n",
    "src/sinuous/model/__init__.py": "",
    "src/sinuous/model/arm.py": "if TYPE_CHECKING:\n    from sinuous.scene.ball import Ball\n",
    "src/sinuous/scene/ball.py": "def robot():\n    from sinuous.model import arm\n",
    "src/sinuous/base/errors.py": SOURCE,
    "tests/model/test_arm.py": "from sinuous.base.errors import InputError\n",
}


def test_code_is_what_is_neither_comment_nor_docstring_nor_blank() -> None:
    assert code_lines(SOURCE) == 6
    assert code_lines("") == 0
    assert code_lines('text = """\na\n\nb\n"""\n') == 5


def test_rooms_add_up() -> None:
    assert sizes(PACKAGE) == {"package": 1, "base": 6, "model": 2, "scene": 2, "tests": 1}
