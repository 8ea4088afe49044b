"""Why a solve ended as it did, and what would help."""

from dataclasses import dataclass
from typing import Any

from sinuous.answer.binding import Binding, in_words, nearest_limits
from sinuous.answer.remedies import Remedy, find_remedies
from sinuous.answer.residual import residual_under_load
from sinuous.answer.solve_again import SolveAgain
from sinuous.answer.status import Reason, Status
from sinuous.answer.trials import Case, Trials
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError, degrees, number
from sinuous.base.frozen import NotebookMixin, call

NONE_TRIED = "no change was tried: "
"""What `untried` begins with where there was nothing to try."""

LOADED = f"{NONE_TRIED}a result that was read from a file does not say with which options it was found"

MORE = 5.0
"""How many times more time is advised where it was too short, at least a second."""

NOTHING = "nothing that was tried would help"

ALONE = "the target is not reached even without obstacles"

MOST_LINES = 6
"""Most lines about what holds a configuration back."""


@dataclass(frozen=True, repr=False)
class Explanation(NotebookMixin):
    """Why a solve ended as it did, and what would help; prints itself.

    Attributes
    ----------
    status : Status
    sentence : str
        What the status means here.
    reason : Reason or None
        What proves that there is no solution.
    misses : str
        By how much the best configuration misses the targets; empty when it meets them.
    binding : tuple of Binding
        What holds the best configuration back, strongest first.
    nearest : tuple of Binding
        When solved: the limits of which least is left.
    remedies : tuple of Remedy
        Changes that were tried; with each the problem is solved and proved.
    untried : str
        Why not all changes were tried; empty where they were.
    obstacles_matter : bool
        False where no solution was found without obstacles either.
    segments : int
        Of the robot.
    """

    status: Status
    sentence: str
    reason: Reason | None
    misses: str
    binding: tuple[Binding, ...]
    nearest: tuple[Binding, ...]
    remedies: tuple[Remedy, ...]
    untried: str
    obstacles_matter: bool
    segments: int

    @property
    def complete(self) -> bool:
        """Whether all changes were tried."""
        return not self.untried

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values."""
        reason = None if self.reason is None else str(self.reason)
        return {**result_of(self, "status sentence"), "reason": reason, **result_of(self, "binding remedies complete")}

    def __str__(self) -> str:
        lines = [f"{self.status}: {self.sentence}"]
        if self.reason is not None:
            lines.append(f"  because    {self.reason}")
        if self.misses:
            lines.append(f"  best found {self.misses}")
        lines += _labelled("held by", in_words(self.binding, self.segments, values=True))
        lines += _labelled("nearly at", in_words(self.nearest, self.segments, values=True))
        lines += _labelled("would help", [str(each) for each in self.remedies])
        none = self.status is not Status.SOLVED and not self.remedies and not self.untried.startswith(NONE_TRIED)
        said = "" if self.obstacles_matter else ALONE, NOTHING if none else "", self.untried
        return "\n".join([*lines, *(f"  {each[0].upper()}{each[1:]}." for each in said if each)])

    def __repr__(self) -> str:
        counted = [f"{len(self.binding)} binding", f"{len(self.remedies)} remedies"]
        return call("Explanation", [str(self.status), *counted])


def _labelled(label: str, texts: list[str]) -> list[str]:
    """Lines with a label before the first; a long list is cut."""
    shown = texts if len(texts) <= MOST_LINES + 1 else [*texts[:MOST_LINES], f"and {len(texts) - MOST_LINES} more"]
    return [f"  {label if i == 0 else '':<10} {text}" for i, text in enumerate(shown)]


def explain(case: Case, sentence: str, end: float, seconds: float) -> Explanation:
    """Explain a solve, until the time is `end` (by `work_time`); `sentence` is what its status means here.

    `seconds`: how much time that was, from the beginning.
    """
    own, count = (case.status, sentence, case.reason, _misses(case), case.binding), len(case.problem.robot.segments)
    if case.status is Status.SOLVED:
        return Explanation(*own, nearest_limits(case.problem, case.q), (), "", True, count)
    if type(case.resolver) is SolveAgain:  # read from a file
        return Explanation(*own, (), (), LOADED, True, count)
    trials = Trials(case, end)
    remedies = find_remedies(trials, case)
    return Explanation(
        *own, (), remedies, "" if trials.complete else _too_short(seconds), trials.obstacles_matter, count
    )


def _too_short(seconds: float) -> str:
    """Say that the time was too short, and how to give more."""
    more = f"{max(1.0, MORE * seconds):.2g}"
    return f"the time was too short to try everything: explain(time={more}), or --why-time {more}, gives it more"


def _misses(case: Case) -> str:
    """By how much the best configuration misses its targets."""
    tolerance = case.problem.tolerance
    try:
        residual = residual_under_load(case.problem, case.q)
    except InputError:  # no equilibrium
        return ""
    off, turn = residual.position_error, residual.angle_error
    parts = [f"{number(off)} from the position"] if off > (tolerance.position or 0.0) else []
    aim = "rotation" if any(each.rotation is not None for each in case.problem.targets) else "direction"
    parts += [f"{number(turn)} rad ({degrees(turn)}) from the {aim}"] if turn > tolerance.angle else []
    return " and ".join(parts)
