"""A vibrating free bar that flies through the cells."""

from __future__ import annotations

import numpy as np
from _freebodies import free_box
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.norms import Errors
from harness.scene import DIM, NVEL, UP, Array, Body, Scene, lattice, stable_dt
from harness.theory import dispersion_constant

LENGTH, DENSITY, YOUNG = 1.0, 1000.0, 1e6
WAVE_SPEED = float(np.sqrt(YOUNG / DENSITY))
FRAMES, MARGIN = 20, 2
#: Cells across the bar, by directions of the grid.
WIDTH = {1: 1, 2: 2, 3: 1}


def strain(p: Parameters) -> float:
    """Return strain of the wave; linear theory holds up to about a third of it, relatively."""
    return p.number("strain", 1e-4 if p.mapping == "cpdi" else 1e-3)


def drift(p: Parameters) -> float:
    """Return velocity of the bar."""
    return p.number("drift", 0.1) * WAVE_SPEED


def scene(p: Parameters) -> Scene:
    """Return the scene: one period of a vertical bar, nu = 0, whose sides are free."""
    dim, up, h = DIM[p.sim_type], UP[p.sim_type], LENGTH / p.cells
    k = np.pi / LENGTH
    t_stop = 2.0 * LENGTH / WAVE_SPEED
    size = np.full(dim, WIDTH[dim])
    size[up] = p.cells
    lower = np.full(dim, float(MARGIN))
    if p.sim_type == 4:
        lower[0] = 0.0

    def velocity(x: Array) -> Array:
        v = np.zeros((len(x), NVEL[p.sim_type]))
        v[:, up] = drift(p) + strain(p) * WAVE_SPEED * np.cos(k * (x[:, up] - MARGIN * h))
        return v

    points = lattice(
        p.sim_type, lower * h, (lower + size) * h, list(size * p.ppc), DENSITY, velocity
    )
    counts = [int(n) + 2 * MARGIN for n in size]
    counts[up] += int(np.ceil(drift(p) * t_stop / h))
    boundary = free_box(dim, {"x_lower": 1} if p.sim_type == 4 else {})
    return Scene(
        p.sim_type,
        [n * h for n in counts],
        counts,
        [Body("bar", points, YOUNG, 0.0, boundary)],
        t_stop,
        stable_dt(LENGTH, p.cells, WAVE_SPEED, t_stop, p.number("cfl", 0.2), FRAMES),
        FRAMES,
        p.mapping,
        digits=17,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors of displacement less the drift, velocity and stress, over their amplitudes."""
    up, k = UP[p.sim_type], np.pi / LENGTH
    points = out.scene.bodies[0].points
    angle = k * (points.x[:, up] - MARGIN * LENGTH / p.cells)
    errors = Errors(points.measure)
    for frame in out.points():
        swing = k * WAVE_SPEED * frame.time
        u = (frame["displacement"][:, up] - drift(p) * frame.time) * k / strain(p)
        errors.add("e_u", u - np.cos(angle) * np.sin(swing))
        v = (frame["velocity"][:, up] - drift(p)) / (strain(p) * WAVE_SPEED)
        errors.add("e_v", v - np.cos(angle) * np.cos(swing))
        stress = frame["cauchy_stress"][:, up, up] / (strain(p) * YOUNG)
        errors.add("e_stress", stress + np.sin(angle) * np.sin(swing))
    return errors.measures()


def judge(r: Results) -> list[Finding]:
    """Expect second order where forces are continuous, and none at all where they jump."""
    name = "order of e_u"
    findings = []
    orders = r.halvings("e_u_l2")
    if r.first.mapping == "cpdi":
        order = Finding(f"{name}, last halving", orders[-1], 1.85, 2.15, 2.0)
        order.reason = "forces are continuous"
        findings.append(order)
        # Phase error of a period in L2; the ends, which lie off the node lines, add their part.
        for p, m in r:
            rest = 2.0 * np.pi * dispersion_constant(p.ppc) * (np.pi / p.cells) ** 2 / np.sqrt(2.0)
            findings.append(
                below(
                    f"e_u, {p.cells} cells",
                    m["e_u_l2"],
                    2.0 * rest,
                    "twice the phase error at rest: ends off the node lines cost as much again",
                )
            )
    elif r.cells[-1] >= 128:
        order = Finding(f"{name}, last halving", orders[-1], high=0.5)
        order.reason = "noise T F/n on the nodes, by which accelerations grow like 1/h: order -1"
        findings.append(order)
        noisy = Finding("e_stress (largest), finest", r.column("e_stress_linf")[-1], 0.02)
        noisy.reason = "a jump of the force on an edge node while points cross"
        findings.append(noisy)
    else:
        findings.append(Finding(f"{name}, last halving", orders[-1]))
    return findings


CASE = Case(
    family="Hard cases",
    title="Cell crossing at speed: a vibrating bar in flight",
    statement=r"""
A free bar vibrates in its mode $\cos k X$, strain $10^{-3}$ (corner averages: $10^{-4}$, for
which the linear solution is the more exact), and flies at a tenth of the wave speed, so that its
points and its ends cross node lines all the time. *Exact*: the same vibration as at rest, plus $V
t$. With corner averages forces are continuous and the error of the displacement is of *second
order*, at most twice that of a bar at rest. With linear functions forces jump by the stress times
the area (see the noise of a uniform stress): the error falls to some 32 cells, then **grows**
with refinement; the matrix asserts that.
""",
    source="Derived here; cf. Steffen, Kirby and Berzins (2008)",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
