"""A corner hits a face."""

from __future__ import annotations

import math

import numpy as np
from _contact import sums
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import (
    DIM,
    NVEL,
    UP,
    Body,
    Points,
    Scene,
    huang,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)

#: Side of the block, density, wave speed.
SIDE, DENSITY, SPEED, NU = 1.0, 1000.0, 100.0, 0.3
FRAMES = 40


def geometry(p: Parameters) -> tuple[float, list[int], float, float]:
    """Return cell size, cells, height of the plate's face, and x of the corner."""
    dim, up = DIM[p.sim_type], UP[p.sim_type]
    h = SIDE / p.cells
    half = math.ceil(SIDE / math.sqrt(2.0) / h) + 4
    plate = max(4, p.cells // 2)
    cells = [2 * half] * dim
    cells[up] = plate + 2 * half + 4
    if dim == 3:
        cells[1] = p.cells // 2 + 4
    return h, cells, (plate + 2) * h, half * h


def scene(p: Parameters) -> Scene:
    """Place a square (a bar in TYPE 3) on its corner above a free plate."""
    dim, up = DIM[p.sim_type], UP[p.sim_type]
    h, cells, top, middle = geometry(p)
    v = SPEED * p.number("v", 0.02)
    counts, lower, upper = [p.cells * p.ppc] * dim, [-0.5 * SIDE] * dim, [0.5 * SIDE] * dim
    if dim == 3:
        lower[1], upper[1], counts[1] = 2 * h, (2 + p.cells // 2) * h, p.cells // 2 * p.ppc
    velocity = [0.0] * NVEL[p.sim_type]
    velocity[up] = -v
    square = lattice(p.sim_type, lower, upper, counts, DENSITY, velocity)
    x = square.x.copy()
    across, along = x[:, up].copy(), x[:, 0].copy()
    square.x[:, 0] = middle + (along - across) / math.sqrt(2.0)
    square.x[:, up] = top + 1.5 * h + SIDE / math.sqrt(2.0) + (along + across) / math.sqrt(2.0)
    plate_low, plate_high = [2 * h] * dim, [(n - 2) * h for n in cells]
    plate_high[up] = top
    if dim == 3:
        plate_low[1], plate_high[1] = h, (cells[1] - 1) * h
    plate = lattice(
        p.sim_type,
        plate_low,
        plate_high,
        [round((b - a) / h) * p.ppc for a, b in zip(plate_low, plate_high, strict=True)],
        DENSITY,
    )
    young = DENSITY * SPEED**2 / pressure_wave_modulus(1.0, NU)
    stop = 1.5 * h / v + 6.0 * SIDE / SPEED
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        [Body("block", square, young, NU), Body("plate", plate, young, NU)],
        stop,
        stable_dt(SIDE, p.cells, SPEED, stop, p.number("cfl", 0.3), FRAMES),
        FRAMES,
        p.mapping,
        p.contact,
        contacts=[huang("plate", "block", p.number("mu", 0.3), int(p.number("normals", 1)))],
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Momentum, symmetry, energy, and the gap below the corner."""
    up, h = UP[p.sim_type], SIDE / p.cells
    block: Points = out.scene.bodies[0].points
    corner = int(np.argmin(block.x[:, up]))
    speed = SPEED * p.number("v", 0.02)
    totals, energies, gaps, sideways, speeds = [], [], [], [], []
    for one, two in zip(out.points(0), out.points(1), strict=True):
        a, b = sums(out, 0, one), sums(out, 1, two)
        totals.append(a.momentum + b.momentum)
        energies.append(a.kinetic + a.strain + b.kinetic + b.strain)
        near = np.abs(two.x[:, 0] - one.x[corner, 0]) < h
        gaps.append((one.x[corner, up] - np.max(two.x[near, up])) / h)
        sideways.append(abs(a.velocity[0]) / speed)
        speeds.append(a.velocity[up] / speed)
    total = np.array(totals)
    return {
        "momentum": float(np.max(np.abs(total - total[0]))) / abs(total[0, up]),
        "energy_max": float(np.max(energies)) / energies[0],
        "gap": float(np.min(gaps)),
        "sideways": float(np.max(sideways)),
        "rebound": float(speeds[-1] + 1.0),
    }


def judge(r: Results) -> list[Finding]:
    """Conservation, symmetry, no overlap."""
    findings = []
    for p, m in r:
        label = f"{p.cells} cells"
        findings += [
            below(f"momentum, {label}", m["momentum"], 1e-12, "forces are opposite"),
            below(
                f"largest energy over that of the start, {label}",
                m["energy_max"],
                1.0 + 1e-3,
                "no source of energy; half a step between stress and velocity",
            ),
            below(
                f"speed sideways over v, {label}",
                m["sideways"],
                1e-9,
                "mirror symmetry about a node line; roundings grow little",
            ),
            Finding(
                f"change of the block's velocity over v, {label}",
                m["rebound"],
                0.3,
                2.0,
                reason="the corner is stopped: between a soft and an elastic impact",
            ),
        ]
        if p.contact == "implicit":
            findings.append(
                Finding(
                    f"smallest gap between points at the corner/h, {label}",
                    m["gap"],
                    0.0,
                    reason="no point of the block passes a point of the plate",
                )
            )
    return findings


CASE = Case(
    family="Hard cases",
    title="A corner hits a face",
    statement=r"""
A square that stands on its corner (TYPE 3: an edge of a bar) falls on a free plate, $v = 0.02 c$.
There is no exact answer; what must hold: momentum to round-off, energy at most that of the start,
no motion sideways (the set-up is its own mirror image about a line of nodes), no point of the
block passes a point of the plate (implicit rule), and the block is thrown back.
""",
    source="Conservation and symmetry.",
    scene=scene,
    measure=measure,
    judge=judge,
)
