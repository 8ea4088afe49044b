"""The shape of a ROS 2 `JointTrajectory`."""

import json
from pathlib import Path

import numpy as np

from sinuous.files.joint_chain import joint_trajectory, write_json


def test_points_have_times_from_the_first_on(tmp_path: Path) -> None:
    positions = np.array([[0.0, 1.0], [0.5, 2.0], [1.0, 3.0]])
    times = np.array([2.0, 2.25, 4.9999999999])
    message = joint_trajectory(["a", "b"], times, positions)
    assert message["joint_names"] == ["a", "b"]
    assert [point["positions"] for point in message["points"]] == positions.tolist()
    assert [point["time_from_start"] for point in message["points"]] == [
        {"sec": 0, "nanosec": 0},
        {"sec": 0, "nanosec": 250_000_000},
        {"sec": 3, "nanosec": 0},
    ]
    assert "velocities" not in message["points"][0]
    write_json(tmp_path / "out.json", message)
    assert json.loads((tmp_path / "out.json").read_text()) == message
