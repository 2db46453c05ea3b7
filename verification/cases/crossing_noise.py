"""Forces on the nodes of a body of uniform stress and uniform stretch."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import ALL_DIGITS, EPS
from _self_weight import lateral_share, self_weight, uniform_gravity
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import DIM, UP, Array, Body, Scene, lattice, pressure_wave_modulus

LENGTH, DENSITY, YOUNG, POISSON = 1.0, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
#: Cells across the column, by directions of the grid.
WIDTH = {1: 1, 2: 2, 3: 2}


def stretch(p: Parameters) -> float:
    """Stretch of the column."""
    return p.number("stretch", 0.9512)


def scene(p: Parameters) -> Scene:
    """The foot of a very high column, at the start of its only step."""
    dim, up, h = DIM[p.sim_type], UP[p.sim_type], LENGTH / p.cells
    cells = [WIDTH[dim]] * dim
    cells[up] = p.cells
    size = [n * h for n in cells]
    points = lattice(p.sim_type, [0.0] * dim, size, [n * p.ppc for n in cells], DENSITY)
    dt = 1e-4 * h / math.sqrt(MODULUS / DENSITY)
    gravity = uniform_gravity(stretch(p), DENSITY, MODULUS)
    return Scene(
        p.sim_type,
        size,
        cells,
        [Body("column", points, YOUNG, POISSON, "CartesianSmoothBox")],
        dt,
        dt,
        mapping=p.mapping,
        driver=self_weight(dt, gravity, 1e9, DENSITY, YOUNG, POISSON),
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Nodal forces of the initial state over stress times the area of a cell."""
    up, h, frame = UP[p.sim_type], LENGTH / p.cells, out.nodes()[0]
    first = out.points()[0]
    stress = MODULUS * np.log(stretch(p))
    area = np.full(len(frame.x), h ** (DIM[p.sim_type] - 1))
    if p.sim_type == 4:
        area = frame.x[:, 0] * h
    deep = np.ones(len(frame.x), bool)
    for d in range(DIM[p.sim_type]):
        top = 0.9 * stretch(p) * LENGTH if d == up else WIDTH[DIM[p.sim_type]] * h
        reach = 2.5 * h if d == up else 0.5 * h
        deep &= (frame.x[:, d] > reach) & (frame.x[:, d] < top - reach)
    force = frame["force"][deep] / (stress * area[deep, None])
    sideways = np.delete(force, up, axis=1)
    s = stretch(p) * h / p.ppc
    box = 0.5 * h / p.ppc if p.mapping == "cpdi" else 1e-9 * h
    place = frame.x[deep, up]
    left = numbers_below(p, place, s, box) - numbers_below(p, place - h, s, box)
    right = numbers_below(p, place + h, s, box) - numbers_below(p, place, s, box)
    exact = stretch(p) / p.ppc * (left - right)
    share = first["cauchy_stress"][:, 0 if up != 0 else 1, 0 if up != 0 else 1] / stress
    return {
        "every node": float(np.max(np.abs(force[:, up] + exact))),
        "peak": float(np.max(np.abs(force[:, up]))),
        "sideways": float(np.max(np.abs(sideways))),
        "stress": float(np.max(np.abs(first["cauchy_stress"][:, up, up] / stress - 1.0))),
        "lateral stress": float(np.max(np.abs(share - lateral_share(POISSON)))),
        "nodes": float(np.sum(deep)),
    }


def numbers_below(p: Parameters, x: Array, s: float, box: float) -> Array:
    """Numbers of points below heights; a point counts in part while x lies in its box."""
    points = (np.arange(p.cells * p.ppc) + 0.5) * s
    return np.sum(np.clip((x[:, None] - points) / box + 0.5, 0.0, 1.0), axis=1)


def law(p: Parameters) -> float:
    """Largest force over stress and area, see the statement."""
    f, n = stretch(p), p.ppc
    step = n * (1.0 / f - 1.0)
    if p.mapping == "linear":
        return f / n
    box = 0.5 / f
    gap = 1.0 - box
    return f / n * (min(step, box) - max(0.0, step - gap)) / box


def judge(r: Results) -> list[Finding]:
    """The law, at every resolution the same."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells"
        findings.append(
            below(f"error of the force on any node{end}", m["every node"], 1e-6, "counts of points")
        )
        # Linear functions have their largest force at all phases of the points to the node, corner
        # averages at one of them only, next to which the nodes of a scene come.
        lowest = 1.0 - 1e-6 if p.mapping == "linear" else 0.7
        peak = Finding(f"largest nodal force over stress and area{end}", m["peak"], lowest * law(p))
        peak.high, peak.expected = (1.0 + 1e-6) * law(p), law(p)
        peak.reason = "closed form, see statement; corner averages: at the best phase of the points"
        findings.append(peak)
        findings.append(
            below(
                f"forces across the column{end}",
                m["sideways"],
                100 * (2 * p.ppc) ** DIM[p.sim_type] * EPS,
                "0: uniform stress on an undeformed row; round-off",
            )
        )
        findings.append(below(f"stress of the start{end}", m["stress"], 1e-8, "LENGTH/1e9"))
        findings.append(
            below(f"lateral stress of the start{end}", m["lateral stress"], 1e-8, "LENGTH/1e9")
        )
    return findings


CASE = Case(
    family="Hard cases",
    title="Cell-crossing noise of a uniform stress",
    statement="""
The foot of a very high column under its own weight: uniform stress T, uniform stretch F < 1, points at distances s = F
h/n. The exact nodal forces are 0. The scheme gives T V sum dN/dx, that is T F/n times the difference between
the numbers of points in the cells left and right of the node; the force on every node is compared with that.

- *Linear functions*: the numbers differ by one wherever F is not 1: the largest force per area is **T F/n**,
  however small the strain.
- *Corner averages* count a point in part while the node line lies in the inner half of its first box, of width
  w = h/(2n). In a length h there are n + d spacings, d = n (1/F - 1). What d adds lies in a box or in a
  gap of s - w, so that the largest force is T (F/n) (min(d s, w) - max(0, d s + w - s))/w: for small strain
  **2 T F |1 - F|**, which is 2 n times that of boxes that fill the body, and T F/n at most.

Neither depends on h: accelerations grow like 1/h, so that no refinement at a fixed number of points a cell
lets linear functions converge where points cross cells. Across the column nothing is deformed and the forces
vanish: in TYPE 4 that needs the hoop stress to balance the radial one exactly, on all nodes.
""",
    source="Derived here; cf. Steffen, Kirby and Berzins (2008)",
    scene=scene,
    measure=measure,
    judge=judge,
)
