"""The scheme in one dimension, written again in NumPy from its formulas, for comparison."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from harness.theory import grid_functions
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Bar:
    """Points of a bar in uniaxial strain between two walls that hold the end nodes of the grid."""

    x: Array
    v: Array
    volume: Array
    density: float
    modulus: float
    spacing: float
    cells: int
    #: Functions by their names in the matrix: `cpdi` averages hats over half of each point's first
    #: box.
    basis: str = "linear"
    #: Points per cell, for boxes of uGIMP.
    ppc: int = 1

    def __post_init__(self) -> None:
        """Take what does not change from the start."""
        self.start = self.x.copy()
        self.mass = self.density * self.volume
        self.arm = 0.25 * self.volume
        self.stress = np.zeros_like(self.x)

    def functions(self) -> tuple[Array, Array]:
        """Return values and derivatives (points, nodes)."""
        if self.basis not in ("linear", "cpdi"):
            values, slopes = grid_functions(self.basis, self.x / self.spacing, self.cells, self.ppc)
            return values, slopes / self.spacing
        top = self.cells * self.spacing
        s = self.x / self.spacing
        cell = np.minimum(s.astype(int), self.cells - 1)
        nodes = np.arange(self.cells + 1)
        value = self.hats(self.x)
        slope = ((nodes == cell[:, None] + 1) * 1.0 - (nodes == cell[:, None])) / self.spacing
        if self.basis == "linear":
            return value, slope
        low, high = self.x - self.arm, self.x + self.arm
        whole = ((low >= 0.0) & (high <= top))[:, None]
        left, right = self.hats(low), self.hats(high)
        mean, rise = 0.5 * (left + right), (right - left) / (2.0 * self.arm[:, None])
        return np.where(whole, mean, value), np.where(whole, rise, slope)

    def hats(self, x: Array) -> Array:
        """Return the hat functions of all nodes at positions."""
        distance = x[:, None] / self.spacing - np.arange(self.cells + 1)
        return np.maximum(0.0, 1.0 - np.abs(distance))

    def step(self, dt: float) -> None:
        """Advance by one step: momentum, forces, positions, velocities, volumes, stress."""
        n, dn = self.functions()
        mass = n.T @ self.mass
        held = np.zeros(self.cells + 1, bool)
        held[[0, -1]] = True
        empty = mass <= 0.0
        mass = np.where(empty, 1.0, mass)
        increment = dt * -(dn.T @ (self.volume * self.stress)) / mass
        velocity = (n.T @ (self.mass * self.v)) / mass
        increment[held | empty] = 0.0
        velocity[held | empty] = 0.0
        velocity += increment
        self.x = self.x + dt * (n @ velocity)
        self.v = self.v + n @ increment
        rate = dn @ velocity
        self.volume = self.volume * np.exp(dt * rate)
        self.stress = self.stress + dt * self.modulus * rate
