"""The pages in docs/ name what is there, and say of the methods what they say of themselves."""

import re
import shutil
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.main import get_command

import sinuous as sn
from benchmarks.methods import FAITHFUL
from sinuous.cli.app import app, main
from sinuous.cli.options import Output
from sinuous.files.nouns import KEYS, keys_of
from sinuous.methods.method import LIMITS, METHODS, capabilities
from sinuous.scene.obstacles import PRIMITIVES
from sinuous.view.pictures.figures import MOVIES
from tests.helpers import with_each

DOCS = Path(__file__).parent.parent / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
PACKAGE = Path(sn.__file__).parent
LESS = {r"\btime=\d+\.0": "time=0.5", r"\bseconds=\d+": "seconds=0.2", r"\brobots=\d+": "robots=32"}
"""What takes as long as it may, and what it is here: a place that is explored, a film, a search for a robot."""

WIDTH = 88
"""Characters of code that stand side by side on a page of the site."""

LESSONS = [DOCS / "index.md", DOCS / "first-steps.md", *sorted((DOCS / "guides").glob("*.md"))]


MOST_WORDS = {"docs": 25_000, "docs/design.md": 3_500, "CHANGELOG.md": 1_500, "README.md": 1_000}
"""Words that pages may have: each fact stands once, what a module does in its docstring."""


@with_each("place", MOST_WORDS)
def test_pages_stay_short(place: str) -> None:
    pages = PAGES if place == "docs" else [DOCS.parent / place]
    assert sum(len(page.read_text(encoding="utf-8").split()) for page in pages) <= MOST_WORDS[place]


@with_each("page", PAGES)
def test_links_and_pictures_are_there(page: Path) -> None:
    for link in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
        assert link.startswith("https://") or (page.parent / link).exists(), link


def test_endings_of_pictures_stand_in_the_help_the_format_and_the_guide() -> None:
    told = next(each.metadata["help"] for each in fields(Output) if each.name == "plot")
    endings = set(re.findall(r"\.[a-z]\w+", told))
    assert endings == {".png", ".svg", ".pdf", *(f".{kind}" for kind in MOVIES), ".html"}
    for page, row in (("format.md", "| `--plot FILE` |"), ("guides/pictures.md", "`--plot FILE`")):
        lines = (DOCS / page).read_text(encoding="utf-8").splitlines()
        assert any(line.startswith(row) and all(f"`{each}`" in line for each in endings) for line in lines), page


@with_each("page", [*PAGES, DOCS.parent / "CONTRIBUTING.md"])
def test_sources_that_pages_name_are_there(page: Path) -> None:
    for name in re.findall(r"`((?:\w+/)+\w+\.py)`", page.read_text(encoding="utf-8")):
        assert (PACKAGE / name).exists() or (DOCS.parent / name).exists(), name


@with_each("page", [*PAGES, DOCS.parent / "README.md", DOCS.parent / "CONTRIBUTING.md"])
def test_blocks_of_code_fit_the_width(page: Path) -> None:
    shown = re.findall(r"```(?:python|yaml|bash|text)\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert max(map(len, "".join(shown).splitlines()), default=0) <= WIDTH


@pytest.mark.parametrize("page", LESSONS, ids=lambda page: str(page.stem))
def test_what_lessons_show_works(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All blocks of a page, one after the other."""
    pytest.importorskip("matplotlib")
    shutil.copytree(DOCS.parent / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    shown = blocks(str(page.relative_to(DOCS)), "python")
    assert shown
    code = "\n".join(shown)
    for long, short in LESS.items():
        code = re.sub(long, short, code)
    exec(compile(code, page.name, "exec"), names)
    answer: Any = names["solution"] if "solution" in names else names.get("motion", names.get("now"))
    assert answer.solved
    match page.stem:
        case "calibration":
            assert names["found"].expected.mean < 0.03 * names["drawn"].mean_length
            assert names["weighed"].robot.payload[0].mass == pytest.approx(0.005, rel=1e-6)
        case "control-loop":
            assert abs(names["seen"] - names["target"].position).max() < 0.01
        case "derivatives":
            assert names["derivative"].regular
        case "known-place":
            assert names["solution"].start == "remembered"
            assert names["again"].motions > names["again"].shapes > 50
        case "lumen":
            assert names["motion"].deviation(names["curve"]).shape < 1.0  # % of the length
        case "motors":
            np.testing.assert_allclose(names["q"], names["solution"].q, atol=1e-9)
        case "workspace":
            assert names["again"].equals(names["workspace"])
            assert 0.0 < names["workspace"].volume().found < names["workspace"].volume(free=True).at_most
    for text in blocks(str(page.relative_to(DOCS)), "yaml"):
        Path("problem.yaml").write_text(text, encoding="utf-8")
        assert main(["solve", "problem.yaml"]) == 0


def test_every_public_name_is_in_the_reference() -> None:
    listed = re.findall(
        r"^\.\. auto(?:class|function):: ([\w.]+)$",
        "".join(page.read_text(encoding="utf-8") for page in (DOCS / "reference").glob("*.md")),
        re.MULTILINE,
    )
    public = {name for name in sn.__all__ if name != "__version__"}
    for room in (sn.answer, sn.files, sn.methods, sn.studies, sn.view):
        public |= {f"{room.__name__}.{name}" for name in room.__all__}
    assert public <= set(listed)
    for name in listed:
        home, _, last = name.rpartition(".")
        assert isinstance(getattr(import_module(home or "sinuous"), last), object)
    methods = {options.rpartition(".")[2] for options in METHODS.values()}
    assert methods == set(sn.methods.__all__) - {"Network", "train"}


def test_pages_name_every_way_into_and_out_of_a_file() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES if page.parent.name != "reference")
    public = [getattr(sn, name) for name in sn.__all__]
    ways = {way for noun in public for way in dir(noun) if re.match("to_|from_|save$|load$", way)}
    assert {"to_csv", "to_mjcf", "to_urdf"} <= ways
    assert {way for way in ways if not re.search(rf"\b{way}\b", text)} == set()


def test_pictures_are_made_by_one_command() -> None:
    """Those of experiments are made by these; every other one by `docs/figures.py`, and is shown somewhere."""
    source = (DOCS / "figures.py").read_text(encoding="utf-8")
    pages = "".join(page.read_text(encoding="utf-8") for page in [*PAGES, DOCS.parent / "README.md"])
    experiments = ("methods_", "segments_", "table1_", "tracking_")
    for image in (DOCS / "images").iterdir():
        assert image.name in pages, image.name
        assert image.stat().st_size < 1_500_000
        assert image.stem in source or image.stem.startswith(experiments), image.name


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


def test_what_the_page_of_formats_shows_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "examples").mkdir()
    shutil.copy(DOCS.parent / "examples" / "pose.yaml", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile("import sinuous as sn\n" + "\n".join(blocks("format.md", "python")), "format.md", "exec"), names)
    assert names["again"].to_dict() == names["solution"].to_dict()
    assert sn.load("motion.json").equals(names["motion"])
    problem, jointed, motors, driven, moving = blocks("format.md", "yaml")
    Path("gate.csv").write_text("t,x,y,z\n0,0,90,0\n1,0,60,0\n", encoding="utf-8")
    Path("problem.yaml").write_text(moving + "robot: {segments: {length: 50}}\ntarget: {position: [0, 0, 50]}")
    Path("motors.yaml").write_text(motors + "target: {position: [10, 0, 100]}", encoding="utf-8")
    scene = sn.load("problem.yaml", sn.Job).scene
    assert len([each for each in scene.obstacles if isinstance(each, sn.Moving)]) == len(scene) == 2
    Path("jointed.yaml").write_text(jointed, encoding="utf-8")
    assert sn.load("jointed.yaml", sn.Job).robot.joint_names == ("feed", "j2")
    for text in (problem, *(part + "target: {position: [10, 0, 100]}" for part in (motors, driven))):
        Path("problem.yaml").write_text(text, encoding="utf-8")
        assert main(["solve", "problem.yaml"]) == 0
    robot = sn.load("motors.yaml", sn.Job).robot
    assert [each.limits for each in robot.actuators] == [(0, 4000), *[(1248, 2848)] * 3]


def test_the_page_of_formats_names_every_key_option_and_status() -> None:
    text = "".join((DOCS / page).read_text(encoding="utf-8") for page in ("format.md", "clusters.md", "viewer.md"))
    nouns = (sn.Robot, sn.Segment, sn.Tendons, sn.Chambers, sn.Stage, sn.Stiffness, sn.Payload, sn.Actuators)
    obstacles = (*PRIMITIVES.values(), sn.Mesh, sn.PointCloud, sn.Grid)
    asked = (sn.Revolute, sn.Prismatic, sn.Target, sn.Tolerance, sn.Preferences, sn.Rates)
    keys = {*KEYS, *(key for noun in (*nouns, *obstacles, *asked) for key in keys_of(noun)[0])}
    answer = sn.solve(sn.Robot.uniform(2, 50), sn.Target((30, 0, 80)))
    motion = sn.Motion(answer.robot, [answer.q, answer.q])
    words = {*keys, *answer.to_dict(), *motion.to_dict(), *sn.Status}
    assert {word for word in words if not re.search(rf"\b{word}\b", text)} == set()
    options = {
        option.removeprefix("--")
        for command in get_command(app).commands.values()  # type: ignore[attr-defined]
        for parameter in command.params
        for option in parameter.opts
        if option.startswith("--")
    }
    shown = {found.removeprefix("no-") for found in re.findall(r"--([a-z-]+)", text)}
    assert options <= shown


def test_what_the_page_of_pages_shows_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "examples").mkdir()
    shutil.copy(DOCS.parent / "examples" / "insertion_room.yaml", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    exec(compile("\n".join(blocks("viewer.md", "python")), "viewer.md", "exec"), {})
    assert (tmp_path / "room.html").exists()
    assert (tmp_path / "question.html").exists()


def rows_of(page: str) -> dict[str, list[str]]:
    """Cells of the first table of capabilities, by method."""
    lines = (DOCS / page).read_text(encoding="utf-8").split("## What they handle")[1].splitlines()
    table = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| `")]
    return {row[0].strip("`"): row[1:] for row in table[: len(METHODS)]}


def test_the_table_of_methods_is_true() -> None:
    rows = rows_of("methods.md")
    assert list(rows) == list(METHODS)
    for name in METHODS:
        can = capabilities(name)
        flags = can.direction, can.rotation, can.orientation_alone, can.several_targets, can.tool
        limits = "all" if can.limits == LIMITS else ", ".join(can.limits)
        rest = can.obstacles, can.preferences, can.initial
        assert rows[name] == [*map(word, flags), limits, *map(word, rest)]


def word(handled: bool) -> str:
    return "yes" if handled else ""


def test_every_method_was_measured() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in (DOCS / "results").glob("*.txt"))
    for label in (*METHODS, FAITHFUL):
        assert text.count(f"| {label} ") >= 8, label
