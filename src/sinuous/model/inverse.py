"""From the values of actuators back to configurations: least squares, once factored for every robot."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import ActuatorValues, Batch
from sinuous.base.checks import Floats, in_order
from sinuous.base.errors import InputError, warn_of
from sinuous.base.frozen import Frozen
from sinuous.model.actuation import Actuation, flat, product
from sinuous.model.actuators import Each, checked_each
from sinuous.model.segment import COORDINATES

RANK = 1e-9
"""Actuators that are as nearly dependent as this, relative to their weights, count as dependent."""

CONTRADICTION = 1e-6
"""By how much the values of actuators may contradict each other without a word, in mean lengths of the robot: what
rounding to seven digits does."""


class Inverse(Frozen):
    """What leads from the displacements of a robot's actuators to its configuration.

    Coordinates are measured in rad and in mean lengths of their segments. Of all configurations whose displacements are
    nearest to those given, the one nearest to a reference is meant.

    Parameters
    ----------
    actuation : Actuation

    Attributes
    ----------
    undetermined : ndarray of bool (n, 3)
        Coordinates that can move and that no actuator determines.
    """

    undetermined: NDArray[np.bool_]
    _of_displacements: Floats
    _of_reference: Floats
    _constant: Floats

    def __init__(self, actuation: Actuation) -> None:
        coordinates, jacobian = actuation.coordinates, actuation.jacobian
        basis, scale = coordinates.basis, coordinates.scales
        system = (jacobian @ basis) * scale
        norms = np.linalg.norm(system, axis=1, keepdims=True)
        _, sizes, directions = np.linalg.svd(system / np.where(norms > 0.0, norms, 1.0))
        rank = int((sizes > RANK).sum())
        loose = np.linalg.norm(directions[rank:], axis=0) > np.sqrt(RANK)
        if actuation.elastic is not None:
            loose &= ~actuation.elastic.determined
        u, s, vt = np.linalg.svd(system, full_matrices=False)
        inverse = basis @ (scale[:, None] * ((vt[:rank].T / s[:rank]) @ u[:, :rank].T))
        # origin + inverse (displacements - jacobian origin), with what of the reference can move added to the origin
        rest = np.eye(len(basis)) - inverse @ jacobian
        arrays = {
            "undetermined": (basis[:, loose] != 0.0).any(axis=1).reshape(-1, 3),
            "_of_displacements": inverse,
            "_of_reference": (rest @ basis) @ basis.T,
            "_constant": rest @ coordinates.origin.ravel(),
        }
        for array in arrays.values():
            array.flags.writeable = False
        self._set(**arrays)

    def configuration(self, displacements: Floats, reference: Floats | None) -> Floats:
        """Configurations (..., n, 3) with these displacements (..., m), nearest to the reference (..., n, 3)."""
        found = product(displacements, self._of_displacements) + self._constant
        if reference is not None:
            found = found + product(flat(reference), self._of_reference)
        return found.reshape(*found.shape[:-1], len(self.undetermined), 3)

    def named(self, names: Sequence[str], joints: int = 0) -> list[str]:
        """Name the coordinates that are undetermined, of rows with these names, the first of which are of joints."""
        return [
            f"joint {names[k]!r}" if k < joints else f"{COORDINATES[c]} of {names[k]} (segment {k + 1 - joints})"
            for k, c in np.argwhere(self.undetermined)
        ]


def fitting(
    values: ActuatorValues | None, initial: Batch | None, names: Sequence[str], segments: int
) -> tuple[Floats, Floats | None]:
    """Check values (..., m), or (...) for each name, and a reference (..., n, 3) or none.

    Their axes in front must broadcast.
    """
    named = in_order("actuators", values, names) if isinstance(values, Mapping) else values
    given = checks.stack("actuators", named, (len(names),))
    if initial is None:
        return given, None
    near = checks.stack("initial", initial, (segments, 3))
    checks.broadcast("initial", initial, given[..., :1], near[..., 0, :1])
    return given, near


def answer_contradictions(
    drive: Actuation, values: Floats, found: Floats, tolerance: Each | None, mean_length: float
) -> None:
    """Tell by how much configurations (..., n, 3) that were found miss the values (..., m) they were found for.

    Parameters
    ----------
    tolerance : float or ndarray (m,), optional
        In the units of the motors; more is refused. Without it, more than rounding is warned of.
    """
    if not values.size:
        return
    residuals = drive.values(found) - values
    if drive.elastic is not None:  # these may take any values
        residuals[..., drive.elastic.places] = 0.0
    sizes = np.abs(residuals).reshape(-1, len(drive))
    if tolerance is None:
        shares = drive.motors.within(sizes) / (drive.scales * CONTRADICTION * mean_length)
    else:
        allowed = checked_each("tolerance", tolerance, len(drive), low=0.0)
        shares = sizes / np.maximum(allowed, np.finfo(float).tiny)
    if not (shares > 1.0).any():
        return
    row, worst = np.unravel_index(int(np.argmax(shares)), shares.shape)
    actuator = drive.actuators[worst]
    amount, unit = float(sizes[row, worst]), f" {actuator.unit}" if actuator.unit else ""
    where = f", in row {row}" if len(sizes) > 1 else ""
    problem = (
        f"they contradict each other: in the nearest configuration {actuator.name} is off by {amount:.4g}{unit}{where}"
    )
    if tolerance is not None:
        at_worst = float(np.broadcast_to(values, residuals.shape).reshape(-1, len(drive))[row, worst])
        raise InputError(
            f"actuators: {actuator.name}", problem, at_worst, "values of one configuration, within tolerance"
        )
    warn_of([f"actuators: {problem}; tolerance= says how much of that is expected"])
