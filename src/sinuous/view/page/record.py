"""A page as one file, in which everything stands still, or moves with a time slider."""

import html as markup
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from viser import ViserServer

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.scene.moving import Moving
from sinuous.scene.obstacles import Obstacle
from sinuous.view.display.bounds import best_view, bounds_of, direction_of, find_hiding, seen_places
from sinuous.view.display.contents import Arm, Contents, MovingArm
from sinuous.view.display.results import describe_solutions, status_in_words
from sinuous.view.display.style import CONTACT, FORCE, ROUTE, TIP_PATH, arm_tones
from sinuous.view.page import nodes
from sinuous.view.page.model import playing_speed

GHOST = 0.4
"""Opacity of a ghost."""

GRAIN_SPANS = 1e-4
"""Vertices of bodies that move are multiples of about this, in spans of the page: a recording is half as large."""

FEWEST_FRAMES, MOST_FRAMES = 60, 400
"""Frames of a motion: its knots, or between them where there are few, or some of them where there are many."""

MOST_LINES = 8
"""Lines of a caption."""

STYLE = """<style>
[aria-label$="scene tree"] { display: none !important; }
#sinuous-caption { position: fixed; left: 14px; top: 12px; z-index: 5; font: 13px/1.45 system-ui, sans-serif;
  color: #2f343a; pointer-events: none; white-space: pre-line; max-width: 70vw; }
</style>"""
"""Hides the tree of nodes, and places the caption."""


def record_page(contents: Contents) -> str:
    """Return a page that shows `contents`, as one HTML text that needs nothing else."""
    bounds = bounds_of(contents)
    server = nodes.open_server()
    try:
        nodes.aim_camera(server.initial_camera, bounds, direction_of(best_view(contents)))
        nodes.show_axes(server.scene, bounds)
        there, eye = contents.obstacles_at(0.0), np.array(server.initial_camera.position)
        in_front = find_hiding(there, seen_places(contents), eye[None])
        obstacles = nodes.Obstacles(server.scene, bounds)
        obstacles.show(there, hiding=in_front)
        for i, (target, place) in enumerate(contents.targets):
            nodes.show_target(server.scene, f"/targets/{i}", target, place, bounds.span)
        for i, mark in enumerate(contents.marks):
            nodes.show_ball(server.scene, f"/marks/{i}", mark, CONTACT, bounds.span, nodes.MARK_SIZE)
        for i, path in enumerate(contents.paths):
            nodes.show_line(server.scene, f"/paths/{i}", path, TIP_PATH, bounds.span)
        _show_forces(server, "forces", contents.forces, bounds.span)
        for i, route in enumerate(contents.routes):
            nodes.show_line(server.scene, f"/routes/{i}", route, ROUTE, bounds.span)
        for i, (arm, ghost) in enumerate(zip(contents.arms, ghosts_of(contents.arms), strict=True)):
            body = nodes.BodyNode(
                server.scene, f"/robots/{i}", arm.robot, nodes.BodyStyle(bounds.span, opacity=GHOST if ghost else None)
            )
            body.show(arm.q, nodes.colours_of(arm))
        page = _show_moving(server, contents, bounds.span, partial(obstacles.show, hiding=in_front))
    finally:
        nodes.close_server(server)
    return _finished(page, contents)


def frames_of(moving: MovingArm) -> tuple[Floats, Floats]:
    """Configurations (f, n, 3) of a motion that are shown, and their times (f,) in seconds from its begin."""
    times = np.asarray(moving.times, np.float64) - moving.times[0]
    times /= playing_speed(float(times[-1]))
    count = len(times)
    if FEWEST_FRAMES <= count <= MOST_FRAMES:
        return moving.q, times
    shares = np.linspace(0.0, 1.0, max(FEWEST_FRAMES, min(count, MOST_FRAMES)))
    return np.stack([moving.at(float(share)).q for share in shares]), shares * times[-1]


def ghosts_of(arms: Sequence[Arm]) -> list[bool]:
    """Which bodies are ghosts on a page, also those of a robot whose body is there in another configuration."""
    first = {id(arm.owner): arm.number for arm in reversed(arms)}
    return [arm.ghost or arm.number != first[id(arm.owner)] for arm in arms]


def _show_moving(
    server: ViserServer, contents: Contents, span: float, show_obstacles: Callable[[list[Obstacle]], None]
) -> str:
    """Show what moves, frame by frame, and return the page with everything on it."""
    if not contents.moving:
        return server.get_scene_serializer().as_html()
    grain = 2.0 ** math.floor(math.log2(GRAIN_SPANS * span))
    bodies = []
    for i, moving in enumerate(contents.moving):
        robot = moving.begin.robot
        opacity = GHOST if moving.ghost else None
        look = nodes.BodyStyle(span, opacity=opacity, grain=grain, along=max(1, min(10, 80 // len(robot))))
        colours = nodes.colours_of(moving.begin)
        body = nodes.BodyNode(server.scene, f"/motions/{i}", robot, look)
        bodies.append((body, *frames_of(moving), colours))
        body.show(bodies[i][1][0], colours)
        _show_forces(server, f"forces of {i}", moving.forces_at(0.0), span)
    times = max((own for _, _, own, _ in bodies), key=lambda each: each[-1])
    first = float(bodies[0][2][-1])
    others = any(isinstance(obstacle, Moving) for obstacle in contents.obstacles)
    recording = server.get_scene_serializer()
    for before, now in pairwise(times.tolist()):
        recording.insert_sleep(now - before)
        for i, (body, q, own_times, colours) in enumerate(bodies):
            body.show(q[min(int(np.searchsorted(own_times, now)), len(q) - 1)], colours)
            forces = contents.moving[i].forces_at(min(1.0, now / own_times[-1]))
            _show_forces(server, f"forces of {i}", forces, span)
        if others:
            show_obstacles(contents.obstacles_at(min(1.0, now / first)))
    recording.insert_sleep(float(times[-1] - times[-2]))
    return recording.as_html()


def _show_forces(server: ViserServer, name: str, forces: Sequence[Floats], span: float) -> None:
    for i, force in enumerate(forces):
        nodes.show_line(server.scene, f"/{name}/{i}", force, FORCE, 2.0 * span)


def _finished(page: str, contents: Contents) -> str:
    """Put a title, a caption and our style into a page of viser."""
    lines = "\n".join(list(_caption(contents))[:MOST_LINES])
    caption = f'<div id="sinuous-caption">{lines}</div>' if lines else ""
    title, end = page.index("<title>") + len("<title>"), page.index("</title>")
    page = page[:title] + "Sinuous" + page[end:]
    return page.replace("</head>", STYLE + "</head>", 1).replace("</body>", caption + "</body>", 1)


def _caption(contents: Contents) -> Iterator[str]:
    """Yield a line for each answer; of several solutions with the colour of its robot."""
    solutions = [answer for answer in contents.answers if isinstance(answer, Solution)]
    if len(contents.robots) != len(solutions) or len(solutions) < 2:
        yield from (markup.escape(str(answer).split("\n", maxsplit=1)[0]) for answer in contents.answers)
        return
    for i, (solution, line) in enumerate(zip(solutions, describe_solutions(solutions), strict=True)):
        dot = f'<span style="color:{arm_tones(solution.solved, i)[0]}">\u25cf</span>'
        yield f"{dot} {markup.escape(f'{line}, {status_in_words(solution.status)}')}"
