"""Mass, momentum and angular momentum of a free vibrating body over many steps."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import (
    ALL_DIGITS,
    EPS,
    angular_momentum,
    bulk_modulus,
    free_faces,
    kinetic_energy,
    lopsided,
    momentum,
    strain_energy,
    without_rigid_motion,
)
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.frames import Frame
from harness.scene import (
    DIM,
    Array,
    Body,
    Points,
    Scene,
    lattice,
    pressure_wave_modulus,
    shear_modulus,
)

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
WAVE_SPEED = float(np.sqrt(pressure_wave_modulus(YOUNG, POISSON) / DENSITY))
COURANT, FRAMES, MARGIN = 0.2, 20, 4


def speed(p: Parameters) -> float:
    """Return scale of the velocities over that of waves."""
    return p.number("speed", 1e-3)


def steps(p: Parameters) -> int:
    """Return steps of the run."""
    return int(p.number("steps", 10000))


def body_points(p: Parameters) -> Points:
    """Return a block at rest on the whole; with `spin` it may turn."""
    dim = DIM[p.sim_type]
    lower = np.full(dim, float(MARGIN))
    if p.sim_type == 4:
        lower[0] = 0.0
    upper = lower + p.cells
    points = lattice(
        p.sim_type,
        lower * SPACING,
        upper * SPACING,
        [p.cells * p.ppc] * dim,
        DENSITY,
        lambda x: speed(p) * WAVE_SPEED * lopsided(p.sim_type, x / (p.cells * SPACING)),
    )
    points.velocity = without_rigid_motion(points, keep_spin=p.number("spin", 0) == 1)
    return points


def scene(p: Parameters) -> Scene:
    """Return the scene: free faces all around, but the axis."""
    dim = DIM[p.sim_type]
    counts = [p.cells + 2 * MARGIN] * dim
    dt = COURANT * SPACING / WAVE_SPEED
    boundary = free_faces(p)
    return Scene(
        p.sim_type,
        [n * SPACING for n in counts],
        counts,
        [Body("block", body_points(p), YOUNG, POISSON, boundary)],
        steps(p) * dt,
        dt,
        FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return largest changes over the frames, over what they are to be compared with."""
    frames = list(out.points())
    first = frames[0]
    mass, x0, v0 = first["mass"], first.x, first["velocity"]
    total = math.fsum(mass)
    momenta = math.fsum(mass * np.linalg.norm(v0, axis=1))
    size = p.cells * SPACING
    center = mass @ x0 / total
    energy = kinetic_energy(first)
    shear, bulk = shear_modulus(YOUNG, POISSON), bulk_modulus(YOUNG, POISSON)
    worst = dict.fromkeys(["mass", "momentum", "center", "angular momentum"], 0.0)
    energies = []
    rows = [1] if p.sim_type == 4 else list(range(3))
    for frame in frames[1:]:
        changes = {
            "mass": float(np.max(np.abs(frame["mass"] - mass) / mass)),
            "momentum": np.max(np.abs(momentum(frame) - momentum(first))[rows]) / momenta,
        }
        drift = np.array([math.fsum(mass * (frame.x - x0)[:, c]) for c in range(3)]) / total
        drift -= momentum(first) / total * frame.time * (np.arange(3) < DIM[p.sim_type])
        changes["center"] = np.max(np.abs(drift[rows])) / size
        if p.sim_type == 4:
            swirl = [math.fsum(mass * f.x[:, 0] * f["velocity"][:, 2]) for f in (first, frame)]
            turns = math.fsum(mass * x0[:, 0] * np.abs(v0[:, 2]))
            changes["angular momentum"] = abs(swirl[1] - swirl[0]) / turns
        elif DIM[p.sim_type] > 1:
            about = slice(2, 3) if DIM[p.sim_type] == 2 else slice(0, 3)
            change = angular_momentum(frame, center) - angular_momentum(first, center)
            changes["angular momentum"] = np.max(np.abs(change[about])) / (momenta * size)
        for name, value in changes.items():
            worst[name] = max(worst[name], float(value))
        energies.append((kinetic_energy(frame) + strain_energy(frame, shear, bulk)) / energy)
    if has_whole_spin(p):
        nodes = list(out.nodes())[1:]
        turns = np.array([nodal_spin(frame, center) for frame in nodes])
        change = np.max(np.abs(turns - turns[0])[:, 2 if DIM[p.sim_type] == 2 else slice(None)])
        worst["angular momentum of nodes"] = float(change) / (momenta * size)
    return {**worst, "energy, largest": max(energies), "energy, last": energies[-1]}


def has_whole_spin(p: Parameters) -> bool:
    """Tell whether nodes keep their angular momentum while the body moves.

    Affine fields carry what the points leave; how much depends on the mean square distance of the
    nodes from a point, which smooth functions keep wherever the point is. In TYPE 3 corners reach
    nodes of negligible mass, of whose forces affine fields know nothing.
    """
    affine = p.scheme.transfer in ("APIC", "MLS")
    return affine and p.mapping in ("quadratic", "cubic") and p.sim_type in (2, 5)


def nodal_spin(frame: Frame, center: Array) -> Array:
    """Return the angular momentum of the nodes of a frame, after their update."""
    turns = frame["mass"][:, None] * np.cross(frame.x - center, frame["velocity"])
    return np.array([math.fsum(turns[:, c]) for c in range(3)])


def judge(r: Results) -> list[Finding]:
    """Expect mass exactly, momentum to round-off, angular momentum to what FLIP keeps."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells"
        n = steps(p)
        findings.append(below(f"change of mass{end}", m["mass"], 0.0, "masses are never written"))
        findings.append(
            below(
                f"change of momentum{end}",
                m["momentum"],
                n * EPS,
                "one rounding of each velocity a step, all of one sign",
            )
        )
        extent = (p.cells + 2 * MARGIN) / p.cells
        findings.append(
            below(
                f"centre of mass off its line{end}",
                m["center"],
                n * EPS * (extent + speed(p) * COURANT * n / p.cells),
                "one rounding of each position a step, and the momentum's drift",
            )
        )
        if DIM[p.sim_type] > 1 and p.number("spin", 0) == 0:
            # Around an axis splines reach two nodes beyond an edge, off by up to 3h/2.
            wide = 6.0 if p.sim_type == 4 and p.mapping in ("quadratic", "cubic") else 1.0
            findings.append(
                below(
                    f"change of angular momentum{end}",
                    m["angular momentum"],
                    wide * 0.5 / p.cells**2,
                    "share h/L of nodes at edges or axis, whose centroids are off by up to h/2",
                )
            )
        if has_whole_spin(p):
            findings.append(
                below(
                    f"change of the angular momentum of the nodes{end}",
                    m["angular momentum of nodes"],
                    10.0 * n * EPS * (p.cells + 2 * MARGIN) / p.cells,
                    "internal forces have no moment, affine fields carry the rest; ten roundings "
                    "of each moment a step",
                )
            )
        findings.append(
            Finding(
                f"largest energy{end}",
                m["energy, largest"],
                0.0,
                1.0 + COURANT / 2,
                reason="the filter only takes energy; omega dt/2 between v and T, omega <= c/h",
            )
        )
        findings.append(Finding(f"energy at the end{end}", m["energy, last"]))
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Mass, momentum and angular momentum over 10 000 steps",
    statement=r"""
A free elastic block with a smooth velocity field of no symmetry vibrates for 10 000 steps (with
`spin` it turns as well, through many node lines). *Exact*: the mass never changes. The increments
of the points sum to the nodal forces, and internal forces sum to 0 since the functions sum to 1:
linear momentum changes by round-off, $\epsilon$ a step at most. Points move with the grid's
velocity, whose mass-weighted sum is the momentum: the centre of mass moves on a line. Angular
momentum is exact from points to nodes, not on the way back: an increment that belongs to a node
acts at the centroid of its points. The two differ at the edges, and on the axis of TYPE 4, which
are a share $h/L$ of the nodes, by up to $h/2$: a vibration changes it by at most $(h/L)^2/2$ of
$L \sum m |v|$. Spinning bodies have a case of their own. TYPE 4: the axial momentum, and $\sum m
r v_\theta$.
""",
    source="Sulsky, Chen and Schreyer (1994); partition of unity",
    scene=scene,
    measure=measure,
    judge=judge,
)
