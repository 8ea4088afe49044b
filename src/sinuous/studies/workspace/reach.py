"""A map of the workspace: voxels about a robot, what is reached of them, in which directions, and why not."""

import math
from collections.abc import Iterator
from enum import IntEnum
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.solutions import Solutions
from sinuous.answer.status import Status
from sinuous.base import checks
from sinuous.base.arguments import Vector
from sinuous.base.checks import Floats
from sinuous.base.documents import read_archive, write_archive
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, NotebookMixin
from sinuous.model.robot import Robot
from sinuous.problem.target import Workspace

VOXELS_IN_REACH = 35
"""Voxels from the base to the farthest place, where no spacing is given."""

MOST_VOXELS = 20_000_000


class Voxels(Frozen):
    """A grid of cubes, one of them about the base.

    Attributes
    ----------
    first : ndarray (3,)
        Middle of the voxel `[0, 0, 0]`.
    spacing : float
        Edge of a voxel.
    shape : (int, int, int)
    """

    first: Floats
    spacing: float
    shape: tuple[int, int, int]

    def __init__(self, first: Any, spacing: float, shape: tuple[int, int, int]) -> None:
        self._set(first=checks.vector("first", first), spacing=spacing, shape=shape)

    @classmethod
    def about(cls, robot: Robot, asked: Workspace) -> "Voxels":
        """Make those that hold whatever a robot may reach, or what of it is between the corners that are asked for.

        Raises
        ------
        InputError
            When there would be none, or too many.
        """
        base, reach = robot.base[:3, 3], reach_of(robot)
        step = reach / VOXELS_IN_REACH if asked.spacing is None else asked.spacing
        corners = base - reach if asked.low is None else asked.low
        others = base + reach if asked.high is None else asked.high
        if (others < corners).any():
            raise InputError("high", "is below low", others.tolist(), f"at least {corners.tolist()} in every entry")
        slack = 1e-9
        begin, end = np.ceil((corners - base) / step - slack), np.floor((others - base) / step + slack)
        counts = np.maximum(0.0, end - begin + 1.0)
        if not 0.0 < float(np.prod(counts)) <= MOST_VOXELS:
            wanted = f"one that makes 1 to {MOST_VOXELS:,}"
            raise InputError("spacing", f"makes {float(np.prod(counts)):.3g} voxels", step, wanted)
        x, y, z = counts.astype(int).tolist()
        return cls(base + step * begin, step, (x, y, z))

    @property
    def middles(self) -> Floats:
        """Middles (x, y, z, 3) of all voxels."""
        return self.first + self.spacing * np.moveaxis(np.indices(self.shape), 0, -1)

    @property
    def volume(self) -> float:
        """Volume of one voxel."""
        return self.spacing**3


def reach_of(robot: Robot) -> float:
    """Largest distance of the tip, with the tool, from the base."""
    length = sum(float(segment.length[1]) for segment in robot.segments)
    return length + float(np.linalg.norm(robot.tool[:3, 3]))


class Verdict(IntEnum):
    """What is known of a voxel in a direction; what is proved comes first.

    `OBSTACLE`: without obstacles it was solved, and among them nothing was found; `obstacles` says which one the free
    body would run into. `LIMITS`: limits hold the best found, also without obstacles. Both are no proofs.
    """

    SOLVED = 0
    OUT_OF_REACH = 1
    TARGET_BLOCKED = 2
    BASE_BLOCKED = 3
    OBSTACLE = 4
    LIMITS = 5
    NOT_FOUND = 6

    @property
    def proved(self) -> bool:
        """Whether it is certain."""
        return self <= Verdict.BASE_BLOCKED

    @property
    def sentence(self) -> str:
        """What it means."""
        return _SENTENCES[self]


_SENTENCES = {
    Verdict.SOLVED: "solved, whole body proved clear",
    Verdict.OUT_OF_REACH: "proved: out of reach",
    Verdict.TARGET_BLOCKED: "proved: the body would overlap an obstacle there",
    Verdict.BASE_BLOCKED: "proved: the body overlaps an obstacle at its base",
    Verdict.OBSTACLE: "an obstacle is in the way of all that was found",
    Verdict.LIMITS: "limits stop all that was found",
    Verdict.NOT_FOUND: "not found within the budget",
}

OF_STATUSES = {
    Status.SOLVED: Verdict.SOLVED,
    Status.OUT_OF_REACH: Verdict.OUT_OF_REACH,
    Status.TARGET_BLOCKED: Verdict.TARGET_BLOCKED,
    Status.BASE_BLOCKED: Verdict.BASE_BLOCKED,
    Status.LIMIT_BOUND: Verdict.LIMITS,
}

Codes = NDArray[np.uint8]


def verdicts_of(found: Solutions) -> Codes:
    """Return verdicts (m,) of solves without obstacles, or of a position among them."""
    return np.array([OF_STATUSES.get(status, Verdict.NOT_FOUND) for status in found.status.tolist()], np.uint8)


Truths = NDArray[np.bool_]

FORMAT = 3
"""Of files of maps."""

ARRAYS = ("directions", "verdicts", "free", "positions", "free_positions", "obstacles", "base")
NUMBERS = ("farthest", "seconds")
"""What a file of a map holds under the name of the attribute."""


class Volume(NamedTuple):
    """A volume on a grid.

    Attributes
    ----------
    found : float
        Of the voxels that were found.
    error : float
        By how much it may be wrong: half a voxel for each pair of neighbours of which one is found; where directions
        stand for all that there are, also what is lost from half of them to all of them.
    at_most : float
        Of those and of all that nothing is proved of; the true one is between both, but for the error.
    """

    found: float
    error: float
    at_most: float


class Reach(NotebookMixin, Frozen):
    """What a robot reaches, on a grid of voxels, with obstacles and without.

    Attributes
    ----------
    voxels : Voxels
    directions : ndarray (d, 3)
        Of the tangent at the tip; none in a map of positions.
    within : float or None
        How far the tangent may be off them, rad; `None`: the angle of the tolerance.
    sampled : bool
        Whether the directions stand for all that there are.
    positions : ndarray (x, y, z) of uint8
        Verdicts of positions, whatever the direction.
    free_positions : ndarray (x, y, z) of uint8
        The same without obstacles.
    verdicts : ndarray (x, y, z, d) of uint8
        See `Verdict`. In a map of positions `d` is 1, and these are `positions`.
    free : ndarray (x, y, z, d) of uint8
        The same without obstacles.
    obstacles : ndarray (x, y, z) of int16
        Number of the obstacle that takes most directions away, -1 where none does.
    names : tuple of str
        Of the obstacles.
    base : ndarray (3,)
    farthest : float
        Largest distance of the tip from the base.
    seconds : float
    """

    voxels: Voxels
    directions: Floats
    within: float | None
    sampled: bool
    positions: Codes
    free_positions: Codes
    verdicts: Codes
    free: Codes
    obstacles: NDArray[np.int16]
    names: tuple[str, ...]
    base: Floats
    farthest: float
    seconds: float

    def __init__(self, **parts: Any) -> None:
        for part in parts.values():
            if isinstance(part, np.ndarray):
                part.flags.writeable = False
        self._set(**parts)

    @cached_property
    def share(self) -> Floats:
        """Share (x, y, z) of the directions that are solved and proved."""
        return self._share(self.verdicts)

    @cached_property
    def free_share(self) -> Floats:
        """The same without obstacles."""
        return self._share(self.free)

    @property
    def lost(self) -> Floats:
        """Share (x, y, z) of the directions that obstacles take away."""
        return self.free_share - self.share

    @property
    def reachable(self) -> Truths:
        """Which voxels are reached, whatever the direction (x, y, z)."""
        return np.asarray(self.positions == Verdict.SOLVED)

    @property
    def dexterous(self) -> Truths:
        """Which voxels are reached in all directions that were asked for (x, y, z).

        Raises
        ------
        InputError
            When it is a map of positions.
        """
        self._need_directions()
        return np.asarray(self.share == 1.0)

    @cached_property
    def reasons(self) -> Codes:
        """What is said most often of the directions that are not solved (x, y, z); `SOLVED` where all are."""
        counts = np.stack([(self.verdicts == code).sum(axis=-1) for code in Verdict if code != Verdict.SOLVED])
        return np.where(counts.any(axis=0), 1 + counts.argmax(axis=0), Verdict.SOLVED).astype(np.uint8)

    @cached_property
    def proved(self) -> Truths:
        """Voxels (x, y, z) of which everything is certain: each direction is solved, or proved impossible."""
        return np.asarray((self.verdicts <= Verdict.BASE_BLOCKED).all(axis=-1))

    def volume(self, dexterous: bool = False, free: bool = False) -> Volume:
        """Volume of what is reached, whatever the direction or in all that were asked for; `free` without obstacles.

        Where all directions stand for the whole sphere, the volume that is reached in all of them shrinks with their
        number. What it loses from half of them to all of them is part of its error.

        Raises
        ------
        InputError
            When all directions are meant in a map of positions.
        """
        if not dexterous:
            return self._volume((self.free_positions if free else self.positions)[..., None])
        self._need_directions()
        codes = self.free if free else self.verdicts
        whole = self._volume(codes)
        if not self.sampled:
            return whole
        halves = [float((codes[..., k::2] == Verdict.SOLVED).all(axis=-1).sum()) for k in range(2)]
        return whole._replace(error=whole.error + self.voxels.volume * sum(halves) / 2.0 - whole.found)

    def _volume(self, codes: Codes) -> Volume:
        """Volume where all of verdicts (x, y, z, d) are solved."""
        found = (codes == Verdict.SOLVED).all(axis=-1)
        possible = ((codes == Verdict.SOLVED) | (codes > Verdict.BASE_BLOCKED)).all(axis=-1)
        padded = np.pad(found, 1)
        surface = sum(int((np.diff(padded, axis=axis)).sum()) for axis in range(3))
        unit = self.voxels.volume
        return Volume(unit * int(found.sum()), 0.5 * unit * surface, unit * int(possible.sum()))

    def _need_directions(self) -> None:
        if not len(self.directions):
            raise InputError("directions", "this is a map of positions", 0, "a map with directions: reach(directions=)")

    def why(self, point: Vector) -> dict[str, int]:
        """Count the directions at the voxel that holds a point (3,) by their verdicts, in the words of `Verdict`.

        What is farther from the base than the robot is long is out of reach, also outside the map.

        Raises
        ------
        InputError
            When it is outside the map, and not so far away.
        """
        place = checks.vector("point", point)
        if np.linalg.norm(place - self.base) > self.farthest:
            return {Verdict.OUT_OF_REACH.name.lower(): self.verdicts.shape[-1]}
        counts = np.bincount(self.verdicts[self._index(place)], minlength=len(Verdict))
        return {Verdict(code).name.lower(): int(count) for code, count in enumerate(counts) if count}

    def in_the_way(self, point: Vector) -> str | None:
        """Name of the obstacle that takes most directions away at the voxel that holds a point (3,), where one does.

        Raises
        ------
        InputError
            When it is outside the map.
        """
        number = int(self.obstacles[self._index(checks.vector("point", point))])
        return self.names[number] if number >= 0 else None

    def blame(self) -> dict[str, int]:
        """In how many voxels each obstacle takes most directions away; the most harmful first."""
        counts = np.bincount(self.obstacles[self.obstacles >= 0], minlength=len(self.names))
        order = np.argsort(-counts, kind="stable")
        return {self.names[i]: int(counts[i]) for i in order.tolist() if counts[i]}

    def save(self, file: str | Path) -> None:
        """Write it as NPZ.

        `verdicts` and `free` (without obstacles): numbers (x, y, z, direction) that stand for the words in `codes`;
        `positions` and `free_positions` (x, y, z): the same whatever the direction; `obstacles` (x, y, z): the number
        in `names` of the one that takes most directions away, or -1; `directions` (d, 3); `first` (3,): the middle of
        voxel [0, 0, 0]; `spacing`; `base` (4, 4); `farthest`: the largest distance of the tip from the base.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        own = {name: getattr(self, name) for name in (*ARRAYS, *NUMBERS, "sampled")}
        words = {"names": np.array(self.names, np.str_), "codes": np.array([code.name.lower() for code in Verdict])}
        grid = {"first": self.voxels.first, "spacing": self.voxels.spacing}
        within = np.nan if self.within is None else self.within
        write_archive(file, compressed=True, reach=FORMAT, within=within, **own, **grid, **words)

    @classmethod
    def load(cls, file: str | Path) -> "Reach":
        """Read what `save` wrote.

        Raises
        ------
        InputError
            When it is no such file.
        """
        with read_archive(file, "reach", (FORMAT,), "a map that Reach.save or sinuous reach --out wrote") as data:
            own = {name: data[name] for name in ARRAYS} | {name: float(data[name]) for name in NUMBERS}
            own["voxels"] = Voxels(data["first"], float(data["spacing"]), own["verdicts"].shape[:3])
            own["names"] = tuple(map(str, data["names"].tolist()))
            within = float(data["within"])
            return cls(within=None if np.isnan(within) else within, sampled=bool(data["sampled"]), **own)

    def to_dict(self) -> dict[str, Any]:
        """Return its totals as plain values."""
        kinds: dict[str, dict[str, bool]] = {"reachable": {}, "free_reachable": {"free": True}}
        if len(self.directions):
            kinds |= {"dexterous": {"dexterous": True}, "free_dexterous": {"free": True, "dexterous": True}}
        return {
            "voxels": list(self.voxels.shape),
            "spacing": self.voxels.spacing,
            "directions": len(self.directions),
            "within": self.within,
            "volumes": {name: self.volume(**kind)._asdict() for name, kind in kinds.items()},
            "verdicts": {code.name.lower(): int((self.verdicts == code).sum()) for code in Verdict},
            "obstacles": self.blame(),
            "seconds": self.seconds,
        }

    def _shown(self) -> Iterator[str]:
        yield "x".join(map(str, self.voxels.shape)) + " voxels"
        yield f"{len(self.directions)} directions" if len(self.directions) else "positions"
        yield f"volume={self.volume().found:.4g}"

    @property
    def asked_in_words(self) -> str:
        """What is meant by all directions, in words."""
        if len(self.directions) > 1:
            what = f"in all {len(self.directions)} directions"
        else:
            what = "with the tip along " + " ".join(f"{value:.3g}" for value in self.directions[0])
        return what if self.within is None else f"{what}, within {math.degrees(self.within):.3g} degrees"

    def __str__(self) -> str:
        shape = " x ".join(map(str, self.voxels.shape))
        count = len(self.directions)
        what = f"{count} directions each" if count > 1 else "a direction each" if count else "positions"
        parts = [f"Reach: {shape} voxels of {self.voxels.spacing:.4g}, {what}"]
        kinds = {"reachable": False} | ({self.asked_in_words: True} if len(self.directions) else {})
        for label, dexterous in kinds.items():
            found, free = self.volume(dexterous), self.volume(dexterous, free=True)
            less = f"; without obstacles {free.found:.4g}" if self.names else ""
            parts.append(
                f"  {label}: {found.found:.4g}, off by at most {found.error:.2g}; at most {found.at_most:.4g}{less}"
            )
        counts = {code: int((self.verdicts == code).sum()) for code in Verdict}
        whole = max(1, self.verdicts.size)
        parts += [f"  {100.0 * n / whole:9.3g} % {code.sentence}" for code, n in counts.items() if n]
        blame = list(self.blame().items())[:5]
        if blame:
            parts.append("  in the way " + ", ".join(f"{name} ({count:,} voxels)" for name, count in blame))
        return "\n".join(parts)

    def _share(self, codes: Codes) -> Floats:
        return (codes == Verdict.SOLVED).mean(axis=-1)

    def _index(self, place: Floats) -> tuple[int, int, int]:
        x, y, z = np.rint((place - self.voxels.first) / self.voxels.spacing).astype(int).tolist()
        if not all(0 <= k < n for k, n in zip((x, y, z), self.voxels.shape, strict=True)):
            last = self.voxels.first + self.voxels.spacing * (np.array(self.voxels.shape) - 1)
            wanted = f"a point between {self.voxels.first.tolist()} and {last.tolist()}"
            raise InputError("point", "outside the map", place.tolist(), wanted)
        return x, y, z
