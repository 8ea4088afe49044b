"""Code as users write it, in which a type checker finds nothing. It is checked, not run."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

import sinuous as sn

tendons = sn.Tendons(3, radius=4, displacement=(-8, 8), names=["a", "b", "c"])
robot = sn.Robot(
    [
        sn.Segment((0, 100), max_bend=0, name="stage"),
        sn.Segment(80, 2, tendons=tendons),
        sn.Segment([45, np.float64(70)]),
    ],
    radius=4,
    base=sn.pose((0, 0, 1), direction=(0, 0, -1)),
    self_collision="avoid",
    actuators=sn.Actuators(np.eye(9), limits=[(0, 100), *[None] * 8]),
)
robot = sn.Robot.uniform(5, length=(45, 70), max_bend=2.4, radius=4, base=np.eye(4), tool=None, name="arm")
robot = robot.changed(mount=5, self_collision="allow")
q = [[0.4, 0.1, 50], [-0.3, 0.5, 60], [0.0, 0.0, 55], [0.0, 0, 1], [1, 2.5, 3]]
many: list[npt.NDArray[np.float64]] = [np.array(q), robot.backbone(q)]
motors = robot.from_actuators(robot.to_actuators([q, q]), initial=[[0, 0, 1.5], [1, 2, 3]])
values = robot.to_actuators(np.array(q, np.float32)) + 1
tip = robot.tip(q)[:3, 3]
curvature, angle, length = sn.arc_parameters(motors)
shape = sn.from_arc_parameters(0.1, [0, 1.5], np.arange(2))

corners, faces = np.zeros((4, 3)), np.zeros((4, 3), np.int32)


def ball(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray(np.linalg.norm(points, axis=-1)) - 1.0


obstacles = [
    sn.Sphere((0, 80, -120), radius=25, inside=True, name="ball"),
    sn.Box(center=[1, 2, 3], size=np.ones(3), rotation=(1, 0, 0, 0)),
    sn.Box((0, 0, 0), (1, 1, 1), rotation=Rotation.from_euler("x", 90, degrees=True)),
    sn.Box((0, 0, 0), (1, 1, 1), rotation=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
    sn.Capsule((0, 0, 0), (1, 0, 0), 0.5),
    sn.HalfSpace((0, 0, 0), (0, 0, 1)),
    sn.Mesh(corners, faces, thickness=0.1),
    sn.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], [[0, 1, 2]]),
    sn.PointCloud(corners, [0.1, 0.2, 0.3, 0.4]),
    sn.PointCloud.load(Path("scan.ply"), radius=2, xyzw=(0, 0, 0, 1)),
    sn.Grid(np.zeros((2, 2, 2), bool), (0, 0, 0), 1),
    sn.Grid([[[0.5, 1], [0, 1]], [[0, 1], [0, 1]]], (0, 0, 0), 0.1),
    sn.Field(ball, (-2, -2, -2), (2, 2, 2), 0.1),
]
scene = sn.Scene(obstacles)
scene.update([[0, 0, 1.5], [1, 2, 3]], radius=1)
distance = scene.distance((0, 0, 1)) + scene.distance([[0, 0, 1], [0, 0, 2.5]])

target = sn.Target((-60, 150, -230), direction=(-0.7071, 0, -0.7071))
elbow = sn.Target(tip, segment=2)
whole = sn.Target([1, 2, 3], rotation=Rotation.from_euler("x", 90, degrees=True))
several = sn.Target.each(corners, rotation=Rotation.from_euler("x", [90, 80, 70, 60], degrees=True))
ik = sn.Solver(robot, scene, method="opti_path", time=1, routes=False, tolerance=sn.Tolerance(0.1, angle=1e-2))
ik = sn.Solver(
    robot, obstacles, method=sn.methods.OptiPath(iterations=100, metric="identity"), prefer=sn.Preferences(bends=1)
)
ik = sn.Solver(robot, method=sn.methods.OptiPath.faithful(restarts=True))
solution = ik.solve(target, initial=q, time=0.5)
solution = ik.solve([target, elbow], initial=solution)
clear: float | None = solution.clearance
if solution.status is sn.Status.SOLVED and solution.start == "route":
    print(solution.q.sum(), solution.binding[0].constraint == "bend", solution.explain(time=3))
best = sn.solve_all(robot, target, [sn.Sphere((0, 0, 9), 1)], count=3)[0]
print(sn.solve(robot, target, method="newton", seed=3).raise_for_status().q, best)
track = sn.track(robot, several, scene, start=solution, progress=print, time=0.1)
one: bool = sn.check(robot, [[0.4, 0.1, 50], [0, 0, 55]]).ok
two: npt.NDArray[np.bool_] = sn.check(robot, [q, q], scene).ok
print(sn.check(robot, solution.q).clearance < 1, sn.check(robot, track.q).ok.all())
batch = ik.solve_many(positions=corners, directions=[[0, 0, 1.5]] * 4, initial=q, workers=2, progress=True)
first: sn.Solution = batch[0]
some: sn.answer.Solutions = ik.solve_many([target, [target, elbow]], initial=[solution, solution.q])[:1]
print(batch.solved.mean(), batch.q.shape, sn.track(robot, positions=corners, time=0.1).q)
job = sn.load("job.yaml", sn.Job)
job.solve(time=0.5).explain()
sn.load("arm.yaml", sn.Robot).save(Path("other.yaml"))
sn.load("any.yaml").save("x.yaml")
sn.Job(robot, target, [*obstacles], tolerance=sn.Tolerance(0.1), start=q).save("a.yaml")
again = sn.Solution.from_dict(solution.to_dict(), solution.problem)
axes = sn.plot(robot, np.array(q), scene, [target, solution], view=(20, 30))
sn.plot(track, batch, ax=axes)
sn.view.animate(track, path="track.gif", seconds=2)
sn.view.diagram(track, "clearance")
