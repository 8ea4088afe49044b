"""A map says of every voxel and direction what solving it says, and no proof of it is false."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.studies.workspace import find, rounds
from sinuous.studies.workspace.reach import Verdict
from tests.studies.workspace.maps import ROBOT, WALL, made


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


def test_random_shapes_refute_no_proof() -> None:
    """What a map takes for proved comes from these calls: none may say so of the tip of a shape that is clear."""
    rng = np.random.default_rng(2)
    bends = rng.uniform(-1.1, 1.1, (80, 2, 2))
    q = np.concatenate([bends, rng.uniform(40, 60, (80, 2, 1))], axis=-1)
    tips = ROBOT.tip(q[sn.check(ROBOT, q, WALL).ok])
    assert len(tips) > 30
    for directions in (tips[:, :3, 2], None):
        solver = sn.Solver(ROBOT, WALL, max_starts=1, routes=False)
        many = solver.solve_many(positions=tips[:, :3, 3], directions=directions)
        proved = {sn.Status.OUT_OF_REACH, sn.Status.TARGET_BLOCKED, sn.Status.BASE_BLOCKED}
        assert not proved & set(many.status.tolist())


def test_obstacles_only_take_away(found: sn.studies.Reach) -> None:
    assert (found.share <= found.free_share).all()
    alone = sn.studies.reach(ROBOT, None, 20.0)
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


def test_neighbours_find_what_the_arc_does_not() -> None:
    robot = sn.Robot.uniform(4, length=(45, 70), max_bend=2.4, radius=4)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rounds, "TRIES", 0)
        without = sn.studies.reach(robot, WALL, 40.0, 6)
    found = sn.studies.reach(robot, WALL, 40.0, 6)
    gained = (found.verdicts == Verdict.SOLVED) & (without.verdicts != Verdict.SOLVED)
    assert not ((without.verdicts == Verdict.SOLVED) & (found.verdicts != Verdict.SOLVED)).any()
    assert gained.any()


def test_a_base_that_is_blocked_is_said_of_all() -> None:
    blocked = sn.studies.reach(ROBOT, [sn.Sphere((0, 0, 0), radius=10)], 60.0, 6)
    told = set(np.unique(blocked.verdicts[blocked.free == Verdict.SOLVED]).tolist())
    assert told <= {int(Verdict.BASE_BLOCKED), int(Verdict.TARGET_BLOCKED)}
    assert blocked.volume().found == 0.0


def test_wherever_it_ends_the_same_call_goes_on(
    found: sn.studies.Reach, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (find, rounds):
        monkeypatch.setattr(module, "CALL_SIZE", 3000)
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
    ("key", "options"),
    [
        ("seed", {"seed": 1}),
        ("directions", {"directions": 6}),
        ("low", {"low": (-20, -20, 0)}),
        ("high", {"high": (0, 0, 60)}),
    ],
)
def test_a_map_that_was_begun_otherwise_is_refused_by_name(key: str, options: dict[str, Any], tmp_path: Path) -> None:
    box: dict[str, Any] = {"low": (-20, 0, 0), "high": (20, 0, 60), "out": tmp_path / "map.npz"}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sn.studies.Reach, "save", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            made(**box)
    with pytest.raises(sn.InputError, match=rf"^{key}: .*changed since this map began"):
        made(**(box | options))


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"spacing": 0.0}, "spacing"),
        ({"spacing": 0.01}, "spacing"),
        ({"spacing": 20.0, "directions": 0}, "directions"),
        ({"spacing": 20.0, "directions": [[0.0, 0.0, 0.0]]}, "directions"),
        ({"low": (0, 0, 0), "high": (-1, 0, 0)}, "high"),
        ({"low": (1, 1, 1), "high": (2, 2, 2), "spacing": 20.0}, "spacing"),
        ({"workers": 0}, "workers"),
        ({"time": -1.0}, "time"),
        ({"out": f"{__file__}/map.npz", "spacing": 60.0}, "out"),
    ],
)
def test_wrong_arguments_are_refused(options: dict[str, object], key: str) -> None:
    with pytest.raises(sn.InputError, match=rf"^{key}"):
        sn.studies.reach(ROBOT, None, **options)  # type: ignore[arg-type]
