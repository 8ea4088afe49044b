"""Exact distances at the points of a grid about an obstacle, kept on disk; and lists of what may be the closest."""

import hashlib
import itertools
import math
import os
import zipfile
import zlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.documents import draft_of
from sinuous.base.progress import work_time
from sinuous.base.system import places, writable
from sinuous.kernels.tables import FEWEST_SAMPLED, ITEM_COUNT, ITEM_KIND, LEVELS, MANY_OBSTACLES, TRIANGLES

MOST_FILES = 32
"""Files kept; the oldest go first."""


def load(name: str, shape: tuple[int, ...]) -> Floats | None:
    """Read an array of this name and shape; None where there is none, or none that is whole."""
    for directory in places("samples"):
        file = directory / f"{name}.npz"
        try:
            with file.open("rb") as stream, np.load(stream, allow_pickle=False) as arrays:
                values: Floats = arrays["values"]
            os.utime(file)
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error):
            continue
        if values.shape == shape and values.dtype == np.float64 and bool(np.isfinite(values).all()):
            return values
    return None


def save(name: str, values: Floats) -> None:
    """Keep an array where there is a place for it; others see it whole or not at all."""
    directory = next((place for place in places("samples") if writable(place)), None)
    if directory is None:
        return
    try:
        with draft_of(directory / f"{name}.npz") as draft:
            np.savez(draft, values=values)
        files = sorted(directory.glob("*.npz"), key=lambda file: file.stat().st_mtime, reverse=True)
        for old in files[MOST_FILES:]:
            old.unlink(missing_ok=True)
    except OSError:  # a full disk, or another process that tidies up: nothing is lost but time
        return


CELLS, ENTRIES = 29_000, 1_900_000
"""Most cells about a mesh, and most triangles of all their lists: 16 MB."""


def candidates(row: Floats, store: Floats, shape: tuple[int, int, int]) -> Floats:
    """Return cells and lists (l,) as the kernels read them, see `sinuous.kernels.fields.candidates`.

    Of a mesh whose row says where the middles of the cells are.
    """
    from sinuous.kernels.fields.candidates import CELL_SIZE, WORK, list_candidates  # noqa: PLC0415

    cells, lists = np.empty((*shape, CELL_SIZE)), np.empty(ENTRIES)
    count = list_candidates(row.reshape(1, -1).copy(), store, np.empty((WORK, int(row[ITEM_COUNT]))), cells, lists)
    return np.concatenate([cells.ravel(), lists[:count]])


Progress = Callable[[float], object]
"""Called with the share of the work that is done, 0 to 1."""

LEAST, MOST = 2**18, 2_000_000
"""Samples of an obstacle: at least about so many, and at most (16 MB)."""

PER_PIECE = 128
"""Samples for every primitive, between these."""

MANY_TRIANGLES, MOST_OF_MANY = 100_000, 2**19
"""Triangles from which on a sample takes several times as long, and most samples of such a mesh: steps and bounds are
coarser there, and what they leave undecided is decided exactly."""

FEWEST = 2**15
"""Samples of one that shares with others, at least about so many: see `parts`."""

SAMPLE_SECONDS = 6e-7
"""Seconds that a sample takes, about."""

OF_SMALL = 2**12
"""Samples of a mesh of few triangles that is one of many."""

PAD = 3
"""Cells around the box of the obstacle."""

THREADS = 2

SLABS = 64
"""Parts that the threads share."""

WORTH_KEEPING = 0.1
"""Seconds of computing from which samples are kept on disk."""

VERSION = 2
"""Raised when the samples of the same obstacle come out differently."""


def sample_count(of_triangles: bool, pieces: int, sharing: int) -> int:
    """How many samples an obstacle of so many primitives has, where so many share those of one."""
    if of_triangles and pieces < FEWEST_SAMPLED and sharing >= MANY_OBSTACLES:
        return OF_SMALL
    most = MOST_OF_MANY if of_triangles and pieces * sharing > MANY_TRIANGLES else MOST
    return max(min(max(PER_PIECE * pieces, LEAST), most) // sharing, FEWEST if sharing > 1 else 0)


def sampling_grid(low: Floats, high: Floats, most: int) -> tuple[Floats, float, tuple[int, int, int]]:
    """First point, spacing and shape of the finest grid of at most `most` points about a box, with `PAD` around it."""
    extent = high - low

    def shape(spacing: float) -> tuple[int, int, int]:
        x, y, z = (max(1, math.ceil(e / spacing)) + 1 + 2 * PAD for e in extent.tolist())
        return x, y, z

    fine, coarse = math.log(extent.max() / most), math.log(10.0 * extent.max())
    for _ in range(50):
        middle = 0.5 * (fine + coarse)
        if math.prod(shape(math.exp(middle))) > most:
            fine = middle
        else:
            coarse = middle
    spacing = math.exp(coarse)
    counts = shape(spacing)
    first = 0.5 * (low + high) - 0.5 * spacing * (np.array(counts) - 1)
    return first, spacing, counts


def sample(
    row: Floats, store: Floats, low: Floats, spacing: float, shape: tuple[int, int, int], progress: Progress | None
) -> Floats:
    """Distances (nx, ny, nz) to the obstacle of one row, whose low corner and spacing are in that row, or kept ones."""
    digest = hashlib.sha256(f"{VERSION} {shape} {low.tolist()} {spacing!r}".encode())
    digest.update(row.tobytes())
    digest.update(store.tobytes())
    name = digest.hexdigest()
    found = load(name, shape)
    if found is not None:
        if progress is not None:
            progress(1.0)
        return found
    values, seconds = _compute(row, store, shape, progress)
    if seconds > WORTH_KEEPING:
        save(name, values)
    return values


def _compute(
    row: Floats, store: Floats, shape: tuple[int, int, int], progress: Progress | None
) -> tuple[Floats, float]:
    """Sample by slabs, in threads: the kernel runs without the interpreter's lock. Return the seconds, too.

    The time of compiling or interpreting does not count: otherwise small arrays would be kept, too.
    An interrupt waits for the slabs that are under way, and not for the others.
    """
    from sinuous.kernels.fields import solids  # noqa: PLC0415
    from sinuous.kernels.fields.blocks import EDGE, WORKSPACE  # noqa: PLC0415
    from sinuous.kernels.fields.discs import DISC_SIZE  # noqa: PLC0415

    values = np.empty(shape)
    table = row.reshape(1, -1).copy()
    discs = np.empty((2 << int(row[LEVELS]) if row[ITEM_KIND] == TRIANGLES else 0, DISC_SIZE))
    if len(discs):
        solids.enclose(table, store, discs)
    solids.sample(table, store, discs, np.empty(WORKSPACE), 0, 0, values)  # compiled, or loaded, and nothing sampled
    began = work_time()
    steps = np.linspace(0, shape[0], SLABS + 1).astype(int)
    cuts = np.unique([*(steps[:-1] // EDGE * EDGE), shape[0]]).tolist()
    if values.size <= FEWEST:  # sooner than threads are begun
        solids.sample(table, store, discs, np.empty(WORKSPACE), 0, shape[0], values)
        return values, work_time() - began
    with ThreadPoolExecutor(min(THREADS, os.cpu_count() or 1)) as threads:
        slabs = [
            threads.submit(solids.sample, table, store, discs, np.empty(WORKSPACE), first, last, values)
            for first, last in itertools.pairwise(cuts)
        ]
        try:
            for done, slab in enumerate(slabs):
                slab.result()
                if progress is not None:
                    progress((done + 1) / len(slabs))
        except BaseException:
            threads.shutdown(wait=False, cancel_futures=True)
            raise
    return values, work_time() - began
