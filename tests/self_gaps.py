"""Which places of a sampled body concern each other, by the words of the definition: an oracle for all its proofs."""

import math
from itertools import combinations_with_replacement, pairwise
from typing import NamedTuple

import numpy as np
from scipy.spatial.distance import cdist

from tests.helpers import Floats, frames_of


class Sampled(NamedTuple):
    """Places of a body, in order: where (m, 3), tangents (m, 3), length and turn before (m,), radii and runs (m,)."""

    points: Floats
    tangents: Floats
    along: Floats
    turned: Floats
    radii: Floats
    runs: Floats


def sample_body(q: Floats, radii: Floats, pieces: int, base: Floats | None = None) -> Sampled:
    """Divide every segment of a body in configuration `q` (n, 3) into so many pieces; `base` (4, 4)."""
    fractions = np.linspace(0.0, 1.0, pieces + 1)
    frames = frames_of(q, base)
    points, tangents = [], []
    for k, (ux, uy, length) in enumerate(q):
        u, turn = math.hypot(ux, uy), frames[k, :9].reshape(3, 3)
        angle = u * fractions
        side = np.array([ux, uy, 0.0]) / u if u > 0.0 else np.zeros(3)
        aside = length * np.where(angle > 1e-6, (1.0 - np.cos(angle)) / max(u, 1e-300), 0.5 * angle * fractions)
        ahead = length * np.where(angle > 1e-6, np.sin(angle) / max(u, 1e-300), fractions)
        local = aside[:, None] * side + ahead[:, None] * [0.0, 0.0, 1.0]
        points.append(frames[k, 9:] + local @ turn.T)
        tangents.append((np.sin(angle)[:, None] * side + np.cos(angle)[:, None] * [0.0, 0.0, 1.0]) @ turn.T)
    bends, lengths = np.hypot(q[:, 0], q[:, 1]), q[:, 2]
    along = ((np.cumsum(lengths) - lengths)[:, None] + lengths[:, None] * fractions).ravel()
    turned = ((np.cumsum(bends) - bends)[:, None] + bends[:, None] * fractions).ravel()
    thick = np.asarray(radii, np.float64)
    runs = np.concatenate([[0.0], np.cumsum(np.diff(thick) != 0.0)])
    each = [np.repeat(values, pieces + 1) for values in (thick, runs)]
    return Sampled(np.concatenate(points), np.concatenate(tangents), along, turned, *each)


def gaps_of(body: Sampled) -> Floats:
    """Gaps (m, m) of all places that concern each other, the first nearer to the base; infinite of the others."""
    gaps = np.full((len(body.points),) * 2, np.inf)
    cuts = [*np.flatnonzero(np.diff(body.runs, prepend=-1.0)), len(gaps)]
    parts = [slice(*ends) for ends in pairwise(cuts)]  # of one radius each
    for a, b in combinations_with_replacement(parts, 2):
        both = body.radii[a.start] + body.radii[b.start]
        if a == b:
            concerned = body.along[b] - body.along[a, None] >= math.pi * body.radii[a.start]
        else:
            concerned = body.turned[b] - body.turned[a, None] >= 0.5 * math.pi
        if both == 0.0 or not concerned.any():
            continue
        p, t, q, u = body.points[a], body.tangents[a], body.points[b], body.tangents[b]
        if a != b:
            here = t @ q.T - (p * t).sum(axis=1)[:, None]
            there = (q * u).sum(axis=1) - p @ u.T
            concerned &= (here <= 0.0) | (there <= 0.0)
        gaps[a, b][concerned] = cdist(p, q)[concerned] - both
    return gaps
