"""Lines by room: code is counted without comments, docstrings and blanks; a commit that is not there is refused."""

import pytest

from benchmarks import rooms
from benchmarks.rooms import Size, code_lines, main, sizes

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


def test_code_is_what_is_neither_comment_nor_docstring_nor_blank() -> None:
    assert code_lines(SOURCE) == 6
    assert code_lines("") == 0
    assert code_lines('text = """\na\n\nb\n"""\n') == 5


def test_rooms_add_up() -> None:
    package = [("robot/robot.py", SOURCE), ("kernels/step/newton.py", "x = 1\n"), ("errors.py", "x = 1\ny = 2\n")]
    found = sizes([("tests/robot/test_robot.py", "x = 1\n"), *((f"src/sinuous/{path}", own) for path, own in package)])
    assert found["kernels/step"] == Size(1, 1, 1)
    assert found["."] == Size(1, 2, 2)
    assert list(found)[-2:] == ["all", "tests"]
    assert found["tests"] == Size(1, 1, 1)
    assert found["all"] == Size(3, 3 + len(SOURCE.splitlines()), 9)


def test_a_table_is_printed(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rooms, "PACKAGE", "src/sinuous/model")
    monkeypatch.setattr(rooms, "BESIDE", ())
    assert main([]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[0].startswith("| room |")
    assert rows[-1].startswith("| all |")


def test_a_commit_that_is_not_there_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--against", "no-such-commit"]) == 2
    assert "--against" in capsys.readouterr().err
