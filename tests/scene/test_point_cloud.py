"""Clouds: files of every kind, radii, and bad input."""

import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sinuous.errors import InputError
from sinuous.scene.point_cloud import PointCloud
from tests.helpers import NOT_NUMBERS, random_rotation, refused, refused_each

POINTS = np.random.default_rng(0).normal(size=(20, 3)).round(3)


def test_a_radius_for_all_or_for_each() -> None:
    cloud = PointCloud(POINTS, 0.1, name="scan")
    np.testing.assert_array_equal(cloud.radii, np.full(20, 0.1))
    np.testing.assert_array_equal(cloud.points, POINTS)
    assert cloud.name == "scan"
    assert not cloud.points.flags.writeable
    assert not cloud.radii.flags.writeable
    radii = np.linspace(0.0, 1.0, 20)
    np.testing.assert_array_equal(PointCloud(POINTS.tolist(), radii.tolist()).radii, radii)


def test_the_cloud_keeps_its_own_points() -> None:
    points = POINTS.copy()
    cloud = PointCloud(points, 0.1)
    points += 1.0
    np.testing.assert_array_equal(cloud.points, POINTS)


def save(folder: Path, kind: str) -> Path:
    file = folder / f"scan.{kind}"
    if kind == "npy":
        np.save(file, POINTS)
    elif kind == "ply":
        trimesh = pytest.importorskip("trimesh")
        trimesh.PointCloud(POINTS).export(file)
    elif kind == "pcd":
        head = "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 20\nHEIGHT 1\nPOINTS 20\nDATA ascii\n"
        file.write_text(head + "".join(f"{x} {y} {z}\n" for x, y, z in POINTS.tolist()))
    else:
        between = "," if kind == "csv" else " "
        rows = [between.join(map(str, [*row, 255])) for row in POINTS.tolist()]
        file.write_text("\n".join([f"x{between}y{between}z{between}red" if kind == "csv" else "# scan", *rows, "", ""]))
    return file


@pytest.mark.parametrize("kind", ["ply", "pcd", "npy", "xyz", "txt", "csv"])
def test_files_of_every_kind(tmp_path: Path, kind: str) -> None:
    turn = random_rotation(np.random.default_rng(1))
    cloud = PointCloud.load(save(tmp_path, kind), 0.1, 1e-3, (1, 2, 3), turn, "scan")
    np.testing.assert_allclose(cloud.points, 1e-3 * POINTS @ turn.T + (1, 2, 3), atol=1e-9)
    assert cloud.radii.max() == 0.1
    assert cloud.name == "scan"
    np.testing.assert_allclose(PointCloud.load(save(tmp_path, kind), 0.1).points, POINTS, atol=1e-6)


@pytest.mark.parametrize("points", [np.zeros((4, 1)), np.zeros(4), np.zeros((2, 2, 3)), 3.0, "abc", None, {"x": 1}])
def test_what_is_no_list_of_points_is_refused(points: Any) -> None:
    refused("points", lambda: PointCloud(points, 1.0), "point")


def test_bad_points_are_refused() -> None:
    refused_each("points", ([], np.zeros((0, 3))), lambda value: PointCloud(value, 1.0), "at least one point")
    for bad in (np.nan, np.inf):
        wrong = POINTS.copy()
        wrong[7, 1] = bad
        refused("points[7]", partial(PointCloud, wrong, 1.0), "expected 3 finite numbers")
    refused("points", lambda: PointCloud([[0, 0, True]], 1.0), "rows of 3 finite numbers")


def test_bad_radii_are_refused() -> None:
    refused_each("radius", [*NOT_NUMBERS, -1.0], lambda value: PointCloud(POINTS, value))
    refused("radius", lambda: PointCloud(POINTS, np.ones(19)), "20 finite numbers")
    refused("radius[4]", lambda: PointCloud(POINTS, np.where(np.arange(20) == 4, -1.0, 1.0)), "at least 0")


def test_bad_files_are_refused(tmp_path: Path) -> None:
    def load(name: str, content: str) -> PointCloud:
        (tmp_path / name).write_text(content)
        return PointCloud.load(tmp_path / name, 1.0)

    for name, content, message in (
        ("one.xyz", "1\n2\n", r"one\.xyz: points: expected x, y, z on every line, got '1' \(has 1 of three columns\)"),
        (
            "two.csv",
            "x,y\n1,2\n",
            r"two\.csv: points: expected x, y, z on every line, got '1 2' \(has 2 of three",
        ),
        ("words.txt", "1 2 3\n1 two 3\n", r"words\.txt: points: expected x, y, z on every line"),
        ("short.txt", "1 2 3\n1 2\n", r"short\.txt: points: expected x, y, z on every line"),
        ("nothing.xyz", "# no points\n\n", r"nothing\.xyz: points: expected at least one point"),
        ("hole.xyz", "1 2 3\n1 nan 3\n", r"hole\.xyz: points\[1\]: expected 3 finite numbers, got \[1\.0, nan"),
        ("a.npy", "no array", r"^file: expected .* \(cannot be read: "),
        ("a.ply", "no points", r"^file: expected .* \(cannot be read: "),
        ("a.pcd", "no points", r"a\.pcd: file: expected a PCD file, got .* \(cannot be read: no PCD header\)"),
        ("a.las", "", r"^file: expected a name that ends in \.ply"),
    ):
        with pytest.raises(InputError, match=message):
            load(name, content)
    refused("file", lambda: PointCloud.load(tmp_path / "none.xyz", 1.0), "No such file")
    refused_each("scale", (0.0, -1.0, "1"), lambda value: PointCloud.load(tmp_path / "none.xyz", 1.0, value))


def test_arrays_of_objects_are_never_unpickled(tmp_path: Path) -> None:
    file = tmp_path / "evil.npy"
    np.save(file, np.array([Unpickled()], object), allow_pickle=True)
    refused("file", lambda: PointCloud.load(file, 1.0), "cannot be read")


class Unpickled:
    def __reduce__(self) -> Any:
        return pytest.fail, ("unpickled",)


def test_an_array_of_another_shape_is_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.zeros((5, 4)))
    with pytest.raises(InputError, match=r"a\.npy: points: expected three columns x, y, z, got .* \(shape \(5, 4\)\)"):
        PointCloud.load(tmp_path / "a.npy", 1.0)


def test_only_ply_needs_trimesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = save(tmp_path, "ply")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    refused("file", lambda: PointCloud.load(file, 1.0), "needs trimesh", "pip install sinuous[mesh]")
    assert len(PointCloud.load(save(tmp_path, "pcd"), 1.0).points) == 20
