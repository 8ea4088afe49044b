"""JSON is read strictly, and results are strict JSON on one line."""

import json
import math

import numpy as np
import pytest

from sinuous.base.documents import result_value
from sinuous.base.errors import InputError
from sinuous.files.documents import json_line, parse_json, result
from tests.cases import with_each


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


def test_nothing_of_numpy_and_nothing_infinite_leaks() -> None:
    value = {
        "a": np.float64(1.5),
        "b": np.arange(3),
        "c": (np.int64(2), math.inf),
        "d": float("nan"),
        "e": np.bool_(True),
    }
    line = json_line(value)
    assert "\n" not in line
    assert json.loads(line) == {"a": 1.5, "b": [0, 1, 2], "c": [2, None], "d": None, "e": True}
    assert result_value(np.array([np.inf, 1.0])) == [None, 1.0]


def test_the_file_comes_first_and_the_time_of_preparing_after_that_of_solving() -> None:
    entries = result("a.yaml", {"status": "solved", "seconds": 1.0, "method": "newton"}, 2.0)
    assert list(entries) == ["file", "status", "seconds", "prepare_seconds", "method"]
