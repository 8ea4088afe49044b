"""The tube that an elbow lies in: followed from there to both mouths."""

import numpy as np
import pytest

from benchmarks.places.parts.surfaces import blind_bore, open_tube, solid
from sinuous import Scene, pose
from sinuous.kernels.tables import QUERY_LONGEST, QUERY_RADIUS, QUERY_WIDTH
from sinuous.solving.polylines import lengths_along
from sinuous.solving.routing.elbows.inside import Inside, tube_of
from tests.helpers import Floats

RADIUS = 0.1
TURN = 2.0
"""Radius of the axis of the bent pipe."""


def bent_pipe() -> tuple[Scene, Floats]:
    """A quarter of a circle in the plane of x and z, and its frames."""
    angles = np.linspace(0.0, 0.5 * np.pi, 31)
    frames = np.array(
        [pose((TURN * (1.0 - np.cos(a)), 0.0, TURN * np.sin(a)), direction=(np.sin(a), 0.0, np.cos(a))) for a in angles]
    )
    return Scene([solid(open_tube(frames, 1.5 * RADIUS, 2.3 * RADIUS), "pipe")]), frames


def found(scene: Scene, elbow: Floats) -> Inside | None:
    query = np.zeros(QUERY_WIDTH)
    query[QUERY_RADIUS], query[QUERY_LONGEST] = RADIUS, 10.0
    return tube_of(scene.snapshot()._kernel_group, query, elbow, scene.distance, 60.0)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("aside", [0.0, 0.3 * RADIUS])
def test_both_mouths_are_as_far_as_the_pipe_is_long(share: float, aside: float) -> None:
    scene, frames = bent_pipe()
    frame = frames[round(share * (len(frames) - 1))]
    tube = found(scene, frame[:3, 3] + aside * frame[:3, 1])
    assert tube is not None
    ends, length = (tube.one[-1], tube.other[-1]), 0.5 * np.pi * TURN
    lengths = lengths_along(tube.one)[-1], lengths_along(tube.other)[-1]
    if np.linalg.norm(ends[0] - frames[0, :3, 3]) > np.linalg.norm(ends[1] - frames[0, :3, 3]):
        ends, lengths = ends[::-1], lengths[::-1]
    assert lengths == pytest.approx((share * length, (1.0 - share) * length), abs=3.0 * RADIUS)
    assert np.linalg.norm(ends[0] - frames[0, :3, 3]) < 3.0 * RADIUS
    assert np.linalg.norm(ends[1] - frames[-1, :3, 3]) < 3.0 * RADIUS
    assert abs(tube.along @ frame[:3, 2]) > 0.95


def test_the_tangent_leads_from_the_first_mouth_to_the_other() -> None:
    scene, frames = bent_pipe()
    tube = found(scene, frames[15, :3, 3])
    assert tube is not None
    other = tube.turned()
    assert tube.along @ (tube.other[3] - tube.one[3]) > 0.0
    assert other.along @ (other.other[3] - other.one[3]) > 0.0
    assert np.array_equal(other.one, tube.other)


def test_there_is_none_in_the_open_or_in_a_blind_bore() -> None:
    scene, frames = bent_pipe()
    assert found(scene, frames[15, :3, 3] + [0.0, 5.0, 0.0]) is None
    assert found(Scene(), np.zeros(3)) is None
    bore = Scene([solid(blind_bore(np.eye(4), 1.5 * RADIUS, 2.0, 0.6, RADIUS), "block")])
    assert found(bore, np.array([0.0, 0.0, 1.0])) is None
