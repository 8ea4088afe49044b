"""What the page says of the shape that it shows: measured, and as HTML."""

import html as markup
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sinuous.answer.binding import in_words
from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, labelled
from sinuous.measures.body import segment_ends
from sinuous.measures.reach import target_errors
from sinuous.model.limits import Violation
from sinuous.model.robot import Robot
from sinuous.problem.problem import ask_body
from sinuous.problem.target import Target
from sinuous.scene.snapshot import Snapshot, least_gap
from sinuous.statics.rest import bodies_at
from sinuous.view.display.results import STARTS, format_number, lengths_along, radii_along, rows_of, status_in_words
from sinuous.view.page.model import PageModel

PLACES = 16
"""Places of a segment whose distance to the obstacles is measured."""

GOOD, BAD = "#00694c", "#a34700"
"""Colours of badges."""

MOST_NAMED = 4
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
.mantine-Button-root { height: auto; min-height: 2em; }
.mantine-Button-label { white-space: normal; }
.sinuous .notice { color: #c92a2a; margin-top: 2px; }
</style>"""

Rows = dict[str, Sequence[str]]
"""Labels, and the cells beside each: one a method."""


@dataclass(frozen=True)
class NearestPlace:
    """Where a body is nearest to the obstacles.

    Attributes
    ----------
    obstacle : str
        Its name.
    distance : float
        From the surface of the body; negative in an overlap.
    body, surface : ndarray (3,)
        The nearest places on both surfaces.
    """

    obstacle: str
    distance: float
    body: Floats
    surface: Floats


@dataclass(frozen=True)
class Judgement:
    """What holds of a shape that was bent by hand.

    Attributes
    ----------
    position_error, angle_error : float or None
        Largest over the targets; None where none is asked for.
    violations : tuple
        Limits that it is beyond: which, segment (1 = first) or joint, by how much.
    """

    position_error: float | None
    angle_error: float | None
    violations: tuple[Violation, ...]


def judge_shape(robot: Robot, targets: tuple[Target, ...], q: Floats) -> Judgement:
    """Compare a configuration (n, 3) with targets and limits; where it hangs, the body that the targets are for."""
    violations = tuple(robot.violations(q))
    try:
        asked = ask_body(robot, q, targets)
    except InputError:  # no equilibrium
        return Judgement(None, None, violations)
    ends = segment_ends(asked.body, asked.arcs)
    errors = [(target, *target_errors(asked.body, target, ends)) for target in asked.targets]
    placed = [position for target, position, _ in errors if target.position is not None]
    turned = [a for target, _, a in errors if target.direction is not None or target.rotation is not None]
    return Judgement(max(placed, default=None), max(turned, default=None), violations)


def find_nearest(robot: Robot, scene: Snapshot, q: Floats) -> NearestPlace | None:
    """Where the body beyond its mount is nearest to the obstacles; None without any."""
    if not len(scene):
        return None
    body, arcs = bodies_at(robot, q[None])
    return _nearest(body, scene, arcs[0])


def _nearest(robot: Robot, scene: Snapshot, q: Floats) -> NearestPlace | None:
    along = lengths_along(q, PLACES)
    free = along >= min(robot.mount, along[-1])
    points, radii = robot.backbone(q, PLACES)[free], radii_along(robot, PLACES)[free]
    found = least_gap(points, radii, scene)
    if found.place is None or found.obstacle is None:
        return None
    point, radius = points[found.place], float(radii[found.place])
    away = scene.gradient(point)
    size = float(np.linalg.norm(away))
    away = away / size if size > 0.0 else away
    return NearestPlace(found.obstacle, found.distance, point - radius * away, point - (found.distance + radius) * away)


def status_html(model: PageModel, near: NearestPlace | None, judged: Judgement | None, busy: bool) -> tuple[str, str]:
    """What holds of the shape on the page, in a table with one column a method, and the details below it.

    `busy`: a solve goes on.
    """
    there = {**_of_time(model), **_of_near(near)}
    if model.motion is not None:
        summary = str(model.motion).split("\n", maxsplit=1)[0].partition(": ")[2]
        proved = model.step_is_proved
        badge = _badge("proved clear here" if proved else "not proved clear here", proved)
        if model.step in model.motion.left_steps:
            badge += " " + _badge("off the line here", model.motion.reconfigure == "allow")
        return _table([badge], {"motion": [summary], **there}), ""
    if model.by_hand and judged is not None:
        return _table([_badge("bent by hand", not judged.violations)], {**_of_judgement(judged), **there}), ""
    if not model.targets:
        return _table([_badge("the start" if model.job.start is not None else "no start", True)], there), ""
    if model.answer is None:
        return _table([_badge("not solved yet", False)], there), ""
    answers = [model.answer] if model.beside is None else [model.answer, model.beside]
    badges = [_badge(status_in_words(each.status), each.solved) for each in answers]
    if busy:
        badges[0] = _badge("still looking ...", False)
    if model.beside is not None:
        badges = [f"{badge}<br>{markup.escape(each.method)}" for badge, each in zip(badges, answers, strict=True)]
    main = _side_by_side([_most_of(each, near) for each in answers])
    rest = _side_by_side([rows_of(each) | _of_search(each) for each in answers]) | _of_near(near)
    rest = {"status": rest.pop("because"), **rest} if "because" in rest else rest
    details = {label: cells for label, cells in rest.items() if cells not in main.values()}
    return _table(badges, main | _of_time(model)), _table([], details)


def _most_of(answer: Solution, near: NearestPlace | None) -> dict[str, str]:
    """What holds of an answer, each fact in one figure; of one that is not solved, the one that says why."""
    if not answer.solved:
        far = format_number(missed_distance(answer), " from the target at best", "the tip stays ")
        return {"because": far or str(answer.reason or answer.worst or answer.sentence)}
    chosen = {label: value for label, value in rows_of(answer).items() if label in ("position error", "angle error")}
    clear = format_number(answer.clearance, ", proved", "at least ")
    return chosen | ({"clearance": f"{clear} ({near.obstacle})" if near else clear} if clear else {})


def _side_by_side(own: list[dict[str, str]]) -> Rows:
    labels = dict.fromkeys(label for rows in own for label in rows)
    return {label: [rows.get(label, "") for rows in own] for label in labels}


def missed_distance(answer: Solution) -> float | None:
    """How far the best shape is from a target that is out of reach; None for other answers."""
    missed = answer.worst is not None and answer.worst.constraint == "position"
    return answer.position_error if answer.status == "out_of_reach" and missed else None


def _of_search(solution: Solution) -> dict[str, str]:
    binding = in_words(solution.binding, len(solution.problem.robot.segments), values=True)[:MOST_NAMED]
    rows = {
        "proof": "" if solution.reason is None else str(solution.reason),
        "held by": "; ".join(binding),
        "found from": STARTS[solution.start],
    }
    return {label: value for label, value in rows.items() if value}


def _of_judgement(judged: Judgement) -> Rows:
    beyond = [f"{kind} of {labelled([k])} by {amount:.3g}" for kind, k, amount in judged.violations]
    rows = {
        "position error": format_number(judged.position_error),
        "angle error": format_number(judged.angle_error, " rad"),
        "violated": "; ".join(beyond[:MOST_NAMED]),
    }
    return {label: [value] for label, value in rows.items() if value}


def _of_time(model: PageModel) -> Rows:
    """The time on the page, where something moves."""
    first, last = model.window
    return {"at time": [f"{model.time:.2f}, from {first:g} to {last:g}"]} if first < last else {}


def _of_near(near: NearestPlace | None) -> Rows:
    if near is None:
        return {}
    where = f"{near.distance:.3g} away" if near.distance >= 0.0 else f"overlap of {-near.distance:.3g}"
    return {"nearest": [f"{near.obstacle}, {where}"]}


def notice_html(text: str) -> str:
    """One line about what was refused; nothing where nothing was."""
    return f'<div class="notice">{markup.escape(" ".join(text.split()))}</div>' if text else ""


def scale_html(low: str, high: str, colours: Sequence[str]) -> str:
    """A legend: what the colours of the body mean."""
    bar = f'<div class="scale" style="background:linear-gradient(90deg,{",".join(colours)})"></div>'
    return f'{bar}<div class="ends"><span>{markup.escape(low)}</span><span>{markup.escape(high)}</span></div>'


def block_html(*parts: str) -> str:
    """Parts as one block of the panel."""
    return f'<div class="sinuous">{"".join(parts)}</div>'


def table_html(rows: dict[str, str]) -> str:
    """A table of labels and what stands beside each."""
    return _table([], {label: [value] for label, value in rows.items()})


def _badge(word: str, good: bool) -> str:
    return f'<span class="badge" style="background:{GOOD if good else BAD}">{markup.escape(word)}</span>'


def _table(badges: Sequence[str], rows: Rows) -> str:
    head = "".join(f"<td>{badge}</td>" for badge in badges)
    top = f"<tr><td></td>{head}</tr>" if badges else ""
    lines = "".join(
        f"<tr><td>{markup.escape(label)}</td>{''.join(f'<td>{markup.escape(cell)}</td>' for cell in cells)}</tr>"
        for label, cells in rows.items()
    )
    return f"<table>{top}{lines}</table>"
