"""Columns that begin in equilibrium under their own weight."""

from __future__ import annotations

import numpy as np
from _freebodies import ALL_DIGITS
from _self_weight import equilibrium, lateral_share, noise_law, self_weight, sound
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.norms import Errors
from harness.scene import DIM, NVEL, UP, Body, Scene, lattice, pressure_wave_modulus

HEIGHT, DENSITY, YOUNG, FRAMES = 1.0, 1000.0, 1e6, 20
#: Cells across the column, by directions of the grid.
WIDTH = {1: 1, 2: 2, 3: 1}


def poisson(p: Parameters) -> float:
    """Poisson's ratio."""
    return p.number("nu", 0.3)


def modulus(p: Parameters) -> float:
    """Modulus M of uniaxial strain."""
    return pressure_wave_modulus(YOUNG, poisson(p))


def strain(p: Parameters) -> float:
    """The logarithmic strain at the base, rho g l0/M."""
    return p.number("strain", 1e-6)


def gravity(p: Parameters) -> float:
    """Gravity of that strain."""
    return strain(p) * modulus(p) / (DENSITY * HEIGHT)


def steps(p: Parameters) -> int:
    """Steps; few where the start is all that is looked at."""
    return int(p.number("steps", 20 if crosses(p) else 10000))


def scene(p: Parameters) -> Scene:
    """Rollers at the base and on the sides; the top is free, two cells below the upper face."""
    dim, up, h = DIM[p.sim_type], UP[p.sim_type], HEIGHT / p.cells
    cells = [WIDTH[dim]] * dim
    cells[up] = p.cells
    size = [n * h for n in cells]
    points = lattice(p.sim_type, [0.0] * dim, size, [n * p.ppc for n in cells], DENSITY)
    cells[up] += 2
    c = sound(YOUNG, poisson(p), DENSITY)
    dt = 0.2 * h / c
    t_stop = steps(p) * dt
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        [Body("column", points, YOUNG, poisson(p), "CartesianSmoothBox")],
        t_stop,
        dt,
        FRAMES,
        p.mapping,
        driver=self_weight(t_stop, gravity(p), HEIGHT, DENSITY, YOUNG, poisson(p)),
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Residual of the start; then deviations from the start, scaled with the weight."""
    up, h, g = UP[p.sim_type], HEIGHT / p.cells, gravity(p)
    points = out.scene.bodies[0].points
    y, stress = equilibrium(points.x[:, up], g, HEIGHT, DENSITY, modulus(p))
    weight = DENSITY * g * HEIGHT
    nodes = out.nodes()[0]
    alive = (nodes["mass"] > 0.0) & (nodes.x[:, up] > 0.5 * h)
    residual = np.abs(nodes["force"][alive, up]) / nodes["mass"][alive] / g
    errors = Errors(points.measure)
    side = 0 if up != 0 else 1
    largest = 0.0
    for frame in out.points():
        errors.add("e_u", (frame.x[:, up] - y) / (strain(p) * HEIGHT))
        errors.add("e_stress", (frame["cauchy_stress"][:, up, up] - stress) / weight)
        lateral = frame["cauchy_stress"][:, side, side] - lateral_share(poisson(p)) * stress
        errors.add("e_lateral", lateral / weight)
        v = frame["velocity"][:, up] / (strain(p) * sound(YOUNG, poisson(p), DENSITY))
        errors.add("e_v", v)
        others = [d for d in range(NVEL[p.sim_type]) if d != up]
        side_motion = np.abs(frame["velocity"][:, others]) / sound(YOUNG, poisson(p), DENSITY)
        largest = max(largest, float(np.max(side_motion, initial=0.0)) / strain(p))
    return {**errors.measures(), "residual": float(np.max(residual)), "sideways": largest}


def crosses(p: Parameters) -> bool:
    """Whether points are in other cells than without weight: the top sinks by strain l0/2."""
    return 0.5 * strain(p) * p.cells > 1.0


def noise(p: Parameters) -> float:
    """Largest acceleration by crossed node lines over g: forces by their law, masses rho0 h/F."""
    depths = np.linspace(0.0, 1.0, 201)
    stretches = np.exp(-strain(p) * depths)
    laws = [depth * f * noise_law(p.mapping, p.ppc, f) for depth, f in zip(depths, stretches, strict=True)]
    return p.cells * max(laws)


def judge(r: Results) -> list[Finding]:
    """Equilibrium to the strain where no point crosses a node line, else the noise's law."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells"
        if crosses(p):
            acceleration = Finding(f"largest acceleration at the start over g{end}", m["residual"])
            acceleration.expected = noise(p)
            acceleration.low, acceleration.high = 0.5 * noise(p), 1.3 * noise(p)
            acceleration.reason = (
                "the law of the noise on rho h/F; which depths have the worst phases, and the"
                " scatter of the nodal masses, are left to chance"
            )
            findings.append(acceleration)
        else:
            findings += judge_rest(p, m, end)
    if crosses(r.first) and len(r.measures) > 1:
        order = Finding("order of the acceleration at the start", r.order("residual"), -1.3, -0.7)
        order.expected = -1.0
        order.reason = "noise on the nodes does not depend on h, their mass does"
        findings.append(order)
    return findings


def judge_rest(p: Parameters, m: Measures, end: str) -> list[Finding]:
    """No crossing: all that is left is of second order in the strain, and never grows."""
    s, why = strain(p), "what is left swings by strain/2 of the top node and 2 strain of quadrature"
    top = near(
        f"largest acceleration at the start over strain times g{end}",
        m["residual"] / s,
        p.cells,
        0.02,
        "the top node loses the share 2 u/h of its mass, u = strain l0/2, and none of its force",
    )
    # Undamped, it swings to twice the new equilibrium: 2 (1/2 + 2) strain.
    return [
        top,
        below(f"e_stress (largest) over rho g l0{end}", m["e_stress_linf"], 5 * s, why),
        below(f"lateral stress (largest) over rho g l0{end}", m["e_lateral_linf"], 5 * s, why),
        below(f"e_u (largest) over strain l0{end}", m["e_u_linf"], 5 * s, why),
        below(f"velocity over strain c{end}", m["e_v_linf"], 5 * s, why),
        below(f"motion across the column over strain c{end}", m["sideways"], 1e-9, "round-off"),
    ]


CASE = Case(
    family="Invariance and conservation",
    title="Column at rest under its own weight",
    statement="""
A column between rollers begins in the exact state of rest under its weight: vertical stress -rho0 g (l0 - Y)
over the reference height Y, nu/(1 - nu) of it to the sides, heights of the logarithmic law. In TYPE 4 radial and hoop stress balance;
with nu = 0.49 the column is nearly a hydrostatic one. *Small strain* (rho g l0/M = 1e-6), 10 000 steps: the residual forces are of second
order in the strain, and everything stays at that level, without drift. The largest acceleration is that of the top node,
N strain g with N cells: its mass goes with the volume above its neighbour, its force does not.

*Larger strain*: points have crossed node lines, and the nodes are out of equilibrium by the noise of
a uniform stress, T F/n for linear functions and about 2 T F |1 - F| for corner averages. It does not depend on h, the mass of
a node does: accelerations grow in proportion to the number of cells. Those runs stop after a few steps; where such a
column settles is the subject of the slow loading.
""",
    source="Elementary",
    scene=scene,
    measure=measure,
    judge=judge,
)
