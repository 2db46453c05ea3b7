"""Exact solutions of the manufactured motions that are not along the axes of the grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from _manufactured import AxialSolution, Solution

Array = npt.NDArray[np.float64]


def turned(vectors: Array, angle: Array | float) -> Array:
    """Return vectors (n, 3) turned about z by angles."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack(
        [
            cosine * vectors[:, 0] - sine * vectors[:, 1],
            sine * vectors[:, 0] + cosine * vectors[:, 1],
            vectors[:, 2],
        ]
    )


def dyad(a: Array, b: Array) -> Array:
    """Return the tensors a b of vectors (n, 3)."""
    return np.einsum("ni,nj->nij", a, b)


@dataclass
class Vortex(Solution):
    """x = Q(a) X about an axis along z, a = A sin(pi t) (1 - 16 (R - 1)^2)^2 in a ring."""

    amplitude: float = 0.0
    centre: float = 0.0
    length: float = 0.25
    time: float = 1 / np.pi

    def arms(self, reference: Array) -> tuple[Array, Array]:
        """Return the vectors from the axis, (n, 3), and the radii."""
        arm = reference * [1.0, 1.0, 0.0] - [self.centre, self.centre, 0.0]
        return arm, np.hypot(arm[:, 0], arm[:, 1])

    def shape(self, radius: Array) -> tuple[Array, Array]:
        """Return the angle and its derivative by R, over A sin(pi t)."""
        q = np.maximum(0.0, 1.0 - 16.0 * (radius - 1.0) ** 2)
        return q**2, -64.0 * (radius - 1.0) * q

    def displacement(self, reference: Array, time: float) -> Array:
        """Return displacements."""
        arm, radius = self.arms(reference)
        return turned(arm, self.amplitude * np.sin(np.pi * time) * self.shape(radius)[0]) - arm

    def velocity(self, reference: Array, time: float) -> Array:
        """Return velocities: the turned arms, a quarter turn ahead, times the spin."""
        arm, radius = self.arms(reference)
        shape = self.amplitude * self.shape(radius)[0]
        spin = np.pi * np.cos(np.pi * time) * shape
        return spin[:, None] * turned(arm, np.sin(np.pi * time) * shape + 0.5 * np.pi)

    def stress(self, reference: Array, time: float) -> Array:
        """Return the stress of the simple shear k = R da/dR between circles."""
        arm, radius = self.arms(reference)
        shape, slope = self.shape(radius)
        g = self.amplitude * np.sin(np.pi * time)
        k = radius * g * slope
        e_r = turned(arm / np.maximum(radius, 1e-300)[:, None], g * shape)
        e_t = turned(e_r, 0.5 * np.pi)
        normal, shear = self.shear * (1.0 - np.cos(k)), self.shear * np.sin(k)
        return normal[:, None, None] * (dyad(e_t, e_t) - dyad(e_r, e_r)) + shear[:, None, None] * (
            dyad(e_r, e_t) + dyad(e_t, e_r)
        )

    def scales(self) -> tuple[float, float, float]:
        """Return A R, pi A R at R = 1 m, and G times the largest shear, 7.066 A."""
        return self.amplitude, np.pi * self.amplitude, 7.066 * self.shear * self.amplitude


@dataclass
class AxialVortex(AxialSolution, Vortex):
    """The same about the axis of TYPE 4."""

    def shown_displacement(self, reference: Array, time: float) -> Array:
        """Return the third component as the path along theta."""
        radius = self.arms(reference)[1]
        angle = self.amplitude * np.sin(np.pi * time) * self.shape(radius)[0]
        return np.column_stack([0.0 * angle, 0.0 * angle, radius * angle])


@dataclass
class Ring(Solution):
    """u_r = A sin(omega t) T(R): a ring with free rims at a and b, where T' = 0, T(b) = 1.

    The logarithmic stress with nu = 0 vanishes with the radial strain. T = c1 R + c2 R^2 + c3 R^3.
    """

    amplitude: float = 0.0
    centre: float = 0.0
    inner: float = 0.4
    outer: float = 0.6
    length: float = 0.2

    @property
    def omega(self) -> float:
        """Angular frequency, of half a wave over the mean circumference of the radius R."""
        return float(np.pi * self.wave_speed / (self.inner + self.outer))

    def arms(self, reference: Array) -> tuple[Array, Array]:
        """Return the vectors from the axis, (n, 3), and the radii."""
        arm = reference * [1.0, 1.0, 0.0] - [self.centre, self.centre, 0.0]
        return arm, np.hypot(arm[:, 0], arm[:, 1])

    def shape(self, radius: Array) -> tuple[Array, Array]:
        """Return T and T'."""
        a, b = self.inner, self.outer
        # T' = c (R - a)(R - b) and T(0) = 0 give T = c (R^3/3 - (a + b) R^2/2 + a b R).
        c = 1.0 / (b**3 / 3 - (a + b) * b**2 / 2 + a * b * b)
        t = c * (radius**3 / 3 - (a + b) * radius**2 / 2 + a * b * radius)
        return t, c * (radius - a) * (radius - b)

    def displacement(self, reference: Array, time: float) -> Array:
        """Return displacements."""
        arm, radius = self.arms(reference)
        size = self.amplitude * np.sin(self.omega * time) * self.shape(radius)[0]
        return (size / radius)[:, None] * arm

    def velocity(self, reference: Array, time: float) -> Array:
        """Return velocities."""
        arm, radius = self.arms(reference)
        speed = self.amplitude * self.omega * np.cos(self.omega * time) * self.shape(radius)[0]
        return (speed / radius)[:, None] * arm

    def stress(self, reference: Array, time: float) -> Array:
        """Return the logarithmic stress, with nu = 0."""
        arm, radius = self.arms(reference)
        t, slope = self.shape(radius)
        g = self.amplitude * np.sin(self.omega * time)
        radial = self.youngs_modulus * np.log1p(g * slope)
        hoop = self.youngs_modulus * np.log1p(g * t / radius)
        e_r = arm / radius[:, None]
        e_t = turned(e_r, 0.5 * np.pi)
        return radial[:, None, None] * dyad(e_r, e_r) + hoop[:, None, None] * dyad(e_t, e_t)

    def scales(self) -> tuple[float, float, float]:
        """Return A, A omega and E A/R with the mean radius R."""
        mean = 0.5 * (self.inner + self.outer)
        return (
            self.amplitude,
            self.amplitude * self.omega,
            self.youngs_modulus * self.amplitude / mean,
        )


@dataclass
class AxialRing(AxialSolution, Ring):
    """The same about the axis of TYPE 4."""

    def shown_displacement(self, reference: Array, time: float) -> Array:
        """Return components r, z, theta."""
        u = self.displacement(reference, time)
        return np.column_stack([u[:, 0], u[:, 2], u[:, 1]])


@dataclass
class Antiplane(Solution):
    """u_z = A sin(omega t) sin(pi X/L)^2 between free faces, L = 1 m: a simple shear c = du_z/dX.

    The Jaumann rate makes S_xz = G sin c, S_zz = -S_xx = G (1 - cos c) of it.
    """

    amplitude: float = 0.0
    origin: float = 0.0

    @property
    def omega(self) -> float:
        """Angular frequency: that of half a shear wave on the length."""
        return float(np.pi * np.sqrt(self.shear / self.density))

    def displacement(self, reference: Array, time: float) -> Array:
        """Return displacements."""
        shape = np.sin(np.pi * (reference[:, 0] - self.origin)) ** 2
        u = np.zeros_like(reference)
        u[:, 2] = self.amplitude * np.sin(self.omega * time) * shape
        return u

    def velocity(self, reference: Array, time: float) -> Array:
        """Return velocities."""
        shape = np.sin(np.pi * (reference[:, 0] - self.origin)) ** 2
        v = np.zeros_like(reference)
        v[:, 2] = self.amplitude * self.omega * np.cos(self.omega * time) * shape
        return v

    def stress(self, reference: Array, time: float) -> Array:
        """Return stresses."""
        slope = np.pi * np.sin(2 * np.pi * (reference[:, 0] - self.origin))
        c = self.amplitude * np.sin(self.omega * time) * slope
        stress = np.zeros((len(reference), 3, 3))
        stress[:, 2, 0] = stress[:, 0, 2] = self.shear * np.sin(c)
        stress[:, 2, 2] = self.shear * (1.0 - np.cos(c))
        stress[:, 0, 0] = -stress[:, 2, 2]
        return stress

    def scales(self) -> tuple[float, float, float]:
        """Return A, A omega, G pi A."""
        return (
            self.amplitude,
            self.amplitude * self.omega,
            self.shear * np.pi * self.amplitude,
        )


@dataclass
class RotatingBlock(Solution):
    """A block of side 1 m with free faces, nu = 0: x = c + Q(spin t) (y - c).

    y_i = X_i + A sin(pi X_i)^2 sin(omega t), X from the corner; without rotation the stress is
    E ln F_ii. The rigid rotation turns it.
    """

    amplitude: float = 0.0
    spin: float = 0.0
    omega: float = 1.0
    corner: tuple[float, float, float] = (0.0, 0.0, 0.0)
    dim: int = 2
    length: float = 0.5

    def vibration(self, reference: Array) -> tuple[Array, Array, Array]:
        """Return arms from the middle, displacements and strains of y over sin(omega t)."""
        angle = np.pi * (reference - self.corner)
        moves = np.arange(3) < self.dim
        u = self.amplitude * np.sin(angle) ** 2 * moves
        strain = self.amplitude * np.pi * np.sin(2 * angle) * moves
        return reference - self.corner - 0.5, u, strain

    def displacement(self, reference: Array, time: float) -> Array:
        """Return displacements."""
        arm, u, _ = self.vibration(reference)
        return turned(arm + np.sin(self.omega * time) * u, self.spin * time) - arm

    def velocity(self, reference: Array, time: float) -> Array:
        """Return velocities."""
        arm, u, _ = self.vibration(reference)
        place = turned(arm + np.sin(self.omega * time) * u, self.spin * time)
        across = self.spin * np.column_stack([-place[:, 1], place[:, 0], 0.0 * place[:, 0]])
        return across + turned(self.omega * np.cos(self.omega * time) * u, self.spin * time)

    def stress(self, reference: Array, time: float) -> Array:
        """Return Q diag(E ln F_ii) Q^T."""
        strain = np.log1p(np.sin(self.omega * time) * self.vibration(reference)[2])
        axes = turned(np.eye(3), self.spin * time)
        return self.youngs_modulus * np.einsum("nk,ki,kj->nij", strain, axes, axes)

    def scales(self) -> tuple[float, float, float]:
        """Return 1 m, the speed of a face and of the vibration, E pi A (E without vibration)."""
        strain = np.pi * self.amplitude if self.amplitude > 0.0 else 1.0
        speed = 0.5 * abs(self.spin) + self.amplitude * self.omega
        return 1.0, speed, self.youngs_modulus * strain
