"""Torsional waves of a round bar."""

from __future__ import annotations

import numpy as np
from _scheme import LinearScheme
from _waves import DENSITY, LENGTH, SLIP, STICK, YOUNG, Walls, fit_oscillation, wave_speed
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.norms import Errors, linf
from harness.scene import Body, Scene, lattice, shear_modulus, stable_dt

FRAMES = 20
AMPLITUDE = 1e-8
K = np.pi / LENGTH
#: Largest run that is compared with the linear scheme, in points times components.
LARGEST = 2000


def frequency(p: Parameters) -> float:
    """Return the exact frequency."""
    return K * float(np.sqrt(shear_modulus(YOUNG, p.number("nu", 0.0)) / DENSITY))


def is_held(p: Parameters) -> bool:
    """Tell whether the ends are held, instead of free to turn on smooth planes."""
    return p.text("ends", "slip") == "stick"


def walls(p: Parameters) -> Walls:
    """Return the walls."""
    ends = STICK if is_held(p) else SLIP
    return Walls([STICK if p.text("axis", "slip") == "stick" else SLIP, SLIP, ends, ends])


def radius_cells(p: Parameters) -> int:
    """Return the cells on the radius."""
    return max(2, p.cells // 4)


def along(p: Parameters, z: np.ndarray) -> np.ndarray:
    """Return the shape along the bar."""
    return np.sin(K * z) if is_held(p) else np.cos(K * z)


def scene(p: Parameters) -> Scene:
    """Return a bar with velocities A omega r/R sin or cos kz around its axis."""
    h, cells = LENGTH / p.cells, [radius_cells(p), p.cells]
    lengths = [n * h for n in cells]
    points = lattice(4, [0.0, 0.0], lengths, [n * p.ppc for n in cells], DENSITY)
    omega = frequency(p)
    r, z = points.x.T
    points.velocity[:, 2] = AMPLITUDE * omega * r / lengths[0] * along(p, z)
    t_stop = 2.0 * np.pi / omega
    body = Body("bar", points, YOUNG, p.number("nu", 0.0), walls(p).section())
    dt = stable_dt(h, 1, wave_speed(p), t_stop, p.number("cfl", 0.2), FRAMES)
    return Scene(4, lengths, cells, [body], t_stop, dt, FRAMES, p.mapping)


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors, also away from the axis, and the difference from theory."""
    points, omega = out.scene.bodies[0].points, frequency(p)
    x, volume = points.x, points.measure
    radius = out.scene.lengths[0]
    exact = x[:, 0] / radius * along(p, x[:, 1])
    g = shear_modulus(YOUNG, p.number("nu", 0.0))
    slope = np.cos(K * x[:, 1]) if is_held(p) else -np.sin(K * x[:, 1])
    off = x[:, 0] > 2.0 * LENGTH / p.cells
    errors, away = Errors(volume), Errors(volume[off])
    small = len(points) * 3 <= LARGEST
    if small:
        scheme = LinearScheme(out.scene, walls(p).codes)
        theory, _ = scheme.march(out.scene.dt, out.scene.steps, out.scene.steps // FRAMES)
    deviation, others, times, amplitudes = 0.0, 0.0, [], []
    for number, frame in enumerate(out.points()):
        t, u = frame.time, frame["displacement"] / AMPLITUDE
        s = frame["cauchy_stress"] / (g * K * AMPLITUDE)
        errors.add("e_u", u[:, 2] - exact * np.sin(omega * t))
        away.add("e_u_off", (u[:, 2] - exact * np.sin(omega * t))[off])
        errors.add("e_s", s[:, 1, 2] - x[:, 0] / radius * slope * np.sin(omega * t))
        errors.add("e_shear", s[:, 0, 2])
        away.add("e_shear_off", s[off, 0, 2])
        others = max(others, linf(u[:, :2]))
        if small:
            deviation = max(deviation, linf(u - theory[number] / AMPLITUDE))
        times.append(t)
        amplitudes.append(float(np.sum(volume * exact * u[:, 2]) / np.sum(volume * exact**2)))
    found, _ = fit_oscillation(np.array(times), np.array(amplitudes), omega)
    result = {**errors.measures(), **away.measures(), "others": others}
    result |= {"frequency_ratio": found / omega, "frequency_error": abs(1.0 - found / omega)}
    if small:
        result["d_u"] = deviation
    return result


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    if len(r.cells) > 1:
        second = "lumped mass: order 2, at the axis too; 0.15 for the next terms"
        findings = [
            Finding("order of the frequency", r.order("frequency_error"), 1.85, 2.15, 2.0, second),
            Finding("order of e_u", r.order("e_u_l2"), 1.85, 2.15, 2.0, second),
            Finding("order of e_u, linf", r.order("e_u_linf"), 1.85, 2.15, 2.0, second),
            Finding(
                "order of e_s",
                r.order("e_s_l2"),
                0.95,
                2.15,
                1.0,
                "gradients of bilinear functions at points: order 1, up to 2 on few cells",
            ),
            Finding(
                "order of the shear in planes through the axis",
                r.order("e_shear_l2"),
                1.4,
                2.15,
                1.5,
                "exactly 0; order 1 in the cells at axis and surface, a part h of the bar: 3/2, up "
                "to 2 on few cells",
            ),
        ]
    for p, m in r:
        label, strain = f"{p.cells} cells", K * AMPLITUDE * p.cells / radius_cells(p)
        findings.append(
            below(
                f"motion in planes through the axis, {label}",
                m["others"],
                10.0 * strain,
                "centrifugal forces alone, of second order in the strains",
            )
        )
        if "d_u" in m:
            findings.append(
                below(
                    f"d_u, {label}",
                    m["d_u"],
                    10.0 * strain,
                    "the linear scheme as matrices, written a second time; 10 strains for what is "
                    "not linear",
                )
            )
    return findings


CASE = Case(
    family="Axial bar",
    title="Torsional waves of a round bar",
    statement=r"""
$u_\theta = A (r/R)\cos kz\sin\omega t$, $\omega = k\sqrt{G/\rho}$, $k = \pi/L$, between smooth
planes, or $\sin kz$ between planes that hold it; a smooth wall at $r = R = L/4$, which does not
touch $u_\theta$. Exact: $\sigma_{z\theta} = -GkA(r/R)\sin kz\sin\omega t$, and no shear
$\sigma_{r\theta}$. Start: velocities at zero displacement; one period. In one row the axis is held.

Expected: order 2 of frequency and displacement. The mass of the points around a node is not
centred at it, so that the grid turns $r$ into $r + O(h^2/r)$: shear $\sigma_{r\theta}$ of order 1
in the cells at the axis and at the surface, less inside. On coarse grids the displacements are
compared with those of the linear scheme, written a second time as matrices.
""",
    source="Love, A Treatise on the Mathematical Theory of Elasticity (1927), article 200.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
