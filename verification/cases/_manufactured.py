"""What the manufactured solutions share: exact states, checks of their equations, errors of frames.

A solution is a motion of points in space, with its Cauchy stress. Both are written in Cartesian
components of all three directions, whatever the simulation TYPE; in TYPE 4 the points of the
meridian plane are (r, 0, z). Body forces are not written at all: they are found from motion and
stress by numerical differentiation, and so are a second opinion on those of the program.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from harness.case import Finding, Measures, Output, Results, below, observed_order
from harness.frames import Frame
from harness.norms import Errors
from harness.scene import Points, shear_modulus

Array = npt.NDArray[np.float64]
Field = Callable[[Array, float], Array]

EPSILON = float(np.finfo(np.float64).eps)
#: Central differences of sixth order: offsets in steps, weights of first and second derivative.
OFFSETS = np.array([-3, -2, -1, 1, 2, 3])
FIRST = np.array([-1, 9, -45, 45, -9, 1]) / 60.0
SECOND = np.array([2, -27, 270, 270, -27, 2]) / 180.0
#: Points at which the equations of motion are checked.
SAMPLES = 40


@dataclass
class Solution(ABC):
    """Motion and stress of a hypoelastic body, with the constants of its material."""

    youngs_modulus: float
    poisson: float
    density: float

    #: Lengths and times over which the solution changes, for numerical differentiation.
    length: float = 1.0
    time: float = 1.0

    @property
    def shear(self) -> float:
        """Shear modulus."""
        return shear_modulus(self.youngs_modulus, self.poisson)

    @property
    def lame(self) -> float:
        """First Lame constant."""
        return 2 * self.shear * self.poisson / (1 - 2 * self.poisson)

    @property
    def wave_speed(self) -> float:
        """Speed of pressure waves."""
        return float(np.sqrt((self.lame + 2 * self.shear) / self.density))

    @abstractmethod
    def displacement(self, reference: Array, time: float) -> Array:
        """Return displacements (n, 3)."""

    @abstractmethod
    def velocity(self, reference: Array, time: float) -> Array:
        """Return velocities (n, 3)."""

    @abstractmethod
    def stress(self, reference: Array, time: float) -> Array:
        """Return Cauchy stresses (n, 3, 3)."""

    @abstractmethod
    def scales(self) -> tuple[float, float, float]:
        """Return the sizes of displacement, velocity and stress by which errors are divided."""

    def gradient(self, reference: Array, time: float) -> Array:
        """Return the deformation gradient (n, 3, 3), by differences."""
        return np.eye(3) + self.strain(reference, time)

    def strain(self, reference: Array, time: float) -> Array:
        """Return the displacement gradient (n, 3, 3), by differences."""
        return space_gradient(self.displacement, reference, time, self.step)

    @property
    def step(self) -> float:
        """Step of the differences in space."""
        return 0.01 * self.length

    def piola(self, reference: Array, time: float) -> Array:
        """Return the first Piola stress J T F^-T."""
        f = self.gradient(reference, time)
        inverse = np.linalg.inv(f).transpose(0, 2, 1)
        return np.linalg.det(f)[:, None, None] * self.stress(reference, time) @ inverse

    def body_force(self, reference: Array, time: float) -> tuple[Array, float]:
        """Return the acceleration by the body force, and the size of the terms it is made of."""
        inertia = second_rate(self.displacement, reference, time, 0.02 * self.time)
        gradients = space_gradient(self.piola, reference, time, self.step)
        internal = np.einsum("nijj->ni", gradients) / self.density
        size = float(max(np.max(np.abs(inertia)), np.max(np.abs(internal))))
        return inertia - internal, size

    def jaumann_residual(self, reference: Array, time: float) -> float:
        """Return the largest residual of the rate equation, over E times the velocity gradient."""
        step = 0.02 * self.time
        rate = first_rate(self.stress, reference, time, step)
        # The unit tensor is left out: its rounding would hide small strains.
        f_rate = first_rate(self.strain, reference, time, step)
        velocity_gradient = f_rate @ np.linalg.inv(self.gradient(reference, time))
        d = 0.5 * (velocity_gradient + velocity_gradient.transpose(0, 2, 1))
        w = velocity_gradient - d
        stress = self.stress(reference, time)
        trace = np.einsum("nii->n", d)[:, None, None]
        law = self.lame * trace * np.eye(3) + 2 * self.shear * d + w @ stress - stress @ w
        size = self.youngs_modulus * np.max(np.abs(velocity_gradient))
        return float(np.max(np.abs(rate - law)) / size)

    def basis(self, reference: Array, time: float) -> Array:
        """Return the vectors, row by row, whose components the program uses (1 or n, 3, 3)."""
        return np.eye(3)[None]

    def shown_displacement(self, reference: Array, time: float) -> Array:
        """Return the displacements as the program counts them."""
        return self.displacement(reference, time)

    def place(self, points: Points) -> Array:
        """Return the positions of points of a scene in space."""
        space = np.zeros((len(points), 3))
        if points.sim_type == 4:
            space[:, [0, 2]] = points.x
        else:
            space[:, : points.x.shape[1]] = points.x
        return space


class AxialSolution:
    """Makes a solution one of TYPE 4, with components r, z, theta at the place of a point."""

    def basis(self, reference: Array, time: float) -> Array:
        """Return e_r, e_z, e_theta."""
        place = reference + self.displacement(reference, time)
        radius = np.hypot(place[:, 0], place[:, 1])
        cosine, sine, zero = place[:, 0] / radius, place[:, 1] / radius, np.zeros(len(place))
        return np.stack(
            [
                np.column_stack([cosine, sine, zero]),
                np.column_stack([zero, zero, zero + 1.0]),
                np.column_stack([-sine, cosine, zero]),
            ],
            axis=1,
        )


def space_gradient(function: Field, reference: Array, time: float, step: float) -> Array:
    """Return the derivatives by the reference position; their direction is the last index."""
    parts = []
    for direction in np.eye(3):
        values = [function(reference + k * step * direction, time) for k in OFFSETS]
        parts.append(sum(w * v for w, v in zip(FIRST, values, strict=True)) / step)
    return np.stack(parts, axis=-1)


def first_rate(function: Field, reference: Array, time: float, step: float) -> Array:
    """Return the first derivative by time."""
    values = [function(reference, time + k * step) for k in OFFSETS]
    return sum(w * v for w, v in zip(FIRST, values, strict=True)) / step


def second_rate(function: Field, reference: Array, time: float, step: float) -> Array:
    """Return the second derivative by time."""
    values = [function(reference, time + k * step) for k in OFFSETS]
    middle = -sum(SECOND) * function(reference, time)
    return (sum(w * v for w, v in zip(SECOND, values, strict=True)) + middle) / step**2


def measure_solution(
    solution: Solution,
    out: Output,
    *,
    staggered: bool = False,
    judged: npt.NDArray[np.bool_] | None = None,
    sampled: npt.NDArray[np.bool_] | None = None,
) -> Measures:
    """Return the errors of all frames, scaled, and how far the start is from the exact state.

    Parameters
    ----------
    solution : Solution
        The exact solution.
    out : Output
        The run.
    staggered : bool
        Whether the run begins with the velocities of half a step before its start.
    judged : array of bool, optional
        Points whose errors count.
    sampled : array of bool, optional
        Points at which the equations may be checked, for solutions that have kinks elsewhere.
    """
    points, dt = out.scene.bodies[0].points, out.scene.dt
    reference = solution.place(points)
    judged = np.ones(len(points), dtype=bool) if judged is None else judged
    sampled = judged if sampled is None else sampled
    weights = points.measure[judged]
    errors = Errors(weights)
    frames = out.points()
    for frame in frames:
        lag = 0.5 * dt if frame.number > 0 else 0.5 * dt * staggered
        differences = compare(solution, reference, frame, frame.time - lag)
        if frame.number == 0:
            start = [float(np.max(np.abs(d))) for d in differences]
            continue
        for name, difference in zip(("u", "v", "stress"), differences, strict=True):
            errors.add(name, difference[judged])
    chosen = np.flatnonzero(sampled)
    chosen = chosen[np.linspace(0, len(chosen) - 1, SAMPLES).astype(int)]
    middle = frames[len(frames) // 3]
    return {
        **errors.measures(),
        "start": max(start),
        "load": check_loads(solution, reference, middle, chosen, dt),
        "jaumann": solution.jaumann_residual(reference[chosen], middle.time),
    }


def components(basis: Array, vectors: Array) -> Array:
    """Return the components (n, 3) of vectors along a basis (1 or n, 3, 3)."""
    return np.einsum("nij,nj->ni", np.broadcast_to(basis, (len(vectors), 3, 3)), vectors)


def compare(
    solution: Solution, reference: Array, frame: Frame, velocity_time: float
) -> tuple[Array, Array, Array]:
    """Return the scaled differences of displacement, velocity and stress of a frame."""
    u, v, s = solution.scales()
    basis = solution.basis(reference, frame.time)
    # TYPE 4: velocities of half a step earlier have been turned with the points to where these are
    # now; the first ones have not.
    basis_v = basis if frame.number > 0 else solution.basis(reference, velocity_time)
    exact_v = components(basis_v, solution.velocity(reference, velocity_time))
    exact_s = basis @ solution.stress(reference, frame.time) @ basis.transpose(0, 2, 1)
    exact_u = solution.shown_displacement(reference, frame.time)
    return (
        (frame["displacement"] - exact_u) / u,
        (frame["velocity"] - exact_v) / v,
        (frame["cauchy_stress"] - exact_s) / s,
    )


def check_loads(
    solution: Solution,
    reference: Array,
    frame: Frame,
    chosen: npt.NDArray[np.int_],
    dt: float,
) -> float:
    """Return the largest difference of the body forces of a frame, over the size of their terms.

    They are those of the beginning of the last step.
    """
    time = frame.time - dt
    force, size = solution.body_force(reference[chosen], time)
    shown = components(solution.basis(reference[chosen], time), force)
    return float(np.max(np.abs(frame["body_force"][chosen] - shown))) / size


def judge_start(r: Results, strain: float, truncation: float = 1e-10) -> list[Finding]:
    """Return what all runs must agree in with the exact solution, however coarse they are."""
    state = 50.0 * EPSILON * (1.0 + 1.0 / strain)
    reason = f"sixth order differences: truncation and rounding, {truncation:g}"
    return [
        below(
            "first state against the exact one",
            max(r.column("start")),
            state,
            f"rounding: 50 epsilon (1 + 1/strain), strain {strain:.2g}; two derivations",
        ),
        below(
            "body forces against differentiated stresses",
            max(r.column("load")),
            truncation,
            f"{reason}; relative to inertia and internal forces",
        ),
        below(
            "residual of the Jaumann rate",
            max(r.column("jaumann")),
            truncation,
            f"{reason}; the exact stress obeys the law of the material",
        ),
    ]


def halvings(r: Results, *names: str) -> list[Finding]:
    """Return the observed orders between neighbouring resolutions, without bounds."""
    found = []
    for name in names:
        column = r.column(name)
        for i in range(len(r.cells) - 1):
            order = observed_order(r.cells[i : i + 2], column[i : i + 2])
            found.append(Finding(f"order of {name}, {r.cells[i]} to {r.cells[i + 1]}", order))
    return found


def fitted(
    r: Results, name: str, low: float, high: float, reason: str, first: int = 0, last: int = 10**9
) -> list[Finding]:
    """Return the order by least squares over the resolutions in a range, with bounds.

    There is none when fewer than two runs of the tier are in the range.
    """
    pairs = [(p.cells, m[name]) for p, m in r if first <= p.cells <= last]
    if len(pairs) < 2:
        return []
    cells, values = zip(*pairs, strict=True)
    label = f"order of {name}, fit {cells[0]} to {cells[-1]}"
    return [Finding(label, observed_order(cells, values), low, high, reason=reason)]


def tabled(
    r: Results, name: str, table: dict[int, float], scale: float, relative: float, reason: str
) -> list[Finding]:
    """Return findings: scaled errors are those of a table, to a relative tolerance."""
    found = []
    for p, m in r:
        if p.cells in table:
            value = table[p.cells] / scale
            low, high = value * (1 - relative), value * (1 + relative)
            label = f"{name}, {p.cells} cells, table"
            found.append(Finding(label, m[name], low, high, value, reason))
    return found


def between(
    r: Results,
    name: str,
    tables: tuple[dict[int, float], dict[int, float]],
    scale: float,
    relative: float,
    reason: str,
) -> list[Finding]:
    """Return findings: scaled errors lie between those of two tables, to a relative tolerance."""
    found = []
    for p, m in r:
        if all(p.cells in table for table in tables):
            values = sorted(table[p.cells] / scale for table in tables)
            low, high = values[0] * (1 - relative), values[1] * (1 + relative)
            label = f"{name}, {p.cells} cells, between tables"
            found.append(Finding(label, m[name], low, high, reason=reason))
    return found


def interpolation_error(ppc: int, h: float, curvature: float) -> float:
    """Return the error of gradients of linear functions at points in the middles of their parts.

    The gradient of a cell is that of its middle. The points lie at distances d from there, with
    mean d^2 = h^2 (1 - 1/n^2)/12: an error of first order unless n = 1. `curvature` is the root
    mean square of the second derivative.
    """
    return curvature * h * float(np.sqrt((1.0 - 1.0 / ppc**2) / 12.0))
