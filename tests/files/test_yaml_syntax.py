"""YAML means what YAML 1.2 says, and nothing more than JSON can say."""

from typing import Any

import pytest
import yaml

from sinuous.base.errors import InputError
from sinuous.files import documents
from sinuous.files.documents import parse_yaml
from tests.helpers import refused, with_each


@pytest.fixture(params=["CSafeLoader", "SafeLoader"], autouse=True)
def _both_parsers(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run every test with PyYAML's parser in C, where it is, and with that in Python."""
    if not hasattr(yaml, request.param):
        pytest.skip("PyYAML without libyaml")
    monkeypatch.setattr(documents, "_LOADER", getattr(yaml, request.param))


PLAIN: dict[str, Any] = {
    **{"1e-3": 0.001, "1E3": 1000.0, "-2.5e+2": -250.0, ".5": 0.5, "5.": 5.0, "+7": 7, "010": 10},
    **{"true": True, "False": False, "~": None, "null": None, "": None},
    **{each: each for each in ("no", "on", "0x10", "0o10", "1_000", "1:30", "2001-01-01", "größe 😀")},
    **{"'1'": "1", '"true"': "true"},
    "[1, 2.0, a]": [1, 2.0, "a"],
    "{b: {c: []}}": {"b": {"c": []}},
}


@with_each(("text", "value"), list(PLAIN.items()))
def test_scalars_are_those_of_yaml_1_2(text: str, value: Any) -> None:
    (found,) = parse_yaml(f"key: {text}").values()
    assert found == value
    assert type(found) is type(value)


def test_a_text_may_be_empty_and_lines_may_end_as_on_windows() -> None:
    assert parse_yaml("") is None
    assert parse_yaml("# only a remark\n") is None
    assert parse_yaml("a: 1\r\nb:\r\n  - 2\r\n") == {"a": 1, "b": [2]}


@with_each(
    ("text", "value"),
    [
        ("a: &x 1\nb: *x", {"a": 1, "b": 1}),
        ("a: &x {b: [1]}\nc: [*x, *x]", {"a": {"b": [1]}, "c": [{"b": [1]}] * 2}),
        ("a: &x [&y 1, *y]\nb: [*x, *y]", {"a": [1, 1], "b": [[1, 1], 1]}),
        ("a: &x 1\nb: &x 2\nc: *x", {"a": 1, "b": 2, "c": 2}),
        ("a: &x\nb: *x", {"a": None, "b": None}),
    ],
)
def test_an_alias_stands_for_the_value_of_its_anchor(text: str, value: Any) -> None:
    assert parse_yaml(text) == value


def bomb(levels: int) -> str:
    """Each level stands for ten of the one before."""
    rows = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, levels)]
    return "\n".join(["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]", *rows])


def test_aliases_that_multiply_are_refused_in_a_line_and_at_once() -> None:
    assert len(parse_yaml(bomb(4))["a3"]) == 10
    for levels in (6, 9, 60):
        with pytest.raises(
            InputError, match=r"^line 5: aliases multiply; expected at most 100000 repeated values"
        ) as found:
            parse_yaml(bomb(levels))
        assert "\n" not in str(found.value)
    many = "a: &a [" + "1, " * 999 + "1]\nb: [" + "*a, " * 99 + "*a]"
    refused("line 2", lambda: parse_yaml(many), " repeated")


@pytest.mark.parametrize(
    ("text", "key", "problem"),
    [
        ("a: .nan", "a", "expected a finite number"),
        ("a: [1, -.inf]", "a[1]", "expected a finite number"),
        ("a: {b: 1e999}", "a.b", "expected a finite number"),
        ("a: " + "9" * 5000, "a", "expected a finite number"),
        ("a: 1\na: 1", "a", "stands twice"),
        ("a: {b: 1, b: 2}", "a.b", "stands twice"),
        ("a: 1\nb: *x", "line 2", "alias of an anchor above it"),
        ("a: &x [1, *x]", "line 1", "part of"),
        ("a: *x\nb: &x 1", "line 1", "above"),
        ("a: 1\n*x : 2", "line 2", "no name"),
        ("a: &x !!str 1", "line 1", "tag"),
        ("a: !!python/object/apply:os.system [ls]", "line 1", "tag"),
        ("a: 1\n---\nb: 2", "line 2", "another document"),
        ("a: 1\nb: [1, 2", "line ", ""),
        ("a: b: c", "line 1", "mapping values"),
        ("? [1]\n: 2", "line 1", "no name"),
        ("a: \x00", "file", ""),
        ("[" * 100_000, "file", "nested too deeply"),
        ("- " * 5000 + "a", "file", "nested too deeply"),
    ],
)
def test_refusals_name_line_or_key(text: str, key: str, problem: str) -> None:
    with pytest.raises(InputError) as refusal:
        parse_yaml(text)
    assert refusal.value.key.startswith(key)
    assert problem in str(refusal.value)
    assert len(str(refusal.value).splitlines()) == 1
