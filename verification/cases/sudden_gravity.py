"""A column under gravity that sets in at once."""

from __future__ import annotations

import numpy as np
from _waves import DENSITY, FREE, LENGTH, Bar, BarScheme, walls_reflect
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.norms import Errors, linf
from harness.scene import Scene

#: rho g L/M: the strain at the base of the column at rest.
STRAIN = 1e-8
#: E_u c^2/(g L^2) of an independent program with the same scheme, 2 points per cell, CFL 0.2, by
#: cells: without and with a staggered start; and the largest stress at the base over 2 rho g L.
PLAIN = {16: 3.57e-3, 32: 1.67e-3, 64: 8.4e-4, 128: 4.35e-4, 256: 2.21e-4}
STAGGERED = {16: 4.05e-3, 32: 1.28e-3, 64: 4.06e-4, 128: 1.28e-4, 256: 4.05e-5}
#: The same of splines, two digits.
SPLINES = {
    "quadratic": {16: 7.3e-3, 32: 2.28e-3, 64: 7.2e-4, 128: 2.25e-4, 256: 7.1e-5},
    "cubic": {16: 8.8e-3, 32: 2.78e-3, 64: 8.8e-4, 128: 2.76e-4, 256: 8.7e-5},
}
PEAK = {16: 0.949, 32: 0.971, 64: 0.983, 128: 0.990}


def bar(p: Parameters) -> Bar:
    """Return the column."""
    return Bar(p, end=FREE)


def frames(p: Parameters) -> int:
    """Return the number of frames: many in one dimension, where peaks are looked at."""
    return 160 if p.sim_type == 1 else 80


def is_staggered(p: Parameters) -> bool:
    """Tell whether the points start with the velocities of half a step before."""
    return p.text("start", "plain") == "staggered"


def gravity(p: Parameters) -> float:
    """Return g."""
    return STRAIN * bar(p).c ** 2 / LENGTH


def period(p: Parameters) -> float:
    """Return the time of a period."""
    return 4.0 * LENGTH / bar(p).c


def start(p: Parameters) -> float:
    """Return the velocity of the points at the start."""
    return 0.5 * gravity(p) * bar(p).dt(period(p), frames(p)) if is_staggered(p) else 0.0


def scene(p: Parameters) -> Scene:
    """Return a column on a smooth base."""
    return bar(p).scene(
        lambda x: np.full_like(x, start(p)), period(p), frames(p), gravity=-gravity(p)
    )


def exact(x: np.ndarray, way: float) -> tuple[np.ndarray, np.ndarray]:
    """Return u c^2/(g L^2) and stress/(rho g L) when waves have run a way, in lengths.

    Waves start at the base and are reflected at the top without, at the base with a change of sign.
    """
    u, s = np.full_like(x, -0.5 * way**2), np.zeros_like(x)
    for m in range(3):
        up = np.maximum(0.0, way - (2 * m + x))
        down = np.maximum(0.0, way - (2 * (m + 1) - x))
        u += 0.5 * (-1) ** m * (up**2 + down**2)
        s += (-1) ** m * (down - up)
    return u, s


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors, the largest stress at the base, and the difference from theory."""
    this, points, g = bar(p), out.scene.bodies[0].points, gravity(p)
    x = points.x[:, this.axis]
    unit = g * LENGTH**2 / this.c**2
    scheme = BarScheme(this)
    line = np.searchsorted(scheme.x, x - 1e-9 * this.h)
    theory, _ = scheme.march(
        np.full(len(scheme.x), start(p)),
        np.full(len(scheme.mass), -g),
        out.scene.dt,
        out.scene.steps,
        out.scene.steps // out.scene.frames,
    )
    errors, base = Errors(points.measure), []
    deviation = stress_deviation = 0.0
    for number, frame in enumerate(out.points()):
        u = frame["displacement"][:, this.axis] / unit
        s = frame["cauchy_stress"][:, this.axis, this.axis] / (DENSITY * g * LENGTH)
        exact_u, exact_s = exact(x / LENGTH, frame.time * this.c / LENGTH)
        errors.add("e_u", u - exact_u)
        errors.add("e_s", s - exact_s)
        nodes = theory[number] / unit
        deviation = max(deviation, linf(u - (scheme.values @ nodes)[line]))
        stress_deviation = max(stress_deviation, linf(s - LENGTH * (scheme.slopes @ nodes)[line]))
        base.append(float(-np.mean(s[x < this.h])))
    return {
        **errors.measures(),
        "peak": max(base) / 2.0,
        "when": np.argmax(base) * 4.0 / out.scene.frames,
        "d_u": deviation,
        "d_s": stress_deviation,
    }


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    staggered = is_staggered(r.first)
    if len(r.cells) > 1:
        reason = (
            "gravity sets in with v at t = 0 for v at -dt/2: order 1; 0.1 for the rest"
            if not staggered
            else "kinks of the velocity under second order dispersion: order 5/3; 0.1 for few cells"
        )
        order = highest = 5.0 / 3.0 if staggered else 1.0
        if not staggered and not walls_reflect(r.first):
            highest = 5.0 / 3.0
            reason += "; up to 5/3 for splines, the kinks of which are wider, with few cells"
        findings.append(
            Finding("order of e_u", r.order("e_u_l2"), order - 0.1, highest + 0.1, order, reason)
        )
        findings.append(
            Finding(
                "order of e_s",
                r.order("e_s_l2"),
                0.9,
                1.1,
                1.0,
                "kinks of the stress, and one stress for all points of a cell: order 1",
            )
        )
    for p, m in r:
        label, cfl = f"{p.cells} cells", bar(p).cfl(bar(p).dt(period(p), frames(p)))
        linear = (
            "the discrete equations marched in a second way; strains times the waves' way for what "
            "is not linear"
        )
        findings += [
            below(f"d_u, {label}", m["d_u"], 8.0 * STRAIN * 4.0, linear),
            below(f"d_s, {label}", m["d_s"], 32.0 * STRAIN * 4.0, f"{linear}, kinks"),
            near(
                f"time of the largest stress, {label}",
                m["when"],
                2.0,
                2.0 / frames(p) + 1.0 / p.cells,
                "t = 2L/c; a frame, a cell",
            ),
        ]
        if not staggered and (walls_reflect(p) or p.cells >= 64):
            findings.append(
                near(
                    f"e_u by theory, {label}",
                    m["e_u_l2"],
                    cfl / (2.0 * np.sqrt(3.0) * p.cells),
                    0.12,
                    "half a step too late: (dt/2) max |v|, |v| the root mean square, at ct = L; "
                    "12 %: errors of order 5/3",
                )
            )
        if p.sim_type > 1:
            continue
        if p.ppc == 2 and staggered and p.cells in SPLINES.get(p.mapping, {}):
            findings.append(
                near(
                    f"e_u of another program, {label}",
                    m["e_u_l2"],
                    SPLINES[p.mapping][p.cells],
                    0.02,
                    "an independent program with the same scheme, two digits",
                )
            )
        if not walls_reflect(p):
            continue
        if p.ppc == 2 and p.cells in PLAIN:
            findings.append(
                near(
                    f"e_u of another program, {label}",
                    m["e_u_l2"],
                    (STAGGERED if staggered else PLAIN)[p.cells],
                    0.01,
                    "an independent program with the same scheme, three digits; 1 %: instants of "
                    "frames",
                )
            )
        if p.ppc == 2 and p.cells in PEAK:
            findings.append(
                Finding(
                    f"largest stress at the base, {label}",
                    m["peak"],
                    PEAK[p.cells] - 0.003,
                    PEAK[p.cells] + 0.003,
                    PEAK[p.cells],
                    "an independent program; 2 rho g L, less the half cell and what dispersion "
                    "takes off the tip; instants of frames",
                )
            )
    return findings


CASE = Case(
    family="Axial bar",
    title="Sudden gravity on a column",
    statement=r"""
A column on a smooth base, free at its top, between smooth walls, at rest when gravity sets in.
Exact over a period $4L/c$, with $[\cdot]_+$ the positive part:
$$u = -\tfrac12 g t^2 + \tfrac12 g \sum_m (-1)^m\left\{[t-(2mL+X)/c]_+^2 +
[t-(2(m+1)L-X)/c]_+^2\right\},$$
a stress at the base of $\rho g c t$, then $\rho g(4L-ct)$, at most $2\rho gL$: twice that at rest.

Expected: symplectic steps take the velocity at the start for that of half a step before, so that
all comes $\Delta t/2$ too late: order 1, $E_u = \mathrm{CFL}\,h/(2\sqrt3L)$ in units of $gL^2/c^2$.
When the points start with $v = +\frac12 g\Delta t$ the kinks of the velocity are what is left:
order 5/3. The solution of the discrete equations, marched in a second way, is met to the size of
the strains.
""",
    source="""d'Alembert; checked against a modal series. Order and constants:
`docs/verification.md`.""",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
)
