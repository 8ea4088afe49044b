"""`python -m benchmarks motion`: what is planned and tracked, how quickly, and whether it is as clear as it claims."""

from benchmarks.harness import Part
from benchmarks.motion import known, leader, loops, moving, p5, tracks

PARTS: dict[str, Part] = {**p5.PARTS, **tracks.PARTS, **leader.PARTS, **loops.PARTS, **moving.PARTS, **known.PARTS}
"""What is measured, in order."""
