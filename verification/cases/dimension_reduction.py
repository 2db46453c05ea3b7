"""The same motion in one direction in every TYPE."""

from __future__ import annotations

import numpy as np
from _freebodies import ALL_DIGITS
from _reference_1d import Bar
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import (
    DIM,
    NVEL,
    Body,
    Points,
    Scene,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)
from harness.scheme import FEWEST_CELLS

LENGTH, DENSITY, YOUNG, POISSON = 0.7, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
WAVE_SPEED = float(np.sqrt(MODULUS / DENSITY))
#: Share of the lateral stress in uniaxial strain.
LATERAL = POISSON / (1.0 - POISSON)
FRAMES, PERIODS = 8, 1.0
NAMES = ("position", "velocity", "stress", "lateral motion", "lateral stress")
#: Cells across the bar, by directions of the grid.
WIDTH = {1: 1, 2: 2, 3: 1}


def width(p: Parameters) -> int:
    """Return cells across the bar."""
    return max(WIDTH[DIM[p.sim_type]], FEWEST_CELLS[p.mapping])


def axis(p: Parameters) -> int:
    """Return direction of the bar; TYPE 4 can move along z only."""
    return int(p.number("axis", 1 if p.sim_type == 4 else 0))


def amplitude(p: Parameters) -> float:
    """Return displacement of the middle over the length; 0.05 makes points cross cells."""
    return p.number("amplitude", 0.05)


def start(p: Parameters) -> Points:
    """Return a bar that fills the box, with the velocities of a standing wave."""
    dim, along = DIM[p.sim_type], axis(p)
    counts, k = [width(p) * p.ppc] * dim, np.pi / LENGTH
    upper = [width(p) * LENGTH / p.cells] * dim
    counts[along], upper[along] = p.cells * p.ppc, LENGTH

    def velocity(x: np.ndarray) -> np.ndarray:
        v = np.zeros((len(x), NVEL[p.sim_type]))
        v[:, along] = amplitude(p) * LENGTH * k * WAVE_SPEED * np.sin(k * x[:, along])
        return v

    return lattice(p.sim_type, [0.0] * dim, upper, counts, DENSITY, velocity)


def scene(p: Parameters) -> Scene:
    """Return the scene: smooth walls all around."""
    dim = DIM[p.sim_type]
    cells = [width(p)] * dim
    cells[axis(p)] = p.cells
    t_stop = PERIODS * 2.0 * LENGTH / WAVE_SPEED
    return Scene(
        p.sim_type,
        [n * LENGTH / p.cells for n in cells],
        cells,
        [Body("bar", start(p), YOUNG, POISSON, "CartesianSmoothBox")],
        t_stop,
        stable_dt(LENGTH, p.cells, WAVE_SPEED, t_stop, frames=FRAMES),
        FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return largest differences to the reference over points and frames."""
    points, along = out.scene.bodies[0].points, axis(p)
    places = np.round(points.x[:, along] * 1e9)
    _, line, row = np.unique(places, return_index=True, return_inverse=True)
    volume = np.full(len(line), LENGTH / len(line))
    bar = Bar(
        points.x[line, along],
        points.velocity[line, along],
        volume,
        DENSITY,
        MODULUS,
        LENGTH / p.cells,
        p.cells,
        p.mapping,
        p.ppc,
    )
    speed = amplitude(p) * np.pi * WAVE_SPEED
    worst = dict.fromkeys(NAMES, 0.0)

    def note(name: str, difference: np.ndarray) -> None:
        worst[name] = max(worst[name], float(np.max(np.abs(difference), initial=0.0)))

    frames = iter(out.points())
    next(frames)
    crossed = 0.0
    for step in range(1, out.scene.steps + 1):
        bar.step(out.scene.dt)
        if step % (out.scene.steps // FRAMES) != 0:
            continue
        frame = next(frames)
        stress = frame["cauchy_stress"]
        note("position", (frame.x[:, along] - bar.x[row]) / LENGTH)
        note("velocity", (frame["velocity"][:, along] - bar.v[row]) / speed)
        note("stress", (stress[:, along, along] - bar.stress[row]) / (MODULUS * amplitude(p)))
        rest = [d for d in range(3) if d != along]
        note("lateral motion", frame["velocity"][:, rest] / speed)
        sides = np.einsum("nii->ni", stress)[:, rest] - LATERAL * bar.stress[row][:, None]
        note("lateral stress", sides / (MODULUS * amplitude(p)))
        shears = stress - np.einsum("nii->ni", stress)[:, :, None] * np.eye(3)
        note("lateral stress", shears / (MODULUS * amplitude(p)))
        other_cell = np.floor(bar.x / bar.spacing) != np.floor(bar.start / bar.spacing)
        crossed = max(crossed, float(np.mean(other_cell)))
    return {**worst, "crossed": crossed}


def judge(r: Results) -> list[Finding]:
    """Expect the same to round-off."""
    why = (
        "same discretisation; 1e-10: round-off (1e-16 a step, some hundred steps) times the gain of"
        " cell crossings"
    )
    findings = [
        below(f"{name}, {p.cells} cells", m[name], 1e-10, why) for p, m in r for name in NAMES
    ]
    for p, m in r:
        # With displacements of 0.05 L and cells of L/16 a third of the points and more change cell.
        share = Finding(f"points in another cell, {p.cells} cells", m["crossed"], 0.2, 1.0)
        share.reason = "the comparison must include cell crossings"
        findings.append(share)
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="One motion in every TYPE",
    statement=r"""
A bar between two walls, with rollers on its sides, vibrates along an axis with an amplitude of
0.05 of its length, so that points cross cells. Across it nothing moves, and the scheme factors:
nodal masses, momenta and forces are those of the one-dimensional bar times the lateral sum of the
functions (in TYPE 4, along $z$, the factor $r$ is in that sum). So all TYPEs and all axes must
give *the same numbers*, step by step. They are compared with the scheme in one dimension written
again in NumPy from its formulas: linear functions or their corner averages, forces, symplectic
update, FLIP, exponential volumes, stress in rate form. Lateral stresses are $\nu/(1-\nu)$ of the
axial one.
""",
    source="Independent implementation of the same scheme",
    scene=scene,
    measure=measure,
    judge=judge,
)
