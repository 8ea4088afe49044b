"""`python -m benchmarks rooms`: lines of code by room, and the shape of the package: rooms, circles of imports, names.

Lines of code are those without comments, docstrings and blanks. Imports count wherever they stand, also within
functions and under TYPE_CHECKING. With `--against COMMIT` the rooms of that commit stand beside those of now.
"""

import ast
import io
import re
import subprocess
import tarfile
import tokenize
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from scipy.sparse.csgraph import connected_components

from benchmarks.harness import table
from sinuous.base.errors import InputError

ROOT = Path(__file__).parents[1]
PACKAGE = "src/sinuous/"
FOLDERS = ("src", "benchmarks", "tests")

NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}

Sources = Mapping[str, str]
"""Text of modules by their paths in the repository."""


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
    """Name the room of a module, by its path: a folder of the package, `package` for modules beside these."""
    parts = path.removeprefix(PACKAGE).split("/")
    return parts[0] if len(parts) > 1 else "package"


def sizes(sources: Sources) -> Counter[str]:
    """Return lines of code by room; those of benchmarks and of tests are one room each."""
    found: Counter[str] = Counter()
    for path, source in sources.items():
        found[room_of(path)] += code_lines(source)
    return found


def imports(sources: Sources) -> dict[str, set[str]]:
    """Return which modules of rooms each module of a room imports."""
    names = {path.removeprefix("src/").removesuffix(".py").removesuffix("/__init__"): path for path in sources}
    modules = {name.replace("/", "."): path for name, path in names.items() if path.startswith(PACKAGE)}
    edges: dict[str, set[str]] = {module: set() for module in modules if module != "sinuous"}
    for module, own in edges.items():
        for node in ast.walk(ast.parse(sources[modules[module]])):
            if isinstance(node, ast.ImportFrom) and node.module is not None:
                named = {node.module, *(f"{node.module}.{each.name}" for each in node.names)}
                own.update((named & edges.keys()) - {module})
    return edges


def between_rooms(edges: Mapping[str, Iterable[str]]) -> dict[str, set[str]]:
    """Return which rooms, and modules beside rooms, each of them imports."""
    found: dict[str, set[str]] = {}
    for module, others in edges.items():
        own = ".".join(module.split(".")[:2])
        found.setdefault(own, set()).update({".".join(other.split(".")[:2]) for other in others} - {own})
    return found


def circles(edges: Mapping[str, Iterable[str]]) -> list[list[str]]:
    """Return the groups in which each imports itself by way of the others."""
    names = sorted(edges)
    at = {name: i for i, name in enumerate(names)}
    graph = np.zeros((len(names), len(names)), bool)
    for name, others in edges.items():
        graph[at[name], [at[other] for other in others]] = True
    _, labels = connected_components(graph, connection="strong")
    groups = [[name for name, label in zip(names, labels, strict=True) if label == each] for each in set(labels)]
    return [group for group in groups if len(group) > 1]


def here() -> dict[str, str]:
    """Return all modules as they are now."""
    files = sorted(file for folder in FOLDERS for file in (ROOT / folder).rglob("*.py"))
    return {file.relative_to(ROOT).as_posix(): file.read_text(encoding="utf-8") for file in files}


def at(commit: str) -> dict[str, str]:
    """Return all modules as they are in a commit.

    Raises
    ------
    InputError
        When there is no such commit.
    """
    done = subprocess.run(["git", "-C", ROOT, "archive", commit, *FOLDERS], capture_output=True, check=False)
    if done.returncode != 0:
        raise InputError("--against", "", commit, "a commit of this repository")
    with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
        members = [(member.name, archive.extractfile(member)) for member in archive if member.name.endswith(".py")]
        return {name: file.read().decode() for name, file in members if file is not None}


def report(now: Sources, before: Sources) -> Iterator[str]:
    """Yield the table of rooms, the circles, and one line of totals."""
    columns = [sizes(now)] + ([sizes(before)] if before else [])
    beside = ("benchmarks", "tests")
    rooms = sorted({room for column in columns for room in column} - {*beside})
    whole = [sum(column[room] for room in rooms) for column in columns]
    rows = [[room, *(f"{column[room]:,}" for column in columns)] for room in (*rooms, *beside)]
    rows.insert(len(rooms), ["all of the package", *(f"{count:,}" for count in whole)])
    yield table([["room", "lines of code", "before"][: 1 + len(columns)], *rows])
    edges = imports(now)
    loops = circles(edges) + circles(between_rooms(edges))
    yield from ("circle: " + ", ".join(loop) for loop in loops)
    stub = (ROOT / PACKAGE / "__init__.pyi").read_text(encoding="utf-8")
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "*.md"], capture_output=True, text=True, check=True).stdout
    pages = [ROOT / name for name in listed.split() if (ROOT / name).exists()]
    loose = [path for path in now if path.startswith(PACKAGE) and room_of(path) == "package"]
    totals = {
        "package": whole[0],
        "tests": columns[0]["tests"],
        "benchmarks": columns[0]["benchmarks"],
        "rooms": sum((ROOT / PACKAGE / room / "__init__.py").exists() for room in rooms),
        "modules beside them": len(loose) - sum(Path(path).stem in ("__init__", "__main__") for path in loose),
        "circles": len(loops),
        "public names": len(re.findall(r"^from \S+ import \S+ as \S+$", stub, re.MULTILINE)),
        "Markdown words": sum(len(page.read_text(encoding="utf-8").split()) for page in pages),
    }
    yield "; ".join(f"{what} {count:,}" for what, count in totals.items())


def run(
    against: Annotated[str | None, typer.Option(metavar="COMMIT", help="Show this commit beside it.")] = None,
) -> None:
    """Count lines of code by room, and say how many rooms, circles of imports, public names and words there are."""
    typer.echo("\n".join(report(here(), {} if against is None else at(against))))
