"""What is read is noted once, and a mesh that is wrong is refused before anything is solved."""

from collections.abc import Callable
from pathlib import Path

import pytest

from sinuous.cli.app import main
from sinuous.cli.reading import read_all
from tests.cli.test_solve import strict
from tests.scene.shapes import cube

Write = Callable[[str], str]


def test_defects_are_noted_once_beside_the_results(capsys: pytest.CaptureFixture[str], problem: Write) -> None:
    file, easy = problem("shell.yaml"), problem("easy.yaml")
    main(["solve", file])  # may have to compile, which is said too
    capsys.readouterr()
    assert main(["solve", "--json", file, easy, file]) == 0
    said = capsys.readouterr()
    assert [strict(line)["status"] for line in said.out.splitlines()] == ["solved"] * 3
    assert said.err.splitlines() == [
        f"note: {file}: sheet: 3 edges with one triangle only (holes), so it is used as a shell and not as a solid"
    ]


def test_a_mesh_that_cuts_through_itself_is_a_shell_and_that_is_said(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path
) -> None:
    """Pulled through its opposite face, one corner of a cube turns a part of it inside out."""
    file = problem("shell.yaml")
    vertices, faces = cube(5.0)
    vertices[7] = (-6.0, -6.0, 1.0)
    rows = [f"v {x} {y} {z}" for x, y, z in vertices.tolist()] + [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    (tmp_path / "sheet.obj").write_text("\n".join(rows))
    assert main(["solve", problem("easy.yaml"), file]) == 0
    notes = [line for line in capsys.readouterr().err.splitlines() if "cuts through itself" in line]
    assert notes == [
        f"note: {file}: sheet: its surface cuts through itself, so it is used as a shell and not as a solid"
    ]


def test_reading_is_timed(problem: Write) -> None:
    (read,) = read_all([problem("shell.yaml")])
    assert len(read.problem.scene) == 1
    assert 0.0 < read.seconds < 60.0


def test_a_wrong_mesh_is_refused_in_one_line(
    capsys: pytest.CaptureFixture[str], problem: Write, tmp_path: Path
) -> None:
    good, file = problem("easy.yaml"), problem("shell.yaml")
    sheet = tmp_path / "sheet.obj"
    for text, said in (
        (
            "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n",
            f"{sheet}: vertices[1]: expected 3 finite numbers, got [nan, 0.0, 0.0]",
        ),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", f"{file}: scene[0].mesh.file: expected a mesh with at least one triangle"),
        ("no mesh\n", f"{file}: scene[0].mesh.file: "),
    ):
        sheet.write_text(text)
        assert main(["solve", good, file]) == 2
        output = capsys.readouterr()
        assert output.out == ""
        (line,) = output.err.splitlines()
        assert line.startswith(said)
        assert ": expected " in line
