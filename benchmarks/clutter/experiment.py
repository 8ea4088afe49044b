"""`python -m benchmarks clutter`: intricate places, each known to be possible; `worlds`: very many small ones."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import partial
from statistics import median
from typing import Any

from benchmarks.clutter.trials import Attempt, Task, Trial, examine
from benchmarks.harness.experiment import Divided, OfLines
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.places import FAMILIES
from benchmarks.solvers.parallel import Abreast
from sinuous.solver.options import read_without

COUNT, QUICK, TOGETHER = 60, 2, 5
"""Places of a family: three times all robots; in a quick run; and of one share, which an interrupt costs a process."""

PUBLISHED, PUBLISHED_QUICK, PUBLISHED_TOGETHER = 400, 8, 50
"""The same of a published protocol: a hundred in each of its four scenes."""

SMALL = "small world"
WORLDS, WORLDS_QUICK, WORLDS_TOGETHER = 100_000, 200, 100
"""The same of small worlds, made to find false claims that are rare."""

SOLVED = "solved and proved within 1 s, and found right by the judges"
FALSE = 'wrong claims: "solved" where a judge disagrees, or "impossible" where there is the hidden shape'
MEDIAN = "median time (one core, warm; the goal is stricter where the single arc alone solves 99 %)"
TAIL = "time that 95 % of the solves keep within"
WORST = "worst time"
FIRST = "from robot and obstacles to the first answer, median"
ALONE = "compared: newton from the single arc alone"

NOISE = 2.0
"""Of a worst time."""

NARROW = 10e-3
"""Goal of the median where a pipe is 1.3 times as wide as the body, seconds."""

LIMIT = 1.0
"""Seconds after which an answer comes too late."""

SHOWN = 40
"""Most seeds that a line lists."""

COUNTED = (
    f"budget {LIMIT:g} s; timed is the second of two calls of solve, in a process that keeps to one core; counted is "
    "what says solved within the budget and the judges find right"
)


class Clutter(Abreast, OfLines):
    """The experiment; see `Experiment`. Its parts are the families.

    Parameters
    ----------
    plan : Plan
    """

    protocol = (
        f"place i of a family is benchmarks.places.make(family, 1000 * seed + i), i below {COUNT} ({PUBLISHED} for p3 "
        "and p4); constants may be tuned on even numbers below 1000 only, and on no place of a judging kind, so every "
        f"seed but 0 judges; {COUNTED}"
    )

    def __init__(self, plan: Plan) -> None:
        super().__init__("clutter", plan)
        self._without: tuple[str, ...] = ()

    def switch_off(self, names: Sequence[str]) -> None:
        """Measure without some attempts of the solver; see `sinuous.solver.attempts.ATTEMPTS`.

        Raises
        ------
        InputError
            Where one is not known.
        """
        self._without = read_without(list(names))

    def settings(self) -> dict[str, Any]:
        """Return what is switched off."""
        return {"without": ",".join(self._without)} if self._without else {}

    def parts(self) -> Iterator[tuple[str, Divided]]:
        """Every family, some places a piece."""
        for family, own in FAMILIES.items():
            sizes = (PUBLISHED, PUBLISHED_QUICK) if own.published else (COUNT, QUICK)
            count, first = self.plan.count(*sizes), 1000 * self.plan.seed
            tasks = [Task(family, seed, self._without) for seed in range(first, first + count)]
            yield family, divided(tasks, PUBLISHED_TOGETHER if own.published else TOGETHER)


class Worlds(Abreast, OfLines):
    """The experiment; see `Experiment`. `benchmarks.places.make("small world", number)` makes a world again.

    Parameters
    ----------
    plan : Plan
        World i has the number `WORLDS * seed + i`.
    """

    protocol = f"world i is benchmarks.places.make({SMALL!r}, {WORLDS} * seed + i); {COUNTED}"

    def __init__(self, plan: Plan) -> None:
        super().__init__("worlds", plan)

    def parts(self) -> Iterator[tuple[str, Divided]]:
        """All worlds in their order, a hundred a piece."""
        count, first = self.plan.count(WORLDS, WORLDS_QUICK), WORLDS * self.plan.seed
        yield SMALL, divided([Task(SMALL, number) for number in range(first, first + count)], WORLDS_TOGETHER)


def divided(tasks: Sequence[Task], together: int) -> Divided:
    """Return places of one family, some at a time, and what sums them up."""
    shares = [partial(tried, tasks[i : i + together]) for i in range(0, len(tasks), together)]
    return Divided(shares, partial(summed, tasks[0].family))


def tried(tasks: Sequence[Task]) -> list[dict[str, Any]]:
    """Try some places; return plain values of the trials."""
    return [asdict(examine(task)) for task in tasks]


def summed(family: str, shares: list[list[dict[str, Any]]]) -> Iterator[Line]:
    """Summarise a family of which some shares were tried."""
    return lines_of(family, [Trial.of(plain) for share in shares for plain in share])


def lines_of(family: str, trials: list[Trial]) -> Iterator[Line]:
    """Summarise one family: every family on the same lines, so that they can be compared."""
    own = FAMILIES[family]
    ours, arcs = [trial.ours for trial in trials], [trial.arc for trial in trials]
    times = Times.of([attempt.seconds for attempt in ours])
    good = [attempt.solved and attempt.seconds <= LIMIT for attempt in ours]
    goal = Goal(100.0 if own.published else 99.0, at_most=False)
    failed = [trial for trial, well in zip(trials, good, strict=True) if not well]
    won = Counter(attempt.start for attempt in ours if attempt.solved).most_common()
    winners = "won by " + (", ".join(f"{kind} {count}" for kind, count in won) or "none")
    note = "; ".join([own.words + " (judging only)" * own.judging, winners, *_listed("not solved", failed)])
    yield Line(SOLVED, family, 100.0 * sum(good) / len(good), "%", goal, times, (sum(good), len(good)), note)
    wrong = [trial for trial in trials if trial.ours.false or trial.arc.false]
    yield Line(FALSE, family, len(wrong), "", Goal(0, correctness=True), note="; ".join(_listed("wrong", wrong)))
    local = _solved(arcs) >= 0.99 * len(arcs)
    fast = Goal(200e-6 if own.published else 100e-6 if local else NARROW if "1.3" in family else 5e-3)
    yield Line(MEDIAN, family, times.median, "us" if fast.value < 1e-3 else "ms", fast)
    yield Line(TAIL, family, times.p95, "ms", Goal(50e-3), noise=NOISE)
    yield Line(WORST, family, times.worst, "ms", Goal(LIMIT), noise=NOISE)
    yield Line(FIRST, family, median(trial.prepare + trial.ours.first for trial in trials), "ms", noise=0.5)
    alone = Times.of([attempt.seconds for attempt in arcs])
    yield Line(ALONE, family, 100.0 * _solved(arcs) / len(arcs), "%", None, alone, (_solved(arcs), len(arcs)))


def _solved(attempts: Sequence[Attempt]) -> int:
    return sum(attempt.solved for attempt in attempts)


def _listed(what: str, trials: list[Trial]) -> list[str]:
    """Seeds and statuses, to begin a search with; nothing when there are none."""
    listed = ", ".join(f"{trial.seed} ({trial.ours.status})" for trial in trials[:SHOWN])
    return [f"{what}: seeds {listed}{' ...' * (len(trials) > SHOWN)}"] if trials else []
