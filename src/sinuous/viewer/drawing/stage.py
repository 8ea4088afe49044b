"""Where a page looks, and the server behind it, which says nothing on standard output."""

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import rich
from viser import ViserServer

from sinuous.checks import Floats
from sinuous.scene.extents import box_of
from sinuous.scene.obstacles import Obstacle
from sinuous.viewer.drawing.obstacles import View

FIELD = math.radians(40.0)
"""Angle that the camera sees, from top to bottom."""

ELEVATION = math.radians(22.0)
ASIDE = math.radians(-65.0)
"""Where the camera stands: above the horizon, and from the direction in which the robot reaches."""

ROOM = 0.12
"""How much around the robots is shown of obstacles that go on, in sizes of the robots."""


class Frame:
    """The part of the world that a page shows.

    Parameters
    ----------
    points : iterable of ndarray (k, 3)
        What must be seen: bodies, targets.
    obstacles : sequence of Obstacle
        What is near of these is seen, too.
    """

    def __init__(self, points: Iterable[Floats], obstacles: Sequence[Obstacle]) -> None:
        boxes = [box for box in map(box_of, obstacles) if box is not None]
        seen = [np.asarray(part).reshape(-1, 3) for part in points]
        own = np.concatenate(seen) if seen else np.concatenate([*boxes, np.zeros((1, 3))])
        low, high = own.min(axis=0), own.max(axis=0)
        reach = ROOM * float((high - low).max()) if seen else math.inf
        for box in boxes:
            low = np.minimum(low, np.maximum(box[0], own.min(axis=0) - reach))
            high = np.maximum(high, np.minimum(box[1], own.max(axis=0) + reach))
        self.middle: Floats = 0.5 * (low + high)
        self.span = max(float((high - low).max()), 1e-12)
        self._radius = 0.5 * float(np.linalg.norm(high - low)) or 0.5
        side = own[-1] - own[0]
        self._azimuth = math.atan2(side[1], side[0]) + ASIDE

    @property
    def view(self) -> View:
        """What is looked at."""
        return View(self.middle, self.span)

    def look(self, server: ViserServer) -> None:
        """Let the camera of the page show all of it."""
        away = 0.98 * self._radius / math.sin(0.5 * FIELD)
        flat = math.cos(ELEVATION)
        side = np.array([flat * math.cos(self._azimuth), flat * math.sin(self._azimuth), math.sin(ELEVATION)])
        camera = server.initial_camera
        camera.position, camera.look_at, camera.fov = self.middle + away * side, self.middle, FIELD
        camera.near, camera.far = 0.01 * away, 100.0 * away


@contextmanager
def quiet() -> Iterator[None]:
    """Keep viser from printing where it listens and that it stopped."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before


def open_server(host: str = "127.0.0.1", port: int = 0, label: str = "Sinuous") -> ViserServer:
    """Start a server with an empty scene and none of viser's own signs.

    `port` 0: any that is free.
    """
    with quiet():
        server = ViserServer(host=host, port=port, label=label, verbose=False)
    server.gui.configure_theme(show_logo=False, show_share_button=False)
    server.scene.world_axes.visible = False
    light(server)
    server.request_share_url = lambda verbose=True: None  # type: ignore[method-assign]  # no page may open a tunnel
    return server


def light(server: ViserServer) -> None:
    """Light the scene evenly and without shadows: clear colours, and quick where pages are drawn in software."""
    scene = server.scene
    scene.configure_environment_map(None)
    scene.configure_default_lights(False)
    scene.add_light_ambient("/light/all", intensity=0.6)
    scene.add_light_hemisphere("/light/sky", sky_color=(255, 255, 255), ground_color=(150, 155, 165), intensity=1.0)
    for name, side, strength in (("left", (-1.0, -2.0, 3.0), 1.5), ("right", (2.0, 1.0, 1.0), 0.7)):
        scene.add_light_directional(f"/light/{name}", intensity=strength, position=side)


def close_server(server: ViserServer) -> None:
    """Stop a server."""
    with quiet():
        server.stop()
