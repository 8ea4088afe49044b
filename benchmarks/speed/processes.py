"""How long a fresh process takes, and whether memory grows over many solves.

To import, to help, to solve, and to compile when nothing is in the cache; `many` measures what a second thread adds.
"""

import os
import subprocess
import sys
import tempfile
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from itertools import cycle, islice
from pathlib import Path

from benchmarks.harness import Goal, Line, Plan, Times, timed
from benchmarks.problems import ProblemSet, among_spheres, arm
from sinuous.solver.solver import Solver

FRESH = "fresh processes, from start to end, with the interpreter's own start"

IMPORT = "import sinuous"
HELP = "import sys; sys.argv = ['sinuous', '--help']; from sinuous.cli.app import main; main()"
SOLVE = """
import sinuous as sn
robot = sn.Robot.uniform(5, (45, 70), 2.4, radius=4, base=sn.pose(direction=(0, 0, -1)))
target = sn.Target((-10, 40, -260), direction=(0, 0.2169, -0.9762))
solution = sn.solve(robot, target, [sn.Sphere((0, 80, -120), 25)])
assert solution.solved, solution
"""
FREE = SOLVE.replace("[sn.Sphere((0, 80, -120), 25)]", "None")
ROOT = Path(__file__).parents[2]
README = (
    "import sys; sys.argv = ['sinuous', 'solve', 'examples/insertion_room.yaml']; "
    "from sinuous.cli.app import main; main()"
)
ONE_CORE = "import os; hasattr(os, 'sched_setaffinity') and os.sched_setaffinity(0, {min(os.sched_getaffinity(0))}); "
LOAD = 4
"""Processes that do nothing but work, beside those that are measured."""

LATER = "the README's command, nothing compiled, against what it takes interpreted (least of several, by turns)"


def measure_startup(plan: Plan) -> Iterator[Line]:
    """Medians over a few processes; once each with an empty store."""
    repeats = plan.count(5, 1)
    yield _line("import sinuous", IMPORT, repeats, Goal(0.3))
    yield _line("sinuous --help", HELP, repeats, Goal(0.3))
    yield _line("first solve, compiled before", SOLVE, repeats, Goal(1.2))
    if not plan.quick:
        yield _first("first solve ever, nothing compiled, and said so", FREE)
        yield _first("the same among obstacles", SOLVE)
        yield _later("on all cores", README, repeats)
        yield _later("on one core", ONE_CORE + README, repeats)
        with _busy(LOAD):
            yield _later(f"beside a load of {LOAD}", README, repeats)


def _line(what: str, code: str, repeats: int, goal: Goal) -> Line:
    runs = [_run(code, dict(os.environ)) for _ in range(repeats + 1)][1:]  # the first one warms the disk
    times = Times.of([seconds for seconds, _ in runs])
    return Line(FRESH, what, times.median, "s", goal, times)


def _run(code: str, environment: dict[str, str]) -> tuple[float, str]:
    """Return how long a process takes, s, and what it says on standard error; one that fails ends the measurement."""
    run = partial(subprocess.run, env=environment, capture_output=True, text=True, check=True, cwd=ROOT)
    done, seconds = timed(run, [sys.executable, "-c", code])
    return seconds, done.stderr


def _first(what: str, code: str) -> Line:
    seconds, said = _run_from_nothing(code, "auto")
    note = "nothing was said of compiling" * ("compiled" not in said)
    return Line(FRESH, what, float("inf") if note else seconds, "s", Goal(10.0), note=note)


def _run_from_nothing(code: str, mode: str) -> tuple[float, str]:
    with tempfile.TemporaryDirectory() as folder:
        return _run(code, {**os.environ, "SINUOUS_KERNELS": mode, "SINUOUS_CACHE": folder})


def _later(what: str, code: str, repeats: int) -> Line:
    runs = [[_run_from_nothing(code, mode)[0] for mode in ("auto", "interpreted")] for _ in range(repeats)]
    first, alone = (min(each) for each in zip(*runs, strict=True))
    return Line(LATER, what, first / alone, "times", Goal(1.3), note=f"{first:.1f} s against {alone:.1f} s")


@contextmanager
def _busy(count: int) -> Iterator[None]:
    """Have so many processes work within."""
    with ExitStack() as stack:
        for _ in range(count):
            process = subprocess.Popen([sys.executable, "-c", "while True: pass"])
            stack.callback(process.wait)
            stack.callback(process.kill)
        yield


ENDURANCE = "endurance"


def measure_endurance(plan: Plan) -> Iterator[Line]:
    """Solve again and again among spheres."""
    yield from _memory(plan, among_spheres(arm(5, 2.4, radius=4.0), 40, plan.count(500, 20), plan.rng(6)))


def _memory(plan: Plan, problems: ProblemSet) -> Iterator[Line]:
    """Growth of what the process holds, and of what Python and NumPy allocated, after a warm-up."""
    solver = Solver(problems.robot, problems.scene)

    def growth(held: Callable[[], int], before: int, count: int) -> float:
        """KiB by which so many solves let grow what is held, after some others."""
        _one_by_one(solver, problems, before)
        begun = held()
        _one_by_one(solver, problems, count)
        return (held() - begun) / 1024.0

    count, note = plan.count(100_000, 1000), "" if _resident() else "this system does not say what a process holds"
    what, most = f"growth of the process over {count} solves", Goal(1024.0, correctness=True)
    yield Line(ENDURANCE, what, growth(_resident, 1000, count), "KiB", most, note=note)
    count = plan.count(20_000, 500)
    tracemalloc.start()
    try:
        grown = growth(lambda: tracemalloc.get_traced_memory()[0], 100, count)
    finally:
        tracemalloc.stop()
    what = f"growth of traced allocations over {count} solves"
    yield Line(ENDURANCE, what, grown, "KiB", Goal(64.0, correctness=True))


def _resident() -> int:
    """Bytes that the process holds in memory; 0 where the system does not say."""
    listing = Path("/proc/self/statm")
    return int(listing.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") if listing.exists() else 0


def _one_by_one(solver: Solver, problems: ProblemSet, count: int) -> None:
    for target in islice(cycle(problems.targets), count):
        solver.solve(target)
