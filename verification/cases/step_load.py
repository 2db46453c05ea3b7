"""A bar that is pulled at its end from one instant on."""

from __future__ import annotations

import numpy as np
from _waves import DENSITY, LENGTH, SLIP, TRACTION, Bar, BarScheme, Walls
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.norms import Errors, l1, linf
from harness.scene import DIM, Scene
from harness.theory import dispersion_constant

#: Traction over M.
STRAIN = 1e-8
FRAMES = 160
#: A jump becomes the integral of an Airy function by dispersion of third order: up to its first
#: zero at -2.338 the integral is 1.274.
AIRY_OVERSHOOT = 0.2744


def bar(p: Parameters) -> Bar:
    """Return the bar; it fills the grid, since the traction acts on a face of the grid."""
    return Bar(p)


def period(p: Parameters) -> float:
    """Return the time of a period."""
    return 4.0 * LENGTH / bar(p).c


def walls(p: Parameters) -> Walls:
    """Return smooth walls, and a traction along the bar at its end.

    A traction replaces the walls beside it where it acts, unless its components say that the
    others are held.
    """
    dim, along = DIM[p.sim_type], bar(p).axis
    codes = [SLIP] * (2 * dim)
    codes[2 * along + 1] = TRACTION
    values = [np.nan if i < dim else 0.0 for i in range(3)]
    values[along] = STRAIN * bar(p).modulus
    return Walls(codes, values)


def scene(p: Parameters) -> Scene:
    """Return the bar at rest."""
    return bar(p).scene(np.zeros_like, period(p), FRAMES, walls=walls(p))


def exact(x: np.ndarray, way: float) -> tuple[np.ndarray, np.ndarray]:
    """Return u M/(traction L) and stress/traction when waves have run a way, in lengths."""
    u, s = np.zeros_like(x), np.zeros_like(x)
    for m in range(2):
        down, up = way - (2 * m + 1 - x), way - (2 * m + 1 + x)
        u += (-1) ** m * (np.maximum(0.0, down) - np.maximum(0.0, up))
        s += (-1) ** m * ((down > 0.0).astype(float) + (up > 0.0).astype(float))
    return u, s


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors, overshoots and the difference from theory."""
    this, points = bar(p), out.scene.bodies[0].points
    x, volume = points.x[:, this.axis], points.measure
    scheme = BarScheme(this, held=False)
    line = np.searchsorted(scheme.x, x - 1e-9 * this.h)
    load = np.zeros(p.cells + 1)
    load[-1] = STRAIN * this.modulus / (DENSITY * scheme.mass[-1] * this.h)
    theory, _ = scheme.march(
        np.zeros(len(scheme.x)), load, out.scene.dt, out.scene.steps, out.scene.steps // FRAMES
    )
    errors, in_time, in_middle, end = Errors(volume), [], [], []
    highest = lowest = stress_deviation = deviation = 0.0
    middle = np.abs(x - 0.5 * LENGTH) < this.h
    for number, frame in enumerate(out.points()):
        u = frame["displacement"][:, this.axis] / (STRAIN * LENGTH)
        s = frame["cauchy_stress"][:, this.axis, this.axis] / (STRAIN * this.modulus)
        exact_u, exact_s = exact(x / LENGTH, frame.time * this.c / LENGTH)
        errors.add("e_u", u - exact_u)
        in_time.append(l1(s - exact_s, volume))
        in_middle.append(l1((s - exact_s)[middle], volume[middle]))
        nodes = theory[number] / (STRAIN * LENGTH)
        deviation = max(deviation, linf(u - (scheme.values @ nodes)[line]))
        stress_deviation = max(stress_deviation, linf(s - LENGTH * (scheme.slopes @ nodes)[line]))
        highest, lowest = max(highest, float(np.max(s))), min(lowest, float(np.min(s)))
        end.append(float(np.mean(u[x > LENGTH - this.h])))
    return {
        **errors.measures(),
        "e_s": float(np.mean(in_time)),
        "e_s_middle": float(np.mean(in_middle)),
        "over": highest - 2.0,
        "under": -lowest,
        "end": max(end),
        "when": np.argmax(end) * 4.0 / FRAMES,
        "d_u": deviation,
        "d_s": stress_deviation,
    }


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    if len(r.cells) > 1:
        jump = (
            "jumps under dispersion of third order: 2/3, less up to 1/6 for the tail of the Airy "
            "function; 0.05 for few cells"
        )
        findings = [
            Finding("order of e_s in space and time", r.order("e_s"), 0.48, 0.7, np.nan, jump),
            Finding("order of e_s in the middle", r.order("e_s_middle"), 0.45, 0.75, np.nan, jump),
            Finding(
                "order of e_u",
                r.order("e_u_l2"),
                0.9,
                1.1,
                1.0,
                "kinks under dispersion of third order, and a start half a step late: order 1",
            ),
            Finding(
                "order of e_u, linf",
                r.order("e_u_linf"),
                0.6,
                0.8,
                2.0 / 3.0,
                "the width of a kink, order 2/3; 0.1 for the start half a step late",
            ),
        ]
    for p, m in r:
        label = f"{p.cells} cells"
        linear = (
            "the discrete equations marched in a second way; the load is that of the filled part "
            "of the end, which grows by 2 u/h, for what is not linear"
        )
        # (3 kappa h^2 ct)^(1/3) of the Airy function after ct = 2L.
        width = (6.0 * dispersion_constant(p.ppc, p.mapping)) ** (1.0 / 3.0) * p.cells ** (
            -2.0 / 3.0
        )
        findings += [
            below(f"d_u, {label}", m["d_u"], 8.0 * STRAIN * p.cells, linear),
            below(f"d_s, {label}", m["d_s"], 16.0 * STRAIN * p.cells, linear),
            Finding(
                f"overshoot, {label}",
                m["over"],
                0.1,
                2.0 * AIRY_OVERSHOOT,
                AIRY_OVERSHOOT,
                "a jump of two tractions at the wall, at most 0.274 of it too high; FLIP damps "
                "waves of that length little",
            ),
            Finding(
                f"undershoot, {label}",
                m["under"],
                0.1,
                2.0 * AIRY_OVERSHOOT,
                AIRY_OVERSHOOT,
                "as the overshoot",
            ),
            Finding(
                f"largest displacement of the end, {label}",
                m["end"],
                2.0 - 0.5 / p.cells - width,
                2.0,
                2.0,
                "2 traction L/M, twice that at rest, less half a cell, and the width of the kink",
            ),
            near(
                f"time of it, {label}",
                m["when"],
                2.0,
                4.0 / FRAMES + 1.0 / p.cells,
                "t = 2L/c; frames, a cell",
            ),
        ]
    return findings


CASE = Case(
    family="Axial bar",
    title="A bar pulled at its end from one instant on",
    statement=r"""
A bar at rest, held at $X = 0$, gets the traction $\tau$ at $X = L$ (a wall of
`CartesianBoxCustom`). Exact over a period $4L/c$: jumps of the stress by $\tau$ run to and fro; the
end moves by $\tau ct/M$, then $\tau(4L-ct)/M$, at most $2\tau L/M$, twice that at rest.

Measured: the mean over space and time of the error of the stress ($L_1$), also in the two cells in
the middle of the bar; errors of the displacement; the highest and lowest stress; the difference
from the discrete equations, marched in a second way.

Expected: the dispersion of third order turns a jump into the integral of an Airy function of the
width $(3\kappa h^2 ct)^{1/3}$: order 2/3 in $L_1$, less up to 1/6 for its slow tail, and 27 % of
overshoot. The displacement has order 1 in $L_2$, 2/3 in $L_\infty$.
""",
    source="d'Alembert. Orders: `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_s",
)
