"""`python -m benchmarks mbm FOLDER`: problems of MotionBenchMaker, planned by robots at the place of the Panda.

The folder holds a file for each scenario, a problem in each line: obstacles, and the joint values of the Panda at the
start and at the goal. What counts is the CPU time of one call of `sn.plan`, from a start that is solved, in a scene in
which nothing was planned before; a plan is valid where the judges find all of it clear, and both ends where they were
asked to be.
"""

import gzip
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from statistics import median
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.harness import Experiment, Line, Plan, Times, Trial, conduct, divided, missed, refuted, require
from benchmarks.judges.judge import right, wrong_in
from benchmarks.problems import tip_targets
from benchmarks.ways import measured
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.motion.configurations import distances
from sinuous.scene.obstacles import Obstacle

SUFFIX = ".jsonl.gz"

LIMIT = 5.0
"""Seconds of CPU time in which a plan has to be found."""

PATIENCE = 3.0
"""Budget of a plan on the clock, in units of that: the machine may be busy."""

RUNS = 3
"""Plans of each problem, of which the middle one counts: the first may load compiled code."""

PUBLISHED = (
    "VAMP, for all 700 problems of the Panda itself, edges sampled, not proved (AMD Ryzen 9 7950X, one core; "
    "resources/README.md of KavrakiLab/vamp): 699 solved and valid; a plan 35 us in the median, 343 us for 95 %, "
    "1.1 ms at worst; with simplification 99, 442 us and 1.2 ms. Its Panda has a hand; this one ends at its flange."
)

PLANNED = f"planned within {LIMIT:g} s, and found valid by the judges"
COSTS = "length of the path"
FALSE = "plans called solved that a judge finds wrong"

Problem = dict[str, Any]


class Asked(NamedTuple):
    """A robot among obstacles, and where it is asked to begin and to end: targets, or configurations."""

    robot: sn.Robot
    scene: sn.Scene
    start: sn.Target | Floats
    goal: sn.Target | Floats


class Planned(NamedTuple):
    """What came of a problem, and the length of the path."""

    trial: Trial
    cost: float = math.nan


@cache
def arm() -> sn.Robot:
    """Six segments, as long as the Panda together."""
    return sn.Robot([sn.Segment((0.10, 0.26), max_bend=1.8, radius=0.04)] * 6, mount=0.12)


@cache
def panda() -> sn.Robot:
    """The Panda up to its flange, with the links that its joints move."""
    return sn.load(Path(__file__).parent / "data/panda.yaml", sn.Robot)


def continuum(problem: Problem) -> Asked:
    """Put an arm of six segments at the place of the Panda; its tip is asked where the flange is, and points along."""
    start, goal = tip_targets(panda(), np.array(_ends(problem)))
    return Asked(arm(), sn.Scene([obstacle(each) for each in problem["obstacles"]]), start, goal)


def itself(problem: Problem) -> Asked:
    """Put the Panda there; it is asked for joint values."""
    return Asked(panda(), sn.Scene([obstacle(each) for each in problem["obstacles"]]), *_ends(problem))


def _ends(problem: Problem) -> list[Floats]:
    """Configurations of the Panda at the start and at the goal."""
    return [panda().with_joints(None, np.array(problem[end])) for end in ("start", "goal")]


ROBOTS: dict[str, Callable[[Problem], Asked]] = {"continuum": continuum, "panda": itself}
"""From a problem to what is asked of a robot at the place of the Panda."""


def obstacle(given: dict[str, Any]) -> Obstacle:
    """Return a box or a cylinder of a problem."""
    center, xyzw = np.array(given["position"]), given["quaternion_xyzw"]
    if given["type"] == "box":
        return sn.Box(center, given["dimensions"], xyzw=xyzw, name=given["name"])
    length, radius = given["dimensions"]
    half = 0.5 * length * Rotation.from_quat(xyzw).as_matrix()[:, 2]
    return sn.Cylinder(center - half, center + half, radius, name=given["name"])


def read_scenarios(folder: Path) -> dict[str, list[Problem]]:
    """Read all problems of a folder, by scenario.

    Raises
    ------
    InputError
        When it holds none.
    """
    files = sorted(folder.glob(f"*{SUFFIX}"))
    if not files:
        raise InputError("FOLDER", f"has no files *{SUFFIX}", str(folder), "the problems, a file for each scenario")
    texts = {file.name.removesuffix(SUFFIX): gzip.decompress(file.read_bytes()) for file in files}
    return {name: [json.loads(line) for line in text.splitlines()] for name, text in texts.items()}


def examine(robot: str, seed: int, problem: Problem) -> Planned:
    """Plan one problem, and judge the plan."""
    motions, number = [], problem["problem"]
    for _ in range(RUNS):
        asked = ROBOTS[robot](problem)
        start: sn.Target | sn.Solution | Floats = asked.start
        if isinstance(start, sn.Target):
            start = sn.solve(asked.robot, start, asked.scene, seed=seed)
            if not start.solved:
                return Planned(Trial(number, math.inf, f"start {start.status}"))
        if why := _outside(asked):
            return Planned(Trial(number, math.inf, why))
        plan = partial(sn.plan, time=PATIENCE * LIMIT, seed=seed)
        motions.append(measured(plan, asked.robot, start, asked.goal, asked.scene))
    motion = motions[0][0]
    wrong = _wrong(asked, motion) if motion.solved else ""
    cost = float(distances(asked.robot, motion.configuration).sum())
    return Planned(Trial(number, median(spent for _, spent in motions), str(motion.status), wrong), cost)


def _outside(asked: Asked) -> str:
    """Say whether a configuration that is asked for is beyond its limits."""
    ends = [end for end in (asked.start, asked.goal) if not isinstance(end, sn.Target)]
    return "limits exclude an end" if any(asked.robot.violations(end) for end in ends) else ""


def _wrong(asked: Asked, motion: sn.Motion) -> str:
    """Say what is wrong with a motion; nothing where it is as was asked."""
    for end, q in zip((asked.start, asked.goal), motion.configuration[[0, -1]], strict=True):
        if not (
            right(asked.robot, [end], q[None], sn.Tolerance()).all()
            if isinstance(end, sn.Target)
            else np.array_equal(q, end)
        ):
            return "not at its ends"
    return wrong_in(asked.robot, asked.scene, motion.configuration)


def lines_of(name: str, planned: Sequence[Planned]) -> Iterator[Line]:
    """Sum up a scenario: what is planned in time, and how long its paths are; times are those of such plans."""
    good = [each for each in planned if each.trial.good(LIMIT)]
    names = missed([each.trial for each in planned], LIMIT)
    times = Times.of([each.trial.seconds for each in good] or [math.nan])
    solved, note = (len(good), len(planned)), f"not solved, or not valid: {names}" if names else ""
    yield Line(PLANNED, name, 100.0 * len(good) / len(planned), "%", None, times, solved, note)
    costs = Times.of([each.cost for each in good] or [math.nan])
    yield Line(COSTS, f"{name}, median", costs.median, "m")
    yield Line(COSTS, f"{name}, 95 %", costs.p95, "m")


def total_of(found: Mapping[str, Sequence[Planned]]) -> Iterator[Line]:
    """Sum up all scenarios, and count false claims."""
    yield from lines_of("all", [each for own in found.values() for each in own])
    yield refuted(FALSE, "all", {name: [each.trial for each in own] for name, own in found.items()})


def run(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The problems, a file for each scenario.")],
    robot: Annotated[str, typer.Option(help=f"At the place of the Panda: {', '.join(ROBOTS)}.")] = "continuum",
    count: Annotated[int, typer.Option(help="Problems of each scenario, at most.")] = 10_000,
    seed: Annotated[int, typer.Option(help="Of the planner.")] = 0,
    quick: Annotated[bool, typer.Option("--quick", help="One problem of each scenario, in this process.")] = False,
    out: Annotated[Path | None, typer.Option(metavar="FOLDER", help="Folder of journal and results.")] = None,
    record: Annotated[Path | None, typer.Option(metavar="FOLDER", help="Also keep the report there.")] = None,
) -> None:
    """Plan problems of MotionBenchMaker; the exit code is 1 when a plan was wrong."""
    checks.choice("--robot", robot, tuple(ROBOTS))
    checks.integer("--count", count, 1, 10_000)
    checks.integer("--seed", seed, 0, 2**31 - 1)
    require()
    plan = Plan(seed, quick)
    most, work = plan.count(count, 1), partial(examine, robot, seed)
    parts = {
        name: divided(plan, work, problems[:most], most, partial(lines_of, name))
        for name, problems in read_scenarios(folder).items()
    }
    protocol = (
        f"{robot}, at most {count} problems of each scenario of {folder.name}; CPU time of one call of sn.plan, the "
        f"middle one of {RUNS}, each in a scene of its own; valid as the judges find it; the length of a path counts a "
        f"change of a bend by the length of what it moves. {PUBLISHED}"
    )
    name = "mbm" if robot == "continuum" else f"mbm_{robot}"
    raise typer.Exit(conduct(Experiment(name, plan, parts, protocol, total_of), out, record))
