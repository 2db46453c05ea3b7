"""Standing waves along the axes of a box: exact solution, scene, and what the scheme makes of them.

While displacements are so small that no point changes its cell, the steps are linear. On a wave of
the grid, V e^(ikx_i), a point at offset j in its cell sees S_j V and the gradient D_j V. A step is

    V = mean S_j* v_j,   f = -dt/rho mean D_j* T_j,
    v_j += S_j f,   u_j += dt S_j (V + f),   T_j += dt M D_j (V + f),

with means over the points of a cell. Walls reflect, so that the imaginary parts are the solution in
a box. `modal_errors` follows these few numbers from the exact start: the errors that a correct
program must show.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from _manufactured import Solution
from harness.case import Finding, Output, Parameters
from harness.scene import DIM, Body, Scene, lattice, section, stable_dt
from harness.scheme import Scheme
from harness.steps import PointSums
from harness.theory import cell_symbols, grid_functions, point_offsets

Array = npt.NDArray[np.float64]

#: USL with FLIP.
PLAIN = Scheme()
LENGTH, DENSITY, YOUNG = 1.0, 1000.0, 1e7
WAVE_NUMBER = np.pi / LENGTH
PHASES = {1: [0.0], 2: [0.0, np.pi], 3: [0.0, 2 * np.pi / 3, 4 * np.pi / 3], 5: [0.0, np.pi]}
NAMES = ("phi_x", "phi_y", "phi_z")


@dataclass
class AxisAligned(Solution):
    """u_i = A sin(k X_i) sin(omega t + phi_i); the stress is logarithmic since nothing turns."""

    amplitude: float = 0.0
    phases: list[float] = field(default_factory=list)

    @property
    def omega(self) -> float:
        """Angular frequency: that of a small free wave."""
        return float(WAVE_NUMBER * self.wave_speed)

    def displacement(self, reference: Array, time: float) -> Array:
        """Return displacements."""
        u = np.zeros_like(reference)
        for d, phase in enumerate(self.phases):
            shape = np.sin(WAVE_NUMBER * reference[:, d])
            u[:, d] = self.amplitude * shape * np.sin(self.omega * time + phase)
        return u

    def velocity(self, reference: Array, time: float) -> Array:
        """Return velocities."""
        v = np.zeros_like(reference)
        for d, phase in enumerate(self.phases):
            shape = np.sin(WAVE_NUMBER * reference[:, d])
            v[:, d] = self.amplitude * self.omega * shape * np.cos(self.omega * time + phase)
        return v

    def stress(self, reference: Array, time: float) -> Array:
        """Return stresses T_ii = lambda ln J + 2 G ln F_ii."""
        strain = np.zeros_like(reference)
        for d, phase in enumerate(self.phases):
            shape = np.cos(WAVE_NUMBER * reference[:, d])
            strain[:, d] = np.log1p(
                self.amplitude * WAVE_NUMBER * shape * np.sin(self.omega * time + phase)
            )
        trace = np.sum(strain, axis=1, keepdims=True)
        return np.eye(3) * (self.lame * trace + 2 * self.shear * strain)[:, :, None]

    def scales(self) -> tuple[float, float, float]:
        """Return A, A omega, M k A."""
        modulus = self.lame + 2 * self.shear
        return self.amplitude, self.amplitude * self.omega, modulus * WAVE_NUMBER * self.amplitude


def starts_early(p: Parameters) -> int:
    """Return 1 where the first velocities are those of half a step before the start.

    That is `staggered=1`; with `staggered=yes` the solver advances those of the start by half a
    step first.
    """
    return int(p.text("staggered", "0") == "1")


def solution(p: Parameters) -> AxisAligned:
    """Return the exact solution of a row; option phase shifts all phases."""
    phases = [phi + p.number("phase", 0.0) * np.pi for phi in PHASES[p.sim_type]]
    found = AxisAligned(
        YOUNG,
        p.number("nu", 0.0 if p.sim_type == 1 else 0.3),
        DENSITY,
        amplitude=p.number("amplitude", 1e-6),
        phases=phases,
    )
    found.time = 1.0 / found.omega
    return found


def make_scene(p: Parameters, cells: int, steps: int, frames: int) -> Scene:
    """Return a box full of points between smooth walls."""
    exact, dim = solution(p), DIM[p.sim_type]
    t_stop = p.number("periods", 1.0) * 2 * LENGTH / exact.wave_speed
    points = lattice(p.sim_type, [0.0] * dim, [LENGTH] * dim, [cells * p.ppc] * dim, DENSITY)
    constants = {
        "t_stop": t_stop,
        "amplitude": exact.amplitude,
        "length": LENGTH,
        "density": DENSITY,
        "E": YOUNG,
        "nu": exact.poisson,
    }
    constants |= dict(zip(NAMES, exact.phases, strict=False))
    driver = section("AxisAlignedDriver", constants, {"staggered": int(starts_early(p))})
    body = Body("box", points, YOUNG, exact.poisson, "CartesianSmoothBox")
    return Scene(
        p.sim_type,
        [LENGTH] * dim,
        [cells] * dim,
        [body],
        t_stop,
        t_stop / steps,
        frames,
        p.mapping,
        driver=driver,
    )


def steps_of(p: Parameters, cells: int, frames: int) -> int:
    """Return the number of steps at the Courant number of a row."""
    exact = solution(p)
    t_stop = p.number("periods", 1.0) * 2 * LENGTH / exact.wave_speed
    dt = stable_dt(LENGTH, cells, exact.wave_speed, t_stop, p.number("cfl", 0.2), frames)
    return round(t_stop / dt)


def mode(
    ppc: int,
    cells: int,
    steps: int,
    frames: int,
    phase: float,
    periods: float,
    staggered: bool,
    basis: str = "linear",
    scheme: Scheme = PLAIN,
) -> dict[str, Array]:
    """Follow one wave of a bar in units of A, A omega and M k A.

    Splines do not mirror waves at walls; theirs are followed with matrices.

    Returns
    -------
    dict
        For u, v and stress the errors of all points of the bar at each frame, (frames, points);
        velocities are compared with the exact ones half a step earlier.
    """
    kh, tau = np.pi / cells, 2 * np.pi * periods / steps
    exact_u, exact_v = np.sin(phase), np.cos(phase - 0.5 * tau * staggered)
    places = point_offsets(ppc * cells) * cells
    wave = np.exp(1j * kh * places)
    mirrored = basis not in ("quadratic", "cubic")
    if mirrored:
        # One cell stands for all; its points' amplitudes are factors of the wave.
        s, d = (a[:, None] for a in cell_symbols(kh, ppc, basis=basis))
        sums = PointSums.of(kh, ppc, basis=basis)
        fit, arm = sums.fit[:, None], sums.t[:, None].conj().T / ppc
        if scheme.transfer == "MLS":
            d = fit
        to_node, pull = s.conj().T / ppc, d.conj().T / (ppc * kh)
        u, v, t = (np.full(ppc, a, dtype=complex) for a in (exact_u, exact_v, 1j * exact_u))
        free = 1.0
    else:
        s, d = grid_functions(basis, places, cells, ppc)
        mass = s.sum(axis=0)[:, None]
        to_node, pull = s.T / mass, d.T / (mass * kh)
        u, v, t = exact_u * np.imag(wave), exact_v * np.imag(wave), exact_u * np.real(wave)
        free = np.ones(cells + 1)
        free[[0, -1]] = 0.0
    errors: dict[str, list[Array]] = {"u": [], "v": [], "stress": []}
    affine = scheme.transfer in ("APIC", "MLS")
    if affine and not mirrored:
        raise ValueError("affine fields of splines at walls are not followed here")
    c = fit @ (to_node @ v) if affine else None
    kept = scheme.flip if scheme.transfer == "FLIP" else 0.0
    for n in range(1, steps + 1):
        late = scheme.staggered and n == 1
        grid = free * (to_node @ v)
        if c is not None:
            grid = grid + arm @ c
        if scheme.solver == "USF" and not late:
            t = t + tau / kh * (d @ grid)
        force = -tau * (0.5 if late else 1.0) * free * (pull @ t)
        new = gain = grid + force
        if scheme.transfer == "XPIC":
            rest = grid
            for _ in range(scheme.xpic - 1):
                rest = rest - free * (to_node @ (s @ rest))
                gain = gain + rest
        v = kept * (v + s @ force) + (1.0 - kept) * (s @ gain)
        u = u + tau * (s @ new)
        if c is not None:
            c = fit @ new
        if scheme.solver == "MUSL":
            new = free * (to_node @ v)
            if c is not None:
                new = new + arm @ c
        if scheme.solver != "USF":
            t = t + tau / kh * (d @ new)
        if n % (steps // frames) == 0:
            angle = phase + n * tau
            now = np.sin(angle), np.cos(angle - 0.5 * tau)
            if mirrored:
                amplitudes = (u - now[0], v - now[1], t - 1j * now[0])
                found = [np.imag(np.tile(a, cells) * wave) for a in amplitudes]
            else:
                shape, slope = np.imag(wave), np.real(wave)
                found = [u - now[0] * shape, v - now[1] * shape, t - now[0] * slope]
            for name, error in zip(errors, found, strict=True):
                errors[name].append(error)
    return {name: np.array(values) for name, values in errors.items()}


def modal_errors(p: Parameters, cells: int, steps: int, frames: int) -> dict[str, float]:
    """Return the largest L2 norms of u, v and stress over the frames, by the linear steps."""
    exact = solution(p)
    bars = [
        mode(
            p.ppc,
            cells,
            steps,
            frames,
            phase,
            p.number("periods", 1.0),
            bool(starts_early(p)),
            p.mapping,
            p.scheme,
        )
        for phase in exact.phases
    ]
    ratio = exact.lame / (exact.lame + 2 * exact.shear)
    norms = {}
    for name, own, other in (
        ("u", 1.0, 0.0),
        ("v", 1.0, 0.0),
        ("stress", 1.0 + 2 * ratio**2, 2 * ratio + ratio**2),
    ):
        # Along each direction the error depends on one coordinate: means of products are products
        # of means. T_aa = M e_a + lambda (sum of the other e).
        means = np.array([np.mean(bar[name], axis=1) for bar in bars])
        squares = np.sum([np.mean(bar[name] ** 2, axis=1) for bar in bars], axis=0)
        crossed = np.sum(means, axis=0) ** 2 - np.sum(means**2, axis=0)
        norms[f"{name}_l2"] = float(np.sqrt(np.max(own * squares + other * crossed)))
    return norms


def judge_modes(p: Parameters, measures: dict[str, float], cells: int, steps: int, frames: int):
    """Return findings: the errors are those of the linear steps, up to terms of the strain.

    The terms that the linear steps leave out are of relative size k A: forces, masses and places of
    the nodes belong to points that have moved. They change u by up to 2 k A of its amplitude in a
    period, and v and stress, at twice the wave number and frequency, by up to 4 k A.
    """
    strain = WAVE_NUMBER * p.number("amplitude", 1e-6)
    found = []
    for name, value in modal_errors(p, cells, steps, frames).items():
        factor = 2.0 if name == "u_l2" else 4.0
        margin = factor * strain * np.sqrt(DIM[p.sim_type]) + 1e-4 * value
        found.append(
            Finding(
                f"{name}, {p.cells} {p.text('refine', 'cells')}",
                measures[name],
                value - margin,
                value + margin,
                value,
                f"linear steps in closed form; {factor:g} k A sqrt(dim) for what is not linear",
            )
        )
    return found


def is_linear(p: Parameters, cells: int) -> bool:
    """Tell whether points and the corners of their boxes stay in their cells."""
    return p.number("amplitude", 1e-6) <= 0.25 * LENGTH / (cells * p.ppc)


def follow_bar(p: Parameters, scene: Scene) -> list[tuple[Array, Array, Array]]:
    """Return u, v and stress of the frames of a bar, by an own program with full matrices.

    It shares nothing with the program under test but the method: each function of each node is
    evaluated at each point from its definition, and nothing is taken from the last step but the
    state of the points.
    """
    exact, points, dt = solution(p), scene.bodies[0].points, scene.dt
    reference = exact.place(points)
    modulus = exact.lame + 2 * exact.shear
    amplitude, omega, phase = exact.amplitude, exact.omega, exact.phases[0]
    shape, slope = np.sin(WAVE_NUMBER * reference[:, 0]), np.cos(WAVE_NUMBER * reference[:, 0])
    u = amplitude * shape * np.sin(phase)
    stretch = 1 + amplitude * WAVE_NUMBER * slope * np.sin(phase)
    lag = 0.5 * omega * dt * starts_early(p)
    v = amplitude * omega * shape * np.cos(phase - lag)
    stress, volume = modulus * np.log(stretch), points.volume * stretch
    cells, h = scene.cells[0], scene.lengths[0] / scene.cells[0]
    nodes = np.arange(cells + 1)
    quarter = 0.25 * points.volume[:, None] / h
    frames = []
    for n in range(scene.steps):
        s = (points.x[:, :1] + u[:, None]) / h
        if p.mapping == "cpdi":
            ahead, behind = hat(s + quarter - nodes), hat(s - quarter - nodes)
            weight, gradient = 0.5 * (ahead + behind), (ahead - behind) / (2 * quarter * h)
            outside = ((s + quarter > cells) | (s - quarter < 0))[:, 0]
            weight[outside] = hat(s - nodes)[outside]
            gradient[outside] = hat_slope(s - nodes)[outside] / h
        elif p.mapping == "linear":
            weight, gradient = hat(s - nodes), hat_slope(s - nodes) / h
        else:
            weight, gradient = grid_functions(p.mapping, s[:, 0], cells, p.ppc)
            gradient = gradient / h
        growth = 1 + amplitude * WAVE_NUMBER * slope * np.sin(omega * n * dt + phase)
        wave = amplitude * omega**2 * shape * np.sin(omega * n * dt + phase)
        load = wave * (1 / growth - 1)
        mass = points.mass @ weight
        velocity = (points.mass * v) @ weight / mass
        change = dt * ((points.mass * load) @ weight - (volume * stress) @ gradient) / mass
        velocity[[0, -1]], change[[0, -1]] = 0.0, 0.0
        v = v + weight @ change
        u = u + dt * (weight @ (velocity + change))
        strain = dt * (gradient @ (velocity + change))
        volume, stress = volume * np.exp(strain), stress + modulus * strain
        if (n + 1) % (scene.steps // scene.frames) == 0:
            frames.append((u, v, stress))
    return frames


def hat(s: Array) -> Array:
    """Return the linear function."""
    return np.maximum(0.0, 1.0 - np.abs(s))


def hat_slope(s: Array) -> Array:
    """Return its derivative; on a node that of the cell above."""
    return np.where((s >= -1) & (s < 0), 1.0, 0.0) - np.where((s >= 0) & (s < 1), 1.0, 0.0)


def compare_bar(p: Parameters, out: Output) -> float:
    """Return the largest difference of u, v and stress to those of `follow_bar`, scaled."""
    worst = 0.0
    u, v, t = solution(p).scales()
    own = follow_bar(p, out.scene)
    for i, (own_u, own_v, own_t) in enumerate(own):
        frame = out.points()[i + 1]
        differences = (
            (frame["displacement"][:, 0] - own_u) / u,
            (frame["velocity"][:, 0] - own_v) / v,
            (frame["cauchy_stress"][:, 0, 0] - own_t) / t,
        )
        worst = max(worst, *(float(np.max(np.abs(d))) for d in differences))
    return worst
