"""Taylor-Green vortices: a flow with pressure that viscosity brings to rest."""

from __future__ import annotations

import math

import numpy as np
from harness.case import (
    Case,
    Finding,
    Measures,
    Output,
    Parameters,
    Published,
    Results,
    below,
)
from harness.scene import Array, Body, Scene, lattice
from harness.theory import grid_functions, point_offsets

#: Side of a square that the flow repeats, density, velocity of the vortices.
LENGTH, DENSITY, SPEED = 1.0, 1.0, 1.0
K = 2.0 * math.pi / LENGTH
#: Speed of the vortices over that of sound, where the points flow.
MACH = 0.05
#: Displacement of the fastest points of a slow flow, over the spacing of COARSEST cells.
SHIFT, COARSEST = 0.01, 16
#: nu dt/h**2 of a slow flow, Courant number of one in which points flow.
DIFFUSION, COURANT = 0.02, 0.3
FRAMES = 8
#: Largest error of the forces of the exact pressure over those of the flow and over the cells of a
#: wave length, in a table of an independent program that moves points in the flow, to the
#: displacements of the Reynolds numbers 1 and 5.
DISORDER = {
    ("linear", 1.0): 0.0375,
    ("linear", 5.0): 0.16,
    ("cubic", 1.0): 0.0032,
    ("cubic", 5.0): 0.029,
}


def reynolds(p: Parameters) -> float:
    """Return U/(nu k); 0 for a flow in which no point leaves its cell."""
    return p.number("reynolds", 0.0)


def speed(p: Parameters) -> float:
    """Return the largest velocity at the start; that of a slow flow is small."""
    return SPEED if reynolds(p) > 0.0 else SHIFT * LENGTH / COARSEST


def viscosity(p: Parameters) -> float:
    """Return the kinematic viscosity; a slow flow falls to 1/e in the unit of time."""
    return speed(p) / (reynolds(p) * K) if reynolds(p) > 0.0 else 0.5 / K**2


def sound(p: Parameters) -> float:
    """Return the speed of sound: in a slow flow no faster than viscosity across coarse cells."""
    return speed(p) / MACH if reynolds(p) > 0.0 else viscosity(p) * COARSEST / LENGTH


def decay_time(p: Parameters) -> float:
    """Return the time in which velocities fall to 1/e."""
    return 0.5 / (viscosity(p) * K**2)


def walls(p: Parameters) -> bool:
    """Tell whether one vortex turns between smooth walls, in place of four in a periodic box."""
    return p.number("walls", 0.0) > 0.0


def vortices(p: Parameters, x: Array) -> Array:
    """Return the velocity at places, over the speed: (n, 2)."""
    a, b = K * x[:, 0], K * x[:, 1]
    if walls(p):
        return np.column_stack([np.sin(a) * np.cos(b), -np.cos(a) * np.sin(b)])
    return np.column_stack([np.cos(a) * np.sin(b), -np.sin(a) * np.cos(b)])


def scene(p: Parameters) -> Scene:
    """Return a square of fluid; `cells` are those of a wave length."""
    side, cells = LENGTH, p.cells
    if walls(p):
        side, cells = 0.5 * LENGTH, p.cells // 2
    points = lattice(
        2,
        [0.0, 0.0],
        [side, side],
        [cells * p.ppc] * 2,
        DENSITY,
        velocity=lambda x: speed(p) * vortices(p, x),
    )
    h, nu, c = LENGTH / p.cells, viscosity(p), sound(p)
    dt = DIFFUSION * h**2 / nu
    if reynolds(p) > 0.0:
        # Waves and viscosity bound the step together.
        dt = COURANT * h / (c + 2.0 * nu / h)
    intervals = math.ceil(decay_time(p) / (FRAMES * dt))
    codes = [1, 1, 1, 1] if walls(p) else [3, 3, 3, 3]
    return Scene(
        2,
        [side, side],
        [cells, cells],
        [
            Body(
                "fluid",
                points,
                1.0,
                0.0,
                'boundary-class = "CartesianBoxCustom"\n'
                f"    boundary-int-props = {{{', '.join(map(str, codes))}}}",
                'material-class = "BarotropicViscousFluid"\n'
                f"    material-props = {{{DENSITY * c**2!r}, {DENSITY * nu!r}}}",
            )
        ],
        decay_time(p),
        decay_time(p) / (FRAMES * intervals),
        FRAMES,
        p.mapping,
        periodic=() if walls(p) else (True, True),
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors of velocity, of the vortices' part of it, and of the kinetic energy."""
    mass = out.scene.bodies[0].points.total_mass[:, None]
    velocity_errors, sizes, energies = [], [], []
    for frame in out.points():
        shape, v = vortices(p, frame.x), frame["velocity"][:, :2] / speed(p)
        exact = math.exp(-frame.time / decay_time(p))
        norm = math.sqrt(float(np.sum(mass * shape**2)))
        velocity_errors.append(math.sqrt(float(np.sum(mass * (v - exact * shape) ** 2))) / norm)
        sizes.append(float(np.sum(mass * shape * v)) / norm**2)
        energies.append(float(np.sum(mass * v**2)))
    half = len(sizes) // 2
    rate = math.log(sizes[half] / sizes[-1]) / 0.5
    return {
        "v_l2": max(velocity_errors),
        "v_end_l2": velocity_errors[-1],
        "e_rate": abs(rate - 1.0),
        "rate": rate - 1.0,
        "energy": energies[-1] / energies[0] * math.exp(2.0) - 1.0,
    }


def linear_flow(p: Parameters) -> tuple[float, float]:
    """Return the rate at which the vortices fall and the square of their false frequency.

    On points that stay at their places the nodes have the same vortices, one amplitude A, and
    A'' + R A' + W A = 0: R is the viscous power, W that of the divergence which the functions
    make at the points of a flow that has none. Both are found from sums over all points, and the
    way from the nodes to the points and back takes mu of each direction.
    """
    n = p.cells
    places = (np.arange(n)[:, None] + point_offsets(p.ppc)).ravel()
    values, slopes = grid_functions(p.mapping, places, n, p.ppc, periodic=True)
    h = LENGTH / n
    nodes = K * h * np.arange(n)
    wave, turned = np.cos(nodes), np.sin(nodes)
    # cos, sin and their slopes as the functions give them at the points; v = -sin cos.
    c, s = values @ wave, values @ turned
    dc, ds = slopes @ wave / h, slopes @ turned / h
    xx, yy = np.outer(dc, s), -np.outer(s, dc)
    shear = np.outer(c, ds) - np.outer(ds, c)
    trace = xx + yy
    power = 2.0 * np.mean(xx**2 + yy**2 + 0.5 * shear**2 - trace**2 / 3.0)
    # Mean of the squared nodal velocity: 1/2.
    mu = float(np.mean(c**2) / 0.5)
    return (
        2.0 * viscosity(p) * mu**2 * float(power),
        2.0 * sound(p) ** 2 * mu**2 * float(np.mean(trace**2)),
    )


def linear_size(p: Parameters, t: float) -> float:
    """Return the amplitude at a time over that of the start, from `linear_flow`."""
    rate, square = linear_flow(p)
    root = np.sqrt(complex(0.25 * rate**2 - square))
    # A(0) = 1, A'(0) = -R: the displacement is 0 at the start.
    first, second = -0.5 * rate + root, -0.5 * rate - root
    sizes = (rate + first) * np.exp(second * t) - (rate + second) * np.exp(first * t)
    return float((sizes / (first - second)).real)


def linear_rate(p: Parameters) -> float:
    """Return the rate of the second half of the time, over the exact one, less 1."""
    t = decay_time(p)
    return 2.0 * math.log(linear_size(p, 0.5 * t) / linear_size(p, t)) - 1.0


def noise(p: Parameters) -> float:
    """Return the velocity that points in disorder make, over the norm of the vortices.

    Forces of the pressure at the points are off by c N times those of the flow, with the c of
    DISORDER; viscosity holds what changes from node to node, of wave number pi/h, at the
    acceleration over nu (pi/h)**2.
    """
    disorder = DISORDER[p.mapping, reynolds(p)]
    return (
        disorder
        * p.cells
        * 0.5
        * SPEED**2
        * K
        / (viscosity(p) * (math.pi * p.cells / LENGTH) ** 2 * SPEED / math.sqrt(2.0))
    )


def judge(r: Results) -> list[Finding]:
    """Compare a slow flow with the discrete one, one with moving points with its errors."""
    flowing = reynolds(r.first) > 0.0
    findings = []
    for p, m in r:
        findings += (judge_flow if flowing else judge_slow)(p, m)
    if not flowing and r.first.mapping != "linear" and len(r.measures) > 1:
        order = Finding("order of the rate of decay", r.order("e_rate"), 1.85, 2.1, 2.0)
        order.reason = "second order; (kh)² is 0.15 and less"
        findings.append(order)
    return findings


def judge_slow(p: Parameters, m: Measures) -> list[Finding]:
    """Expect the amplitudes of the discrete equations."""
    kh = K * LENGTH / p.cells
    # Symplectic Euler is off by half of R dt; points that move see the functions change by the
    # share of a cell that they moved.
    margin = 2.0 * DIFFUSION * kh**2 + SHIFT * p.cells / COARSEST * kh**2
    reason = (
        "amplitudes of the discrete equations with points at rest; the step, nu k² dt, and the "
        "share of a cell that points move"
    )
    expected = linear_rate(p)
    rate = Finding(f"rate of decay less 1, {p.cells} cells", m["rate"], expected=expected)
    rate.low, rate.high, rate.reason = expected - margin, expected + margin, reason
    expected = (linear_size(p, decay_time(p)) * math.e) ** 2 - 1.0
    energy = Finding(f"kinetic energy over exact less 1, {p.cells} cells", m["energy"])
    energy.low, energy.high = expected - 2.0 * margin, expected + 2.0 * margin
    energy.expected, energy.reason = expected, reason
    return [rate, energy]


def judge_flow(p: Parameters, m: Measures) -> list[Finding]:
    """Expect what lumped mass, false stiffness, sound and disorder add."""
    steady = linear_flow(p)[0] * decay_time(p) - 1.0
    stiff = linear_rate(p)
    sound_waves = math.sqrt(2.0) / 4.0 * MACH
    disorder = noise(p)
    rate = Finding(f"rate of decay less 1, {p.cells} cells", m["rate"])
    # Twice the share of the disorder in what is left of the vortices.
    margin = 2.0 * math.e * disorder + 2.0 * sound_waves**2
    rate.low, rate.high = min(steady, stiff) - margin, max(steady, stiff) + margin
    rate.expected = steady
    rate.reason = (
        "that of the discrete equations: from without false stiffness to with all of it, as if "
        "points stayed in their cells; twice the share of the disorder"
    )
    speed_error = below(
        f"largest error of velocity, {p.cells} cells",
        m["v_l2"],
        sound_waves + max(abs(steady), abs(stiff)) / math.e + 2.0 * disorder,
        "sum of the sound of a start without pressure, sqrt(2)/4 of the Mach number, of the error "
        "of the rate, over e at most, and of twice the disorder",
    )
    return [rate, speed_error]


def published(r: Results) -> list[Published]:
    """Return the kinetic energy of flows whose points move."""
    if reynolds(r.first) == 0.0:
        return []
    exact = math.exp(-2.0)
    ours = exact * (1.0 + r.measures[-1]["energy"])
    what = "kinetic energy over that of the start, when velocities are 1/e"
    return [Published(what, "exact: Taylor and Green 1937", exact, ours)]


CASE = Case(
    family="Fluid",
    title="Taylor-Green vortices",
    statement=r"""
Four vortices in a periodic square of side $L$, $v = U (\cos kx \sin ky, -\sin kx \cos ky)$, $k =
2\pi/L$; with `walls`, one of them between smooth walls, moved by a quarter of the period. *Exact*,
without compression: $v\,e^{-2\nu k^2 t}$ at any speed, since the pressure $-\frac14\rho U^2 (\cos
2kx + \cos 2ky)\,e^{-4\nu k^2 t}$ (with `walls`: the other sign) balances the inertia; the kinetic
energy falls with $e^{-4\nu k^2 t}$. Each run ends when the velocities are $1/e$ of those at the
start.

Measured: the rate of decay in the second half of the time by projection on the exact flow at the
points, the kinetic energy, and the velocity error, over the norm of the flow at the start.

*Slow flow* (no `reynolds`): no point moves by more than a hundredth of a coarse cell. The discrete
equations have the same vortices as the exact ones, of one amplitude $A$ with $A'' + RA' + WA = 0$.
$R$ is the viscous power, smaller than $2\nu k^2$ by an error of **second order** (1 point a cell:
$\frac56 (kh)^2$). $W$ is false: linear functions with several points a cell make a divergence of
order $h$ at the points out of a flow that has none, against which the bulk modulus is stiff
(locking). Cubic functions make four orders less of it.

*Flow with moving points*: `reynolds` is $U/(\nu k)$, $U$ is 1/20 of the speed of sound; points move
by 0.05 $L$ (1) or 0.25 $L$ (5). Three more errors. *Compression*: the program starts without the
pressure, and what is missing runs about as sound, with $\sqrt2/4$ of the Mach number, 0.018, in the
norm of the velocity error. Density changes by 0.1 %. *Stiffness* vanishes as points cross cells, so
that the rate lies between that with and that without it. *Disorder*: forces of the pressure at
disordered points are wrong by $cN$ of the flow's own, $N$ cells in $L$, which grows under
refinement; $c$ is the largest in a table of an independent program with prescribed velocities
(0.0032 and 0.029 with cubic, 0.038 and 0.16 with linear functions). Viscosity holds the velocities
which follow from that at $2\sqrt2\,c\,\mathrm{Re}/N$. What the grid does not see of them stays in
the points: with linear functions, Re = 5 and 64 cells the run ends with points that move more than
a cell in a step, so that the matrix has these functions up to Re = 1. The velocity error in the
figures has the sound in it, which does not fall under refinement.

The solvers `TGVErrorSolver` and `ShiftedTGVErrorSolver` of mpm_3d measured the disorder alone, with
velocities and pressures that were prescribed.
""",
    source=(
        "Taylor and Green, Proc. R. Soc. A 158 (1937) 499-521; discrete amplitudes and error of "
        "the start derived here; disorder: independent program"
    ),
    scene=scene,
    measure=measure,
    judge=judge,
    error="v_l2",
)
