"""What each attempt brings: rows by hand make the tables that they should, and a short run ends well."""

from pathlib import Path

import pytest

from benchmarks.clutter.ablation import EVERYTHING, OFF, Row, examined, main, tables
from benchmarks.clutter.by_family import LIMIT


def test_tables_say_what_is_lost_and_what_is_slower() -> None:
    rows = [Row("pipe", i, EVERYTHING, True, 2.0) for i in range(10)]
    rows += [Row("pipe", i, "gates", i > 0, 2.0 if i > 0 else 1e3 * LIMIT) for i in range(10)]
    rows += [Row("pipe", i, "laid", True, 2.1) for i in range(10)]
    rows += [Row("hall", i, EVERYTHING, True, 4.0) for i in range(10)]
    rows += [Row("hall", i, "gates", True, 3.0) for i in range(10)]
    rows += [Row("hall", i, "laid", True, 10.0) for i in range(10)]
    rows += [
        Row("door", i, off, True, 1.0 + (off == "laid")) for i in range(10) for off in (EVERYTHING, "gates", "laid")
    ]
    lines = list(tables(rows))
    assert lines[2] == "| everything | 30/30 | 2.3 | 2.00 | 4.0 |  |"
    assert lines[3].startswith("| gates | 29/30 |")
    assert lines[3].endswith("| pipe (1 lost) |")
    assert lines[4].endswith("| hall (x 2.5) |")  # door takes twice as long, too, but hardly any time
    assert "| hall | 10/10 | 4.00 | 4.0 |" in lines


def test_a_place_is_solved_with_everything_and_without_each() -> None:
    rows = examined(("pipe 1.3", 0), ("laid", "cells"))
    assert [row.off for row in rows] == [EVERYTHING, "laid", "cells"]
    assert rows[0].solved
    easy = examined(("spheres 12", 0))
    assert [row.off for row in easy] == [EVERYTHING, *OFF]
    assert len({row.milliseconds for row in easy}) == 1


def test_the_command_prints_tables_and_keeps_what_places_took(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    kept = tmp_path / "rows.csv"
    arguments = ["--piece", "spheres 12", "--count", "1", "--only", "cells", "--alone", "--csv", str(kept)]
    assert main(arguments) == 0
    assert "| spheres 12 | 1/1" in capsys.readouterr().out
    assert kept.read_text().splitlines()[0] == ",".join(Row._fields)
    assert len(kept.read_text().splitlines()) == 3


@pytest.mark.parametrize("typed", [["--only", "hops"], ["--count", "0"], ["--piece", "hop"]])
def test_what_cannot_be_meant_is_refused_in_one_line(typed: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(typed) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
