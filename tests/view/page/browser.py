"""A page of the viewer in a real browser: Debian's Chromium with software WebGL, driven by Playwright."""

import io
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.helpers import Floats

CHROMIUM = Path("/usr/bin/chromium")
FLAGS = (
    "--no-sandbox",
    "--enable-unsafe-swiftshader",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--disable-gpu-compositing",  # panels as pictures of WebGL, too, took half of the processor time
    "--no-first-run",
    "--disable-quic",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
)
ROUGH = """
    const own = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, words) {
        return own.call(this, kind, {...words, antialias: false});
    };
    const draw = requestAnimationFrame;
    window.requestAnimationFrame = act => setTimeout(() => draw(act), 180);
    window.cancelAnimationFrame = clearTimeout;
"""
"""Lets the page draw without smooth edges, which software draws four times for, and at most 6 pictures a second."""

SIZE = (900, 560)
COARSE = 2
"""Units of the page to a pixel: software draws four times as fast as with one."""

PATIENCE = 300.0
"""Seconds: kernels may have to be compiled first, and on a busy machine software takes many to draw a picture."""

REOPENED = 5e3
"""Milliseconds after which a list is opened again."""


@contextmanager
def chromium() -> Iterator[Any]:
    """Start a browser; without one the test is skipped."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="needs Playwright: pip install playwright")
    if not CHROMIUM.exists():
        pytest.skip("needs Chromium: apt-get install chromium")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=str(CHROMIUM), args=list(FLAGS))
        yield browser
        browser.close()


def opened(browser: Any, address: str) -> Any:
    """Open an address, and wait until it shows something."""
    tab = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]}, device_scale_factor=1.0 / COARSE)
    tab.set_default_timeout(1e3 * PATIENCE)
    tab.add_init_script(ROUGH)
    tab.problems = []
    tab.on("pageerror", lambda error: tab.problems.append(str(error)))
    tab.goto(address)
    tab.wait_for_selector("canvas")
    close = tab.locator(".mantine-Notification-closeButton")  # that WebGL runs in software is no news here
    close.first.click()
    return tab


def choose(tab: Any, label: str, entry: str) -> None:
    """Choose an entry of a list; where the page is made anew meanwhile the list closes, and is opened again."""
    from playwright.sync_api import TimeoutError as TooLate

    option = tab.get_by_role("option", name=entry, exact=True)

    def chosen() -> bool:
        if not option.is_visible():
            tab.get_by_role("combobox", name=label, exact=True).click()
        try:
            option.click(timeout=REOPENED)
        except TooLate:
            return False
        return True

    until(chosen, f"{entry!r} of {label!r}")


def inputs(tab: Any, label: str) -> Any:
    """The fields for numbers beside a label."""
    return tab.locator(f"//label[.='{label}']/ancestor::div[contains(@class, 'Flex-root')][1]//input")


def until(holds: Callable[[], object], what: str) -> None:
    """Wait until something holds."""
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end, f"did not come: {what}"
        time.sleep(0.05)


def frames(tab: Any, count: int) -> None:
    """Wait until the browser has drawn so many pictures."""
    next_ones = (
        "count => new Promise(done => { const next = () => count-- ? requestAnimationFrame(next) : done(); next(); })"
    )
    tab.evaluate(next_ones, count)


def pixels(tab: Any) -> NDArray[np.uint8]:
    """What the browser shows, (height, width, 3)."""
    from matplotlib.image import imread

    picture = imread(io.BytesIO(tab.screenshot()), format="png")
    return np.asarray(np.round(255.0 * picture[..., :3]), np.uint8).repeat(COARSE, axis=0).repeat(COARSE, axis=1)


def projected(camera: Any, point: Floats) -> tuple[float, float]:
    """Where a camera of the page sees a point, in pixels from the upper left corner of the canvas."""
    forward = camera.look_at - camera.position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.up_direction)
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    seen = point - camera.position
    unit = 0.5 * camera.image_height / np.tan(0.5 * camera.fov)
    depth = float(seen @ forward)
    x = 0.5 * camera.image_width + unit * float(seen @ right) / depth
    return x, 0.5 * camera.image_height + unit * float(seen @ down) / depth
