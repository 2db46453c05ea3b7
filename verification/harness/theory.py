"""Closed forms for linear functions, lumped mass and FLIP: dispersion, stability, energy loss.

A mode k on uniformly placed points, `n` a cell, has two means over the points of a cell: K of the
squared discrete gradient and mu, the filter from the grid to the points and back. The grid steps
obey omega_h^2 = c^2 K mu, see docs/verification.md. The corner-averaged functions have the same K
and mu on points at rest whose boxes tile the bar.
"""

from __future__ import annotations

import numpy as np


def tent(distance: np.ndarray) -> np.ndarray:
    """Return the linear function at a distance in cells."""
    return np.maximum(0.0, 1.0 - np.abs(distance))


def point_offsets(n: int, shift: float = 0.0) -> np.ndarray:
    """Return the places of n points in a cell, in cells."""
    return (np.arange(n) + 0.5) / n + shift


def symbols(kh: float, n: int, shift: float = 0.0) -> tuple[float, float]:
    """Return K h^2 and mu of a mode with k h = kh for linear functions.

    Parameters
    ----------
    kh : float
        Wave number times cell size.
    n : int
        Points per cell.
    shift : float
        Offset of the points from the symmetric places, in cells.
    """
    offsets = np.mod(point_offsets(n, shift), 1.0)
    phases = np.exp(-1j * kh * offsets), np.exp(1j * kh * (1.0 - offsets))
    sums = (1.0 - offsets) * phases[0] + offsets * phases[1]
    gradients = -phases[0] + phases[1]
    return float(np.mean(np.abs(gradients) ** 2)), float(np.mean(np.abs(sums) ** 2))


def amplification(kh: float, n: int, cfl: float) -> np.ndarray:
    """Return the two eigenvalues of a USL step of FLIP for a mode.

    V is the amplitude of the velocity on the grid, f = dt times that of the acceleration. The
    points receive f and map it back, filtered by mu; the stress changes by the gradient of V + f:
    V' = V + mu f, f' = f - z (V + f) with z = c^2 K dt^2.
    """
    k2, mu = symbols(kh, n)
    z = cfl**2 * k2
    return np.linalg.eigvals(np.array([[1.0, mu], [-z, 1.0 - z]]))


def frequency_ratio(kh: float, n: int, cfl: float) -> float:
    """Return omega_h/omega of the scheme with its time steps."""
    return float(np.max(np.angle(amplification(kh, n, cfl)))) / (cfl * kh)


def dispersion_constant(n: int) -> float:
    """Return kappa of omega_h/omega = 1 - kappa (kh)^2: 1/8 + 1/(24 n^2)."""
    return 1.0 / 8.0 + 1.0 / (24.0 * n**2)


def filter_constant(n: int) -> float:
    """Return a of 1 - mu = a (kh)^2: 1/6 + 1/(12 n^2)."""
    return 1.0 / 6.0 + 1.0 / (12.0 * n**2)


def stability_limit(n: int, shift: float = 0.0) -> float:
    """Return the largest stable Courant number of USL in one dimension.

    z = c^2 K dt^2 <= 4/(2 - mu) for every mode.
    """
    limits = []
    for kh in np.linspace(1e-3, np.pi, 2000):
        k2, mu = symbols(kh, n, shift)
        if k2 > 0.0:
            limits.append(np.sqrt(4.0 / ((2.0 - mu) * k2)))
    return float(min(limits))


def energy_loss_per_period(kh: float, n: int, cfl: float) -> float:
    """Return the relative loss of energy in a period: 2 pi a CFL (kh)^3."""
    return 2.0 * np.pi * filter_constant(n) * cfl * kh**3
