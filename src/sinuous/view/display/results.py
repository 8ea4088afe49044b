"""What is said of an answer: in the title of a picture, in a notebook, on a page."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.base.errors import counted, duration
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion, left_in_words, reached_in_words
from sinuous.motion.timing import largest, motor_speeds
from sinuous.scene.snapshot import Snapshot
from sinuous.statics.body import body_of
from sinuous.statics.rest import bodies_at

STARTS = {
    "given": "the initial configuration",
    "arc": "a single arc",
    "random": "a random configuration",
    "route": "a route through free space",
    "remembered": "a configuration in the memory",
}
"""What sentences call the kinds of starts."""


def status_in_words(status: str) -> str:
    """A status in words: `out of reach`."""
    return str(status).replace("_", " ")


def caption_of(answers: Sequence[Solution | Motion]) -> str:
    """What answers say, in one line."""
    if len(answers) > 1:
        return f"{sum(answer.solved for answer in answers)} of {len(answers)} solved"
    answer = answers[0]
    clear = "" if answer.clearance is None else f", clearance at least {answer.clearance:.3g}{confidence_of(answer)}"
    if isinstance(answer, Solution) or not answer.solutions:
        return f"{status_in_words(answer.status)}{clear}, {duration(answer.seconds)}"
    begun = "" if answer.solved else f"{status_in_words(answer.status)}: "
    return f"{begun}{left_in_words(answer) or reached_in_words(answer)}{clear}"


def confidence_of(answer: Solution | Motion) -> str:
    """At which level a clearance is proved: ` at 95 %`; nothing where the body is where the model says."""
    unsure = answer.robot.uncertainty
    return "" if unsure is None else f" {unsure.confidence}"


def describe_solutions(solutions: Sequence[Solution]) -> list[str]:
    """A line for each of several solutions, by which people tell them apart: `2: bends 1.2 rad, clearance 0.3`.

    It says how much a body bends in all, how long it is where lengths differ, its clearance, and where its middle is
    when another line would be the same.
    """
    lengths = [f"{solution.configuration[:, 2].sum():.3g}" for solution in solutions]
    lines = []
    for solution, length in zip(solutions, lengths, strict=True):
        bends = f"bends {np.hypot(solution.configuration[:, 0], solution.configuration[:, 1]).sum():.3g} rad"
        clear = format_number(solution.clearance, before="clearance ")
        lines.append(", ".join(filter(None, [bends, f"length {length}" if len({*lengths}) > 1 else "", clear])))
    found = []
    for i, (solution, line) in enumerate(zip(solutions, lines, strict=True), 1):
        body = solution.problem.robot.backbone(solution.configuration, 2)
        x, y, z = body[len(body) // 2]
        found.append(f"{i}: {line}" + (f", by ({x:.3g}, {y:.3g}, {z:.3g})" if lines.count(line) > 1 else ""))
    return found


def rows_of(answer: Solution | Motion) -> dict[str, str]:
    """What holds of an answer, as rows of a table: a label, and a value."""
    rows = _of_solution(answer) if isinstance(answer, Solution) else _of_motion(answer)
    return {label: value for label, value in rows.items() if value}


def format_number(value: float | None, behind: str = "", before: str = "") -> str:
    """A number with three digits between two texts; nothing where there is none, or it is infinite."""
    return "" if value is None or value == float("inf") else f"{before}{value:.3g}{behind}"


def _of_solution(solution: Solution) -> dict[str, str]:
    tolerance = solution.problem.tolerance
    effort = f"{counted(solution.iterations, 'iteration')}, {counted(solution.starts, 'start')}"
    return {
        "because": "" if solution.solved else solution.sentence,
        "worst": "" if solution.worst is None else str(solution.worst),
        "position error": format_number(solution.position_error, f" (tolerance {tolerance.position:.3g})"),
        "angle error": format_number(solution.angle_error, f" rad (tolerance {tolerance.angle:.3g})"),
        "clearance": format_number(solution.clearance, f", proved{confidence_of(solution)}", "at least "),
        "self-clearance": format_number(solution.self_clearance, ", proved", "at least "),
        "tensions": _tensions(solution),
        "effort": f"{effort}, {duration(solution.seconds)}",
    }


def _tensions(solution: Solution) -> str:
    """The least and the largest tension; nothing where nothing pulls."""
    found = solution.tensions or {}
    if not found:
        return ""
    slack, tight = min(found, key=found.__getitem__), max(found, key=found.__getitem__)
    return f"{found[slack]:.3g} ({slack}) to {found[tight]:.3g} ({tight})"


def _of_motion(motion: Motion) -> dict[str, str]:
    moves, (bend, length) = len(motion.configuration) > 1, motion.largest_step
    between = f"{motion.between} clear" if motion.between == "proved" else motion.between
    times = f"{motion.times[0]:.4g} to {motion.times[-1]:.4g}, {len(motion.configuration)} knots" if moves else ""
    return {
        "target": reached_in_words(motion) if motion.solutions else "",
        "worst": "" if motion.worst is None else str(motion.worst),
        "left": left_in_words(motion),
        "between": between if moves else "",
        "time": times,
        "clearance": format_number(motion.clearance, confidence_of(motion)),
        "largest step": f"{bend:.3g} rad, {length:.3g} of length",
        "effort": duration(motion.seconds),
    }


def lengths_along(q: Floats, samples: int) -> Floats:
    """Lengths of backbone (..., n * samples + 1) from the base to evenly spaced places of every segment."""
    steps = np.repeat(q[..., 2] / samples, samples, axis=-1)
    return np.concatenate([np.zeros((*steps.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)


def radii_along(robot: Robot, samples: int) -> Floats:
    """Radii (n * samples + 1,) of the body there; where two segments meet, that of the second."""
    return np.append(np.repeat(robot.radii, samples), robot.radii[-1])


def clearances_along(robot: Robot, scene: Snapshot, q: Floats, samples: int, times: Floats | None = None) -> Floats:
    """Distances (..., n * samples + 1) of the surface of the body from obstacles in configurations (..., n, 3).

    Those within the mount are infinite. Where obstacles move, configurations (k, n, 3) are those at `times` (k,). Of a
    loaded body it is the least of as many places each as its segment has arcs.
    """
    if robot.has_external_load:
        loaded, arcs = bodies_at(robot, q.reshape(-1, len(robot), 3))
        own = clearances_along(loaded, scene, arcs, samples, times)
        ends = samples * np.cumsum(body_of(robot).counts)
        parts = [each.reshape(len(own), samples, -1).min(axis=-1) for each in np.split(own[:, :-1], ends[:-1], axis=1)]
        return np.concatenate([*parts, own[:, -1:]], axis=1).reshape(*q.shape[:-2], -1)
    body = robot.backbone(q, samples)
    if scene.moves and times is not None:
        distances = np.stack([scene.at(t).distance(own) for t, own in zip(times.tolist(), body, strict=True)])
    else:
        distances = scene.distance(body)
    return np.where(lengths_along(q, samples) < robot.mount, np.inf, distances - radii_along(robot, samples))


class Curves(NamedTuple):
    """Values over time.

    Attributes
    ----------
    title : str
    times : ndarray (T,)
    values : ndarray (T, c)
    names : tuple of str
        Of the curves.
    unit : str
    """

    title: str
    times: Floats
    values: Floats
    names: tuple[str, ...]
    unit: str


def bends_of(motion: Motion) -> Curves:
    """How much each segment is bent."""
    values = np.hypot(motion.q[..., 0], motion.q[..., 1])
    return Curves("bends of the segments", motion.times, values, motion.robot.segment_names, "rad")


def lengths_of(motion: Motion) -> Curves:
    """How long each segment is."""
    return Curves("lengths of the segments", motion.times, motion.q[..., 2], motion.robot.segment_names, "length unit")


def joints_of(motion: Motion) -> Curves:
    """Values of the joints."""
    return Curves("joints", motion.times, motion.joints, motion.robot.joint_names, "rad, or length unit")


def actuators_of(motion: Motion) -> Curves:
    """Values of all actuators."""
    robot = motion.robot
    units = {actuator.unit or ("value" if robot.linear else "length unit") for actuator in robot.actuators}
    unit, names = units.pop() if len(units) == 1 else "value", tuple(actuator.name for actuator in robot.actuators)
    return Curves("actuators", motion.times, motion.actuators, names, unit)


def speeds_of(motion: Motion, rates: Rates) -> Curves:
    """What share of the rates each step takes, of what is nearest to its own: even within a step."""
    q, spread, durations = motion.configuration, rates.spread(motion.robot), np.diff(motion.times)[:, None, None]
    moves = np.diff(q, axis=0)
    motors = motor_speeds(motion.robot, spread, q[:-1], moves)
    shares = 100.0 / largest(
        motion.robot, spread, moves / durations, None if motors is None else motors / durations[..., 0]
    )
    return Curves(
        "speed", np.repeat(motion.times, 2)[1:-1], np.repeat(shares, 2)[:, None], ("speed",), "% of the rates"
    )
