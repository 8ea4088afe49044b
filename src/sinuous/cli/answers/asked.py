"""All that motions depend on, so that a command goes on with nothing else than it began with."""

import json
from collections.abc import Mapping

from sinuous.batch.checkpoint import hash_of, problem_record
from sinuous.checks import Floats
from sinuous.cli.options import Options
from sinuous.files.problem_file import ProblemFile
from sinuous.problem.target import target_table
from sinuous.solving.options import SolveOptions
from sinuous.writing.plain import described


def asked_of(problems: list[ProblemFile], options: Options, typed: Mapping[str, str]) -> dict[str, str]:
    """Return all that the motions of some problems depend on; `typed` are options of one command alone."""
    told = {"files": ", ".join(problem.file for problem in problems), **typed}
    for problem in problems:
        own = SolveOptions(**options.solve_options(problem.tolerance, problem.prefer))
        scene = problem.scene.snapshot()
        parts = {
            **problem_record(problem.robot, scene.at(0.0), own),
            "moving": hash_of(
                *(part.tobytes() for one in scene.courses.values() for part in (one.times, *one.poses(one.times)))
            ),
            "path": hash_of(*(target_table(problem.robot, targets).tobytes() for targets in problem.waypoints)),
            "times": _hash(problem.times),
            "start": _hash(problem.start),
            "goal": _hash(problem.goal),
            "rates": json.dumps(described(problem.rates)),
        }
        told |= {f"{problem.file}: {key}": value for key, value in parts.items()}
    return told


def _hash(values: Floats | None) -> str:
    return "none" if values is None else hash_of(values.tobytes())
