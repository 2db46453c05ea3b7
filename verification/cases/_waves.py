"""What the cases of waves share: bars, and waves of the discrete equations in closed form.

On a uniform lattice of points at rest the steps of USL with FLIP have plane waves as exact
solutions. Let N_i be the functions of the nodes, and for a wave number k

    S_p = sum_i N_i(x_p) e^(ik(x_i - x_p)),   D_p = sum_i grad N_i(x_p) e^(ik(x_i - x_p)).

A wave V e^(ik x_i) of the grid gives velocities S_p V and gradients D_p V to the points; masses,
velocities and stresses come back to the nodes as means over the points of a cell. With
mu = mean |S_p|^2 and K = mean D_p* C D_p/rho (c^2 mean |D_p|^2 in one dimension) a step is

    f = -dt K U,   U := U + dt (V + f),   V := V + mu f,

where U is the amplitude of the displacement of the grid, and u_p = S_p U, stress_p = C D_p U. Walls
reflect: with images the waves become sines and cosines, and the same equations hold.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from harness.case import Parameters
from harness.scene import DIM, Body, Points, Scene, lattice, pressure_wave_modulus, stable_dt
from harness.scheme import FEWEST_CELLS as FEWEST
from harness.theory import cell_symbols, grid_functions, near_nodes, node_functions

Array = npt.NDArray[np.float64]

LENGTH, DENSITY, YOUNG = 1.0, 1000.0, 1e7
#: Codes of the walls of CartesianBoxCustom.
FREE, STICK, SLIP, TRACTION = -1, 0, 1, 5


def wave_speed(p: Parameters) -> float:
    """Return the speed of pressure waves."""
    return float(np.sqrt(pressure_wave_modulus(YOUNG, p.number("nu", 0.0)) / DENSITY))


@dataclass(frozen=True)
class Walls:
    """Codes of the walls, face by face: -x, +x, -y, +y, -z, +z; and the values they take."""

    codes: Sequence[int]
    values: Sequence[float] = ()

    def section(self) -> str:
        """Return what the section of a body says of its boundary."""
        if all(code == SLIP for code in self.codes):
            return "CartesianSmoothBox"
        if all(code == STICK for code in self.codes):
            return "CartesianBox"
        lines = [
            'boundary-class = "CartesianBoxCustom"',
            f"    boundary-int-props = {{{', '.join(map(str, self.codes))}}}",
        ]
        if self.values:
            lines.append(f"    boundary-props = {{{', '.join(map(repr, self.values))}}}")
        return "\n".join(lines)


@dataclass
class Bar:
    """A bar from 0 to LENGTH along one axis, between smooth walls on its sides.

    Options of the row: `axis` (0, 1, 2), `nu`, `width` (cells across), `inner` (TYPE 4: cells from
    the axis to the inner radius of a tube), `shift` (offset of the points along the bar from the
    symmetric places, in cells), `cfl`.
    """

    p: Parameters
    #: Cells along the bar; by default the resolution of the run.
    cells: int = 0
    #: The wall at LENGTH; when it is FREE, a row of empty cells lies beyond.
    end: int = SLIP
    #: Component in which the bar moves; by default along itself.
    component: int = -1
    values: Sequence[float] = ()
    #: Whether the grid repeats along the bar.
    periodic: bool = False
    axis: int = field(init=False)

    def __post_init__(self) -> None:
        """Fill in what follows from the row."""
        self.cells = self.cells or self.p.cells
        self.axis = int(self.p.number("axis", 1 if self.p.sim_type == 4 else 0))
        if self.component < 0:
            self.component = self.axis

    @property
    def h(self) -> float:
        """Size of the cells."""
        return LENGTH / self.cells

    @property
    def c(self) -> float:
        """Speed of pressure waves."""
        return wave_speed(self.p)

    @property
    def modulus(self) -> float:
        """Pressure wave modulus."""
        return pressure_wave_modulus(YOUNG, self.p.number("nu", 0.0))

    def counts(self) -> tuple[list[int], list[int], list[int]]:
        """Return lower and upper corner of the bar, and the cells of the grid, in cells."""
        dim = DIM[self.p.sim_type]
        width = int(self.p.number("width", max(1 if dim == 3 else 2, FEWEST[self.p.mapping])))
        lower, upper = [0] * dim, [width] * dim
        upper[self.axis] = self.cells
        grid = list(upper)
        grid[self.axis] += self.end == FREE
        if self.p.sim_type == 4:
            lower[0] = int(self.p.number("inner", 0))
        return lower, upper, grid

    def points(self, velocity: Callable[[Array], Array]) -> Points:
        """Fill the bar; the velocity is a function of the coordinate along it."""
        lower, upper, _ = self.counts()
        counts = [(b - a) * self.p.ppc for a, b in zip(lower, upper, strict=True)]
        low, high = [n * self.h for n in lower], [n * self.h for n in upper]
        low[self.axis] += self.p.number("shift", 0.0) * self.h
        high[self.axis] += self.p.number("shift", 0.0) * self.h
        points = lattice(self.p.sim_type, low, high, counts, DENSITY)
        points.velocity[:, self.component] = velocity(points.x[:, self.axis])
        return points

    def walls(self) -> Walls:
        """Return the walls: smooth at the lower end and on the sides."""
        codes = [SLIP] * (2 * DIM[self.p.sim_type])
        codes[2 * self.axis + 1] = self.end
        return Walls(codes, self.values)

    def scene(
        self,
        velocity: Callable[[Array], Array],
        t_stop: float,
        frames: int,
        gravity: float = 0.0,
        walls: Walls | None = None,
    ) -> Scene:
        """Return the scene; gravity acts along the bar."""
        grid = self.counts()[2]
        body = Body(
            "bar",
            self.points(velocity),
            YOUNG,
            self.p.number("nu", 0.0),
            (walls or self.walls()).section(),
        )
        pull = [0.0] * 3
        pull[self.axis] = gravity
        made = Scene(
            self.p.sim_type,
            [n * self.h for n in grid],
            grid,
            [body],
            t_stop,
            self.dt(t_stop, frames),
            frames,
            self.p.mapping,
            gravity=pull[: len(body.points.velocity[0])],
        )
        if self.periodic:
            made.periodic = [d == self.axis for d in range(len(grid))]
        return made

    def dt(self, t_stop: float, frames: int) -> float:
        """Return the time step."""
        return stable_dt(LENGTH, self.cells, self.c, t_stop, self.p.number("cfl", 0.2), frames)

    def cfl(self, dt: float) -> float:
        """Return the Courant number of a time step."""
        return self.c * dt / self.h


def interpolate(
    function: Callable[[Array], Array], x: Array, h: float, basis: str = "linear", n: int = 1
) -> Array:
    """Return what points get of a function's values at the nodes; n points a cell."""
    nodes = near_nodes(x / h)
    return np.sum(node_functions(basis, (x / h)[:, None] - nodes, n)[0] * function(nodes * h), 1)


def slope(
    function: Callable[[Array], Array], x: Array, h: float, basis: str = "linear", n: int = 1
) -> Array:
    """Return the gradient that points see of a function's values at the nodes."""
    nodes = near_nodes(x / h)
    slopes = node_functions(basis, (x / h)[:, None] - nodes, n)[1]
    return np.sum(slopes * function(nodes * h), 1) / h


@dataclass(frozen=True)
class Symbols:
    """Means over the points of a cell along one direction."""

    #: mean |S|^2, mean |h D|^2, and mean conj(h D) S, which is imaginary on symmetric points.
    mu: float
    k2: float
    mixed: complex
    #: mean S.
    s: complex


def symbols(kh: float, n: int, shift: float = 0.0, basis: str = "linear") -> Symbols:
    """Return the means of `cell_symbols`."""
    s, d = cell_symbols(kh, n, shift, basis)
    return Symbols(
        float(np.mean(np.abs(s) ** 2)),
        float(np.mean(np.abs(d) ** 2)),
        complex(np.mean(np.conj(d) * s)),
        complex(np.mean(s)),
    )


@dataclass(frozen=True)
class DiscreteWave:
    """A standing wave of the discrete equations: amplitudes on the grid, step by step.

    Parameters
    ----------
    stiffness : float
        K, 1/s^2.
    mu : float
        Filter from the grid to the points and back.
    """

    stiffness: float
    mu: float

    def matrix(self, dt: float) -> Array:
        """Return a step as a matrix on (V, f): V' = V + mu f, f' = f - K dt^2 (V + f)."""
        z = self.stiffness * dt**2
        return np.array([[1.0, self.mu], [-z, 1.0 - z]])

    def eigenvalue(self, dt: float) -> complex:
        """Return the eigenvalue of a step with the larger angle."""
        values = np.linalg.eigvals(self.matrix(dt))
        return complex(values[np.argmax(np.angle(values))])

    def frequency(self, dt: float) -> float:
        """Return the frequency with its time steps."""
        return float(np.angle(self.eigenvalue(dt))) / dt

    def energy_loss(self, dt: float) -> float:
        """Return the rate at which the energy decays: E ~ exp(-rate t)."""
        return -2.0 * float(np.log(np.abs(self.eigenvalue(dt)))) / dt

    def march(self, velocity: complex, dt: float, steps: int) -> tuple[Array, Array]:
        """Return U and the sum of f after 0, 1, ... steps from rest at zero displacement.

        `velocity` is the velocity of the grid at the start.
        """
        v, u, total = velocity, 0.0, 0.0
        displacements, sums = [u], [total]
        for _ in range(steps):
            f = -dt * self.stiffness * u
            u += dt * (v + f)
            v += self.mu * f
            total += f
            displacements.append(u)
            sums.append(total)
        return np.array(displacements), np.array(sums)


def bar_wave(
    kh: float, n: int, c: float, h: float, shift: float = 0.0, basis: str = "linear"
) -> DiscreteWave:
    """Return a wave along a bar."""
    means = symbols(kh, n, shift, basis)
    return DiscreteWave(c**2 * means.k2 / h**2, means.mu)


def walls_reflect(p: Parameters) -> bool:
    """Tell whether waves between walls are those of an endless grid, odd or even about the walls.

    Splines next to a wall have less mass at the first node inside than elsewhere; the boxes of
    uGIMP, as the points of a filled grid, do not reach over walls.
    """
    return p.mapping not in ("quadratic", "cubic")


class BarScheme:
    """The discrete equations of small motions of a bar as matrices, for every basis, with its ends.

    Masses are those of `values` summed over the points, in masses of a full node.

    Parameters
    ----------
    bar : Bar
        The bar; held at 0, and at its end unless that is free.
    held : bool, optional
        Whether its end is held; by default if its wall is smooth.
    """

    def __init__(self, bar: Bar, held: bool | None = None) -> None:
        n, h, grid = bar.p.ppc, bar.h, bar.counts()[2][bar.axis]
        places = (np.arange(n * bar.cells) + 0.5) / n + bar.p.number("shift", 0.0)
        self.x = places * h
        self.values, slopes = grid_functions(bar.p.mapping, places, grid, n)
        self.slopes = slopes / h
        self.mass = self.values.sum(axis=0) / n
        share = np.where(self.mass > 0.0, 1.0 / np.maximum(self.mass, 1e-300), 0.0)[:, None] / n
        self.to_nodes = share * self.values.T
        self.filter = self.to_nodes @ self.values
        self.stiffness = bar.c**2 * share * (self.slopes.T @ self.slopes)
        self.free = np.ones(grid + 1, dtype=bool)
        self.free[0] = False
        if bar.end == SLIP if held is None else held:
            self.free[-1] = False

    def march(
        self, velocity: Array, acceleration: Array, dt: float, steps: int, every: int
    ) -> tuple[Array, Array]:
        """Return displacements of the nodes and sums of their velocity increments.

        Parameters
        ----------
        velocity : Array
            Velocities of the points at the start, by rising place.
        acceleration : Array
            Accelerations of the nodes by loads.
        dt, steps, every : float, int, int
            Time step, number of steps, steps between two rows of the results.

        Returns
        -------
        tuple[Array, Array]
            Both (frames, nodes).
        """
        v = np.where(self.free, self.to_nodes @ velocity, 0.0)
        u, total = np.zeros(len(v)), np.zeros(len(v))
        shown = [(u, total)]
        for step in range(1, steps + 1):
            f = np.where(self.free, dt * (acceleration - self.stiffness @ u), 0.0)
            u = u + dt * (v + f)
            v = np.where(self.free, v + self.filter @ f, 0.0)
            total = total + f
            if step % every == 0:
                shown.append((u, total))
        return np.array([u for u, _ in shown]), np.array([total for _, total in shown])

    def eigenvalue(self, dt: float, guess: float) -> complex:
        """Return the eigenvalue of a step whose frequency is next to a guess."""
        live = self.free & (self.mass > 0.0)
        one, z = np.eye(np.count_nonzero(live)), dt**2 * self.stiffness[np.ix_(live, live)]
        step = np.block([[one, -self.filter[np.ix_(live, live)] @ z], [one, one - z]])
        values = np.linalg.eigvals(step)
        return complex(values[np.argmin(np.abs(np.angle(values) - guess * dt))])


def fit_oscillation(times: Array, values: Array, guess: float) -> tuple[float, float]:
    """Return frequency and rate of decay of exp(-d t) (a sin(w t) + b cos(w t)).

    Gauss-Newton iterations from a good guess of the frequency, no decay to begin with.
    """
    omega, decay = guess, 0.0
    for _ in range(50):
        envelope = np.exp(-decay * times)
        sine, cosine = envelope * np.sin(omega * times), envelope * np.cos(omega * times)
        a, b = np.linalg.lstsq(np.column_stack([sine, cosine]), values, rcond=None)[0]
        model = a * sine + b * cosine
        by_omega, by_decay = times * (a * cosine - b * sine), -times * model
        jacobian = np.column_stack([sine, cosine, by_omega, by_decay])
        change = np.linalg.lstsq(jacobian, values - model, rcond=None)[0]
        omega += change[2]
        decay += change[3]
        if max(abs(change[2]), abs(change[3])) < 1e-13 * guess:
            break
    return float(omega), float(decay)


def bessel(order: int, x: npt.ArrayLike) -> Array:
    """Return J_n(x) from (1/pi) int_0^pi cos(n t - x sin t) dt.

    The trapezoidal rule on the periodic integrand with m intervals is exact but for J_(2m-n)(x),
    below the roundings for |x| < 20 and m = 64.
    """
    t = np.linspace(0.0, np.pi, 65)
    values = np.cos(order * t - np.multiply.outer(np.asarray(x, dtype=float), np.sin(t)))
    return (np.sum(values[..., 1:-1], axis=-1) + 0.5 * (values[..., 0] + values[..., -1])) / 64


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the zero of a function between two places where it has different signs."""
    sign = np.sign(function(low))
    for _ in range(200):
        middle = 0.5 * (low + high)
        if np.sign(function(middle)) == sign:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
