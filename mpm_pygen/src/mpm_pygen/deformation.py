"""How points were deformed, from where their neighbours went: for the shapes of drawn points."""

from __future__ import annotations

import numpy as np

from mpm_pygen.shape import BoolArray, FloatArray, IntArray

#: Neighbours are those of a square lattice, diagonals included, up to this many spacings away.
REACH = 1.6
#: Bodies of more points are drawn without a deformation, which would not be seen.
MOST_POINTS = 200_000
#: A fit that misses the neighbours by more than this part of their distance says nothing.
WORST_FIT = 0.25


class Deformation:
    """Deformation gradients of the points of a body in a plane, relative to a first state.

    Parameters
    ----------
    start : FloatArray
        Positions at the start, `(n, 2)`.
    side : FloatArray
        Sides of the points at the start, `(n,)`.
    """

    def __init__(self, start: FloatArray, side: FloatArray) -> None:
        self.start, self.side = start, side
        self.first, self.second = _pairs(start, REACH * float(np.median(side)))
        along = start[self.second] - start[self.first]
        moment = np.zeros((len(start), 2, 2))
        np.add.at(moment, self.first, along[:, :, None] * along[:, None, :])
        self.along = along
        self.squares = np.bincount(self.first, np.sum(along**2, axis=1), len(start))
        # Points in a row, or alone, have no deformation that their neighbours could tell.
        self.known = np.linalg.det(moment) > 1e-3 * side**4
        moment[~self.known] = np.eye(2)
        self.inverse = np.linalg.inv(moment)

    def gradients(self, now: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Fit the deformation gradients.

        Parameters
        ----------
        now : FloatArray
            Positions, `(n, 2)`.

        Returns
        -------
        gradient : FloatArray
            `(n, 2, 2)`.
        sound : BoolArray
            Where the neighbours agree on one, `(n,)`.
        """
        along = now[self.second] - now[self.first]
        product = np.zeros((len(now), 2, 2))
        np.add.at(product, self.first, along[:, :, None] * self.along[:, None, :])
        gradient = product @ self.inverse
        rest = along - np.einsum("kij,kj->ki", gradient[self.first], self.along)
        missed = np.bincount(self.first, np.sum(rest**2, axis=1), len(now))
        sound = self.known & (missed <= WORST_FIT**2 * self.squares)
        sound &= np.linalg.det(gradient) > 0.0
        return gradient, sound


def surface_points(position: FloatArray, side: FloatArray) -> BoolArray:
    """Tell which points of a plane body have no neighbour on some side.

    Parameters
    ----------
    position : FloatArray
        `(n, 2)`.
    side : FloatArray
        Sides of the points, `(n,)`.
    """
    if len(position) > MOST_POINTS:
        return np.ones(len(position), dtype=bool)
    first, second = _pairs(position, REACH * float(np.median(side)))
    along = position[second] - position[first]
    surface = np.zeros(len(position), dtype=bool)
    for axis in range(2):
        for sign in (1.0, -1.0):
            # Neighbours within 45 degrees of this direction.
            ahead = sign * along[:, axis] >= np.abs(along[:, 1 - axis])
            surface |= np.bincount(first[ahead], minlength=len(position)) == 0
    return surface


def _pairs(position: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    """Give all ordered pairs of points that are no further apart than `reach`."""
    nobody = np.empty(0, dtype=int)
    place = (position - position.min(axis=0)) / reach
    if not np.all(place < 1e9):
        # A body that has burst has no neighbours.
        return nobody, nobody
    # Points by cells as wide as the reach, so that neighbours are in the next cells at most.
    cells = place.astype(int) + 1
    stride = int(cells[:, 1].max()) + 2
    key = cells[:, 0] * stride + cells[:, 1]
    order = np.argsort(key, kind="stable")
    keys = key[order]
    first, second = [nobody], [nobody]
    for step in (a * stride + b for a in (-1, 0, 1) for b in (-1, 0, 1)):
        start = np.searchsorted(keys, key + step, "left")
        count = np.searchsorted(keys, key + step, "right") - start
        one = np.repeat(np.arange(len(key)), count)
        within = np.arange(len(one)) - np.repeat(np.cumsum(count) - count, count)
        other = order[np.repeat(start, count) + within]
        near = np.sum((position[one] - position[other]) ** 2, axis=1) <= reach**2
        kept = near & (one != other)
        first.append(one[kept])
        second.append(other[kept])
    return np.concatenate(first), np.concatenate(second)
