"""Obstacles that move, and paths as tables, as problem files say them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.files.nouns import HEADERS, parse_path
from tests.helpers import present, refused, with_each


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
    np.testing.assert_allclose(present(turns.rotations)[1:], [np.diag([1, -1, -1]), np.diag([-1, -1, 1])])
    np.testing.assert_allclose(turns.positions, [(1, 2, 3), (0, 0, 0), (0, 0, 0)])


def test_a_table_of_them(tmp_path: Path) -> None:
    (tmp_path / "way.csv").write_text("t,x,y,z\n0,1,2,3\n2,4,5,6\n")
    assert read(tmp_path, "way.csv").equals(read(tmp_path, "[[0, [1, 2, 3]], [2, [4, 5, 6]]]"))
    (tmp_path / "turn.csv").write_text("t,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0,0,0,0,1\n")
    turned = read(tmp_path, "turn.csv").rotations
    np.testing.assert_allclose(present(turned)[1], np.diag([-1, -1, 1]))


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
    with pytest.raises(sn.InputError) as caught:
        read(tmp_path, moving)
    assert said in str(caught.value)


@pytest.mark.parametrize("header", HEADERS, ids=",".join)
def test_rows_are_targets_of_their_numbers(header: tuple[str, ...]) -> None:
    numbers = np.random.default_rng(1).normal(size=(50, len(header)))
    text = ",".join(header) + "\n" + "\n".join(" , ".join(map(repr, row)) for row in numbers.tolist())
    targets, name = parse_path(text).targets, HEADERS[header]
    assert len(targets) == 50
    for target, row in zip(targets, numbers, strict=True):
        turned: dict[str, Any] = {} if name is None else {name: row[3:]}
        np.testing.assert_array_equal(target.table, sn.Target(row[:3], **turned).table)


def test_columns_may_stand_in_any_order_with_any_separator() -> None:
    targets, times = parse_path("z;y;x;t\n3,5;2;1;0,5\n")
    assert times == [0.5]
    np.testing.assert_array_equal(targets[0].position, (1.0, 2.0, 3.5))


def test_a_column_in_front_has_times() -> None:
    targets, times = parse_path("t,x,y,z,dx,dy,dz\n0.5,1,2,3,0,0,2\n2,4,5,6,0,1,0\n")
    assert present(times).tolist() == [0.5, 2.0]
    assert [
        target.equals(wanted)
        for target, wanted in zip(
            targets, [sn.Target((1, 2, 3), direction=(0, 0, 1)), sn.Target((4, 5, 6), direction=(0, 1, 0))], strict=True
        )
    ] == [True] * 2
    assert parse_path("x,y,z\n1,2,3\n").times is None


@with_each(
    ("text", "key", "problem"),
    [
        ("", "line 1", "expected x,y,z or x,y,z,dx,dy,dz or"),
        ("1,2,3\n", "line 1", "expected x,y,z or x,y,z,dx,dy,dz or"),
        ("x,y,z,dx\n", "line 1", "expected x,y,z or x,y,z,dx,dy,dz or"),
        ("x;y;w\n1;2;3\n", "line 1", "expected x,y,z or x,y,z,dx,dy,dz or"),
        ("Name;X;Y;Z;nx\na;1;2;3;0\n", "line 1", "unknown columns Name, nx; expected x,y,z or"),
        ("x,y,z\n", "line 1", "expected at least one target"),
        ("x,y,z\n\n1,2\n", "line 3", "has 2 cells; expected as many as in line 1: x,y,z"),
        ("x,y,z\n1,2,nan\n", "line 2.z", "expected a finite number, got '"),
        ("x,y,z\n1,,3\n", "line 2.y", "expected a finite number, got '"),
        ("x,y,z\n1_0,2,3\n", "line 2.x", "expected a finite number, got '"),
        ("x,y,z\n1e999,2,3\n", "line 2.x", "expected a finite number, got '1e999'"),
        ("x,y,z,dx,dy,dz\n1,2,3,0,0,0\n", "line 2.direction", "expected a vector that is not zero"),
        ("x,y,z\n" + "1,2,3\n" * 1000 + "1,2,x\n", "line 1002.z", "expected a finite number, got 'x'"),
        ('x,y,z\n"1,2,3\n', "line 1", "the table cannot be read"),
        ("t,x,y\n1,2,3\n", "line 1", "perhaps with t"),
        ("t,x,y,z\n0,1,2,3\n1,1,2,3\n1,4,5,6\n", "line 4.t", "times must increase; expected more than 1, got 1.0"),
        ("t,x,y,z\nsoon,1,2,3\n", "line 2.t", "expected a finite number, got 'soon'"),
        ("t,x,y,z\n0,1,2\n", "line 2", "has 3 cells"),
    ],
)
def test_refusals_name_the_line(text: str, key: str, problem: str) -> None:
    refused(key, lambda: parse_path(text), problem)
