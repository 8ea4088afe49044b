"""The proof that the body does not run through itself, against dense sampling of the definition."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from sinuous.kernels.body import self_proof
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.body.self_contacts import MOST_PAIRS, PAIR_VALUE, self_contacts
from sinuous.kernels.body.self_pairs import SPAN_WIDTH, Shape
from sinuous.kernels.clock import STRIDE, WORK
from sinuous.kernels.packing import segment_row
from tests.helpers import Floats, columns_of, frames_of
from tests.kernels.workspace import make_clock
from tests.self_gaps import gaps_of, sample_body

SAMPLES, MOST_PLACES = 100, 800
"""Places of a segment; and of the whole body, at most."""

FINEST = 1e-7


def table_of(radii: Floats | Sequence[float]) -> Floats:
    """Rows of segments with these radii, and no other limits."""
    return np.array([segment_row((0.0, 10.0), 6.0, math.inf, radius, radius) for radius in radii])


def prove(
    q: Floats, radii: Floats | Sequence[float], base: Floats | None = None, clock: Any = None
) -> tuple[int, float, tuple[int, float, int, float]]:
    shape = Shape(table_of(radii), q, frames_of(q, base), np.full((len(q) + 1, SPAN_WIDTH), np.nan))
    clock = make_clock() if clock is None else clock
    return self_proof.prove_self(shape, FINEST * float(q[:, 2].sum()), clock)


def sampled(q: Floats, radii: Floats | Sequence[float], most: int = SAMPLES) -> tuple[float, float]:
    """Least gap by the definition, over many places; and by how much it may be above the truth."""
    samples = min(most, MOST_PLACES // len(q))
    gaps = gaps_of(sample_body(q, np.asarray(radii, np.float64), samples))
    return float(gaps.min()), float(q[:, 2].max()) / samples


def curled(rng: np.random.Generator, radii: Floats | Sequence[float], most: float) -> Floats:
    """A shape with bends up to `most`, that nowhere bends more tightly than it is thick."""
    n = len(radii)
    lengths = rng.uniform(0.3, 1.5, n)
    caps = np.minimum(most, lengths * 0.999999 / np.maximum(radii, 1e-9))
    bends = caps * np.sqrt(rng.random(n))
    angles = rng.normal(0.0, 0.7, n) + rng.uniform(-math.pi, math.pi)
    return np.stack([bends * np.cos(angles), bends * np.sin(angles), lengths], axis=-1)


CASES = (
    (2, 3.0, (0.05, 0.3)),
    (3, 5.5, (0.05, 0.3)),
    (5, 2.0, (0.02, 0.4)),
    (8, 1.6, (0.02, 0.3)),
    (5, 0.6, (0.02, 0.4)),
)


@pytest.mark.parametrize(("n", "most", "thick"), CASES)
@pytest.mark.parametrize("several", [False, True])
def test_the_proof_agrees_with_dense_sampling(n: int, most: float, thick: tuple[float, float], several: bool) -> None:
    rng = np.random.default_rng(n)
    verdicts = {CLEAR: 0, TOUCHING: 0, UNDECIDED: 0}
    for _ in range(30):
        radii = rng.uniform(*thick, n) if several else np.full(n, rng.uniform(*thick))
        if several and rng.random() < 0.3:
            radii[rng.integers(n)] = 0.0
        q = curled(rng, radii, most)
        verdict, gap, _ = prove(q, radii)
        least, spacing = sampled(q, radii)
        verdicts[verdict] += 1
        if verdict == CLEAR:
            assert gap <= least + 1e-12, "the bound is above what was seen"
            assert least > 0.0
        elif verdict == TOUCHING:
            assert least < 2.0 * spacing
            assert gap >= least - 2.0 * spacing
        else:
            assert abs(least) < 2.0 * spacing, "undecided though plain"
    assert verdicts[CLEAR] >= 5


def ring(bend: float, length: float = 1.0) -> Floats:
    return np.array([[bend, 0.0, length]])


@pytest.mark.parametrize("bend", [4.0, 5.0, 6.0, 2 * math.pi - 1e-3])
def test_a_single_arc_touches_itself_when_its_ends_do(bend: float) -> None:
    chord = 2.0 / bend * math.sin(0.5 * bend)
    for gap in (1e-2, 1e-6):
        if chord > 2.0 * gap:
            assert prove(ring(bend), [0.5 * (chord - gap)])[0] == CLEAR
        verdict, seen, where = prove(ring(bend), [0.5 * (chord + gap)])
        assert verdict == TOUCHING
        assert seen == pytest.approx(-gap, abs=1e-9)
        assert (where[0], where[2]) == (0, 0)
    assert [prove(ring(whole), [1e-6])[0] for whole in (2.0 * math.pi, 7.0)] == [TOUCHING] * 2


@pytest.mark.parametrize("radius", [0.1, 0.3])
def test_a_body_that_nobody_looks_at_has_the_gap_of_its_shortest_way_round(radius: float) -> None:
    """A straight body has a gap of pi radii less two; one that is shorter than pi radii has no two such places."""
    straight = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.5]])
    verdict, gap, where = prove(straight, [radius] * 2)
    assert (verdict, where[0]) == (CLEAR, -1)
    assert gap == pytest.approx((math.pi - 2.0) * radius)
    assert prove(straight * 0.6 * radius, [radius] * 2)[:2] == (CLEAR, math.inf)
    assert prove(np.array([[6.0, 0.0, 1.0]] * 5), [0.0] * 5)[:2] == (CLEAR, math.inf)


THIN, THICK = 0.01, 0.1
FOLDED = {
    "a thick part turns, and comes beside itself": ((0.2, 0.1, 0.1), (1.0, 0.45, 1.0), math.pi, TOUCHING),
    "the same, all thin": ((0.1, 0.1, 0.1), (1.0, 0.45, 1.0), math.pi, CLEAR),
    "a thin part goes back within a thick one": ((THICK, THIN, THIN), (0.5, 4.7 * THIN, 0.2), math.pi, TOUCHING),
    "the same, hardly": ((THICK, THIN, THIN), (0.5, 4.7 * THIN, 0.05), math.pi, TOUCHING),
    "about a hinge without thickness": ((0.02, 0.0, 0.02), (0.5, 0.002, 0.5), math.pi, TOUCHING),
    "the same, shorter than pi radii": ((0.02, 0.0, 0.02), (0.01, 0.002, 0.01), math.pi, TOUCHING),
    "a thin part leads away from a thick one": ((THICK, THIN, THIN), (0.5, 0.02, 0.5), 1.5, CLEAR),
    "a thick part leads away from a thin one": ((THIN, THIN, THICK), (0.5, 0.02, 0.5), 1.5, CLEAR),
    "a wrist beyond a thick arm": ((THICK, THIN, THIN), (0.5, 0.051, 0.5), 1.7, CLEAR),
    "a wrist that bends into the arm": ((THICK, THIN, THIN), (0.5, 0.072, 0.5), 2.4, TOUCHING),
}
"""Radii and lengths of three segments, the second of which is bent (rad); and the verdict."""


@pytest.mark.parametrize("name", FOLDED)
def test_parts_of_several_radii_touch_where_they_are_folded_and_not_where_they_lead_away(name: str) -> None:
    radii, lengths, bend, expected = FOLDED[name]
    q = np.array([[0.0, 0.0, lengths[0]], [bend, 0.0, lengths[1]], [0.0, 0.0, lengths[2]]])
    verdict, gap, _ = prove(q, radii)
    assert (verdict, gap > 0.0) == (expected, expected == CLEAR)
    assert (sampled(q, radii)[0] > 0.0) == (expected == CLEAR)


def test_long_arms_of_many_segments_touch_where_they_meet_alone() -> None:
    """At their ends: whoever passes over what is far must not pass over what comes back."""
    arm, bend = [[0.0, 0.0, 0.3]] * 10, math.pi + 0.14
    q, radii = np.array([*arm, [bend, 0.0, 0.2 * bend], *arm]), [0.02] * 21
    verdict, _gap, where = prove(q, radii)
    assert (verdict, where[0], where[2] > 18) == (TOUCHING, 0, True)
    assert sampled(q, radii)[0] < 0.0


def test_the_proof_ends_by_its_deadline() -> None:
    rng = np.random.default_rng(5)
    verdicts = []
    for _ in range(40):
        radii = [0.1] * 5
        q = curled(rng, np.array(radii), 2.5)
        late = make_clock(0)
        late[WORK] = STRIDE - 1  # with the next look the time is read
        verdicts.append((prove(q, radii)[0], prove(q, radii, clock=late)[0]))
    assert (CLEAR, UNDECIDED) in verdicts
    assert all(other in (one, UNDECIDED) for one, other in verdicts)


@pytest.mark.parametrize("several", [False, True])
def test_contacts_ask_for_what_is_missing(several: bool) -> None:
    """The least gap that sampling sees is what the strongest asks for; and its bound is one."""
    rng = np.random.default_rng(5)
    seen = 0
    for _ in range(80):
        if seen > 15:
            break
        radii = rng.uniform(0.05, 0.2, 5) if several else np.full(5, 0.15)
        q = curled(rng, radii, 2.4)
        pairs = np.zeros((MOST_PAIRS, 1 + 3 * len(q)))
        shape = Shape(table_of(radii), q, frames_of(q), np.full((len(q) + 1, SPAN_WIDTH), np.nan))
        count, low = self_contacts(shape, columns_of(q), 0.02, 2.0, pairs)
        least, spacing = sampled(q, radii)
        if count == 0:
            assert low == math.inf
            assert least > 0.02 - 1e-12
            continue
        seen += 1
        asked = 2.0 * pairs[:count, PAIR_VALUE].max()
        assert low <= least + 1e-12
        # A tenth of the gap and a quarter of the margin may be missing.
        assert asked >= 0.02 - least - 0.1 * abs(least) - 0.25 * 0.02 - 2.0 * spacing
        assert asked <= 0.02 - least + 2.0 * spacing
    assert seen > 15
