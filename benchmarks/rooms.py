"""`python -m benchmarks rooms`: lines of code by room, and the shape of the package: rooms, public names, words.

Lines of code are those without comments, docstrings and blanks. That imports run downwards, and never in a circle,
holds `tests/test_layout.py`.
"""

import ast
import io
import re
import subprocess
import tokenize
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

import typer

from benchmarks.harness import table

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


def here() -> dict[str, str]:
    """Return all modules as they are now."""
    files = sorted(file for folder in FOLDERS for file in (ROOT / folder).rglob("*.py"))
    return {file.relative_to(ROOT).as_posix(): file.read_text(encoding="utf-8") for file in files}


def report(now: Sources) -> Iterator[str]:
    """Yield the table of rooms, and one line of totals."""
    own, beside = sizes(now), ("benchmarks", "tests")
    rooms = sorted({*own} - {*beside})
    own["all of the package"] = sum(own[room] for room in rooms)
    rows = [[room, f"{own[room]:,}"] for room in (*rooms, "all of the package", *beside)]
    yield table([["room", "lines of code"], *rows])
    stub = (ROOT / PACKAGE / "__init__.pyi").read_text(encoding="utf-8")
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "*.md"], capture_output=True, text=True, check=True).stdout
    pages = [ROOT / name for name in listed.split() if (ROOT / name).exists()]
    loose = [path for path in now if path.startswith(PACKAGE) and room_of(path) == "package"]
    totals = {
        "package": own["all of the package"],
        "tests": own["tests"],
        "benchmarks": own["benchmarks"],
        "rooms": sum((ROOT / PACKAGE / room / "__init__.py").exists() for room in rooms),
        "modules beside them": len(loose) - sum(Path(path).stem in ("__init__", "__main__") for path in loose),
        "public names": len(re.findall(r"^from \S+ import \S+ as \S+$", stub, re.MULTILINE)),
        "Markdown words": sum(len(page.read_text(encoding="utf-8").split()) for page in pages),
    }
    yield "; ".join(f"{what} {count:,}" for what, count in totals.items())


def run() -> None:
    """Count lines of code by room, and say how many rooms, public names and words there are."""
    typer.echo("\n".join(report(here())))
