"""Look at single problems again, by the names that reports give them."""

from collections.abc import Sequence

from benchmarks.wild import worlds
from benchmarks.wild.trials import refuted, solutions_of
from sinuous.base import checks
from sinuous.base.errors import InputError


def replay(seed: int, names: Sequence[str]) -> list[str]:
    """Solve problems again, and describe what came of each.

    Parameters
    ----------
    seed : int
    names : sequence of str
        Each WORLD.PROBLEM, or WORLD for all problems of a world.

    Raises
    ------
    InputError
        When a name is none.
    """
    return [line for name in names for line in _one(seed, name)]


def _one(seed: int, name: str) -> list[str]:
    number, _, which = name.partition(".")
    if not number.isdecimal() or not (which.isdecimal() or which == ""):
        raise InputError("--only", "", name, "WORLD.PROBLEM, or WORLD for all its problems")
    world = worlds.make(seed, checks.integer("--only", int(number), 0, 2**31 - 1))
    if which and int(which) >= len(world.targets):
        raise InputError("--only", "", name, f"{number}.0 to {number}.{len(world.targets) - 1}")
    chosen = [int(which)] if which else range(len(world.targets))
    solutions, seconds = solutions_of(world)
    lines = [f"world {number}: {world.robot!r}, {len(world.scene)} obstacles, {world.tolerance!r}"]
    for i in chosen:
        solution = solutions[i]
        if isinstance(solution, Exception):
            raise solution
        false = refuted(world, {i: solution})[i]
        lines += [
            f"  {number}.{i}: {', '.join(map(repr, world.targets[i]))}",
            f"    {solution.status} in {1e3 * seconds[i]:.3g} ms, {solution.starts} starts, {solution.iterations} "
            f"iterations, {solution.start}" + (f"; FALSE: {', '.join(false)}" if false else ""),
        ]
        if not solution.solved:
            lines.append(f"    {solution.reason or solution.worst}")
    return lines
