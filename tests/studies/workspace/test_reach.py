"""What a map tells: shares, volumes with their error, reasons, and files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.problem.target import Workspace, directions_of
from sinuous.studies.workspace.reach import Codes, Verdict, Voxels, reach_of
from tests.helpers import refused
from tests.studies.workspace.maps import ROBOT


def ball(radius: float, spacing: float) -> sn.studies.Reach:
    """A map of a ball that is reached in both of two directions, and of a shell of which nothing is known."""
    count = int(radius / spacing) + 4
    voxels = Voxels((-count * spacing,) * 3, spacing, (2 * count + 1,) * 3)
    far = np.linalg.norm(voxels.middles, axis=-1)[..., None] * np.ones(2)
    inner = np.where(far <= radius + spacing, Verdict.LIMITS, Verdict.OUT_OF_REACH)
    verdicts = np.where(far <= radius, Verdict.SOLVED, inner).astype(np.uint8)
    verdicts[..., 1][verdicts[..., 1] == Verdict.LIMITS] = Verdict.OUT_OF_REACH
    return mapped(voxels, np.eye(3)[:2], verdicts, sampled=False)


def mapped(voxels: Voxels, directions: Floats, verdicts: Codes, *, sampled: bool) -> sn.studies.Reach:
    """A map of these verdicts."""
    some = (verdicts == Verdict.SOLVED).any(axis=-1)
    places = np.where(some, Verdict.SOLVED, verdicts.max(axis=-1)).astype(np.uint8)
    return sn.studies.Reach(
        voxels=voxels,
        directions=directions,
        within=None,
        sampled=sampled,
        positions=places,
        free_positions=places.copy(),
        verdicts=verdicts,
        free=verdicts.copy(),
        obstacles=np.full(voxels.shape, -1, np.int16),
        names=(),
        base=np.zeros(3),
        seconds=0.0,
    )


@pytest.mark.parametrize("spacing", [1.0, 0.5])
def test_the_volume_of_a_ball_is_within_its_error(spacing: float) -> None:
    volume = ball(8.0, spacing).volume()
    true = 4.0 / 3.0 * np.pi * 8.0**3
    assert abs(volume.found - true) < volume.error < 0.35 * true
    assert volume.at_most > volume.found
    dexterous = ball(8.0, spacing).volume(dexterous=True)
    assert dexterous.found == volume.found == dexterous.at_most


def test_shares_reasons_and_proofs_agree(found: sn.studies.Reach) -> None:
    assert ((found.share == 1.0) == (found.reasons == Verdict.SOLVED)).all()
    assert (found.reachable >= found.dexterous).all()
    assert found.volume().found == found.reachable.sum() * 20.0**3
    assert found.proved[0, 0, 0]
    assert sum(found.to_dict()["verdicts"].values()) == found.verdicts.size
    assert json.loads(json.dumps(found.to_dict()))["directions"] == 26
    assert "reachable" in str(found)
    assert "of the" not in repr(found)


def test_saved_and_loaded_is_equal(found: sn.studies.Reach, tmp_path: Path) -> None:
    found.save(tmp_path / "map.npz")
    assert sn.studies.Reach.load(tmp_path / "map.npz").equals(found)
    for bad in (b"no map", b""):
        (tmp_path / "bad.npz").write_bytes(bad)
        refused("reach", lambda: sn.studies.Reach.load(tmp_path / "bad.npz"), "expected a map that")
    np.savez(tmp_path / "other.npz", q=np.zeros(3))
    refused("reach", lambda: sn.studies.Reach.load(tmp_path / "other.npz"), "expected a map that")
    refused("reach", lambda: sn.studies.Reach.load(tmp_path / "no.npz"), "cannot be read")
    refused("file", lambda: found.save(tmp_path / "no" / "map.npz"), "cannot be written")


def test_farther_than_the_robot_is_long_it_is_out_of_reach_and_else_outside_it_is_refused(
    found: sn.studies.Reach,
) -> None:
    assert found.why((1000, 0, 0)) == {"out_of_reach": len(found.directions)}
    refused("point", lambda: found.in_the_way((1000, 0, 0)), "outside the map")
    part = sn.studies.reach(sn.Robot.uniform(2, 50.0, 1.0), None, 25.0, 6, low=(0, 0, 0), high=(0, 0, 100))
    refused("point", lambda: part.why((50, 0, 50)), "outside the map")


def test_a_voxel_is_about_the_base_and_all_hold_the_reach() -> None:
    robot = ROBOT.changed(base=sn.pose((3, -4, 5)), tool=sn.pose((0, 0, 7)))
    voxels = Voxels.about(robot, Workspace(10.0))
    assert reach_of(robot) == 127.0
    assert voxels.shape == (25, 25, 25)
    np.testing.assert_allclose(voxels.middles[12, 12, 12], (3, -4, 5))
    assert Voxels.about(robot, Workspace()).shape == (71, 71, 71)


def test_corners_make_a_slice() -> None:
    voxels = Voxels.about(ROBOT, Workspace(10.0, low=(-30, 0, 0), high=(30, 0, 50)))
    assert voxels.shape == (7, 1, 6)


@pytest.mark.parametrize("count", [0, 1, 6, 26, 100])
def test_directions_are_unit_vectors_all_round(count: int) -> None:
    axes = directions_of(count)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=1), 1.0)
    assert axes.shape == (count, 3)
    assert len(np.unique(axes.round(9), axis=0)) == count
    if count > 1:
        assert np.linalg.norm(axes.mean(axis=0)) < 0.2


def test_a_map_of_positions_has_no_directions(positions: sn.studies.Reach, tmp_path: Path) -> None:
    assert positions.directions.shape == (0, 3)
    np.testing.assert_array_equal(positions.verdicts[..., 0], positions.positions)
    assert "dexterous" not in positions.to_dict()["volumes"]
    assert "positions" in str(positions)
    refused("directions", lambda: positions.volume(dexterous=True), "map of positions")
    positions.save(tmp_path / "map.npz")
    assert sn.studies.Reach.load(tmp_path / "map.npz").equals(positions)


def test_directions_take_nothing_from_positions(found: sn.studies.Reach, positions: sn.studies.Reach) -> None:
    assert (found.reachable >= positions.reachable).all()
    assert (found.reachable >= (found.share > 0.0)).all()
    assert found.volume().found > found.volume(dexterous=True).found


@pytest.mark.parametrize("count", [8, 26, 100])
def test_the_error_of_all_directions_covers_those_between(count: int) -> None:
    """A place is reached in a direction where it is behind a plane across it: in all directions it is in a ball."""
    voxels, axes = Voxels((-12.0,) * 3, 1.0, (25, 25, 25)), directions_of(count)
    verdicts = np.where(voxels.middles @ axes.T <= 8.0, Verdict.SOLVED, Verdict.OUT_OF_REACH).astype(np.uint8)
    found = mapped(voxels, axes, verdicts, sampled=True)
    volume, ball_volume = found.volume(dexterous=True), 4.0 / 3.0 * np.pi * 8.0**3
    assert abs(volume.found - ball_volume) <= volume.error
    given = mapped(voxels, axes, verdicts, sampled=False).volume(dexterous=True)
    assert given.found == volume.found
    assert given.error < volume.error  # directions that are given stand for no others


@pytest.mark.parametrize(
    ("arguments", "key", "words"),
    [
        ({"within": 0.3}, "within", "no direction is asked for"),
        ({"directions": (0, 0, 1), "within": 20}, "within", "expected an angle up to pi, rad (20 degrees are 0.349)"),
        ({"directions": -1}, "directions", ""),
    ],
)
def test_a_question_that_cannot_be_meant_is_refused(arguments: dict[str, Any], key: str, words: str) -> None:
    refused(key, lambda: Workspace(**arguments), words)
