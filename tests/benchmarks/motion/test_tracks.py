"""Paths with more and more waypoints on them."""

from benchmarks.harness.plan import Plan
from benchmarks.motion import tracks


def test_long_paths_grow_evenly() -> None:
    lines = {line.section: line for line in tracks.measure_long(Plan(quick=True))}
    assert {tracks.LONG_TIME, tracks.LONG_MEMORY, tracks.TIME_RATIO, tracks.MEMORY_RATIO} == set(lines)
    assert lines[tracks.LONG_TIME].reached > 0.0
    memory = lines[tracks.MEMORY_RATIO]
    assert memory.reached > 0.5
    assert memory.held
