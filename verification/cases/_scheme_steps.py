"""Steps of every integrator and transfer as matrices, for one direction."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from _scheme import LinearScheme
from harness.scene import Scene
from harness.steps import LEAST_SPREAD

Array = npt.NDArray[np.float64]


class SchemeMatrices(LinearScheme):
    """Matrices of one body of a scene of TYPE 1, with the scheme of the scene.

    On the grid a step is f = -dt Z U, V' = kept V + gained f, and U' = U + dt (V + f) in USL,
    U + dt V' in MUSL, U + dt V before the forces in USF.
    """

    def __init__(self, scene: Scene, codes: list[int]) -> None:
        super().__init__(scene, codes)
        self.scheme = scene.scheme
        points, h = scene.bodies[0].points, scene.lengths[0] / scene.cells[0]
        one = np.eye(len(self.free))
        name = self.scheme.transfer
        self.kept, self.gained = one, self.filter
        if name == "FLIP":
            self.kept = self.scheme.flip * one + (1.0 - self.scheme.flip) * self.filter
        elif name == "XPIC":
            rest = np.linalg.matrix_power(one - self.filter, self.scheme.xpic)
            self.kept = one - rest
        elif name == "PIC":
            self.kept = self.filter
        else:
            distance = points.x / h - np.arange(scene.cells[0] + 1)
            spread = np.sum(self.values * distance**2, axis=1, keepdims=True)
            fitted = (spread > LEAST_SPREAD) & (scene.mapping != "linear")
            fit = -self.values * distance / np.where(fitted, spread, 1.0)
            fit = np.where(fitted, fit, self.strain[0] * h)
            arm = -distance * self.values
            mapped = (arm.T @ (points.total_mass[:, None] * fit))[np.ix_(self.free, self.free)]
            self.kept = self.gained = self.filter + mapped / self.mass[:, None]

    def growth(self, dt: float) -> float:
        """Return the largest magnitude of the eigenvalues of a step."""
        one, z = np.eye(len(self.free)), dt**2 * self.stiffness
        pull = self.gained @ z
        if self.scheme.solver == "MUSL":
            rows = [[self.kept, -pull], [self.kept, one - pull]]
        elif self.scheme.solver == "USF":
            rows = [[self.kept - pull, -pull], [one, one]]
        else:
            rows = [[self.kept, -pull], [one, one - self.counts[:, None] * z]]
        return float(np.max(np.abs(np.linalg.eigvals(np.block(rows)))))
