"""What the cases of invariance, conservation and hard cases share: points, sums, estimates."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from harness.case import Parameters
from harness.frames import Frame
from harness.scene import DIM, NVEL, UP, Points
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Rounding unit of double precision, as Fortran's epsilon.
EPS = float(np.finfo(float).eps)
#: Digits that frames need to lose nothing.
ALL_DIGITS = 17


def join(parts: Sequence[Points]) -> Points:
    """Put the points of several parts into one body, in order."""
    return Points(
        parts[0].sim_type,
        np.concatenate([part.x for part in parts]),
        np.concatenate([part.volume for part in parts]),
        np.concatenate([part.mass for part in parts]),
        np.concatenate([part.velocity for part in parts]),
    )


def free_box(dim: int, faces: dict[str, int] | None = None, values: Sequence[float] = ()) -> str:
    """Return the lines of a boundary whose faces are free unless `faces` gives them a code.

    Parameters
    ----------
    dim : int
        Directions of the grid.
    faces : dict[str, int]
        Codes of faces by name, such as ``x_lower``.
    values : Sequence[float]
        What the codes take.
    """
    names = [f"{axis}_{side}" for axis in "xyz"[:dim] for side in ("lower", "upper")]
    chosen = faces or {}
    codes = ", ".join(f"{name} = {chosen.get(name, -1)}" for name in names)
    lines = f'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {{{codes}}}'
    if values:
        lines += f"\n    boundary-props = {{{', '.join(map(repr, values))}}}"
    return lines


def free_faces(p: Parameters) -> str:
    """Return a boundary with free faces; on the axis of TYPE 4 the radial velocity is 0."""
    return free_box(DIM[p.sim_type], {"x_lower": 1} if p.sim_type == 4 else {})


def momentum(frame: Frame, velocity: Array | None = None) -> Array:
    """Return the sum of m v over the points, exactly rounded."""
    v = frame["velocity"] if velocity is None else velocity
    return np.array([math.fsum(frame["mass"] * v[:, c]) for c in range(v.shape[1])])


def angular_momentum(frame: Frame, center: Array) -> Array:
    """Return the sum of (x - center) x m v over the points."""
    turns = np.cross(frame.x - center, frame["velocity"])
    return np.array([math.fsum(frame["mass"] * turns[:, c]) for c in range(3)])


def kinetic_energy(frame: Frame) -> float:
    """Return the kinetic energy."""
    return 0.5 * math.fsum(frame["mass"] * np.sum(frame["velocity"] ** 2, axis=1))


def strain_energy(frame: Frame, shear: float, bulk: float) -> float:
    """Return the sum of V (s:s/(4 G) + p^2/(2 K)) over the points."""
    stress = frame["cauchy_stress"]
    pressure = -np.trace(stress, axis1=1, axis2=2) / 3.0
    deviator = stress + pressure[:, None, None] * np.eye(3)
    density = np.sum(deviator**2, axis=(1, 2)) / (4.0 * shear) + pressure**2 / (2.0 * bulk)
    return math.fsum(frame["volume"] * density)


def bulk_modulus(youngs_modulus: float, poisson: float) -> float:
    """Return K = E/(3 (1 - 2 nu))."""
    return youngs_modulus / (3.0 * (1.0 - 2.0 * poisson))


def vector(sim_type: int, components: Sequence[float]) -> Array:
    """Return a vector with as many components as velocities have."""
    v = np.zeros(NVEL[sim_type])
    v[: len(components)] = components
    return v


def upward(sim_type: int, amount: float) -> Array:
    """Return a vector along the vertical."""
    v = np.zeros(NVEL[sim_type])
    v[UP[sim_type]] = amount
    return v


def directions(sim_type: int) -> Array:
    """Return unit vectors along which bodies fly: axes, diagonals, and between them (n, dim)."""
    dim = DIM[sim_type]
    if dim == 1:
        return np.array([[1.0], [-1.0]])
    if sim_type == 4:
        return np.array([[0.0, 1.0], [0.0, -1.0]])
    if dim == 2:
        angles = 2.0 * np.pi * np.arange(16) / 16
        return np.column_stack([np.cos(angles), np.sin(angles)])
    signs = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    chosen = [np.array(s, float) for s in signs if abs(s[0]) + abs(s[1]) + abs(s[2]) in (1, 3)]
    return np.array([s / np.linalg.norm(s) for s in chosen])


def lopsided(sim_type: int, s: Array) -> Array:
    """Return velocities of order 1 of no symmetry, smooth in s, the position over the body's size."""
    v = np.zeros((len(s), NVEL[sim_type]))
    first, last = s[:, 0], s[:, -1]
    v[:, 0] = 0.5 + 0.5 * np.sin(2.1 * first + 1.3 * last + 0.4)
    if sim_type == 4:
        # Radial motion and swirl vanish on the axis.
        v[:, 0] = first * np.cos(1.7 * last + 0.3)
        v[:, 2] = first * np.sin(1.1 * last + 0.9)
    if sim_type in (3, 5):
        v[:, 2] = 0.5 * np.sin(1.9 * last - 1.4 * first + 0.2)
    if NVEL[sim_type] > 1:
        v[:, 1] = -0.3 + 0.5 * np.cos(2.3 * last + 1.1 * first)
    return v


def without_rigid_motion(points: Points, *, keep_spin: bool = False) -> Array:
    """Return velocities less the mean ones and, unless it is kept, less the mean rotation."""
    n, dim = points.x.shape
    mass = points.total_mass
    x, v = np.zeros((n, 3)), np.zeros((n, 3))
    x[:, :dim], v[:, : points.velocity.shape[1]] = points.x, points.velocity
    held = [0, 2] if points.sim_type == 4 else []
    mean = mass @ v / np.sum(mass)
    mean[held] = 0.0
    v -= mean
    if not keep_spin and dim > 1 and points.sim_type != 4:
        arm = x - mass @ x / np.sum(mass)
        planar = dim == 2
        spin = mass @ np.cross(arm, v * ([1.0, 1.0, 0.0] if planar else 1.0))
        squares = np.einsum("n,ni,nj->ij", mass, arm, arm)
        inertia = np.trace(squares) * np.eye(3) - squares
        rate = np.array([0.0, 0.0, spin[2] / inertia[2, 2]])
        v -= np.cross(rate if planar else np.linalg.solve(inertia, spin), arm)
    return v[:, : points.velocity.shape[1]]
