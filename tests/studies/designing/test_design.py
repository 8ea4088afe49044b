"""Robots for sets of tasks: better than the template, the same for any worker and after any interruption."""

import csv
from contextlib import suppress
from pathlib import Path
from socket import socket
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.verification import verify
from sinuous.cli.app import main
from sinuous.model.segment import straight
from sinuous.studies.designing import find
from sinuous.studies.designing.design import Design
from sinuous.studies.designing.search import RobotCandidates, RobotSearch, Space
from tests.helpers import Floats, present, refused

TEMPLATE = sn.Robot.uniform(3, 100.0, max_bend=2.0, radius=2.0, tendons=sn.Tendons(3, 2.0))
TASKS = {
    "left": sn.Target((-90.0, 0.0, 190.0)),
    "right": sn.Target((90.0, 20.0, 180.0)),
    "top": sn.Target((10.0, 0.0, 230.0)),
}
BALL = sn.Sphere((0.0, 60.0, 120.0), 20.0)
PORT_OF_DASK = 8787
"""Where the page of a cluster is, of which there may be others on a machine."""

VARY: dict[str, Any] = {"segments.length": (40.0, 130.0), "segments.count": [2, 3, 4]}


def run(**changes: Any) -> Design:
    """Find the shortest robot among few."""
    options = {"vary": VARY, "minimise": "length", "robots": 64, "workers": 1, **changes}
    return sn.studies.design(TEMPLATE, TASKS, [BALL], **options)


def test_the_best_robot_does_all_tasks_and_is_shorter_than_the_template() -> None:
    found = run()
    assert found.solved
    assert found.best is not None
    assert found.best.objectives["length"] < 300.0
    assert sn.studies.assess(found.robot, TASKS, [BALL]).solved
    assert found.best.values["segments.length"] * found.best.values["segments.count"] == pytest.approx(
        found.best.objectives["length"]
    )
    assert found.deciding in TASKS
    assert {change.field for change in found.changes} == {"segments.length"}
    assert "decides" in str(found)


LINES = sn.Tendons(3, 2.0, stiffness=50.0)
SOFT = sn.Robot([sn.Segment(100.0, 2.0, radius=2.0, tendons=LINES)] * 3, stiffness=sn.Stiffness(bend=300.0))


def most_of(minimise: str, robot: sn.Robot, answers: Floats) -> float:
    """The largest bend, travel of an actuator, or tension of answers."""
    if minimise == "bend":
        return float(np.hypot(answers[..., 0], answers[..., 1]).max())
    shapes = np.concatenate([answers, straight(robot.segments)[None]])
    if minimise == "travel":
        return float(np.ptp(robot.to_actuators(shapes), axis=0).max())
    return float(np.abs(present(robot.drive.elastic).balance(shapes).tensions).max())


@pytest.mark.parametrize(
    ("minimise", "template", "scene", "better"), [("bend", TEMPLATE, [BALL], 0.95), ("tension", SOFT, [], 0.97)]
)
def test_derivatives_lead_fields_and_answers_to_a_better_robot(
    minimise: str, template: sn.Robot, scene: list[Any], better: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    varied, least = {"segments.length": (60.0, 130.0), "base.position[2]": (-20.0, 20.0)}, []
    for robots in (80, 96):
        best = sn.studies.design(template, TASKS, scene, vary=varied, minimise=minimise, robots=robots, workers=1).best
        assert best is not None
        for name, q in best.answers.items():
            assert verify(sn.Problem(best.robot, TASKS[name], scene), q).ok
        answers = np.array([*best.answers.values()])
        assert most_of(minimise, best.robot, answers) == pytest.approx(best.objectives[minimise])
        least.append(best.objectives[minimise])
        monkeypatch.setattr(find, "can_descend", lambda _: False)
    assert least[0] < better * least[1]


def test_any_engine_and_any_interruption_leave_it_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    whole, out = run().to_dict()["front"], tmp_path / "front.csv"
    judged, count = find._DesignRun._judged, []

    def interrupted(self: Any, *arguments: Any) -> Any:
        count.append(1)
        if len(count) in (2, 3):
            raise KeyboardInterrupt
        return judged(self, *arguments)

    monkeypatch.setattr(find._DesignRun, "_judged", interrupted)
    for engine in ("processes", "threads"):
        with pytest.raises(KeyboardInterrupt):
            run(engine=engine, workers=3, out=out)
        assert len(list((tmp_path / "front.csv.parts").glob("chunk-*"))) == 1
    with socket() as other:
        with suppress(OSError):  # whoever has it already does as well
            other.bind(("", PORT_OF_DASK))
            other.listen()
        found = run(engine="dask", out=out)
    assert found.to_dict()["front"] == whole
    assert len(count) == 6
    assert [path.name for path in tmp_path.iterdir()] == ["front.csv"]
    assert len(list(csv.DictReader(out.read_text(encoding="utf-8").splitlines()))) == len(whole)


def test_of_two_objectives_the_front_is_found() -> None:
    found = run(minimise=("length", "clearance"))
    lengths, clear = ([each.objectives[name] for each in found.front] for name in ("length", "clearance"))
    assert lengths == sorted(lengths)
    assert clear == sorted(clear)
    assert len(found.front) > 1
    assert found.to_dict()["minimise"] == ["length", "clearance"]


def test_uncovered_share_counts_also_where_not_all_is_done() -> None:
    tasks = [sn.studies.Cover([sn.Target((-90.0, 0.0, 190.0)), sn.Target((900.0, 0.0, 190.0))])]
    found = sn.studies.design(TEMPLATE, tasks, vary=VARY, minimise=("uncovered", "actuators"), robots=32, workers=1)
    assert found.front[0].objectives["uncovered"] == 0.5
    assert found.front[0].objectives["actuators"] == 6.0


def test_what_no_robot_can_do_is_said_with_the_task_and_the_reason() -> None:
    tasks = {**TASKS, "far": sn.Target((900.0, 0.0, 0.0))}
    refused(
        "tasks",
        lambda: sn.studies.design(TEMPLATE, tasks, vary=VARY, minimise="length"),
        "no robot of these can do far",
    )
    some = {**TASKS, "high": sn.Target((0.0, 0.0, 300.0))}
    found = sn.studies.design(TEMPLATE, some, vary=VARY, minimise="length", robots=48, workers=1)
    assert [cut.values for cut in found.cut] == [{"segments.count": 2}]
    assert found.cut[0].task == "high"


def test_fields_are_ranges_lists_and_elements() -> None:
    space = Space(TEMPLATE, {"base.position[2]": (-10.0, 10.0), "segments[1].length": {"values": [80.0, 90.0]}})
    robot = present(space.robot((90.0,), np.array([0.75])))
    assert robot.base[2, 3] == 5.0
    assert robot.segments[1].length == (90.0, 90.0)
    assert Space(TEMPLATE, {"segments.length": {"range": [50, 150]}}).shares_of(TEMPLATE) is not None
    widest = space.widest((80.0,))
    assert present(widest)[1] == 10.0


@pytest.mark.parametrize(
    ("key", "changes", "words"),
    [
        ("vary.segments.colour", {"vary": {"segments.colour": [1]}}, ""),
        ("vary['segments.length']", {"vary": {"segments.length": (2.0, 1.0)}}, "is empty"),
        ("vary['segments.length']", {"vary": {"segments.length": []}}, "is empty"),
        ("vary", {"vary": {}}, ""),
        ("minimise", {"minimise": "weight"}, "actuators"),
        ("minimise", {"minimise": ("length", "length")}, "twice"),
        ("minimise", {"minimise": "tension"}, "stiffness"),
        ("robots", {"robots": 0}, ""),
        ("budget", {"budget": 0.0}, ""),
        ("template", {"template": "arm"}, ""),
        ("tasks", {"tasks": []}, ""),
    ],
)
def test_bad_input_is_refused(key: str, changes: dict[str, Any], words: str) -> None:
    given: dict[str, Any] = {"template": TEMPLATE, "tasks": TASKS, "vary": VARY, "minimise": "length", **changes}
    refused(key, lambda: sn.studies.design(**given), words)


def test_generations_stay_within_the_ranges() -> None:
    search = RobotSearch([0, 2], 3, 5, known=(2, np.array([0.5, 0.0, 1.0])))
    found: list[RobotCandidates] = []
    for number in range(8):
        combination, shares, begin, source, _ = search.generation(number, found)
        assert set(combination.tolist()) <= {0, 2}
        assert ((shares >= 0.0) & (shares <= 1.0)).all()
        many = len(combination)
        own = shares.sum(axis=1, keepdims=True)
        done = np.full(many, 3), np.ones(many), own, np.full(many, -1)
        found.append(RobotCandidates(combination, shares, *done, begin, source, np.ones(many, int)))
    assert found[0].combination[0] == 2
    assert found[-1].objectives.min() < found[0].objectives.min()


FILE = """
robot: {segments: {count: 3, length: 100, max_bend: 2, radius: 2}}
scene: [{sphere: {center: [0, 60, 120], radius: 20}}]
tasks:
  left: {target: {position: [-90, 0, 190]}}
  both: {set: [{position: [90, 20, 180]}, {position: [10, 0, 230]}], share: 0.5}
  line: {path: [{position: [90, 20, 180]}, {position: [85, 20, 182]}]}
vary: {segments.length: {range: [40, 130]}}
minimise: length
"""


def test_the_command_writes_the_robot_the_front_and_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.yaml"
    file.write_text(FILE, encoding="utf-8")
    names = [tmp_path / name for name in ("best.yaml", "front.csv", "front.png")]
    options = [f"--{key}={name}" for key, name in zip(("out", "csv", "plot"), names, strict=True)]
    assert main(["design", str(file), "--robots=32", "--vary=segments.count=2,3", *options]) == 0
    assert all(name.exists() for name in names)
    assert "robots tried" in capsys.readouterr().out
    assert main(["design", str(file), "--vary=segments.colour=1,2"]) == 2
    assert "vary.segments.colour" in capsys.readouterr().err
    assert main(["design", str(file), "--vary=nothing"]) == 2
    assert "--vary" in capsys.readouterr().err
