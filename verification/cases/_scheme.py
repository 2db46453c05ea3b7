"""The linear scheme written a second time, as matrices: small motions about points at rest.

Explicit USL with FLIP, for any places of the points, any TYPE and all mappings, from its formulas:

    V_i = sum_p m_p N_i v_p / m_i,   f_i = -dt sum_p V_p B_pi^T s_p / m_i,
    v_p += N_p f,   u_p += dt N_p (V + f),   s_p += dt C B_p (V + f)

with B the matrix of strains, TYPE 4 per radian with the hoop strain v_r/r and the shear
dv_theta/dr - v_theta/r. On the grid these are f = -dt Z U, U' = U + dt (V + f), V' = V + Mu f. At
nodes of negligible mass U moves with V alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
import numpy.typing as npt
from _waves import SLIP, STICK
from harness.scene import NVEL, Scene
from harness.theory import grid_functions

Array = npt.NDArray[np.float64]
#: Mass at or below which a node is negligible, over the mean mass of the points.
CUTOFF = 1e-9
#: Whether a smooth wall at r = 0 holds the velocity around the axis, too (TYPE 4).
AXIS_HOLDS_SWIRL = True


def held_nodes(sim_type: int, cells: Sequence[int], codes: Sequence[int]) -> npt.NDArray[np.bool_]:
    """Return which components of which nodes walls hold: (components, nodes), x fastest.

    `codes` are those of CartesianBoxCustom, face by face; only no slip and free slip hold nodes.
    """
    dim = len(cells)
    held = np.zeros((NVEL[sim_type], *[n + 1 for n in reversed(cells)]), dtype=bool)
    for face, code in enumerate(codes):
        axis, upper = divmod(face, 2)
        place: list[slice | int] = [slice(None)] * dim
        place[dim - 1 - axis] = -upper
        if code == STICK:
            held[(slice(None), *place)] = True
        elif code == SLIP:
            held[(axis, *place)] = True
        if sim_type == 4 and face == 0 and code == SLIP and AXIS_HOLDS_SWIRL:
            held[(2, *place)] = True
    return held.reshape(NVEL[sim_type], -1)


def functions(
    basis: str, places: Array, cells: int, n: float, averaged: npt.NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Return the functions of the nodes along one direction and their slopes in cells.

    Both are (points, nodes); `places` and the boxes of the points, 1/n, are in cells. Where corner
    averages would reach over a wall in any direction, the hats themselves count.
    """
    if basis != "cpdi":
        return grid_functions(basis, places, cells, n)
    plain, mean = (grid_functions(name, places, cells, n) for name in ("linear", "cpdi"))
    chosen = averaged[:, None]
    return np.where(chosen, mean[0], plain[0]), np.where(chosen, mean[1], plain[1])


def product(factors: Sequence[Array]) -> Array:
    """Return products of the functions of all directions: (points, nodes), x fastest."""
    return reduce(lambda a, b: (b[:, :, None] * a[:, None, :]).reshape(len(a), -1), factors)


class LinearScheme:
    """Matrices of one body of a scene.

    Parameters
    ----------
    scene : Scene
        The scene; its first body counts.
    codes : Sequence[int]
        Codes of the walls, face by face.
    """

    def __init__(self, scene: Scene, codes: Sequence[int]) -> None:
        body = scene.bodies[0]
        points, self.sim_type = body.points, scene.sim_type
        dim, self.components = len(scene.cells), NVEL[scene.sim_type]
        h = np.array(scene.lengths) / np.array(scene.cells)
        # Corners of the averaged functions lie a quarter of the box's side from its middle.
        quarter = 0.25 * points.volume ** (1.0 / dim)
        inside = (points.x >= quarter[:, None]) & (
            points.x + quarter[:, None] <= np.array(scene.lengths)
        )
        averaged = np.all(inside, axis=1) & (scene.mapping == "cpdi")
        # Boxes have one width in all directions; those of corner averages that of the point.
        box = 4.0 * quarter[0] if scene.mapping == "cpdi" else scene.box * h[0]
        lines = []
        for d in range(dim):
            place = points.x[:, d] / h[d]
            w, dw = functions(scene.mapping, place, scene.cells[d], float(h[d] / box), averaged)
            lines.append((w, dw / h[d]))
        self.values = product([w for w, _ in lines])
        slopes = [
            product([line[1] if e == d else line[0] for e, line in enumerate(lines)])
            for d in range(dim)
        ]
        mass = self.values.T @ points.total_mass
        self.strain = self.strain_matrix(slopes, points.x[:, 0])
        lame = body.youngs_modulus * body.poisson / (1 + body.poisson) / (1 - 2 * body.poisson)
        shear = body.youngs_modulus / (2 * (1 + body.poisson))
        self.law = np.diag([2 * shear] * 3 + [shear] * 3)
        self.law[:3, :3] += lame
        held = held_nodes(scene.sim_type, scene.cells, codes)
        self.free = np.flatnonzero(((mass > 0.0) & ~held).ravel())
        self.mass = np.tile(mass, self.components)[self.free]
        self.counts = (self.mass > CUTOFF * np.mean(points.total_mass)).astype(float)
        forces = np.einsum("ab,bpi->api", self.law, self.strain) * points.measure[:, None]
        stiffness = np.einsum("api,apj->ij", self.strain, forces, optimize=True)
        filters = np.kron(
            np.eye(self.components), self.values.T @ (points.total_mass[:, None] * self.values)
        )
        chosen = np.ix_(self.free, self.free)
        self.stiffness = stiffness[chosen] / self.mass[:, None]
        self.filter = filters[chosen] / self.mass[:, None]
        momenta = self.values.T @ (points.total_mass[:, None] * points.velocity)
        self.start = momenta.T.ravel()[self.free] / self.mass

    def strain_matrix(self, slopes: Sequence[Array], r: Array) -> Array:
        """Return strains xx yy zz and shears xy yz zx: (6, points, components * nodes)."""
        n, nodes = self.values.shape
        b = np.zeros((6, n, self.components, nodes))
        shears = {(0, 1): 3, (1, 2): 4, (0, 2): 5}
        for c in range(self.components):
            for d, slope in enumerate(slopes):
                if c == d:
                    b[c, :, c] += slope
                else:
                    b[shears[min(c, d), max(c, d)], :, c] += slope
        if self.sim_type == 4:
            b[2, :, 0] = self.values / r[:, None]
            b[5, :, 2] -= self.values / r[:, None]
        return b.reshape(6, n, -1)

    def growth(self, dt: float) -> float:
        """Return the largest magnitude of the eigenvalues of a step."""
        one, z = np.eye(len(self.free)), dt**2 * self.stiffness
        # On (V, U/dt).
        step = np.block([[one, -self.filter @ z], [one, one - self.counts[:, None] * z]])
        return float(np.max(np.abs(np.linalg.eigvals(step))))

    def limit(self, low: float, high: float) -> float:
        """Return the time step between two at which waves begin to grow, to 1e-5.

        Eigenvalues 1 of rigid motions are double, so that roundings move them by 1e-8.
        """
        while high > low * (1.0 + 1e-5):
            middle = float(np.sqrt(low * high))
            if self.growth(middle) > 1.0 + 1e-6:
                high = middle
            else:
                low = middle
        return float(np.sqrt(low * high))

    def march(self, dt: float, steps: int, every: int) -> tuple[Array, Array]:
        """Return displacements (frames, points, components) and stresses (frames, 6, points)."""
        v, u, shown = self.start.copy(), np.zeros(len(self.free)), []
        for step in range(steps + 1):
            if step % every == 0:
                shown.append(u)
            f = -dt * (self.stiffness @ u)
            u = u + dt * (v + self.counts * f)
            v = v + self.filter @ f
        nodes = self.values.shape[1]
        full = np.zeros((len(shown), self.components * nodes))
        full[:, self.free] = shown
        moved = np.einsum("pi,fci->fpc", self.values, full.reshape(-1, self.components, nodes))
        stress = np.einsum("ab,bpi,fi->fap", self.law, self.strain, full, optimize=True)
        return moved, stress
