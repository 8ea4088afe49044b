"""Results are strict JSON on one line."""

import json
import math

import numpy as np

from sinuous.files.results import json_line, plain, result


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
    assert plain(np.array([np.inf, 1.0])) == [None, 1.0]


def test_the_file_comes_first_and_the_time_of_preparing_after_that_of_solving() -> None:
    entries = result("a.yaml", {"status": "solved", "seconds": 1.0, "method": "newton"}, 2.0)
    assert list(entries) == ["file", "status", "seconds", "prepare_seconds", "method"]
