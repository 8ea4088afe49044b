"""Where something is over time: poses at times, and what lies between them."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.frozen import Frozen


class Course(Frozen):
    """Poses at times: linear in position between them, turning evenly the shortest way; at rest before and after.

    Parameters
    ----------
    times : ndarray (T,)
        Increasing, at least one.
    positions : ndarray (T, 3)
    rotations : ndarray (T, 3, 3) or None
        `None`: it never turns.
    """

    times: Floats
    positions: Floats
    rotations: Floats | None

    def __init__(self, times: Floats, positions: Floats, rotations: Floats | None) -> None:
        self._set(times=times, positions=positions, rotations=rotations)

    @cached_property
    def turns(self) -> Floats:
        """Rotation vectors (T - 1, 3) between neighbouring poses, rad, in the frame of the first of the two."""
        from scipy.spatial.transform import Rotation  # noqa: PLC0415

        if self.rotations is None or len(self.times) < 2:
            return np.zeros((max(0, len(self.times) - 1), 3))
        steps = np.swapaxes(self.rotations[:-1], 1, 2) @ self.rotations[1:]
        turns: Floats = Rotation.from_matrix(steps).as_rotvec()
        return turns

    def poses(self, when: Floats) -> tuple[Floats, Floats]:
        """Positions (m, 3) and rotations (m, 3, 3) at times (m,)."""
        step, share = self._where(when)
        return self._positions(step, share), self._rotations(step, share)

    def _where(self, when: Floats) -> tuple[NDArray[np.intp], Floats]:
        """Numbers of the steps that times (m,) lie in, and shares of these from 0 to 1."""
        step = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, max(0, len(self.times) - 2))
        return step, self._shares(step, when)

    def _shares(self, step: NDArray[np.intp], when: Floats) -> Floats:
        if len(self.times) < 2:
            return np.zeros(len(when))
        begin, end = self.times[step], self.times[step + 1]
        shares: Floats = np.clip((when - begin) / (end - begin), 0.0, 1.0)
        return shares

    def _positions(self, step: NDArray[np.intp], share: Floats) -> Floats:
        if len(self.times) < 2:
            return np.repeat(self.positions, len(step), axis=0)
        s = share[:, None]
        places: Floats = (1.0 - s) * self.positions[step] + s * self.positions[step + 1]
        return places

    def _rotations(self, step: NDArray[np.intp], share: Floats) -> Floats:
        from scipy.spatial.transform import Rotation  # noqa: PLC0415

        if self.rotations is None:
            return np.broadcast_to(np.eye(3), (len(step), 3, 3)).copy()
        if len(self.times) < 2:
            return np.repeat(self.rotations, len(step), axis=0)
        turned: Floats = self.rotations[step] @ Rotation.from_rotvec(share[:, None] * self.turns[step]).as_matrix()
        return turned
