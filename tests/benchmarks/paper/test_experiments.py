"""Every experiment, cut down: it runs, all claims hold, and its tables, figures and JSON agree."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.layout_engine import ConstrainedLayoutEngine

from benchmarks.__main__ import Chosen
from benchmarks.harness.conduct import Output, conduct
from benchmarks.judges.judge import judge
from benchmarks.paper.entrants import DIFFERENCES, FAITHFUL
from benchmarks.paper.methods.families import FAMILIES
from benchmarks.paper.scenes import paper_pose
from benchmarks.paper.table1.rows import EXACT
from benchmarks.pictures import style as look
from benchmarks.pictures.style import STYLES, style
from benchmarks.problems import PAPER_POSES
from sinuous.methods.registry import METHODS
from tests.cases import with_each

RUNNERS = ("newton", "opti_path", "dls")

Ran = Callable[[str], tuple[dict[str, Any], str, Path]]


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Ran:
    """Run an experiment once for all tests of it; return its JSON, its Markdown and its folder."""
    done: dict[str, tuple[dict[str, Any], str, Path]] = {}

    def run(name: str) -> tuple[dict[str, Any], str, Path]:
        if name not in done:
            folder = tmp_path_factory.mktemp(name)
            experiment = Chosen(name, seed=1, quick=True, methods=RUNNERS).experiment()
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(look, "DPI", 50)
                patch.setattr(ConstrainedLayoutEngine, "execute", lambda *_: None)  # half of the drawing
                assert conduct(experiment, Output(folder, json=True)) == 0
            done[name] = json.loads((folder / f"{name}.json").read_text()), (folder / f"{name}.md").read_text(), folder
        return done[name]

    return run


@pytest.mark.parametrize("name", ["table1", "tracking", "segments", "methods"])
def test_tables_and_figures_are_written(ran: Ran, name: str) -> None:
    data, text, folder = ran(name)
    assert data["wrong"] == 0
    assert data["quick"]
    assert data["seed"] == 1
    shown = re.findall(r"!\[[^]]+\]\((\w+\.png)\)", text)
    assert sorted(shown) == sorted(file.name for file in folder.glob("*.png"))
    assert all((folder / file).stat().st_size > 4_000 for file in shown)
    assert text.count("\n| newton") >= 2
    assert "takes account of limits on" in text


def test_table1_has_every_method_beside_what_is_published(ran: Ran) -> None:
    data, text, _ = ran("table1")
    assert set(data["poses"]) == set(PAPER_POSES)
    for pose, found in data["poses"].items():
        assert set(found) == {"newton", EXACT, "opti_path", FAITHFUL, "dls"}
        problems = paper_pose(pose, 1)
        for label in ("newton", "opti_path"):
            assert found[label]["right"] == found[label]["runs"] == 2
            q = np.array([found[label]["q"]])
            assert judge(problems.robot, problems.targets, q, problems.tolerance).right.all()
        assert found[EXACT]["position"] < 2e-6
    assert data["poses"]["A"]["dls"]["published"] == {
        "seconds": 0.112,
        "position": 4.52,
        "angle": 0.85,
        "iterations": "",
    }
    assert "112 ms" in text


def test_tracking_counts_waypoints(ran: Ran) -> None:
    data, text, _ = ran("tracking")
    assert set(data["densities"]) == {"10", "40"}
    for found in data["densities"].values():
        assert found["newton"]["waypoints"] == 8
        assert found["newton"]["right"] == 8
        assert found["newton"]["least_clearance"] >= -1e-9
        assert found["newton"]["paths"] == 1
    assert data["not_run"] == {"dls": "does not avoid obstacles"}
    assert "| by any" in text


def test_segments_fits_exponents(ran: Ran) -> None:
    data, text, _ = ran("segments")
    for curve in data["path"] + data["poses"]:
        assert curve["label"] in {"newton", "opti_path", DIFFERENCES}
        assert curve["solved"][0][0] > 0
    assert [curve["sizes"] for curve in data["poses"]] == [[5, 10, 20]] * 3
    slope = float(np.polyfit(np.log([5.0, 10.0, 20.0]), np.log(data["poses"][0]["iteration"]), 1)[0])
    assert data["poses"][0]["iteration_exponent"] == pytest.approx(slope)
    assert f"n^{slope:.2f}" in text


def test_methods_covers_every_family(ran: Ran) -> None:
    data, text, _ = ran("methods")
    assert set(data["families"]) == set(FAMILIES)
    assert all(found["newton"]["right"] == 2 for found in data["families"].values())
    assert "dls" in data["not_run"]["spheres, position"]
    assert "opti_path" in data["not_run"]["rotation"]
    assert "Not run: " in text


@with_each("family", list(FAMILIES))
def test_problems_are_those_of_their_seed_and_differ(family: str) -> None:
    draw = FAMILIES[family].draw
    first, again, other = (draw(3, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert [t.table.tolist() for t in first.targets] == [t.table.tolist() for t in again.targets]
    assert [t.table.tolist() for t in first.targets] != [t.table.tolist() for t in other.targets]
    assert bool(len(first.scene)) is family.startswith("spheres")


def test_every_method_has_a_look_of_its_own() -> None:
    labels = [*METHODS, FAITHFUL]
    assert set(labels) <= set(STYLES)
    assert len({style(label).color for label in labels}) == len(labels)
    assert len({style(label).marker for label in labels}) == len(labels)
