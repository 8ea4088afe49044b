"""JSON is read strictly."""

import pytest

from sinuous.base.errors import InputError
from sinuous.files.documents import parse_json
from tests.cases import with_each


def test_values() -> None:
    assert parse_json('{"a": [1, 2.5, true, null, "x"]}') == {"a": [1, 2.5, True, None, "x"]}


@with_each(
    ("text", "key", "problem"),
    [
        ('{"a": NaN}', "a", "expected a finite number"),
        ('{"a": [0, {"b": -Infinity}]}', "a[1].b", "expected a finite number"),
        ('{"a": 1e400}', "a", "expected a finite number"),
        ('{"a": ' + "9" * 5000 + "}", "a", "expected a finite number"),
        ('{"a": 1, "a": 1}', "a", "stands twice"),
        ('{"a": 1,\nb}', "line 2", "Expecting property name"),
        ('{"a": 1}\n{"a": 1}', "line 2", "Extra data"),
        ("", "line 1", "Expecting value"),
        ("[" * 100_000, "file", "nested too deeply"),
    ],
)
def test_refusals_name_line_or_key(text: str, key: str, problem: str) -> None:
    with pytest.raises(InputError) as refusal:
        parse_json(text)
    assert refusal.value.key.startswith(key)
    assert problem in str(refusal.value)
