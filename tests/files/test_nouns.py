"""Obstacles that move, as problem files say it."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.errors import InputError


def read(folder: Path, moving: str) -> sn.Moving:
    file = folder / "scene.yaml"
    file.write_text(f"- sphere: {{center: [0, 0, 0], radius: 1, name: ball, moving: {moving}}}\n")
    (obstacle,) = sn.load(file, sn.Scene).obstacles
    assert isinstance(obstacle, sn.Moving)
    return obstacle


def test_a_list_of_times_and_poses(tmp_path: Path) -> None:
    places = read(tmp_path, "[[0, [1, 2, 3]], [2.5, [4, 5, 6]]]")
    assert places.equals(sn.Moving(sn.Sphere((0, 0, 0), 1.0, name="ball"), [0, 2.5], [(1, 2, 3), (4, 5, 6)]))
    turns = read(tmp_path, "[[0, {position: [1, 2, 3]}], [1, {rotation: [0, 1, 0, 0]}], [2, {xyzw: [0, 0, 1, 0]}]]")
    assert turns.rotations is not None
    np.testing.assert_allclose(turns.rotations[1:], [np.diag([1, -1, -1]), np.diag([-1, -1, 1])])
    np.testing.assert_allclose(turns.positions, [(1, 2, 3), (0, 0, 0), (0, 0, 0)])


def test_a_table_of_them(tmp_path: Path) -> None:
    (tmp_path / "way.csv").write_text("t,x,y,z\n0,1,2,3\n2,4,5,6\n")
    assert read(tmp_path, "way.csv").equals(read(tmp_path, "[[0, [1, 2, 3]], [2, [4, 5, 6]]]"))
    (tmp_path / "turn.csv").write_text("t,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0,0,0,0,1\n")
    turned = read(tmp_path, "turn.csv").rotations
    assert turned is not None
    np.testing.assert_allclose(turned[1], np.diag([-1, -1, 1]))


@pytest.mark.parametrize(
    ("moving", "said"),
    [
        ("[]", "[0].sphere.moving: expected a list of [time, pose]"),
        ("3", "[0].sphere.moving: expected a list of [time, pose]"),
        ("[[0, [1, 2, 3]], [0, [1, 2, 3]]]", "[0].sphere.moving[1][0]: times must increase; expected more than 0"),
        ("[[0, [1, 2]]]", "[0].sphere.moving[0][1]: expected [x, y, z] or a mapping"),
        ("[[0, [1, 2, 3], 4]]", "[0].sphere.moving[0]: expected [time, pose]"),
        ("[[0, {place: [1, 2, 3]}]]", "[0].sphere.moving[0][1].place: unknown key; expected one of position"),
        ("nowhere.csv", "[0].sphere.moving: cannot be read: No such file"),
        ("bad.csv", "bad.csv: line 3.t: times must increase; expected more than 1"),
        ("untimed.csv", "untimed.csv: line 1: expected t,x,y,z"),
        ("pointed.csv", "pointed.csv: line 1: expected t,x,y,z"),
    ],
)
def test_what_is_wrong_is_refused_by_its_place(tmp_path: Path, moving: str, said: str) -> None:
    (tmp_path / "bad.csv").write_text("t,x,y,z\n1,0,0,0\n1,0,0,0\n")
    (tmp_path / "untimed.csv").write_text("x,y,z\n0,0,0\n")
    (tmp_path / "pointed.csv").write_text("t,x,y,z,dx,dy,dz\n0,0,0,0,0,0,1\n")
    with pytest.raises(InputError) as caught:
        read(tmp_path, moving)
    assert said in str(caught.value)
