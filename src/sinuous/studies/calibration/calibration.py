"""What a calibration found: the robot as it stands on the table, what is known of it, and what is left of errors."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import ActuatorValues, HasArray, Number, Rows, Stack, Truth
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of, result_value
from sinuous.base.errors import InputError
from sinuous.base.frozen import ShortRepr
from sinuous.model.inverse import fitting
from sinuous.model.robot import Robot, Uncertainty
from sinuous.studies.calibration.fit import after_play, errors, lines_with_play
from sinuous.studies.calibration.measurements import Measurements, read
from sinuous.studies.calibration.model import at_rest, model, predicted
from sinuous.studies.calibration.parameters import Values

if TYPE_CHECKING:
    import sinuous as sn

LEVEL = 0.95
"""Share of rows for which the bound of the robot held, by default."""

ROUNDING = 1e-9
"""By how much a number of rows may miss a whole one."""

OUTLYING = 8.0
"""Medians of the errors of fitted rows beyond which a row is named as an outlier."""

MOST_SHOWN = 5
"""Patterns, and parameters, that an explanation names."""


class Parameter(NamedTuple):
    """One parameter of a fit.

    Attributes
    ----------
    name : str
    group : str
    kind : str
        `factor`: what the drawn value is multiplied by; `angle` (rad), `length` or `mass`: what is added to it.
    value : float
        The factor, or what is added.
    deviation : float
        Standard deviation of the value (of a factor: relative to it), from how patterns of motion differ.
    determined : bool
        Whether the measurements say more about it than the drawing does.
    """

    name: str
    group: str
    kind: str
    value: float
    deviation: float
    determined: bool


class Trial(NamedTuple):
    """A group of parameters that was tried: mean error of rows that were held back, without it and with it."""

    group: str
    before: float
    after: float
    kept: bool


class Errors(NamedTuple):
    """Errors in the length unit: how many rows, and their mean, median, 95 % quantile and largest."""

    rows: int
    mean: float
    median: float
    p95: float
    worst: float

    @classmethod
    def of(cls, off: Floats) -> "Errors":
        """Of rows (N,)."""
        return cls(len(off), float(off.mean()), float(np.median(off)), float(np.quantile(off, 0.95)), float(off.max()))


@dataclass(frozen=True, repr=False)
class Calibration(ShortRepr):
    """A calibrated robot.

    Attributes
    ----------
    robot : Robot
        As measured, with its `uncertainty`; it is saved and loaded as any.
    drawn : Robot
        As it was given.
    device : ndarray (4, 4)
        Pose of the measuring device in the robot's world; the identity where the base was fitted instead.
    groups : tuple of str
        What was fitted.
    trials : tuple of Trial
        Groups that were tried, in order, where the fit chose by itself.
    parameters : tuple of Parameter
    residuals : ndarray (N, k, 3)
        Predicted less measured, in the frame of the device; NaN where nothing was seen.
    held_back : ndarray (N, k, 3)
        The same, each row predicted by a fit without rows of patterns like its own.
    rows : ndarray of int (N,)
        Numbers of the rows that were used.
    dropped : tuple of int
        Rows without a measurement (NaN).
    labels : tuple of str (N)
        The pattern of each row.
    notes : tuple of str
        What may surprise.
    play : float
        Of tendons and chambers, in the length unit, where it was fitted (`fit=["play", ...]`), else 0. `held_back`
        and bounds are those of rows of which the motion before is not known.
    """

    robot: Robot
    drawn: Robot
    device: Floats
    groups: tuple[str, ...]
    trials: tuple[Trial, ...]
    parameters: tuple[Parameter, ...]
    residuals: Floats
    held_back: Floats
    dropped: tuple[int, ...]
    notes: tuple[str, ...]
    measurements: Measurements
    play: float = 0.0

    @property
    def rows(self) -> Any:
        """Numbers of the rows that were used (N,)."""
        return self.measurements.rows

    @property
    def labels(self) -> tuple[str, ...]:
        """The pattern of each row (N)."""
        return self.measurements.labels

    @property
    def fitted(self) -> Errors:
        """Errors of the rows that were fitted."""
        return Errors.of(self._off(self.residuals))

    @property
    def expected(self) -> Errors:
        """Errors of rows that were held back: what to expect of other motions."""
        return Errors.of(self._off(self.held_back))

    @property
    def by_pattern(self) -> dict[str, Errors]:
        """Errors of held-back rows, by pattern, the worst first."""
        off, labels = self._off(self.held_back), np.array(self.labels)
        found = {label: Errors.of(off[labels == label]) for label in sorted(set(self.labels))}
        return dict(sorted(found.items(), key=lambda each: -each[1].mean))

    @property
    def level(self) -> float:
        """Level of the bound of the robot: 0.95, or with fewer than 19 rows what n of them allow, n / (n + 1)."""
        return attainable(len(self.labels), LEVEL)

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Names of the parameters about which the drawing says more than the measurements."""
        return tuple(each.name for each in self.parameters if not each.determined)

    def bound(self, level: Number = LEVEL, of: str = "patterns") -> float:
        """Error that this share of held-back rows does not exceed.

        Parameters
        ----------
        level : float
        of : str
            `patterns`: it holds for at least that share of the rows of every pattern that was held back, so for more of
            most, and about for motions unlike those that were measured (group-conditional conformal prediction).
            `rows`: for that share of the rows of further patterns like those that were measured (hierarchical conformal
            prediction); for that at least `1 / (1 - level) - 1` patterns are needed, with fewer it is the other. Labels
            that go on from another, as `circle_hold` does from `circle`, are no pattern of their own here.

        Returns
        -------
        float
            Infinite where there are too few rows: for 95 % at least 19, for 90 % at least 9. Patterns that have fewer
            count together.
        """
        share, off = checks.number("level", level, low=0.0, high=1.0), self._off(self.held_back)
        if checks.choice("of", of, ("patterns", "rows")) == "rows":
            like = bound_of_further(_parts(off, whole_patterns(self.labels)), share)
            if np.isfinite(like):
                return like
        return max(bound_of(part, share) for part in joined_parts(off, self.labels, share))

    def confidence(self, error: "Number | sn.Solution") -> float:
        """Share of further rows that are off by at most `error`, of rows of all patterns; of a solution, P(clear).

        It is k / (n + 1) where k of n held-back rows are off by no more. A solution of the calibrated robot is clear of
        obstacles where the robot is off by no more than its clearance and the bound that proofs thicken the body by.

        Raises
        ------
        InputError
            When the error is negative, or the solution has no proved clearance.
        """
        from sinuous.answer.solution import Solution  # noqa: PLC0415

        if isinstance(error, Solution):
            if error.clearance is None:
                raise InputError("error", "nothing is proved of its clearance", error.status, "a solved solution")
            unsure = error.problem.robot.uncertainty
            error = error.clearance + (0.0 if unsure is None else float(np.min(unsure.bound)))
        off = self._off(self.held_back)
        most = error if error == math.inf else checks.number("error", error, low=0.0)
        return float((off <= most).sum()) / (len(off) + 1)

    @property
    def outliers(self) -> tuple[int, ...]:
        """Numbers of rows that are off by more than `OUTLYING` times the median: the fit hardly counts them."""
        off = errors(np.nan_to_num(self.residuals))
        return tuple(self.rows[off > OUTLYING * max(float(np.median(off)), ROUNDING * self.robot.mean_length)].tolist())

    def for_motion(
        self,
        actuators: ActuatorValues,
        measured: Stack,
        *,
        level: Number = LEVEL,
        places: Sequence[Number] | HasArray | None = None,
        markers: Rows | None = None,
        unit: Number = 1.0,
    ) -> Robot:
        """The robot with a bound of its error in one motion, from some rows of that motion (split conformal).

        Errors differ from motion to motion, so a bound from other motions (`bound`) holds for more rows of it, or for
        fewer. This one holds for the share `level` of its further rows, on average over which rows are measured, where
        these are drawn from all of it, or spread evenly over it; 40 are enough.

        Parameters
        ----------
        actuators, measured, places, markers, unit
            As for `calibrate`, of rows to which the robot was not fitted; in the same frame of the measuring device.
        level : float

        Returns
        -------
        Robot
            Its `uncertainty` is that bound, in the places that were measured.

        Raises
        ------
        InputError
            When there are too few rows for this level (at least `level / (1 - level)`), or they are off by more than
            the length of the robot.
        """
        share = checks.number("level", level, above=0.0, high=1.0)
        rows = read(self.robot, actuators, measured, places, markers, ["motion"] * len(np.asarray(measured)), unit)
        count = len(rows.rows)
        if share > attainable(count, share) + ROUNDING:
            needed = (
                f"at least {math.ceil(share / (1.0 - share) - ROUNDING)} rows" if share < 1.0 else "a level below 1"
            )
            raise InputError("measured", f"rows for a bound at {share:.4g}", count, needed)
        points = rows.points @ self.device[:3, :3].T + self.device[:3, 3]
        off = predicted(model(self.robot, Values((), np.zeros(0)), rows.places), rows.actuators) - points
        usual, length = float(np.nanmedian(np.linalg.norm(off, axis=-1))), self.robot.mean_length
        if usual > length:
            problem = f"rows are off by {usual:.3g}, the robot is {length:.3g} long"
            wanted = "points in the frame of the device and the length unit of the robot, or another unit"
            raise InputError("measured", problem, points[0].tolist(), wanted)
        known = self.held_back if self.held_back.shape[1:] == off.shape[1:] else off
        bounds = bounds_of(range(self.robot.drive.before, len(self.robot)), off, rows, share, scales_of_points(known))
        return self.robot.changed(uncertainty=Uncertainty(bounds, share))

    def predict(self, actuators: ActuatorValues, *, in_order: Truth = False) -> Floats:
        """Pose (..., 4, 4) of the tool in the world, at values (..., m) of the actuators; at rest under its weight.

        Values (N, m) that are `in_order` of time are those of one motion: what `play` leaves of them counts.

        Raises
        ------
        InputError
            When the robot cannot hold its load at some of these values.
        """
        values, _ = fitting(actuators, None, [each.name for each in self.robot.actuators], len(self.robot))
        rows = values.reshape(-1, values.shape[-1])
        if checks.truth("in_order", in_order):
            rows = after_play(self.robot.drive.motors, lines_with_play(self.robot), rows, self.play)
        return at_rest(self.robot, rows).tips().reshape(*values.shape[:-1], 4, 4)

    def save(self, file: str | Path) -> None:
        """Write the robot into a file; `sinuous.load` reads it where it stands in a problem file."""
        self.robot.save(file)

    def explain(self) -> str:
        """Say what was fitted, what mattered most, what is not known, and what to measure next."""
        return "\n".join(self._lines())

    def _lines(self) -> list[str]:
        own, unit = self.expected, self.robot.mean_length
        lines = [f"{own.rows} rows; fitted: {', '.join(self.groups) or 'nothing'} ({len(self.parameters)} parameters)"]
        for name, each in (("fitted", self.fitted), ("held back", own)):
            lines.append(
                f"error of rows {name}: mean {each.mean:.3g} ({100 * each.mean / unit:.2g} % of the length), "
                f"median {each.median:.3g}, 95 % {each.p95:.3g}, worst {each.worst:.3g}"
            )
        lines.append(f"bound of the error at {self.level:.3g}: {self.bound(self.level):.3g}")
        kept = sorted((t for t in self.trials if t.kept), key=lambda t: t.after - t.before)
        if kept:
            said = [f"{t.group} ({t.before:.3g} to {t.after:.3g})" for t in kept[:MOST_SHOWN]]
            lines.append("what matters most: " + ", ".join(said))
        worst = list(self.by_pattern.items())[:MOST_SHOWN]
        lines.append("worst patterns: " + ", ".join(f"{label} (mean {each.mean:.3g})" for label, each in worst))
        if self.undetermined:
            more = len(self.undetermined) - MOST_SHOWN
            names = ", ".join(self.undetermined[:MOST_SHOWN]) + (f" and {more} more" if more > 0 else "")
            lines.append(f"not determined by these rows: {names}; measure next what sinuous.studies.suggest says")
        return lines + [f"note: {note}" for note in self.notes]

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain values."""
        return {
            **result_of(self, "robot device"),
            "fitted": list(self.groups),
            **result_of(self, "parameters"),
            "errors": result_value({"fitted": self.fitted, "held_back": self.expected}),
            "patterns": result_value(self.by_pattern),
            "bound": self.bound(self.level),
            **result_of(self, "level dropped outliers notes"),
        }

    def _off(self, residuals: Floats) -> Floats:
        """Error of each row (N,): of its worst point."""
        own = self.measurements.levers > 0.0
        return np.sqrt((np.nan_to_num(residuals[:, own]) ** 2).sum(axis=2)).max(axis=1)

    def _shown(self) -> Iterator[str]:
        own = self.expected
        yield from (f"{own.rows} rows", f"{len(self.parameters)} parameters", f"mean error {own.mean:.3g}")


def bounds_of(
    rows_of_body: range, off: Floats, rows: Measurements, level: float, scales: Floats
) -> float | tuple[float, ...]:
    """Bound of each of some rows of a robot for errors (N, k, 3), largest of all patterns: of the first point beyond.

    The score of a row is the worst of its points, each divided by its scale (k,), so the bounds of all points hold
    together. No segment has less than those before.
    """
    sizes = np.linalg.norm(off, axis=2)
    own = np.flatnonzero(rows.levers > 0.0)
    scores = np.nanmax(sizes[:, own] / scales[own], axis=1)
    worst_score = max(bound_of(part, level) for part in joined_parts(scores, rows.labels, level))
    bounds: dict[int, float] = {}
    for k in own.tolist():
        segment = rows.places[k].segment
        bounds[segment] = max(bounds.get(segment, 0.0), worst_score * float(scales[k]))
    each: list[float] = []
    worst = 0.0
    for k in rows_of_body:
        beyond = [segment for segment in bounds if segment >= k]
        worst = max(worst, bounds[min(beyond)] if beyond else max(bounds.values()))
        each.append(worst)
    return tuple(each) if len(set(each)) > 1 else max(bounds.values())


def scales_of_points(off: Floats) -> Floats:
    """Scale (k,) of the error of each point, of errors (N, k, 3): their mean, at least a tenth of the largest one."""
    means = np.nanmean(np.linalg.norm(off, axis=2), axis=0)
    largest = float(np.nanmax(means))
    return np.maximum(np.nan_to_num(means), 0.1 * largest) if largest > 0.0 else np.ones(off.shape[1])


def attainable(rows: int, level: float) -> float:
    """The level of a bound that so many rows allow: `level`, or with too few of them n / (n + 1)."""
    return min(level, rows / (rows + 1.0))


def joined_parts(off: Floats, labels: Sequence[str], level: float) -> list[Floats]:
    """The errors (N,) of each pattern that has rows enough for this level; those of all others together.

    Where these are too few, too, all rows are one part.
    """
    parts = _parts(off, labels)
    enough = [part for part in parts if np.isfinite(bound_of(part, level))]
    others = [part for part in parts if not np.isfinite(bound_of(part, level))]
    rest = [np.concatenate(others)] if others else []
    if rest and not np.isfinite(bound_of(rest[0], level)):
        return [*enough, off]
    return [*enough, *rest]


def _parts(off: Floats, labels: Sequence[str]) -> list[Floats]:
    """The errors (N,) of each pattern."""
    each = np.array(labels)
    return [off[each == label] for label in set(labels)]


def whole_patterns(labels: Sequence[str]) -> list[str]:
    """The pattern of each label: itself, or the shortest label from which it goes on after an underscore."""
    known, result = set(labels), []
    for label in labels:
        words = label.split("_")
        begins = ("_".join(words[:count]) for count in range(1, len(words)))
        result.append(next((begin for begin in begins if begin in known), label))
    return result


def bound_of(off: Floats, level: float) -> float:
    """The error that a further row exceeds with at most the probability 1 - level; infinite with too few rows.

    Of n errors (N,) it is the ceil((n + 1) level)-th smallest (split conformal prediction, Vovk et al. 2005).
    """
    place = math.ceil((len(off) + 1) * level - ROUNDING)
    return math.inf if place > len(off) else float(np.sort(off)[max(place, 1) - 1])


def bound_of_further(parts: Sequence[Floats], level: float) -> float:
    """The error that a row of a further pattern exceeds with at most this probability; infinite with too few patterns.

    Errors (N,) of each pattern count as much together as those of any other, and one more pattern may have any (Lee,
    Barber & Willett 2023).
    """
    off = np.concatenate(parts)
    shares = np.concatenate([np.full(len(part), 1.0 / len(part)) for part in parts]) / (len(parts) + 1.0)
    order = np.argsort(off)
    at = int(np.searchsorted(np.cumsum(shares[order]), level - 1e-12))
    return float(off[order[at]]) if at < len(off) else np.inf
