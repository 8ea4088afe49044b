"""What can be proved of the base before anything is tried."""

from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot


def base_blocked(robot: Robot, scene: Snapshot) -> bool:
    """Prove that the body overlaps an obstacle where it leaves its mount, whatever the configuration.

    Where the whole robot may be shorter than its mount, nothing is proved. The backbone at arc length `mount` is
    within `mount * bend / 2` of the straight line, where `bend` is the most that it can have turned till there.
    """
    if len(scene) == 0:
        return False
    turned, reached, radius = 0.0, 0.0, robot.radii[0]
    if robot.mount > 0.0:
        for segment, own, curvature in zip(robot.segments, robot.radii, robot.curvatures, strict=True):
            # Lengths vary: this may be the segment that leaves the mount, and so may any before it.
            radius = min(radius, own)
            turned += min(segment.max_bend, curvature * segment.length[1])
            reached += segment.length[0]
            if reached > robot.mount:
                break
        else:
            return False
    sway = robot.mount * min(2.0, 0.5 * turned)
    leaves = robot.base[:3, 3] + robot.mount * robot.base[:3, 2]
    return bool(scene.at_most(leaves) + sway < radius)
