"""Trying changes of a problem that was not solved, within a time that is kept; and where obstacles would give way."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.binding import Binding
from sinuous.answer.solve_again import FoundSolution, SolveAgain
from sinuous.answer.status import Reason, Status
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, rounded_up
from sinuous.base.progress import work_time
from sinuous.measures.obstacles import to_triangles
from sinuous.model.rates import Changes
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.point_cloud import PointCloud

TRIAL_STARTS = 1000
"""Most starts of a trial, where the user gave no bound."""

QUICK_STARTS = 24
"""Starts of a trial that only looks whether a change may do."""

REFINING = 0.6
"""Share of the time after which no change is made smaller any more: the rest is for confirming it."""

FINE = 0.01
"""To which share of itself the smallest change is found."""

SMALLER = 3.0
"""By which factor an amount is made smaller at first."""

LOOKS = 3
"""How often an amount is made smaller before it is given up, where no solution is found with it."""

NOTHING = 1e-4
"""Share of the largest amount below which it is not made smaller."""

MORE = (1.0, 1.05, 1.2, 1.5, 2.0)
"""Factors of the smallest amount that are tried where the whole search, begun anew, finds no solution with it."""

FARTHER = (1.0, 1.02, 1.2, 1.5, 2.0, 3.0)
"""Factors of a first vector that are tried until one does."""

ASIDE = (0.5, 0.25, 0.12, 0.06)
"""Angles, rad, by which vectors beside the best one are turned away from it."""

SHORTER = 0.97
"""Size of a vector that is tried beside the best one, relative to it."""

Amount = Callable[[float], Problem]
"""Makes a problem in which something is changed by an amount greater than 0."""

Vector = Callable[[Floats], Problem]
"""Makes a problem in which something is changed by a vector (3,)."""

Shift = tuple[Floats, FoundSolution]
"""A vector by which something is changed, and a solution with it."""


class Case(NamedTuple):
    """The solve that failed.

    Attributes
    ----------
    problem : Problem
    status : Status
    q : ndarray (n, 3)
        The best configuration.
    given : ndarray (n, 3) or None
        The initial configuration of the user.
    binding : tuple of Binding
    reason : Reason or None
    resolver : SolveAgain
    starts : int
        How many starts were tried.
    within : Changes or None
        The changes from there that were allowed.
    """

    problem: Problem
    status: Status
    q: Floats
    given: Floats | None
    binding: tuple[Binding, ...]
    reason: Reason | None
    resolver: SolveAgain
    starts: int
    within: Changes | None = None


class Trials:
    """Solves changed problems until the time is up; after that every trial fails.

    Parameters
    ----------
    case : Case
    end : float
        When the time is up, by `work_time`.

    Attributes
    ----------
    complete : bool
        Whether no trial was cut short by the time.
    obstacles_matter : bool
        False where no solution was found without obstacles either.
    """

    def __init__(self, case: Case, end: float) -> None:
        self._case = case
        self._end = self._deadline = self._refined = end
        self.complete = self.obstacles_matter = True

    def share(self, part: float) -> None:
        """Give what comes next this part of the time that is left."""
        now = work_time()
        self._deadline = now + max(0.0, self._end - now) * part
        self._refined = now + REFINING * (self._deadline - now)

    def may_refine(self) -> bool:
        """Whether a change may still be made smaller; later, there would be no time left to confirm it."""
        early = work_time() < self._refined
        self.complete &= early
        return early

    @property
    def left(self) -> float:
        """Seconds that are left of this part."""
        return max(0.0, self._deadline - work_time())

    def quick(self, problem: Problem, initial: Floats | None = None) -> FoundSolution | None:
        """Return a solution from a configuration, by default the best of the case, or from a few starts."""
        near = self._case.q if initial is None else initial
        return self._solved(problem, near, routes=False, max_starts=min(QUICK_STARTS, self._most_starts))

    def whole(self, problem: Problem, **options: Any) -> FoundSolution | None:
        """Return a solution that the whole search finds, begun as the user began it."""
        return self._solved(problem, self._case.given, **{"max_starts": self._most_starts, **options})

    @property
    def _most_starts(self) -> int:
        """Most starts of a trial: a search without a bound would take all the time that is left for others."""
        own = self._case.resolver.max_starts
        return TRIAL_STARTS if own is None else own

    def _solved(self, problem: Problem, initial: Floats | None, **options: Any) -> FoundSolution | None:
        left = self.left
        if left <= 0.0:
            self.complete = False
            return None
        budget = options.pop("time", self._case.resolver.seconds)
        try:
            found = self._case.resolver.solve(problem, initial, time=min(budget, left), **options)
        except InputError:  # the change makes something that cannot be
            return None
        if not found.solved and left < budget and self.left <= 0.0:
            self.complete = False
        return found if found.solved else None

    def smallest(self, vary: Amount, most: float, thorough: bool = False) -> float | None:
        """Find the smallest amount, up to `most`, by which something has to be changed.

        A few large amounts come first: where all fail, nothing else is tried. Then the amount is made smaller as long
        as that works, each time from the last solution. At last the whole search is run with it, as a user would. With
        `thorough` that is also done where a few starts find nothing.
        """
        high, found = most, self.quick(vary(most))
        while found is None and high > most / SMALLER**LOOKS:
            high /= SMALLER
            found = self.quick(vary(high))
        if found is None and thorough:
            high, found = most, self.whole(vary(most))
        if found is None:
            return None
        low = 0.0
        while high - low > FINE * high and high > NOTHING * most and self.may_refine():
            middle = max(high / SMALLER, 0.5 * (low + high)) if low > 0.0 else high / SMALLER
            tried = self.quick(vary(middle), found.configuration)
            if tried is None:
                low = middle
            else:
                high, found = middle, tried
        amounts = (min(most, rounded_up(high * more)) for more in MORE if high * more <= most)
        return next((amount for amount in amounts if self.whole(vary(amount)) is not None), None)

    def nearest(
        self, vary: Vector, firsts: Iterable[Floats], least: float, plane: Floats | None = None
    ) -> Shift | None:
        """Find a small vector by which something has to be changed, beginning with the smallest of several that does.

        The border of what can be reached has no formula, so this is a pattern search: the vector is made shorter as
        long as that works; then shorter ones beside it are tried, at ever smaller angles.

        Parameters
        ----------
        vary : callable
        firsts : iterable of ndarray (3,)
            Vectors that may do; those that are zero are passed over.
        least : float
            Length of a vector that counts as none: the search ends there.
        plane : ndarray (3,), optional
            Normal of the plane that all vectors lie in.
        """
        begun = [found for first in firsts if first.any() and (found := self._begin(vary, first)) is not None]
        if not begun:
            return None
        best = self._shorten(vary, min(begun, key=lambda shift: float(np.linalg.norm(shift[0]))), least)
        for angle in ASIDE:
            better: Shift | None = best
            while better is not None and float(np.linalg.norm(best[0])) > least and self.may_refine():
                beside = (
                    SHORTER * (np.cos(angle) * best[0] + np.sin(angle) * np.linalg.norm(best[0]) * across)
                    for across in _across(best[0], plane)
                )
                tried = ((shift, self.quick(vary(shift), best[1].configuration)) for shift in beside)
                better = next(((shift, found) for shift, found in tried if found is not None), None)
                if better is not None:
                    best = self._shorten(vary, better, least)
        return best

    def _begin(self, vary: Vector, first: Floats) -> Shift | None:
        """The first vector, or a longer one in its direction."""
        shifts = (factor * first for factor in FARTHER)
        return next(((shift, found) for shift in shifts if (found := self.quick(vary(shift))) is not None), None)

    def _shorten(self, vary: Vector, best: Shift, least: float) -> Shift:
        """Make a vector shorter, in its direction, as long as that works: in steps that grow, then halving."""
        whole, low, high, step = best[0], 0.0, 1.0, FINE
        size = float(np.linalg.norm(whole))
        while high - low > FINE * high and high * size > least and self.may_refine():
            middle = high - min(step, 0.5 * (high - low))
            found = self.quick(vary(middle * whole), best[1].configuration)
            if found is None:
                low, step = middle, 1.0
            else:
                high, best, step = middle, (middle * whole, found), 2.0 * step
        return best


def _across(shift: Floats, plane: Floats | None) -> list[Floats]:
    """Unit vectors (3,) across a vector, which are within the plane of this normal."""
    along = shift / np.linalg.norm(shift)
    if plane is not None:
        across = np.cross(plane, along)
        return [across, -across]
    first = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    first /= np.linalg.norm(first)
    second = np.cross(along, first)
    return [first, -first, second, -second]


PLACES = 64
"""Places of each segment that a body is seen at."""

MOST_PAIRS = 4_000_000
"""Most pairs of triangles and places that are held against each other together."""


class GivenWay(NamedTuple):
    """An obstacle without what a body overlaps.

    Attributes
    ----------
    rest : Obstacle
    center : ndarray (3,)
        The place of the body that is deepest in what is missing.
    radius : float
        How far from there what is missing goes.
    """

    rest: Obstacle
    center: Floats
    radius: float


def give_way(robot: Robot, q: Floats, obstacle: Obstacle, demanded: float) -> GivenWay | None:
    """Take out of a mesh or a cloud what the body in a configuration (n, 3) overlaps; `None` where nothing is left.

    `demanded`: how far the body has to stay from obstacles.
    """
    if not isinstance(obstacle, Mesh | PointCloud) or obstacle.inside:
        return None
    places = robot.backbone(q, PLACES)
    radii = np.append(np.repeat(robot.radii, PLACES), robot.radii[-1]) + demanded
    radii = radii + 0.5 * float(np.linalg.norm(np.diff(places, axis=0), axis=1).max())
    if isinstance(obstacle, PointCloud):
        gaps, ends = _of_cloud(obstacle, places, radii)
    else:
        gaps, ends = _of_mesh(obstacle, places, radii)
    hit = gaps.min(axis=1) <= 0.0
    if not hit.any() or hit.all():
        return None
    center = places[int(gaps[hit].min(axis=0).argmin())]
    radius = float(np.linalg.norm(ends[hit] - center, axis=-1).max())
    if isinstance(obstacle, PointCloud):
        return GivenWay(PointCloud(obstacle.points[~hit], obstacle.radii[~hit], name=obstacle.name), center, radius)
    thick = 2.0 * obstacle.half_thickness
    rest = Mesh(obstacle.vertices, obstacle.faces[~hit], thickness=thick, name=obstacle.name)
    return GivenWay(rest, center, radius)


def _of_cloud(cloud: PointCloud, places: Floats, radii: Floats) -> tuple[Floats, Floats]:
    """Gaps (m, k) between balls and places, and the centers (m, 1, 3) of the balls."""
    apart = np.linalg.norm(cloud.points[:, None] - places, axis=-1)
    return apart - radii - cloud.radii[:, None], cloud.points[:, None]


def _of_mesh(mesh: Mesh, places: Floats, radii: Floats) -> tuple[Floats, Floats]:
    """Gaps (m, k) between triangles and places, and the corners (m, 3, 3) of the triangles."""
    corners = mesh.vertices[mesh.faces]
    gaps = np.empty((len(corners), len(places)))
    size = max(1, MOST_PAIRS // len(places))
    for first in range(0, len(corners), size):
        some: NDArray[np.float64] = corners[first : first + size]
        which, where = np.indices((len(some), len(places))).reshape(2, -1)
        gaps[first : first + size] = to_triangles(some[which], places[where]).reshape(len(some), len(places))
    return gaps - radii - mesh.half_thickness, corners
