"""The figures of `clutter`: every family on the same lines, so that they can be compared."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import partial
from statistics import median
from typing import Any

from benchmarks.clutter.trials import ARC, IPOPT, RANDOM, Attempt, Task, Trial, examine
from benchmarks.harness.experiment import Divided
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.places import FAMILIES

COUNT, QUICK = 60, 2
"""Places of a family: three times all robots; in a quick run."""

PROTOCOL, PROTOCOL_QUICK = 400, 8
"""Targets of a published protocol: a hundred in each of its four scenes."""

TOGETHER, TOGETHER_PROTOCOL = 5, 50
"""Places of one share: what an interrupt may cost a process."""

SOLVED = "solved and proved within 1 s, and found right by the judges"
FALSE = 'wrong claims: "solved" where a judge disagrees, or "impossible" where there is the hidden shape'
MEDIAN = "median time (one core, warm; the goal is stricter where the single arc alone solves 99 %)"
TAIL = "time that 95 % of the solves keep within"
WORST = "worst time"
PROOF = "one look and the proof, as a share of the solve in the kernel, median (50 %: as long as all the rest)"
FIRST = "from robot and obstacles to the first answer, median"
ALONE = {
    ARC: "compared: newton from the single arc alone",
    RANDOM: "compared: the single arc and 100 random initial configurations, no routes, on every third place",
    IPOPT: "compared: IPOPT by casadi from the single arc, then from two random configurations, on a few places "
    "(balls only: meshes and clouds lack the derivatives that it needs)",
}
NOISE = 2.0
"""Of a worst time."""

NARROW = 10e-3
"""Goal of the median where a pipe is 1.3 times as wide as the body, seconds."""

LIMIT = 1.0
"""Seconds after which an answer comes too late."""

COUNTED = (
    f"budget {LIMIT:g} s; timed is the second of two calls of solve, in a process that keeps to one core; counted is "
    "what says solved within the budget and the judges find right"
)
"""How a place is timed, and what counts."""


def divided(plan: Plan, family: str, without: tuple[str, ...] = ()) -> Divided:
    """Return the places of a family, some at a time, and what sums them up; `without` some attempts of the solver."""
    tasks = [task._replace(without=without) for task in tasks_of(plan, family)]
    size = TOGETHER_PROTOCOL if FAMILIES[family].published else TOGETHER
    return Divided([partial(tried, tasks[i : i + size]) for i in range(0, len(tasks), size)], partial(summed, family))


def tried(tasks: Sequence[Task]) -> list[dict[str, Any]]:
    """Try some places; return plain values of the trials."""
    return [asdict(examine(task)) for task in tasks]


def summed(family: str, shares: list[list[dict[str, Any]]]) -> Iterator[Line]:
    """Summarise a family of which some shares were tried."""
    return lines_of(family, [Trial.of(plain) for share in shares for plain in share])


def tasks_of(plan: Plan, family: str) -> list[Task]:
    """Return the places of a family, and what each is compared with: the slower, the fewer."""
    published = FAMILIES[family].published
    count = plan.count(PROTOCOL, PROTOCOL_QUICK) if published else plan.count(COUNT, QUICK)
    rare = [0, 33, 66, 99] if published else [0, 6, 20, 26]
    tasks = []
    for i in range(count):
        compared = [ARC]
        if not FAMILIES[family].trap:
            compared += [RANDOM] * (i % 3 == 0) + [IPOPT] * (i in rare)
        tasks.append(Task(family, 1000 * plan.seed + i, tuple(compared)))
    return tasks


def lines_of(family: str, trials: list[Trial]) -> Iterator[Line]:
    """Summarise one family."""
    published = FAMILIES[family].published
    ours = [trial.ours for trial in trials]
    times = Times.of([attempt.seconds for attempt in ours])
    good = [attempt.solved and attempt.seconds <= LIMIT for attempt in ours]
    share = 100.0 * sum(good) / len(good)
    goal = Goal(100.0 if published else 99.0, at_most=False)
    failed = [trial for trial, well in zip(trials, good, strict=True) if not well]
    words = FAMILIES[family].words + " (judging only)" * FAMILIES[family].judging
    note = "; ".join([words, _winners(ours), *_listed("not solved", failed)])
    yield Line(SOLVED, family, share, "%", goal, times, (sum(good), len(good)), note)
    wrong = [trial for trial in trials if any(attempt.false for attempt in _claims(trial))]
    note = "; ".join(_listed("wrong", wrong))
    yield Line(FALSE, family, len(wrong), "", Goal(0, correctness=True), None, None, note)
    others = {name: [trial.others[name] for trial in trials if name in trial.others] for name in ALONE}
    local = sum(attempt.solved for attempt in others[ARC]) >= 0.99 * len(others[ARC])
    fast = Goal(200e-6 if published else 100e-6 if local else NARROW if "1.3" in family else 5e-3)
    yield Line(MEDIAN, family, times.median, "us" if fast.value < 1e-3 else "ms", fast)
    yield Line(TAIL, family, times.p95, "ms", Goal(50e-3), noise=NOISE)
    yield Line(WORST, family, times.worst, "ms", Goal(LIMIT), noise=NOISE)
    proofs = [trial.proof for trial in trials if trial.proof is not None]
    if proofs:
        yield Line(PROOF, family, 100.0 * median(proofs), "%", Goal(50.0))
    yield Line(FIRST, family, median(trial.prepare + trial.ours.first for trial in trials), "ms", noise=0.5)
    for name, attempts in others.items():
        if attempts:
            yield _compared(ALONE[name], family, attempts)


def _claims(trial: Trial) -> list[Attempt]:
    """Attempts whose claims are this library's."""
    return [trial.ours, *(attempt for name, attempt in trial.others.items() if name != IPOPT)]


def _winners(attempts: list[Attempt]) -> str:
    """Which kinds of starts won, the most frequent first."""
    counts = Counter(attempt.start for attempt in attempts if attempt.solved)
    return "won by " + (", ".join(f"{kind} {count}" for kind, count in counts.most_common()) or "none")


def _listed(what: str, trials: list[Trial]) -> list[str]:
    """Seeds and statuses, to begin a search with; nothing when there are none."""
    listed = ", ".join(f"{trial.seed} ({trial.ours.status})" for trial in trials)
    return [f"{what}: seeds {listed}"] if trials else []


def _compared(section: str, family: str, attempts: list[Attempt]) -> Line:
    solved = sum(attempt.solved for attempt in attempts)
    times = Times.of([attempt.seconds for attempt in attempts])
    return Line(section, family, 100.0 * solved / len(attempts), "%", None, times, (solved, len(attempts)))
