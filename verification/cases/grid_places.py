"""Points exactly on node planes, on the faces and in the corners of the grid."""

from __future__ import annotations

import itertools
import math
import re

import numpy as np
from _freebodies import (
    ALL_DIGITS,
    EPS,
    bulk_modulus,
    free_faces,
    kinetic_energy,
    strain_energy,
)
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import (
    DIM,
    NVEL,
    Array,
    Body,
    Points,
    Scene,
    pressure_wave_modulus,
    shear_modulus,
)

# A power of 2, so that positions on node planes are exact.
SPACING, DENSITY, YOUNG, POISSON = 0.125, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
WAVE_SPEED = float(np.sqrt(MODULUS / DENSITY))
LOST = re.compile(r"points that left the grid: (\d+)")


def place(p: Parameters) -> str:
    """Return where the points are: `flight`, `walls` or `leave`."""
    return p.text("place", "flight")


def grid(p: Parameters) -> int:
    """Return cells of the grid along each direction."""
    return p.cells if place(p) == "walls" else p.cells + 12


def lattice_on_nodes(p: Parameters) -> Points:
    """Return points at multiples of h/n; those on the surface of the body have half boxes there."""
    dim, first = DIM[p.sim_type], {"flight": 3, "walls": 0, "leave": 10}[place(p)]
    index = np.arange(p.cells * p.ppc + 1)
    side = np.where((index == 0) | (index == p.cells * p.ppc), 0.5, 1.0) * SPACING / p.ppc
    line = (first + index / p.ppc) * SPACING
    if p.sim_type == 4:
        # From the axis on, but not on it, where a point has no mass.
        lines, sides = [line[1:] - first * SPACING, line], [side[1:], side]
    else:
        lines, sides = [line] * dim, [side] * dim
    x = np.array(list(itertools.product(*lines)))
    volume = np.prod(np.array(list(itertools.product(*sides))), axis=1)
    return Points(p.sim_type, x, volume, DENSITY * volume, velocities(p, x))


def velocities(p: Parameters, x: Array) -> Array:
    """Return flight by a quarter of a cell a step, or a slow vibration between walls."""
    v = np.zeros((len(x), NVEL[p.sim_type]))
    dim = DIM[p.sim_type]
    if place(p) == "walls":
        k = np.pi / (p.cells * SPACING)
        for d in range(dim):
            v[:, d] = 1e-4 * WAVE_SPEED * np.sin(k * x[:, d])
        return v
    v[:, :dim] = 0.25 * SPACING / time_step(p)
    if p.sim_type == 4:
        v[:, 0] = 0.0
    return v


def time_step(p: Parameters) -> float:
    """Return a step of Courant number 0.2 or less; in flight a power of 2."""
    # In flight a power of 2, so that a quarter of a cell a step is exact.
    step = 0.2 * SPACING / WAVE_SPEED
    return step if place(p) == "walls" else 2.0 ** math.floor(math.log2(0.5 * step))


def steps(p: Parameters) -> int:
    """Return the steps of 5 cells of flight, of leaving the grid, or of some periods."""
    if place(p) == "walls":
        return 500
    return 20 if place(p) == "flight" else 4 * (p.cells + 4)


def scene(p: Parameters) -> Scene:
    """Return the scene: one body in a cube of cells."""
    dim, dt = DIM[p.sim_type], time_step(p)
    boundary = "CartesianSmoothBox" if place(p) == "walls" else free_faces(p)
    return Scene(
        p.sim_type,
        [grid(p) * SPACING] * dim,
        [grid(p)] * dim,
        [Body("points", lattice_on_nodes(p), YOUNG, POISSON, boundary)],
        steps(p) * dt,
        dt,
        4,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return sums over nodes against sums over points; then what the motion must keep."""
    points, dim = out.scene.bodies[0].points, DIM[p.sim_type]
    frames, nodes = list(out.points()), out.nodes()[0]
    mass = math.fsum(points.total_mass)
    centroid = [math.fsum(points.total_mass * points.x[:, d]) for d in range(dim)]
    nodal = [math.fsum(nodes["mass"] * nodes.x[:, d]) for d in range(dim)]
    extent = grid(p) * SPACING
    found = {
        "mass": abs(math.fsum(nodes["mass"]) / mass - 1.0),
        "centroid": float(np.max(np.abs(np.subtract(nodal, centroid)))) / (mass * extent),
        "finite": float(all(np.all(np.isfinite(v)) for f in frames for v in f.fields.values())),
    }
    if place(p) == "walls":
        shear, bulk = shear_modulus(YOUNG, POISSON), bulk_modulus(YOUNG, POISSON)
        energy = [kinetic_energy(f) + strain_energy(f, shear, bulk) for f in frames]
        sums = [math.fsum(f["mass"]) for f in frames]
        return {**found, "energy": max(energy) / energy[0], "lost": 1.0 - sums[-1] / sums[0]}
    speed = 0.25 * SPACING / time_step(p)
    nvel = NVEL[p.sim_type]
    off, drift, stress, left = 0.0, 0.0, 0.0, 0.0
    for frame in frames:
        inside = frame["active"] == 1.0
        v = frame["velocity"][:, :nvel] - points.velocity
        moved = frame["displacement"][inside, :nvel] - points.velocity[inside] * frame.time
        off = max(off, float(np.max(np.abs(v))) / speed)
        drift = max(drift, float(np.max(np.abs(moved), initial=0.0)) / SPACING)
        stress = max(stress, float(np.max(np.abs(frame["cauchy_stress"]))) / MODULUS)
        # A point on the upper face is inside; exactness of the flight decides.
        exact = points.x + points.velocity[:, :dim] * frame.time
        should = np.all(exact <= extent * (1.0 + 1e-12), axis=1)
        edge = np.any(np.abs(exact - extent) < 1e-9, axis=1)
        left = max(left, float(np.sum((inside != should) & ~edge)))
    told = LOST.search(out.text)
    outside = float(np.sum(frames[-1]["active"] != 1.0))
    return {
        **found,
        "velocity": off,
        "position": drift,
        "stress": stress,
        "wrong side": left,
        "told": float(told[1]) if told else 0.0,
        "outside": outside,
    }


def judge(r: Results) -> list[Finding]:
    """Expect sums to round-off, exact flight, no growth."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells"
        # A point on a node gives its cell's far node a weight of 4 eps.
        width = {"ugimp": 3, "quadratic": 3, "cubic": 4}.get(p.mapping, 2)
        terms = (width * p.ppc + 1) ** DIM[p.sim_type]
        small = (8 + terms) * DIM[p.sim_type] * EPS
        findings += [
            below(f"nodal mass over mass less 1{end}", m["mass"], small, "sum N = 1"),
            below(f"nodal centroid less centroid{end}", m["centroid"], small, "sum N x = x"),
            Finding(f"all fields finite{end}", m["finite"], 1.0, 1.0, 1.0, "no 0/0 on node lines"),
        ]
        if place(p) == "walls":
            rises = Finding(f"largest energy over the first{end}", m["energy"], 0.0, 1.1)
            rises.reason = "no growth; C/2 = 0.1 between velocities and stresses"
            findings += [rises, below(f"mass lost{end}", m["lost"], 0.0, "walls hold it")]
            continue
        n, why = steps(p), "round-off of each step"
        findings += [
            below(f"change of velocity{end}", m["velocity"], small * n, why),
            below(f"position off its line{end}", m["position"], 4 * small * n, why),
            below(f"stress{end}", m["stress"], 4 * small * n, why),
            below(f"points on the wrong side{end}", m["wrong side"], 0.0, "exact flight"),
        ]
        told = Finding(f"points that the program tells it lost{end}", m["told"])
        told.low = told.high = told.expected = m["outside"]
        told.reason = "inactive points of the last frame"
        findings.append(told)
        if place(p) == "leave":
            gone = Finding(f"points that are outside at the end{end}", m["outside"], 1.0)
            gone.reason = "the body flies out of the grid"
            findings.append(gone)
    return findings


CASE = Case(
    family="Hard cases",
    title="Points on node planes, faces and corners of the grid",
    statement=r"""
Points lie at multiples of $h/n$, so that many are exactly on node planes. `flight`: a body flies
along the diagonal by a quarter of a cell a step, exactly from node plane to node plane. `walls`:
it fills the grid, with points on all faces and in all corners, between free-slip walls, and
vibrates for 500 steps. `leave`: it flies out of the grid at a corner. *Must hold*: nodal masses
sum to the mass, their moments to its moments, to round-off (no point is counted twice or lost);
nothing is 0/0; flights are exact; energy does not grow; points beyond a face are inactive, those
before it are not, and the program tells how many have left.
""",
    source="Elementary",
    scene=scene,
    measure=measure,
    judge=judge,
)
