"""What exploring brings to plans: into one place, explored from where the robot waits and from a solved shape, or not.

The robot waits straight, or, where that is not clear, in a shape that reaches a place away from the hidden tip. Plans
lead from there to the hidden shape and to targets about it that the judge finds feasible; the judges look at every
motion called proved. Nothing is added to the memory meanwhile.
"""

from collections.abc import Iterator

import numpy as np

import sinuous as sn
from benchmarks.clutter.remembered import targets_about
from benchmarks.clutter.ways import Row, timed
from benchmarks.judges.motions import wrong_in
from benchmarks.motion.hidden import straight
from benchmarks.places import Place, make
from sinuous.base.checks import Floats
from sinuous.motion.plan import Goal
from sinuous.studies.exploring.explore import explore

AGAINST = {"explored": "not explored", "not explored": "not explored"}

SECONDS, PATIENCE, ROUNDS = 5.0, 3600.0, 50
"""Budget of a plan; seconds of exploring, whatever the rounds; and rounds of it."""

AWAY, TRIES = (0.3, 0.6), 30
"""How far the tip of another shape is from the hidden one's, in lengths of the robot, and how many are tried."""


def elsewhere(place: Place) -> Floats | None:
    """Return a clear shape (n, 3) whose tip is away from the hidden one; `None` where none is found."""
    rng, solver = np.random.default_rng(place.seed), sn.Solver(place.robot, place.scene)
    tip = place.robot.tip(place.hidden_q)[:3, 3]
    for _ in range(TRIES):
        way = rng.normal(size=3)
        far = place.robot.mean_length * rng.uniform(*AWAY)
        solution = solver.solve(sn.Target(tip + far * way / np.linalg.norm(way)))
        if solution.solved:
            return np.array(solution.q)
    return None


def examined(family: str, seed: int, count: int) -> Iterator[Row]:
    """Explore one place, and plan in it; nothing where no shape is found in which the robot could wait."""
    place = make(family, seed)
    robot, scene, tolerance = place.robot, place.scene, place.tolerance
    start: Floats | None = straight(robot)
    plain = sn.Planner(robot, scene, time=SECONDS, tolerance=tolerance)
    if plain.plan(straight(robot), place.hidden_q).status is sn.Status.START_BLOCKED:
        start = elsewhere(place)
    if start is None:
        return
    memory = sn.Memory(robot)
    sn.Solver(robot, scene, memory=memory, tolerance=tolerance).solve(place.targets)
    explore(robot, scene, time=PATIENCE, rounds=ROUNDS, memory=memory, starts=start, workers=1)
    walker = sn.Planner(robot, scene, memory=memory.reading(), time=SECONDS, tolerance=tolerance)
    goals: list[Goal] = [
        place.hidden_q,
        *(list(o.targets) for o in targets_about(place, count, np.random.default_rng(seed))),
    ]
    for way, planner in zip(AGAINST, (walker, plain), strict=True):
        planner.plan(start, goals[-1])  # what is kept of the memory is made by the first plan
        for goal in goals:
            motion, spent = timed(planner.plan, start, goal)
            wrong = motion.solved and bool(wrong_in(robot, scene, motion.q))
            yield Row(family, way, motion.solved and not wrong, wrong, spent)
