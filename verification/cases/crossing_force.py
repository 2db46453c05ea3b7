"""Force of a single point on the nodes as it crosses a node line."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import ALL_DIGITS, join
from _self_weight import FAR, self_weight, uniform_gravity
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import DIM, UP, Array, Body, Scene, lattice, pressure_wave_modulus
from harness.theory import node_functions

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
#: Stretch of the points: next to none.
STRETCH = 1.0 - 1e-6
#: Cells between neighbouring points, so that they share no node.
APART = 5


def places(p: Parameters) -> Array:
    """Return `cells` distances of the points from their nodes in cells, none of them 0."""
    return (np.arange(p.cells) + 0.5) / p.cells - 0.5


def scene(p: Parameters) -> Scene:
    """Return the scene: points one above the other, each at another distance from a node line."""
    dim, up = DIM[p.sim_type], UP[p.sim_type]
    side = SPACING / p.ppc
    parts = []
    for i, place in enumerate(places(p)):
        middle = np.full(dim, 2.5 * SPACING)
        middle[up] = (APART * (i + 1) + place) * SPACING / STRETCH
        parts.append(lattice(p.sim_type, middle - side / 2, middle + side / 2, [1] * dim, DENSITY))
    counts = [5] * dim
    counts[up] = APART * (p.cells + 1)
    dt = 1e-3 * SPACING / math.sqrt(MODULUS / DENSITY)
    return Scene(
        p.sim_type,
        [n * SPACING for n in counts],
        counts,
        [Body("points", join(parts), YOUNG, POISSON)],
        dt,
        dt,
        mapping=p.mapping,
        driver=self_weight(
            dt, uniform_gravity(STRETCH, DENSITY, MODULUS), FAR, DENSITY, YOUNG, POISSON
        ),
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return force along the motion on the node that is crossed and on its neighbours."""
    frame, up = out.nodes()[0], UP[p.sim_type]
    first = out.points()[0]
    pull = float(first["cauchy_stress"][0, up, up] * first["volume"][0] / SPACING)
    column = frame["force"][:, up]
    height = np.round(frame.x[:, up] / SPACING).astype(int)
    sums = np.bincount(height, weights=column) / pull
    crossed = np.array([sums[APART * (i + 1)] for i in range(p.cells)])
    beside = {
        side: np.array([sums[APART * (i + 1) + side] for i in range(p.cells)])
        for side in (-2, -1, 1, 2)
    }

    def slope(x: Array) -> Array:
        return node_functions(p.mapping, x, p.ppc)[1]

    s = places(p)
    worst = max(
        float(np.max(np.abs(found + slope(s - shift))))
        for shift, found in ((0, crossed), *beside.items())
    )
    return {
        "profile": worst,
        "jump": float(np.max(np.abs(np.diff(crossed)))),
        "neighbour": float(np.max(np.abs(np.diff(beside[1])))),
        "sum": float(np.max(np.abs(crossed + sum(beside.values())))),
    }


def largest_changes(p: Parameters) -> tuple[float, float, str]:
    """Return the largest change of the slope between places, at a node and beside it; and why."""
    step = 1.0 / p.cells
    if p.mapping == "linear":
        return 2.0, 1.0, "the derivative jumps from 1/h to -1/h"
    if p.mapping == "cpdi":
        jump = 4.0 * p.ppc * step
        return jump, 0.5 * jump, "a ramp of width h/(2 n) between 1/h and -1/h"
    if p.mapping == "cubic":
        why = "the second derivative is -2 + 3|x| within a cell, 2 - |x| in the next"
        return 2.0 * step - 0.75 * step**2, step - 0.5 * step**2, why
    wide = p.ppc if p.mapping == "ugimp" else 1
    why = "a ramp of width h/n (uGIMP) or h between 1/h and -1/h"
    return 2.0 * wide * step, wide * step, why


def judge(r: Results) -> list[Finding]:
    """Expect the profile of the derivative, and its jump."""
    findings = []
    for p, m in r:
        end = f", {p.cells} places"
        # The places follow from exp and sinh; the force from a stress uniform to 1e-8.
        findings.append(below(f"error of the profile{end}", m["profile"], 1e-7, "closed form"))
        why = "derivatives sum to 0; 1e-10: the weight of the points"
        findings.append(below(f"sum over the nodes{end}", m["sum"], 1e-9, why))
        jump, beside, why = largest_changes(p)
        findings.append(near(f"largest change on the node{end}", m["jump"], jump, 1e-6, why))
        findings.append(near(f"largest change beside it{end}", m["neighbour"], beside, 1e-6, why))
    return findings


CASE = Case(
    family="Hard cases",
    title="A single point crosses a node line",
    statement=r"""
Points of the same stress $T$ and volume $V$ lie at many distances from a node line (the
resolution says how many), each alone in its neighbourhood. The force on the node is $-T
V\,dN/dx$. *Linear functions*: it jumps from $-T V/h$ to $T V/h$ where the point passes the node,
and by half of that on the nodes beside it, whatever the time step; with one point a cell by $2 T
h^{d-1}$. *Corner averages*: a ramp of width $h/(2n)$, so that the largest change between places a
distance $D$ apart is $4 n D/h$ times $T V/h$. *uGIMP, quadratic*: ramps of width $h/n$ and $h$.
*Cubic*: no kink. The whole profile is compared with the closed
forms.
""",
    source="Elementary",
    scene=scene,
    measure=measure,
    judge=judge,
)
