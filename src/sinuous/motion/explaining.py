"""Why a motion ended as it did, and what would help; `Motion.explain` calls it."""

from typing import TYPE_CHECKING

from sinuous.answer.binding import Binding
from sinuous.answer.explanation import NONE_TRIED, Explanation
from sinuous.answer.remedies import Remedy
from sinuous.answer.status import Status
from sinuous.answer.worst import Worst
from sinuous.base import checks
from sinuous.base.arguments import Constraint, Number
from sinuous.base.progress import work_time
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene

if TYPE_CHECKING:
    from sinuous.motion.motion import Motion

UNTRIED = f"{NONE_TRIED}of this motion only its waypoints are explained"

HALVINGS = 7
"""How often the interval is halved in which the thickest body lies."""


THINNEST = 1e-9
"""Share of its thickness that a link keeps where a body without any is meant: it has one, or it is none."""


def explain_motion(motion: "Motion", sentence: str, time: Number) -> Explanation:
    """Say why a motion ended as it did; `sentence` is what its status means here. See `Motion.explain`."""
    seconds = checks.number("time", time, low=0.0)
    end = work_time() + seconds
    failed = next((solution for solution in motion.solutions if not solution.solved), None)
    if failed is not None:
        own = failed.explain(seconds)
        return Explanation(**{**vars(own), "status": motion.status, "sentence": sentence})
    worst, remedies = motion.worst, list[Remedy]()
    complete = True
    if motion.status is Status.LEFT_PATH:
        remedies.append(Remedy("reconfigure", "refuse", "allow", "the tip leaves the line there"))
    elif worst is not None and motion.status is Status.BLOCKED:
        remedies, complete = _make_clear(motion, worst, end)
    known = motion.solved or motion.status in {Status.LEFT_PATH, Status.BLOCKED}
    short = f"the time was too short to try everything: explain(time={max(1.0, 5.0 * seconds):.2g}) gives it more"
    untried = short if not complete else "" if known else UNTRIED
    held = () if worst is None or motion.status is not Status.BLOCKED else (_held_by(motion, worst),)
    return Explanation(
        motion.status, sentence, None, "", held, (), tuple(remedies), untried, True, len(motion.robot.segments)
    )


def _held_by(motion: "Motion", worst: Worst) -> Binding:
    """What a place of the body was seen to overlap."""
    kind: Constraint = "self_clearance" if worst.constraint == "self_clearance" else "clearance"
    demanded = motion.robot._least_clearances[0 if kind == "clearance" else 1]
    return Binding(
        kind,
        worst.segment,
        worst.obstacle,
        demanded - worst.amount,
        demanded,
        other_segment=worst.other_segment,
        place=worst.place,
    )


def _make_clear(motion: "Motion", worst: Worst, end: float) -> tuple[list[Remedy], bool]:
    """Changes with which all of the motion is proved, and whether the time was enough to try them."""
    found: list[Remedy] = []
    if worst.obstacle is not None:
        others = [each for i, each in enumerate(motion.scene.obstacles) if motion.scene.name(i) != worst.obstacle]
        if _proved(motion, motion.robot, others):
            where = f"it is {worst.amount:.3g} deep in it, {worst.place}"
            found.append(Remedy(f"obstacle {worst.obstacle}", worst.obstacle, None, where))
    if work_time() > end:
        return found, False
    thickest = max(motion.robot.body_radii)
    if thickest > 0.0 and not motion.robot.has_external_load and _proved(motion, _thinner(motion.robot, 0.0), None):
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            if work_time() > end:
                return found, False
            share = 0.5 * (low + high)
            low, high = (share, high) if _proved(motion, _thinner(motion.robot, share), None) else (low, share)
        found.append(Remedy("radius", thickest, low * thickest, "" if low > 0.0 else "a body without thickness"))
    return found, True


def _thinner(robot: Robot, share: float) -> Robot:
    """The robot with a share of its thickness."""
    thin = [own.changed(radius=share * own.radius) for own in robot.segments]
    bodies = [[(*own[:2], max(share, THINNEST) * own.radius) for own in joint.body] for joint in robot.joints]
    joints = [joint.changed(body=body) for joint, body in zip(robot.joints, bodies, strict=True)]
    return robot.changed(segments=thin, joints=joints)


def _proved(motion: "Motion", robot: Robot, obstacles: list[Obstacle] | None) -> bool:
    """Whether the motion of another robot, or among other obstacles, is proved."""
    scene = motion.scene if obstacles is None else Scene(obstacles)
    return type(motion)(robot, motion.configuration, scene, motion.times).solved
