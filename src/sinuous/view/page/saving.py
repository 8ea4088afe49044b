"""The problem on the page as the text of a file, and files that are brought to the page."""

from pathlib import Path, PurePath
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from sinuous.base.documents import yaml_text
from sinuous.base.errors import InputError
from sinuous.files.documents import join, parse
from sinuous.files.problem_file import problem_of
from sinuous.motion.job import Job
from sinuous.motion.tables import write_motion
from sinuous.view.page.edits import change_job
from sinuous.view.page.model import PageModel

LARGEST = 50_000_000
"""Bytes of a problem file that are read."""

NAMED = ("robot", "scene", "path", "start", "file")
"""Keys under which the name of another file may stand."""


def problem_text(model: PageModel) -> str:
    """Return a problem file in YAML that says what is on the page; where nothing moves, it starts with its shape.

    Its first line is the command that asks the same.

    Raises
    ------
    InputError
        When an obstacle is a function, which no file can hold.
    """
    job, own = model.job, model.settings
    moves = job.is_path or job.goal is not None or model.motion is not None or model.scene.moves
    kept = job if moves else change_job(job, start=model.q)
    command = "track" if job.is_path else "plan" if moves else "solve"
    begin = f" --begin {model.begin:g}" if command == "plan" and model.begin else ""
    line = f"# sinuous {command} FILE --method {own.method} --seed {own.seed} --time {own.time:g}{begin}\n"
    return line + yaml_text(kept.to_dict(model.folder))


def motion_table(model: PageModel) -> str:
    """Return the motion on the page as CSV, or the shape as a single row; columns as of `Motion.to_csv`."""
    q, times = (
        (model.shown[None], np.array([model.time])) if model.motion is None else (model.motion.q, model.motion.times)
    )
    with TemporaryDirectory() as folder:
        file = Path(folder) / "motion.csv"
        write_motion(file, model.robot, times, q)
        return file.read_text(encoding="utf-8")


def read_problem(name: str, content: bytes, folder: Path) -> Job:
    """Read a problem file that was brought to the page.

    Names of other files in it begin at `folder`, where the problem of the page stands, and must lead to files within
    it: whoever can reach the page shall not read others.

    Raises
    ------
    InputError
        In one line, when it is no problem file.
    """
    title = PurePath(name.replace("\\", "/")).name or "file"
    try:
        if len(content) > LARGEST:
            raise InputError("file", "too large", f"{len(content)} bytes", f"at most {LARGEST} bytes")
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError("file", f"not UTF-8 at byte {error.start}", title, "a text file in UTF-8") from None
        values = parse(text, Path(title))
        _refuse_far_files(values, folder)
        job = problem_of(values, str(folder / title), Job)
        job.scene.prepare()
        return job
    except InputError as error:
        raise error.in_file(title) from None


def _refuse_far_files(values: Any, folder: Path, key: str = "") -> None:
    """Refuse names of files that lead out of a folder."""
    entries = values.items() if isinstance(values, dict) else enumerate(values) if isinstance(values, list) else ()
    for inner, entry in entries:
        if isinstance(entry, dict | list):
            _refuse_far_files(entry, folder, join(key, inner))
        elif (
            isinstance(entry, str)
            and inner in NAMED
            and not (folder / entry).resolve().is_relative_to(folder.resolve())
        ):
            wanted = "a file within that folder"
            raise InputError(join(key, inner), "leads out of the folder of the page", entry, wanted)
