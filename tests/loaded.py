"""What processes that tests begin in pools have loaded already: they are forked from one that imported this."""

import sinuous as sn
import sinuous.cli.warm
import tests.benchmarks.test_harness
import tests.studies.runs.poison
from tests.studies.batch.questions import BALL, OPTIONS, ROBOT

__all__ = ["sinuous", "tests"]

sn.Solver(ROBOT, [BALL], **OPTIONS).solve((0, 0, 150))
