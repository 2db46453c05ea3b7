"""Force of a single point on the nodes as it crosses a node line."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import ALL_DIGITS, join
from _self_weight import self_weight, uniform_gravity
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import DIM, UP, Array, Body, Scene, lattice, pressure_wave_modulus

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
#: Stretch of the points: next to none.
STRETCH = 1.0 - 1e-6
#: Cells between neighbouring points, so that they share no node.
APART = 5


def places(p: Parameters) -> Array:
    """Distances of the points from their node, in cells: `cells` of them, none on the node."""
    return (np.arange(p.cells) + 0.5) / p.cells - 0.5


def scene(p: Parameters) -> Scene:
    """Points one above the other, each at another distance from a node line."""
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
            dt, uniform_gravity(STRETCH, DENSITY, MODULUS), 1e9, DENSITY, YOUNG, POISSON
        ),
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Force along the motion on the node that is crossed and on its neighbours."""
    frame, up = out.nodes()[0], UP[p.sim_type]
    first = out.points()[0]
    pull = float(first["cauchy_stress"][0, up, up] * first["volume"][0] / SPACING)
    column = frame["force"][:, up]
    height = np.round(frame.x[:, up] / SPACING).astype(int)
    sums = np.bincount(height, weights=column) / pull
    crossed = np.array([sums[APART * (i + 1)] for i in range(p.cells)])
    above = np.array([sums[APART * (i + 1) + 1] for i in range(p.cells)])
    below_ = np.array([sums[APART * (i + 1) - 1] for i in range(p.cells)])
    s, arm = places(p), 0.25 / p.ppc

    def hat(x: Array) -> Array:
        return np.maximum(0.0, 1.0 - np.abs(x))

    def slope(x: Array) -> Array:
        if p.mapping == "linear":
            return np.where(np.abs(x) < 1.0, -np.sign(x), 0.0)
        return (hat(x + arm) - hat(x - arm)) / (2.0 * arm)

    worst = max(
        float(np.max(np.abs(found + slope(s - shift))))
        for found, shift in ((crossed, 0.0), (above, 1.0), (below_, -1.0))
    )
    return {
        "profile": worst,
        "jump": float(np.max(np.abs(np.diff(crossed)))),
        "neighbour": float(np.max(np.abs(np.diff(above)))),
        "sum": float(np.max(np.abs(crossed + above + below_))),
    }


def judge(r: Results) -> list[Finding]:
    """The profile of the derivative, and its jump."""
    findings = []
    for p, m in r:
        end = f", {p.cells} places"
        # The places follow from exp and sinh; the force from a stress uniform to 1e-8.
        findings.append(below(f"error of the profile{end}", m["profile"], 1e-7, "closed form"))
        findings.append(below(f"sum over the nodes{end}", m["sum"], 1e-9, "0, and 1e-10: their weight"))
        if p.mapping == "linear":
            jump, beside, why = 2.0, 1.0, "the derivative jumps from 1/h to -1/h"
        else:
            step = 1.0 / p.cells
            jump, beside = 4.0 * p.ppc * step, 2.0 * p.ppc * step
            why = "a ramp of width h/(2 n) between 1/h and -1/h"
        findings.append(near(f"largest change on the node{end}", m["jump"], jump, 1e-6, why))
        findings.append(near(f"largest change beside it{end}", m["neighbour"], beside, 1e-6, why))
    return findings


CASE = Case(
    family="Hard cases",
    title="A single point crosses a node line",
    statement="""
Points of the same stress T and volume V lie at many distances from a node line (the resolution says how many),
each alone in its neighbourhood. The force on the node is -T V dN/dx. *Linear functions*: it jumps from -T V/h
to T V/h where the point passes the node, and by half of that on the nodes beside it, whatever the time step; with one
point a cell, 2 T h^(d-1). *Corner averages*: a ramp of width h/(2 n), so that the largest change between places
a distance D apart is 4 n D/h times T V/h. The whole profile is compared with the closed forms.
""",
    source="Elementary",
    scene=scene,
    measure=measure,
    judge=judge,
)
