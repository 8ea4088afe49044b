"""What tests of interrupted commands look at."""

import json
from pathlib import Path
from typing import Any


def answers(out: Path) -> list[Any]:
    """What a file of results says, without times."""
    return [untimed(json.loads(line)) for line in out.read_text().splitlines()]


def untimed(values: Any) -> Any:
    if isinstance(values, dict):
        return {key: untimed(value) for key, value in values.items() if key not in ("seconds", "prepare_seconds")}
    return [untimed(value) for value in values] if isinstance(values, list) else values


def lines(out: Path) -> int:
    """Lines of a journal that are whole."""
    file = out.with_name(out.name + ".journal")
    return file.read_bytes().count(b"\n") if file.exists() else 0
