"""The worst constraint is what is missed by most, in comparable units; contacts are found, with right gradients."""

import json
from dataclasses import replace

import numpy as np
import pytest

import sinuous as sn
from sinuous import Box, Problem, Robot, Sphere, Target, pose
from sinuous.answer.verification import verify
from sinuous.answer.worst import Worst, contacts_of, find_overlap, find_worst
from sinuous.measures.body import BodyPlace, least_clearance, segment_ends
from tests.helpers import Floats, present, refused, with_each

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), 1.0, radius=0.1)
UNITS = {"angle": 1.0, "bend": 1.0, "curvature": 1.0}
"""What counts in rad; all others are lengths, and count in mean lengths of the robot."""


@with_each("seed", range(12))
def test_nothing_is_missed_by_more(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = np.column_stack([rng.normal(0.0, 0.6, (2, 2)), rng.uniform(0.7, 1.3, 2)])
    place = ROBOT.tip(q)[:3, 3] + rng.normal(0.0, 0.1, 3)
    problem = sn.Problem(ROBOT, sn.Target(place, direction=rng.normal(size=3)), [sn.Sphere(place, 0.2, name="ball")])
    worst, slow = find_worst(problem, q, False), verify(problem, q)
    unit = ROBOT.mean_length
    missed = [slow.position_error / unit, slow.angle_error, -slow.clearance / unit]
    missed += [amount / UNITS.get(name, unit) for name, _, amount in ROBOT.violations(q)]
    assert worst.amount / UNITS.get(worst.constraint, unit) == pytest.approx(max(missed), rel=1e-2)
    overlap = find_overlap(ROBOT, problem.scene, q)
    assert overlap.obstacle == "ball"
    assert overlap.amount == pytest.approx(-slow.clearance, abs=1e-3)


def test_it_is_read_as_it_was_written() -> None:
    worst = Worst("clearance", 2, "ball", 0.125)
    assert Worst.from_dict(worst.to_dict()) == worst
    refused("worst", lambda: Worst.from_dict({"constraint": "clearance"}))
    refused("worst", lambda: Worst.from_dict(None))
    there = replace(worst, place=BodyPlace((0.1, 0.2, 0.3), 2, 0.5), step=3, time=2.5)
    assert Worst.from_dict(json.loads(json.dumps(there.to_dict()))) == there
    refused("place", lambda: Worst.from_dict({**worst.to_dict(), "place": {"segment": 1}}))


@pytest.mark.parametrize("seed", range(6))
def test_places_are_where_they_say(seed: int) -> None:
    """A body that is cut off at the share of its segment ends at the position; there the clearance is what it says."""
    q = random_q(seed)
    problem = asked(seed, q)
    worst, contacts = find_overlap(CONTACTS_ROBOT, problem.scene, q), contacts_of(problem, q)
    said = [(worst.place, -worst.amount), *((each.place, each.clearance) for each in contacts)]
    for place, clearance in said:
        assert place is not None
        assert place.segment is not None
        part = q.copy()
        part[place.segment - 1] *= present(place.share)
        assert place.position == pytest.approx(CONTACTS_ROBOT.forward(part)[place.segment - 1, :3, 3], abs=1e-9)
        assert float(problem.scene.distance(place.position)) - 0.06 <= clearance + 1e-9
    assert (worst.place.segment if worst.place else None) == worst.segment


def test_a_place_is_said_as_people_read_it() -> None:
    assert str(BodyPlace((1e-15, 0.25, -12.5), 2, 0.396)) == "at (0, 0.25, -12.5), 40 % along segment 2"
    assert str(BodyPlace((0.0, 0.0, 0.0), 1, 0.0)) == "at (0, 0, 0), at the beginning of segment 1"
    assert str(BodyPlace((1234567.0, 0.0, 3.0), 3, 1.0)) == "at (1.235e+06, 0, 0), at the end of segment 3"
    assert str(BodyPlace((1.0, 2.0, 3.0))) == "at (1, 2, 3)"
    mixed = Worst("clearance", 2, "ball", 0.125, place=BodyPlace((1.0, 2.0, 3.0), 2, 0.5), step=3, time=2.5)
    said = "step 3, at time 2.5: segment 2 lacks 0.125 of clearance from ball, at (1, 2, 3), 50 % along segment 2"
    assert str(mixed) == said


def test_of_a_body_of_arcs_a_place_is_on_the_segment_that_they_are_of() -> None:
    owners, lengths = [1, 1, 2, 2, 2], np.array([1.0, 1.0, 0.5, 0.5, 1.0])
    assert BodyPlace((0, 0, 0), 2, 0.5).on_robot(owners, lengths) == BodyPlace((0, 0, 0), 1, 0.75)
    assert BodyPlace((0, 0, 0), 5, 0.5).on_robot(owners, lengths) == BodyPlace((0, 0, 0), 2, 0.75)
    assert BodyPlace((0, 0, 0)).on_robot(owners, lengths) == BodyPlace((0, 0, 0))


CONTACTS_ROBOT = Robot.uniform(
    4, (0.5, 1.0), 2.5, radius=0.06, base=pose((0.1, 0.2, 0.3), direction=(1, 1, 1)), mount=0.1
)


def random_q(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.normal(0.0, 0.9, (4, 2)), rng.uniform(0.5, 1.0, 4)])


def asked(seed: int, q: Floats) -> Problem:
    rng = np.random.default_rng(seed)
    places = CONTACTS_ROBOT.backbone(q, 50)[rng.integers(20, 200, 3)]
    balls = [Sphere(place + rng.normal(0.0, 0.08, 3), 0.1, name=f"ball{i}") for i, place in enumerate(places)]
    return Problem(CONTACTS_ROBOT, Target((0, 0, 0)), [*balls, Box((9, 9, 9), (1, 1, 1))])


@with_each("seed", range(12))
def test_the_deepest_contact_is_the_least_clearance(seed: int) -> None:
    q = random_q(seed)
    problem = asked(seed, q)
    least = least_clearance(CONTACTS_ROBOT, problem.scene, q, segment_ends(CONTACTS_ROBOT, q))
    found = contacts_of(problem, q)
    assert (found != []) == (least.distance <= 1e-3 * CONTACTS_ROBOT.mean_length)
    if found:
        assert found[0].clearance == pytest.approx(least.distance, abs=2e-3)
        assert found[0].obstacle != "box[3]"


@pytest.mark.parametrize("seed", range(6))
def test_gradients_are_derivatives_of_the_clearance(seed: int) -> None:
    """A contact moves along the body as the shape changes, so places inside a segment need a wide margin of error."""
    q = random_q(seed)
    problem = asked(seed, q)
    for contact in contacts_of(problem, q)[:1]:
        numbers = []
        for step in 1e-5 * np.eye(12).reshape(12, 4, 3):
            more, less = (
                least_clearance(
                    CONTACTS_ROBOT,
                    problem.scene.without([]),
                    q + sign * step,
                    segment_ends(CONTACTS_ROBOT, q + sign * step),
                ).distance
                for sign in (1.0, -1.0)
            )
            numbers.append((more - less) / 2e-5)
        along = float(np.dot(contact.gradient, numbers)) / float(np.linalg.norm(numbers) ** 2)
        assert along == pytest.approx(1.0, abs=0.25)


def test_what_sits_in_the_mount_is_no_contact() -> None:
    base = [Sphere(CONTACTS_ROBOT.base[:3, 3], 0.03, name="socket")]
    q = np.array([[0.0, 0.0, 0.8]] * 4)
    assert contacts_of(Problem(CONTACTS_ROBOT, Target((0, 0, 0)), base), q) == []
