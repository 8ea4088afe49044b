"""The command bench: find a measurement by its name and run it."""

from importlib import import_module
from pathlib import Path

from sinuous.cli.options import check_writable
from sinuous.errors import InputError

BENCHES = ("speed",)


def measure(name: str, *, json: bool, out: Path | None, seed: int, quick: bool) -> int:
    """Run the measurement called `name`; return the exit code."""
    if name not in BENCHES:
        raise InputError("NAME", "no such measurement", name, "one of " + ", ".join(BENCHES))
    if out is not None:
        check_writable("--out", out)
    return int(import_module(f"sinuous.bench.{name}").run(json=json, out=out, seed=seed, quick=quick) or 0)
