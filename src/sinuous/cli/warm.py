"""The command warm: compile everything now, so that nobody waits for it later."""

import multiprocessing
import signal
import time as clock
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, wait
from functools import partial
from time import perf_counter
from typing import Any, NamedTuple

import numba
import numpy as np
import typer

from sinuous.base import checks
from sinuous.base.arguments import MethodName
from sinuous.base.errors import InputError
from sinuous.base.progress import ProgressBar
from sinuous.base.system import pool_of
from sinuous.cli.app import Warm
from sinuous.cli.options import INTERRUPTED, SOLVED
from sinuous.kernels.compile import code_first, cores
from sinuous.kernels.compile.sources import COMPILER
from sinuous.kernels.compile.store import CACHE, clear, size_of
from sinuous.kernels.compile.targets import shipped
from sinuous.kernels.compile.tiers import TOOK, Piece, told_to
from sinuous.methods.learned import FEWEST_TARGETS, Learned, train
from sinuous.methods.method import METHODS, name_of
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion
from sinuous.motion.planning.memory_search import load_memory_search
from sinuous.motion.planning.rrt_connect import load_trees
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Target
from sinuous.scene.decimation import largest_distance
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
        WarmStep("preferences", partial(_preferences, None)),
        WarmStep("preferences among obstacles", partial(_preferences, FAR)),
    ]
    others = [WarmStep(f"the method {name}", partial(_method, name)) for name in chosen if name != "newton"]
    geometry = [
        WarmStep("kinematics", _kinematics),
        WarmStep("starts of a memory", _memory),
        WarmStep("distances", _distances),
        WarmStep("classes of routes", RouteCurves(ROBOT, FAR.snapshot()).load),
        WarmStep("motions", _motions),
        WarmStep("plans", _plans),
        WarmStep("control loops", partial(_loops, ROBOT)),
        WarmStep("derivatives", _derivatives),
        WarmStep("shapes under load", _shapes_under_load),
        WarmStep("control loops under load", partial(_loops, HEAVY)),
    ]
    return [*(own if "newton" in chosen else []), *geometry, *others]


def _preferences(scene: Scene | None) -> None:
    Solver._for_one_query(ROBOT, scene, prefer=Preferences(bends=1.0)).solve(TARGET)


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


def _loops(robot: Robot) -> None:
    Solver._of_checked(robot, FAR, SolveOptions.of({})).step([[0.0, 0.0, 1.0]] * len(robot), (0.0,) * 6, 1.0)


def _derivatives() -> None:
    solver = Solver._for_one_query(ROBOT, FAR)
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
    mesh = Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    largest_distance(mesh.vertices, mesh.faces, mesh.vertices, mesh.faces, 1.0)
    scene = Scene([mesh])
    scene.distance([1.0, 1.0, 1.0])
    least_gap(corners, np.zeros(len(corners)), scene.snapshot())


def warm_up(asked: Warm) -> int:
    """Compile what methods need, by default all, or show or empty what is compiled; return the exit code.

    Raises
    ------
    InputError
        When there is no such method, or options contradict each other.
    """
    typed = [name for name in ("where", "clear", "profile") if getattr(asked, name)]
    if len(typed) > 1 or (asked.method and typed not in ([], ["profile"])):
        named = [f"--{name}" for name in [*typed, *(["method"] if asked.method else [])]]
        raise InputError(named[0], f"cannot be combined with {named[1]}", True, f"one of {named[0]}, {named[1]}")
    if asked.where:
        return _show_store()
    if asked.clear:
        typer.echo(f"{clear(CACHE)} compiled kernels removed from {CACHE}")
        return SOLVED
    methods = tuple(asked.method or METHODS)
    for name in methods:
        checks.choice("--method", name, tuple(METHODS))
    return _profile(steps(methods)) if asked.profile else _compile(methods)


def _compile(methods: tuple[str, ...]) -> int:
    """Compile what these methods need."""
    listed = steps(methods)
    if COMPILER == "numba":
        typer.echo(f"sinuous: kernels are compiled by Numba {numba.__version__} alone, which takes longer", err=True)
    began = clock.perf_counter()
    shared = min(cores(), len(listed))
    try:
        with _Shown(len(listed)) as shown:
            if shared > 1:
                _use_in_processes(shared, methods, shown)
            else:
                _use_here(listed, shown)
    except KeyboardInterrupt:
        typer.echo(f"sinuous: interrupted after {shown.done} of {len(listed)}; what is compiled stays so", err=True)
        return INTERRUPTED
    seconds = clock.perf_counter() - began
    typer.echo(f"everything is compiled, in {seconds:.0f} s" if shown.compiled else "everything was compiled before")
    return SOLVED


def _show_store() -> int:
    """Say where compiled kernels are kept, how many they are, and what is shipped."""
    count, size = size_of(CACHE)
    typer.echo(f"{CACHE}: {count} files, {size / 1e6:.1f} MB")
    for folder, _ in shipped():
        typer.echo(f"{folder}: {size_of(folder)[0]} files, shipped")
    return SOLVED


def _profile(listed: list[WarmStep]) -> int:
    """Compile what is missing, one after the other, and print the CPU time of each entry."""
    first = [step for step in listed if step.what in FIRST_COMMAND]
    with _Shown(len(listed)) as shown:
        _use_here(first, shown)
        taken = sum(seconds for _, seconds in TOOK)
        _use_here([step for step in listed if step not in first], shown)
    for name, seconds in sorted(TOOK, key=lambda one: -one[1]):
        typer.echo(f"{seconds:7.2f} s  {name}")
    whole = sum(seconds for _, seconds in TOOK)
    typer.echo(f"{whole:7.2f} s of CPU for {len(TOOK)} entries; kernels count where they came first")
    typer.echo(f"{taken:7.2f} s of CPU for those of the first command of the README")
    return SOLVED


def _use_here(listed: list[WarmStep], shown: "_Shown") -> None:
    """Take one step after the other."""
    with code_first(), told_to(shown.compiling):
        for step in listed:
            shown.begin(step)
            step.use()
            shown.end()


def _use_in_processes(count: int, methods: tuple[str, ...], shown: "_Shown") -> None:
    """Take the steps in so many processes, which share what they compile through the disk."""
    said: Any = multiprocessing.get_context("spawn").SimpleQueue()
    pool = pool_of(count, _begin, said)
    try:
        listed = steps(methods)
        due = {pool.submit(_use, methods, i): step for i, step in enumerate(listed)}
        while due:
            done, _ = wait(due, timeout=0.1, return_when=FIRST_COMPLETED)
            while not said.empty():
                shown.compiling(said.get())
            for one in done:
                due.pop(one)
                one.result()
                shown.end()
            if done and due:
                shown.begin(next(iter(due.values())))
    except BaseException:
        for child in multiprocessing.active_children():
            child.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _begin(said: Any) -> None:
    """Begin a process: tell the first one what is compiled, and let an interrupt end it without a word."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _tell.append(said.put)


def _use(methods: tuple[str, ...], i: int) -> None:
    """Take a step in a process of the pool."""
    with code_first(), told_to(_tell[-1]):
        steps(methods)[i].use()


_tell: list[Callable[[Piece], None]] = []
"""In a process of the pool: how the first one is told what is compiled."""


class _Shown:
    """Shows what is compiled, how many are done and for how long: as a bar, or in lines where nobody looks at one."""

    def __init__(self, total: int) -> None:
        self.total, self.done, self.compiled = total, 0, 0
        self._bar = ProgressBar(total, what="loading")

    def __enter__(self) -> "_Shown":
        self._bar.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.__exit__()

    def begin(self, step: WarmStep) -> None:
        """Go on to a step: whether anything is to be compiled for it is not known yet."""
        self._bar.say(f"loading {step.what}")

    def end(self) -> None:
        """Count a step that is done."""
        self.done += 1
        self._bar.advance()

    def compiling(self, piece: Piece) -> None:
        """Say what is about to be compiled."""
        self.compiled += 1
        said = f"compiling {piece.what} (about {piece.expected} s)"
        self._bar.say(said)
        if not self._bar.shows:
            typer.echo(f"sinuous: {self.done + 1} of {self.total}: {said}", err=True)
