"""Tables of numbers in text files: how their columns are separated, what these are called, and what they hold.

Separators are `;`, tabs, commas or white space; decimals have a point, or a comma where that leaves one way to read
them. The first line may have names, with units in brackets (`x [mm]`), or a comment right before the rows has them
(`//X Y Z`); a line that has one whole number alone counts the rows that follow. A table that can be read in two ways
is refused with its first row, never guessed.
"""

import csv
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, counted, warn_of

SAMPLED = 200
"""Rows by which the separator is told."""

FEWEST = 2
"""Columns that a separator must make, where a table has no names."""

COMMENTS = ("#", "//", "%")

MISSING = {"", "nan", "-nan", "+nan", "inf", "-inf", "+inf", "null", "none", "na", "n/a", "-"}
"""What a cell says that holds no finite number."""

NUMBERS = {
    ".": re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"),
    ",": re.compile(r"[-+]?(,[0-9]+|[0-9]+(,[0-9]*)?)([eE][-+]?[0-9]+)?"),
}
"""A finite decimal number, by its decimal sign: `1e-3` is one; `0x10`, `1_000` and `1:30` are not."""

WHOLE, FRACTION = re.compile(r"[-+]?[0-9]+"), re.compile(r"[0-9]+([eE][-+]?[0-9]+)?")
"""What stands before and behind a decimal comma."""

WHITE, SPACED_COMMA = r"\s+", r",\s+"
WAYS = ((";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", "."), (SPACED_COMMA, ","), (WHITE, "."), (WHITE, ","))
"""Ways to read a row: a separator and a decimal sign."""

UNITS = {"m", "mm", "cm", "um", "µm", "km", "in", "inch", "ft", "rad", "deg", "degrees", "°", "s", "ms", "n", "nm"}
"""What may stand for the unit of a column in a line of its own below the names."""

AXES = {"x", "y", "z"}

AXIS = re.compile(
    r"(?:pos(?:ition)?[._ ]?|points?[:_.]|coord(?:inate)?s?[._ ]?|field\.)?([xyz012])"
    r"(?:[_ ](?:m|mm|cm|um|in|ft))?(?: coordinate)?"
)
"""Names of a coordinate: `x`, `X`, `pos_x`, `x_mm`, `Points:0`."""


class TableFormat(NamedTuple):
    """How the rows of a text are read.

    Attributes
    ----------
    separator : str
        A regular expression.
    decimal : str
    width : int
        Columns.
    names : tuple of str or None
    units : tuple of str
        What the header says about each column; empty where it says nothing.
    """

    separator: str
    decimal: str
    width: int
    names: tuple[str, ...] | None = None
    units: tuple[str, ...] = ()

    def cells(self, line: str) -> list[str]:
        """Cells of a row, without white space around them."""
        cells = _split(line, self.separator)
        return cells[:-1] if len(cells) == self.width + 1 and not cells[-1] else cells

    def number(self, cell: str) -> float | None:
        """Value of a cell: NaN where it holds none, `None` where it is another word."""
        if NUMBERS[self.decimal].fullmatch(cell):
            return float(cell.replace(",", "."))
        return np.nan if cell.lower() in MISSING else None

    def place(self, name: str) -> int | None:
        """Where the column of this name is; of `x`, `y`, `z` also under the other names of these.

        Raises
        ------
        InputError
            When two columns have the name.
        """
        names = self.names or ()
        for known in (names, [each.lower() for each in names], [axis_of(each) for each in names]):
            found = [i for i, each in enumerate(known) if each == name]
            if len(found) > 1:
                raise InputError("columns", f"{name} is there twice", " ".join(names), "names of their own")
            if found:
                return found[0]
        return None

    def read(self, rows: Sequence[tuple[int, str]], places: Sequence[int], *, strict: bool = True) -> Floats:
        """Numbers (m, k) in some columns of rows (line number, text); NaN where a cell holds none.

        Raises
        ------
        InputError
            With the number of the line, when a row has another number of cells, or a cell is a word; not `strict`, the
            cells that are missing, and words, are NaN.
        """
        if not rows:
            return np.empty((0, len(places)))
        try:
            return self._read_at_once([line for _, line in rows], places)
        except ValueError:
            return np.array([self._read_row(number, line, places, strict) for number, line in rows])

    def read_finite(self, rows: Sequence[tuple[int, str]], places: Sequence[int]) -> Floats:
        """Numbers (m, k) in some columns, all of them finite; see `read`."""
        numbers = self.read(rows, places)
        if np.isfinite(numbers).all():
            return numbers
        row, column = np.argwhere(np.isnan(numbers))[0]
        cell = self.cells(rows[row][1])[places[column]]
        raise InputError(f"line {rows[row][0]}.{self.name(places[column])}", "", cell, "a finite number")

    def name(self, place: int) -> str:
        """Name of a column; without names `column 1` and so on."""
        return f"column {place + 1}" if self.names is None else self.names[place]

    def warn_of_units(self, places: Iterable[int], file: object) -> None:
        """Warn that the header says units of columns, which nothing is turned into."""
        units = {self.units[place] for place in places if self.units} - {""}
        if units:
            warn_of([f"{file}: the header says {', '.join(sorted(units))}; numbers are taken as they stand"])

    def _read_at_once(self, lines: list[str], places: Sequence[int]) -> Floats:
        """Read rows of numbers alone, quickly; ValueError where some row needs a closer look."""
        if self.separator == SPACED_COMMA:
            lines = [re.sub(SPACED_COMMA, " ", line) for line in lines]
        if self.decimal == ",":
            lines = [line.replace(",", ".") for line in lines]
        between = self.separator if len(self.separator) == 1 else None
        if any('"' in line for line in lines):
            raise ValueError
        try:
            table = np.loadtxt(lines, delimiter=between, ndmin=2, comments=None)
        except ValueError:  # some column has words, or is empty
            if {len(_trimmed(line.strip().split(between))) for line in lines} != {self.width}:
                raise
            table = np.loadtxt(lines, delimiter=between, ndmin=2, comments=None, usecols=places)
        else:
            if table.shape[1] != self.width:
                raise ValueError
            table = table[:, list(places)]
        table[~np.isfinite(table)] = np.nan
        return table

    def _read_row(self, number: int, line: str, places: Sequence[int], strict: bool) -> list[float]:
        cells = self.cells(line)
        if strict and len(cells) != self.width:
            wanted = f"{self.width}" if self.names is None else f"{self.width}: {','.join(self.names)}"
            raise InputError(f"line {number}", f"has {counted(len(cells), 'cell')}", line, wanted)
        values = []
        for place in places:
            value = self.number(cells[place]) if place < len(cells) else np.nan
            if value is None and strict:
                raise InputError(f"line {number}.{self.name(place)}", "", cells[place], "a finite number")
            values.append(np.nan if value is None else value)
        return values


def axis_of(name: str) -> str | None:
    """`x`, `y` or `z` where a name means one of these."""
    found = AXIS.fullmatch(name.strip().lower())
    return None if found is None else {"0": "x", "1": "y", "2": "z"}.get(found[1], found[1])


def decode_table(content: bytes) -> str:
    """Text of a file: UTF-8, or UTF-16 with its byte order mark."""
    wide = content[:2] in (b"\xff\xfe", b"\xfe\xff")
    return content.decode("utf-16" if wide else "utf-8-sig", "replace")


def read_table(text: str, wanted: Collection[str] = AXES) -> tuple[TableFormat, list[tuple[int, str]]]:
    """Tell how a text is to be read, and return its rows: number of the line (1 = first), and the line.

    A comment before the rows has the names of columns where all `wanted` are among them.

    Raises
    ------
    InputError
        When it can be read in no way, or in two, or a count of rows is wrong.
    """
    lines = text.splitlines()
    filled = list(filled_lines(lines))
    table, rows = tell_format(list(_uncounted(filled)), _comments_before(lines, filled), wanted)
    if not text.endswith(("\n", "\r")) and _is_cut(table, rows):
        number, line = rows[-1]
        warn_of(
            [f"line {number} is the last, ends without a new line and in fewer digits, {line!r}: the table may be cut"]
        )
    return table, rows


def _is_cut(table: TableFormat, rows: list[tuple[int, str]]) -> bool:
    """Whether the last cell has fewer digits than all before it in its column."""
    cells = [table.cells(line)[-1] for _, line in rows[-SAMPLED:]]
    return len(cells) > FEWEST and len(cells[-1].lstrip("+-")) < min(len(cell.lstrip("+-")) for cell in cells[:-1])


def tell_format(
    rows: list[tuple[int, str]], comments: Sequence[str] = (), wanted: Collection[str] = AXES
) -> tuple[TableFormat, list[tuple[int, str]]]:
    """Tell how rows are to be read, of which the first may have the names; or one of the comments before them."""
    if not rows:
        return TableFormat(",", ".", 0), []
    number, first = rows[0]
    named = not any(_is_numeric(cell) for cell in _words(first))
    units: tuple[str, ...] = ()
    body = rows[1:] if named else rows
    if named and body and all(_plain_unit(cell) in UNITS for cell in _words(body[0][1])):
        units, body = tuple(map(_plain_unit, _words(body[0][1]))), body[1:]
    sample = [line for _, line in body[:SAMPLED]]
    if not sample:
        names, own = _names_of(first, None) or ((), ())
        return TableFormat(",", ".", len(names), names, units or own), []
    found = list(_ways(sample))
    ways = [way for way in found if not named or _names_of(first, way.width) is not None]
    if found and not ways:
        wanted = f"as many as in line {number}: {first}"
        raise InputError(f"line {body[0][0]}", f"has {found[0].width} cells", sample[0], wanted)
    ways = _best(ways, sample)
    if not ways:
        expected = "rows of as many numbers, between commas, semicolons, tabs or spaces"
        raise InputError(f"line {number}", "the table cannot be read", first, expected)
    way = ways[0]
    numbers = _sampled(way, sample)
    for other in ways[1:]:
        if not np.array_equal(numbers, _sampled(other, sample), equal_nan=True):
            problem = f"the table can be read as {way.width} columns and as {other.width}"
            raise InputError(f"line {body[0][0]}", problem, sample[0], "one separator that is no decimal sign")
    if named:
        names, own = _names_of(first, way.width) or ((), ())
        return way._replace(names=names, units=units or own), body
    for comment in comments:
        said = _names_of(comment, way.width)
        if said is not None and {*said[0], *map(axis_of, said[0])} >= set(wanted):
            return way._replace(names=said[0], units=said[1]), body
        half = _names_of(comment, way.width // 2) if way.separator == "," else None
        if half is not None and set(map(axis_of, half[0])) >= AXES:
            problem = f"has {way.width} cells; commas may be separators or decimal signs"
            raise InputError(f"line {body[0][0]}", problem, sample[0], f"as many as names before it: {comment}")
    _refuse_decimal_commas(way, sample, body[0][0])
    return way, body


def _refuse_decimal_commas(way: TableFormat, sample: list[str], number: int) -> None:
    """Refuse cells between commas each two of which may be one number with a decimal comma: `0,63,149,34,1,2e3`."""
    if way.separator != "," or way.width % 2 or way.width < 2 * len("xyz"):
        return
    rows = [cells for line in sample if len(cells := way.cells(line)) == way.width]
    if all(WHOLE.fullmatch(cell) for row in rows for cell in row[::2]) and all(
        FRACTION.fullmatch(cell) for row in rows for cell in row[1::2]
    ):
        problem = "commas may be separators or decimal signs"
        raise InputError(f"line {number}", problem, sample[0], "names of the columns in the first line, or columns=")


def filled_lines(lines: Iterable[str]) -> Iterator[tuple[int, str]]:
    """Yield lines that hold something, and their numbers, without comments."""
    for number, line in enumerate(lines, 1):
        plain = line.partition("#")[0].strip(" \r\n\f\v")
        if plain and not plain.startswith(COMMENTS) and not plain.isspace():
            yield number, plain


def _comments_before(lines: list[str], filled: list[tuple[int, str]]) -> list[str]:
    """Comments before the first line that is none, the last one first."""
    before = lines[: filled[0][0] - 1] if filled else []
    return [line.strip().lstrip("#/% ") for line in reversed(before) if line.strip().startswith(COMMENTS)]


def begins_with_count(lines: list[tuple[int, str]]) -> bool:
    """Whether the first line has one whole number alone, and the second one several words."""
    return len(lines) > 1 and lines[0][1].isdigit() and len(_words(lines[1][1])) > 1


def _uncounted(lines: list[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Yield the rows without counts of them, which are checked."""
    if not begins_with_count(lines):
        yield from lines
        return
    at = 0
    while at < len(lines):
        number, line = lines[at]
        named = at + 1 < len(lines) and not any(map(_is_numeric, _words(lines[at + 1][1])))
        end = at + 1 + named + (int(line) if line.isdigit() else len(lines))
        if end > len(lines):
            there = len(lines) - at - 1 - named
            raise InputError(f"line {number}", f"the count of rows is wrong, {there} follow", line, str(there))
        yield from lines[at + 1 : end]
        at = end


def _split(line: str, separator: str) -> list[str]:
    if '"' in line and len(separator) == 1:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
    parts = line.strip().split() if separator == WHITE else re.split(separator, line)
    return [cell.strip() for cell in parts]


def _words(line: str) -> list[str]:
    """Words of a line, whatever separates them."""
    return [word.strip("\"' ") for word in re.split(r"[;,\t]|\s+", _joined(line)) if word.strip("\"' ")]


def _joined(line: str) -> str:
    """A line of names, where units in brackets belong to the name before them: `x [mm]` is one word."""
    return re.sub(r"\s+([\[(][^\])]*[\])])", r"\1", line)


def _plain_unit(word: str) -> str:
    return word.strip("[]()\"' ").lower()


def _is_numeric(word: str) -> bool:
    return word.lower().lstrip("+-") in ("nan", "inf") or any(each.fullmatch(word) for each in NUMBERS.values())


def _names_of(line: str, width: int | None) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """Names and units in a line; of so many columns, or `None` where there are not so many."""
    joined = _joined(line)
    for separator in (";", "\t", ",", WHITE):
        cells = [cell.strip("\"' ") for cell in _split(joined, separator)]
        if len(cells) > 1 and not cells[-1]:
            cells = cells[:-1]
        if len(cells) == width or (width is None and len(cells) > 1):
            parts = [re.fullmatch(r"(.*?)\s*(?:[\[(]([^\])]*)[\])])?", cell) for cell in cells]
            return tuple(p[1] if p else "" for p in parts), tuple((p[2] or "") if p else "" for p in parts)
    return ((line.strip(),), ("",)) if width is None else None


def _ways(sample: list[str]) -> Iterator[TableFormat]:
    """Yield the ways in which all rows of a sample have as many cells."""
    for separator, decimal in WAYS:
        counts = Counter(len(_trimmed(_split(line, separator))) for line in sample)
        ((width, most),) = counts.most_common(1)
        if width >= FEWEST and 2 * most > len(sample):
            yield TableFormat(separator, decimal, width)


def _trimmed(cells: list[str]) -> list[str]:
    """Cells without an empty one behind the last separator."""
    return cells[:-1] if len(cells) > 1 and not cells[-1] else cells


def _best(ways: list[TableFormat], sample: list[str]) -> list[TableFormat]:
    """The ways in which no cell is a word; where there is none, those with the most columns of numbers."""
    columns = [int((~np.isnan(_sampled(way, sample))).any(axis=0).sum()) for way in ways]
    words = [_has_words(way, sample) for way in ways]
    plain = [way for way, count, word in zip(ways, columns, words, strict=True) if count and not word]
    if plain:
        return plain
    most = max(columns, default=0)
    return [way for way, count in zip(ways, columns, strict=True) if count == most > 0]


def _has_words(way: TableFormat, sample: list[str]) -> bool:
    return any(way.number(cell) is None for line in sample for cell in way.cells(line))


def _sampled(way: TableFormat, sample: list[str]) -> NDArray[np.float64]:
    """Numbers of a sample (m, width), NaN for words; only rows that have so many cells."""
    rows = [cells for line in sample if len(cells := way.cells(line)) == way.width]
    read = [[np.nan if (value := way.number(cell)) is None else value for cell in row] for row in rows]
    table = np.array(read, np.float64).reshape(-1, way.width)
    words = np.array([[way.number(cell) is None for cell in row] for row in rows]).reshape(-1, way.width)
    table[:, words.any(axis=0)] = np.nan
    return table
