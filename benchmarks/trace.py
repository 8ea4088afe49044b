"""`python -m benchmarks trace`: how many files of the package run in an easy solve, a hard one, and an explained one.

A file counts where one of its functions is entered otherwise than by an import. Of kernels what calls and compiles them
is counted apart: compiled code does not show.
"""

import contextlib
import inspect
import io
import json
import subprocess
import sys
import threading
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType
from typing import Annotated, Any

import typer

BLOCKED = """
robot: {segments: {count: 5, length: [45, 70], max_bend: 2.4}, radius: 4, base: {direction: [0, 0, -1]}}
scene: [{box: {center: [90, 0, -150], size: [40, 200, 30], name: table}}]
target: {position: [90, 40, -160]}
"""
"""A problem without a solution, to be explained."""

EXAMPLES = Path(__file__).parents[1] / "examples"


def scenarios(folder: Path) -> dict[str, list[str]]:
    """Return what is typed after `sinuous`, by what it shows; what is not an example is written into a folder."""
    blocked = folder / "blocked.yaml"
    blocked.write_text(BLOCKED, encoding="utf-8")
    return {
        "an easy solve": ["solve", str(EXAMPLES / "pose.yaml")],
        "a hard solve": ["solve", str(EXAMPLES / "duct.yaml")],
        "why a target is not reached": ["solve", str(blocked), "--why"],
    }


def files_of(typed: list[str]) -> list[str]:
    """Return the files of the package whose functions `sinuous` enters, run in a process of its own."""
    child = [sys.executable, "-c", "from benchmarks.trace import print_files; print_files()", *typed]
    done = subprocess.run(child, capture_output=True, text=True, check=True, cwd=Path(__file__).parents[1])
    files: list[str] = json.loads(done.stdout)
    return files


def print_files() -> None:
    """Run `sinuous` with the arguments of this process, and print the files whose functions were entered, as JSON."""
    from sinuous.cli.app import main  # noqa: PLC0415

    package, entered = str(Path(str(sys.modules["sinuous"].__file__)).parent), set[str]()

    def note(frame: FrameType, event: str, _: Any) -> None:
        code = frame.f_code
        is_function = code.co_flags & inspect.CO_OPTIMIZED  # neither a module nor the body of a class
        if event == "call" and is_function and code.co_filename.startswith(package) and code.co_filename not in entered:
            caller = frame.f_back
            while caller is not None and caller.f_code.co_name != "<module>":
                caller = caller.f_back
            if caller is None or not caller.f_code.co_filename.startswith(package):
                entered.add(code.co_filename)

    threading.setprofile(note)
    sys.setprofile(note)
    with contextlib.redirect_stdout(io.StringIO()):
        main(sys.argv[1:])
    sys.setprofile(None)
    sys.stdout.write(json.dumps([name[len(package) + 1 :] for name in sorted(entered)]))


def run(show: Annotated[bool, typer.Option("--list", help="Name the files, too.")] = False) -> None:
    """Count the files of the package that run in an easy solve, a hard one, and one that is explained."""
    with TemporaryDirectory() as folder:
        for what, typed in scenarios(Path(folder)).items():
            files = files_of(typed)
            kernels = sum(name.startswith("kernels/") for name in files)
            typer.echo(f"{what}: {len(files) - kernels} files, and {kernels} of kernels")
            typer.echo("".join(f"  {name}\n" for name in files if show), nl=False)
