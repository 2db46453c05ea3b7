"""Pressure, shear and antiplane waves in a square and a cube."""

from __future__ import annotations

import numpy as np
from _scheme import LinearScheme
from _waves import (
    DENSITY,
    LENGTH,
    SLIP,
    STICK,
    YOUNG,
    DiscreteWave,
    Walls,
    fit_oscillation,
    interpolate,
    slope,
    symbols,
    walls_reflect,
)
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
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

FRAMES = 12
AMPLITUDE = 1e-8
K = np.pi / LENGTH
#: Signs of the components along the directions of the grid.
SIGNS = {"pressure": (1.0, 1.0, 1.0), "shear": (1.0, -1.0, 0.0), "antiplane": (0.0, 0.0, 0.0)}


def kind(p: Parameters) -> str:
    """Return what the row says: pressure, shear or antiplane."""
    return p.text("wave", "pressure")


def is_sine(p: Parameters) -> bool:
    """Tell whether an antiplane wave is held at the walls, instead of free to slide along them."""
    return p.text("walls", "slip") == "stick"


def moduli(p: Parameters) -> tuple[float, float]:
    """Return lambda + 2 G and G."""
    nu = p.number("nu", 0.3)
    return pressure_wave_modulus(YOUNG, nu), shear_modulus(YOUNG, nu)


def frequency(p: Parameters) -> float:
    """Return the exact frequency."""
    m, g = moduli(p)
    return K * float(np.sqrt(DIM[p.sim_type] * (m if kind(p) == "pressure" else g) / DENSITY))


def components(p: Parameters) -> list[tuple[int, float]]:
    """Return the components that move, and their signs."""
    if kind(p) == "antiplane":
        return [(2, 1.0)]
    return [(a, SIGNS[kind(p)][a]) for a in range(DIM[p.sim_type])]


def profile(p: Parameters, x: np.ndarray, component: int, h: float = 0.0) -> np.ndarray:
    """Return the shape of a component; with h what points get of it from the grid."""
    result = np.ones(len(x))
    for axis in range(x.shape[1]):
        result *= factor(p, x[:, axis], component, axis, h, derive=False)
    return result


def strains(p: Parameters, x: np.ndarray, h: float = 0.0) -> np.ndarray:
    """Return the strains over k A: (n, 3, 3); with h those that points get from the grid."""
    result = np.zeros((len(x), 3, 3))
    for c, sign in components(p):
        for axis in range(x.shape[1]):
            gradient = np.full(len(x), sign)
            for other in range(x.shape[1]):
                gradient *= factor(p, x[:, other], c, other, h, derive=other == axis)
            result[:, c, axis] += 0.5 * gradient
            result[:, axis, c] += 0.5 * gradient
    return result


def factor(
    p: Parameters, place: np.ndarray, component: int, axis: int, h: float, *, derive: bool
) -> np.ndarray:
    """Return the factor of one direction in the shape of a component, or its derivative over k."""
    function = np.sin if axis == component or (component == 2 and is_sine(p)) else np.cos
    if h > 0.0:
        scale, reader = (K, slope) if derive else (1.0, interpolate)
        return reader(lambda s: function(K * s), place, h, p.mapping, p.ppc) / scale
    if derive:
        return np.cos(K * place) if function is np.sin else -np.sin(K * place)
    return function(K * place)


def scene(p: Parameters) -> Scene:
    """Return a square or a cube with the velocities of the wave at zero displacement."""
    dim, h = DIM[p.sim_type], LENGTH / p.cells
    speed = AMPLITUDE * frequency(p)

    def velocity(x: np.ndarray) -> np.ndarray:
        v = np.zeros((len(x), NVEL[p.sim_type]))
        for c, sign in components(p):
            v[:, c] = speed * sign * profile(p, x, c)
        return v

    points = lattice(
        p.sim_type, [0.0] * dim, [LENGTH] * dim, [p.cells * p.ppc] * dim, DENSITY, velocity
    )
    code = STICK if is_sine(p) else SLIP
    body = Body("body", points, YOUNG, p.number("nu", 0.3), Walls([code] * (2 * dim)).section())
    t_stop, c = 2.0 * np.pi / frequency(p), np.sqrt(moduli(p)[0] / DENSITY)
    dt = stable_dt(h, 1, c, t_stop, p.number("cfl", 0.2), FRAMES)
    return Scene(p.sim_type, [LENGTH] * dim, [p.cells] * dim, [body], t_stop, dt, FRAMES, p.mapping)


def wave(p: Parameters) -> tuple[DiscreteWave, float]:
    """Return the wave of the discrete equations, and the share of the start that the grid gets."""
    dim, (m, g) = DIM[p.sim_type], moduli(p)
    h = LENGTH / p.cells
    one = symbols(K * h, p.ppc, basis=p.mapping)
    # Means of |D_a|^2 and of conj(D_a) D_b, from those along each direction.
    same = one.k2 * one.mu ** (dim - 1) / h**2
    mixed = abs(one.mixed) ** 2 * one.mu ** (dim - 2) / h**2
    stiffness = g * dim * same
    if kind(p) == "pressure":
        stiffness += (m - g) * (same + (dim - 1) * mixed)
    elif kind(p) == "shear":
        stiffness += (m - g) * (same - mixed)
    return DiscreteWave(stiffness / DENSITY, one.mu**dim), one.s.real**dim


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors, the frequency, and the difference from the discrete equations."""
    points, omega = out.scene.bodies[0].points, frequency(p)
    m, g = moduli(p)
    x, volume, h = points.x, points.measure, LENGTH / p.cells
    exact, on_grid = np.zeros((len(x), 3)), np.zeros((len(x), 3))
    for c, sign in components(p):
        exact[:, c] = sign * profile(p, x, c)
        on_grid[:, c] = sign * profile(p, x, c, h)

    def stress_of(strain: np.ndarray) -> np.ndarray:
        trace = np.trace(strain, axis1=1, axis2=2)
        return ((m - 2.0 * g) * trace[:, None, None] * np.eye(3) + 2.0 * g * strain) / m

    stress, grid_stress = stress_of(strains(p, x)), stress_of(strains(p, x, h))
    discrete, share = wave(p)
    dt = out.scene.dt
    march, kicks = discrete.march(share * omega, dt, out.scene.steps)
    errors = Errors(volume)
    largest = dict.fromkeys(("d_u", "d_v", "d_s"), 0.0)

    def note(name: str, difference: np.ndarray) -> None:
        largest[name] = max(largest[name], linf(difference))

    times, amplitudes, predicted = [], [], []
    own = None if walls_reflect(p) else by_matrices(p, out.scene)
    for number, frame in enumerate(out.points()):
        t, step = frame.time, round(frame.time / dt)
        u, v = frame["displacement"] / AMPLITUDE, frame["velocity"] / (AMPLITUDE * omega)
        errors.add("e_u", u - exact * np.sin(omega * t))
        errors.add("e_w", v - exact * np.cos(omega * max(0.0, t - dt / 2)))
        s = frame["cauchy_stress"] / (m * K * AMPLITUDE)
        errors.add("e_s", s - stress * np.sin(omega * t))
        if own is None:
            expected = on_grid * march[step]
            note("d_v", v - exact - on_grid * kicks[step] / omega)
            note("d_s", s - grid_stress * march[step])
        else:
            expected = own[0][number] / AMPLITUDE
            note("d_s", s - own[1][number] / (m * K * AMPLITUDE))
        note("d_u", u - expected)
        predicted.append(np.sum(exact * expected) / np.sum(exact**2))
        times.append(t)
        amplitudes.append(np.sum(exact * u) / np.sum(exact**2))
    found, _ = fit_oscillation(np.array(times), np.array(amplitudes), omega)
    theory = discrete.frequency(dt)
    if own is not None:
        theory, _ = fit_oscillation(np.array(times), np.array(predicted), omega)
    return {
        **errors.measures(),
        "theory_ratio": theory / omega,
        "frequency_ratio": found / omega,
        "frequency_error": abs(1.0 - found / omega),
        **largest,
        "dt": dt,
    }


def by_matrices(p: Parameters, made: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return what the discrete equations of small motions, as matrices, give at the points.

    Displacements (frames, points, 3) and stresses (frames, points, 3, 3): splines do not mirror
    waves at walls.
    """
    codes = [STICK if is_sine(p) else SLIP] * (2 * DIM[p.sim_type])
    scheme = LinearScheme(made, codes)
    moved, stress = scheme.march(made.dt, made.steps, made.steps // made.frames)
    full = np.zeros((*moved.shape[:2], 3))
    full[:, :, : moved.shape[2]] = moved
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
    tensor = np.zeros((*moved.shape[:2], 3, 3))
    for (a, b), component in zip(pairs, np.swapaxes(stress, 0, 1), strict=True):
        tensor[:, :, a, b] = tensor[:, :, b, a] = component
    return full, tensor


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    least, second = 1.85, "lumped mass: order 2; 0.15 for the next terms"
    if r.first.mapping == "cubic":
        least, second = 1.7, second + ", as much for the walls of cubic functions"
    if len(r.cells) > 1:
        order = r.order("frequency_error")
        findings.append(Finding("order of the frequency", order, least, 2.15, 2.0, second))
    if len(r.cells) > 1 and r.column("frequency_error")[0] < 0.06:
        findings += [
            Finding("order of e_u", r.order("e_u_l2"), least, 2.15, 2.0, second),
            Finding("order of e_u, linf", r.order("e_u_linf"), least, 2.15, 2.0, second),
            Finding(
                "order of e_v half a step earlier", r.order("e_w_l2"), least, 2.15, 2.0, second
            ),
        ]
    for p, m in r:
        label = f"{p.cells} cells"
        theory = 1.0 - m["theory_ratio"]
        nonlinear = 10.0 * K * AMPLITUDE
        linear = "the discrete equations solved in closed form; 10 strains for what is not linear"
        findings += [
            near(
                f"1 - omega_h/omega, {label}",
                1.0 - m["frequency_ratio"],
                theory,
                0.01,
                "eigenvalues of a step; 1 %: points' part that the grid does not see, fit",
            ),
            below(f"d_u, {label}", m["d_u"], nonlinear, linear),
            below(f"d_s, {label}", m["d_s"], 2.0 * nonlinear, linear),
        ]
        if walls_reflect(p):
            findings.append(below(f"d_v, {label}", m["d_v"], nonlinear, linear))
    return findings


CASE = Case(
    family="Axial bar",
    title="Pressure, shear and antiplane waves in a square and a cube",
    statement=r"""
Standing waves between smooth walls, $k = \pi/L$ along all $d$ directions: pressure waves
$u = \nabla\phi$, $\phi \propto \cos kx\cos ky\,(\cos kz)$, $\omega = k\sqrt{dM/\rho}$; shear waves
$u = A(\sin kx\cos ky, -\cos kx\sin ky)\,(\cos kz)$, $\omega = k\sqrt{dG/\rho}$; in TYPE 5 antiplane
waves $u_z = A\cos kx\cos ky$ along smooth walls or $A\sin kx\sin ky$ between walls that hold them,
$\omega = k\sqrt{2G/\rho}$. Start: velocities at zero displacement; one period. Together they check
$M$ and $G$.

Expected: order 2 of the frequency, of the displacement and of the velocity half a step before. The
wave of the discrete
equations has in place of $k^2$ and 1 products of the means along each direction: with
$K = \overline{|D|^2}$, $\mu = \overline{|S|^2}$ and $\overline{D^*S} = -i\sin(kh)/h$ a stiffness
$(\lambda+G)(K\mu^{d-1} \pm \ldots|\overline{D^*S}|^2\mu^{d-2}) + GdK\mu^{d-1}$ over $\rho$, and the
filter $\mu^d$. Waves of splines between walls are compared with matrices of the discrete equations.
""",
    source="Elementary. Discrete equations: `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
