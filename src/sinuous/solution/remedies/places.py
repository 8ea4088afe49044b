"""Changes of what stands around, of where the robot stands in it, and of how thick its body is."""

from collections.abc import Iterator

import numpy as np

from sinuous.checks import Floats
from sinuous.problem.problem import Problem
from sinuous.solution.binding.contacts import contacts_of
from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.solution.status import Status
from sinuous.words import listed, number, rounded

MOST = 8
"""Most obstacles that are taken away one by one."""

THINNEST = 1 / 64
"""Share of its radius to which a body is made thinner at most."""


def clear_away(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the obstacles without which the problem is solved; where no single one is enough, several together."""
    scene = case.problem.scene
    if len(scene) == 0:
        return
    free = trials.quick(_without(case.problem, {scene.name(i) for i in range(len(scene))}))
    if free is None:
        return
    in_the_way = [each.obstacle for each in contacts_of(case.problem, free.q, 0.0) if each.obstacle is not None]
    bound = [each.obstacle for each in case.binding if each.obstacle is not None]
    proved = [case.reason.obstacle] if case.reason is not None and case.reason.obstacle is not None else []
    names = list(dict.fromkeys([*proved, *bound, *in_the_way]))[:MOST]
    alone = [name for name in names if _solved_without(trials, case, {name})]
    for name in alone:
        yield Remedy(f"obstacle {name}", "in the scene", None)
    together = [name for name in map(scene.name, range(len(scene))) if name in in_the_way]
    if not alone and 1 < len(together) <= MOST and _solved_without(trials, case, set(together)):
        yield Remedy(f"obstacles {listed(together)}", "in the scene", None)


def _without(problem: Problem, names: set[str]) -> Problem:
    return problem.changed(scene=problem.scene.without(names))


def _solved_without(trials: Trials, case: Case, names: set[str]) -> bool:
    return trials.whole(_without(case.problem, names)) is not None


def free_the_base(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield a longer mount and another place of the base, where that is blocked."""
    if case.status is not Status.BASE_BLOCKED:
        return
    robot = case.problem.robot
    longest = sum(segment.length[1] for segment in robot.segments)

    def mounted(more: float) -> Problem:
        return case.problem.changed(robot=robot.changed(mount=rounded(robot.mount + more)))

    found = trials.smallest(mounted, longest)
    if found is not None:
        yield Remedy("mount", robot.mount, rounded(robot.mount + found[0]))
    place = robot.base[:3, 3]
    slope = case.problem.scene.gradient(place + robot.mount * robot.base[:3, 2])
    length = float(np.linalg.norm(slope))
    if length == 0.0:
        return

    def moved(by: float) -> Problem:
        return case.problem.changed(robot=robot.changed(base=_shifted(robot.base, by / length * slope)))

    found = trials.smallest(moved, longest)
    if found is not None:
        after = moved(found[0]).robot.base[:3, 3]
        yield Remedy("base position", place.tolist(), after.tolist(), f"{number(found[0])} away")


def _shifted(pose: Floats, by: Floats) -> Floats:
    shifted = pose.copy()
    shifted[:3, 3] += by
    return shifted


def make_thinner(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the largest radius of the body with which the problem is solved, where it has one radius."""
    robot = case.problem.robot
    radius = robot.radii[0]
    if len(set(robot.radii)) > 1 or radius == 0.0 or not _touches(case):
        return

    def thinner(by: float) -> Problem:
        return case.problem.changed(robot=robot.changed(radius=rounded(radius - by)))

    found = trials.smallest(thinner, (1.0 - THINNEST) * radius, thorough=True)
    if found is not None:
        yield Remedy("radius", radius, rounded(radius - found[0]))


def _touches(case: Case) -> bool:
    """Whether the thickness of the body has to do with it."""
    kinds = "clearance", "self_clearance"
    bound = any(each.constraint in kinds or each.key == "radius" for each in case.binding)
    return bound or (case.reason is not None and case.reason.obstacle is not None)


def let_through(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield that the body may run through itself, where that holds it back."""
    robot = case.problem.robot
    bound = any(each.constraint == "self_clearance" or each.key == "radius" for each in case.binding)
    if bound and robot.avoids_itself:
        through = case.problem.changed(robot=robot.changed(self_collision="allow"))
        if trials.whole(through) is not None:
            yield Remedy("self_collision", "avoid", "allow")
