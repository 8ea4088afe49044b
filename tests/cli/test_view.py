"""The command view: a page in one file, and a server that an interrupt ends."""

import os
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

import sinuous as sn
from sinuous.cli.view import is_loopback
from sinuous.view.page.page import Page
from tests.cli.conftest import Run
from tests.helpers import present, refused


def test_a_problem_and_a_path_become_pages_and_a_page_remembers(run: Run) -> None:
    for _ in range(2):
        assert run("view scene.yaml --html x.html --memory arm.npz").out == ""
        assert len(sn.Memory.load("arm.npz")) == 1
    assert run("view path.yaml --html y.html").out == ""
    assert all("solved" in Path(page).read_text(encoding="utf-8") for page in ("x.html", "y.html"))
    assert "memory" in run("view scene.yaml --html x.html --memory scene.yaml", 2).err


@pytest.mark.parametrize("typed", ["solve scene.yaml", "solve --all 2 easy.yaml", "track path.yaml --json"])
def test_answers_are_drawn_as_pages(run: Run, typed: str) -> None:
    run(f"{typed} --plot x.html")
    assert Path("x.html").stat().st_size > 500_000


def test_what_plan_wrote_is_shown(run: Run) -> None:
    run("plan plan.yaml --out results.jsonl")
    straight = [[0.0, 0.0, 1.0]] * 4
    sn.Job(sn.Robot.uniform(4, 1.0), start=straight, goal=straight).save("other.yaml")
    for typed in ("--result results.jsonl", ""):
        Path("page.html").unlink(missing_ok=True)
        run(f"view plan.yaml --html page.html {typed}")
        assert Path("page.html").stat().st_size > 500_000
    for typed, words in (("other.yaml --result results.jsonl", "knots"), ("plan.yaml --result plan.yaml", "line 1")):
        (line,) = run(f"view {typed} --html page.html", 2).err.splitlines()
        assert words in line


def test_without_viser_it_is_said_how_to_get_it(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [*sys.modules]:
        if name.startswith(("viser", "sinuous.cli.view", "sinuous.view.page")):  # as where they never were imported
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "viser", None)
    for typed in ("view easy.yaml", "solve easy.yaml --plot x.html"):
        assert "pip install sinuous[view]" in run(typed, 2).err


def test_which_addresses_are_this_machine_alone() -> None:
    assert all(map(is_loopback, ("127.0.0.1", "127.3.2.1", "::1", "localhost")))
    assert not any(map(is_loopback, ("0.0.0.0", "192.168.1.4", "::")))
    refused("--host", lambda: is_loopback("example.org"))


@pytest.mark.skipif(os.name == "nt", reason="interrupts are sent in another way there")
@pytest.mark.usefixtures("run")
def test_a_server_runs_until_it_is_interrupted() -> None:
    host, environment = "0.0.0.0", {**os.environ, "PYTHONUNBUFFERED": "1"}
    typed = f"-m sinuous view easy.yaml --port 0 --no-browser --host {host}"
    command = [sys.executable, *typed.split()]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    address = present(process.stdout).readline().split()[0]
    assert address.startswith(f"http://{host}:")
    with urllib.request.urlopen(address.replace("0.0.0.0", "127.0.0.1")) as page:
        assert b"</html>" in page.read()
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=300)
    assert process.returncode == 0
    assert out == ""
    assert "whoever reaches" in error
    assert "Traceback" not in error


def test_a_page_for_this_machine_alone_needs_no_warning(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: Page) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Page, "wait", interrupted)
    monkeypatch.setattr(sys, "setswitchinterval", lambda _: None)
    said = run("view easy.yaml --port 0 --no-browser")
    assert said.out.startswith("http://127.0.0.1:")
    assert said.err.strip() == ""
