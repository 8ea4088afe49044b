"""What is saved is what is on the page; what is no problem file is refused in one line."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.view.page.model import PageModel, problem_text, read_problem
from tests.scene.shapes import cube

PROBLEM = b"robot: {segments: {count: 3, length: [0.8, 1.2]}}\ntarget: {position: [1, 0, 2]}\n"


def test_a_saved_problem_is_what_is_on_the_page(tmp_path: Path) -> None:
    np.save(tmp_path / "scan.npy", np.ones((4, 3)))
    more = b"scene: [{points: {file: scan.npy, radius: 0.1}}]\nworkspace: {spacing: 0.2}\n"
    (tmp_path / "problem.yaml").write_bytes(PROBLEM + more)
    page = PageModel(sn.load(tmp_path / "problem.yaml", sn.Job))
    page.add("capsule")
    page.place_target(0, np.array([0.1, 0.2, 2.5]))
    page.limit(1, max_bend=1.25)
    page.tolerate(0.003, 0.004)
    page.bend(0, 0.1, 0.2, 0.9)
    page.set_method("dls", None, 3, 0.5)
    text = problem_text(page)
    assert text.startswith("# sinuous solve FILE --method dls --seed 3 --time 0.5\n")
    again = read_problem("saved.yaml", text.encode(), tmp_path)
    assert again.robot.equals(page.robot)
    assert again.scene.snapshot().equals(page.scene)
    assert again.waypoints[0][0].equals(page.targets[0])
    assert again.tolerance == page.job.tolerance
    assert again.workspace.spacing == 0.2
    assert again.start is not None


def test_obstacles_that_were_moved_are_saved_where_they_are() -> None:
    cell = np.pad(np.ones((1, 1, 1), bool), 1)
    scene = [
        sn.Mesh(*cube(0.5, (-2, -2, 2))),
        sn.PointCloud([[3, 0, 0], [3, 1, 0]], 0.1),
        sn.Grid(cell, (4, 0, 0), 0.2),
    ]
    page = PageModel(sn.Job(sn.Robot.uniform(3, (0.8, 1.2)), sn.Target((1, 0, 2)), scene))
    for index in range(3):
        page.grasp(index)
        assert page.grip is not None
        for shift in ((0.1, 0.2, 0.3), (0.1, 0.1, 0.1)):
            turn = sn.pose(shift, rotation=(1, 2, 3, 4) if index < 2 else None)
            page.carry(turn @ page.grip)
    again = read_problem("moved.yaml", problem_text(page).encode(), Path()).scene.snapshot()
    assert again.equals(page.scene)
    points = np.random.default_rng(0).normal(size=(200, 3))
    np.testing.assert_allclose(again.distance(points), page.scene.distance(points), atol=1e-9)


def test_a_path_keeps_all_its_waypoints(tmp_path: Path) -> None:
    text = PROBLEM.replace(b"target: {position: [1, 0, 2]}", b"path: [{position: [1, 0, 2]}, {position: [1, 0.1, 2]}]")
    page = PageModel(read_problem("path.yaml", text, tmp_path))
    page.go_to_waypoint(1)
    page.place_target(0, np.array([1.0, 0.4, 2.0]))
    again = read_problem("path.yaml", problem_text(page).encode(), tmp_path)
    assert again.equals(page.job)
    assert again.start is None


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("a.yaml", b"robot: 3\n", "a.yaml: robot"),
        ("a.yaml", b"\xff\xfe", "not UTF-8"),
        ("a.json", b"{", "a.json: line 1"),
        ("a.yaml", b"", "a.yaml: file"),
        ("a.yaml", b"just text", "a.yaml: file"),
        ("../../b.yaml", PROBLEM + b"target: 1\n", "b.yaml: "),
        ("a.yaml", PROBLEM + b"scene: [{mesh: {file: ../secret.stl, scale: 1}}]\n", "leads out of the folder"),
        ("a.yaml", PROBLEM + b"start: /etc/passwd\n", "leads out of the folder"),
        ("a.yaml", b"robot: ../arm.yaml\ntarget: {position: [1, 0, 2]}\n", "leads out of the folder"),
        ("a.yaml", PROBLEM + b"scene: [{mesh: {file: missing.stl, scale: 1}}]\n", "missing.stl"),
    ],
)
def test_what_is_no_problem_is_refused_in_one_line(name: str, content: bytes, expected: str, tmp_path: Path) -> None:
    with pytest.raises(sn.InputError) as caught:
        read_problem(name, content, tmp_path)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)
