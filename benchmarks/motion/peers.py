"""Planners of OMPL (Sucan, Moll & Kavraki 2012) on the same pairs, over the same proofs of states and motions."""

from collections.abc import Callable
from importlib.util import find_spec
from time import perf_counter
from typing import Any

import numpy as np

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.solver.certificates.steps import Prover

PLANNERS = ("RRTConnect", "BITstar")
"""Those to compare with; the second goes on to shorten the way until its time is over."""


def installed() -> bool:
    """Whether OMPL is there; it has no wheels for every platform."""
    return find_spec("ompl") is not None


def plan_all(
    robot: sn.Robot, scene: sn.Scene, start: Floats, goal: Floats, seconds: float
) -> dict[str, tuple[float, bool]]:
    """Return the time that each planner took from one configuration (n, 3) to another, and whether it found a way."""
    return {name: _plan(name, _checker(robot, scene), start, goal, seconds) for name in PLANNERS} if installed() else {}


def _plan(name: str, clear: Callable[..., bool], start: Floats, goal: Floats, seconds: float) -> tuple[float, bool]:
    from ompl import base, geometric, util  # noqa: PLC0415

    util.setLogLevel(util.LogLevel.LOG_ERROR)
    n = len(start)
    space, bounds = base.RealVectorStateSpace(2 * n), base.RealVectorBounds(2 * n)
    bounds.setLow(-np.pi)
    bounds.setHigh(np.pi)
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: clear(_read(state, n)))

    class Proof(base.MotionValidator):  # type: ignore[misc]
        def checkMotion(self, one: Any, other: Any, *_: Any) -> bool:  # noqa: N802
            return clear(_read(one, n), _read(other, n))

    information = setup.getSpaceInformation()
    information.setMotionValidator(Proof(information))
    setup.setStartAndGoalStates(_write(space, start), _write(space, goal))
    setup.setPlanner(getattr(geometric, name)(information))
    began = perf_counter()
    setup.solve(seconds)
    return perf_counter() - began, bool(setup.haveExactSolutionPath())


def _checker(robot: sn.Robot, scene: sn.Scene) -> Callable[..., bool]:
    prover = Prover(robot, scene.snapshot())

    def clear(one: Floats, other: Floats | None = None) -> bool:
        q = np.stack([one, one if other is None else other])
        if (np.hypot(q[..., 0], q[..., 1]) > np.pi).any():
            return False
        return bool(prover.prove(q, slack=1.0)[0, VERDICT] == CLEAR)

    return clear


def _read(state: Any, n: int) -> Floats:
    bends = np.array([state[i] for i in range(2 * n)]).reshape(n, 2)
    return np.concatenate([bends, np.ones((n, 1))], axis=1)


def _write(space: Any, q: Floats) -> Any:
    state = space.allocState()
    for i, value in enumerate(q[:, :2].ravel()):
        state[i] = float(value)
    return state
