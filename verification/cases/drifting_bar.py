"""A free bar that drifts slowly over the grid."""

from __future__ import annotations

import numpy as np
from _waves import DENSITY, FREE, LENGTH, YOUNG, Walls, wave_speed
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.norms import linf
from harness.scene import DIM, Body, Scene, lattice

#: Speed over that of waves, way in cells, empty cells on either side.
DRIFT, WAY, EMPTY = 1e-3, 1.2, 2
CFL, FRAMES = 0.3, 12


def scene(p: Parameters) -> Scene:
    """Return a bar without stress; its ends start on grid lines."""
    dim, h, c = DIM[p.sim_type], LENGTH / p.cells, wave_speed(p)
    filled = [2] * (dim - 1) + [p.cells]
    grid = [n + 2 * EMPTY for n in filled]
    # Along r a drift is no rigid motion.
    drift = [0.0 if p.sim_type == 4 and d == 0 else DRIFT * c for d in range(dim)]
    points = lattice(
        p.sim_type,
        [EMPTY * h] * dim,
        [(EMPTY + n) * h for n in filled],
        [n * p.ppc for n in filled],
        DENSITY,
        drift,
    )
    t_stop = WAY * h / (DRIFT * c)
    body = Body("bar", points, YOUNG, p.number("nu", 0.3), Walls([FREE] * (2 * dim)).section())
    dt = t_stop / (FRAMES * round(WAY / (DRIFT * CFL * FRAMES)))
    return Scene(p.sim_type, [n * h for n in grid], grid, [body], t_stop, dt, FRAMES, p.mapping)


def measure(p: Parameters, out: Output) -> Measures:
    """Return the largest deviation of a velocity from the drift, and of a stress from 0."""
    speed, deviation, stress = DRIFT * wave_speed(p), 0.0, 0.0
    exact = out.scene.bodies[0].points.velocity / speed
    for frame in out.points():
        v = frame["velocity"][:, : exact.shape[1]] / speed
        deviation = max(deviation, linf(v - exact))
        impact = DENSITY * wave_speed(p) * speed
        stress = max(stress, linf(frame["cauchy_stress"]) / impact)
    return {"deviation": deviation, "stress": stress, "failed": float(out.status == 3)}


def is_fit(p: Parameters) -> bool:
    """Tell whether a scheme bears nodes with little mass."""
    affine = p.scheme.transfer in ("APIC", "MLS")
    return p.mapping == "cpdi" or (p.scheme.solver != "USL" and not affine)


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    for p, m in r:
        label = f"{p.cells} cells"
        if is_fit(p):
            reason = "a rigid motion without stress; roundings of 4000 steps and of places"
            findings += [
                below(f"deviation of velocities, {label}", m["deviation"], 1e-10, reason),
                below(f"stress, {label}", m["stress"], 1e-10, reason),
                below(f"failed, {label}", m["failed"], 0.0, "the run ends well"),
            ]
        else:
            findings.append(
                Finding(
                    f"deviation of velocities or failure, {label}",
                    max(m["deviation"], m["failed"]),
                    1.0,
                    np.inf,
                    np.nan,
                    "the ends spend some hundred steps below the least mass of a stable node; "
                    "roundings grow to the drift itself",
                )
            )
    return findings


CASE = Case(
    family="Hard cases",
    title="A free bar that drifts slowly over the grid",
    statement=r"""
A bar free on all sides and without stress moves with $10^{-3}c$ along all directions
(TYPE 4: a tube, along its axis), by 1.2 cells. Exact: it goes on.

Expected: a point that enters a cell alone spends $\xi_c h/(v\Delta t)$ steps, some hundred, with a
weight below $\xi_c$ on the nodes ahead (see the free end with little mass). With linear functions
roundings grow there until they are as large as the motion: the scheme is not fit for a slow free
edge, and the run must say so or show it. With the corner-averaged functions nothing
grows, nor with MUSL and USF unless affine fields of hats pass the velocities of those nodes on.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    may_fail=True,
)
