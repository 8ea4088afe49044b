"""Tables of numbers in texts: read as they were written, or refused; never other numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.base.errors import InputError
from sinuous.base.text_tables import axis_of, decode_table, read_table
from tests.helpers import refused

SEPARATORS = ",", ";", "\t", " ", "   ", ", ", " ; "
FORMATS = "{:.6f}", "{:.3e}", "{:g}", "{:+.2f}"


@st.composite
def tables(draw: st.DrawFn) -> tuple[str, np.ndarray, tuple[str, ...] | None]:
    """A text, its numbers, and its names."""
    width, count = draw(st.integers(3, 7)), draw(st.integers(2, 6))
    numbers = np.random.default_rng(draw(st.integers(0, 999))).normal(scale=100.0, size=(count, width))
    separator, form = draw(st.sampled_from(SEPARATORS)), draw(st.sampled_from(FORMATS))
    comma = draw(st.booleans()) and separator.strip() != ","
    cells = [[form.format(x).replace(".", "," if comma else ".") for x in row] for row in numbers]
    lines = [separator.join(row) + draw(st.sampled_from(["", separator.strip()])) for row in cells]
    read = np.array([[float(cell.replace(",", ".")) for cell in row] for row in cells])
    names = None
    if draw(st.booleans()):
        names = tuple(draw(st.permutations([*"xyz", *(f"extra{i}" for i in range(width - 3))])))
        lines.insert(0, draw(st.sampled_from(["", "//", "# "])) + separator.join(names))
    elif separator.strip() != "," and draw(st.booleans()):
        lines.insert(0, str(count))
    lines[1:1] = draw(st.sampled_from([[], ["# a comment"], ["", "  "]]))
    ending = draw(st.sampled_from(["\n", "\r\n"]))
    return draw(st.sampled_from(["", "\ufeff"])) + ending.join(lines) + ending, read, names


@given(tables())
def test_a_table_is_read_as_it_was_written(written: tuple[str, np.ndarray, tuple[str, ...] | None]) -> None:
    text, numbers, names = written
    try:
        table, rows = read_table(decode_table(text.encode()))
    except InputError as refusal:
        assert "can be read as" in str(refusal) or "separators or decimal" in str(refusal), text  # noqa: PT017
        return
    assert table.width == numbers.shape[1]
    np.testing.assert_array_equal(table.read(rows, range(table.width)), numbers)
    np.testing.assert_array_equal([table.read([row], range(table.width))[0] for row in rows], numbers)
    if names is not None and len(set(map(axis_of, names)) - {None}) == 3:
        assert [table.place(axis) for axis in "xyz"] == [names.index(axis) for axis in "xyz"]


@pytest.mark.parametrize(
    ("text", "refusal"),
    [
        ("0,6, 1,2, 3,4\n1,6, 2,2, 3,9\n", "line 1: the table can be read as 6 columns and as 3"),
        ("0,628651,149,339476,153,202113\n", "line 1: commas may be separators or decimal signs"),
        ("3\n1 2 3\n1 2 3\n", "line 1: the count of rows is wrong, 2 follow; expected 2, got '3'"),
        ("2\n1 2 3\n1 2 3\n1 2 3\n", "line 4: .*count of rows|line 4"),
        ("x,y,z\n1,2\n", "line 2: has 2 cells; expected as many as in line 1: x,y,z"),
        ("only words\nand more\n", "line 1|line 2"),
        ("1\n2\n", "line 1: the table cannot be read"),
    ],
)
def test_what_can_be_read_in_no_way_or_in_two_is_refused(text: str, refusal: str) -> None:
    def read_all() -> None:
        table, rows = read_table(text)
        table.read(rows, range(table.width))

    with pytest.raises(InputError, match=refusal):
        read_all()


def test_cells_without_a_number_are_nan() -> None:
    table, rows = read_table("a;b;c\n1;;nan\ninf;2;3\n")
    np.testing.assert_array_equal(table.read(rows, [0, 1, 2]), [(1, np.nan, np.nan), (np.nan, 2, 3)])
    refused("line 2.b", lambda: table.read_finite(rows, [1]), "expected a finite number, got ''")


def test_names_of_axes_and_units() -> None:
    for name in ("x", "X", "pos_x", "position.x", "x_mm", "Points:0", "x coordinate", "field.x"):
        assert axis_of(name) == "x", name
    for name in ("dx", "xx", "index", "nx", "id", "x2", "max"):
        assert axis_of(name) is None, name
    for text in ("x [mm], y [mm], z [mm]\n1,2,3\n", "x y z\nmm mm mm\n1 2 3\n", "x (mm)\ty (mm)\tz (mm)\n1\t2\t3\n"):
        table, rows = read_table(text)
        assert table.units == ("mm",) * 3, text
        assert table.read(rows, [2]).tolist() == [[3.0]]
