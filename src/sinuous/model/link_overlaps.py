"""Links whose bodies overlap in nearly all configurations: capsules that are too thick, or links that are meant to."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.joints import RigidRows

SAMPLES = 100
"""Configurations that are tried."""

NEARLY_ALL = 0.95
"""Share of them from which on it is told."""


def overlap_notes(rigid: RigidRows, joint_names: Sequence[str], begins: Callable[[Floats], Floats]) -> Iterator[str]:
    """Yield a line for each pair of links that may not touch, and overlap nearly everywhere within the limits.

    `begins` tells of values (m, j) of the joints the poses (m, r, 4, 4) in which rows of joints and links begin.
    """
    rows = [(k, row) for k, row in enumerate(rigid.rows) if row.has_body]
    pairs: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for i, (_, one) in enumerate(rows):
        for j, (_, other) in enumerate(rows[:i]):
            if not one.touches >> other.link & 1:
                pairs.setdefault((other.link, one.link), []).append((j, i))
    if not pairs:
        return
    low, high = np.array([joint.limits for joint in rigid.moving]).T
    poses = begins(np.random.default_rng(0).uniform(low, high, (SAMPLES, len(low))))
    capsules = []
    for k, row in rows:
        start = poses[:, k, :3, 3]
        capsules.append((start, start + row.length[1] * poses[:, k, :3, 2], row.radius))
    names = ("base", *joint_names)
    for (a, b), own in pairs.items():
        overlap = np.zeros(SAMPLES, np.bool_)
        for i, j in own:
            (p, q, r), (u, v, s) = capsules[i], capsules[j]
            overlap |= segment_distances(p, q, u, v) < r + s
        if overlap.mean() >= NEARLY_ALL:
            seen = f"overlap in {int(overlap.sum())} of {SAMPLES} random configurations"
            yield f"links of {names[a]} and {names[b]} {seen}: `touches` of {names[b]}, or an SRDF, allows it"


def segment_distances(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Distances (m,) between segments from a to b and from c to d, each (m, 3).

    They are nearest in their insides, or at one of the four ends (Ericson 2005).
    """
    along, other, apart = b - a, d - c, a - c
    aa, ab, bb = (np.einsum("mi,mi->m", *pair) for pair in ((along, along), (along, other), (other, other)))
    x, y = np.einsum("mi,mi->m", along, apart), np.einsum("mi,mi->m", other, apart)
    tiny = np.finfo(np.float64).tiny
    area = aa * bb - ab * ab
    s = np.clip((ab * y - bb * x) / np.maximum(area, tiny), 0.0, 1.0)
    t = np.clip((s * ab + y) / np.maximum(bb, tiny), 0.0, 1.0)
    found = [np.linalg.norm(apart + s[:, None] * along - t[:, None] * other, axis=1)]
    for p, q, u in ((a, b, c), (a, b, d), (c, d, a), (c, d, b)):  # how far u is from what is between p and q
        line = q - p
        share = np.einsum("mi,mi->m", u - p, line) / np.maximum(np.einsum("mi,mi->m", line, line), tiny)
        found.append(np.linalg.norm(p + np.clip(share, 0.0, 1.0)[:, None] * line - u, axis=1))
    result: Floats = np.min(found, axis=0)
    return result
