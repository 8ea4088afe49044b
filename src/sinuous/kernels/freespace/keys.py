"""Cells by whole numbers: cubes of several sizes, those of each level twice as long as those of the level below.

Cells of level 0 are the finest. Their numbers (x, y, z) count them along the axes from the one about the origin; a cell
of level l has the numbers of those in it, shifted right by l. Its *key* is one number that says all that.
"""

BITS = 19
"""Of a key, for each of the three numbers."""

ORIGIN_NUMBER = 1 << (BITS - 1)
"""Numbers are counted from here, so that they are positive."""

MASK = 2 * ORIGIN_NUMBER - 1


def key_of(level: int, x: int, y: int, z: int) -> int:
    """Key of a cell."""
    return (
        (level << (3 * BITS))
        | ((x + ORIGIN_NUMBER) << (2 * BITS))
        | ((y + ORIGIN_NUMBER) << BITS)
        | (z + ORIGIN_NUMBER)
    )


def numbers_of(key: int) -> tuple[int, int, int, int]:
    """Level and the three numbers of a cell."""
    x, y, z = (key >> (2 * BITS)) & MASK, (key >> BITS) & MASK, key & MASK
    return key >> (3 * BITS), x - ORIGIN_NUMBER, y - ORIGIN_NUMBER, z - ORIGIN_NUMBER


def parent_of(key: int) -> int:
    """Key of the cell one level up that a cell lies in."""
    level, x, y, z = numbers_of(key)
    return int(key_of(level + 1, x >> 1, y >> 1, z >> 1))


def octant_of(x: int, y: int, z: int) -> int:
    """Which of its parent's eight children the cell with these numbers is."""
    return ((x & 1) << 2) | ((y & 1) << 1) | (z & 1)


def child_of(key: int, octant: int) -> int:
    """Key of one of the eight children of a cell."""
    level, x, y, z = numbers_of(key)
    return int(key_of(level - 1, 2 * x + (octant >> 2), 2 * y + ((octant >> 1) & 1), 2 * z + (octant & 1)))


def touch(one: int, other: int) -> bool:
    """Whether two cells have a face, an edge, a corner or more in common."""
    by, x, y, z = numbers_of(one)
    to, u, v, w = numbers_of(other)
    return (
        x << by <= (u + 1) << to
        and u << to <= (x + 1) << by
        and y << by <= (v + 1) << to
        and v << to <= (y + 1) << by
        and z << by <= (w + 1) << to
        and w << to <= (z + 1) << by
    )
