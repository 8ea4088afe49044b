"""The command bench: find a measurement by its name and run it."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from sinuous.cli.options import check_writable
from sinuous.errors import InputError

BENCHES = ("speed", "clutter")

WITH_FAMILIES = ("clutter",)
"""Measurements of which a part can be chosen."""


def measure(name: str, *, json: bool, out: Path | None, seed: int, quick: bool, families: Sequence[str] = ()) -> int:
    """Run the measurement called `name`, of `families` alone if there are any; return the exit code."""
    if name not in BENCHES:
        raise InputError("NAME", "no such measurement", name, "one of " + ", ".join(BENCHES))
    if out is not None:
        check_writable("--out", out)
    chosen = {"families": tuple(families)} if families else {}
    if chosen and name not in WITH_FAMILIES:
        raise InputError("--family", "has no meaning here", list(families), f"bench {' or '.join(WITH_FAMILIES)}")
    return int(import_module(f"sinuous.bench.{name}").run(json=json, out=out, seed=seed, quick=quick, **chosen) or 0)
