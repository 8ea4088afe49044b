"""Every entry is named once, and methods that are not asked for are left out. What is compiled: `test_conformance`."""

import re
from pathlib import Path

import sinuous
from sinuous.cli.warm_steps import steps
from sinuous.kernels.compile.pieces import FREE, PIECES
from sinuous.methods.method import METHODS
from tests.kernels.test_compile import decorated

PACKAGE = Path(sinuous.__file__).parent


def made_around(file: Path) -> list[str]:
    """Names of the entries of a file that are made around another kernel."""
    return re.findall(r"^(\w+) = search_by\(", file.read_text(encoding="utf-8"), re.MULTILINE)


def test_every_entry_is_in_one_piece() -> None:
    listed = [entry for piece in PIECES for entry in piece.entries]
    assert len(set(listed)) == len(listed)
    entries = {
        ".".join([*file.relative_to(PACKAGE).with_suffix("").parts, name])
        for room in ("kernels", "methods")
        for file in (PACKAGE / room).rglob("*.py")
        for name in (*decorated(file, "entry"), *made_around(file))
    }
    assert {entry.removesuffix(FREE) for entry in listed} == entries


def test_methods_that_are_not_asked_for_are_left_out() -> None:
    named = [step.what for step in steps(["dls", "dls"])]
    geometry = ["kinematics", "starts of a memory", "distances", "classes of routes", "motions", "plans"]
    bodies = ["derivatives", "derivatives among obstacles", "shapes under load"]
    assert named == [*geometry, "control loops", *bodies, "the method dls"]
    assert {step.what for step in steps()} >= {f"the method {name}" for name in METHODS if name != "newton"}
