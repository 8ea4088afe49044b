"""One place again."""

from pathlib import Path

import pytest

from benchmarks.clutter.replay import main


def test_a_place_is_solved_again(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "place.png"
    assert main(["spheres 12", "0", "--picture", str(picture)]) == 0
    assert capsys.readouterr().out.startswith("spheres 12, 0: solved by arc in ")
    assert picture.stat().st_size > 5_000


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["labyrinth", "0"], "FAMILY: expected one of spheres 12, "),
        (["shelf", "--", "-1"], "NUMBER: expected "),
        (["shelf", "0", "--picture", "/nowhere/a.png"], "--picture: cannot be written: "),
    ],
)
def test_what_cannot_be_meant_is_one_line(
    arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith(complaint)
    assert captured.err.count("\n") == 1
