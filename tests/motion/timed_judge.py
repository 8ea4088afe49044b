"""What is claimed of motions in time, judged by sampling with distances that share no code."""

import numpy as np

import sinuous as sn
from sinuous.measures.obstacles import measure


def least_clearance(motion: sn.Motion, count: int = 250) -> float:
    """Least clearance over many times and places of the body."""
    least, radii = np.inf, np.array(motion.robot.radii)
    for t in np.linspace(motion.times[0], motion.times[-1], count).tolist():
        places = motion.robot.backbone(motion.at(t), 16)
        thick = np.append(np.repeat(radii, 16), radii[-1])
        least = min(least, *(float((measure(one, places) - thick).min()) for one in motion.scene.at(t).obstacles))
    return least


def fastest(motion: sn.Motion) -> tuple[float, float]:
    """Largest rate of a bend (rad) and of a length, in a unit of time."""
    rates = np.diff(motion.q, axis=0) / np.diff(motion.times)[:, None, None]
    return float(np.hypot(rates[..., 0], rates[..., 1]).max()), float(np.abs(rates[..., 2]).max())


def hardest(motion: sn.Motion) -> tuple[float, float]:
    """Largest change of the rate of a bend (rad) and of a length by the mean duration beside it, from and to rest."""
    durations = np.diff(motion.times)
    rates = np.diff(motion.q, axis=0) / durations[:, None, None]
    still = np.zeros((1, *rates.shape[1:]))
    changes = np.diff(np.concatenate([still, rates, still]), axis=0)
    beside = 0.5 * (np.append(0.0, durations) + np.append(durations, 0.0))
    gains = changes / beside[:, None, None]
    return float(np.hypot(gains[..., 0], gains[..., 1]).max()), float(np.abs(gains[..., 2]).max())
