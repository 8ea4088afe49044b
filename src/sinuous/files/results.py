"""Results as strict JSON: one object a line, plain values, no NaN and no infinity."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.files.documents import parse_json, read_text


def json_line(result: dict[str, Any]) -> str:
    """Return one result as one line, without a line break; numbers that are not finite become null."""
    try:
        return json.dumps(result, allow_nan=False, default=plain)
    except ValueError:  # some number is not finite
        return json.dumps(plain(result), allow_nan=False)


def result(file: str, answer: dict[str, Any], prepare_seconds: float) -> dict[str, Any]:
    """Put the name of the problem file in front of an answer, and the time of preparing after the time of solving.

    Remedies, where there are any, stand behind what they are remedies of.
    """
    answer = dict(answer)
    remedies = {"remedies": answer.pop("remedies")} if "remedies" in answer else {}
    entries: dict[str, Any] = {"file": file}
    for key, value in answer.items():
        entries[key] = value
        if key == "binding":
            entries.update(remedies)
        if key == "seconds":
            entries["prepare_seconds"] = prepare_seconds
    return entries


def plain(value: Any) -> Any:
    """Return a value with dict, list, str, int, finite float, bool and None in it, nothing else."""
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def read_results(file: Path) -> list[tuple[int, dict[str, Any]]]:
    """Read the results in a file, each with the number of its line.

    Raises
    ------
    InputError
        When it cannot be read, holds no result, or a line is no JSON object.
    """
    lines = [(i, line) for i, line in enumerate(read_text(file).splitlines(), 1) if line.strip()]
    results = []
    for number, line in lines:
        with checks.inside(f"line {number}"):
            values = parse_json(line)
            checks.instance("", values, dict, "a result")
        results.append((number, values))
    if not results:
        raise InputError("file", "is empty", str(file), "results, one a line")
    return results
