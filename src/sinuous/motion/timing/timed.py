"""A motion as fast as it may be."""

from typing import TYPE_CHECKING

from sinuous import checks
from sinuous.arguments import Number
from sinuous.errors import InputError
from sinuous.motion.timing.optimal import optimal
from sinuous.motion.timing.scaling import stopping
from sinuous.motion.timing.trajectory import Trajectory
from sinuous.motion.timing.way import legs_of, rounded, straight
from sinuous.robot.rates import Rates

if TYPE_CHECKING:
    from sinuous.motion.motion import Motion


def timed(motion: "Motion", rates: "Rates", blend: Number = 0.0) -> Trajectory:
    """Pass the way of a motion as fast as rates and accelerations allow; see `Motion.timed`."""
    if not isinstance(rates, Rates):
        raise InputError("rates", "", rates, "Rates")
    if motion.scene.moves:
        raise InputError("motion", "obstacles move", motion, "one among obstacles that stand still: it has other times")
    limits, accelerations = rates.spread(motion.robot), None
    if rates.acceleration is not None:
        with checks.inside("acceleration"):
            accelerations = rates.acceleration.spread(motion.robot)
    most = checks.number("blend", blend, low=0.0)
    if most > 0.0 and accelerations is None:
        raise InputError("blend", "rates have no acceleration, and so no corner asks for one", most, "0")
    legs = legs_of(motion.robot, motion.q, motion.steps)
    if not len(legs.sizes):
        raise InputError("motion", "stands still", motion, "a motion that moves")
    if accelerations is not None and most > 0.0 and len(legs.sizes) > 1:
        way = rounded(motion.robot, legs, most)
        return Trajectory(motion, way, *optimal(motion.robot, way, limits, accelerations))
    way = straight(legs)
    return Trajectory(motion, way, *stopping(motion.robot, way, limits, accelerations))
