"""The file of a memory: read when a command begins, and written when it ends, also by an interrupt."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from sinuous.cli.options import as_typed, check_writable
from sinuous.robot.robot import Robot
from sinuous.solving.memory import Memory


@contextmanager
def remembered(file: Path | None, robots: Mapping[str, Robot]) -> Iterator[Memory | None]:
    """Yield the memory in a file, or a new one where it is not there; in the end, write what is kept then.

    `robots`: the one of each problem file, which all must be the robot of the memory. Without a file there is none.
    """
    if file is None:
        yield None
        return
    with as_typed("memory"):
        memory = Memory.load(file) if file.exists() else Memory(next(iter(robots.values())))
        for robot in robots.values():
            memory.check(robot)
    check_writable("--memory", file, list(robots))
    try:
        yield memory
    finally:
        memory.save(file)
