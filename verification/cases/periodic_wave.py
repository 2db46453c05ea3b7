"""Standing waves on grids that repeat."""

from __future__ import annotations

import numpy as np
from _waves import (
    DENSITY,
    LENGTH,
    SLIP,
    YOUNG,
    DiscreteWave,
    Walls,
    fit_oscillation,
    interpolate,
    slope,
    symbols,
)
from harness.case import (
    Case,
    Finding,
    Measures,
    Output,
    Parameters,
    Results,
    below,
    near,
    observed_order,
)
from harness.norms import Errors, linf
from harness.scene import (
    DIM,
    NVEL,
    Body,
    Scene,
    lattice,
    pressure_wave_modulus,
    shear_modulus,
    stable_dt,
)
from harness.theory import series, stress_constant

AMPLITUDE = 1e-8
EPSILON = float(np.finfo(float).eps)


class Wave:
    """One run: u = A d sin(k.x) sin(w t) on a periodic lattice.

    Options of the row: `axis` (direction of the wave), `oblique` (1: along the diagonal instead),
    `component` (of the motion; by default along the wave), `polar` (oblique: `pressure`, `shear`,
    or `antiplane` along the third component), `nu`, `shift` (of the points along the wave, in
    cells), `width` (cells across), `mode` (waves on the length), `cfl`.
    """

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.dim = DIM[p.sim_type]
        self.axis = int(p.number("axis", 1 if p.sim_type == 4 else 0))
        self.oblique = p.number("oblique", 0.0) == 1.0
        self.along = list(range(self.dim)) if self.oblique else [self.axis]
        self.h = LENGTH / p.cells
        self.k = 2.0 * np.pi * p.number("mode", 1.0) / LENGTH
        self.shift = p.number("shift", 0.0)
        nu = p.number("nu", 0.0)
        self.m, self.g = pressure_wave_modulus(YOUNG, nu), shear_modulus(YOUNG, nu)

    @property
    def direction(self) -> np.ndarray:
        """Unit vector of the motion."""
        d, polar = np.zeros(3), self.p.text("polar", "pressure")
        if not self.oblique or polar == "antiplane":
            d[int(self.p.number("component", 2 if self.oblique else self.axis))] = 1.0
        elif polar == "pressure":
            d[: self.dim] = 1.0
        else:
            d[:2] = 1.0, -1.0
        return d / np.linalg.norm(d)

    @property
    def speed(self) -> float:
        """Speed of the wave: that of pressure or of shear."""
        wave = np.zeros(3)
        wave[self.along] = 1.0 / np.sqrt(len(self.along))
        modulus = self.g + (self.m - self.g) * float(wave @ self.direction) ** 2
        return float(np.sqrt(modulus / DENSITY))

    @property
    def omega(self) -> float:
        """Exact frequency."""
        return self.k * float(np.sqrt(len(self.along))) * self.speed

    @property
    def kh(self) -> float:
        """Wave number times cell size."""
        return self.k * float(np.sqrt(len(self.along))) * self.h

    @property
    def frames(self) -> int:
        """Frames: more in one dimension."""
        return 20 if self.dim == 1 else 10

    @property
    def t_stop(self) -> float:
        """One period."""
        return 2.0 * np.pi / self.omega

    @property
    def dt(self) -> float:
        """Time step."""
        c = float(np.sqrt(self.m / DENSITY))
        return stable_dt(self.h, 1, c, self.t_stop, self.p.number("cfl", 0.2), self.frames)

    @property
    def cfl(self) -> float:
        """Courant number of the wave."""
        return self.speed * self.dt / self.h

    def counts(self) -> list[int]:
        """Return the cells of the grid."""
        across = int(self.p.number("width", 3 if self.p.sim_type == 4 else 2))
        return [self.p.cells if d in self.along else across for d in range(self.dim)]

    def field(self, x: np.ndarray) -> np.ndarray:
        """Return e^(ik.x) at points."""
        return np.exp(1j * self.k * np.sum(x[:, self.along], axis=1))

    def on_grid(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what points get of e^(ik.x) at the nodes, and of its gradient over k: (n, 3)."""

        def wave(s: np.ndarray) -> np.ndarray:
            return np.exp(1j * self.k * s)

        basis, n = self.p.mapping, self.p.ppc
        values = {a: interpolate(wave, x[:, a], self.h, basis, n) for a in self.along}
        gradient = np.zeros((len(x), 3), dtype=complex)
        for a in self.along:
            gradient[:, a] = slope(wave, x[:, a], self.h, basis, n) / self.k
            for other in self.along:
                if other != a:
                    gradient[:, a] *= values[other]
        return np.prod(list(values.values()), axis=0), gradient

    def stress(self, gradient: np.ndarray) -> np.ndarray:
        """Return the stress over M k A of a displacement with a gradient over k A: (n, 3, 3)."""
        strain = gradient[:, :, None] * self.direction
        strain = 0.5 * (strain + np.swapaxes(strain, 1, 2))
        trace = np.trace(strain, axis1=1, axis2=2)[:, None, None]
        return ((self.m - 2.0 * self.g) * trace * np.eye(3) + 2.0 * self.g * strain) / self.m

    def discrete(self) -> tuple[DiscreteWave, complex]:
        """Return the wave of the discrete equations, and what the grid gets of e^(ik.x)."""
        one = symbols(self.k * self.h, self.p.ppc, self.shift, self.p.mapping)
        many = len(self.along)
        # Means of conj(D_a) D_b, from those along each direction.
        means = np.zeros((3, 3))
        for a in self.along:
            for b in self.along:
                same = one.k2 * one.mu ** (many - 1)
                means[a, b] = same if a == b else abs(one.mixed) ** 2 * one.mu ** (many - 2)
        means /= self.h**2
        stiffness = (self.m - self.g) * means + self.g * np.trace(means) * np.eye(3)
        d = self.direction
        wave = DiscreteWave(float(d @ stiffness @ d) / DENSITY, one.mu**many)
        return wave, complex(np.conj(one.s) ** many)


def scene(p: Parameters) -> Scene:
    """Return a filled grid with seams, in TYPE 4 with smooth walls around."""
    wave, dim = Wave(p), DIM[p.sim_type]
    cells = wave.counts()

    def velocity(x: np.ndarray) -> np.ndarray:
        speed = AMPLITUDE * wave.omega * np.imag(wave.field(x))
        return (speed[:, None] * wave.direction)[:, : NVEL[p.sim_type]]

    offset = [wave.shift * wave.h * (d in wave.along) for d in range(dim)]
    points = lattice(
        p.sim_type,
        offset,
        [n * wave.h + o for n, o in zip(cells, offset, strict=True)],
        [n * p.ppc for n in cells],
        DENSITY,
        velocity,
    )
    walls = Walls([SLIP] * (2 * dim)).section() if p.sim_type == 4 else ""
    body = Body("body", points, YOUNG, p.number("nu", 0.0), walls)
    made = Scene(
        p.sim_type,
        [n * wave.h for n in cells],
        cells,
        [body],
        wave.t_stop,
        wave.dt,
        wave.frames,
        p.mapping,
    )
    made.periodic = [not (p.sim_type == 4 and d == 0) for d in range(dim)]
    return made


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors, and the difference from the discrete equations."""
    wave, points = Wave(p), out.scene.bodies[0].points
    x, dt, omega, d = points.x, out.scene.dt, wave.omega, wave.direction
    exact = np.imag(wave.field(x))[:, None] * d
    stress = wave.stress(np.real(wave.field(x))[:, None] * np.isin(np.arange(3), wave.along))
    grid, grid_gradient = wave.on_grid(x)
    discrete, share = wave.discrete()
    march, kicks = discrete.march(share * omega, dt, out.scene.steps)
    errors = Errors(points.measure)
    largest = dict.fromkeys(("d_u", "d_v", "d_s", "momentum"), 0.0)

    def note(name: str, difference: np.ndarray) -> None:
        largest[name] = max(largest[name], linf(difference))

    times, amplitudes, start = [], [], None
    for frame in out.points():
        t, step = frame.time, round(frame.time / dt)
        u, v = frame["displacement"] / AMPLITUDE, frame["velocity"] / (AMPLITUDE * omega)
        s = frame["cauchy_stress"] / (wave.m * wave.k * AMPLITUDE)
        errors.add("e_u", u - exact * np.sin(omega * t))
        errors.add("e_v", v - exact * np.cos(omega * t))
        errors.add("e_w", v - exact * np.cos(omega * max(0.0, t - dt / 2)))
        errors.add("e_s", s - stress * np.sin(omega * t))
        note("d_u", u - np.imag(grid * march[step])[:, None] * d)
        note("d_v", v - exact - np.imag(grid * kicks[step])[:, None] * d / omega)
        note("d_s", s - wave.stress(np.imag(grid_gradient * march[step])))
        momentum = points.total_mass @ v / np.sum(points.total_mass)
        start = momentum if start is None else start
        free = slice(1, None) if p.sim_type == 4 else slice(None)  # hoop stress acts along r
        note("momentum", (momentum - start)[None, free])
        times.append(t)
        amplitudes.append(np.sum(exact * u) / np.sum(exact**2))
    frequency, _ = fit_oscillation(np.array(times), np.array(amplitudes), discrete.frequency(dt))
    return {**errors.measures(), **largest, "frequency_ratio": frequency / omega}


def judge(r: Results) -> list[Finding]:
    """Compare with the solution of the discrete equations and its expansions."""
    findings = orders(r)
    for p, m in r:
        findings += judge_run(p, m)
    return findings


def orders(r: Results) -> list[Finding]:
    """Return orders in h at a fixed Courant number."""
    second = "lumped mass: order 2 with every basis; 0.15 for the next terms from kh = 0.4 on"
    first = (
        "slopes whose second moment is not 0 give the points of a cell stresses that differ by "
        "b kh beside the phase error of order 2; 0.1 for the next terms"
    )
    fine = [(p, m) for p, m in r if Wave(p).kh < 0.4]
    if len(fine) < 2:
        return []
    cells = [p.cells for p, _ in fine]
    inside = observed_order(cells, [stress_error(p) for p, _ in fine])
    findings = []
    wanted = [
        ("order of e_u", "e_u_l2", 2.0, 0.15, second),
        ("order of e_u, l1", "e_u_l1", 2.0, 0.15, second),
        ("order of e_u, linf", "e_u_linf", 2.0, 0.15, second),
        ("order of e_v half a step earlier", "e_w_l2", 2.0, 0.15, second),
    ]
    if not Wave(r.first).oblique:
        wanted.append(("order of e_s", "e_s_l2", inside, 0.1, first))
    for name, key, expected, margin, reason in wanted:
        order = observed_order(cells, [m[key] for _, m in fine])
        low, high = expected - margin, expected + margin
        findings.append(Finding(name, order, low, high, expected, reason))
    return findings


def stress_error(p: Parameters) -> float:
    """Return the first terms of the error of the stress, up to a factor: in a cell, and in time."""
    wave, t = Wave(p), np.linspace(0.0, 2.0 * np.pi, 201)
    kappa = series(p.ppc, wave.shift, p.mapping)[0] - wave.cfl**2 / 24.0
    inside = stress_constant(p.ppc, wave.shift, p.mapping) * wave.kh * np.sin(t)
    return float(np.max(np.hypot(inside, kappa * wave.kh**2 * t * np.cos(t))))


def judge_run(p: Parameters, m: Measures) -> list[Finding]:
    """Return the findings of one run."""
    wave, label = Wave(p), f"{p.cells} cells"
    kh = wave.kh
    strain = np.sqrt(len(wave.along)) * wave.k * AMPLITUDE
    linear = (
        "the discrete equations solved in closed form; 5 strains for what is not linear: the "
        "second harmonic grows to omega t/16 strains, its gradient to twice that"
    )
    steps = round(wave.t_stop / wave.dt)
    theory = 1.0 - wave.discrete()[0].frequency(wave.dt) / wave.omega
    findings = [
        below(f"d_u, {label}", m["d_u"], 5.0 * strain, linear),
        below(f"d_v, {label}", m["d_v"], 5.0 * strain, linear),
        below(f"d_s, {label}", m["d_s"], 5.0 * strain, linear),
        near(
            f"1 - omega_h/omega, {label}",
            1.0 - m["frequency_ratio"],
            theory,
            0.001 + 5.0 * strain / theory,
            "eigenvalues of a step; 0.1 %: fit; 5 strains for what is not linear",
        ),
        below(
            f"change of the momentum, {label}",
            m["momentum"],
            EPSILON * (steps + 10.0),
            "the functions of all nodes sum to 1, and no wall acts; one rounding a step, and of "
            "the sums over the points",
        ),
    ]
    if kh < 0.2 and not wave.oblique:
        kappa = series(p.ppc, wave.shift, p.mapping)[0] - wave.cfl**2 / 24.0
        findings += [
            near(
                f"1 - omega_h/omega by kappa, {label}",
                1.0 - m["frequency_ratio"],
                kappa * kh**2,
                0.03,
                "(kappa - CFL^2/24)(kh)^2 with kappa of the basis; 3 %: the next term",
            ),
            near(
                f"e_u by kappa, {label}",
                m["e_u_l2"],
                2.0 * np.pi * kappa * kh**2 / np.sqrt(2.0),
                0.05,
                "phase error at the end of the period; 5 %: the next term, loss of amplitude",
            ),
        ]
    return findings


CASE = Case(
    family="Axial bar",
    title="Standing waves on grids that repeat, with every basis",
    statement=r"""
A grid filled with points, periodic in all directions (TYPE 4: along the axis of symmetry), without
walls. Points start with the velocities $A\omega\,d\sin k\cdot x$, $k = 2\pi/L$ along one direction
or along all; the motion $d$ is along the wave or across it. Exact:
$u = A\,d\sin k\cdot x\sin\omega t$ with $\omega = |k|\sqrt{M/\rho}$ or $|k|\sqrt{G/\rho}$.
Measured over one period: errors of displacement, velocity and stress, the frequency, the momentum,
and the difference from the wave that the discrete equations have in closed form, for points in the
middle of their cells and shifted.

Expected: no difference but that of finite strain, for every basis and every place of the points.
Order 2 with every basis, with the phase error
$1-\omega_h/\omega = (\kappa-\mathrm{CFL}^2/24)(kh)^2$, which is larger for smoother functions:
for symmetric points $\kappa = 1/8+1/(24n^2)$ for linear functions and averages of them,
$1/4+1/(24n^2)$ ($n$ even) or $1/4-1/(12n^2)$ ($n$ odd) for quadratic and $1/3$ for cubic ones.
Stresses at points have order 2 with splines, order 1 with linear functions. The momentum stays to
round-off.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
