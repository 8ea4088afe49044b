"""All pieces of the corpus, by name: each yields its problems, the same ones in the same order every time."""

from collections.abc import Callable, Iterator

from benchmarks.corpus import files, motions, solves, studies
from benchmarks.corpus.answers import Problem

PIECES: dict[str, Callable[[], Iterator[Problem]]] = {
    **solves.PIECES,
    **motions.PIECES,
    **studies.PIECES,
    **files.PIECES,
}
