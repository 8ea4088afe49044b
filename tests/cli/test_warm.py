"""The command warm, and the steps that it takes."""

import re
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import sinuous
from sinuous.base.progress import LONG
from sinuous.cli import warm
from sinuous.cli.app import main
from sinuous.cli.warm import WarmStep, steps
from sinuous.kernels.compile import tiers
from sinuous.kernels.compile.tiers import FREE, PIECES
from sinuous.methods.method import METHODS
from tests.base.test_progress import Terminal
from tests.helpers import refused
from tests.kernels.test_compile import decorated

FIRST, SECOND = tiers.PIECES[:2]


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> Callable[[tiers.Piece], None]:
    """Steps, of which the first compiles and the others find everything; returns what stands for pieces."""

    def compile_it(piece: tiers.Piece) -> None:
        tiers._tellers[-1](piece)

    steps = [WarmStep("one", lambda: compile_it(FIRST)), *[WarmStep("another", lambda: None)] * (LONG - 1)]
    monkeypatch.setattr(warm, "steps", lambda methods: steps)
    monkeypatch.setattr(warm, "cores", lambda: 1)
    return compile_it


@pytest.mark.usefixtures("compiled")
def test_it_says_what_is_compiled_and_how_many_are_left(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["warm"]) == 0
    said = capsys.readouterr()
    assert said.err == f"sinuous: 1 of 10: compiling single solves (about {FIRST.expected} s)\n"
    assert said.out == "everything is compiled, in 0 s\n"
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    assert main(["warm"]) == 0
    assert "10 of 10" in stream.getvalue()


def test_an_interrupt_is_no_traceback(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(warm, "steps", lambda methods: [WarmStep("one", lambda: None), WarmStep("two", interrupted)])
    monkeypatch.setattr(warm, "cores", lambda: 1)
    assert main(["warm"]) == 130
    assert capsys.readouterr().err == "sinuous: interrupted after 1 of 2; what is compiled stays so\n"


def test_processes_share_the_work(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(warm, "cores", lambda: 2)
    monkeypatch.setattr(warm, "steps", lambda methods: steps(methods)[:2])  # the others take as long as all of this
    assert main(["warm", "--method", "dls"]) == 0
    said = capsys.readouterr()
    if said.out.startswith("everything is compiled"):  # by now
        assert main(["warm", "--method", "dls"]) == 0
        said = capsys.readouterr()
    assert (said.out, said.err) == ("everything was compiled before\n", "")


def test_an_error_in_a_process_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(warm, "steps", lambda methods: [WarmStep("one", lambda: None)])
    refused("method", lambda: warm._use_in_processes(1, ("magic",), warm._Shown(1)), "unknown method 'magic'")


def test_the_store_is_shown_and_emptied(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("a.1.code", "b.2.code", "0.begun", "lock"):
        (tmp_path / name).write_bytes(b"x" * 1000)
    monkeypatch.setattr(warm, "CACHE", tmp_path)
    assert main(["warm", "--where"]) == 0
    assert capsys.readouterr().out == f"{tmp_path}: 3 files, 0.0 MB\n"
    assert main(["warm", "--clear"]) == 0
    assert capsys.readouterr().out == f"2 compiled kernels removed from {tmp_path}\n"
    assert [file.name for file in tmp_path.iterdir()] == ["lock"]


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
    bodies = ["derivatives", "shapes under load", "control loops under load"]
    assert named == [*geometry, "control loops", *bodies, "the method dls"]
    assert {step.what for step in steps()} >= {f"the method {name}" for name in METHODS if name != "newton"}
