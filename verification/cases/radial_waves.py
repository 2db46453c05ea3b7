"""Radial waves of cylinders and spheres: between walls, and breathing freely."""

from __future__ import annotations

from functools import cache

import numpy as np
from _scheme import LinearScheme
from _waves import (
    DENSITY,
    FREE,
    LENGTH,
    SLIP,
    YOUNG,
    Walls,
    bessel,
    fit_oscillation,
    root,
    wave_speed,
)
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.norms import Errors, linf
from harness.scene import (
    DIM,
    Body,
    Scene,
    lattice,
    pressure_wave_modulus,
    shear_modulus,
    stable_dt,
)
from harness.theory import dispersion_constant

FRAMES = 20
AMPLITUDE = 1e-8
#: Largest run that is compared with the linear scheme, in points times components.
LARGEST = 1600


def kind(p: Parameters) -> str:
    """Return what the row says: `wall`, a cylinder in a wall, or a free `cylinder` or `sphere`."""
    return p.text("body", "wall")


def moduli(p: Parameters) -> tuple[float, float]:
    """Return lambda + 2 G and G."""
    nu = p.number("nu", 0.0)
    return pressure_wave_modulus(YOUNG, nu), shear_modulus(YOUNG, nu)


@cache
def wave_number_of(body: str, ratio: float) -> float:
    """Return k R of the first mode; `ratio` is G/M."""
    if body == "wall":
        return root(lambda q: float(bessel(1, q)), 3.0, 4.5)
    if body == "cylinder":
        return root(lambda q: float(q * bessel(0, q) - 2.0 * ratio * bessel(1, q)), 1.0, 2.4)
    return root(lambda q: np.tan(q) * (1.0 - q * q / (4.0 * ratio)) - q, 1.9, 3.1)


def wave_number(p: Parameters) -> float:
    """Return k."""
    m, g = moduli(p)
    return wave_number_of(kind(p), g / m) / LENGTH


def radial(p: Parameters, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return u, du/dq and u/q at q = k times the radius, u not yet scaled."""
    q = np.maximum(q, 1e-6)
    if kind(p) == "sphere":
        u = np.sin(q) / q**2 - np.cos(q) / q
        return u, np.sin(q) / q - 2.0 * u / q, u / q
    u = bessel(1, q)
    return u, bessel(0, q) - u / q, u / q


def largest(p: Parameters) -> float:
    """Return the largest u on the radius."""
    return float(np.max(radial(p, np.linspace(0.0, wave_number(p) * LENGTH, 4001))[0]))


def walls(p: Parameters) -> Walls:
    """Return smooth planes, the axis, and smooth or no walls outside."""
    codes = [SLIP] * (2 * DIM[p.sim_type])
    if kind(p) != "wall":
        codes[1] = FREE
    if kind(p) == "sphere":
        codes[1::2] = [FREE] * DIM[p.sim_type]
    return Walls(codes)


def radii(p: Parameters, x: np.ndarray) -> np.ndarray:
    """Return vectors from the axis or the centre."""
    if kind(p) == "sphere":
        return x
    return np.column_stack([x[:, 0], np.zeros(len(x))])


def shape(p: Parameters, x: np.ndarray) -> np.ndarray:
    """Return the displacement over A: (n, 3)."""
    vectors = radii(p, x)
    distance = np.sqrt(np.sum(vectors**2, axis=1))
    u = radial(p, wave_number(p) * distance)[0] / largest(p)
    result = np.zeros((len(x), 3))
    result[:, : x.shape[1]] = vectors * (u / distance)[:, None]
    return result


def stresses(p: Parameters, x: np.ndarray) -> np.ndarray:
    """Return the stress over M k A: (n, 3, 3)."""
    vectors = np.zeros((len(x), 3))
    vectors[:, : x.shape[1]] = radii(p, x)
    distance = np.sqrt(np.sum(vectors**2, axis=1))
    _, along, across = radial(p, wave_number(p) * distance)
    m, g = moduli(p)
    turns = 2.0 if kind(p) == "sphere" else 1.0
    trace = along + turns * across
    normal = vectors / distance[:, None]
    # Strain across the radius: in all other directions of a sphere, around the axis of a cylinder.
    strain = (along - across)[:, None, None] * normal[:, :, None] * normal[:, None, :]
    plane = np.eye(3) if kind(p) == "sphere" else np.diag([1.0, 0.0, 1.0])
    strain += across[:, None, None] * plane
    lame = (m - 2.0 * g) * trace[:, None, None] * np.eye(3)
    return (lame + 2.0 * g * strain) / (m * largest(p))


def scene(p: Parameters) -> Scene:
    """Return a slab of a cylinder between smooth planes, or a part of a sphere."""
    dim, h, c = DIM[p.sim_type], LENGTH / p.cells, wave_speed(p)
    spare = 0 if kind(p) == "wall" else 1
    sphere = kind(p) == "sphere"
    filled = [p.cells] * dim if sphere else [p.cells, 1]
    cells = [n + spare for n in filled] if sphere else [p.cells + spare, 1]
    points = lattice(
        p.sim_type, [0.0] * dim, [n * h for n in filled], [n * p.ppc for n in filled], DENSITY
    )
    if sphere:
        points = points.keep(np.sum(points.x**2, axis=1) < LENGTH**2)
    speed = AMPLITUDE * wave_number(p) * c
    points.velocity[:] = speed * shape(p, points.x)
    t_stop = 2.0 * np.pi / (wave_number(p) * c)
    body = Body("body", points, YOUNG, p.number("nu", 0.0), walls(p).section())
    dt = stable_dt(h, 1, c, t_stop, p.number("cfl", 0.2), FRAMES)
    return Scene(p.sim_type, [n * h for n in cells], cells, [body], t_stop, dt, FRAMES, p.mapping)


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors, also away from the axis, the frequency, the difference from theory."""
    points, k = out.scene.bodies[0].points, wave_number(p)
    omega, m = k * wave_speed(p), moduli(p)[0]
    x, volume = points.x, points.measure
    exact, stress = shape(p, x), stresses(p, x)
    off_axis = x[:, 0] > 2.0 * LENGTH / p.cells
    errors, away = Errors(volume), Errors(volume[off_axis])
    small = len(points) * 3 <= LARGEST
    theory = np.zeros((FRAMES + 1, len(points), 3))
    if small:
        scheme = LinearScheme(out.scene, walls(p).codes)
        theory, _ = scheme.march(out.scene.dt, out.scene.steps, out.scene.steps // FRAMES)
    deviation, times, amplitudes = 0.0, [], []
    for number, frame in enumerate(out.points()):
        t = frame.time
        u = frame["displacement"] / AMPLITUDE
        s = frame["cauchy_stress"] / (m * k * AMPLITUDE)
        for of, chosen in ((errors, slice(None)), (away, off_axis)):
            name = "" if of is errors else "_off"
            of.add(f"e_u{name}", (u - exact * np.sin(omega * t))[chosen])
            of.add(f"e_s{name}", (s - stress * np.sin(omega * t))[chosen])
        if small:
            deviation = max(deviation, linf(u - theory[number] / AMPLITUDE))
        times.append(t)
        amplitudes.append(np.sum(volume[:, None] * exact * u) / np.sum(volume[:, None] * exact**2))
    found, _ = fit_oscillation(np.array(times), np.array(amplitudes), omega)
    result = {**errors.measures(), **away.measures(), "frequency_ratio": found / omega}
    result["frequency_error"] = abs(1.0 - found / omega)
    if small:
        result["d_u"] = deviation
    return result


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    if len(r.cells) > 1:
        findings = sphere_orders(r) if kind(r.first) == "sphere" else cylinder_orders(r)
    for p, m in r:
        label, q = f"{p.cells} cells", wave_number(p) * LENGTH
        findings.append(
            below(
                f"error of the frequency, {label}",
                m["frequency_error"],
                dispersion_constant(p.ppc) * (q / p.cells) ** 2
                + (0.5 / (p.ppc * p.cells) if kind(p) == "sphere" else 0.0),
                "the dispersion of a plane wave of the same k as a bound; for a sphere half a "
                "distance of points more, by its steps",
            )
        )
        if "d_u" in m:
            findings.append(
                below(
                    f"d_u, {label}",
                    m["d_u"],
                    10.0 * wave_number(p) * AMPLITUDE,
                    "the linear scheme as matrices, written a second time; 10 strains for what is "
                    "not linear",
                )
            )
    return findings


def cylinder_orders(r: Results) -> list[Finding]:
    """Return the orders of a cylinder whose surface lies on a grid line."""
    second = "lumped mass: order 2, at the axis too; 0.15 for the next terms"
    return [
        Finding("order of the frequency", r.order("frequency_error"), 1.85, 2.15, 2.0, second),
        Finding("order of e_u", r.order("e_u_l2"), 1.85, 2.15, 2.0, second),
        Finding("order of e_u, linf", r.order("e_u_linf"), 1.85, 2.15, 2.0, second),
        Finding(
            "order of e_s",
            r.order("e_s_l2"),
            0.95,
            2.05,
            1.0,
            "gradients of linear functions at points: order 1, up to 2 on few cells",
        ),
    ]


def sphere_orders(r: Results) -> list[Finding]:
    """Return the orders of a sphere of points on a lattice."""
    steps = "the surface is a staircase of points: order 1, up to 2 where its errors cancel"
    findings = [
        Finding("order of the frequency", r.order("frequency_error"), 0.9, 2.2, np.nan, steps),
        Finding("order of e_u", r.order("e_u_l2"), 0.9, 2.2, np.nan, steps),
    ]
    if r.first.sim_type == 4 and max(r.cells) >= 32:
        findings.append(
            Finding(
                "order of e_s, linf",
                r.order("e_s_linf"),
                -1.0,
                0.3,
                0.0,
                "stress at the steps of the surface does not converge",
            )
        )
    return findings


CASE = Case(
    family="Axial bar",
    title="Radial waves of cylinders and spheres",
    statement=r"""
`wall`: a cylinder in a rigid smooth wall, $u_r = A J_1(kr)\sin kct$ with $J_1(kR) = 0$,
$kR = 3.83171$, $c = \sqrt{M/\rho}$. `cylinder`: free, $M\,kR\,J_0(kR) = 2G J_1(kR)$,
$kR$ = 1.84118, 2.12575 for $\nu$ = 0, 0.3. `sphere`: free, $u \propto j_1(k\rho)$,
$\tan q = q/(1 - q^2M/(4G))$, $q = kR$ = 2.08158, 2.67021. In TYPE 4 a slab between smooth planes,
or half a sphere; in TYPE 3 an eighth of a sphere. Start: velocities at zero displacement; one
period.

Expected: order 2 of frequency and displacement when the surface lies on a grid line, also at the
axis; order 1 of stress at points. A sphere of points on a lattice has a surface of steps: order 1
to 2, and no convergence of the stress at the steps. On coarse grids the displacements are compared
with those of the linear scheme, written a second time as matrices.
""",
    source="""Love, A Treatise on the Mathematical Theory of Elasticity (1927), chapters XII and
XIII.""",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
