"""Changes that make a problem solvable, in order: first what costs the user least; and limits that may be widened.

Every change that is offered was tried: with it the problem is solved and proved, by the whole search, begun as the user
began it; or from a start that is told with it.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.binding import OF_THICKNESS, Binding
from sinuous.answer.residual import residual_of, rotation_between
from sinuous.answer.solve_again import FoundSolution
from sinuous.answer.status import Status, begun_in, mouth_of
from sinuous.answer.trials import Case, Trials, give_way
from sinuous.answer.worst import contacts_of
from sinuous.base.checks import Floats
from sinuous.base.errors import degrees, labelled, listed, number, rounded, rounded_up
from sinuous.base.frozen import ShortRepr
from sinuous.model.actuators import Actuators
from sinuous.model.joints import RigidRow, joints_with
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.problem.problem import Problem
from sinuous.problem.target import Tolerance

MOST = 4.0
"""Largest widening, as a share of the limit."""

FROM_NOTHING = 0.1
"""What stands for a limit of 0 there: rad, or length unit."""

COUPLED = "actuators.limits"
"""What the problem file calls limits of the robot's `Actuators`; all others are limits of segments."""

JOINT = "limits"
"""The same of limits of joints."""

HELD = ("plane", "locked")
"""What holds a bend whatever its limits are."""

OF_ANY_SIGN = ("max_bend", "tendons.displacement", "tendons.limits", "chambers.limits", COUPLED, JOINT)
"""Limits that may be negative."""

Limits = float | tuple[float, float]


class Widening(NamedTuple):
    """A limit that several segments, or several rows of `Actuators`, share, and which of its ends bind.

    Attributes
    ----------
    key : str
        What the problem file calls it.
    shared : tuple of int
        Numbers of the rows of the robot, 1 = first; of `Actuators` of the rows, 0 = first.
    limits : float or (float, float)
        As they are.
    ends : frozenset of int
        Of an interval: 0 its lower, 1 its upper end.
    """

    key: str
    shared: tuple[int, ...]
    limits: Limits
    ends: frozenset[int]

    @property
    def most(self) -> float:
        """The largest amount that can be meant: lengths not below 0, bends up to a full turn."""
        if not isinstance(self.limits, tuple):
            most = MOST * (self.limits or FROM_NOTHING)
            return min(most, 2.0 * math.pi - self.limits) if self.key == "max_bend" else most
        most = MOST * max(map(abs, self.limits))
        return min(most, self.limits[0]) if self.key not in OF_ANY_SIGN and self.ends == {0} else most

    def name(self, robot: Robot) -> str:
        """What is widened: `max_bend of all segments`, `actuators.limits of pan and tilt`."""
        if self.key == COUPLED:
            return f"{self.key} of {listed(_linear(robot).names[i] for i in self.shared)}"
        return f"{self.key} of {labelled([robot.labels[place - 1] for place in self.shared], len(robot.segments))}"

    def by(self, amount: float) -> Limits:
        """The limits, wider by this much."""
        if not isinstance(self.limits, tuple):
            return rounded(self.limits + amount)
        low, high = self.limits[0] - amount * (0 in self.ends), self.limits[1] + amount * (1 in self.ends)
        return rounded(low if self.key in OF_ANY_SIGN else max(0.0, low)), rounded(high)

    def applied(self, robot: Robot, amount: float) -> Robot:
        """Return the robot with this limit wider by this much."""
        limits = self.by(amount)
        if self.key != COUPLED:
            numbered = enumerate(robot.segments, len(robot) - len(robot.segments) + 1)
            changed = [_segments_with(s, self.key, limits) if k in self.shared else s for k, s in numbered]
            joints = joints_with(robot.joints, robot._rigid, dict.fromkeys(self.shared, limits))
            return robot.changed(segments=changed, joints=joints)
        linear = _linear(robot)
        own = [limits if i in self.shared else each for i, each in enumerate(linear.limits)]
        return robot.changed(actuators=linear.changed(limits=own))


def widenings(robot: Robot, binding: tuple[Binding, ...]) -> list[Widening]:
    """Return the limits that bind. Segments with the same limit share it, and it is widened for all of them."""
    ends: dict[tuple[str, Limits], set[int]] = {}
    for each in binding:
        if each.key is not None and each.segment is not None:
            key, _, end = each.key.partition("[")
            place = (
                _linear(robot).names.index(each.actuator)
                if key == COUPLED and each.actuator
                else robot.end_row(each.segment)
            )
            limits = limits_of(robot, key, place)
            if limits is not None:
                ends.setdefault((key, limits), set()).add(int(end[0]) if end else 0)
    result = []
    for (key, limits), own in ends.items():
        symmetric = isinstance(limits, tuple) and limits[0] == -limits[1]
        places = range(len(_linear(robot).names)) if key == COUPLED else range(1, len(robot) + 1)
        shared = tuple(place for place in places if limits_of(robot, key, place) == limits)
        result.append(Widening(key, shared, limits, frozenset((0, 1) if symmetric else own)))
    return result


def limits_of(robot: Robot, key: str, place: int) -> Limits | None:
    """Return the limits that a problem file calls `key`, of a row of a robot (1 = first) or of `Actuators` (0 = first).

    `None` where there are none; also of `radius`, which limits the curvature, of a plane, and of segments that are
    locked: there is no limit that could be wider.
    """
    if key == COUPLED:
        return _linear(robot).limits[place]
    group, _, name = key.rpartition(".")
    segment = robot.rows[place - 1]
    if isinstance(segment, RigidRow):
        return robot._rigid.moving[segment.joint].limits if key == JOINT and segment.joint >= 0 else None
    if key == JOINT:
        return None
    owner = getattr(segment, group) if group else segment
    if owner is None or key in OF_THICKNESS or key in HELD or segment.locked is not None:
        return None
    return getattr(owner, name if group else Segment._arguments.get(name, name))


def plain(limits: Limits) -> float | list[float]:
    """Limits as a problem file says them: an interval of no length is a number."""
    if not isinstance(limits, tuple):
        return limits
    return limits[0] if limits[0] == limits[1] else list(limits)


def _segments_with(segment: Segment, key: str, limits: Limits) -> Segment:
    """Return a segment with other limits."""
    group, _, name = key.rpartition(".")
    changes: dict[str, Any] = {group: getattr(segment, group).changed(**{name: limits})} if group else {key: limits}
    return segment.changed(**changes)


def _linear(robot: Robot) -> Actuators:
    assert robot.linear is not None
    return robot.linear


BEST_METHOD = "newton"
"""The method that handles everything."""

MORE_STARTS = 10
"""How many times more starts are tried."""

MOST_CHANGES = 1024.0
"""How many times larger changes than those that were allowed (`within`) are tried."""

FINE_CHANGES = 1.01
"""The ratio to which the smallest of them is found."""

LOOSER = 20.0
"""How many times a tolerance may grow before another target is the better advice."""

FARTHER = (1.0, 1.02, 1.1)
"""Factors of the least change of a target that are tried where the whole search finds no solution with it."""

MOST_OBSTACLES = 8
"""Most obstacles that are taken away one by one."""

THINNEST = 1 / 64
"""Share of its radius to which a body is made thinner at most."""

PROVED = (Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED, Status.NO_ROUTE)
"""Statuses that no effort changes."""


@dataclass(frozen=True, repr=False)
class Remedy(ShortRepr):
    """A change that was tried: with it, the problem is solved and proved.

    Attributes
    ----------
    change : str
        What is changed: `max_bend of all segments`, `target position`, `obstacle ball`, `time`.
    before, after : object
        Plain values; `None` after: it is taken away.
    note : str
        What else there is to say, like how far a target moves; may be empty.
    start : list or None
        The configuration (n, 3) from which it is solved, where the search alone does not find it: `initial` of a solve.
    problem : Problem or None
        The problem with this change; nothing where an option of the solve is changed (`method`, `time`, `max_starts`,
        `within`).
    """

    change: str
    before: Any
    after: Any
    note: str = ""
    start: list[list[float]] | None = None
    problem: Problem | None = field(default=None, compare=False)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        start = {} if self.start is None else {"start": self.start}
        return {"change": self.change, "from": self.before, "to": self.after} | start

    def __str__(self) -> str:
        notes = [self.note] if self.note else []
        notes += ["the search needs its `start`"] if self.start is not None else []
        note = f" ({', '.join(notes)})" if notes else ""
        if self.after is None:
            return f"without {self.change}{note}"
        before = "" if self.before is None else f"{_shown(self.before)} -> "
        return f"{self.change}: {before}{_shown(self.after)}{note}"


def _shown(value: Any) -> str:
    """Plain values in a sentence; a rotation by its angle and axis."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    if isinstance(value, dict):
        return ", ".join(f"{key} {_shown(each)}" for key, each in value.items())
    if not (isinstance(value, list) and [len(row) for row in value if isinstance(row, list)] == [3, 3, 3]):
        return number(value, 6)
    turn = Rotation.from_matrix(value).as_rotvec()
    angle = float(np.linalg.norm(turn))
    return f"{degrees(angle)} about {number(turn / angle, 3)}" if angle > 0.0 else "no rotation"


Kind = Callable[[Trials, Case], Iterator[Remedy]]


def find_remedies(trials: Trials, case: Case) -> tuple[Remedy, ...]:
    """Return changes that work; `trials` knows then whether all were tried before its time was up."""
    kinds = _kinds(case)
    found: list[Remedy] = []
    for i, (kind, part) in enumerate(kinds):
        trials.share(part / sum(other for _, other in kinds[i:]))
        found += kind(trials, case)
    return tuple(found)


def _kinds(case: Case) -> list[tuple[Kind, float]]:
    """What can help, and the shares of the time that each may take; what one leaves is for those after it."""
    if case.within is not None:  # all others begin anywhere, and go anywhere
        return [(allow_larger_changes, 1.0)]
    demanded: list[tuple[Kind, float]] = [(demand_less, 3.0)] if case.problem.robot._demands_clearance else []
    if case.status is Status.BASE_BLOCKED:
        return [*demanded, (stay_inside, 3.0), (free_the_base, 1.0), (clear_away, 3.0), (make_thinner, 1.0)]
    kinds: list[tuple[Kind, float]] = [
        *demanded,
        (widen, 3.0),
        (relax, 3.0),
        (clear_away, 3.0),
        (make_thinner, 1.0),
        (drop, 1.0),
    ]
    return kinds if case.status in PROVED else [(change_method, 2.0), *kinds, (search_longer, 1.0)]


def change_method(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield our own method, where another one failed."""
    if case.resolver.method != BEST_METHOD and trials.whole(case.problem, method=BEST_METHOD) is not None:
        yield Remedy("method", case.resolver.method, BEST_METHOD)


def search_longer(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield a longer budget, or more starts, where either ran out."""
    starts, seconds = case.resolver.max_starts, case.resolver.seconds
    if case.status is Status.TIME_LIMIT or starts is None:
        longer = max(2.0 * seconds, 1e-3)
        while longer <= trials.left:
            if trials.whole(case.problem, time=longer, max_starts=starts) is not None:
                yield Remedy("time", seconds, longer)
                return
            longer *= 2.0
    elif case.starts >= starts and trials.whole(case.problem, max_starts=MORE_STARTS * starts) is not None:
        yield Remedy("max_starts", starts, MORE_STARTS * starts)


def allow_larger_changes(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield larger changes, all by the same factor, where changes were what was allowed."""
    assert case.within is not None
    low, high = 1.0, 2.0
    while trials.whole(case.problem, within=case.within * high) is None:
        low, high = high, 2.0 * high
        if high > MOST_CHANGES:
            return
    while high > FINE_CHANGES * low and trials.may_refine():
        middle = math.sqrt(low * high)
        if trials.whole(case.problem, within=case.within * middle) is None:
            low = middle
        else:
            high = middle
    factor = rounded_up(high)
    if trials.whole(case.problem, within=case.within * factor) is not None:
        yield Remedy("within", 1.0, factor, "times the changes that were allowed")


def demand_less(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the largest clearance that can be kept, each alone: where they are several, by the same share of all."""
    robot = case.problem.robot
    for key in ("clearance", "self_clearance"):
        before = getattr(robot, key)

        def less(by: float, key: str = key, before: Any = before) -> Problem:
            after = np.maximum(0.0, (1.0 - by) * np.asarray(before))
            return case.problem.changed(robot=robot.changed(**{key: _rounded_down(after)}))

        share = trials.smallest(less, 1.0, thorough=True) if np.any(before) else None
        if share is not None:
            problem = less(share)
            yield Remedy(key, _listed(before), _listed(getattr(problem.robot, key)), problem=problem)


def _listed(demanded: float | tuple[float, ...]) -> float | list[float]:
    """What is demanded as a problem file says it."""
    return list(demanded) if isinstance(demanded, tuple) else demanded


def _rounded_down(values: Floats) -> Any:
    """Values that are a little less where they had many digits."""
    return tuple(map(_rounded_down, values)) if values.ndim else rounded(float(values))


def widen(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the smallest widening of every limit that binds, each alone; where none is enough, of all together."""
    problem, robot = case.problem, case.problem.robot
    usable = [each for each in widenings(robot, case.binding) if each.most > 0.0]
    amounts = [
        trials.smallest(lambda amount, one=one: problem.changed(robot=one.applied(robot, amount)), one.most)  # type: ignore[misc]
        for one in usable
    ]
    for one, amount in zip(usable, amounts, strict=True):
        if amount is not None:
            changed = problem.changed(robot=one.applied(robot, amount))
            yield Remedy(one.name(robot), plain(one.limits), plain(one.by(amount)), problem=changed)
    if len(usable) < 2 or any(amount is not None for amount in amounts):
        return

    def wider(share: float) -> Problem:
        changed = robot
        for each in usable:
            changed = each.applied(changed, share * each.most)
        return problem.changed(robot=changed)

    share = trials.smallest(wider, 1.0)
    if share is not None:
        before = {each.name(robot): plain(each.limits) for each in usable}
        after = {each.name(robot): plain(each.by(share * each.most)) for each in usable}
        yield Remedy("limits", before, after, problem=wider(share))


def relax(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the nearest position and direction that can be reached, or tolerances within which the target is met.

    Where neither is enough alone, the target is offered that the best configuration meets.
    """
    if len(case.problem.targets) > 1:
        return
    target, found = case.problem.targets[0], 0
    asked = [key for key in ("position", "direction", "rotation") if getattr(target, key) is not None]
    for key in asked:
        for remedy in _nearest(trials, case, key):
            found += 1
            yield remedy
    if not found and len(asked) > 1:
        end, key = _end(case.problem, case.q), asked[1]
        values = {"position": end[:3, 3], key: end[:3, 2] if key == "direction" else end[:3, :3]}
        before, after = ({name: np.asarray(each[name]).tolist() for name in asked} for each in (vars(target), values))
        yield from _offered(trials, [(_with(case.problem, **values), Remedy("target", before, after))], case.q)


def _nearest(trials: Trials, case: Case, key: str) -> Iterator[Remedy]:
    """Change the position, direction or rotation of the target as little as possible; a little: its tolerance."""
    problem, target = case.problem, case.problem.targets[0]
    before: Floats = getattr(target, key)
    of = "position" if key == "position" else "angle"
    tolerance = float(getattr(problem.tolerance, of))

    def changed(by: Floats) -> Problem:
        return _with(problem, **{key: _moved(key, before, by, tolerance)})

    plane = before if key == "direction" else None
    least = trials.nearest(changed, _firsts(trials, case, key), 0.5 * tolerance, plane)
    if least is None and key == "position":
        least = trials.nearest(changed, _nearby(trials, case), 0.5 * tolerance)
    if least is None:
        return
    by, reached = least
    size = float(np.linalg.norm(by))
    if size <= tolerance:  # nothing has to be changed: the target itself is met from there
        found = trials.quick(problem, reached.configuration)
        if found is not None:
            given = None if case.given is None else case.given.tolist()
            yield Remedy("start", given, found.configuration.tolist(), problem=problem)
        return
    loose = rounded_up(tolerance + size)
    looser = _looser(problem, **{of: loose})
    if loose <= LOOSER * tolerance and trials.whole(looser) is not None:
        yield Remedy(f"tolerance.{of}", tolerance, loose, problem=looser)
    tries = []
    for farther in (factor * by for factor in FARTHER):
        after, size = _moved(key, before, farther, tolerance), float(np.linalg.norm(farther))
        note = f"{number(size)} away" if key == "position" else f"turned by {degrees(size)}"
        note += f" about {number(farther / size, 3)}" if key == "rotation" else ""
        tries.append((changed(farther), Remedy(f"target {key}", before.tolist(), after.tolist(), note)))
    yield from _offered(trials, tries, reached.configuration)


def _offered(trials: Trials, tries: Sequence[tuple[Problem, Remedy]], q: Floats) -> Iterator[Remedy]:
    """Yield the first of several changes that the whole search solves; otherwise the first, with a start near `q`."""
    for problem, remedy in tries:
        if trials.whole(problem) is not None:
            yield replace(remedy, problem=problem)
            return
    problem, remedy = tries[0]
    found = trials.quick(problem, q)
    if found is not None:
        yield replace(remedy, start=found.configuration.tolist(), problem=problem)


def _moved(key: str, before: Floats, by: Floats, tolerance: float) -> Floats:
    """A position moved by a vector (3,), rounded as exactly as its tolerance says; or an orientation turned by one."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    if key == "position":
        return np.round(before + by, min(15, math.ceil(-math.log10(0.1 * tolerance))))
    return Rotation.from_rotvec(by).as_matrix() @ before


def _firsts(trials: Trials, case: Case, key: str) -> Iterator[Floats]:
    """Yield changes of a target that may do: where configurations end that meet the rest of it, and the best one."""
    problem, target = case.problem, case.problem.targets[0]
    before: Floats = getattr(target, key)
    if key == "position" and case.reason is not None and case.reason.bound == "target":  # out of the obstacle
        deep = case.reason.needed - case.reason.available + (problem.tolerance.position or 0.0)
        yield deep * problem.scene.gradient(before)
    ends = [case.q]
    if sum(value is not None for value in (target.position, target.direction, target.rotation)) > 1:
        found = trials.quick(_with(problem, **{key: None}))
        ends += [] if found is None else [found.configuration]
    for q in ends:
        yield _change_to(key, before, _end(problem, q))


def _nearby(trials: Trials, case: Case) -> Iterator[Floats]:
    """Yield changes of a position to where configurations end that are found near to it, farther and farther away."""
    problem = case.problem
    before: Any = problem.targets[0].position
    off = max(1e-3 * problem.robot.mean_length, residual_of(problem, case.q).position_error)
    while off < 4.0 * problem.robot.mean_length and trials.left > 0.0:
        found = trials.quick(_looser(problem, position=off))
        if found is not None:
            yield _change_to("position", before, _end(problem, found.configuration))
        off *= 2.0


def _change_to(key: str, before: Floats, end: Floats) -> Floats:
    """The vector (3,) from a position or orientation to that of a pose (4, 4)."""
    if key == "position":
        return end[:3, 3] - before
    return rotation_between(before, end[:3, 2] if key == "direction" else end[:3, :3])


def _end(problem: Problem, q: Floats) -> Floats:
    """Pose (4, 4) of the end that the first target speaks of."""
    robot, segment = problem.robot, problem.targets[0].segment
    end = robot.end_row(segment)
    return robot.tip(q) if end == len(robot) else robot.forward(q)[end - 1]


def _with(problem: Problem, **values: Any) -> Problem:
    """The problem with other values in its first target."""
    first, *others = problem.targets
    return problem.changed(targets=(first.changed(**values), *others))


def _looser(problem: Problem, **values: float) -> Problem:
    """The problem with other tolerances."""
    own: dict[str, Any] = {"position": problem.tolerance.position, "angle": problem.tolerance.angle}
    return problem.changed(tolerance=Tolerance(**{**own, **values}))


def drop(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the targets, of several, without which the others can be met."""
    targets = case.problem.targets
    for i, target in enumerate(targets if len(targets) > 1 else ()):
        fewer = case.problem.changed(targets=targets[:i] + targets[i + 1 :])
        if trials.whole(fewer) is not None:
            yield Remedy(f"target {i + 1}", repr(target), None, problem=fewer)


def clear_away(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the obstacles without which the problem is solved; where no single one is enough, several together."""
    scene = case.problem.scene
    every = [scene.name(i) for i in range(len(scene))]

    def cleared(names: Sequence[str]) -> Problem:
        return case.problem.changed(scene=scene.without(names))

    def helped(names: Sequence[str]) -> FoundSolution | None:
        return trials.whole(cleared(names))

    if not every or case.status is Status.OUT_OF_REACH:  # which is proved without a look at them
        return
    bare = cleared(every)
    free = trials.quick(bare) or trials.whole(bare)
    if free is None:
        trials.obstacles_matter = trials.left <= 0.0
        return
    met = [each.obstacle for each in contacts_of(case.problem, free.configuration, 0.0)]
    held = [None if case.reason is None else case.reason.obstacle, *(each.obstacle for each in case.binding)]
    names = [name for name in dict.fromkeys([*held, *met]) if name is not None][:MOST_OBSTACLES]
    alone = {name: found for name in names if (found := helped([name])) is not None}
    for name, found in alone.items():
        part = _hole(trials, case.problem, every.index(name), found.configuration)
        if part is not None:
            yield part
            continue
        note = _giving_way(case.problem, name, found.configuration)
        yield Remedy(f"obstacle {name}", "in the scene", None, note, problem=cleared([name]))
    together = [name for name in every if name in met]
    if not alone and 1 < len(together) <= MOST_OBSTACLES and helped(together) is not None:
        yield Remedy(f"obstacles {listed(together)}", "in the scene", None, problem=cleared(together))


def _hole(trials: Trials, problem: Problem, index: int, q: Floats) -> Remedy | None:
    """Say where alone a mesh or a cloud would have to give way to a solution without it (n, 3)."""
    scene, name = problem.scene, problem.scene.name(index)
    if problem.robot.has_external_load or problem.scene.moves:
        return None
    demanded = float(np.max(problem.robot.clearance))
    given = give_way(problem.robot, q, scene.obstacles[index], demanded)
    if given is None:
        return None
    opened = problem.changed(scene=scene.replaced(index, given.rest))
    if (trials.quick(opened, q) or trials.whole(opened)) is None:
        return None
    where = {"position": [*map(rounded, given.center.tolist())], "radius": rounded_up(given.radius)}
    return Remedy(f"obstacle {name} gives way", None, where, _giving_way(problem, name, q), problem=opened)


def _giving_way(problem: Problem, name: str, q: Floats) -> str:
    """Where the body of a solution without an obstacle (n, 3) is deepest in that: there it would have to give way."""
    if problem.robot.has_external_load:
        return ""
    deepest = next((each for each in contacts_of(problem, q, 0.0) if each.obstacle == name), None)
    if deepest is None:
        return ""
    return f"a solution is {number(-deepest.clearance)} deep in it, {Binding.of(deepest, problem.robot).place}"


def stay_inside(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield that the body stays inside the obstacle that it begins in, as in a lumen."""
    scene, begun = case.problem.scene, begun_in(case.problem)
    if begun is None:
        return
    turned = case.problem.changed(scene=scene.replaced(begun, scene.obstacles[begun]._changed({"inside": True})))
    if trials.whole(turned) is not None:
        yield Remedy(f"inside of {scene.name(begun)}", False, True, problem=turned)


def free_the_base(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield a longer mount and another place of the base, where that is blocked.

    A mount within the first segment is a sleeve; with a longer one nothing of the body would be checked.
    """
    problem, robot = case.problem, case.problem.robot
    longest = [segment.length[1] for segment in robot.rows]

    def mounted(more: float) -> Problem:
        return problem.changed(robot=robot.changed(mount=rounded(robot.mount + more)))

    amount = trials.smallest(mounted, longest[0])
    if amount is not None:
        yield Remedy("mount", robot.mount, rounded(robot.mount + amount), problem=mounted(amount))
    slope = problem.scene.gradient(mouth_of(robot))
    size = float(np.linalg.norm(slope))
    if size == 0.0:
        return

    def moved(by: float) -> Problem:
        base = robot.base.copy()
        base[:3, 3] += by / size * slope
        return problem.changed(robot=robot.changed(base=base))

    amount = trials.smallest(moved, sum(longest))
    if amount is not None:
        free = moved(amount)
        after, note = free.robot.base[:3, 3].tolist(), f"{number(amount)} away"
        yield Remedy("base position", robot.base[:3, 3].tolist(), after, note, problem=free)


def make_thinner(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the largest radius of the body with which the problem is solved, where it has one radius."""
    robot, radius = case.problem.robot, case.problem.robot.radii[0]
    proved = case.reason is not None and case.reason.obstacle is not None
    kinds = "clearance", "self_clearance"
    concerned = proved or any(each.constraint in kinds or each.key in OF_THICKNESS for each in case.binding)
    if len(set(robot.radii)) > 1 or radius == 0.0 or not concerned:
        return

    def thinner(by: float) -> Problem:
        return case.problem.changed(robot=robot.changed(radius=rounded(radius - by)))

    amount = trials.smallest(thinner, (1.0 - THINNEST) * radius, thorough=True)
    if amount is not None:
        yield Remedy("radius", radius, rounded(radius - amount), problem=thinner(amount))
