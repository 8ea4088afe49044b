"""The command view: a page in one file, one line where something is wrong, and a server that an interrupt ends."""

import os
import signal
import subprocess
import sys
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest

import sinuous as sn
from sinuous.base.errors import InputError
from sinuous.cli.app import main
from sinuous.cli.view import is_loopback
from sinuous.view.page.page import Page

Write = Callable[[str], str]


def test_a_problem_and_a_path_become_pages(problem: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("scene.yaml", "path.yaml"):
        out = tmp_path / f"{name}.html"
        assert main(["view", problem(name), "--html", str(out)]) == 0
        assert "solved" in out.read_text(encoding="utf-8")
    captured = capsys.readouterr()
    assert captured.out == ""


def test_answers_are_drawn_as_pages(problem: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "x.html"
    for arguments in (["solve", problem("scene.yaml")], ["solve", "--all", "2", problem("easy.yaml")]):
        page.unlink(missing_ok=True)
        assert main([*arguments, "--plot", str(page)]) == 0
        assert page.stat().st_size > 500_000
    assert main(["track", problem("path.yaml"), "--plot", str(page), "--json"]) == 0
    assert capsys.readouterr().out.count("\n{") <= 1


def test_what_plan_wrote_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2, radius=0.08)
    straight = [[0.0, 0.0, 1.0]] * 3
    file, other = str(tmp_path / "goal.yaml"), str(tmp_path / "other.yaml")
    sn.Job(robot, start=straight, goal=[[0.5, 0.0, 1.0]] * 3).save(file)
    sn.Job(sn.Robot.uniform(4, 1.0), start=[[0.0, 0.0, 1.0]] * 4, goal=[[0.5, 0.0, 1.0]] * 4).save(other)
    results, page = str(tmp_path / "results.jsonl"), tmp_path / "page.html"
    assert main(["plan", file, "--out", results]) == 0
    for arguments in (["view", file, "--result", results], ["view", file]):
        page.unlink(missing_ok=True)
        assert main([*arguments, "--html", str(page)]) == 0
        assert page.stat().st_size > 500_000
    capsys.readouterr()
    for wrong, words in ((["view", other, "--result", results], "knots"), (["view", file, "--result", file], "line 1")):
        assert main([*wrong, "--html", str(page)]) == 2
        error = capsys.readouterr().err
        assert words in error
        assert error.count("\n") == 1


def test_a_page_remembers(problem: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, page, kept = problem("scene.yaml"), tmp_path / "x.html", tmp_path / "arm.npz"
    for _ in range(2):
        assert main(["view", file, "--html", str(page), "--memory", str(kept)]) == 0
        assert len(sn.Memory.load(kept)) == 1
    capsys.readouterr()
    assert main(["view", file, "--html", str(page), "--memory", file]) == 2
    assert "memory" in capsys.readouterr().err


def test_what_is_wrong_is_one_line(problem: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = problem("easy.yaml")
    for arguments, said in (
        (["view", file, "--html", "x.png"], "--html: expected a name that ends in .html, got 'x.png'\n"),
        (["view", problem("bad.yaml")], "target.position"),
        (["view", str(tmp_path / "missing.yaml")], "missing.yaml: file"),
        (["view", file, "--host", "nowhere"], "--host: expected an address like 127.0.0.1"),
        (["view", file, "--port", "70000"], "Invalid value for '--port'"),
        (["solve", file, "--plot", str(tmp_path / "no" / "x.html")], "--plot"),
    ):
        assert main(arguments) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count("\n") == 1


def test_without_viser_it_is_said_how_to_get_it(
    problem: Write, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    assert main(["view", problem("easy.yaml")]) == 2
    assert "pip install sinuous[view]" in capsys.readouterr().err
    assert main(["solve", problem("easy.yaml"), "--plot", "x.html"]) == 2
    assert "pip install sinuous[view]" in capsys.readouterr().err


def test_which_addresses_are_this_machine_alone() -> None:
    assert all(map(is_loopback, ("127.0.0.1", "127.3.2.1", "::1", "localhost")))
    assert not any(map(is_loopback, ("0.0.0.0", "192.168.1.4", "::")))
    with pytest.raises(InputError, match="--host"):
        is_loopback("example.org")


@pytest.mark.skipif(os.name == "nt", reason="interrupts are sent in another way there")
def test_a_server_runs_until_it_is_interrupted(problem: Write) -> None:
    host = "0.0.0.0"
    command = [
        sys.executable,
        "-m",
        "sinuous",
        "view",
        problem("easy.yaml"),
        "--port",
        "0",
        "--no-browser",
        "--host",
        host,
    ]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    address = process.stdout.readline().split()[0]
    assert address.startswith(f"http://{host}:")
    with urllib.request.urlopen(address.replace("0.0.0.0", "127.0.0.1")) as page:
        assert b"</html>" in page.read()
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=300)
    assert process.returncode == 0
    assert out == ""
    assert "whoever reaches" in error
    assert "Traceback" not in error


def test_a_page_for_this_machine_alone_needs_no_warning(
    problem: Write, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_: Page) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Page, "wait", interrupted)
    monkeypatch.setattr(sys, "setswitchinterval", lambda _: None)
    assert main(["view", problem("easy.yaml"), "--port", "0", "--no-browser"]) == 0
    said = capsys.readouterr()
    assert said.out.startswith("http://127.0.0.1:")
    assert said.err.strip() == ""
