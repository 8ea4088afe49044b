"""`python -m benchmarks clutter`: intricate places, each of which is known to be possible."""

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

from benchmarks.conduct import conduct, require
from benchmarks.plan import Plan
from sinuous.errors import InputError

NEEDED = {"casadi": "casadi", "fcl": "python-fcl", "igl": "libigl"}
"""Modules that a plain installation does not bring, and the packages that do."""


def run(
    seed: int = 0,
    quick: bool = False,
    json: bool = False,
    out: Path | None = None,
    families: Sequence[str] = (),
) -> int:
    """Measure, print, and say whether all is right.

    Parameters
    ----------
    seed : int
        Of all places: `benchmarks.places.make(family, 1000 * seed + i)` makes number i again.
    quick : bool
        Whether to cut all counts down, to see in seconds that everything runs.
    json : bool
        Print JSON, one line, instead of tables.
    out : Path, optional
        File to write the JSON to, also when interrupted.
    families : sequence of str
        Names of those to measure; none means all.

    Returns
    -------
    int
        Exit code; see `conduct`.

    Raises
    ------
    InputError
        When packages are not installed, or there is no such family.
    """
    require(NEEDED)
    from benchmarks import far, figures  # noqa: PLC0415
    from benchmarks.places import FAMILIES  # noqa: PLC0415

    for name in families:
        if name not in FAMILIES:
            raise InputError("--family", "is not known", name, "one of " + ", ".join(FAMILIES))
    plan = Plan(seed, quick)
    lines = figures.measure(plan, families or tuple(FAMILIES))
    if not families:
        lines = chain(lines, far.measure(plan))
    return conduct(lines, plan, json, out)
