"""What is written is read again, by this package and by others."""

import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from sinuous.base.documents import write_document, yaml_text
from sinuous.base.errors import InputError
from sinuous.files.documents import parse, parse_yaml
from tests.helpers import refused

numbers = st.integers(-(10**18), 10**18) | st.floats(allow_nan=False, allow_infinity=False)
odd = [*"~#\\'\"\x85\u2028", "no", "1e-3", "null", "010", "a: b", "- a", "*x", "&x", "!t", "a.b", "nan"]
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=12) | st.sampled_from(odd)
values = st.recursive(
    st.none() | st.booleans() | numbers | texts,
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(texts, inner, max_size=5),
    max_leaves=30,
)


@given(values)
def test_yaml_is_read_again(value: Any) -> None:
    found = parse_yaml(yaml_text(value))
    assert found == value
    assert json.dumps(found) == json.dumps(value)  # 1 and 1.0 and True differ here


@given(st.dictionaries(texts, numbers | st.lists(numbers | st.booleans(), max_size=9), max_size=5))
def test_other_readers_find_the_same(value: Any) -> None:
    assert yaml.safe_load(yaml_text(value)) == value


def test_lines_are_short_where_they_can_be() -> None:
    text = yaml_text({"a": [[0.1] * 5] * 9, "b": {"c": list(range(9)), "d": [{"e": [1.5] * 40, "f": 2}]}, "g": []})
    assert text.splitlines()[:2] == ["a:", "  - [0.1, 0.1, 0.1, 0.1, 0.1]"]
    assert max(map(len, text.splitlines())) <= 120
    assert "    - e:\n        - 1.5\n" in text
    assert text.endswith("      f: 2\ng: []\n")


def test_the_name_of_the_file_says_the_format(tmp_path: Path) -> None:
    for name in ("a.json", "a.JSON", "a.yaml", "a"):
        write_document(tmp_path / name, {"größe": [1, 2.5]})
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert parse(text, tmp_path / name) == {"größe": [1, 2.5]}
        assert text.startswith("{") == name.lower().endswith("json")


@pytest.mark.parametrize("file", ["missing/a.yaml", "", "a\0b"])
def test_files_that_cannot_be_written_are_refused(tmp_path: Path, file: str) -> None:
    with pytest.raises(InputError, match=r"^file: cannot be written: .*; expected a file that can be written, got "):
        write_document(f"{tmp_path}/{file}", {})


def test_texts_without_utf_8_are_refused(tmp_path: Path) -> None:
    write_document(tmp_path / "a.yaml", {"a": 1})
    refused("file", lambda: write_document(tmp_path / "a.yaml", {"a": "\udfff"}), "no form in UTF-8")
    assert (tmp_path / "a.yaml").read_text() == "a: 1\n"


@pytest.mark.parametrize("file", ["robot.npz", "robot.csv"])
def test_endings_of_other_formats_are_refused(tmp_path: Path, file: str) -> None:
    with pytest.raises(
        InputError, match=r"^file: its ending names no format.*; expected one of \.yaml, .* got "
    ) as caught:
        write_document(tmp_path / file, {})
    assert caught.value.key == "file"
    assert not (tmp_path / file).exists()
