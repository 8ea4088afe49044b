"""The commands check and new: what problem files contain, and a commented one to start from."""

import shlex
from dataclasses import asdict
from importlib.resources import files
from typing import Any

import numpy as np
import typer

from sinuous.answer.verification import Verification, verified, verify
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, counted, number, one_of_body, span
from sinuous.cli.app import KINDS, Check, New
from sinuous.cli.options import BAD_INPUT, SOLVED, UNSOLVED, check_writable
from sinuous.cli.reading import read_all
from sinuous.files.documents import json_line
from sinuous.model.joints import Fixed
from sinuous.model.robot import Robot
from sinuous.motion.job import Job

MOST = 12
"""Most obstacles of which sizes are printed."""


def check_files(asked: Check) -> int:
    """Say of each file what it contains, or what is wrong with it.

    Returns
    -------
    int
        2 when a file is wrong, else 1 when a start does not meet its target, else 0.
    """
    code = SOLVED
    for file in asked.files:
        try:
            (read,) = read_all([file])
        except InputError as error:  # the others may be good; what one needs may merely be missing here
            typer.echo(" ".join(str(error).split()), err=True)
            code = BAD_INPUT
            continue
        problem = read.problem
        start = _verified(problem)
        if start is not None and not start.ok:
            code = max(code, UNSOLVED)
        typer.echo(json_line(_contents(problem, start)) if asked.json else _description(problem, start))
    return code


def _verified(problem: Job) -> Verification | None:
    """What the start is: held against the first target, or, where a configuration is the goal, merely looked at."""
    if problem.start is None:
        return None
    return _alone(problem, problem.start) if problem.goal is not None else verify(problem.problem(), problem.start)


def _alone(problem: Job, q: Floats) -> Verification:
    """What a configuration (n, 3) is by itself, without a target."""
    return verified(problem.robot, q, problem.scene.snapshot().first, (), problem.tolerance)


def _contents(problem: Job, start: Verification | None) -> dict[str, Any]:
    robot = problem.robot
    lengths, radii = [segment.length for segment in robot.segments], robot.body_radii
    return {
        "file": problem.file,
        **({"joints": _joints(robot)} if robot.joints else {}),
        "segments": len(lengths),
        "length": [sum(low for low, _ in lengths), sum(high for _, high in lengths)],
        "radius": [min(radii, default=0.0), max(radii, default=0.0)],
        "obstacles": len(problem.scene),
        "waypoints": len(problem.waypoints),
        "sizes": [{"name": name, "size": size, "from_base": away} for name, size, away in _sizes(problem)],
        "targets_from_base": _from_base(problem),
        "notes": problem.notes,
        "start": None if start is None else asdict(start),
        "actuators": _actuators(problem),
    }


def _description(problem: Job, start: Verification | None) -> str:
    contents = _contents(problem, start)
    counts = [counted(contents[f"{noun}s"], noun) for noun in ("segment", "obstacle", "waypoint")]
    line = f"{problem.file}: {counts[0]}, length {span(contents['length'])}; {counts[1]}; {counts[2]}"
    radii = contents["radius"]
    joints = [f"joint {each['name']}: {each['kind']}, {span(each['limits'])}" for each in contents.get("joints", ())]
    sizes = [*joints, f"robot: radius {span(radii)}", *map(_size_in_words, contents["sizes"][:MOST])]
    if len(contents["sizes"]) > MOST:
        sizes.append(f"and {len(contents['sizes']) - MOST} more obstacles")
    if contents["targets_from_base"] is not None:
        sizes.append(f"targets: {span(contents['targets_from_base'])} from the base")
    notes = [f"note: {note}" for note in problem.notes]
    verdict = [] if start is None else [f"start {_verdict(problem, start)}"]
    values = problem.robot.drive.in_words(contents["actuators"] or {})
    return "\n  ".join([line, *sizes, *notes, *verdict, *([f"actuators there: {values}"] if values else [])])


def _joints(robot: Robot) -> list[dict[str, Any]]:
    """Name, kind and limits of the joints that move."""
    moving = (joint for joint in robot.joints if not isinstance(joint, Fixed))
    pairs = zip(robot.joint_names, moving, strict=True)
    return [{"name": name, "kind": joint.kind, "limits": list(joint.limits)} for name, joint in pairs]


def _actuators(problem: Job) -> dict[str, float] | None:
    """Values of all actuators at the start."""
    names = [actuator.name for actuator in problem.robot.actuators]
    if problem.start is None or not names:
        return None
    return dict(zip(names, problem.robot.to_actuators(problem.start).tolist(), strict=True))


def _sizes(problem: Job) -> list[tuple[str, list[float] | None, float]]:
    """Of every obstacle its name, its extents along the axes of the world, and how far it is from the base."""
    base = problem.robot.base[:3, 3]
    boxes = [obstacle._box for obstacle in problem.scene.obstacles]
    scene = problem.scene.snapshot().first
    away = [float(scene.distance_to(i, base)[0]) for i in range(len(boxes))]
    return [
        (problem.scene.name(i), None if box is None else (box[1] - box[0]).tolist(), away[i])
        for i, box in enumerate(boxes)
    ]


def _size_in_words(entry: dict[str, Any]) -> str:
    size = "without end" if entry["size"] is None else " x ".join(number(extent) for extent in entry["size"])
    return f"{entry['name']}: {size}, {number(entry['from_base'])} from the base"


def _from_base(problem: Job) -> list[float] | None:
    """Least and greatest distance of a target from the base."""
    places = [target.position for targets in problem.waypoints for target in targets if target.position is not None]
    away = [float(np.linalg.norm(place - problem.robot.base[:3, 3])) for place in places]
    return [min(away), max(away)] if away else None


def _verdict(problem: Job, start: Verification) -> str:
    """What was found of the start, which is to meet a target, or only to be clear.

    For a motion it is enough to be clear, and a file does not say whether one is wanted.
    """
    seen = (
        f"outside its limits by {start.excess:.3g}, clearance {start.clearance:.3g}, self-clearance "
        f"{start.self_clearance:.3g}{_where(start)} (sampled)"
    )
    if problem.goal is not None:
        return f"{'is clear' if start.ok else 'is blocked'}: {seen}"
    verdict = "meets its target" if start.ok else "is no answer"
    if not start.ok and problem.start is not None and _alone(problem, problem.start).ok:
        verdict = "is clear, a motion can begin there, but it is no answer"
    return f"{verdict}: position error {start.position_error:.3g}, angle error {start.angle_error:.3g}, {seen}"


def _where(start: Verification) -> str:
    """Where a body runs through itself."""
    if start.self_segments is None or start.self_clearance >= 0.0:
        return ""
    one, other = start.self_segments
    if isinstance(one, str) or isinstance(other, str):
        return f" between {one_of_body(one)} and {one_of_body(other)}"
    return f" between segments {one} and {other}"


def write_new(asked: New) -> int:
    """Write the problem file of a kind, and say what to do with it.

    Raises
    ------
    InputError
        When there is no such kind, or the file cannot be written, or is there already and `force` is not said.
    """
    kind, file = checks.choice("KIND", asked.kind, tuple(KINDS)), asked.file
    if file.suffix.lower() == ".json":
        raise InputError("FILE", "has comments, which JSON has not", str(file), "a name that ends in .yaml")
    if file.exists() and not (asked.force and file.is_file()):
        raise InputError("FILE", "is there already", str(file), "a new file, or --force")
    check_writable("FILE", file)
    text = (files("sinuous.cli") / "templates" / f"{kind}.yaml").read_text(encoding="utf-8")
    typed = shlex.quote(" ".join(str(file).split()))
    file.write_text(text.replace("FILE", typed), encoding="utf-8", newline="\n")
    command = "track" if "\npath:" in text else "solve"
    typer.echo(f"{file}: {KINDS[kind]}; next: sinuous {command} {typed}")
    return SOLVED
