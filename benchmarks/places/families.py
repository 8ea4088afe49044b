"""All families of places, what each is, and for which robots it is drawn."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from numpy.random import Generator

from benchmarks.places import bases, cells, media, polyhedra, tubes
from benchmarks.places.around import drum, duct, pipe, plates, shelf, spheres
from benchmarks.places.parts.robots import long_robot, stout_robot, thin_robot, various_robot
from benchmarks.places.place import Draw, Place, Trap, settle, trapped
from benchmarks.places.scans import meshed, scan
from sinuous.model.robot import Robot


@dataclass(frozen=True)
class Family:
    """Places of one kind.

    Attributes
    ----------
    make : callable
        From a seed to a place.
    words : str
        What it is.
    published : bool
        Whether it repeats what others were measured on.
    trap : bool
        Whether it is narrow where a search begins or ends.
    joints : bool
        Whether robots have joints before the arm: what compares clearances of segments alone leaves these out.
    judging : bool
        Whether it is kept from tuning: no constant of the strategy was chosen on it, no mechanism is written for it.
        Whoever looks into one of these to mend a failure moves it to the others and writes a new one.
    """

    make: Callable[[int], Place]
    words: str
    published: bool = False
    trap: bool = False
    judging: bool = False
    joints: bool = False


_DRAWN: dict[str, tuple[Draw, str]] = {
    **{f"spheres {n}": (partial(spheres, n), f"{n} balls beside the hidden shape") for n in (12, 40, 100)},
    **{
        f"pipe {w}": (partial(pipe, w), f"closed curved pipe of {w} times the body's radius, a mesh")
        for w in (2.2, 1.6, 1.3)
    },
    "plates": (plates, "2 to 6 plates with holes of 1.5 times the body's radius, meshes"),
    "drum": (drum, "rows of blades on a drum, meshes; the target deep between two blades"),
    "shelf": (shelf, "a shelf of boxes; the target deep in a compartment"),
    "duct": (duct, "closed duct of 1.7 times the body's radius with 2 to 4 dead ends, a mesh"),
}
SCANNED = ("spheres 40", "pipe 1.6", "plates", "drum", "shelf", "duct")

_TRAPS: dict[str, tuple[Trap, str]] = {
    **{
        f"open pipe {w}": (
            partial(tubes.open_pipe, w),
            f"base in a mouth of a pipe of {w} times the body's radius, a mesh",
        )
        for w in (2.2, 1.6, 1.3)
    },
    "pipe between": (partial(tubes.pipe_between, 1.6), "an open pipe between base and target, a mesh"),
    "guide tube": (tubes.guide_tube, "base in a straight tube that hardly leaves room, a mesh"),
    "channel": (partial(tubes.open_channel, 1.5), "base in a straight channel of boxes"),
    "bore": (partial(tubes.bore, False), "target in a blind bore, the base outside, a mesh"),
    "square bore": (partial(tubes.bore, True), "target in a blind square bore, the base outside, boxes"),
    "door out": (cells.door_out, "base in a cell with one door, the target outside, boxes"),
    "door in": (cells.door_in, "target in a cell with one door, the base outside, boxes"),
    "door beside": (cells.door_beside, "base in a cell whose door is beside or behind it, boxes"),
    "two doors": (cells.two_doors, "two cells, and between them a door and one that is too narrow, boxes"),
    "cells": (partial(tubes.between_cells, True), "from cell to cell through a straight channel, boxes"),
    "cells pipe": (partial(tubes.between_cells, False), "from cell to cell through a bent pipe, boxes and a mesh"),
    "two tubes": (tubes.two_tubes, "base in one pipe, target in another, the open between them, meshes"),
    "funnel": (tubes.funnel, "target in a bent pipe whose mouth widens, the base outside, a mesh"),
    "branches": (tubes.branches, "base in a mouth of a pipe with a dead end on its way, a mesh"),
    "box duct": (tubes.box_duct, "a flat duct of rectangular section, from the base or beyond it, boxes"),
}
_JUDGING: dict[str, tuple[Trap, str]] = {
    "helix": (tubes.helix, "a helical pipe, open at both ends, the base before its mouth or in it, a mesh"),
    "bronchi": (tubes.bronchi, "a tree of tapering tubes, the base in its mouth, the target in a leaf, a mesh"),
    "stenosis": (tubes.stenosis, "a pipe with throats, the base before its mouth or in it, a mesh"),
    "lattice": (media.lattice, "struts along three axes, capsules"),
    "rubble": (media.rubble, "a heap of boxes and convex stones, meshes"),
    "bundle": (media.bundle, "parallel tubes as in a heat exchanger, cylinders"),
    "gyroid": (media.gyroid, "a porous solid with a tunnel, a mesh"),
    "slab": (media.slab, "two plates and pillars between them, half-spaces and cylinders"),
    "keyholes": (cells.keyholes, "thick walls with keyholes, meshes"),
    "nested": (cells.nested, "a cell within a cell, a door each, boxes"),
}
_CROWDS: dict[str, tuple[Trap, str]] = {
    "rods": (media.rods, "hundreds of rods thrown about, capsules"),
    "sheets": (media.sheets, "hundreds of thin sheets, boxes"),
    "hoops": (media.hoops, "hoops, some of which the shape is threaded through, hundreds of capsules"),
    "cables": (media.cables, "trays of curved cables, hundreds of capsules"),
    "profiles": (media.profiles, "a frame of hundreds of profiles, boxes and cylinders"),
    "assembly": (media.assembly, "hundreds of pieces of a machine, in one mesh or a mesh each"),
}
_LONG: dict[str, tuple[Trap, str]] = {"folded": (cells.folded, "20 segments folded in a cell before its door, boxes")}
_STAGED: dict[str, tuple[Draw, str]] = {
    "stage": (bases.staged, "on a stage of 3 to 50 segments' lengths, what is narrow about the target, or between")
}
_CARRIED: dict[str, tuple[Draw, str]] = {
    "six axes": (partial(bases.carried, bases.six_axes), "on an elbow robot of six axes, the same"),
    "driven base": (partial(bases.carried, bases.driven), "on a base that drives and turns, the same"),
    "rail": (partial(bases.carried, bases.railed), "on a rail, and rolled, the same"),
}
SCANNED_TRAPS = (
    *("open pipe 1.6", "pipe between", "guide tube", "channel", "bore"),
    *("door out", "door in", "door beside", "two doors", "cells", "cells pipe"),
)
MESHED = ("square bore", "door out", "door in", "door beside", "two doors", "cells", "folded")

_PUBLISHED: dict[str, tuple[Callable[[int], Place], str]] = {
    "p3": (polyhedra.fixed, "four scenes of balls, 3 inextensible segments, position and rotation"),
    "p4 direction": (
        partial(polyhedra.extensible, whole=False),
        "four scenes of balls, 3 to 6 extensible segments, position and direction",
    ),
    "p4 pose": (
        partial(polyhedra.extensible, whole=True),
        "four scenes of balls, 3 to 6 extensible segments, position and rotation",
    ),
}


_THIN: dict[str, tuple[Trap, str]] = {"hall": (cells.hall, "base in a hall of 1000 radii with one door, boxes")}
_SMALL: dict[str, tuple[Draw, str]] = {
    "small world": (cells.small_world, "any robot and shape, a door that it goes through, and boxes, quickly made")
}


def _for(
    robots: Callable[[int, Generator], Robot], traps: Mapping[str, tuple[Trap, str]]
) -> dict[str, tuple[Draw, str]]:
    """Traps as they are drawn for these robots."""
    return {name: (partial(trapped, trap, robots), words) for name, (trap, words) in traps.items()}


def _scans(drawn: Mapping[str, tuple[Draw, str]]) -> dict[str, tuple[Draw, str]]:
    return {f"{name} scan": (partial(scan, draw), f"a scan of {name}, a cloud") for name, (draw, _) in drawn.items()}


def _families() -> dict[str, Family]:
    """Places as they are drawn, as meshes, and as scans, each for its robots."""
    drawn = _DRAWN | _scans({name: _DRAWN[name] for name in SCANNED})
    traps = _for(various_robot, _TRAPS | _CROWDS) | _for(long_robot, _LONG) | _for(thin_robot, _THIN)
    traps |= {f"{name} mesh": (partial(meshed, traps[name][0]), f"a mesh of {name}") for name in MESHED}
    traps |= _scans(_for(stout_robot, {name: _TRAPS[name] for name in SCANNED_TRAPS}))
    traps |= _scans(_for(partial(long_robot, stout=True), _LONG))
    traps |= _SMALL | _for(various_robot, _JUDGING) | _STAGED | _CARRIED
    families = {
        # The name is part of what the draws begin with.
        name: Family(
            partial(settle, name, draw=draw),
            words,
            trap=name in traps,
            judging=name in _JUDGING,
            joints=name in _CARRIED,
        )
        for name, (draw, words) in (drawn | traps).items()
    }
    return families | {name: Family(made, words, published=True) for name, (made, words) in _PUBLISHED.items()}


FAMILIES = _families()
"""By their names, in the order of the benchmark."""
