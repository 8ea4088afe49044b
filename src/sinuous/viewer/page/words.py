"""What the page says of a shape, as HTML."""

import html as markup
from collections.abc import Sequence

from sinuous.solution.binding import in_words
from sinuous.solution.solution import Solution
from sinuous.viewer.model.judging import Judgement, Near
from sinuous.viewer.model.model import Model
from sinuous.words import duration

GOOD, OFF, PALE = "#00694c", "#a34700", "#6b7178"
MOST_BINDING = 4
"""Limits and obstacles that are named."""

STYLE = """<style>
.sinuous { font: 13px/1.45 system-ui, sans-serif; padding: 2px 12px 6px; overflow-wrap: anywhere; }
.sinuous table { border-collapse: collapse; width: 100%; }
.sinuous td { padding: 1px 10px 1px 0; vertical-align: top; font-variant-numeric: tabular-nums; }
.sinuous td:first-child { color: #6b7178; white-space: nowrap; width: 1%; }
.sinuous .badge { display: inline-block; border-radius: 9px; padding: 0 9px; color: white; font-weight: 600; }
.sinuous .scale { height: 8px; border-radius: 4px; margin: 2px 0; }
.sinuous .ends { display: flex; justify-content: space-between; color: #6b7178; font-size: 12px; }
button:has(.tabler-icon-adjustments) { display: none; }
.sinuous .notice { color: #a34700; margin-top: 4px; }
</style>"""

Row = tuple[str, Sequence[str]]


def status_of(model: Model, near: Near | None, judged: Judgement | None, busy: bool) -> str:
    """What holds of the shape on the page, in a table with one column a method."""
    there = [*_of_time(model), *_of_near(near)]
    if model.motion is not None:
        summary = str(model.motion).split("\n", maxsplit=1)[0].partition(": ")[2]
        rows: list[Row] = [("motion", [summary]), *there]
        proved = model.step_is_proved
        return _table([_badge("proved clear here" if proved else "not proved clear here", proved)], rows)
    if model.by_hand and judged is not None:
        return _table([_badge("bent by hand", not judged.violations)], [*_of_judgement(judged), *there])
    if not model.targets:
        return _table([_badge("the start" if model.job.start is not None else "no start", True)], there)
    if model.answer is None:
        return _table([_badge("not solved yet", False)], there)
    answers = [model.answer] if model.beside is None else [model.answer, model.beside]
    badges = [_badge(str(each.status).replace("_", " "), each.solved) for each in answers]
    if busy:
        badges[0] = _badge("not solved yet", False)
    if model.beside is not None:
        badges = [f"{badge}<br>{markup.escape(each.method)}" for badge, each in zip(badges, answers, strict=True)]
    rows = _of_answers(answers)
    if busy:
        rows.append(("", ["still looking ..."]))
    return _table(badges, [*rows, *there])


def _of_answers(answers: list[Solution]) -> list[Row]:
    tolerance = answers[0].problem.tolerance
    rows: list[Row] = [
        ("", [each.sentence if not each.solved else "" for each in answers]),
        ("violated", ["" if each.worst is None else str(each.worst) for each in answers]),
        ("proof", ["" if each.reason is None else str(each.reason) for each in answers]),
        ("held by", ["; ".join(_binding(each)) for each in answers]),
        ("off target", [_number(each.position_error, f" (tolerance {tolerance.position:.3g})") for each in answers]),
        ("angle", [_number(each.angle_error, f" rad (tolerance {tolerance.angle:.3g})") for each in answers]),
        ("clearance", [_number(each.clearance, ", proved", "at least ") for each in answers]),
        ("from itself", [_number(each.self_clearance, ", proved", "at least ") for each in answers]),
        ("time", [f"{duration(each.seconds)}, {each.starts} starts, won by: {each.start}" for each in answers]),
    ]
    return [row for row in rows if any(row[1])]


def _binding(solution: Solution) -> list[str]:
    return in_words(solution.binding, len(solution.problem.robot), values=True)[:MOST_BINDING]


def _of_judgement(judged: Judgement) -> list[Row]:
    beyond = [f"{kind} of segment {k} by {amount:.3g}" for kind, k, amount in judged.violations]
    rows: list[Row] = [
        ("off target", [_number(judged.position_error)]),
        ("angle", [_number(judged.angle_error, " rad")]),
        ("violated", ["; ".join(beyond[:MOST_BINDING])]),
    ]
    return [row for row in rows if any(row[1])]


def _of_time(model: Model) -> list[Row]:
    """The time on the page, where something moves."""
    first, last = model.window
    return [("at time", [f"{model.time:.2f}, from {first:g} to {last:g}"])] if first < last else []


def _of_near(near: Near | None) -> list[Row]:
    if near is None:
        return []
    where = f"{near.distance:.3g} away" if near.distance >= 0.0 else f"{-near.distance:.3g} deep in it"
    return [("nearest", [f"{near.obstacle}, {where}"])]


def notice(text: str) -> str:
    """One line about what was refused; nothing where nothing was."""
    return f'<div class="notice">{markup.escape(" ".join(text.split()))}</div>' if text else ""


def scale(low: str, high: str, colours: Sequence[str]) -> str:
    """A legend: what the colours of the body mean."""
    bar = f'<div class="scale" style="background:linear-gradient(90deg,{",".join(colours)})"></div>'
    return f'{bar}<div class="ends"><span>{markup.escape(low)}</span><span>{markup.escape(high)}</span></div>'


def framed(*parts: str) -> str:
    """Parts as one block of the panel."""
    return f'<div class="sinuous">{"".join(parts)}</div>'


def _badge(word: str, good: bool) -> str:
    return f'<span class="badge" style="background:{GOOD if good else OFF}">{markup.escape(word)}</span>'


def _table(badges: Sequence[str], rows: Sequence[Row]) -> str:
    head = "".join(f"<td>{badge}</td>" for badge in badges)
    lines = "".join(
        f"<tr><td>{markup.escape(label)}</td>{''.join(f'<td>{markup.escape(cell)}</td>' for cell in cells)}</tr>"
        for label, cells in rows
    )
    return f"<table><tr><td></td>{head}</tr>{lines}</table>"


def _number(value: float | None, behind: str = "", before: str = "") -> str:
    if value is None or value == float("inf"):
        return ""
    return f"{before}{value:.3g}{behind}"
