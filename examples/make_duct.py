"""Make duct.stl and duct_scan.xyz: run in this folder, `python make_duct.py`.

A duct in two bends with a closed far end, as a CAD program would export it (a closed surface, in millimetres), and what
a scanner in its mouth would see of its inner wall. The same seed makes the same files.
"""

import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SEED = 1
INNER, OUTER = 30.0, 34.0
"""Radii of the wall, mm."""
RINGS, AROUND = 34, 20
FOLDER = Path(__file__).parent


def centerline(count: int) -> tuple[Floats, Floats]:
    """Points and tangents (count, 3) of a curve in two planes: 60 mm straight, then two bends of 70 degrees."""
    s = np.linspace(-20.0, 420.0, 4401)
    first = np.radians(70.0) * np.clip((s - 60.0) / 160.0, 0.0, 1.0)
    second = np.radians(70.0) * np.clip((s - 220.0) / 160.0, 0.0, 1.0)
    tangents = np.stack([np.sin(first) * np.cos(second), np.sin(second), np.cos(first) * np.cos(second)], axis=-1)
    steps = 0.5 * (tangents[1:] + tangents[:-1]) * np.diff(s)[:, None]
    points = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)]) - [0.0, 0.0, 20.0]
    chosen = np.linspace(0, len(s) - 1, count).round().astype(int)
    return points[chosen], tangents[chosen]


def rings(radius: float, count: int, around: int) -> Floats:
    """Circles (count, around, 3) about the centerline, that turn about it as little as they can."""
    points, tangents = centerline(count)
    turn = 2.0 * np.pi * np.arange(around) / around
    x = np.array([1.0, 0.0, 0.0])
    circles = []
    for point, tangent in zip(points, tangents, strict=True):
        x = x - (x @ tangent) * tangent
        x /= np.linalg.norm(x)
        circle = np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * np.cross(tangent, x)
        circles.append(point + radius * circle)
    return np.stack(circles)


def triangles() -> Floats:
    """Corners (f, 3, 3) of the wall: outside from the closed end to the mouth, inside back again."""
    outer, inner = rings(OUTER, RINGS, AROUND)[::-1], rings(INNER, RINGS, AROUND)
    inner = inner[:-1]
    points, tangents = centerline(RINGS)
    skin = np.concatenate([outer, inner])
    following = np.roll(skin, -1, axis=1)
    a, b, c, d = skin[:-1], skin[1:], following[1:], following[:-1]
    wall = np.concatenate(
        [np.stack([a, b, c], axis=2).reshape(-1, 3, 3), np.stack([a, c, d], axis=2).reshape(-1, 3, 3)]
    )
    ends = []
    for center, first, second in (
        (points[-1], skin[0], following[0]),
        (points[-1] - (OUTER - INNER) * tangents[-1], following[-1], skin[-1]),
    ):
        ends.append(np.stack([np.broadcast_to(center, first.shape), first, second], axis=1))
    return np.concatenate([wall, *ends])


def write_stl(file: Path, corners: Floats) -> None:
    """Write a binary STL file."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    records = np.zeros(len(corners), [("numbers", "<f4", (4, 3)), ("attribute", "<u2")])
    records["numbers"] = np.concatenate([normals[:, None], corners], axis=1)
    file.write_bytes(b"duct, mm".ljust(80) + struct.pack("<I", len(corners)) + records.tobytes())


def scan() -> Floats:
    """Points (m, 3) on the inner wall, 5 mm apart and wrong by some tenths of a millimetre."""
    rng = np.random.default_rng(SEED)
    wall = rings(INNER, 85, 38)
    points, tangents = centerline(85)
    x, y = wall[-1, 0] - points[-1], wall[-1, 9] - points[-1]
    grid = np.stack(np.meshgrid(np.arange(-25.0, 26.0, 5.0), np.arange(-25.0, 26.0, 5.0)), axis=-1).reshape(-1, 2)
    grid = grid[np.linalg.norm(grid, axis=-1) < INNER] / INNER
    end = points[-1] - (OUTER - INNER) * tangents[-1] + grid[:, :1] * x + grid[:, 1:] * y
    exact = np.concatenate([wall[:-1].reshape(-1, 3), end])
    return exact + rng.normal(0.0, 0.2, exact.shape)


def main() -> None:
    """Write both files."""
    write_stl(FOLDER / "duct.stl", triangles())
    rows = [" ".join(f"{x:.1f}" for x in point) for point in scan().tolist()]
    (FOLDER / "duct_scan.xyz").write_text("\n".join(["# scan of a duct, mm", *rows, ""]))


if __name__ == "__main__":
    main()
