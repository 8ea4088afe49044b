"""The planners in the order in which they are tried: among obstacles that stand still, and among some that move."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from itertools import count, islice

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.kernels.fitting.query import ball_radius
from sinuous.motion.configurations import lever_metric, overlap_at
from sinuous.motion.planning.contact_retraction import ContactRetractionTrees
from sinuous.motion.planning.local_planner import LocalPlanner
from sinuous.motion.planning.path_pacing import pace_path
from sinuous.motion.planning.query import Deadline, ProvedPath, Query, TargetGoals, TimedQuery
from sinuous.motion.planning.retraction import ENOUGH, KINDS, Retraction
from sinuous.motion.planning.rrt_connect import RRTConnect
from sinuous.motion.planning.timed_tree import grow_timed_tree
from sinuous.motion.planning.tree import Chain
from sinuous.scene.moving import Moving
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import LOOSE_SECONDS, SLACK, Prover

EASY = 16
"""Draws of the first trees among very many obstacles; before the next ones, it is listed where which of them are near.
"""

FIRST_DRAWS = 64
"""Draws of trees that grow from the ends as they are, before more goals are looked for."""

MORE_DRAWS = 128
"""The same in all, before goals are drawn back a little."""

LAST_DRAWS, LAST_DRAWS_OF_LINKS = 512, 1024
"""The same in all, before the first turn that draws an end back as far as that goes; and of arms of links alone, which
do not slide along themselves."""

FIRST_GOALS = 2
"""Goals that are drawn back a little."""

FIRST_STEPS = 8
"""By how many steps, as long as the first way to draw them back leads on."""

DRAWS = 128
"""Draws of trees in the first turn; in each turn they are planted anew, with so many more."""

RETRACTED_DRAWS = 8
"""Draws of the contact-retraction trees in a turn: where a retraction is stuck, one from nearby often is not. In the
first turn they have none: straight trees are sooner where they get there."""

ROOTS = 12
"""Knots of one retraction that trees grow from."""

STRAIGHT_GOALS = 4
"""Goals to which straight lines are paced."""

SEEDS = 4
"""Seeds with which paths past obstacles that stand still are planned, to be paced."""

MOMENTS = 5
"""Times of a first path that is to be paced: it is planned past obstacles that move as they stand at all of these."""

SHARE = 0.1
"""Share of the time left that planning a path to be paced may take."""


TURNS_WITH_TENSIONS = 6
"""Turns of the search that does not know limits of tensions, where there are any."""

SHARE_WITH_TENSIONS = 0.5
"""Share of the time left that these may take."""


def find_path(query: Query, trees: RRTConnect | None = None) -> ProvedPath | None:
    """Look for a path turn by turn; `None` when the time is over.

    Under load only a tree grows, whose edges are proved one by one. So it does, after a while, where tensions are
    limited: other trees do not know these.

    `trees`: memory of this robot and scene, to grow trees in.
    """
    if query.robot.has_external_load:
        return _by_proofs(query)
    trees = trees or RRTConnect(query.robot, query.scene)
    if query.robot.limit_set.tension_rows is None:
        return _first_path(PlanSearch(query, trees).paths())
    first = replace(query, deadline=Deadline(SHARE_WITH_TENSIONS * query.deadline.left()))
    path = _first_path(islice(PlanSearch(first, trees).paths(), TURNS_WITH_TENSIONS))
    return path if path is not None and (path.answers[:, VERDICT] == CLEAR).all() else _by_proofs(query)


def _first_path(paths: Iterator[ProvedPath | None]) -> ProvedPath | None:
    return next((path for path in paths if path is not None), None)


class PlanSearch:
    """Joins a start with goals, all of which may be in narrow places.

    Straight trees grow from the ends as they are. Then, turn by turn, a goal or the start is drawn back along itself,
    and trees join what is known: straight ones, and contact-retraction trees.

    Parameters
    ----------
    query : Query
    trees : RRTConnect
    """

    def __init__(self, query: Query, trees: RRTConnect) -> None:
        self._query, self._trees = query, trees
        self._goals = np.empty((0, *query.start.shape))
        self._outs: list[Chain] = []
        self._ins: list[Chain] = []
        self._left = [math.inf, math.inf]  # least length in front of the tip, of the start and of goals: robot lengths
        self._begun: dict[tuple[bytes, int], Retraction] = {}

    @cached_property
    def _local(self) -> LocalPlanner:
        return LocalPlanner(self._query)

    @cached_property
    def _retracted(self) -> ContactRetractionTrees:
        return ContactRetractionTrees(self._local, self._query.seed)

    @cached_property
    def _joining(self) -> RRTConnect:
        """Trees beside those that grow from the ends as they are."""
        return RRTConnect(self._query.robot, self._query.scene)

    def paths(self) -> Iterator[ProvedPath | None]:
        """Yield the path that is found, or `None` after each turn, until the time is over."""
        query, path = self._query, None
        if isinstance(query.goals, TargetGoals):
            path = self._between_ends((0, 0))
            if path is None:
                query.goals.add_simplest()
        if path is None and query.scene.has_hierarchy:
            path = self._between_ends((0, EASY))
            query.scene.list_near(query.robot.base[:3, 3], query.robot.longest, ball_radius(query.robot.limits))
        yield path or self._between_ends((0, FIRST_DRAWS))
        yield self._between_ends((FIRST_DRAWS, MORE_DRAWS))
        yield self._from_little_back()
        yield self._between_ends((MORE_DRAWS, LAST_DRAWS if query.robot.segments else LAST_DRAWS_OF_LINKS))
        for turn in count():
            if query.deadline.left() <= 0.0:
                return
            self._draw_back(turn)
            yield self._grow_straight(turn) or self._grow_retracted(turn)

    def _between_ends(self, draws: tuple[int, int]) -> ProvedPath | None:
        """Let trees grow from the ends as they are, anew where they begin with draw 0."""
        query, known = self._query, len(self._goals) if draws[0] > 0 else 0
        self._goals = query.goals(self._trees.reached if draws[0] > 0 else query.start[None])
        roots = np.concatenate([query.start[None], self._goals[known:]])
        return self._trees.grow(roots, query.seed, draws, query.deadline, query.shortcuts)

    def _from_little_back(self) -> ProvedPath | None:
        """Draw back the first goals a little, and let straight trees grow from the start to there.

        The last one first: what was solved without the start has fewer folds. Arms of links alone do not slide along
        themselves, and trees are there sooner.
        """
        query = self._query
        for goal in self._goals[FIRST_GOALS - 1 :: -1] if query.robot.segments else ():
            made = self._retraction(goal, 0, query.start)
            made.run(FIRST_STEPS, ways=1)
            path = self._join([query.start], [made.knots], query.seed, FIRST_DRAWS)
            if path is not None:
                return path
        return None

    def _draw_back(self, turn: int) -> None:
        """Draw back a goal or the start: at first a goal by each kind, then the end that came less far, or by turns.

        After each kind, it is drawn back from what contact-retraction trees have reached.
        """
        start, goals, left = self._query.start, self._query.goals(self._trees.reached), self._left
        side = 1
        if turn >= len(KINDS):
            side = turn % 2 if left[0] == left[1] else int(left[1] > left[0])
        ends, chains = ([start], goals)[side], (self._outs, self._ins)[side]
        number, kind = divmod(len(chains), len(KINDS))
        chain = [ends[number]] if number < len(ends) else self._retracted.random_branch(side)
        made = self._retraction(chain[-1], kind, (goals[0], start)[side])
        made.run()
        chains.append([*chain[:-1], *made.knots])
        left[side] = min(left[side], max(ENOUGH, made.left / self._query.robot.mean_length))

    def _retraction(self, end: Floats, kind: int, other: Floats) -> Retraction:
        """Return the retraction of an end: the one that has begun, where there is one."""
        key = end.tobytes(), kind
        if key not in self._begun:
            self._begun[key] = Retraction(self._local, end, kind, other)
        return self._begun[key]

    def _grow_straight(self, turn: int) -> ProvedPath | None:
        """Let straight trees grow from the start, or the end of one of its retractions, to knots of the goals'."""
        query, out = self._query, [self._query.start]
        if self._outs and turn % 2 == 0:
            out = self._outs[-1]
        ins = [*self._ins, *([q] for q in query.goals(query.start[None]))]
        return self._join(out, ins, (query.seed + turn) % 2**31, DRAWS * (turn + 1))

    def _join(self, out: Chain, ins: list[Chain], seed: int, draws: int) -> ProvedPath | None:
        """Let trees grow from the end of a chain of the start's to knots of the goals', and lead on into the ends."""
        knots = [q for chain in ins for q in self._choose_knots(chain, out[-1])]
        path = self._joining.grow(np.stack([out[-1], *knots]), seed, (0, draws), self._query.deadline)
        if path is None:
            return None
        end = path.q[-1]
        into = next(chain[i::-1] for chain in ins for i, q in enumerate(chain) if np.array_equal(q, end))
        return self._shortened([*out, *path.q[1:-1], *into])

    def _grow_retracted(self, turn: int) -> ProvedPath | None:
        """Let contact-retraction trees grow from the start and its retractions, and from the goals'."""
        self._retracted.plant(0, [[self._query.start], *self._outs])
        self._retracted.plant(1, self._ins)
        found = self._retracted.grow(0 if turn == 0 else RETRACTED_DRAWS)
        return None if found is None else self._shortened(found)

    def _choose_knots(self, knots: Chain, out: Floats) -> Chain:
        """Some of the knots, the last one first, and the one that is nearest to a configuration (n, 3)."""
        some = np.linspace(len(knots) - 1, 0, ROOTS).round().astype(int)
        squares = np.square((np.stack(knots) - out) * lever_metric(self._query.robot)).sum(axis=(1, 2))
        return [knots[i] for i in np.unique(np.append(some, squares.argmin()))[::-1]]

    def _shortened(self, chain: Chain) -> ProvedPath:
        query = self._query
        return self._trees.shorten(np.stack(chain), query.seed, query.deadline, query.shortcuts)


def _by_proofs(query: Query) -> ProvedPath | None:
    """Find a path by a tree whose edges the prover itself proves; it grows in a time that is made up."""
    timed = query.in_time(Prover(query.robot, query.scene), 0.0, 1.0)
    path = _straight(timed) or grow_timed_tree(timed)
    return None if path is None else join_edges(timed, path)._replace(times=None)


def find_timed_path(query: TimedQuery) -> ProvedPath | None:
    """Find a path in time to one of the goals; `None` when the time is over.

    The straight line is tried at even speed; then straight lines, a path past obstacles as they stand at several times,
    and paths past those that stand still are paced; then a tree grows in time. Edges of that tree do not keep limits of
    acceleration: under these, its branch is paced again.
    """
    path = None
    if not query.early and query.accelerations is None:
        path = _straight(query)
    if path is None:
        path = _paced(query)
    if path is None:
        path = _grown(query)
    return None if path is None else join_edges(query, path)


def standing(scene: Snapshot) -> Snapshot:
    """Return what stands still of a scene."""
    if not scene.moves:
        return scene
    return Snapshot(tuple(own for own in scene.obstacles if not isinstance(own, Moving)))


def _straight(query: TimedQuery) -> ProvedPath | None:
    goal = query.goals(query.start[None])[0]
    answer = query.prove_in_time(query.start, goal, query.begin, query.end)
    if answer is None:
        return None
    return ProvedPath(np.stack([query.start, goal]), answer[None], np.array([query.begin, query.end]))


def _paced(query: TimedQuery) -> ProvedPath | None:
    """Pace one path after the other; `None` where none can be, or the time is over."""
    for q in _untimed_paths(query):
        path = pace_path(query, q)
        if path is not None or query.deadline.left() <= 0.0:
            return path
    return None


def _untimed_paths(query: TimedQuery) -> Iterator[Floats]:
    """Yield configurations (p, n, 3) of paths without times."""
    goals = query.goals(query.start[None])
    for goal in goals[:STRAIGHT_GOALS]:
        yield np.stack([query.start, goal])
    still = standing(query.scene)
    moments = [query.scene.at(t) for t in np.linspace(query.begin, query.end, MOMENTS).tolist()]
    everywhere = Snapshot((*still.obstacles, *(there.obstacles[i] for i in query.scene.courses for there in moments)))
    for seed, scene in enumerate([everywhere, *[still] * SEEDS]):
        q = _untimed_path(query, scene, query.seed + seed)
        if q is not None and len(q) > 2:
            yield q


def _untimed_path(query: TimedQuery, scene: Snapshot, seed: int) -> Floats | None:
    """Plan a path in a scene that stands still, where its ends are clear there."""
    prover = Prover(query.robot, scene)
    ends = query.start, query.goals(query.start[None])[0]
    if any(overlap_at(query.robot, q, prover) is not None for q in ends):
        return None
    deadline = Deadline(SHARE * query.deadline.left())
    path = find_path(Query(query.robot, scene, query.start, query.goals, seed % 2**31, deadline))
    return None if path is None else path.q


def _grown(query: TimedQuery) -> ProvedPath | None:
    """Grow a tree in time; under limits of acceleration, pace its branches, with one seed after the other."""
    seed, path = query.seed, None
    while path is None and query.deadline.left() > 0.0:
        path = grow_timed_tree(replace(query, seed=seed))
        if query.accelerations is None:
            return path
        if path is not None:
            moves = np.abs(np.diff(path.q, axis=0)).max(axis=(1, 2)) > 0.0
            path = pace_path(query, path.q[np.append(True, moves)])
        seed = (seed + 1) % 2**31
    return path


def join_edges(query: TimedQuery, path: ProvedPath) -> ProvedPath:
    """Join edges where the joined one is clear, and bound the clearances of what is left as tightly as is usual.

    Where accelerations are limited no edges are joined: the speed would change more in the corners that are left.
    """
    assert path.times is not None
    when = path.times.tolist()
    kept, answers = [0], []
    last = len(path.q) - 1
    while kept[-1] < last:
        at = kept[-1]
        far = last - at if query.accelerations is None else 1
        joined = None
        while far > 1 and joined is None:
            if query.deadline.left() > 0.0:
                joined = query.prove_in_time(path.q[at], path.q[at + far], when[at], when[at + far])
            far = far if joined is not None else far // 2
        answer = path.answers[at] if joined is None else joined
        kept.append(at + max(1, far))
        tight = query.prover.prove(path.q[[at, kept[-1]]], SLACK, LOOSE_SECONDS, path.times[[at, kept[-1]]])
        answers.append(tight[0] if tight[0, VERDICT] == CLEAR else answer)
    return ProvedPath(path.q[kept], np.stack(answers), path.times[kept])
