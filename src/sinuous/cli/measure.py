"""The command bench: find a measurement by its name and run it."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import typer

from sinuous import checks
from sinuous.cli.options import check_writable
from sinuous.errors import InputError

EXPERIMENTS = ("table1", "tracking", "segments", "methods")
"""Those that keep a journal in a folder: files in `benchmarks.experiments`."""

WITH_FAMILIES = ("clutter",)
"""Measurements of which a part can be chosen."""

INTERRUPTED = 130

BENCHES = ("speed", "clutter", *EXPERIMENTS)


def measure(
    name: str,
    *,
    json: bool,
    out: Path | None,
    seed: int,
    quick: bool,
    families: Sequence[str] = (),
    anew: bool = False,
    method: Sequence[str] = (),
) -> int:
    """Run the measurement called `name`, of `families` or methods alone if there are any; return the exit code."""
    if name not in BENCHES:
        raise InputError("NAME", "", name, "one of " + ", ".join(BENCHES))
    checks.integer("--seed", seed, 0, 2**31 - 1)
    if families and name not in WITH_FAMILIES:
        raise InputError("--family", "has no meaning here", list(families), f"bench {' or '.join(WITH_FAMILIES)}")
    if name in EXPERIMENTS:
        try:
            run = import_module(f"benchmarks.experiments.{name}").run
            return int(run(json=json, out=out, seed=seed, quick=quick, anew=anew, methods=tuple(method)))
        except KeyboardInterrupt:
            typer.echo("sinuous: interrupted before anything was measured", err=True)
            return INTERRUPTED
    if anew or method:
        option, value = ("--anew", anew) if anew else ("--method", list(method))
        raise InputError(option, f"is not for {name}", value, "one of " + ", ".join(EXPERIMENTS))
    if out is not None:
        check_writable("--out", out)
    chosen = {"families": tuple(families)} if families else {}
    return int(import_module(f"benchmarks.{name}").run(json=json, out=out, seed=seed, quick=quick, **chosen) or 0)
