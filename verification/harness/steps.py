"""Closed forms of a step: every integrator with every transfer, for a mode on evenly placed points.

A mode has the amplitudes V of the velocity on the grid and U of the displacement that the stress
has seen. With f = -dt c^2 K U, dt times the acceleration of the nodes, a transfer leaves

    V' = kept V + gained f

on the grid: FLIP kept = 1, gained = mu; PIC both mu; a blend kept = a + (1 - a) mu, gained = mu;
XPIC(k) kept = 1 - (1 - mu)^k, gained = mu; APIC and MLS both mu_A = mean(|S|^2 + |T|^2/D). The
integrators differ in the velocity that the stress sees: U' = U + dt (V + f) in USL, dt V' in MUSL,
and dt V before the forces in USF. See docs/verification.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .scheme import Scheme
from .theory import near_nodes, node_functions, point_offsets

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
#: Mean square distance of the nodes from a point, in cells, up to which derivatives are not fitted.
LEAST_SPREAD = 1e-3


@dataclass(frozen=True)
class PointSums:
    """Sums over the nodes that the points of a cell reach, with lengths in cells.

    S = sum N_i e^(ik(x_i - x)), G = sum N_i' e^(ik(x_i - x)), and for affine fields the fitted
    slope `fit` and T = sum N_i (x_i - x) e^(ik(x_i - x)), which brings them to the nodes.
    """

    places: Array
    s: Complex
    g: Complex
    fit: Complex
    t: Complex

    @classmethod
    def of(cls, kh: float, n: int, shift: float = 0.0, basis: str = "linear") -> PointSums:
        """Return the sums of n points a cell, `shift` cells off the symmetric places."""
        places = point_offsets(n, shift)
        distance = places[:, None] - near_nodes(places)
        values, slopes = node_functions(basis, distance, n)
        phases = np.exp(-1j * kh * distance)
        spread = np.sum(values * distance**2, axis=1)
        t = np.sum(-distance * values * phases, axis=1)
        g = np.sum(slopes * phases, axis=1)
        # The fit to hats is their derivative.
        fitted = (spread > LEAST_SPREAD) & (basis != "linear")
        fit = np.where(fitted, t / np.where(fitted, spread, 1.0), g)
        return cls(places, np.sum(values * phases, axis=1), g, fit, t)


@dataclass(frozen=True)
class ModeSteps:
    """Steps of a scheme for one mode.

    Parameters
    ----------
    scheme : Scheme
        Integrator, transfer and start.
    k2 : float
        K h^2, the mean over the points of the squared gradient.
    mu : float
        Filter from the grid to the points and back.
    mu_affine : float
        The same with affine fields.
    """

    scheme: Scheme
    k2: float
    mu: float
    mu_affine: float = 1.0

    @classmethod
    def of(
        cls, scheme: Scheme, kh: float, n: int, shift: float = 0.0, basis: str = "linear"
    ) -> ModeSteps:
        """Return the steps for a wave number and points."""
        sums = PointSums.of(kh, n, shift, basis)
        slope = sums.fit if scheme.transfer == "MLS" else sums.g
        mu = float(np.mean(np.abs(sums.s) ** 2))
        affine = float(np.mean((np.conj(sums.t) * sums.fit).real))
        return cls(scheme, float(np.mean(np.abs(slope) ** 2)), mu, mu + affine)

    @property
    def kept(self) -> float:
        """What a step without force leaves of the velocity on the grid."""
        name, flip = self.scheme.transfer, self.scheme.flip
        if name == "FLIP":
            return flip + (1.0 - flip) * self.mu
        if name == "XPIC":
            return 1.0 - (1.0 - self.mu) ** self.scheme.xpic
        return self.gained

    @property
    def gained(self) -> float:
        """What a step leaves on the grid of the increment that it gave."""
        return self.mu_affine if self.scheme.transfer in ("APIC", "MLS") else self.mu

    def matrix(self, cfl: float) -> Array:
        """Return a step on (V, U/dt) for a Courant number."""
        kept, z = self.kept, cfl**2 * self.k2
        pull = self.gained * z
        if self.scheme.solver == "MUSL":
            return np.array([[kept, -pull], [kept, 1.0 - pull]])
        if self.scheme.solver == "USF":
            return np.array([[kept - pull, -pull], [1.0, 1.0]])
        return np.array([[kept, -pull], [1.0, 1.0 - z]])

    def determinant(self, cfl: float) -> float:
        """Return the factor of the energy in a step of an oscillating mode."""
        if self.scheme.solver == "USL":
            return self.kept - cfl**2 * self.k2 * (self.kept - self.gained)
        return self.kept

    def eigenvalue(self, cfl: float) -> complex:
        """Return the eigenvalue of a step with the larger angle."""
        values = np.linalg.eigvals(self.matrix(cfl))
        return complex(values[np.argmax(np.angle(values))])

    def growth(self, cfl: float) -> float:
        """Return the largest magnitude of the eigenvalues of a step."""
        return float(np.max(np.abs(np.linalg.eigvals(self.matrix(cfl)))))

    def limit(self) -> float:
        """Return the largest stable Courant number of this mode; infinite without stiffness.

        The eigenvalue that passes -1: z (1 + kept - gained) = 2 (1 + kept) in USL, z gained =
        2 (1 + kept) in MUSL and USF.
        """
        pull = self.gained if self.scheme.solver != "USL" else 1.0 + self.kept - self.gained
        if self.k2 * pull <= 0.0:
            return np.inf
        return float(np.sqrt(2.0 * (1.0 + self.kept) / (self.k2 * pull)))

    def energy(self, v: Array | float, u: Array | float, cfl: float) -> Array | float:
        """Return the quadratic form of (V, u = U/dt) that a step multiplies by its determinant.

        V u' - u V', the area between a state and the next one, is a modified energy: V^2 + mu z u^2
        - mu z V u for MUSL with FLIP.
        """
        a = self.matrix(cfl)
        return a[1, 0] * v**2 + (a[1, 1] - a[0, 0]) * v * u - a[0, 1] * u**2


def stability_limit(scheme: Scheme, n: int, shift: float = 0.0, basis: str = "linear") -> float:
    """Return the largest Courant number at which no mode grows, in one dimension."""
    waves = np.linspace(1e-3, np.pi, 2001)
    return min(ModeSteps.of(scheme, kh, n, shift, basis).limit() for kh in waves)


def energy_loss_per_period(
    scheme: Scheme, kh: float, n: int, cfl: float, basis: str = "linear"
) -> float:
    """Return the part of the energy of an oscillating mode that a period loses."""
    steps = ModeSteps.of(scheme, kh, n, basis=basis)
    value = steps.eigenvalue(cfl)
    return 1.0 - float(np.abs(value)) ** (2.0 * 2.0 * np.pi / float(np.angle(value)))


@dataclass(frozen=True)
class March:
    """A mode step by step, from displacement 0; amplitudes on the grid.

    `stress`: displacement that the stress has seen; `moved`: that by which the points have moved,
    both over dt; `velocity` on the grid; the points have `own` of the velocities that they began
    with, plus S times `given`.
    """

    stress: Complex
    moved: Complex
    velocity: Complex
    own: Array
    given: Complex


def march(steps: ModeSteps, velocity: complex, cfl: float, number: int) -> March:
    """Follow a mode over a number of steps.

    Parameters
    ----------
    steps : ModeSteps
        The mode.
    velocity : complex
        Velocity on the grid after the first mapping, affine fields included.
    cfl : float
        Courant number.
    number : int
        Number of steps.
    """
    scheme, z, mu = steps.scheme, cfl**2 * steps.k2, steps.mu
    kept = scheme.flip if scheme.transfer == "FLIP" else 0.0
    extra = 0.0
    if scheme.transfer == "XPIC":
        extra = sum((1.0 - mu) ** j for j in range(1, scheme.xpic))
    v, u, w, own, given = complex(velocity), 0j, 0j, 1.0, 0j
    rows: list[Sequence[complex]] = [(u, w, v, own, given)]
    for step in range(number):
        late = scheme.staggered and step == 0
        if scheme.solver == "USF" and not late:
            u += v
        f = -z * u * (0.5 if late else 1.0)
        w += v + f
        given = kept * given + kept * f + (1.0 - kept) * (v + f) + extra * v
        own *= kept
        new = steps.kept * v + steps.gained * f
        if scheme.solver == "USL":
            u += v + f
        elif scheme.solver == "MUSL":
            u += new
        v = new
        rows.append((u, w, v, own, given))
    table = np.array(rows, dtype=complex).T
    return March(table[0], table[1], table[2], table[3].real, table[4])
