"""A page in one file: everything stands still, or moves with a time slider."""

import html as markup
import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from viser import ViserServer

from sinuous.checks import Floats
from sinuous.pictures.contents import Arm, Contents, Moving
from sinuous.pictures.style import ROUTE, TIP_PATH
from sinuous.scene.courses.moving import Moving as MovingObstacle
from sinuous.viewer.drawing.colours import tones
from sinuous.viewer.drawing.obstacles import Obstacles
from sinuous.viewer.drawing.robots import Body, Look
from sinuous.viewer.drawing.stage import Frame, close_server, open_server
from sinuous.viewer.drawing.targets import show_line, show_target
from sinuous.viewer.pace import pace

THINNEST = 0.006
"""Least radius of a body, in spans of the page."""

GHOST = 0.4
"""Opacity of a ghost."""

GRAIN = 1e-4
"""Places of bodies that move are multiples of about this, in spans of the page: a recording is half as large."""

FEWEST_FRAMES, MOST_FRAMES = 60, 400
"""Frames of a motion: its knots, or between them where there are few, or some of them where there are many."""


STYLE = """<style>
[aria-label$="scene tree"] { display: none !important; }
#sinuous-caption { position: fixed; left: 14px; top: 12px; z-index: 5; font: 13px/1.45 system-ui, sans-serif;
  color: #2f343a; pointer-events: none; white-space: pre-line; max-width: 70vw; }
</style>"""
"""What no reader of the page has a use for is hidden."""


def record(contents: Contents) -> str:
    """Return a page that shows `contents`."""
    server = open_server()
    try:
        frame = Frame(_seen(contents), contents.obstacles)
        frame.look(server)
        obstacles = Obstacles(server.scene, frame.view)
        obstacles.show(contents.obstacles_at(0.0))
        for i, asked in enumerate(contents.asked):
            show_target(server.scene, f"/targets/{i}", asked.target, asked.end[:3, 3], frame.span)
        for i, path in enumerate(contents.paths):
            if len(path) > 1:
                show_line(server.scene, f"/paths/{i}", path, TIP_PATH, 0.003 * frame.span)
        for i, route in enumerate(contents.routes):
            show_line(server.scene, f"/routes/{i}", route, ROUTE, 0.003 * frame.span)
        _show_standing(server, contents.arms, frame.span)
        page = _show_moving(server, contents, frame.span, obstacles)
    finally:
        close_server(server)
    return _finished(page, contents)


def frames_of(moving: Moving) -> tuple[Floats, Floats]:
    """Configurations (f, n, 3) of a motion that are shown, and their times (f,) in seconds from its begin."""
    times = np.asarray(moving.times, np.float64) - moving.times[0]
    times /= pace(float(times[-1]))
    count = len(times)
    if FEWEST_FRAMES <= count <= MOST_FRAMES:
        return moving.q, times
    shares = np.linspace(0.0, 1.0, max(FEWEST_FRAMES, min(count, MOST_FRAMES)))
    return np.stack([moving.at(float(share)).q for share in shares]), shares * times[-1]


def ghosts_of(arms: Sequence[Arm]) -> list[bool]:
    """Which robots are ghosts: those after the first of the same robot."""
    seen: list[object] = []
    result = []
    for arm in arms:
        result.append(any(arm.robot is robot for robot in seen))
        seen.append(arm.robot)
    return result


def _seen(contents: Contents) -> list[Floats]:
    """Places that must be on the page: of the first thing the base first, its tip last."""
    bodies = [arm.robot.backbone(arm.q) for arm in contents.all_arms]
    ways = [moving.robot.backbone(frames_of(moving)[0]) for moving in contents.moving]
    bases = [arm.robot.base[None, :3, 3] for arm in contents.all_arms[:1]]
    return [*bases, *ways, *(asked.end[None, :3, 3] for asked in contents.asked), *contents.paths, *bodies]


def _show_standing(server: ViserServer, arms: list[Arm], span: float) -> None:
    for i, (arm, ghost) in enumerate(zip(arms, ghosts_of(arms), strict=True)):
        look = Look(THINNEST * span, opacity=GHOST if ghost else None)
        Body(server.scene, f"/robots/{i}", arm.robot, look).show(arm.q, tones(len(arm.robot), arm.solved, i))


def _show_moving(server: ViserServer, contents: Contents, span: float, obstacles: Obstacles) -> str:
    """Show what moves, frame by frame, and return the page with everything on it."""
    motions, first = contents.moving, len(contents.arms)
    others = any(isinstance(obstacle, MovingObstacle) for obstacle in contents.obstacles)
    if not motions:
        return server.get_scene_serializer().as_html()
    grain = 2.0 ** math.floor(math.log2(GRAIN * span))
    bodies, ways = [], []
    for i, moving in enumerate(motions):
        steps = max(1, min(10, 80 // len(moving.robot)))
        look = Look(THINNEST * span, grain=grain, along=steps)
        bodies.append(Body(server.scene, f"/motions/{i}", moving.robot, look))
        ways.append(frames_of(moving))
    colours = [tones(len(m.robot), m.solved, first + i) for i, m in enumerate(motions)]
    times = max((way[1] for way in ways), key=lambda each: each[-1])
    for body, (q, _), own in zip(bodies, ways, colours, strict=True):
        body.show(q[0], own)
    recording = server.get_scene_serializer()
    for before, now in pairwise(times.tolist()):
        recording.insert_sleep(now - before)
        for body, (q, own_times), own in zip(bodies, ways, colours, strict=True):
            body.show(q[min(int(np.searchsorted(own_times, now)), len(q) - 1)], own)
        if others:
            obstacles.show(contents.obstacles_at(min(1.0, now / float(ways[0][1][-1]))))
    recording.insert_sleep(float(times[-1] - times[-2]))
    return recording.as_html()


def _finished(page: str, contents: Contents) -> str:
    """Put a title, a caption and our style into a page of viser."""
    lines = [str(answer).split("\n", maxsplit=1)[0] for answer in contents.answers[:3]]
    title = "Sinuous"
    head = page.index("</head>")
    page = page[:head] + STYLE + page[head:]
    start, end = page.index("<title>"), page.index("</title>")
    page = page[: start + len("<title>")] + title + page[end:]
    body = page.index("</body>")
    caption = f'<div id="sinuous-caption">{markup.escape(chr(10).join(lines))}</div>' if lines else ""
    return page[:body] + caption + page[body:]
