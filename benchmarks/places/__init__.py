"""Intricate places, made from seeds: robots in scenes with a target that a hidden shape is known to reach.

    from benchmarks.places import FAMILIES, make

    place = make("pipe 1.6", seed=7)
    Solver(place.robot, place.scene, tolerance=place.tolerance).solve(place.targets)

`make(family, seed)` returns a `Place`; `FAMILIES` lists the names with what they are. The same seed gives the same
place. Every twenty seeds in a row have all robots: 3, 5, 8, 12 and 20 segments, extensible or not, with an insertion
stage or without. Every place was judged when it was made: `place.hidden_q` is free, of obstacles and of itself, within
limits, and at the target. In "p3", "p4 direction" and "p4 pose" the scenes are the same four in turn, and shared:
places with the same `robot` and `scene` objects can share a `Solver`.

`parts` has robots and hidden shapes, `solids` surfaces; `tubes`, `cells` and `media` what stands about a shape. Traps
are narrow where a search begins or ends: there bodies are slender or thick, tapered, some with a tool or an
intermediate target that is asked for too.
"""

from benchmarks.places.families import FAMILIES, Family
from benchmarks.places.place import Place

__all__ = ["FAMILIES", "Family", "Place", "make"]


def make(family: str, seed: int) -> Place:
    """Make the place of a seed.

    Raises
    ------
    KeyError
        When there is no such family.
    """
    return FAMILIES[family].make(seed)
