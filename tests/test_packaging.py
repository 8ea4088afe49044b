"""What the package says of itself is the same everywhere, and what it needs at run time is in it."""

import re
import tomllib
from pathlib import Path
from typing import Any

import numba
import yaml
from packaging.requirements import Requirement
from packaging.version import Version

import sinuous
from sinuous.kernels.compile.sources import TRIED
from tests.helpers import with_each

ROOT = Path(__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
PAGES = ["README.md", "CONTRIBUTING.md", *(str(page.relative_to(ROOT)) for page in (ROOT / "docs").rglob("*.md"))]
PYTHONS = [
    found[1] for line in PROJECT["classifiers"] if (found := re.fullmatch(r".*Python :: (\d\.\d+)", line)) is not None
]


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_the_version_is_said_once() -> None:
    assert PROJECT["dynamic"] == ["version"]
    assert "version" not in PROJECT
    source = PYPROJECT["tool"]["hatch"]["version"]["path"]
    assert f'__version__ = "{sinuous.__version__}"' in text(source)


def test_citation_and_changelog_speak_of_this_version() -> None:
    version = Version(sinuous.__version__)
    citation: dict[str, Any] = yaml.safe_load(text("CITATION.cff"))
    assert citation["version"] == version.base_version
    assert (citation["license"], citation["title"].lower()) == (PROJECT["license"], PROJECT["name"])
    assert (citation["abstract"], citation["keywords"]) == (PROJECT["description"], PROJECT["keywords"])
    sections = re.findall(r"^## \[(.*?)\]", text("CHANGELOG.md"), re.MULTILINE)
    assert sections[0] == "Unreleased"
    if not version.is_prerelease:
        assert sections[1] == str(version)


def test_python_versions_agree() -> None:
    first, last = PYTHONS[0], PYTHONS[-1]
    assert PROJECT["requires-python"] == f">={first}"
    assert PYPROJECT["tool"]["mypy"]["python_version"] == first
    for page in ("README.md", "CONTRIBUTING.md"):
        assert f"Python {first} to {last}" in text(page)
    for name, job in (("ci", "tests"), ("release", "kernels")):
        workflow = yaml.safe_load(text(f".github/workflows/{name}.yml"))
        assert workflow["jobs"][job]["strategy"]["matrix"]["python"] == PYTHONS


@with_each("page", PAGES)
def test_extras_that_pages_name_are_there(page: str) -> None:
    named = re.findall(r"(?:sinuous|\.)\[(\w+(?:,\w+)*)\]", text(page))
    assert {extra for names in named for extra in names.split(",")} <= set(PROJECT["optional-dependencies"])


def test_refusals_name_extras_that_are_there() -> None:
    """Of pictures, and of each kind of file that another package reads."""
    sources = "".join(file.read_text(encoding="utf-8") for file in Path(sinuous.__file__).parent.rglob("*.py"))
    named = set(re.findall(r"pip install sinuous\[(\w+)\]", sources))
    named |= set(re.findall(r'checks\.needed\("[\w.]+", "(\w+)"', sources))
    assert {"batch", "cluster", "mesh", "plot", "view"} <= named <= set(PROJECT["optional-dependencies"])


def test_this_numba_was_tried_and_others_are_not_refused() -> None:
    (numba_needed,) = (one for one in map(Requirement, PROJECT["dependencies"]) if one.name == "numba")
    assert numba.__version__.startswith(TRIED)
    assert [one.operator for one in numba_needed.specifier] == [">="]


def test_what_the_archives_hold_is_there() -> None:
    targets = PYPROJECT["tool"]["hatch"]["build"]["targets"]
    for name in [*targets["sdist"]["include"], *targets["wheel"]["packages"], *PROJECT["license-files"]]:
        assert (ROOT / name).exists(), name


def test_continuous_integration_installs_the_wheel_with_every_extra() -> None:
    """But those for work on the package itself."""
    extras = [extra for extra in PROJECT["optional-dependencies"] if extra not in ("test", "dev", "docs")]
    assert f"for extra in {' '.join(extras)}; do" in text(".github/workflows/ci.yml")


CHECKED = "mypy src tests benchmarks examples/quickstart.py build/shown"


def test_continuous_integration_runs_what_contributors_run() -> None:
    commands = [
        step["run"]
        for job in yaml.safe_load(text(".github/workflows/ci.yml"))["jobs"].values()
        for step in job["steps"]
        if "run" in step
    ]
    for command in ("ruff check .", "ruff format --check .", CHECKED, "python -m pytest", "python -m build"):
        assert command in commands
    for command in (
        "ruff check .",
        "ruff format --check .",
        CHECKED,
        "python -m sphinx -q -W --keep-going docs build/docs",
    ):
        assert command in commands
        assert f"\n{command}\n" in text(".ci/run")
