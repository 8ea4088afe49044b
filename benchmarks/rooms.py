"""`python -m benchmarks.rooms`: files and lines of the source by room, of benchmarks and of tests; before, too."""

import ast
import io
import subprocess
import sys
import tarfile
import tokenize
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from benchmarks.harness.command import command
from sinuous.base.errors import InputError

ROOT = Path(__file__).parents[1]
PACKAGE = "src/sinuous"

SPLIT = ("kernels", "solver", "motion", "studies", "view")
"""Rooms of which each inner room is counted by itself."""

BESIDE = ("benchmarks", "tests")
"""Folders beside the package, which are counted, too."""

NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


class Size(NamedTuple):
    """Size of a room: files, lines, and lines of code, which are those without comments, docstrings and blanks."""

    files: int = 0
    lines: int = 0
    code: int = 0


def code_lines(source: str) -> int:
    """Count the lines of code of a module."""
    texts: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            texts.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    code = {line for token in tokens if token.type not in NO_CODE for line in range(token.start[0], token.end[0] + 1)}
    return len(code - texts)


def room_of(path: str) -> str:
    """Name the room of a module, by its path in the repository; benchmarks and tests are one room each."""
    own = path.removeprefix(PACKAGE + "/")
    parts = own.split("/")
    if own == path:
        return parts[0]
    return "/".join(parts[:2]) if parts[0] in SPLIT and len(parts) > 2 else parts[0] if len(parts) > 1 else "."


def sizes(sources: Iterable[tuple[str, str]]) -> dict[str, Size]:
    """Add up the sizes of rooms, from paths in the repository and sources of modules; `all` is the sum of the package.

    What stands beside the package comes last.
    """
    found: dict[str, Size] = {}
    for path, source in sources:
        room, lines, code = room_of(path), len(source.splitlines()), code_lines(source)
        for name in (room, "all") if room not in BESIDE else (room,):
            before = found.get(name, Size())
            found[name] = Size(before.files + 1, before.lines + lines, before.code + code)
    return {name: found[name] for name in sorted(found, key=_order)}


def _order(room: str) -> tuple[int, str]:
    return 2 if room in BESIDE else int(room == "all"), room


def here() -> Iterator[tuple[str, str]]:
    """Yield path and source of every module as it is now."""
    for folder in (PACKAGE, *BESIDE):
        for file in sorted((ROOT / folder).rglob("*.py")):
            yield file.relative_to(ROOT).as_posix(), file.read_text(encoding="utf-8")


def at(commit: str) -> Iterator[tuple[str, str]]:
    """Yield path and source of every module as it is in a commit.

    Raises
    ------
    InputError
        When there is no such commit.
    """
    command = ["git", "-C", str(ROOT), "archive", commit, PACKAGE, *BESIDE]
    done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode != 0:
        raise InputError("--against", "", commit, "a commit of this repository")
    with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
        for member in archive:
            file = archive.extractfile(member) if member.name.endswith(".py") else None
            if file is not None:
                yield member.name, file.read().decode()


def table(now: dict[str, Size], before: dict[str, Size]) -> Iterator[str]:
    """Yield the lines of a Markdown table: a room a line."""
    yield "| room | files | lines | of code |" + (" files before | lines before | of code before |" if before else "")
    yield "|---|" + "---:|" * (6 if before else 3)
    for room in sorted({*before, *now}, key=_order):
        row = [*now.get(room, Size()), *(before.get(room, Size()) if before else ())]
        yield f"| {room} | " + " | ".join(f"{number:,}" for number in row) + " |"


def run(
    against: Annotated[str | None, typer.Option(metavar="COMMIT", help="Show this commit beside it.")] = None,
) -> None:
    """Count files, lines and lines of code (no comments, docstrings, blanks) by room, then benchmarks and tests."""
    before = {} if against is None else sizes(at(against))
    typer.echo("\n".join(table(sizes(here()), before)))


main = command(run, "benchmarks.rooms")


if __name__ == "__main__":
    sys.exit(main())
