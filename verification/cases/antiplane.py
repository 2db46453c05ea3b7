"""Shear out of the plane."""

from __future__ import annotations

import numpy as np
from _manufactured import (
    fitted,
    halvings,
    interpolation_error,
    judge_start,
    measure_solution,
)
from _solutions import Antiplane
from harness.case import Case, Finding, Measures, Output, Parameters, Results, near
from harness.scene import Body, Scene, lattice, section, stable_dt
from harness.scheme import FEWEST_CELLS

YOUNG, POISSON, DENSITY = 2.6, 0.3, 1.0
FRAMES = 20
#: Free faces along x, smooth walls along y.
WALLS = 'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {-1, -1, 1, 1}'


def solution(p: Parameters) -> Antiplane:
    """Return the exact solution of a row; a cell of the grid lies beyond each face."""
    amplitude = p.number("amplitude", 0.1)
    exact = Antiplane(YOUNG, POISSON, DENSITY, amplitude=amplitude, origin=1.0 / p.cells)
    exact.length, exact.time = 0.2, 1.0 / exact.omega
    return exact


def scene(p: Parameters) -> Scene:
    """Return a row of cells, one cell wide, or as many as the functions need."""
    exact, h = solution(p), 1.0 / p.cells
    t_stop = p.number("periods", 1.0) * 2 * np.pi / exact.omega
    constants = {
        "t_stop": t_stop,
        "amplitude": exact.amplitude,
        "length": 1.0,
        "density": DENSITY,
        "E": YOUNG,
        "nu": POISSON,
        "origin_x": exact.origin,
    }
    wide = FEWEST_CELLS[p.mapping]
    points = lattice(5, [h, 0.0], [1.0 + h, wide * h], [p.cells * p.ppc, wide * p.ppc], DENSITY)
    return Scene(
        5,
        [1.0 + 2 * h, wide * h],
        [p.cells + 2, wide],
        [Body("block", points, YOUNG, POISSON, WALLS)],
        t_stop,
        stable_dt(1.0, p.cells, exact.wave_speed, t_stop, p.number("cfl", 0.2), FRAMES),
        FRAMES,
        p.mapping,
        driver=section("AntiplaneDriver", constants),
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Measure the errors over all frames, and how the stress has grown by rotation at the end."""
    exact, dt = solution(p), out.scene.dt
    points = out.scene.bodies[0].points
    frame = out.points()[-1]
    stress, strain = frame["cauchy_stress"], np.log(frame["volume"] / points.volume)
    # (G - (T_zz - T_xx)/2, T_xz) turns by the shear and keeps its length; the in-plane strain of
    # the block, small of second order, adds G strain.
    normal = exact.shear * (1.0 - strain) - 0.5 * (stress[:, 2, 2] - stress[:, 0, 0])
    growth = np.log(np.hypot(normal, stress[:, 2, 0]) / exact.shear)
    # Forward Euler: a factor sqrt(1 + (dt c')^2) a step, c' = dc/dt. The mean over X of c'^2 is
    # (pi A omega cos(omega t))^2/2, its mean over time half of that.
    rate = 0.25 * (np.pi * exact.amplitude * exact.omega) ** 2
    predicted = 0.5 * dt * rate * frame.time
    return {**measure_solution(exact, out), "growth": float(np.mean(growth) / predicted)}


def judge(r: Results) -> list[Finding]:
    """Judge the start; small shears: order 2; large ones: 1, and the growth of the stress."""
    amplitude = r.first.number("amplitude", 0.1)
    found = judge_start(r, np.pi * amplitude, 1e-8) + halvings(r, "u_l2", "v_l2", "stress_l2")
    for p, m in r:
        # f'' = 2 pi^2 cos(2 pi X) for two components of T, over G pi A: 2 pi h d_rms/h. The frames
        # of a period in 20 parts show the largest shear.
        error = interpolation_error(p.ppc, 1.0 / p.cells, 2 * np.pi)
        if p.ppc > 1 and amplitude <= 0.1 and p.mapping not in ("quadratic", "cubic"):
            reason = "gradient of the middle of a cell; 8 %: second order in 2 pi h, cos c"
            found.append(near(f"stress_l2, {p.cells} cells", m["stress_l2"], error, 0.08, reason))
    if amplitude < 0.01:
        reason = "no point moves in the plane, small shear: order 2"
        if r.first.mapping in ("quadratic", "cubic"):
            why = "slopes of splines are of order 2 at every place; faces and 2 pi h: 0.3"
            found += fitted(r, "stress_l2", 1.7, 2.1, why)
        return found + fitted(r, "u_l2", 1.9, 2.1, reason)
    reason = "rotation of the stress by forward Euler steps: order 1 in dt = C h/c"
    if amplitude <= 0.1:
        for p, m in r:
            why = "sqrt(1 + (dt c')^2) a step; 5 %: strain times shear, second order in h"
            name = f"growth of the stress, {p.cells} cells"
            found.append(near(name, m["growth"], 1.0, 0.05, why))
        high = 1.6
        if r.first.mapping in ("quadratic", "cubic"):
            high = 2.1
            reason += "; dispersion of order 2, twice that of linear functions and more, beside it"
        return found + fitted(r, "u_l2", 0.95, high, reason, first=64)
    if r.first.scheme.rate == "hughes_winget":
        reason = "stress turned by a rotation of the middle of the step: order 2 in dt, as in h"
        return found + fitted(r, "u_l2", 1.85, 2.1, reason, first=32)
    return found + fitted(r, "u_l2", 0.9, 1.25, reason, first=32)


CASE = Case(
    family="Manufactured solutions",
    title="Shear out of the plane",
    statement=r"""
TYPE 5: a block $0 < X < 1$ m with free faces moves out of the plane by $u_z = A \sin(\omega t)
\sin^2(\pi X)$, $\omega = \pi\sqrt{G/\rho}$. It is a simple shear $c = \partial u_z/\partial X$,
of which the Jaumann rate makes $T_{xz} = G \sin c$, $T_{zz} = -T_{xx} = G(1 - \cos c)$. The body
force is $b_z = \ddot u_z - (G/\rho) \cos c\; \partial c/\partial X$ and, in the plane, $b_x =
(G/\rho) \sin c\; \partial c/\partial X$, without which the points would move along $x$. The faces
are free of displacement and traction.

Measured: largest norms over the frames of the errors of displacement, velocity and stress, over
$A$, $\omega A$, $\pi G A$; and the length of the vector $(G - (T_{zz} - T_{xx})/2,\; T_{xz})$,
which the rotation leaves unchanged.

Points stay in their cells, so that there is no noise from crossing and both mappings do the same.
A small shear shows order 2, stresses order 1 with a known factor ($n > 1$: they have the gradient
of the middle of their cell). At a large shear the rotation by forward Euler steps lengthens that
vector by $\sqrt{1 + (\Delta t\, \dot c)^2}$ a step, which is of order 1 in time, and takes over.
""",
    source="Simple shear with the Jaumann rate: Dienes, Acta Mechanica 32 (1979) 217-232",
    scene=scene,
    measure=measure,
    judge=judge,
    error="u_l2",
    order=2.0,
)
