"""The command design: a robot for a set of tasks."""

import warnings
from pathlib import Path
from typing import Any

from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.cli.app import Design
from sinuous.cli.options import SOLVED, UNSOLVED, as_typed, check_outputs
from sinuous.cli.reading import interruptible, say, say_notes
from sinuous.files.documents import parse
from sinuous.studies.designing.find import design, read_design
from sinuous.studies.runs.engine import Checkpoint


def design_file(asked: Design) -> int:
    """Find a robot for the tasks of a file; return the exit code."""
    check_outputs([asked.file], out=asked.out, csv=asked.csv, plot=asked.plot)
    if asked.plot is not None:
        from sinuous.view.pictures.figures import check_picture  # noqa: PLC0415

        check_picture("--plot", asked.plot, others=())
    task, solving = read_design(asked.file), asked.solving
    setting = task.setting
    say_notes({asked.file: setting.notes})
    wanted = task.minimise if asked.minimise is None else asked.minimise.split(",")
    own = None if asked.out is None else asked.out.with_name(asked.out.name + ".csv")
    kept = asked.csv or own
    run: dict[str, Any] = {"robots": asked.robots, "budget": asked.budget, "workers": asked.workers}
    with interruptible(lambda: _kept(kept)), warnings.catch_warnings(), as_typed(*run, *solving.demands):
        warnings.simplefilter("ignore", SuspiciousInput)
        found = design(
            setting.robot,
            task.tasks,
            setting.scene,
            vary={**task.vary, **dict(map(read_field, asked.vary or []))},
            minimise=wanted or (),
            out=kept,
            progress=True,
            **{key: value for key, value in run.items() if value is not None},
            **solving.arguments(setting.tolerance, setting.prefer),
        )
    if asked.csv is None and own is not None:
        own.unlink(missing_ok=True)
    if asked.out is not None and found.solved:
        found.robot.save(asked.out)
    if asked.plot is not None and found.solved:
        from sinuous.view.pictures.diagrams import plot_design  # noqa: PLC0415

        plot_design(found, asked.plot)
    say(asked.file, found, json=asked.json)
    return SOLVED if found.solved else UNSOLVED


def _kept(out: Path | None) -> str:
    """What is kept of a search that is interrupted."""
    if out is None:
        return "nothing is written"
    done = Checkpoint(out, {}, "this design")
    count = sum(int(done.read(number, "tried")["tried"].sum()) for number in done.done())
    return f"what was judged is kept ({count:,} robots), the same command goes on"


def read_field(text: str) -> tuple[str, Any]:
    """Read `FIELD=LOW:HIGH` or `FIELD=VALUE,VALUE`.

    Raises
    ------
    InputError
        That names the option.
    """
    field, equals, said = text.partition("=")
    if not equals or not field or not said:
        raise InputError("--vary", "", text, "FIELD=LOW:HIGH or FIELD=VALUE,VALUE")
    low, colon, high = said.partition(":")
    try:
        if colon:
            return field, (float(low), float(high))
        return field, [parse(part, Path("--vary")) for part in said.split(",")]
    except ValueError:
        raise InputError("--vary", "", text, "FIELD=LOW:HIGH or FIELD=VALUE,VALUE") from None
