"""Shortcuts: a path is pulled tight, every edge proved clear, with bounds of how clear.

An edge has an answer (14,), see `certificate.query`: its verdict, until when it is proved, and what was seen.

`p` (n, 3) and `q` (n, 3) are the ends of an edge.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.proof import CLEAR, UNDECIDED
from sinuous.kernels.certificate.query import CLEARANCES, UNTIL, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, LEAST_SEEN, PROVED_BOUND
from sinuous.kernels.chain.kinematics import interpolate
from sinuous.kernels.clock import late
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.planning.space import (
    Space,
    best_bound,
    bound_edge,
    bound_edge_again,
    distance,
    prove_edge,
    random,
    seems_clear,
)

Path = namedtuple("Path", ["q", "answers"])
"""Configurations (p, n, 3), and answers (p, 14) about the edges that begin there."""

Exactness = namedtuple("Exactness", ["slack", "of_edges", "finest", "coarse", "loose"])
"""How far below the truth the clearance of the path may be, and that of any edge, as a share of it; the length below
which a proof is not halved; the one for evaluations before a proof; and the one where it is not known what a proof
says."""


def forget_edges(path: Path, count: int) -> None:
    """Know nothing about the edges between `count` configurations."""
    for i in range(count - 1):
        path.answers[i, VERDICT] = UNDECIDED


def path_length(space: Space, path: Path, count: int) -> float:
    """Length of the first `count` configurations of a path."""
    total = 0.0
    for i in range(count - 1):
        total += distance(path.q[i], path.q[i + 1], space.levers)
    return total


def prove_clear(space: Space, p: Array, q: Array, exact: Exactness, answer: Array) -> bool:
    """Prove an edge that is thought to be clear, and fill its answer (14,): first that it is, then how clear."""
    verdict, until = prove_edge(space, p, q, exact.finest, False)
    clear = _keep_answer(space, verdict, until, answer)
    if clear:
        verdict, until = bound_edge(space, p, q, exact.of_edges, exact.finest)
        if verdict == CLEAR:
            _keep_answer(space, verdict, until, answer)
    return clear


def _keep_answer(space: Space, verdict: int, until: float, answer: Array) -> bool:
    """Fill an answer (14,) with what was proved last; say whether it is CLEAR."""
    answer[VERDICT], answer[UNTIL] = verdict, until
    for row in range(2):
        for column in range(CLEARANCES_WIDTH):
            answer[CLEARANCES + row * CLEARANCES_WIDTH + column] = space.seen[row, column]
    return verdict == CLEAR


def joins(space: Space, p: Array, q: Array, exact: Exactness, slack: float, answer: Array) -> bool:
    """Whether an edge is proved clear, with bounds `slack` below the truth; its answer (14,) is filled then."""
    if not seems_clear(space, p, q, exact.coarse):
        return False
    verdict, until = bound_edge(space, p, q, slack, exact.loose)
    return verdict == CLEAR and _keep_answer(space, verdict, until, answer)


def _least_clear(path: Path, count: int, seen: int) -> int:
    """The edge whose bound is the least, of those that are proved; the answer has that from column `seen` on."""
    least, at = math.inf, -1
    for i in range(count - 1):
        if path.answers[i, VERDICT] == CLEAR and path.answers[i, seen + PROVED_BOUND] < least:
            least, at = path.answers[i, seen + PROVED_BOUND], i
    return at


def bound_worst(space: Space, path: Path, count: int, exact: Exactness) -> None:
    """Bound more tightly the edges that decide how clear a path of `count` configurations is.

    Bounds of all other edges are less tight: close to obstacles those take long.
    """
    for row in range(2):
        seen, last = CLEARANCES + row * CLEARANCES_WIDTH, -1
        for _ in range(count - 1):
            i = _least_clear(path, count, seen)
            if i < 0 or i == last or not _can_be_tighter(space, path, i, row, exact):
                break
            last = i
            _recall_answer(space, path.answers[i])
            if not bound_edge_again(space, path.q[i], path.q[i + 1], exact.slack, exact.finest, row):
                break
            for column in range(CLEARANCES_WIDTH):
                path.answers[i, seen + column] = space.seen[row, column]


def _can_be_tighter(space: Space, path: Path, i: int, row: int, exact: Exactness) -> bool:
    """Whether edge `i` is bounded less tightly than it is to be, and another proof may change that."""
    low, least = (
        path.answers[i, CLEARANCES + row * CLEARANCES_WIDTH + PROVED_BOUND],
        path.answers[i, CLEARANCES + row * CLEARANCES_WIDTH + LEAST_SEEN],
    )
    if least == math.inf or low >= (1.0 - exact.slack) * least:
        return False
    return bool(low < (1.0 - exact.slack) * best_bound(space, path.q[i], path.q[i + 1], row))


def _recall_answer(space: Space, answer: Array) -> None:
    """Let the space have `seen` what an answer (14,) says."""
    for row in range(2):
        for column in range(CLEARANCES_WIDTH):
            space.seen[row, column] = answer[CLEARANCES + row * CLEARANCES_WIDTH + column]


def skip_knots(space: Space, path: Path, count: int, exact: Exactness, sure: bool) -> tuple[int, int]:
    """Leave out configurations where the motion past them is clear, and prove the rest.

    From each configuration the motion to the last one is tried, then to one half as far away, and so on. When it is
    `sure`, what lies between neighbours was proved before; if that is over now, or less exact, its answer stays
    undecided. Otherwise it was only examined, and the motion from the first to the last was tried already.

    Returns how many configurations are left, and the edge of the path as it was that is not clear (-1: none was found
    that is not): then the path is not one any more.
    """
    kept = at = 0
    while at < count - 1:
        far = 1 if late(space.sweep.clock) else count - 1 - at
        if at == 0 and not sure:
            far = max(1, far - 1)
        while far > 1 and not joins(space, path.q[kept], path.q[at + far], exact, exact.of_edges, path.answers[kept]):
            far = 1 if late(space.sweep.clock) else far // 2
        if far == 1:
            if path.answers[at, VERDICT] == CLEAR:
                copy(path.answers[at : at + 1], path.answers[kept : kept + 1])
            elif sure or not joins(space, path.q[kept], path.q[at + 1], exact, exact.of_edges, path.answers[kept]):
                clear = prove_clear(space, path.q[kept], path.q[at + 1], exact, path.answers[kept])
                if not (clear or sure or late(space.sweep.clock)):
                    return 0, at
        at += far
        kept += 1
        copy(path.q[at], path.q[kept])
    return kept + 1, -1


def _put_place_on_path(space: Space, path: Path, count: int, along: float, out: Array) -> int:
    """Fill `out` (n, 3) with the configuration at a length along the path; return the edge that it is on."""
    i, length = 0, distance(path.q[0], path.q[1], space.levers)
    while along > length and i < count - 2:
        along, i = along - length, i + 1
        length = distance(path.q[i], path.q[i + 1], space.levers)
    interpolate(path.q[i], path.q[i + 1], min(1.0, along / length) if length > 0.0 else 0.0, out)
    return i


def _move_knot(path: Path, i: int, to: int) -> None:
    """Put configuration `i`, and the answer of the edge that begins there, in another place."""
    copy(path.q[i], path.q[to])
    copy(path.answers[i : i + 1], path.answers[to : to + 1])


def _replace_edges(path: Path, count: int, a: int, b: int, ends: Array, answer: Array) -> int:
    """Put an edge, `ends` (2, n, 3), in the place of what lies between edges `a` < `b`; return the number then.

    What is left of these edges is as clear as they were.
    """
    moved = a + 3 - (b + 1)
    last = path.answers[b : b + 1]
    if moved > 0:
        for i in range(count - 1, b, -1):
            _move_knot(path, i, i + moved)
        copy(path.answers[b : b + 1], path.answers[a + 2 : a + 3])
    else:
        copy(last, path.answers[a + 2 : a + 3])
        for i in range(b + 1, count):
            _move_knot(path, i, i + moved)
    copy(ends[0], path.q[a + 1])
    copy(ends[1], path.q[a + 2])
    copy(answer, path.answers[a + 1 : a + 2])
    return count + moved


def shorten(space: Space, path: Path, count: int, tries: int, seed: int, exact: Exactness, ends: Array) -> int:
    """Join random places of a path of `count` configurations, so often as there are `tries`.

    The places lie on different edges. Returns how many configurations it has then. `ends` (2, n, 3) is scratch, and so
    is the last answer of the path.
    """
    most = path.q.shape[0] - 1
    answer = path.answers[most : most + 1]
    for i in range(tries):
        if count <= 2 or count >= most or late(space.sweep.clock):
            break
        length = path_length(space, path, count)
        low, high = random(i, seed, 0), random(i, seed, 1)
        a = _put_place_on_path(space, path, count, length * min(low, high), ends[0])
        b = _put_place_on_path(space, path, count, length * max(low, high), ends[1])
        if b <= a or not seems_clear(space, ends[0], ends[1], exact.coarse):
            continue
        if prove_clear(space, ends[0], ends[1], exact, answer[0]):
            count = _replace_edges(path, count, a, b, ends, answer)
    return count
