"""Norms of fields at points, weighted with the volumes of the reference state."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def magnitude(values: Array) -> Array:
    """Return |v| of scalars (n,), vectors (n, 3) or tensors (n, 3, 3)."""
    return np.sqrt(np.sum(values.reshape(len(values), -1) ** 2, axis=1))


def l1(difference: Array, volume: Array) -> float:
    """Return sum V |d| / sum V."""
    return float(np.sum(volume * magnitude(difference)) / np.sum(volume))


def l2(difference: Array, volume: Array) -> float:
    """Return sqrt(sum V |d|^2 / sum V)."""
    return float(np.sqrt(np.sum(volume * magnitude(difference) ** 2) / np.sum(volume)))


def linf(difference: Array, volume: Array | None = None) -> float:
    """Return max |d|; the volumes do not matter."""
    return float(np.max(magnitude(difference)))


NORMS = {"l1": l1, "l2": l2, "linf": linf}


class Errors:
    """The largest norm of each error over the frames of a run.

    Errors at one instant can vanish by accident, for example after a whole period.
    """

    def __init__(self, volume: Array) -> None:
        self.volume = volume
        self.largest: dict[str, float] = {}
        self.last: dict[str, float] = {}

    def add(self, name: str, difference: Array) -> None:
        """Take the norms of a difference (n, ...) at a frame into account."""
        for norm, function in NORMS.items():
            key = f"{name}_{norm}"
            self.last[key] = function(difference, self.volume)
            self.largest[key] = max(self.largest.get(key, 0.0), self.last[key])

    def measures(self, *, last: tuple[str, ...] = ()) -> dict[str, float]:
        """Return `name_norm`: the largest, or the last for the names in `last`."""
        return {
            key: self.last[key] if key.rsplit("_", 1)[0] in last else value
            for key, value in self.largest.items()
        }
