"""Make the scene and the path of path_through_spheres.yaml: run in this folder, `python make_path_through_spheres.py`.

A closed curve on the far side of forty spheres. The spheres lie between the robot and the curve, at random, and keep
away from the curve and from where the robot leaves its base. The same seed makes the same files.
"""

from pathlib import Path

import numpy as np

SEED, SPHERES, POINTS = 4, 40, 180
FOLDER = Path(__file__).parent
HEAD = """\
# Follow a curve of 180 points on the far side of forty spheres; the direction of the tip is free.
# Made by make_path_through_spheres.py.
#
#     sinuous track examples/path_through_spheres.yaml --plot track.png

robot:
  segments: {count: 8, length: [0.9, 1.1], max_bend: 1.5}
  radius: 0.08
path: path_through_spheres.csv
scene:
"""


def main() -> None:
    """Write both files."""
    turn = np.linspace(0.0, 2.0 * np.pi, POINTS, endpoint=False)
    curve = np.stack([2.6 * np.sin(turn), 1.6 * np.sin(2.0 * turn), 6.0 + 0.5 * np.cos(turn)], axis=-1).round(4)
    rng = np.random.default_rng(SEED)
    lines = []
    while len(lines) < SPHERES:
        center, radius = rng.uniform((-3.0, -3.0, 1.5), (3.0, 3.0, 5.5)).round(3), round(rng.uniform(0.15, 0.45), 3)
        if np.linalg.norm(curve - center, axis=-1).min() > radius + 0.4 and np.hypot(*center[:2]) > radius + 0.2:
            lines.append(f"  - sphere: {{center: {center.tolist()}, radius: {radius}}}\n")
    (FOLDER / "path_through_spheres.yaml").write_text(HEAD + "".join(lines))
    rows = [",".join(map(str, point)) for point in curve.tolist()]
    (FOLDER / "path_through_spheres.csv").write_text("\n".join(["x,y,z", *rows, ""]))


if __name__ == "__main__":
    main()
