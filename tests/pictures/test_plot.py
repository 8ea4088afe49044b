"""Pictures are drawn for every kind of answer, and without touching what the caller has chosen."""

import sys
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.pictures.plot import OTHER, draw_shape, plot_solution
from tests.scene.shapes import cube

matplotlib = pytest.importorskip("matplotlib")

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05, tool=sn.pose((0, 0, 0.2)))
SCENE = sn.Scene(
    [
        sn.Sphere((2, 0, 1), 0.3),
        sn.Box((-1, 0, 1), (0.3, 1, 1)),
        sn.Capsule((-3, 2, 1), (3, 2, 1), 0.1),
        sn.Cylinder((0, -1.5, 0), (0, -1.5, 3), 0.2),
        sn.HalfSpace((0, 0, -0.5), (0, 0, 1)),
        sn.Sphere((0, 0, 0), 8, inside=True),
        sn.Box((0, 0, 0), (12, 12, 12), inside=True),
        sn.Cylinder((0, 0, -6), (0, 0, 6), 6, inside=True),
        sn.Mesh(*cube(0.5, (-2, -2, 2)), name="solid"),
        sn.Mesh(cube()[0] + [2, 2, 2], cube()[1][1:], name="shell"),
        sn.Mesh(*cube(15.0), inside=True),
        sn.PointCloud(np.random.default_rng(0).normal(size=(500, 3)) * 0.2 + [2, -2, 1], 0.02),
        sn.Grid(np.ones((2, 3, 4), bool), (2, 0, 3), 0.1),
        sn.Grid(np.zeros((2, 2, 2), bool), (2, 0, 3), 0.1),
        sn.Field(lambda p: np.linalg.norm(p - [-2, 1, 3], axis=-1) - 0.3, (-9, -9, -9), (9, 9, 9), 0.3),
    ]
)
TARGETS: list[sn.Target | list[sn.Target]] = [
    sn.Target((0.5, 0.5, 2.4), direction=(0, 0, 1)),
    [sn.Target(rotation=(1, 0, 0, 0)), sn.Target((0, 0, 1), segment=1)],
    sn.Target(direction=(1, 0, 0)),
    sn.Target((0, 0, 9)),
]


@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_kinds_of_pictures(tmp_path: Path, kind: str) -> None:
    file = tmp_path / f"shape.{kind}"
    plot_solution(sn.solve(ROBOT, TARGETS[0], SCENE), file)
    assert file.stat().st_size > 5000


@pytest.mark.parametrize("target", TARGETS, ids=range(len(TARGETS)))
def test_targets_of_every_kind(tmp_path: Path, target: sn.Target | list[sn.Target]) -> None:
    plot_solution(sn.solve(ROBOT, target, time=0.1), tmp_path / "shape.png")


def test_a_track_has_a_second_panel(tmp_path: Path) -> None:
    track = sn.track(ROBOT, [*(sn.Target((0.5, y, 2.4)) for y in np.linspace(0, 1, 20)), sn.Target((0, 0, 9))], SCENE)
    plot_solution(track, tmp_path / "track.png")
    plot_solution(track.solutions[0], tmp_path / "shape.png")
    from matplotlib.image import imread

    track_size, shape_size = (imread(tmp_path / f"{name}.png").shape for name in ("track", "shape"))
    assert track_size[1] / track_size[0] > 1.3 > shape_size[1] / shape_size[0]


def test_nothing_global_is_touched(tmp_path: Path) -> None:
    settings = dict(matplotlib.rcParams)
    had_pyplot = "matplotlib.pyplot" in sys.modules
    plot_solution(sn.solve(ROBOT, TARGETS[0]), tmp_path / "shape.png")
    assert dict(matplotlib.rcParams) == settings
    assert ("matplotlib.pyplot" in sys.modules) == had_pyplot


def test_without_matplotlib_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.backend_bases", None)
    with pytest.raises(sn.InputError, match=r"expected it installed: .*\[plot\], got .* \(needs Matplotlib\)"):
        plot_solution(sn.solve(ROBOT, TARGETS[0]), tmp_path / "shape.png")


def test_an_unknown_kind_is_refused(tmp_path: Path) -> None:
    with pytest.raises(sn.InputError, match=r"expected a name that ends in \."):
        plot_solution(sn.solve(ROBOT, TARGETS[0]), tmp_path / "shape.exe")


def test_the_route_that_led_there_and_other_solutions_are_lines(tmp_path: Path) -> None:
    from matplotlib.figure import Figure

    ball = sn.Scene([sn.Sphere((0.0, 0.0, 1.5), 0.5)])
    found = sn.Solver(ROBOT, ball, time=60.0).solve_all(sn.Target((0.0, 0.0, 2.8)), count=2)
    routed = next(solution for solution in found if solution.route is not None)
    axes = Figure().add_subplot(projection="3d", computed_zorder=False)
    others = [solution for solution in found if solution is not routed]
    draw_shape(axes, (routed,), others)
    assert sum(line.get_color() == OTHER for line in axes.get_lines()) == len(others) > 0
    lines = [np.transpose(line.get_data_3d()) for line in axes.get_lines() if line.get_linestyle() == "--"]
    assert len(lines) == 1
    np.testing.assert_array_equal(lines[0], routed.route)
