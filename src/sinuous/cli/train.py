"""The command train: networks that give the robot of a file shapes for targets."""

from pathlib import Path
from time import perf_counter

import typer

from sinuous.cli.options import SOLVED, as_typed, check_writable
from sinuous.cli.reading import setting_of
from sinuous.methods.learned.training import train


def train_file(file: str, out: Path, samples: int, width: int, rounds: int, seed: int) -> int:
    """Train networks for the robot of a file among its obstacles, and write them; return the exit code."""
    check_writable("OUT", out, [file])
    with setting_of(file) as setting, as_typed("samples", "width", "rounds", "seed"):
        began = perf_counter()
        own = {"samples": samples, "width": width, "rounds": rounds, "seed": seed}
        found = train(setting.robot, setting.scene, **own, progress=True)
    found.save(out)
    typer.echo(f"{out}: {found}, {perf_counter() - began:.1f} s; next: --method learned --option network={out}")
    return SOLVED
