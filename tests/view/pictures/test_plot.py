"""Pictures show what they were given, where it is, and touch nothing that the caller has chosen."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.view.display.style import ARMS, ROUTE, TARGET, UNSOLVED
from tests.helpers import Floats, refused
from tests.view.pictures.arms import PATH, ROBOT, SCENE, TARGETS

matplotlib = pytest.importorskip("matplotlib")


def pixels(axes: Any) -> Floats:
    axes.figure.canvas.draw()
    return np.asarray(axes.figure.canvas.buffer_rgba())[..., :3] / 255.0


def at(axes: Any, places: Any) -> Floats:
    """Colours (m, 3) of the pixels where places (m, 3) are drawn."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform

    image = pixels(axes)
    x, y, _ = proj_transform(*np.transpose(places), axes.get_proj())
    column, row = axes.transData.transform(np.stack([x, y], axis=-1)).T
    colours: Floats = image[image.shape[0] - 1 - row.astype(int), column.astype(int)]
    return colours


def is_blue(colours: Floats) -> Any:
    return colours[..., 2] > colours[..., 0] + 0.15


def surfaces(axes: Any) -> Any:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    return [each for each in axes.collections if isinstance(each, Poly3DCollection)]


def test_a_robot_is_where_it_is() -> None:
    q = np.array([[0.5, 0.2, 1.0], [0.0, 0.9, 1.1], [-0.5, 0.0, 0.9]])
    axes = sn.plot(ROBOT, q)
    backbone = ROBOT.backbone(q)[6:]  # beyond the mount
    assert is_blue(at(axes, backbone)).mean() > 0.95
    assert not is_blue(at(axes, backbone + np.array([0.3, 0.3, 0.0]))).any()
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    assert (backbone > low).all()
    assert (backbone < high).all()
    np.testing.assert_allclose(ROBOT.backbone(q).max(axis=0), high, atol=0.6)


def test_what_is_not_solved_has_another_colour() -> None:
    axes = sn.plot(sn.solve(ROBOT, sn.Target((0, 0, 9))))
    assert axes.figure.texts[-1].get_text().startswith("out of reach")
    tones = surfaces(axes)[0].get_facecolor()[:, :3]
    warm = tones[:, 0] > tones[:, 2] + 0.15
    assert warm.mean() > 0.5
    assert ARMS[0] != UNSOLVED


def test_a_motion_has_ghosts_and_the_path_of_its_tip() -> None:
    track = sn.track(ROBOT, PATH)
    axes = sn.plot(track)
    alphas = surfaces(axes)[0].get_facecolor()[:, 3]
    assert 0.2 < (alphas < 0.5).mean() < 0.95
    lines = [np.transpose(line.get_data_3d()) for line in axes.get_lines()]
    ends = np.array([[0.5, 0, 2.4], [0.5, 1, 2.4]])
    assert len(lines) == 2
    for line in lines:
        np.testing.assert_allclose(line[[0, -1]], ends, atol=0.01)


@pytest.mark.parametrize("target", TARGETS, ids=range(len(TARGETS)))
def test_targets_of_every_kind(target: sn.Target | list[sn.Target]) -> None:
    solution = sn.solve(ROBOT, target, time=0.1)
    asked = solution.problem.targets
    axes = sn.plot(solution)
    arrows = sum(1 if t.direction is not None else 3 if t.rotation is not None else 0 for t in asked)
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Path3DCollection

    assert sum(isinstance(each, Line3DCollection) for each in axes.collections) == arrows
    points = [each for each in axes.collections if isinstance(each, Path3DCollection)]
    assert len(points) == len(asked) + (not solution.solved)  # and the place that says why
    np.testing.assert_allclose(points[0].get_facecolor()[0, :3], matplotlib.colors.to_rgb(TARGET))


def test_what_is_in_front_of_a_robot_is_see_through() -> None:
    front = sn.Sphere((0.3, -0.3 * np.sqrt(3.0), 2.0), 0.3)  # between the viewer at azimuth -60 and the robot
    behind = sn.Sphere((-0.3, 0.3 * np.sqrt(3.0), 1.0), 0.3)
    for ball, least in ((front, 0.22), (behind, 1.0)):
        axes = sn.plot(ROBOT, ball, view=(0, -60))
        assert surfaces(axes)[0].get_facecolor()[:, 3].min() == pytest.approx(least)
    axes = sn.plot(ROBOT, front, view=(0, -60))
    assert is_blue(at(axes, [[0.0, 0.0, 2.0]])).all()


def test_all_obstacles_and_a_problem() -> None:
    axes = sn.plot(SCENE, sn.Problem(ROBOT, TARGETS[0], SCENE))
    assert len(surfaces(axes)) == 1
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    assert (high - low).max() < 8.0  # what is far away does not make the robot small
    corners = np.concatenate([np.asarray(path) for path in surfaces(axes)[0]._faces])
    assert (corners.reshape(-1, 3) >= low - 1e-9).all()
    assert len(surfaces(sn.plot(sn.Scene([sn.Sphere((0, 0, 0), 1)])))[0].get_facecolor()) > 100


def test_it_draws_on_what_it_is_given_and_keeps_what_is_there() -> None:
    from matplotlib import pyplot

    axes = pyplot.figure().add_subplot(projection="3d")
    assert sn.plot(ROBOT, ax=axes) is axes
    before = axes.get_zlim()
    sn.plot(sn.Sphere((4, 0, 0), 1), ax=axes)
    assert axes.get_zlim()[1] >= before[1]
    assert axes.get_xlim()[1] > 4.9
    assert len(surfaces(axes)) == 2


def test_a_route_is_a_dashed_line() -> None:
    ball = sn.Scene([sn.Sphere((0.0, 0.0, 1.5), 0.5)])
    found = sn.Solver(ROBOT, ball, time=60.0).solve_all(sn.Target((0.0, 0.0, 3.0)), count=2)
    routed = next(solution for solution in found if solution.route is not None)
    lines = [line for line in sn.plot(routed).get_lines() if line.get_color() == ROUTE]
    assert len(lines) == 1
    np.testing.assert_array_equal(np.transpose(lines[0].get_data_3d()), routed.route)


def test_wrong_axes_and_views_are_refused() -> None:
    from matplotlib.figure import Figure

    refused("ax", lambda: sn.plot(ROBOT, ax=Figure().add_subplot()), "expected axes in space")
    refused("view", lambda: sn.plot(ROBOT, view=(1, 2, 3)), "expected")


def test_without_matplotlib_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.backend_bases", None)
    refused("plot", lambda: sn.plot(ROBOT), "expected it installed: ", "[plot]")


def test_large_meshes_are_thinned(tmp_path: Path) -> None:
    turns, rise = np.meshgrid(np.linspace(0, 2 * np.pi, 200, endpoint=False), np.linspace(0, 3, 60))
    vertices = np.stack([np.cos(turns), np.sin(turns), rise], axis=-1).reshape(-1, 3)
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(59), np.arange(200), indexing="ij"))
    a, b = i * 200 + j, i * 200 + (j + 1) % 200
    faces = np.concatenate([np.stack([a, b, a + 200], axis=-1), np.stack([b, b + 200, a + 200], axis=-1)])
    axes = sn.plot(ROBOT, sn.Mesh(vertices, faces))
    assert len(surfaces(axes)[0].get_facecolor()) < 2 * len(faces)
    axes.figure.savefig(tmp_path / "tube.svg")
    assert (tmp_path / "tube.svg").stat().st_size < 3e6  # as pixels, not as many thousand polygons


def test_a_picture_goes_into_a_file(tmp_path: Path) -> None:
    for name in ("arm.png", "arm.svg"):
        axes = sn.plot(ROBOT, path=tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
        assert hasattr(axes, "get_proj")
    refused("path", lambda: sn.plot(ROBOT, path=tmp_path / "arm.txt"), "png")
    refused("path", lambda: sn.plot(ROBOT, path=tmp_path / "nowhere" / "arm.png"), "can be written")
