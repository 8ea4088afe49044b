"""A map says of every voxel and direction what solving it says, and no proof of it is false."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.studies.runs.engine import Checkpoint
from sinuous.studies.workspace import find
from sinuous.studies.workspace.reach import Verdict
from tests.helpers import refused
from tests.studies.workspace.maps import ROBOT, SPACING, WALL, made


def test_it_is_the_same_whatever_the_number_of_workers(found: sn.studies.Reach) -> None:
    other = made(workers=1)
    np.testing.assert_array_equal(other.verdicts, found.verdicts)
    np.testing.assert_array_equal(other.free, found.free)
    np.testing.assert_array_equal(other.obstacles, found.obstacles)


def test_all_verdicts_are_there(found: sn.studies.Reach) -> None:
    assert {Verdict(code) for code in np.unique(found.verdicts)} >= {
        Verdict.SOLVED,
        Verdict.OUT_OF_REACH,
        Verdict.TARGET_BLOCKED,
        Verdict.LIMITS,
    }


def test_what_is_solved_can_be_solved(found: sn.studies.Reach) -> None:
    at = np.argwhere(found.verdicts == Verdict.SOLVED)
    some = at[np.random.default_rng(0).choice(len(at), 150, replace=False)]
    places, axes = found.voxels.middles[tuple(some[:, :3].T)], found.directions[some[:, 3]]
    many = sn.Solver(ROBOT, WALL).solve_many(positions=places, directions=axes)
    assert many.solved.mean() > 0.98
    assert all(solution.verify().ok for solution in many[many.solved][:20])


def test_positions_are_the_default_and_can_be_solved(positions: sn.studies.Reach) -> None:
    default = sn.studies.reach(ROBOT, WALL, SPACING)
    np.testing.assert_array_equal(default.positions, positions.positions)
    places = default.voxels.middles[default.reachable]
    some = places[np.random.default_rng(0).choice(len(places), 100, replace=False)]
    many = sn.Solver(ROBOT, WALL, max_starts=50).solve_many(positions=some)
    assert many.solved.mean() > 0.98
    left = default.voxels.middles[default.positions == Verdict.LIMITS]
    some = left[np.random.default_rng(0).choice(len(left), 100, replace=False)]
    assert sn.Solver(ROBOT, WALL, max_starts=50).solve_many(positions=some).solved.mean() < 0.02


def test_a_cone_holds_what_random_shapes_reach_in_it() -> None:
    """The places of tips that are within the cone are found, and what is found is within: no solve says otherwise."""
    axis, within = np.array([0.6, 0.0, 0.8]), 0.5
    rng = np.random.default_rng(4)
    q = np.concatenate([rng.uniform(-1.1, 1.1, (4000, 2, 2)), rng.uniform(40, 60, (4000, 2, 1))], axis=-1)
    tips = ROBOT.tip(q)
    places = tips[tips[:, :3, 2] @ axis > np.cos(within), :3, 3]
    assert len(places) > 300
    solver = sn.Solver(ROBOT, None, max_starts=1, routes=False)
    query, calls = find.PlaceQuery(solver, axis[None], within), find.Calls(1, Checkpoint(None, {}, "this map"))
    codes, shapes = query.solve(calls, places, np.zeros(len(places), np.int64), None)
    assert (codes == Verdict.SOLVED).mean() > 0.98
    assert not ((codes > Verdict.SOLVED) & (codes <= Verdict.BASE_BLOCKED)).any()
    found = ROBOT.tip(shapes[codes == Verdict.SOLVED].astype(float))
    assert (found[:, :3, 2] @ axis > np.cos(within) - 1e-9).all()
    assert np.abs(found[:, :3, 3] - places[codes == Verdict.SOLVED]).max() < 0.02


def test_a_cone_of_half_a_turn_is_a_map_of_positions(positions: sn.studies.Reach) -> None:
    whole = made(directions=(0, 0, 1), within=np.pi)
    np.testing.assert_array_equal(whole.dexterous, whole.reachable)
    assert (whole.reachable >= positions.reachable).all()


def test_it_is_told_how_long_it_takes(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(find, "PATIENCE", 1e-9)
    made(directions=0)
    told = capsys.readouterr().err
    assert told.startswith("sinuous: ")
    assert "s left" in told
    made(directions=0, progress=False)
    assert capsys.readouterr().err == ""


def test_obstacles_only_take_away(found: sn.studies.Reach) -> None:
    assert (found.share <= found.free_share).all()
    alone = sn.studies.reach(ROBOT, None, 20.0, 26)
    np.testing.assert_array_equal(alone.verdicts, found.free)
    np.testing.assert_array_equal(alone.verdicts, alone.free)
    assert (alone.obstacles == -1).all()


def test_the_obstacle_in_the_way_is_named(found: sn.studies.Reach) -> None:
    blame = found.blame()
    assert set(blame) <= {"ball -40", "ball 0", "ball 40"}
    assert blame
    told = found.why((45, 0, 70))  # what takes no direction away is not named
    assert set(told) <= {"out_of_reach", "target_blocked"}
    inside = tuple(np.rint((np.array([45, 0, 70]) - found.voxels.first) / 20.0).astype(int))
    assert set(found.verdicts[inside].tolist()) <= {Verdict.OUT_OF_REACH, Verdict.TARGET_BLOCKED}
    assert Verdict.TARGET_BLOCKED in found.verdicts[inside]
    assert found.proved[inside]
    assert found.in_the_way((45, 0, 70)) in blame


def test_wherever_it_ends_the_same_call_goes_on(
    found: sn.studies.Reach, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(find, "CALL_SIZE", 3000)
    calls, solve_many = 0, sn.Solver.solve_many

    def interrupted(*arguments: Any, **options: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls % 5 == 0:
            raise KeyboardInterrupt
        return solve_many(*arguments, **options)

    out = tmp_path / "map.npz"
    with monkeypatch.context() as patch:
        patch.setattr(sn.Solver, "solve_many", interrupted)
        for _ in range(100):
            try:
                made(out=out)
                break
            except KeyboardInterrupt:
                assert out.with_name("map.npz.parts").exists()
    assert calls > 10
    other = sn.studies.Reach.load(out)
    for name in ("verdicts", "free", "obstacles", "directions"):
        np.testing.assert_array_equal(getattr(other, name), getattr(found, name))
    assert [file.name for file in tmp_path.iterdir()] == ["map.npz"]


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"spacing": 0.0}, "spacing"),
        ({"spacing": 0.01}, "spacing"),
        ({"spacing": 20.0, "directions": -1}, "directions"),
        ({"spacing": 20.0, "within": 0.1}, "within"),
        ({"spacing": 20.0, "directions": [[0.0, 0.0, 0.0]]}, "directions[0]"),
        ({"low": (0, 0, 0), "high": (-1, 0, 0)}, "high"),
        ({"low": (1, 1, 1), "high": (2, 2, 2), "spacing": 20.0}, "spacing"),
        ({"workers": 0}, "workers"),
        ({"time": -1.0}, "time"),
        ({"out": f"{__file__}/map.npz", "spacing": 60.0}, "out"),
    ],
)
def test_wrong_arguments_are_refused(options: dict[str, object], key: str) -> None:
    refused(key, lambda: sn.studies.reach(ROBOT, None, **options))  # type: ignore[arg-type]
