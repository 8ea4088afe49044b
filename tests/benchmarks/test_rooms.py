"""Lines by room: code is counted without comments, docstrings and blanks; circles are found, also those of types."""

from benchmarks.rooms import between_rooms, circles, code_lines, imports, sizes

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


def test_circles_are_found_wherever_imports_stand() -> None:
    edges = imports(PACKAGE)
    assert edges["sinuous.scene.ball"] == {"sinuous.model", "sinuous.model.arm"}
    assert circles(edges) == [["sinuous.model.arm", "sinuous.scene.ball"]]
    assert circles(between_rooms(edges)) == [["sinuous.model", "sinuous.scene"]]
    assert circles({"a": ["b"], "b": ["c"], "c": []}) == []
