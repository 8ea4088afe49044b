"""Everything in `examples/` runs and is solved.

What the README shows works.
"""

import json
import os
import re
import runpy
import shutil
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli.app import main

EXAMPLES = Path(__file__).parents[1] / "examples"
PROBLEMS = sorted(EXAMPLES.glob("*.yaml"))
SCRIPTS = sorted(file for file in EXAMPLES.glob("*.py") if not file.name.startswith("make_"))


@pytest.mark.parametrize("file", PROBLEMS, ids=lambda file: file.stem)
def test_problem_files_are_solved(capsys: pytest.CaptureFixture[str], file: Path) -> None:
    command = {"path": "track", "plan": "plan"}.get(file.stem.partition("_")[0], "solve")
    assert main([command, str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["status"] == "solved"


@pytest.mark.parametrize("file", SCRIPTS, ids=lambda file: file.stem)
def test_scripts_run(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(file), run_name="__main__")


def test_the_duct_is_made_by_its_script(tmp_path: Path) -> None:
    """Up to the last digit, in which sines may differ from machine to machine."""
    runpy.run_path(os.fspath(shutil.copy(EXAMPLES / "make_duct.py", tmp_path)), run_name="__main__")
    made, kept = (np.loadtxt(folder / "duct_scan.xyz") for folder in (tmp_path, EXAMPLES))
    np.testing.assert_allclose(made, kept, atol=0.11)
    fresh, old = (sn.Mesh.load(folder / "duct.stl", 1) for folder in (tmp_path, EXAMPLES))
    np.testing.assert_array_equal(fresh.faces, old.faces)
    np.testing.assert_allclose(fresh.vertices, old.vertices, atol=1e-3)
    assert old.watertight
    assert old.defects == ()


def test_the_path_through_spheres_is_made_by_its_script(tmp_path: Path) -> None:
    script = shutil.copy(EXAMPLES / "make_path_through_spheres.py", tmp_path)
    runpy.run_path(os.fspath(script), run_name="__main__")
    for name in ("path_through_spheres.yaml", "path_through_spheres.csv"):
        assert (tmp_path / name).read_text() == (EXAMPLES / name).read_text()


ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_python_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (example,) = blocks("python")
    exec(compile(example, "README.md", "exec"), {})
    assert "Solution: solved" in capsys.readouterr().out
    assert (tmp_path / "shape.png").stat().st_size > 0


def test_the_file_that_a_command_writes_is_solved(tmp_path: Path) -> None:
    file = str(tmp_path / "arm.yaml")
    assert "sinuous new tendon arm.yaml" in README
    assert main(["new", "tendon", file]) == 0
    assert main(["solve", file]) == 0


def test_every_file_that_it_names_is_there() -> None:
    named = re.findall(r"\]\(((?:docs|examples)[^)]*)\)|(examples/[\w.]+\.yaml)", README)
    assert len(named) > 5
    for pair in named:
        assert (ROOT / (pair[0] or pair[1])).exists()
