"""From the values of actuators back to configurations: least squares, once factored for every robot."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.arguments import Batch, Stack
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE, MIN_LENGTH
from sinuous.robot.actuation import Actuation, flat, product

RANK = 1e-9
"""Actuators that are as nearly dependent as this, relative to their weights, count as dependent."""

COORDINATES = ("bend_x", "bend_y", "length")

MOST_NAMED = 4
"""Coordinates that a refusal names."""


class Inverse(Frozen):
    """What leads from the values of a robot's actuators to its configuration.

    Coordinates are measured in rad and in mean lengths of their segments. Of all configurations whose values are
    nearest to those given, the one nearest to a reference is meant.

    Parameters
    ----------
    actuation : Actuation
    limits : ndarray (n, 8)
        Rows of the segments, laid out as `sinuous.kernels.tables` says.

    Attributes
    ----------
    undetermined : ndarray of bool (n, 3)
        Coordinates that can move and that no actuator determines.
    """

    undetermined: NDArray[np.bool_]
    _of_values: Floats
    _of_reference: Floats
    _constant: Floats

    def __init__(self, actuation: Actuation, limits: Floats) -> None:
        scale = limits[:, [BEND_SCALE, BEND_SCALE, LENGTH_SCALE]]
        moves = scale.ravel() > 0.0
        jacobian = actuation.jacobian
        system = jacobian[:, moves] * scale.ravel()[moves]
        norms = np.linalg.norm(system, axis=1, keepdims=True)
        _, sizes, directions = np.linalg.svd(system / np.where(norms > 0.0, norms, 1.0))
        rank = int((sizes > RANK).sum())
        loose = np.zeros(scale.shape, np.bool_)
        loose.ravel()[moves] = np.linalg.norm(directions[rank:], axis=0) > np.sqrt(RANK)
        u, s, vt = np.linalg.svd(system, full_matrices=False)
        inverse = np.zeros((scale.size, len(actuation)))
        inverse[moves] = scale.ravel()[moves, None] * ((vt[:rank].T / s[:rank]) @ u[:, :rank].T)
        fixed = np.where([False, False, True] & ~moves.reshape(scale.shape), limits[:, [MIN_LENGTH]], 0.0).ravel()
        # reference + inverse (values - jacobian reference), where what is fixed replaces it in the reference
        rest = np.eye(scale.size) - inverse @ jacobian
        arrays = {
            "undetermined": loose,
            "_of_values": inverse,
            "_of_reference": np.where(moves, rest, 0.0),
            "_constant": rest @ fixed,
        }
        for array in arrays.values():
            array.flags.writeable = False
        self._set(**arrays)

    def configuration(self, values: Floats, reference: Floats | None) -> Floats:
        """Configurations (..., n, 3) with these values (..., m), nearest to the reference (..., n, 3)."""
        found = product(values, self._of_values) + self._constant
        if reference is not None:
            found = found + product(flat(reference), self._of_reference)
        return found.reshape(*found.shape[:-1], len(self.undetermined), 3)

    def refuse_undetermined(self, names: Sequence[str]) -> None:
        """Refuse to do without a reference when a coordinate of one of these segments is undetermined."""
        places = [(int(k), COORDINATES[c]) for k, c in np.argwhere(self.undetermined)]
        if places:
            listed = [f"{coordinate} of {names[k]} (segment {k + 1})" for k, coordinate in places[:MOST_NAMED]]
            more = f" and {len(places) - MOST_NAMED} more" if len(places) > MOST_NAMED else ""
            expected = f"a configuration for what no actuator determines: {', '.join(listed)}{more}"
            raise InputError("initial", "missing", None, expected)


def fitting(values: Stack, initial: Batch | None, actuators: int, segments: int) -> tuple[Floats, Floats | None]:
    """Check values (..., m) and a reference (..., n, 3) or none; their axes in front must broadcast."""
    given = checks.stack("actuators", values, (actuators,))
    if initial is None:
        return given, None
    near = checks.stack("initial", initial, (segments, 3))
    checks.broadcast("initial", initial, given[..., :1], near[..., 0, :1])
    return given, near
