"""Make pictures of the documentation: `python docs/figures.py`, or names of some."""

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.patches import Circle
from PIL import Image

import sinuous as sn
from sinuous.view.display.bounds import best_view
from sinuous.view.display.contents import gather
from sinuous.view.display.results import caption_of
from sinuous.view.display.style import ARMS, CURVES, GRID, INK, OBSTACLE, PALE, TARGET
from sinuous.view.pictures.diagrams import finish_axes
from sinuous.view.pictures.figures import axes_box, fill_room, new_figure
from sinuous.view.pictures.plot import draw_contents, draw_still
from sinuous.view.pictures.reports import write_picture

ROOT = Path(__file__).parent.parent
IMAGES, EXAMPLES = ROOT / "docs" / "images", ROOT / "examples"

COLOURS = 160
"""Of a picture: what these pictures have, and a third of the bytes."""

DPI = 110


def save(figure: Any, name: str) -> None:
    """Write a figure as a small PNG."""
    file = IMAGES / f"{name}.png"
    figure.savefig(file, dpi=DPI)
    shrink(file)


def shrink(file: Path, share: float = 1.0) -> None:
    """Make a picture smaller, and give it few colours."""
    with Image.open(file) as opened:
        image = opened.convert("RGB")
    image = image.resize(
        (round(image.width * share), round(image.height * share)),
        Image.Resampling.LANCZOS,
    )
    image.quantize(
        COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
    ).save(file, optimize=True)


def shape(name: str, *things: Any) -> None:
    """Draw things as `--plot` does."""
    save(draw_still(gather(things)), name)


def insertion_room() -> None:
    """An example."""
    shape("insertion_room", sn.load(EXAMPLES / "insertion_room.yaml").solve())


def duct() -> None:
    """An example."""
    shape("duct", sn.load(EXAMPLES / "duct.yaml").solve())


def duct_scan() -> None:
    """An example."""
    shape("duct_scan", sn.load(EXAMPLES / "duct_scan.yaml").solve())


def gripper() -> None:
    """An example."""
    shape("gripper", sn.load(EXAMPLES / "gripper_and_elbow.yaml").solve())


def joints() -> None:
    """What a guide solves."""
    names: dict[str, Any] = {}
    page = (ROOT / "docs" / "guides" / "joints.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    for name, block in zip(("bronchoscope", "six_axis", "rover"), blocks, strict=False):
        exec(block, names)
        shape(name, names["solution"])


def path_through_spheres() -> None:
    """An example: the picture of `--plot`, and the animation of the README."""
    motion = sn.load(EXAMPLES / "path_through_spheres.yaml").track(
        prefer=sn.Preferences(clearance=0.2)
    )
    write_picture(IMAGES / "path_through_spheres.png", motion)
    shrink(IMAGES / "path_through_spheres.png", 0.67)
    view = best_view(gather([motion]))
    sn.view.animate(
        motion, path=IMAGES / "path_through_spheres.gif", view=view, seconds=6, fps=15
    )


def first_steps() -> None:
    """The arm of the first steps."""
    arm = sn.Robot.uniform(5, length=(45, 70), max_bend=2.4, radius=4)
    scene = [
        sn.Sphere((0, 80, 120), radius=25),
        sn.Box((-70, 110, 60), size=(60, 60, 120)),
    ]
    shape(
        "first_steps",
        sn.solve(arm, sn.Target((-60, 150, 170), direction=(0, 1, -1)), scene),
    )


def tendons() -> None:
    """An arm with spacers: its shape, and what its tendons do on a circle."""
    section = sn.Segment(80, max_bend=1.6, radius=6, tendons=sn.Tendons(3, radius=5))
    spacer = sn.Segment(12, max_bend=0, radius=8)
    arm = sn.Robot([section, spacer, section, spacer, section], name="arm")
    turn = np.linspace(0.0, 2.0 * np.pi, 61)
    ring = np.stack([90 * np.cos(turn), 90 * np.sin(turn), np.full(61, 170.0)], axis=-1)
    motion = sn.track(arm, positions=ring, start=sn.solve(arm, sn.Target(ring[0])))
    shape("tendons", motion)
    figure = new_figure(figsize=(6.4, 3.4), layout="constrained")
    sn.view.diagram(motion, "actuators", ax=figure.add_subplot())
    save(figure, "tendons_actuators")


def alternatives() -> None:
    """Two ways past a pillar."""
    arm = sn.Robot.uniform(5, length=(45, 70), max_bend=2.4, radius=5)
    pillar = sn.Capsule((0, 75, 0), (0, 75, 240), radius=16, name="pillar")
    shape(
        "alternatives", sn.solve_all(arm, sn.Target((0, 150, 150)), [pillar], count=2)
    )


def unsolved() -> None:
    """The best shape where there is none."""
    arm = sn.Robot.uniform(3, length=(45, 70), max_bend=1.2, radius=4)
    shape(
        "unsolved",
        sn.solve(arm, sn.Target((120, 0, 190)), [sn.Sphere((60, 10, 120), radius=30)]),
    )


def clearance() -> None:
    """Along the body, and of the body on its way."""
    room = sn.load(EXAMPLES / "insertion_room.yaml").solve()
    motion = sn.load(EXAMPLES / "path_through_spheres.yaml").track(
        prefer=sn.Preferences(clearance=0.2)
    )
    figure = new_figure(figsize=(10.4, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    sn.view.diagram(room, "clearance", ax=left)
    sn.view.diagram(motion, "clearance map", ax=right)
    save(figure, "clearance")


def convergence() -> None:
    """How two methods of the literature come to a pose."""
    arm = sn.Robot.uniform(3, length=80, max_bend=2.4)
    target = sn.Target((90, 60, 160))
    figure = new_figure(figsize=(10.4, 3.6), layout="constrained")
    for axes, method in zip(figure.subplots(1, 2), ("dls", "fabrikc"), strict=True):
        tight = sn.Tolerance(1e-6)
        sn.view.diagram(
            sn.solve(arm, target, method=method, tolerance=tight),
            "convergence",
            ax=axes,
        )
    save(figure, "convergence")


def arcs() -> None:
    """One segment at several bends and lengths."""
    segment = sn.Robot.uniform(1, (60, 100), max_bend=np.pi, radius=5)
    things: list[Any] = []
    for i, (bend, length) in enumerate(
        [(0.0, 80.0), (0.8, 80.0), (1.6, 80.0), (2.4, 80.0), (1.6, 100.0)]
    ):
        base = sn.pose((100.0 * i, 0.0, 0.0))
        things += [segment.changed(base=base), np.array([[bend, 0.0, length]])]
    save(draw_still(gather(things)), "arcs")


def proofs() -> None:
    """Balls that prove a body clear: as large as the distance in their middle says."""
    arm = sn.Robot.uniform(3, length=80, radius=7)
    q = np.array([[1.2, 0.0, 80.0], [-1.3, 0.0, 80.0], [-0.9, 0.0, 80.0]])
    balls = [
        sn.Sphere((70, 0, 40), 22),
        sn.Sphere((10, 0, 105), 20),
        sn.Sphere((105, 0, 160), 18),
    ]
    scene = sn.Scene(balls)
    line = arm.backbone(q, 256)
    figure = new_figure(figsize=(6.4, 5.2), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    for ball in balls:
        axes.add_patch(
            Circle((ball.center[0], ball.center[2]), ball.radius, color=OBSTACLE)
        )
    axes.plot(
        *line[:, ::2].T,
        color=ARMS[0][1],
        linewidth=17,
        alpha=0.5,
        solid_capstyle="round",
    )
    axes.plot(*line[:, ::2].T, color=ARMS[0][0], linewidth=1.5)
    for begin, end in _proved_pieces(scene, line, 7.0, 0, len(line) - 1):
        middle = line[(begin + end) // 2]
        axes.add_patch(
            Circle(
                middle[::2],
                scene.distance(middle),
                fill=False,
                color=CURVES[2],
                linewidth=1.0,
            )
        )
        axes.plot(*middle[::2], "o", color=TARGET, markersize=3.0)
    axes.set(xlim=(-60, 150), ylim=(-30, 210))
    finish_axes(axes, "", x="x", y="z")
    axes.grid(color=GRID)
    count = len(_proved_pieces(scene, line, 7.0, 0, len(line) - 1))
    axes.set_title(f"{count} balls prove this body clear", color=INK)
    axes.tick_params(labelcolor=PALE)
    save(figure, "proofs")


def _proved_pieces(
    scene: sn.Scene, line: Any, radius: float, begin: int, end: int
) -> list[tuple[int, int]]:
    """Halve a piece of the backbone until the distance in its middle decides."""
    step = float(np.linalg.norm(line[1] - line[0]))
    middle = (begin + end) // 2
    if scene.distance(line[middle]) > 0.5 * step * (end - begin) + radius:
        return [(begin, end)]
    return [
        *_proved_pieces(scene, line, radius, begin, middle),
        *_proved_pieces(scene, line, radius, middle, end),
    ]


PLACES = {
    **{"spheres 40": 6, "pipe 1.3": 1, "plates": 16, "drum": 1, "shelf": 1},
    **{"duct": 1, "spheres 40 scan": 6, "pipe 1.6 scan": 7, "plates scan": 1},
    **{"drum scan": 1, "shelf scan": 1, "duct scan": 1},
}
"""Families of intricate places, and the number of the place that stands for each."""


def places() -> None:
    """One place of each kind."""
    sys.path.append(str(ROOT))
    from benchmarks.places import make  # noqa: PLC0415

    rows, panels = -(-len(PLACES) // 4), []
    figure = new_figure(figsize=(16.8, 4.2 * rows), layout="constrained")
    for i, (family, number) in enumerate(PLACES.items(), 1):
        place = make(family, number)
        solver = sn.Solver(place.robot, place.scene, tolerance=place.tolerance)
        solver.solve(place.targets)  # what is loaded is not counted
        contents = gather([solver.solve(place.targets)])
        axes = figure.add_subplot(rows, 4, i, projection="3d", computed_zorder=False)
        panels.append((axes, axes_box(contents)))
        draw_contents(axes, contents, panels[-1][1], best_view(contents))
        axes.set_axis_off()
        axes.set_title(f"{family}\n{caption_of(contents.answers)}", fontsize=10)
    figure.canvas.draw()  # puts the panels in their places
    figure.set_layout_engine("none")
    for axes, box in panels:
        fill_room(axes, box)
    figure.savefig(file := IMAGES / "places.png", dpi=80)
    shrink(file)


FIGURES: dict[str, Callable[[], None]] = {
    figure.__name__: figure
    for figure in (
        insertion_room,
        duct,
        duct_scan,
        gripper,
        joints,
        path_through_spheres,
        first_steps,
        tendons,
        alternatives,
        unsolved,
        clearance,
        convergence,
        arcs,
        proofs,
        places,
    )
}

if __name__ == "__main__":
    for wanted in sys.argv[1:] or FIGURES:
        FIGURES[wanted]()
