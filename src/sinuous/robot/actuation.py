"""Lengths of tendons and chambers, from a configuration and back; plain NumPy.

Arrays are (..., n, 3) for configurations and, per segment, (..., m) for its m lines.
"""

from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.robot.actuators import Lines
from sinuous.robot.segment import Segment


def tendon_displacements(segments: Sequence[Segment], q: Floats) -> list[Floats]:
    """By how much every tendon is pulled, per segment an array (..., m)."""
    total = np.cumsum(q[..., :2], axis=-2)
    return [
        np.zeros((*q.shape[:-2], 0)) if s.tendons is None else total[..., k, :] @ s.tendons.arms.T
        for k, s in enumerate(segments)
    ]


def tendon_lengths(segments: Sequence[Segment], q: Floats) -> list[Floats]:
    """Length of every tendon from base to where it ends, per segment an array (..., m)."""
    reach = np.cumsum(q[..., 2], axis=-1)
    return [reach[..., k, None] - pulled for k, pulled in enumerate(tendon_displacements(segments, q))]


def chamber_lengths(segments: Sequence[Segment], q: Floats) -> list[Floats]:
    """Length of every chamber, per segment an array (..., m)."""
    return [
        np.zeros((*q.shape[:-2], 0)) if s.chambers is None else q[..., k, 2:] - q[..., k, :2] @ s.chambers.arms.T
        for k, s in enumerate(segments)
    ]


def from_tendon_lengths(segments: Sequence[Segment], lengths: Any) -> Floats:
    """See `Robot.from_tendon_lengths`."""
    return _undo_lines(segments, "tendons", _per_segment(segments, "lengths", lengths, "tendons"))


def from_chamber_lengths(segments: Sequence[Segment], lengths: Any) -> Floats:
    """See `Robot.from_chamber_lengths`."""
    return _undo_lines(segments, "chambers", _per_segment(segments, "lengths", lengths, "chambers"))


def from_tendon_displacements(segments: Sequence[Segment], displacements: Any, length: Any) -> Floats:
    """See `Robot.from_tendon_displacements`."""
    if length is None and any(s.length[0] != s.length[1] for s in segments):
        raise InputError("length", "missing", length, "segment lengths, because segments can stretch")
    given = [s.length[0] for s in segments] if length is None else length
    own = checks.stack("length", given, (len(segments),))
    reach = np.cumsum(own, axis=-1)
    values = _per_segment(segments, "displacements", displacements, "tendons")
    checks.broadcast("length", length, own[..., 0], values[0][..., 0])
    return _undo_lines(segments, "tendons", [reach[..., k, None] - v for k, v in enumerate(values)], own)


def _lines(segment: Segment, kind: str) -> Lines | None:
    return segment.tendons if kind == "tendons" else segment.chambers


def _per_segment(segments: Sequence[Segment], key: str, values: Any, kind: str) -> list[Floats]:
    """Check one array (..., lines) a segment; their axes in front are broadcast."""
    is_list = not isinstance(values, (str, bytes, dict)) and np.iterable(values)
    listed = list(islice(values, len(segments) + 1)) if is_list else []
    if len(listed) != len(segments):
        raise InputError(key, "", values, f"a list of {len(segments)} arrays, one a segment")
    result = []
    for k, (segment, value) in enumerate(zip(segments, listed, strict=True)):
        lines = _lines(segment, kind)
        if lines is None or not lines.spans_plane:
            raise InputError(
                f"segments[{k}].{kind}", "do not determine the bend", lines, "at least two, not in one plane"
            )
        result.append(checks.stack(f"{key}[{k}]", value, (len(lines.angles),)))
    lead = checks.broadcast(key, values, *(v[..., 0] for v in result))[0].shape
    return [np.broadcast_to(v, (*lead, v.shape[-1])) for v in result]


def _undo_lines(segments: Sequence[Segment], kind: str, values: list[Floats], known: Floats | None = None) -> Floats:
    """Undo `length = reach - arms . bend`, segment by segment; later tendons run through earlier segments."""
    before = np.zeros((*values[0].shape[:-1], 3))
    out = []
    for k, (segment, value) in enumerate(zip(segments, values, strict=True)):
        lines = _lines(segment, kind)
        assert lines is not None  # `_per_segment` refuses it
        system = np.concatenate([-lines.arms, np.ones((len(lines.arms), 1))], axis=1)
        rest = value - (before @ system.T if kind == "tendons" else 0.0)
        fixed = known[..., k] if known is not None else _only_length(segment)
        if fixed is None:
            own = _with_length(system, rest, f"segments[{k}].{kind}")
        else:
            stretch = np.broadcast_to(np.asarray(fixed, np.float64), rest.shape[:-1])[..., None]
            own = np.concatenate([(stretch - rest) @ np.linalg.pinv(lines.arms).T, stretch], axis=-1)
        out.append(own)
        before = before + own
    return np.stack(out, axis=-2)


def _only_length(segment: Segment) -> float | None:
    """The length of a segment that cannot stretch."""
    low, high = segment.length
    return low if low == high else None


def _with_length(system: Floats, rest: Floats, key: str) -> Floats:
    """Bend and length (..., 3) by least squares; `system` (m, 3) maps them to the lines `rest` (..., m)."""
    if np.linalg.matrix_rank(system, tol=1e-9) < 3:
        raise InputError(key, "do not determine the length", len(system), "three lines or more")
    result: Floats = rest @ np.linalg.pinv(system).T
    return result
