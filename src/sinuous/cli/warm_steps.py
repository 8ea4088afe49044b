"""Everything that is compiled, by using it once: what a solve will need is then on disk."""

from collections.abc import Callable, Iterable
from functools import partial
from time import perf_counter
from typing import NamedTuple

import numpy as np

from sinuous.base.arguments import MethodName
from sinuous.methods.learned.search import Learned
from sinuous.methods.learned.training import FEWEST_TARGETS, train
from sinuous.methods.method import METHODS, name_of
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion
from sinuous.motion.planning.memory_search import load_memory_search
from sinuous.motion.planning.rrt_connect import load_trees
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Target
from sinuous.scene.mesh import Mesh
from sinuous.scene.moving import Moving
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import least_gap
from sinuous.solver.certificates.steps import load_motions
from sinuous.solver.certificates.tip import Tip
from sinuous.solver.memory import MEGABYTES
from sinuous.solver.options import SolveOptions
from sinuous.solver.route_classes.curves import RouteCurves
from sinuous.solver.routing.searches import Searches
from sinuous.solver.shapes import Shapes
from sinuous.solver.solver import Solver
from sinuous.statics.rest import Rest

ROBOT = Robot.uniform(2, (0.8, 1.2), radius=0.05)
MOVING = Scene([Moving(Sphere((9.0, 0.0, 0.0), 0.5), [0.0], [(0.0, 0.0, 0.0)])])
FAR = Scene([Sphere((9.0, 0.0, 0.0), 0.5)])
HEAVY = ROBOT.changed(mass=1.0, gravity=(0.0, 0.0, -9.81), stiffness=100.0)
TARGET = Target((0.5, 0.0, 1.5))

FIRST_COMMAND = ("routes among obstacles", "single solves among obstacles", "kinematics")
"""Steps whose entries the first command of the README calls."""


class WarmStep(NamedTuple):
    """A use of something that is compiled.

    Attributes
    ----------
    what : str
    use : callable
    """

    what: str
    use: Callable[[], object]


def steps(methods: Iterable[str] = METHODS) -> list[WarmStep]:
    """List what to use so that these methods, and all that goes with them, are compiled; what most need comes first.

    Neighbours share little, so that two processes that take turns at the list seldom compile the same at once.
    """
    chosen = tuple(dict.fromkeys(map(name_of, methods)))
    own = [
        WarmStep("single solves", partial(Solver._for_one_query, ROBOT)),
        WarmStep("routes among obstacles", Searches(ROBOT, FAR, SolveOptions.of({}).tolerance.for_robot(ROBOT)).load),
        WarmStep("single solves among obstacles", partial(Solver._for_one_query, ROBOT, FAR)),
        WarmStep("batches of solves", lambda: Solver._for_one_query(ROBOT).solve_many([TARGET])),
        WarmStep("batches of solves among obstacles", lambda: Solver._for_one_query(ROBOT, FAR).solve_many([TARGET])),
        WarmStep("preferences", lambda: Solver._for_one_query(ROBOT, prefer=Preferences(bends=1.0))),
        WarmStep(
            "preferences among obstacles", lambda: Solver._for_one_query(ROBOT, FAR, prefer=Preferences(bends=1.0))
        ),
    ]
    others = [WarmStep(f"the method {name}", partial(_method, name)) for name in chosen if name != "newton"]
    geometry = [
        WarmStep("kinematics", _kinematics),
        WarmStep("starts of a memory", _memory),
        WarmStep("distances", _distances),
        WarmStep("classes of routes", RouteCurves(ROBOT, FAR.snapshot()).load),
        WarmStep("motions", _motions),
        WarmStep("plans", _plans),
        WarmStep("control loops", _loops),
        WarmStep("derivatives", partial(_derivatives, None)),
        WarmStep("derivatives among obstacles", partial(_derivatives, FAR)),
        WarmStep("shapes under load", _shapes_under_load),
    ]
    return [*(own if "newton" in chosen else []), *geometry, *others]


def _method(name: MethodName) -> None:
    """Use a method; `learned` with a network that learns as little as can be: training takes seconds."""
    learned = name == "learned"
    method = Learned(train(ROBOT, FAR, samples=2 * FEWEST_TARGETS, width=1, rounds=1)) if learned else name
    Solver(ROBOT, FAR, method=method)


def _motions() -> None:
    load_motions(ROBOT, MOVING.snapshot())
    Tip(ROBOT)


def _plans() -> None:
    load_trees(ROBOT, FAR.snapshot())
    load_memory_search(ROBOT, FAR.snapshot())


def _loops() -> None:
    Solver._of_checked(ROBOT, FAR, SolveOptions.of({})).step([[0.0, 0.0, 1.0]] * len(ROBOT), (0.0,) * 6, 1.0)


def _derivatives(scene: Scene | None) -> None:
    solver = Solver._for_one_query(ROBOT, scene)
    _ = solver.solve(TARGET).derivative().clearance
    solver.solve_many([TARGET]).derivative()


def _shapes_under_load() -> None:
    straight = np.array([[0.0, 0.0, 1.0]] * len(ROBOT))
    HEAVY.shape(straight)
    Solver._for_one_query(HEAVY, None).solve(TARGET)
    rest = Rest(HEAVY, straight)
    _ = rest.slopes, rest.answers([rest.tables], np.ones(1))
    Motion(HEAVY, [straight, straight + 0.01])


def _kinematics() -> None:
    straight = np.array([[0.0, 0.0, 1.0]] * len(ROBOT))
    ROBOT.forward(straight)
    ROBOT.backbone(straight)
    ROBOT.jacobian(straight)


def _memory() -> None:
    shapes = Shapes(ROBOT, MEGABYTES)
    shapes.add(np.array([[[0.0, 0.0, 1.0]] * len(ROBOT)]))
    shapes.is_new(shapes.q)


def _distances() -> None:
    # at a place of its own each time: samples of a mesh that was met before are read from the disk
    corners = np.vstack([np.zeros(3), np.eye(3)]) + perf_counter() % 1.0
    scene = Scene([Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])])
    scene.distance([1.0, 1.0, 1.0])
    least_gap(corners, np.zeros(len(corners)), scene.snapshot())
