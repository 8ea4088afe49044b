"""The command design: a robot for a set of tasks."""

import warnings
from pathlib import Path
from typing import Any

from sinuous.cli.options import SOLVED, UNSOLVED, Solving, as_typed, check_outputs
from sinuous.cli.reading import interruptible, say, say_notes
from sinuous.designing.find import design
from sinuous.designing.reading import read_design
from sinuous.errors import InputError, SuspiciousInput
from sinuous.files.documents import parse


def design_file(
    file: str,
    solving: Solving,
    minimise: str | None,
    vary: list[str],
    run: dict[str, Any],
    out: Path | None,
    csv: Path | None,
    plot: Path | None,
    *,
    json: bool,
) -> int:
    """Find a robot for the tasks of a file; return the exit code.

    `minimise` are names with commas between them, instead of those of the file; `vary` are fields beside its own, see
    `read_field`; `run` are arguments of `design` about the run, None where they have their defaults.
    """
    check_outputs([file], out=out, csv=csv, plot=plot)
    if plot is not None:
        from sinuous.pictures.files import check_picture  # noqa: PLC0415

        check_picture("--plot", plot)
    asked = read_design(file)
    setting = asked.setting
    say_notes({file: setting.notes})
    wanted = asked.minimise if minimise is None else minimise.split(",")
    kept = None if out is None else out.with_name(out.name + ".csv")
    keeps = (
        "nothing is written" if kept is None and csv is None else "what was judged is kept, the same command goes on"
    )
    with interruptible(keeps), warnings.catch_warnings(), as_typed(*run, *solving.demands):
        warnings.simplefilter("ignore", SuspiciousInput)
        found = design(
            setting.robot,
            asked.tasks,
            setting.scene,
            vary={**asked.vary, **dict(map(read_field, vary))},
            minimise=wanted or (),
            out=kept if csv is None else csv,
            progress=True,
            **{key: value for key, value in run.items() if value is not None},
            **solving.arguments(setting.tolerance, setting.prefer),
        )
    if csv is None and kept is not None:
        kept.unlink(missing_ok=True)
    if out is not None and found.solved:
        found.robot.save(out)
    if plot is not None and found.solved:
        from sinuous.pictures.charts import plot_design  # noqa: PLC0415

        plot_design(found, plot)
    say(file, found, json=json)
    return SOLVED if found.solved else UNSOLVED


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
