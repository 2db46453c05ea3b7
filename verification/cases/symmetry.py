"""Mirrored, turned, shifted and reordered copies of a body."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from _freebodies import ALL_DIGITS, EPS, free_faces, lopsided
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import DIM, NVEL, Array, Body, Points, Scene, lattice, pressure_wave_modulus

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
WAVE_SPEED = float(np.sqrt(MODULUS / DENSITY))
FRAMES = 4
#: Largest velocity over the wave speed; the body drifts by half of that, through several cells.
SPEED = 0.1


class Copy(NamedTuple):
    """A copy of the body: positions go to `q (x - middle) + middle + offset`."""

    name: str
    #: Orthogonal map of all three components of vectors.
    q: Array
    #: Cells of the offset along each direction.
    offset: Array
    #: Order of the rows of the points file.
    order: Callable[[int], Array] = np.arange


def courant(p: Parameters) -> float:
    """Return a Courant number, small enough for linear edges to be past a node in a step."""
    return 0.2 if p.mapping == "cpdi" else 0.02


def steps(p: Parameters) -> int:
    """Return steps that make the body drift by one to three cells."""
    return (160 if p.sim_type == 3 else 240) * (2 if p.mapping == "linear" else 1)


def copies(p: Parameters) -> list[Copy]:
    """Return all that maps the grid and the TYPE's equations onto themselves."""
    dim, one = DIM[p.sim_type], np.eye(3)
    none = np.zeros(3)
    found = [
        Copy("the body", one, none),
        Copy("reversed rows", one, none, lambda n: np.arange(n)[::-1]),
        Copy("shuffled rows", one, none, lambda n: np.random.default_rng(7).permutation(n)),
    ]
    up = 1 if p.sim_type == 4 else 0
    found.append(Copy("shifted by a cell", one, np.eye(3)[up]))
    found.append(Copy("shifted by 3 cells", one, 3.0 * np.eye(3)[up]))
    for d in range(dim):
        if p.sim_type == 4 and d == 0:
            continue
        mirror = one.copy()
        mirror[d, d] = -1.0
        found.append(Copy(f"mirrored along {'xyz'[d]}", mirror, none))
    if p.sim_type in (4, 5):
        # The third component has no direction of its own: swirl and warp may change sign.
        found.append(Copy("third component reversed", np.diag([1.0, 1.0, -1.0]), none))
    if p.sim_type in (2, 5):
        turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        for quarters in (1, 2, 3):
            q = np.linalg.matrix_power(turn, quarters)
            found.append(Copy(f"turned by {90 * quarters} degrees", q, none))
    if p.sim_type == 3:
        cycle = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
        turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        found.append(Copy("axes exchanged", cycle, none))
        found.append(Copy("turned by 90 degrees", turn, none))
        found.append(Copy("turned about another axis", cycle @ turn @ cycle.T, none))
    return found


def half(p: Parameters) -> int:
    """Return cells from the middle of the grid to its faces."""
    return p.cells // 2 + (8 if p.sim_type == 3 else 11)


def middle(p: Parameters) -> Array:
    """Return middle of the grid; on the axis in TYPE 4."""
    m = np.zeros(3)
    m[: DIM[p.sim_type]] = half(p) * SPACING
    if p.sim_type == 4:
        m[0] = 0.0
    return m


def motion(p: Parameters, x: Array) -> Array:
    """Return a smooth velocity field without any symmetry."""
    s = (x - middle(p)[: x.shape[1]]) / (p.cells * SPACING)
    return SPEED * WAVE_SPEED * lopsided(p.sim_type, s)


def make(p: Parameters, copy: Copy) -> Points:
    """Return the points of a copy."""
    dim, nvel, m = DIM[p.sim_type], NVEL[p.sim_type], middle(p)
    lower = m[:dim] - 0.5 * p.cells * SPACING
    upper = lower + p.cells * SPACING
    if p.sim_type == 4:
        lower[0], upper[0] = 0.0, p.cells * SPACING
    # Off the middle of the grid, so that no copy lies on another.
    move = np.zeros(dim)
    move[-1] = SPACING
    count = [p.cells * p.ppc] * dim
    points = lattice(p.sim_type, lower + move, upper + move, count, DENSITY, lambda x: motion(p, x))
    x, v = np.zeros((len(points), 3)), np.zeros((len(points), 3))
    x[:, :dim], v[:, :nvel] = points.x, points.velocity
    x = (x - m) @ copy.q.T + m + copy.offset * SPACING
    order = copy.order(len(points))
    velocity = (v @ copy.q.T)[:, :nvel]
    return Points(
        p.sim_type, x[order, :dim], points.volume[order], points.mass[order], velocity[order]
    )


def scene(p: Parameters) -> Scene:
    """Return the scene: all copies at once; without contacts they do not feel each other."""
    dim = DIM[p.sim_type]
    boundary = free_faces(p)
    bodies = [
        Body(f"copy_{i}", make(p, copy), YOUNG, POISSON, boundary)
        for i, copy in enumerate(copies(p))
    ]
    counts = [2 * half(p)] * dim
    dt = courant(p) * SPACING / WAVE_SPEED
    return Scene(
        p.sim_type,
        [n * SPACING for n in counts],
        counts,
        bodies,
        steps(p) * dt,
        dt,
        1 if p.sim_type == 3 else FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return largest differences of the copies, mapped back, to the body."""
    m = middle(p)
    worst: dict[str, float] = {}
    all_copies = copies(p)
    series = [out.points(i) for i in range(len(all_copies))]
    for number in range(1, len(series[0])):
        body = series[0][number]
        for copy, frames in zip(all_copies[1:], series[1:], strict=True):
            frame = frames[number]
            back = np.empty(len(body.x), int)
            back[copy.order(len(body.x))] = np.arange(len(body.x))
            x = (frame.x[back] - m - copy.offset * SPACING) @ copy.q + m
            v = frame["velocity"][back] @ copy.q
            stress = np.einsum("ki,nkl,lj->nij", copy.q, frame["cauchy_stress"][back], copy.q)
            found = max(
                float(np.max(np.abs(x - body.x))) / SPACING,
                float(np.max(np.abs(v - body["velocity"]))) / (SPEED * WAVE_SPEED),
                float(np.max(np.abs(stress - body["cauchy_stress"]))) / (SPEED * MODULUS),
            )
            worst[copy.name] = max(worst.get(copy.name, 0.0), found)
    return worst


def judge(r: Results) -> list[Finding]:
    """Expect round-off."""
    findings = []
    for p, m in r:
        # Rounding of positions, in cells, and of velocities over SPEED, at each step; elastic
        # vibration neither damps nor amplifies it. Light nodes at edges do, with linear functions:
        # by a few times each time that an edge passes a node line, at most three in these runs.
        gain = 30.0 if p.mapping == "linear" else 1.0
        bound = gain * 2 * half(p) * EPS * steps(p) / SPEED
        for name, value in m.items():
            findings.append(
                below(f"{name}, {p.cells} cells", value, bound, "round-off of each step, added up")
            )
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Mirror, rotation, translation, order of points",
    statement=r"""
A free elastic block with a smooth velocity field of no symmetry drifts through cells and
vibrates. Copies of it are mirrored along each axis, turned by quarters (TYPE 3: axes exchanged
too), shifted by whole cells, or have the rows of their points file reversed or shuffled; in TYPE
4 and 5 the third component of the velocities is reversed. Mapped back they must agree with the
block in positions, velocities and all stress components *to round-off*: every step rounds
positions by $\epsilon$ times the size of the grid. With linear functions a light node at an edge
multiplies round-off a few times when it is passed.
""",
    source="Symmetry of the equations and of the grid",
    scene=scene,
    measure=measure,
    judge=judge,
)
