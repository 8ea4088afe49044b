"""Fit a robot to measurements, and say which measurements would tell most about it."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import ActuatorValues, HasArray, Names, Number, Rows, Stack, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.joints import Prismatic
from sinuous.model.robot import Robot, Uncertainty
from sinuous.studies.calibration.calibration import (
    LEVEL,
    OUTLYING,
    ROUNDING,
    Calibration,
    Parameter,
    Trial,
    attainable,
    bounds_of,
    scales_of_points,
)
from sinuous.studies.calibration.fit import (
    DRAWING_WEIGHT,
    Fit,
    FitState,
    begun,
    by_pose,
    errors,
    extended,
    find_mistake,
    find_play,
    fitted,
    left_out,
    predict,
    rows_after_play,
)
from sinuous.studies.calibration.measurements import Measurements, Place, read, refuse_loose, refuse_size, stalled
from sinuous.studies.calibration.model import derivatives, holds, model
from sinuous.studies.calibration.parameters import (
    ORDER,
    GroupName,
    ParameterGroup,
    Values,
    can_stretch,
    changed,
    elastic,
    group,
    with_joint_motors,
)

PLAY = "play"
"""What is fitted beside groups of parameters, told by name."""

Frame = Literal["base", "device"]
"""Which pose is fitted."""

LARGEST_ERROR_RATIO = 0.99
"""A group is kept when the mean error of rows that were held back falls below this share of what it was."""

PLAY_RATIO = 0.95
"""Play is told where the mean error of rows that were held back falls below this share of what it was."""

PLAY_ROWS = 80
"""Most rows with which play is tried; what it leaves of them follows from all rows."""

TRIAL_PASSES = 2
"""How often groups that were not kept are tried again, once others are."""

TRIAL_ROWS = 300
"""Most rows with which groups are tried; the last fit takes all."""

TRIAL_ROWS_UNDER_LOAD = 100
"""The same where each row is an equilibrium under load, which takes some ten times as long."""

TRIAL_STEPS = 8
"""Most steps of a fit that tries a group."""

NUMBERS_PER_PARAMETER = 2
"""Numbers that have to be measured for each parameter, at least."""

LARGEST_DRAWING_FRACTION = 0.5
"""Share of what is known of a parameter that comes from its drawing, from which on it counts as not determined."""

SOFT_GROUPS = ("stretch", "stiffness", "rest")
"""Groups that only robots with elastic actuators have."""

SOFT_TRIAL_GROUPS: tuple[GroupName, ...] = ("stretch", "offsets", "stiffness")
"""Groups with which elastic tendons are compared with rigid ones: alone, a wrong softness is no better."""

CANDIDATES = 400
"""Settings of which `suggest` takes the best."""

BEND_FRACTION = 0.7
"""Share of its largest bend, or of 1 rad, up to which `suggest` bends a segment."""


def calibrate(
    robot: Robot,
    actuators: ActuatorValues,
    measured: Stack,
    *,
    fit: Names | None = None,
    places: Sequence[Number] | HasArray | None = None,
    markers: Rows | None = None,
    groups: Sequence[object] | NDArray[Any] | None = None,
    unit: Number = 1.0,
    frame: Frame = "base",
) -> Calibration:
    """Fit a robot to measurements of where it was.

    The pose of the robot is fitted in any case. What else is fitted is told by name, or chosen: from few to many
    parameters, as long as rows get better that were held back, pattern by pattern. Outliers count little (soft loss).
    Rigid tendons may turn out to be elastic; then the unit of force is that of the stiffness of the segments, or, where
    none has one, such that a tendon's drawn stiffness is 1. Of a robot that gravity bends, rows are of the body at rest
    under its weight and payload (`Robot.equilibrium`).

    Parameters
    ----------
    robot : Robot
        As drawn.
    actuators : array_like (N, m), or mapping from names to array_like (N,)
        Values of the actuators, in the order of `robot.actuators` or by name, in the units of their motors. Joints that
        no actuator moves come last, by their own names; the fitted robot has them as `actuators`.
    measured : array_like (N, 3), (N, 4, 4) or (N, k, 3)
        Positions of the tool, its poses, or k points of the body, in the frame of the measuring device. NaN: not seen.
    fit : list of str, optional
        Of `base`, `device`, `stretch` and `stiffness` (of lines and segments), `rest` (bends), `offsets`, `lengths`,
        `circles`, `angles` and `gains` (of lines), `tool`, `joints` (offsets of their values), and `payload`: the
        masses that the robot carries, or that of one at its tip where it is drawn with none, at least 0. `play`, of
        tendons and chambers, needs rows in the order of time; without `fit` it is looked for, and told in the notes.
    places : array_like (k,), optional
        Where the k points are: shares of the length of the body, 1 = its end.
    markers : array_like (k, 3), optional
        Their offsets from the backbone, in the frame of the cross-section there (z along the tangent).
    groups : sequence (N,), optional
        The pattern of motion of each row, as texts; those that begin alike are held back together. By default eight
        blocks of rows.
    unit : float
        Length units of the robot in one of the measuring device.
    frame : str
        What is fitted as the pose: `base`, the robot's base in the frame of the device, or `device`, the pose of the
        device in the world, in which the base stands where it stands. Gravity is known in that frame: with `base` in
        that of the device, so that the sag tells how the base is tilted; with `device` in the world.

    Returns
    -------
    Calibration

    Raises
    ------
    InputError
        When rows do not fit the robot, are all equal, or are in another unit of length; when a robot as drawn cannot
        hold its load in some row, or `payload` is to be fitted and no weight bends the robot.
    """
    robot = with_joint_motors(robot)
    rows = read(robot, actuators, measured, places, markers, groups, unit)
    refuse_size(robot, rows)
    names = _names(fit, checks.choice("frame", frame, get_args(Frame)))
    plain = drawn = robot.changed(tool=None, uncertainty=None)
    notes = [f"rows that say 0, 0, 0, taken as not seen: {_few(rows.zeros)}"] if rows.zeros else []
    dropped = tuple(row for row in rows.dropped if row not in rows.zeros)
    if dropped:
        notes.append(f"rows without a measurement: {_few(dropped)}")
    repeated = stalled(rows)
    if repeated:
        notes.append(f"rows that repeat the points of the row before, while actuators moved: {_few(repeated)}")
    still = [a.name for a, moves in zip(robot.actuators, np.ptp(rows.actuators, axis=0), strict=True) if moves == 0.0]
    if still:
        notes.append(f"never move, so nothing is known of them: {', '.join(still)}")
    trials: list[Trial] = []
    if names is None:
        drawn, chosen = _chosen(drawn, rows, frame == "base", trials, notes)
    else:
        drawn = _giving(drawn, names)
        chosen = _fit_as_told(drawn, rows, frame == "base", names, notes)
    play = _play(drawn, chosen, rows, trials, notes) if fit is None or PLAY in fit else 0.0
    moved = rows_after_play(drawn, rows, play if fit is not None else 0.0)
    last = fitted(drawn, chosen, moved)
    mistake = find_mistake(plain, rows, frame == "base", float(np.median(errors(last.residuals))))
    notes += [] if mistake is None else [mistake]
    found = _result(robot, drawn, last, (rows, moved), trials, notes, frame)
    if found.outliers:
        note = (
            f"rows that are off by more than {OUTLYING:g} times the median, which the fit hardly counts and bounds do"
        )
        found = replace(found, notes=(*found.notes, f"{note}: {_few(found.outliers)}"))
    return found if moved is rows else replace(found, groups=(*found.groups, PLAY), play=play)


def _play(drawn: Robot, state: FitState, rows: Measurements, trials: list[Trial], notes: list[str]) -> float:
    """Look for play of tendons, as long as rows are not bodies under load, and say what was found."""
    if drawn.has_external_load:
        return 0.0
    play, before, after = find_play(drawn, state, rows, slice(None, None, max(1, len(rows.labels) // PLAY_ROWS)))
    if play == 0.0 or after > PLAY_RATIO * before:
        return 0.0
    trials.append(Trial(PLAY, before, after, True))
    notes.append(
        f"play of {play:.2g} in the tendons, or friction that acts alike, explains a part of the error: rows held back "
        f"are off by {after:.3g} in the mean with it, {before:.3g} without"
    )
    return play


def _names(fit: Names | None, frame: str) -> tuple[GroupName, ...] | None:
    """Groups that are told, without the pose."""
    if fit is None:
        return None
    known = get_args(GroupName)
    for i, name in enumerate(fit):
        checks.choice(f"fit[{i}]", name, (*known, PLAY))
    if isinstance(fit, str) or {"base", "device"} <= set(fit):
        raise InputError("fit", "", fit, f"a list of names with {frame} or without it, not both poses")
    listed: tuple[GroupName, ...] = tuple(name for name in known if name in fit and name not in ("base", "device"))
    return listed


def _giving(drawn: Robot, names: tuple[GroupName, ...]) -> Robot:
    """The robot with tendons that stretch, where what is to be fitted needs these."""
    if "payload" in names and not drawn.has_external_load:
        problem = "no weight bends the robot: it has no gravity, or no segment has a stiffness"
        raise InputError("fit", problem, list(names), "no payload, or a robot with gravity, stiffness and mass")
    soft = set(names) & ({"stretch"} if drawn.has_external_load else set(SOFT_GROUPS))
    if not soft or drawn.drive.elastic is not None:
        return drawn
    if not can_stretch(drawn):
        raise InputError("fit", "the robot has no tendons that could stretch", sorted(soft), "other groups")
    return elastic(drawn)


def _fit_as_told(
    drawn: Robot, rows: Measurements, levelled: bool, names: tuple[GroupName, ...], notes: list[str]
) -> FitState:
    state = fitted(drawn, begun(drawn, rows, levelled), rows, TRIAL_STEPS).state
    for name in names:
        own = group(drawn, name)
        if not own.names:
            notes.append(f"the robot has no {name}")
        elif _too_many(state, own, rows):
            notes.append(f"too few rows to fit {name}: {', '.join(own.names)}")
        else:
            state = extended(state, own)
    return state


def _too_many(state: FitState, own: ParameterGroup, rows: Measurements) -> bool:
    measured = 3 * int(np.isfinite(rows.points[..., 0]).sum())
    return NUMBERS_PER_PARAMETER * (6 + len(state.values.x) + len(own.names)) > measured


def _chosen(
    drawn: Robot, rows: Measurements, levelled: bool, trials: list[Trial], notes: list[str]
) -> tuple[Robot, FitState]:
    """Add groups as long as held-back rows get better."""
    most = TRIAL_ROWS_UNDER_LOAD if drawn.has_external_load else TRIAL_ROWS
    part = rows.part(slice(None, None, max(1, len(rows.labels) // most)))

    def tried(robot: Robot, state: FitState) -> tuple[FitState, float]:
        own = fitted(robot, state, part, TRIAL_STEPS)
        return own.state, float(errors(left_out(own, part, robot)).mean())

    state, error = tried(drawn, begun(drawn, part, levelled))
    if can_stretch(drawn):
        soft = elastic(drawn)
        start = tuple(group(soft, name) for name in SOFT_TRIAL_GROUPS)
        many = 6 + sum(len(each.names) for each in start)
        fits = NUMBERS_PER_PARAMETER * many <= 3 * int(np.isfinite(rows.points[..., 0]).sum())
        other, after = tried(soft, begun(soft, part, levelled, groups=start if fits else start[:1]))
        trials.append(Trial("elastic tendons", error, after, after < LARGEST_ERROR_RATIO * error))
        if trials[-1].kept:
            drawn, state, error = soft, other, after
    begins = {each.name for each in state.values.groups}
    left = [own for name in ORDER if name not in begins and (own := group(drawn, name)).names]
    for _ in range(TRIAL_PASSES):
        for own in tuple(left):
            if _too_many(state, own, rows):
                continue
            other, after = tried(drawn, extended(state, own))
            trials.append(Trial(own.name, error, after, after < LARGEST_ERROR_RATIO * error))
            if trials[-1].kept:
                state, error = other, after
                left.remove(own)
    few = [own for own in left if _too_many(state, own, rows)]
    notes += [f"too few rows to fit {own.name}: {', '.join(own.names)}" for own in few]
    return drawn, state


def _result(
    robot: Robot,
    drawn: Robot,
    last: Fit,
    rows_and_moved: tuple[Measurements, Measurements],
    trials: list[Trial],
    notes: list[str],
    frame: Frame,
) -> Calibration:
    """Rows are as they were measured, and with what play leaves of their actuators: bounds hold without it, too."""
    rows, moved = rows_and_moved
    state, seen = last.state, np.isfinite(rows.points)
    held = np.where(seen, left_out(last, moved, drawn), np.nan)
    if moved is not rows:
        held += predict(drawn, state, rows) - predict(drawn, state, moved)
    real = changed(drawn, state.values)
    tool = np.array(robot.tool)
    moved_tool = state.values.of("tool")
    if moved_tool is not None:
        tool[:3, 3] += moved_tool
    device = np.eye(4)
    if frame == "base":
        real = real.changed(base=_orthogonal(state.pose @ robot.base))
    else:
        device = _orthogonal(np.linalg.inv(state.pose))
    level = attainable(len(rows.labels), LEVEL)
    if level < LEVEL:
        needed = math.ceil(LEVEL / (1.0 - LEVEL) - ROUNDING)
        notes.append(
            f"{len(rows.labels)} rows allow a bound at {100.0 * level:.3g} %; {100.0 * LEVEL:g} % needs {needed}"
        )
    bounds = bounds_of(range(robot.drive.before, len(robot)), held, rows, level, scales_of_points(held))
    real = real.changed(tool=tool, uncertainty=Uncertainty(bounds, level))
    fit_names = (frame, *(each.name for each in state.values.groups))
    parameters = tuple(_parameters(last, drawn, rows, frame))
    residuals = np.where(seen, last.residuals, np.nan)
    return Calibration(
        real, robot, device, fit_names, tuple(trials), parameters, residuals, held, rows.dropped, tuple(notes), rows
    )


def _orthogonal(pose: NDArray[Any]) -> Floats:
    """The pose, free of rounding."""
    result = np.array(pose, np.float64)
    u, _, vt = np.linalg.svd(pose[:3, :3])
    result[:3, :3] = u @ vt
    return result


def _parameters(last: Fit, drawn: Robot, rows: Measurements, frame: Frame) -> Iterator[Parameter]:
    """Yield all parameters with their standard deviations, from how much patterns pull at them (cluster-robust)."""
    values = last.state.values
    flat = last.slopes.reshape(len(last.slopes), -1, last.slopes.shape[-1])
    off = last.residuals.reshape(len(flat), -1)
    pulls = np.einsum("nkp,nk,n->np", flat, off, last.weights, optimize=True) / last.scale**2
    labels = np.array(rows.labels)
    each = np.stack([pulls[labels == label].sum(axis=0) for label in sorted(set(rows.labels))])
    inverse = np.linalg.pinv(last.hessian, rcond=1e-14, hermitian=True)
    count = len(each)
    spread = inverse @ (each.T @ each) @ inverse * (count / max(count - 1, 1))
    deviations = np.sqrt(np.maximum(np.diag(spread), 0.0))
    known = np.zeros(len(inverse))
    known[6:] = DRAWING_WEIGHT * len(flat) / values.widths**2
    drawing = np.diag(inverse) * known
    kinds = {"rest": "angle", "angles": "angle", "offsets": "length", "tool": "length", "payload": "mass"}
    pose = group(drawn, frame)
    at = 0
    for own in (pose, *values.groups):
        for name in own.names:
            kind = ("angle" if at < 3 else "length") if at < 6 else kinds.get(own.name, "factor")
            if own.name == "joints":
                slides = isinstance(drawn._rigid.moving[own.names.index(name)], Prismatic)
                kind = "length" if slides else "angle"
            value = 0.0 if at < 6 else float(values.x[at - 6])
            value = float(np.exp(value)) if kind == "factor" else value
            yield Parameter(
                name, own.name, kind, value, float(deviations[at]), bool(drawing[at] < LARGEST_DRAWING_FRACTION)
            )
            at += 1


def _few(numbers: tuple[int, ...]) -> str:
    shown = ", ".join(map(str, numbers[:10]))
    return shown + (f" and {len(numbers) - 10} more" if len(numbers) > 10 else "")


def suggest(robot: Robot, n: Whole, *, fit: Names | None = None, seed: Whole = 0) -> Floats:
    """Settings of the actuators (n, m) whose measurement of the tip determines most about a robot.

    Of many settings, one after the other is taken that adds most to the logarithm of the determinant of what is known
    (D-optimal design; Pukelsheim 2006), beside what the drawing says.

    Parameters
    ----------
    robot : Robot
    n : int
    fit : list of str, optional
        Groups that are to be fitted, see `calibrate`; by default all that are tried there.
    seed : int

    Returns
    -------
    ndarray (n, m)

    Raises
    ------
    InputError
        When actuators do not determine the shape of the robot, it cannot hold its load, or an argument is not what it
        should be.
    """
    robot = with_joint_motors(robot)
    refuse_loose(robot)
    count = checks.integer("n", n, 1, 10_000)
    generator = np.random.default_rng(checks.integer("seed", seed, 0, 2**31))
    names = _names(fit, "base") or ORDER
    own = robot.changed(tool=None, uncertainty=None)
    soft = elastic(own) if can_stretch(own) and set(names) & set(SOFT_GROUPS) else own
    listed = tuple(each for name in names if (each := group(soft, name)).names)
    values = Values(listed, np.zeros(sum(len(each.names) for each in listed)))
    settings = _settings(soft, generator, max(CANDIDATES, 4 * count))
    held = holds(soft, settings)
    if held.sum() < count:
        problem = f"no stable equilibrium was found in {(~held).sum()} of {len(held)} random shapes"
        raise InputError("robot", problem, robot, "a load that the robot can hold")
    settings = settings[held]
    tip = Place(len(robot) - 1, 1.0, np.array(robot.tool[:3, 3]))
    points, slopes = derivatives(model(soft, values, (tip,)), settings)
    rows = np.concatenate([by_pose(points), slopes], axis=-1)[:, 0] / (0.01 * robot.mean_length)
    known = np.diag(np.concatenate([np.full(6, 1e-6), 1.0 / values.widths**2]))
    known[3:6, 3:6] /= robot.mean_length**2
    taken: list[int] = []
    inverse = np.linalg.inv(known)
    for _ in range(count):
        gained = np.linalg.slogdet(np.eye(3) + rows @ inverse @ np.swapaxes(rows, 1, 2))[1]
        gained[taken] = -np.inf
        best = int(np.argmax(gained))
        taken.append(best)
        reach = inverse @ rows[best].T
        inverse = inverse - reach @ np.linalg.solve(np.eye(3) + rows[best] @ reach, reach.T)
    return settings[taken]


def _settings(robot: Robot, generator: np.random.Generator, count: int) -> Floats:
    """Values of the actuators of shapes of which some segments are bent, and which are within limits where possible."""
    n = len(robot.segments)
    q = np.zeros((count, n, 3))
    most = np.array([min(segment.max_bend, 1.0) for segment in robot.segments]) * BEND_FRACTION
    turn = generator.uniform(0.0, 2.0 * np.pi, (count, n))
    size = most * np.sqrt(generator.uniform(0.0, 1.0, (count, n))) * (generator.uniform(size=(count, n)) < 0.6)
    q[..., 0], q[..., 1] = size * np.cos(turn), size * np.sin(turn)
    low, high = np.array([segment.length for segment in robot.segments]).reshape(-1, 2).T
    q[..., 2] = generator.uniform(low, high, (count, n))
    low, high = np.array([joint.limits for joint in robot._rigid.moving]).reshape(-1, 2).T
    q = robot.with_joints(q, generator.uniform(low, high, (count, len(low)))) if len(low) else q
    q = q if robot.drive.coordinates.free else robot.drive.coordinates.project(q)
    fits = np.array([not robot.violations(each) for each in q])
    return robot.to_actuators(q[fits] if fits.sum() * 2 >= count else q)
