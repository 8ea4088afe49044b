"""What a folder of chunks, or a file of results, was made of: beside it, as JSON."""

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import sinuous
from sinuous.batch.tables.source import Source
from sinuous.errors import InputError
from sinuous.kernels.compiling.sources import sources_hash
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.options import SolveOptions


def asked(robot: Robot, scene: Snapshot, options: SolveOptions) -> dict[str, str]:
    """Return what tells a robot, the obstacles and the options from others."""
    names = [scene.name(i) for i in range(len(scene))]
    return {
        "version": f"{sinuous.__version__}, kernels {sources_hash()[:12]}",
        "robot": hash_of(json.dumps(robot.to_dict(), sort_keys=True).encode()),
        "scene": f"{len(scene)} obstacles, {hash_of(scene.group.tobytes(), repr(names).encode())}",
        **{name: str(value) for name, value in vars(options).items()},
    }


def record_of(question: Mapping[str, str], source: Source, chunk: int, initial: Any, warm: bool) -> dict[str, Any]:
    """Return all that results depend on."""
    begun = "none" if initial is None else hash_of(np.ascontiguousarray(initial).tobytes())
    return {
        **question,
        "initial": f"{begun}{', then near targets' if warm else ''}",
        "targets": f"{source.rows} rows, {source.fingerprint()}",
        "chunk": chunk,
    }


def check_same(before: Mapping[str, Any], now: Mapping[str, Any], where: Path, what: str = "this batch") -> None:
    """Refuse to go on with what was asked otherwise; `what` began then.

    Raises
    ------
    InputError
        That names the first thing that differs.
    """
    for key, value in now.items():
        if before.get(key) != value:
            wanted = f"{before.get(key)}, as in {where}, or another file for the results"
            raise InputError(key, f"it has changed since {what} began", value, wanted)


@dataclass(frozen=True)
class RecordFile:
    """A record on disk."""

    file: Path

    def read(self) -> dict[str, Any] | None:
        """Return what it says; nothing where there is none.

        Raises
        ------
        InputError
            When it is no record.
        """
        try:
            values = json.loads(self.file.read_text(encoding="utf-8"))
        except (FileNotFoundError, NotADirectoryError):
            return None
        except (OSError, ValueError) as error:
            raise InputError("out", f"cannot be read: {error}", str(self.file), "the record of a batch") from None
        if not isinstance(values, dict):
            raise InputError("out", "", str(self.file), "the record of a batch")
        return values

    def write(self, values: Mapping[str, Any]) -> None:
        """Write it whole, or not at all."""
        draft = draft_of(self.file)
        draft.write_text(json.dumps(values, indent=1) + "\n", encoding="utf-8")
        draft.replace(self.file)


def draft_of(file: Path) -> Path:
    """Where a file is written before it gets its name: no two processes write the same."""
    return file.with_name(f".{file.stem}.{os.uname().nodename}-{os.getpid()}{file.suffix}")


def hash_of(*parts: bytes) -> str:
    """Return what tells some bytes from others."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part)
    return digest.hexdigest()[:16]
