"""Contact at nodes that one body hardly reaches."""

from __future__ import annotations

import numpy as np
from _contact import reach, sums
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import (
    DIM,
    NVEL,
    UP,
    Body,
    Scene,
    huang,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)

LENGTH, DENSITY, SPEED, NU = 1.0, 1000.0, 100.0, 0.3
FRAMES = 20


def scene(p: Parameters) -> Scene:
    """Two blocks in contact at nodes where the second has `share` of the mass of a point.

    The second rests, and its edge points stand so that they just reach the nodes below it; the
    first comes from below with speed v and fills them.
    """
    dim, up = DIM[p.sim_type], UP[p.sim_type]
    h, share = LENGTH / p.cells, p.number("share", 1e-12)
    v = SPEED * p.number("v", 0.01)
    wide = 2 if dim > 1 else 0
    cells = [wide + 4] * dim
    cells[up] = 2 * p.cells + 12
    node = p.cells + 6
    counts, lower, upper = [wide * p.ppc] * dim, [2 * h] * dim, [(2 + wide) * h] * dim
    counts[up] = p.cells * p.ppc
    velocity = [0.0] * NVEL[p.sim_type]
    velocity[up] = v
    # Weight of a corner that reaches e cells into the node's support: e/2, without corners e.
    inside = share * (2.0 if p.mapping == "cpdi" else 1.0)
    start = (node + reach(p.ppc, p.mapping) - 0.5 / p.ppc - inside) * h
    low, high = list(lower), list(upper)
    low[up], high[up] = (node - 0.25) * h - LENGTH, (node - 0.25) * h
    first = lattice(p.sim_type, low, high, counts, DENSITY, velocity)
    low[up], high[up] = start, start + LENGTH
    second = lattice(p.sim_type, low, high, counts, DENSITY)
    young = DENSITY * SPEED**2 / pressure_wave_modulus(1.0, NU)
    stop = 4.0 * LENGTH / SPEED
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        [Body("one", first, young, NU), Body("two", second, young, NU)],
        stop,
        stable_dt(LENGTH, p.cells, SPEED, stop, p.number("cfl", 0.2), FRAMES),
        FRAMES,
        p.mapping,
        p.contact,
        contacts=[huang("one", "two", 0.3)],
        digits=17,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Mass of the emptiest shared node, and what the blocks do."""
    up, v = UP[p.sim_type], SPEED * p.number("v", 0.01)
    if out.status != 0:
        reason = "has lost its volume" in out.errors or "moved more than a cell" in out.errors
        return {"failed": 1.0, "with_reason": float(reason)}
    masses = [out.nodes(k)[0]["mass"] for k in range(2)]
    shared = (masses[0] > 0.0) & (masses[1] > 0.0)
    emptiest = np.min(masses[1][shared]) if np.any(shared) else np.nan
    totals, energies, fastest = [], [], 0.0
    for one, two in zip(out.points(0), out.points(1), strict=True):
        a, b = sums(out, 0, one), sums(out, 1, two)
        totals.append(a.momentum + b.momentum)
        energies.append(a.kinetic + a.strain + b.kinetic + b.strain)
        for frame in (one, two):
            fastest = max(fastest, float(np.max(np.abs(frame["velocity"]))) / v)
    total = np.array(totals)
    if p.sim_type == 4:  # hoop stress changes the radial momentum
        total = total[:, 1:2]
    return {
        "failed": 0.0,
        "emptiest": float(emptiest / np.mean(out.scene.bodies[1].points.total_mass)),
        "momentum": float(np.max(np.abs(total - total[0]))) / float(np.max(np.abs(total[0]))),
        "energy_max": float(np.max(energies)) / energies[0],
        "fastest": fastest,
        "passed_on": float(b.velocity[up] / v),
    }


def judge(r: Results) -> list[Finding]:
    """Nothing blows up."""
    findings = []
    for p, m in r:
        share, label = p.number("share", 1e-12), f"{p.cells} cells"
        if p.mapping == "linear" and p.contact == "explicit":
            findings.append(
                Finding(
                    f"run that ends with exit status 3 and a reason, {label}",
                    m.get("with_reason", 0.0),
                    1.0,
                    1.0,
                    1.0,
                    "dt f/m is not bounded: the linear functions put the whole stress of a point "
                    "on a node with any mass; an explicit contact does not look at forces",
                )
            )
            continue
        findings.append(
            Finding(f"run that fails, {label}", m["failed"], 0.0, 0.0, 0.0, "all is bounded")
        )
        if m["failed"] > 0.0:
            continue
        findings += [
            below(
                f"mass of the emptiest shared node over that of a point, {label}",
                m["emptiest"],
                4.0 * share,
                "as the case is made",
            ),
            below(
                f"momentum, {label}",
                m["momentum"],
                1e-12,
                "opposite forces, also where the mass is negligible",
            ),
            below(
                f"largest energy over that of the start, {label}",
                m["energy_max"],
                1.005,
                "no source of energy; half a step between stress and velocity",
            ),
            below(
                f"largest speed of a point over v, {label}",
                m["fastest"],
                3.0,
                "characteristics: edges of a free rod reach 2 v at most, half more by the "
                "oscillation behind a front",
            ),
            Finding(
                f"velocity passed on over v, {label}",
                m["passed_on"],
                0.0,
                1.0,
                reason="between no and an elastic collision of equal blocks",
            ),
        ]
    return findings


CASE = Case(
    family="Hard cases",
    title="Contact at nodes that one body hardly reaches",
    statement=r"""
Two blocks in contact at nodes where the second has $10^{-12}$ of the mass of a point, because its
edge points just reach them. $v = 0.01 c$.

With corner-averaged functions the gradient at such a node is small too: a node of weight $w$ has
the gradient $4 n w/h$, and $\Delta t f/m$ stays below $4 n\,\mathrm{CFL}\,c\,\varepsilon$. Both
rules must run, conserve momentum, and create no energy or speed. With linear functions the node
carries the whole stress of the point whatever its mass. The implicit rule balances that; with the
explicit rule nothing bounds $\Delta t f/m$ (the program leaves out such forces below $10^{-9}$ of
the mean mass only), and the run must end with exit status 3 and say what went wrong.
""",
    source="Weights of the linear functions.",
    scene=scene,
    measure=measure,
    judge=judge,
    may_fail=True,
)
