"""Commands about a robot in a place: batch, explore, reach. What ends a batch: tests/studies/batch/test_deaths.py."""

import re
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.studies.designing.search import RobotCandidates
from sinuous.studies.exploring.explore import _ExplorationRun
from tests.cli.conftest import Run
from tests.helpers import present
from tests.studies.batch.questions import BALL, ROBOT, points, write_csv
from tests.studies.workspace.maps import ROBOT as MAPPED
from tests.studies.workspace.maps import WALL

BATCH = "batch arm.yaml --targets good.csv"
EXPLORE = "explore narrow.yaml --memory arm.npz --rounds 1 --max-starts 4"
REACH = "reach mapped.yaml --spacing 60 --directions 6"
NARROW = """
robot: {segments: {count: 2, length: [0.8, 1.2], max_bend: 2.0, radius: 0.05}}
scene: [{sphere: {center: [0.6, 0, 1.2], radius: 0.3}}]
start: [[0, 0, 1], [0, 0.4, 1]]
target: {position: [-0.6, 0.2, 1.7]}
"""


@pytest.fixture(autouse=True)
def _files(run: Run) -> None:
    sn.Job(ROBOT, sn.Target((0, 0, 150)), [BALL], tolerance=sn.Tolerance(0.5)).save("arm.yaml")
    write_csv(Path("in.csv"), points(12))
    write_csv(Path("good.csv"), np.array([[0.0, 10.0, 160.0], [20.0, 0.0, 150.0]]))
    Path("narrow.yaml").write_text(NARROW)
    sn.Job(MAPPED, sn.Target((0, 0, 100)), WALL).save("mapped.yaml")


def interrupt(patch: pytest.MonkeyPatch, owner: object, name: str) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    patch.setattr(owner, name, interrupted)


def test_all_rows_of_a_table_are_solved(run: Run) -> None:
    told = run(f"{BATCH} --out out.csv").out
    assert told.startswith("arm.yaml: 2 rows: 2 solved")
    assert "out.csv" in told
    run(f"{BATCH} --out own.csv --columns s2.length,clearance")
    assert Path("own.csv").read_text().splitlines()[0] == "row,status,s2.length,clearance"
    assert run(f"{BATCH} --out out.csv --json").results[0]["before"] == 2
    assert run(f"{BATCH} --out out.csv --warm").err.startswith("note: --warm: does nothing any more; use --memory")
    Path("mm.csv").write_text("X [mm];Y [mm];Z [mm]\n0;10;160\n")
    told = run("batch arm.yaml --targets mm.csv --out mm.npz").err
    assert told.endswith("note: mm.csv: the header says mm; numbers are taken as they stand\n")
    fast = "--out out.npz --max-starts 4 --no-routes"
    assert "invalid    rows 4" in run(f"batch arm.yaml --targets in.csv {fast}", 1).out


def test_a_memory_is_filled_and_a_plan_walks_in_it(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    told = run(EXPLORE).out
    assert told.startswith("narrow.yaml: ")
    assert " motions, " in told
    with monkeypatch.context() as patch:
        interrupt(patch, _ExplorationRun, "round")
        told = run(EXPLORE, 130).err
    found = sn.Memory.load("arm.npz")
    kept = f"{len(found)} shapes and {len(found.edges)} motions are in arm.npz"
    assert told == f"sinuous: interrupted; {kept}, the same command goes on\n"
    (values,) = run(f"{EXPLORE} --json --workers 1").results
    memory = sn.Memory.load("arm.npz")
    assert (values["rounds"], values["shapes"], values["motions"]) == (2, len(memory), len(memory.edges))
    run("plan narrow.yaml --memory arm.npz")
    assert sn.Memory.load("arm.npz").fingerprint == memory.fingerprint  # nothing had to be searched


def test_a_map_is_told_written_and_drawn(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        interrupt(patch, sn.studies.Reach, "save")
        told = run(f"{REACH} --out map.npz", 130).err
    said = re.fullmatch(
        r"sinuous: interrupted; what was found is kept \((.*) solves\), the same command goes on\n", told
    )
    assert int(present(said)[1].replace(",", "")) >= 5**3
    assert run(f"{REACH} --directions 3 --out map.npz", 2).err.startswith("--directions: ")
    assert run(f"{REACH} --toward 0,0,1", 2).err.startswith("--toward: cannot be combined with --directions")
    for wrong in ("--toward 0,0", "--toward 0,0,0", "--within 20 --toward 0,0,1", "--within 0.1"):
        assert run(f"reach mapped.yaml {wrong}", 2).err.startswith(wrong.split()[0] + ": ")
    with monkeypatch.context() as patch:
        interrupt(patch, sn.Solver, "solve_many")
        kept = run(f"{REACH} --out map.npz --plot map.html").out  # all is there
        assert run(REACH, 130).err == "sinuous: interrupted; nothing is written\n"
    assert kept.startswith("mapped.yaml: 5 x 5 x 5 voxels of 60, 6 directions each")
    found = sn.studies.Reach.load("map.npz")
    assert found.voxels.shape == (5, 5, 5)
    assert Path("map.html").exists()
    (values,) = run(f"{REACH} --out map.npz --json").results
    assert values["volumes"]["reachable"]["found"] == found.volume().found


def test_a_file_says_what_a_map_asks_and_options_replace_it(run: Run) -> None:
    asked = sn.studies.Workspace(60.0, (0, 0, 1), 0.4, low=(-60, -60, 0))
    job = sn.Job(MAPPED, scene=WALL, workspace=asked)
    job.save("asked.yaml")
    assert sn.load("asked.yaml", sn.Job).equals(job)
    said = run("reach asked.yaml").out
    assert said.startswith("asked.yaml: 4 x 4 x 3 voxels of 60, a direction each")
    assert "with the tip along 0 0 1, within 22.9 degrees" in said
    (values,) = run("reach asked.yaml --json --spacing 40 --directions 3 --within 0.2").results
    assert (values["spacing"], values["directions"], values["within"]) == (40.0, 3, 0.2)
    (values,) = run("reach asked.yaml --json --toward 1,0,0").results
    assert values["directions"] == 1


def test_a_design_that_is_interrupted_says_how_many_robots_are_kept(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("tasks.yaml").write_text(
        NARROW.partition("start")[0] + "tasks: {up: {target: {position: [-0.6, 0.2, 1.7]}}}\n"
    )
    with monkeypatch.context() as patch:
        interrupt(patch, RobotCandidates, "joined")  # after the first generation
        vary = "design tasks.yaml --vary segments.length=0.5:1.2 --minimise length --robots 400"
        assert run(vary, 130).err.splitlines()[-1] == "sinuous: interrupted; nothing is written"
        told = run(f"{vary} --csv robots.csv", 130).err.splitlines()[-1]
    said = re.fullmatch(
        r"sinuous: interrupted; what was judged is kept \((\d+) robots\), the same command goes on", told
    )
    assert int(present(said)[1]) > 0
