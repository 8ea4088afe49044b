"""Contacts of the body, and the proof that it has none, against dense sampling."""

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.body import proof
from sinuous.kernels.body.contacts import PER_SEGMENT, ContactSearch, PosedBody
from sinuous.kernels.body.contacts import contacts as kernel_contacts
from sinuous.kernels.body.pieces import Scratch, near
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.body.rows import INNER
from sinuous.kernels.fields.solids import EXACT
from sinuous.kernels.tables import ROUNDOFF
from sinuous.scene.obstacles import Obstacle
from tests.helpers import (
    Floats,
    columns_of,
    configurations,
    expm_chain,
    frames_of,
    kernel_scene,
    make_rows,
    random_pose,
    random_rotation,
)
from tests.kernels.workspace import NEVER, make_clock

SAMPLES = 120
SLACK = 0.1
FINEST = 1e-7
RADII = (0.2, 0.1, 0.15, 0.05)
ROBOT = sn.Robot([sn.Segment((0.0, 3.0), 2 * math.pi, radius=radius) for radius in RADII])
N = len(ROBOT)


def random_scene(rng: np.random.Generator, reach: float) -> sn.Scene:
    """Obstacles of all kinds, as far away as `reach` on average."""
    obstacles: list[Obstacle] = []
    for _ in range(rng.integers(1, 8)):
        at = rng.normal(size=3) * reach
        to, size, turn = at + rng.normal(size=3), rng.uniform(0.1, 0.6), random_rotation(rng)
        drawn: tuple[Obstacle, ...] = (
            sn.Sphere(at, size),
            sn.Box(at, rng.uniform(0.1, 1.0, 3), turn),
            sn.Capsule(at, to, size),
            sn.Cylinder(at, to, size),
            sn.HalfSpace(at, -at),
            sn.Sphere((0, 0, 0), 2.0 * reach, inside=True),
            sn.Box((0, 0, 0), np.full(3, 4.0 * reach), turn, inside=True),
        )
        obstacles.append(drawn[rng.integers(len(drawn))])
    return sn.Scene(obstacles)


def sampled(q: Floats, scene: sn.Scene, mount: float = 0.0) -> tuple[float, float]:
    """Least clearance over many places of the body beyond the mount, and how far apart these are."""
    least, spacing = math.inf, 0.0
    reach = 0.0
    points = ROBOT.backbone(q, SAMPLES)
    for k, length in enumerate(q[:, 2]):
        arc = reach + length * np.linspace(0.0, 1.0, SAMPLES + 1)
        own = points[k * SAMPLES : (k + 1) * SAMPLES + 1][arc >= mount]
        if len(own) and (arc[-1] > mount or arc[0] >= mount):
            least = min(least, float((scene.distance(own) - RADII[k]).min()))
            spacing = max(spacing, length / SAMPLES)
        reach += length
    return least, spacing


def test_those_that_may_be_near_are_listed_and_the_others_are_no_nearer_than_their_bound() -> None:
    """Distances as uncertain as rounding makes them, which here is much."""
    obstacles = [sn.Sphere((x, 0.0, 0.0), 0.5) for x in (5.0, 1.0, 3.0, 2.0)]
    scene = kernel_scene(sn.Scene(obstacles))
    scene.table[:, ROUNDOFF] = [0.1, 0.1, 0.3, 0.1]
    among = np.zeros(len(obstacles), np.int64)
    for reach, listed, rest in ((1.5, [1, 3], 2.2), (1.4, [1], 1.4), (0.4, [], 0.4), (9.0, [0, 1, 2, 3], math.inf)):
        count, others = near(scene, (0.0, 0.0, 0.0), reach, among)
        assert among[:count].tolist() == listed
        assert others == pytest.approx(rest)


def prove(
    q: Floats, scene: sn.Scene, mount: float = 0.0, slack: float = SLACK, deadline: int = NEVER
) -> tuple[int, float, int, float, int]:
    scratch = Scratch(np.empty(len(scene), np.int64), make_clock(deadline))
    return proof.prove(ROBOT.limits, q, frames_of(q), kernel_scene(scene), mount, slack, FINEST, scratch)


@pytest.mark.parametrize("reach", [0.7, 2.0, 5.0])
@pytest.mark.parametrize("mount", [0.0, 0.5, 2.2])
def test_the_proof_agrees_with_dense_sampling(reach: float, mount: float) -> None:
    rng = np.random.default_rng(round(10 * reach))
    verdicts = []
    for q in configurations(5, N, 25):
        scene = random_scene(rng, reach)
        verdict, clearance, where, fraction, which = prove(q, scene, mount)
        least, spacing = sampled(q, scene, mount)
        verdicts.append(verdict)
        assert verdict != UNDECIDED
        if verdict == CLEAR:
            assert 0.0 < clearance <= least + 1e-12
            # The truth is between the least sample and half a spacing below it.
            assert clearance >= (1.0 - SLACK) * (least - 0.5 * spacing) - FINEST
        else:
            assert verdict == TOUCHING
            assert clearance < 0.0
            assert least < 0.5 * spacing
        if verdict == TOUCHING or which >= 0:
            place = expm_chain(np.concatenate([q[:where], q[where : where + 1] * fraction]))[-1][:3, 3]
            assert q[:where, 2].sum() + fraction * q[where, 2] >= mount - 1e-12
            seen = scene.distance(place) - RADII[where]
            assert scene.nearest(place) == which
            assert seen == pytest.approx(clearance, abs=1e-12) if verdict == TOUCHING else seen >= clearance - 1e-12
    assert verdicts.count(CLEAR) >= 3
    assert verdicts.count(TOUCHING) >= 3


def straight(length: float = 1.0) -> Floats:
    return np.array([[0.0, 0.0, length]] * N)


def test_what_is_too_close_to_tell_is_not_called_clear() -> None:
    for gap, verdict in (
        (1e-3, CLEAR),
        (1e-5, CLEAR),
        (1e-9, CLEAR),
        (1e-14, UNDECIDED),
        (0.0, UNDECIDED),
        (-1e-9, TOUCHING),
        (-1e-3, TOUCHING),
    ):
        got, clearance, *_ = prove(straight(), sn.Scene([sn.HalfSpace((0.2 + gap, 0, 0), (-1, 0, 0))]))
        assert got == verdict
        assert clearance <= gap + 1e-15


def test_obstacles_do_not_concern_what_sits_in_the_mount() -> None:
    scene = sn.Scene([sn.Box((0, 0, 0), (1, 1, 2.5))])  # up to z = 1.25; the second segment has radius 0.1
    assert prove(straight(), scene, mount=0.0)[0] == TOUCHING
    assert prove(straight(), scene, mount=1.2)[0] == TOUCHING
    assert prove(straight(), scene, mount=1.34)[0] == TOUCHING
    verdict, clearance, *_ = prove(straight(), scene, mount=1.36)
    assert verdict == CLEAR
    assert 0.008 <= clearance <= 0.01 + 1e-12
    assert prove(straight(), scene, mount=4.1)[:2] == (CLEAR, math.inf)


def test_a_proof_ends_with_the_time() -> None:
    """In a hole whose wall the body grazes it takes many looks; what takes few is proved before it is read."""
    for gap, said in ((0.1, CLEAR), (1e-3, UNDECIDED)):
        grazed = sn.Scene([sn.Box((0, 0, 0), (0.4 + 2.0 * gap, 20, 20), inside=True)])
        assert prove(straight(), grazed)[0] == CLEAR
        assert prove(straight(), grazed, deadline=0)[0] == said
    assert prove(straight(), sn.Scene([sn.HalfSpace((0.1, 0, 0), (-1, 0, 0))]), deadline=0)[0] == TOUCHING


def contacts(
    q: Floats, frames: Floats, scene: sn.Scene, k: int, margins: tuple[float, float], depth: int, mount: float = 0.0
) -> tuple[Any, int, float]:
    rows: Any = make_rows(len(q), PER_SEGMENT)
    scratch = Scratch(np.empty(len(scene), np.int64), make_clock())
    own = PosedBody(ROBOT.limits, q, frames, 2.0)
    at, least = kernel_contacts(
        own, kernel_scene(scene), k, mount, ContactSearch(*margins, depth, EXACT), scratch, rows, 0
    )
    return rows, at, least


@pytest.mark.parametrize("depth", [0, 2, 3])
@pytest.mark.parametrize("margin", [0.0, 0.05])
def test_every_place_that_is_too_close_gets_a_row(depth: int, margin: float) -> None:
    rng = np.random.default_rng(depth)
    found = 0
    for q in configurations(7, N, 25):
        scene = random_scene(rng, 1.0)
        for k in range(N):
            mount = 0.3 if k == 0 else 0.0
            rows, at, least = contacts(q, frames_of(q), scene, k, (margin, 0.0), depth, mount=mount)
            start = min(1.0, mount / q[k, 2]) if mount and q[k, 2] else float(mount > 0)
            if start == 1.0:
                assert at == 0
                continue
            parts = (np.arange(2**depth) + 0.5) / 2**depth * (1 - start) + start
            places = [expm_chain(np.concatenate([q[:k], q[k : k + 1] * s]))[-1][:3, 3] for s in parts]
            each = np.array([sn.Scene([o]).distance(places) for o in scene.obstacles]).reshape(-1, len(places)).T
            gaps = RADII[k] + margin - each.ravel()
            expected = np.sort(gaps[gaps > 0.0])
            if abs(gaps).min(initial=1.0) < 1e-9 or len(expected) > PER_SEGMENT:
                continue
            found += at
            np.testing.assert_allclose(np.sort(rows.value[:at]) * 2.0, expected, atol=1e-10)
            assert (rows.kind[:at] == INNER).all()
            if len(expected):
                assert least == pytest.approx(each.min() - RADII[k], abs=1e-10)
            else:
                assert least >= margin - 1e-12
    assert found > 30


def test_rows_are_never_more_than_there_is_room_for() -> None:
    q = straight()
    scene = sn.Scene([sn.Sphere((0.0, 0.0, 0.1 * i), 0.5) for i in range(12)])
    rows, at, least = contacts(q, frames_of(q), scene, 0, (0.0, 0.0), 3)
    assert at == PER_SEGMENT
    assert least < -0.5
    assert (rows.value[:at] > 0).all()


@pytest.mark.parametrize("seed", range(6))
def test_contact_rows_are_the_derivative_of_the_distance(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, base = configurations(seed, N, 1)[0] + [0.0, 0.0, 0.1], random_pose(rng)
    k = seed % N
    mount = 0.03 if seed % 2 else 0.0
    start = mount / q[k, 2]
    s = start + 0.5 * (1 - start)

    def place(x: Floats) -> Floats:
        return np.asarray(expm_chain(np.concatenate([x[:k], s * x[k : k + 1]]), base)[-1][:3, 3])

    at = place(q)
    offset = random_rotation(rng)
    scene = sn.Scene(
        [sn.Sphere(at + 0.3 * offset[0], 0.2), sn.Capsule(at + 0.4 * offset[1], at + 0.5 * offset[2], 0.3)]
    )
    rows, count, _ = contacts(q, frames_of(q, base), scene, k, (0.5, 0.0), 0, mount)
    assert count == 2
    for i in range(2):
        single = sn.Scene(scene.obstacles[i : i + 1])
        slope = np.zeros((N, 3))
        for j in range(3 * N):
            step = np.zeros((N, 3))
            step.flat[j] = 1e-6
            slope.flat[j] = (single.distance(place(q + step)) - single.distance(place(q - step))) / 2e-6
        assert rows.value[i] == pytest.approx((RADII[k] + 0.5 - single.distance(at)) / 2.0, abs=1e-12)
        seen = np.zeros((N, 3))
        seen[: k + 1] = columns_of(q, base)[: k + 1].reshape(-1, 3, 6) @ rows.twist[i]
        seen[k] += rows.inner[i]
        np.testing.assert_allclose(seen, slope / 2.0, atol=1e-8)


def large_obstacle(kind: str, size: float, off: float) -> tuple[Obstacle, Fraction]:
    """An obstacle of this size beside the z axis, about `off` from it, and how far that is exactly."""
    at = size + off
    start, end = (at, 0.0, -size), (at, 0.0, size)
    kinds: dict[str, Obstacle] = {
        "sphere": sn.Sphere((at, 0.0, 0.0), size),
        "capsule": sn.Capsule(start, end, size),
        "cylinder": sn.Cylinder(start, end, size),
        "box": sn.Box((at, 0.0, 0.0), (2.0 * size, 2.0 * size, 2.0 * size)),
        "half_space": sn.HalfSpace((off, size, -size), (-1.0, 0.0, 0.0)),
        "far": sn.Sphere((off + 1.0, 0.0, 0.0), 1.0),
    }
    obstacle = kinds[kind]
    if kind == "half_space":
        return obstacle, Fraction(off)
    return obstacle, Fraction(off + 1.0) - 1 if kind == "far" else Fraction(at) - Fraction(size)


@pytest.mark.parametrize("kind", ["sphere", "capsule", "cylinder", "box", "half_space", "far"])
@pytest.mark.parametrize("size", [1e4, 1e8, 1e12, 1e15])
def test_nothing_is_clear_of_obstacles_with_huge_coordinates_that_it_overlaps(kind: str, size: float) -> None:
    """Rounding of a distance is that of the coordinates that are subtracted, not that of the robot."""
    q = np.array([[0.0, 0.0, 0.5]] * N)
    rng, verdicts = np.random.default_rng(8), []
    for _ in range(60):
        off = max(RADII) + size * 1e-16 * float(rng.uniform(-4.0, 4.0))
        obstacle, away = large_obstacle(kind, size, off)
        verdict = prove(q, sn.Scene([obstacle]), slack=1.0)[0]
        assert verdict != CLEAR or away > Fraction(max(RADII))
        verdicts.append(verdict)
    ample, _ = large_obstacle(kind, size, max(RADII) + 1e-12 * size)
    assert prove(q, sn.Scene([ample]), slack=1.0)[0] == CLEAR
    assert kind == "far" or size < 1e6 or CLEAR not in verdicts
