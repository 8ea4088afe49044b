"""Every job of the cookbook runs as it stands, and takes at most eight statements."""

import ast
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import with_each

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "cookbook.md").read_text(encoding="utf-8")
JOBS = dict(re.findall(r"^## (.*?)\n.*?```python\n(.*?)```", PAGE, re.DOTALL | re.MULTILINE))
MOST = 8

FEWER = 2_000
"""What a batch of 100,000 is here, of which nothing depends on how many there are."""


def statements(code: str) -> list[ast.stmt]:
    """What somebody has to think of."""
    found = [node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.stmt)]
    return [node for node in found if not isinstance(node, ast.Import | ast.ImportFrom)]


def test_every_heading_is_a_job() -> None:
    assert len(JOBS) == PAGE.count("\n## ") == PAGE.count("```python") >= 10


@with_each("job", JOBS)
def test_it_takes_few_statements(job: str) -> None:
    assert 0 < len(statements(JOBS[job])) <= MOST


def run(job: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    shutil.copytree(ROOT / "examples", folder / "examples")
    monkeypatch.chdir(folder)
    pytest.importorskip("matplotlib")
    if "import mujoco" in JOBS[job]:
        pytest.importorskip("mujoco")
    names: dict[str, Any] = {}
    exec(compile(JOBS[job].replace("100_000", str(FEWER)), job, "exec"), names)
    return names


@pytest.mark.parametrize("job", JOBS)
def test_it_does_what_it_says(job: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = run(job, tmp_path, monkeypatch)
    solution: Any = names.get("solution")
    assert solution is None or (solution.solved and solution.verify().ok)
    assert "motion" not in names or names["motion"].solved
    if "shape" in names:
        np.testing.assert_allclose(names["shape"], solution.q, atol=1e-9)
    match job:
        case "From a table of points to a table of motor values":
            assert (tmp_path / "motors.csv").read_text(encoding="utf-8").count("\n") == len(names["motion"].q) + 1
        case "In MuJoCo, moved by its motors":
            reached = names["robot"].tip(solution.q)[:3, 3]
            np.testing.assert_allclose(names["data"].site("tip").xpos, reached, atol=1.0)
        case "From encoders to the shape":
            left = names["arm"].to_actuators(names["q"]) - names["measured"]
            assert 0.1 < abs(left).max() < 3.0
        case "A plan as fast as the motors allow, for a controller":
            assert sn.load(tmp_path / "motion.json").equals(names["motion"])
            assert (tmp_path / "motors.csv").read_text(encoding="utf-8").count("\n") > 100 * names["timed"].duration
        case "Why not, and as near as it can come":
            assert not names["failed"].solved
            assert names["failed"].binding
        case "A batch of 100,000":
            assert len(names["many"]) == FEWER
            assert names["many"].solved.mean() > 0.9
        case "Ten million targets, through files":
            assert names["q"].shape == (FEWER, 5, 3)
            assert names["batch"].counts["solved"] > 0.9 * FEWER
        case "Which robot should it be?":
            assert len(names["found"].totals) == 4
            assert names["found"].best().done == 3
        case "Pick up a payload":
            assert names["empty"].solved
            assert max(abs(names["empty"].actuators[key] - value) for key, value in solution.actuators.items()) > 1e-4
        case "Shapes from elsewhere":
            assert names["checked"].ok.shape == (20,)
        case _:
            assert solution is not None or "motion" in names
