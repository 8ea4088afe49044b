"""What notebooks show: a picture and a table, or the table alone."""

import base64
import io
import re
import sys
from html import escape as html_of

import numpy as np
import pytest

import sinuous as sn
from sinuous.view.pictures.reports import html
from tests.helpers import present
from tests.view.pictures.arms import BALL, PATH, ROBOT, share_of

matplotlib = pytest.importorskip("matplotlib")

ROWS = {
    "Robot arm": ["segments", "length", "radius", "actuators"],
    "Scene": ["obstacles", "sphere"],
    "Solution: solved": ["position error", "clearance", "effort"],
    "Motion: solved": ["target", "between", "time", "effort"],
    "Solutions": ["solved", "least clearance", "time of each"],
    "Trajectory": ["duration", "phases", "between"],
}


@pytest.fixture(scope="module")
def nouns(track: sn.Motion) -> list[object]:
    many = sn.Solver(ROBOT, BALL).solve_many(PATH)
    timed = track.timed(sn.Rates(bend=1.0, length=1.0))
    return [ROBOT.changed(name="arm"), sn.Scene(BALL), track.solutions[0], track, many, timed]


def test_a_picture_and_a_table(nouns: list[object]) -> None:
    for noun, (caption, rows) in zip(nouns, ROWS.items(), strict=True):
        text: str = noun._repr_html_()  # type: ignore[attr-defined]
        assert caption in text
        for row in rows:
            assert f">{row}</th>" in text
        assert len(text) < 80_000
        assert "<script" not in text
        data = present(re.search(r'src="data:image/png;base64,([^"]+)"', text))
        image = matplotlib.image.imread(io.BytesIO(base64.b64decode(data[1])))
        assert 0.3 < share_of(image, (1.0, 1.0, 1.0), 0.02) < 0.995
        assert np.ptp(image[..., :3]) > 0.5


def test_without_matplotlib_there_is_the_table_alone(nouns: list[object], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for noun, (caption, rows) in zip(nouns, ROWS.items(), strict=True):
        text = html(noun)  # type: ignore[arg-type]
        assert caption in text
        assert "<img" not in text
        assert all(row in text for row in rows)


def test_names_are_text_and_no_markup() -> None:
    text = html(ROBOT.changed(name="<b>arm"))
    assert "<b>" not in text
    assert "&lt;b&gt;arm" in text


def test_what_is_not_solved_says_why() -> None:
    text = html(sn.solve(ROBOT, sn.Target((0, 0, 9))))
    assert "out_of_reach" in text
    assert "because" in text


def test_what_prints_itself_is_shown_so() -> None:
    explanation = sn.solve(ROBOT, sn.Target((0, 0, 9))).explain()
    text = present(explanation._repr_html_())
    assert "<img" not in text
    assert html_of(str(explanation)) in text
    found = sn.studies.reach(ROBOT, spacing=0.5 * ROBOT.mean_length, directions=1)
    text = present(found._repr_html_())
    assert html_of(str(found)) in text
    assert "data:image/png" in text
    assert len(text) < 200_000
