"""A corpus of some thousand problems with their answers, so that a change of form can be held to the last bit.

    python -m benchmarks corpus write FILE        # with the code before: asks everything, and keeps the answers
    python -m benchmarks corpus write FILE        # once more, best beside load: drops what depends on the clock
    python -m benchmarks corpus compare FILE      # with the code after: exit code 1 where an answer differs

Problems are made from seeds; budgets are numbers of starts and draws, and of seconds so many that they never decide.
Last bits depend on the processor and on the versions of NumPy and Numba: files are of one machine, and not committed.

What an answer is made of is public. Sentences and messages may change: they are compared apart, and fail nothing.
An answer that differs is looked at by the judges of the other experiments, where these can: whether it is still right.

`answers` says what is kept of an answer and how two differ; `solves`, `motions`, `studies` and `files` hold the
problems, by pieces; `experiment` asks them in processes, and writes or compares.
"""

import os
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, by default that of the process, and return its exit code."""
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "IGL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")  # read when NumPy is first imported
    from benchmarks.corpus.experiment import run  # noqa: PLC0415

    return run(arguments)
