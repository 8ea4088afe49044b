"""The command calibrate."""

import json
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli.app import main


def test_it_fits_a_payload_and_bounds_a_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rod = sn.Stiffness(2e3, 1.5e3)
    tendons = sn.Tendons(3, 4.0)
    drawn = sn.Robot.uniform(1, 60.0, tendons=tendons, stiffness=rod, mass=1e-4, gravity=(0, 0, -9.81), arcs=2)
    real = drawn.changed(base=sn.pose(direction=(1, 0, 0)), payload=sn.Payload(0.01))
    values = real.to_actuators([[[0.02 * i, 0.3 - 0.01 * i, 60.0]] for i in range(20)])
    tips = np.array([real.equilibrium(each).tip[:3, 3] for each in values])
    names = [each.name for each in drawn.actuators]
    rows, motion, out = (tmp_path / name for name in ("rows.csv", "motion.csv", "out.json"))
    for file, off in ((rows, 0.0), (motion, 1.0)):
        table = np.concatenate([values, tips + np.array([0.0, off, 0.0])], axis=1)
        np.savetxt(file, table, delimiter=",", header=",".join([*names, "x", "y", "z"]), comments="")
    robot = tmp_path / "robot.yaml"
    drawn.save(robot)
    asked = ["calibrate", str(robot), str(rows), "--fit", "payload", "--motion", str(motion), "--out", str(out)]
    assert main(asked) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"bound of the robot, from {motion}: 1"
    written = json.loads(out.read_text())
    assert written["payload"][0]["mass"] == pytest.approx(0.01, rel=1e-6)
    assert written["uncertainty"]["bound"] == pytest.approx(1.0, rel=1e-6)
    assert main([*asked[:-2], "--frame", "camera"]) == 2
    assert "--frame: expected base or device" in capsys.readouterr().err
