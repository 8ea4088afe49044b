"""What is read is noted once, and a mesh that is wrong is refused before anything is solved."""

from pathlib import Path

from tests.cli.conftest import Run
from tests.cli.test_check import DEFECT
from tests.scene.shapes import cube


def test_defects_are_noted_once_beside_the_results(run: Run) -> None:
    run("solve shell.yaml")  # may have to compile, which is said too
    said = run("solve --json shell.yaml easy.yaml shell.yaml")
    assert [result["status"] for result in said.results] == ["solved"] * 3
    assert said.err.splitlines() == [f"note: shell.yaml: {DEFECT}"]


def test_a_mesh_that_cuts_through_itself_is_a_shell_and_that_is_said(run: Run) -> None:
    """Pulled through its opposite face, one corner of a cube turns a part of it inside out."""
    vertices, faces = cube(5.0)
    vertices[7] = (-6.0, -6.0, 1.0)
    rows = [f"v {x} {y} {z}" for x, y, z in vertices.tolist()] + [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    Path("sheet.obj").write_text("\n".join(rows))
    said = run("solve easy.yaml shell.yaml").err
    assert (
        "note: shell.yaml: sheet: its surface cuts through itself, so it is used as a shell and not as a solid" in said
    )
