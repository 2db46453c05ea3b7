"""Velocities that the grid does not see."""

from __future__ import annotations

import numpy as np
from _freebodies import ALL_DIGITS, EPS
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import DIM, NVEL, Array, Body, Scene, lattice, pressure_wave_modulus

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
WAVE_SPEED = float(np.sqrt(MODULUS / DENSITY))
#: Patterns along a direction that repeat every cell, or change sign with it (n = 2), and to which
#: all hat functions are orthogonal.
PATTERNS = {2: [1.0, -1.0], 3: [1.0, -2.0, 1.0], 4: [1.0, -1.0, -1.0, 1.0]}
SPEED, STEPS, FRAMES = 0.01, 1000, 4


def pattern(p: Parameters, x: Array) -> Array:
    """Velocities (n, nvel): the pattern along each direction in turn, with different weights."""
    shape = PATTERNS[p.ppc]
    index = np.floor(x / SPACING * p.ppc + 1e-9).astype(int)
    factors = np.array(shape)[index % p.ppc]
    v = np.zeros((len(x), NVEL[p.sim_type]))
    for c in range(v.shape[1]):
        v[:, c] = SPEED * WAVE_SPEED * (1.0 - 0.3 * c) * factors[:, c % x.shape[1]]
    return v


def scene(p: Parameters) -> Scene:
    """A box without slip that is filled to its faces."""
    dim = DIM[p.sim_type]
    size = [p.cells * SPACING] * dim
    points = lattice(
        p.sim_type, [0.0] * dim, size, [p.cells * p.ppc] * dim, DENSITY, lambda x: pattern(p, x)
    )
    dt = 0.2 * SPACING / WAVE_SPEED
    return Scene(
        p.sim_type,
        size,
        [p.cells] * dim,
        [Body("block", points, YOUNG, POISSON, "CartesianBox")],
        STEPS * dt,
        dt,
        FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Largest changes over the frames."""
    frames = list(out.points())
    first = frames[0]
    worst = dict.fromkeys(["velocity", "position", "stress"], 0.0)
    for frame in frames[1:]:
        found = {
            "velocity": np.max(np.abs(frame["velocity"] - first["velocity"])) / (SPEED * WAVE_SPEED),
            "position": np.max(np.abs(frame["displacement"])) / SPACING,
            "stress": np.max(np.abs(frame["cauchy_stress"])) / (SPEED * MODULUS),
        }
        worst = {name: max(worst[name], float(found[name])) for name in worst}
    seen = np.max(np.abs(out.nodes()[1]["velocity"])) / (SPEED * WAVE_SPEED)
    return {**worst, "nodes": float(seen), "motion": float(np.max(np.abs(first["velocity"])))}


def judge(r: Results) -> list[Finding]:
    """Nothing moves, for ever."""
    findings = []
    for p, m in r:
        terms = (2 * p.ppc) ** DIM[p.sim_type]
        # Round-off of nodal velocities; it could add up over the steps.
        seen = terms * EPS
        end = f", {p.cells} cells"
        findings += [
            below(f"largest nodal velocity{end}", m["nodes"], seen, "round-off of a sum"),
            below(f"change of velocities{end}", m["velocity"], seen * STEPS, "round-off, added up"),
            below(f"displacement{end}", m["position"], seen * STEPS, "round-off, added up"),
            below(f"stress{end}", m["stress"], 2 * seen * STEPS, "round-off, added up"),
        ]
        alive = Finding(f"velocity of the points{end}", m["motion"], SPEED * WAVE_SPEED)
        alive.reason = "the mode is there"
        findings.append(alive)
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Null mode: velocities that the grid does not see",
    statement="""
A box is filled with points whose velocities alternate so that every nodal momentum is 0: +v, -v along a
direction with two points a cell, v, -2 v, v with three, v, -v, -v, v with four. *FLIP keeps such a mode for ever*:
after 1000 steps no point has moved, no stress has arisen, no velocity has changed, all to round-off. This is
a property of the method, not a merit: the energy of these velocities is lost to the motion, and they come back
when points reach other cells. A code that mixes in the grid's velocity would damp them within a step.
""",
    source="Brackbill (1988), the ringing instability; patterns derived here",
    scene=scene,
    measure=measure,
    judge=judge,
)
