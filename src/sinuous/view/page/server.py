"""The server behind a page: its camera and its light; it says nothing on standard output."""

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import rich
from viser import CameraHandle, InitialCameraConfig, ViserServer

from sinuous.base.checks import Floats
from sinuous.view.display.bounds import Bounds

FIELD = math.radians(40.0)
"""Angle that the camera sees, from top to bottom."""


MARGIN = 1.1
"""How far a camera is away, relative to where what is shown fills the view: numbers and names of axes need room."""


def aim(camera: CameraHandle | InitialCameraConfig, bounds: Bounds, side: Floats) -> None:
    """Let a camera show all of the bounds from the side that a unit vector (3,) leads to."""
    right = np.cross((0.0, 0.0, 1.0), side)
    right = right / np.linalg.norm(right) if right.any() else np.array([1.0, 0.0, 0.0])
    corners = (np.array(list(np.ndindex(2, 2, 2))) - 0.5) * (bounds.high - bounds.low)
    across = np.abs(corners @ np.stack([right, np.cross(side, right)], axis=-1)).max(axis=-1)
    away = MARGIN * (float((corners @ side + across / math.tan(0.5 * FIELD)).max()) or 1.0)
    camera.position, camera.look_at, camera.fov = bounds.middle + away * side, bounds.middle, FIELD
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


def open_server(host: str = "127.0.0.1", port: int = 0) -> ViserServer:
    """Start a server with an empty scene and none of viser's own signs.

    `port` 0: any that is free.
    """
    with quiet():
        server = ViserServer(host=host, port=port, label="Sinuous", verbose=False)
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
