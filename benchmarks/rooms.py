"""`python -m benchmarks.rooms`: files and lines of the source by room, also beside those of an earlier commit."""

import ast
import io
import subprocess
import sys
import tokenize
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from benchmarks.harness.command import command
from sinuous.errors import InputError

ROOT = Path(__file__).parents[1]
PACKAGE = "src/sinuous"

SPLIT = ("kernels", "solving", "motion")
"""Rooms of which each inner room is counted by itself."""

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


def sizes(sources: Iterable[tuple[str, str]]) -> dict[str, Size]:
    """Add up the sizes of rooms, from paths within the package and sources of modules; `all` is the sum."""
    found: dict[str, Size] = {}
    for path, source in sources:
        parts = path.split("/")
        room = "/".join(parts[:2]) if parts[0] in SPLIT and len(parts) > 2 else parts[0] if len(parts) > 1 else "."
        lines, code = len(source.splitlines()), code_lines(source)
        for name in (room, "all"):
            before = found.get(name, Size())
            found[name] = Size(before.files + 1, before.lines + lines, before.code + code)
    return dict(sorted(found.items(), key=lambda item: (item[0] == "all", item[0])))


def here() -> Iterator[tuple[str, str]]:
    """Yield path and source of every module as it is now."""
    package = ROOT / PACKAGE
    for file in sorted(package.rglob("*.py")):
        yield file.relative_to(package).as_posix(), file.read_text(encoding="utf-8")


def at(commit: str) -> Iterator[tuple[str, str]]:
    """Yield path and source of every module as it is in a commit.

    Raises
    ------
    InputError
        When there is no such commit.
    """

    def git(*arguments: str) -> str:
        done = subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise InputError("--against", "", commit, "a commit of this repository")
        return done.stdout

    for path in git("ls-tree", "-r", "--name-only", f"{commit}:{PACKAGE}").splitlines():
        if path.endswith(".py"):
            yield path, git("show", f"{commit}:{PACKAGE}/{path}")


def table(now: dict[str, Size], before: dict[str, Size]) -> Iterator[str]:
    """Yield the lines of a Markdown table: a room a line."""
    yield "| room | files | lines | of code |" + (" files before | lines before | of code before |" if before else "")
    yield "|---|" + "---:|" * (6 if before else 3)
    names = {*before, *now}
    for room in sorted(names, key=lambda name: (name == "all", name)):
        row = [*now.get(room, Size()), *(before.get(room, Size()) if before else ())]
        yield f"| {room} | " + " | ".join(f"{number:,}" for number in row) + " |"


def run(
    against: Annotated[str | None, typer.Option(metavar="COMMIT", help="Show this commit beside it.")] = None,
) -> None:
    """Count files, lines and lines of code (without comments, docstrings and blanks) of the source, by room."""
    before = {} if against is None else sizes(at(against))
    typer.echo("\n".join(table(sizes(here()), before)))


main = command(run, "benchmarks.rooms")


if __name__ == "__main__":
    sys.exit(main())
