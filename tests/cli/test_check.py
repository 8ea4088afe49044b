"""The command check."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from sinuous.cli.app import main
from tests.cli.test_solve import strict

Write = Callable[[str], str]


def test_it_says_what_files_contain(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    files = [problem("scene.yaml"), problem("path.yaml")]
    assert main(["check", *files]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{files[0]}: 3 segments, length 2.4 to 3.6; 1 obstacle; 1 waypoint",
        f"{files[1]}: 3 segments, length 2.4 to 3.6; 0 obstacles; 3 waypoints",
    ]
    assert main(["check", "--json", files[1]]) == 0
    contents = strict(capsys.readouterr().out)
    assert (contents["segments"], contents["obstacles"], contents["waypoints"]) == (3, 0, 3)


@pytest.mark.parametrize(
    ("start", "code", "said"), [("result.json", 0, "meets its target"), ("straight", 1, "is no answer")]
)
def test_a_start_is_verified(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path, start: str, code: int, said: str
) -> None:
    main(["solve", problem("scene.yaml"), "--out", str(tmp_path / "result.json")])
    capsys.readouterr()
    file = tmp_path / "started.yaml"
    value = "[[0, 0, 1], [0, 0, 1], [0, 0, 1]]" if start == "straight" else start
    file.write_text(Path(problem("scene.yaml")).read_text() + f"start: {value}\n")
    assert main(["check", str(file)]) == code
    assert said in capsys.readouterr().out
    assert main(["check", "--json", str(file)]) == code
    assert strict(capsys.readouterr().out)["start"]["ok"] is (code == 0)


def test_defects_of_meshes_are_listed(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file = problem("shell.yaml")
    defect = "sheet: 3 edges with one triangle only (holes), so it is used as a shell and not as a solid"
    assert main(["check", file]) == 0
    said = capsys.readouterr()
    assert said.out.splitlines()[1:] == [f"  note: {defect}"]
    assert said.err == ""
    assert main(["check", "--json", file]) == 0
    assert strict(capsys.readouterr().out)["notes"] == [defect]


@pytest.mark.parametrize("json", [[], ["--json"]])
def test_a_file_that_is_wrong_does_not_hide_the_others(
    capsys: pytest.CaptureFixture[str], problem: Write, monkeypatch: pytest.MonkeyPatch, json: list[str]
) -> None:
    """A mesh that needs a package which is not installed, for one; and none is forgiven by what follows it."""
    monkeypatch.setitem(sys.modules, "trimesh", None)
    files = [problem("bad.yaml"), problem("shell.yaml"), problem("easy.yaml")]
    assert main(["check", *files, *json]) == 2
    said = capsys.readouterr()
    assert len(said.out.splitlines()) == 1
    assert files[2] in said.out
    bad, missing = said.err.splitlines()
    assert bad.startswith(f"{files[0]}: target.position: expected 3 finite numbers")
    assert missing.startswith(f"{files[1]}: ")
    assert "sinuous[mesh]" in missing
