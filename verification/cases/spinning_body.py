"""Free elastic bodies that spin: angular momentum, growth, stress."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import ALL_DIGITS, angular_momentum, free_box, free_faces, kinetic_energy
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.frames import Frame
from harness.norms import l2
from harness.scene import (
    DIM,
    NVEL,
    Array,
    Body,
    Points,
    Scene,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
WAVE_SPEED = float(np.sqrt(pressure_wave_modulus(YOUNG, POISSON) / DENSITY))
FRAMES = 40
#: Cells of a body of TYPE 3 along the axis of its spin.
THICKNESS = 2


def radius(p: Parameters) -> float:
    """Radius of a disc, half the side of a block: `cells` is the diameter, in TYPE 4 the radius."""
    return p.cells * SPACING * (1.0 if p.sim_type == 4 else 0.5)


def spin(p: Parameters) -> float:
    """Angular velocity at the start."""
    return p.number("tip", 0.1) * WAVE_SPEED / radius(p)


def layout(p: Parameters) -> tuple[list[int], Array, Array]:
    """Cells of the grid, lower and upper corner of the body in cells."""
    if p.sim_type == 4:
        return [p.cells + 3, 2], np.zeros(2), np.array([p.cells, 2.0])
    across = p.cells + 2 * (p.cells // 4 + 3)
    counts, size = [across, across], [p.cells, p.cells]
    if p.sim_type == 3:
        counts, size = [*counts, THICKNESS + 6], [*size, THICKNESS]
    lower = 0.5 * (np.array(counts, float) - size)
    return counts, lower, lower + size


def body_points(p: Parameters) -> Points:
    """A block, or with `disc` what lies in a circle, with the velocities of a rigid spin."""
    _, lower, upper = layout(p)
    center = 0.5 * (lower + upper)[:2] * SPACING
    size = np.round((upper - lower) * p.ppc).astype(int)

    def velocity(x: Array) -> Array:
        v = np.zeros((len(x), NVEL[p.sim_type]))
        if p.sim_type == 4:
            v[:, 2] = spin(p) * x[:, 0]
        else:
            v[:, 0] = -spin(p) * (x[:, 1] - center[1])
            v[:, 1] = spin(p) * (x[:, 0] - center[0])
        return v

    points = lattice(p.sim_type, lower * SPACING, upper * SPACING, list(size), DENSITY, velocity)
    if p.number("disc", 0) == 1:
        inside = np.hypot(*(points.x[:, :2] - center).T) < radius(p)
        points = points.keep(inside)
    return points


def scene(p: Parameters) -> Scene:
    """One revolution, without walls; TYPE 4: rollers at both ends, so that it is in plane strain."""
    counts = layout(p)[0]
    boundary = free_faces(p)
    if p.sim_type == 4:
        boundary = free_box(2, {"x_lower": 1, "y_lower": 1, "y_upper": 1})
    t_stop = 2.0 * np.pi / spin(p) * p.number("revolutions", 1.0)
    return Scene(
        p.sim_type,
        [n * SPACING for n in counts],
        counts,
        [Body("body", body_points(p), YOUNG, POISSON, boundary)],
        t_stop,
        stable_dt(SPACING, 1, WAVE_SPEED, t_stop, p.number("cfl", 0.2), FRAMES),
        FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Angular momentum, moment of inertia and stress over the frames."""
    frames = list(out.points())
    if p.sim_type == 4:
        return measure_cylinder(p, frames)
    mass = frames[0]["mass"]
    center = mass @ frames[0].x / np.sum(mass)
    turns = np.array([angular_momentum(f, center)[2] for f in frames])
    arms = [(f.x - center)[:, :2] for f in frames]
    inertia = np.array([np.sum(mass * np.sum(a**2, axis=1)) for a in arms])
    times = np.array([f.time for f in frames])
    rate = (turns / inertia) ** 2
    growth = out.scene.dt * np.sum(0.5 * (rate[1:] + rate[:-1]) * np.diff(times))
    late = frames[len(frames) // 2 :]
    pull = [np.sum(f["volume"] * (f["cauchy_stress"][:, 0, 0] + f["cauchy_stress"][:, 1, 1])) for f in late]
    return {
        "loss": 1.0 - turns[-1] / turns[0],
        "growth": np.log(inertia[-1] / inertia[0]) / growth,
        "volume": float(np.sum(frames[-1]["volume"]) / np.sum(frames[0]["volume"]) - 1.0),
        "virial": np.mean(pull) / np.mean([2.0 * kinetic_energy(f) for f in late]),
    }


def measure_cylinder(p: Parameters, frames: list[Frame]) -> Measures:
    """TYPE 4: also the stress, averaged over the second half of the time."""
    mass, r = frames[0]["mass"], frames[0].x[:, 0]
    turns = [math.fsum(mass * f.x[:, 0] * f["velocity"][:, 2]) for f in frames]
    half = len(frames) // 2
    found = np.mean([f["cauchy_stress"] for f in frames[half:]], axis=0)
    scale = DENSITY * spin(p) ** 2 / (8.0 * (1.0 - POISSON))
    exact = np.zeros_like(found)
    exact[:, 0, 0] = scale * (3 - 2 * POISSON) * (radius(p) ** 2 - r**2)
    exact[:, 2, 2] = scale * ((3 - 2 * POISSON) * radius(p) ** 2 - (1 + 2 * POISSON) * r**2)
    exact[:, 1, 1] = POISSON * (exact[:, 0, 0] + exact[:, 2, 2])
    largest = scale * (3 - 2 * POISSON) * radius(p) ** 2
    # The rim's last cell has a stress of its own, of the filled part of the cell.
    inside = r < radius(p) - SPACING
    axis = r < SPACING
    weight = mass[inside]
    return {
        "loss": 1.0 - turns[-1] / turns[0],
        "steady loss": (turns[half] - turns[-1]) / turns[0] * len(turns) / (len(turns) - half),
        "stress": l2((found - exact)[inside], weight) / largest,
        "axis": float(np.mean(found[axis, 2, 2]) / np.mean(exact[axis, 2, 2])),
        "twist": float(np.max(np.abs(found[axis, 0, 2]))) / largest,
    }


def judge(r: Results) -> list[Finding]:
    """Laws of the statement."""
    if r.first.sim_type == 4:
        return judge_cylinder(r)
    findings = []
    if len(r.measures) > 1:
        order = Finding("order of the loss of angular momentum", r.order("loss"), 1.5, 3.0, 2.0)
        order.reason = "share of the edge nodes times offset of their centroids"
        findings.append(order)
    for p, m in r:
        end = f", {p.cells} cells"
        offset = 1.0 / 3.0 + 1.0 / (6.0 * p.ppc**2)
        bound = 2.0 * np.pi * 2.0 * offset * (SPACING / radius(p)) ** 2
        law = "2 pi 2 (1/3 + 1/(6 n^2)) (h/R)^2: all offsets in one direction"
        findings.append(below(f"loss of angular momentum{end}", m["loss"], bound, law))
        if p.number("tip", 0.1) < 0.05:
            # Elastic expansion: rho w^2 R^2/M = tip^2 = 4e-4 against a growth of some 5e-3.
            findings.append(
                near(
                    f"growth of the inertia over dt int w^2 dt{end}",
                    m["growth"],
                    1.0,
                    0.1,
                    "chords of a rotation shrink, see statement; 10 %: elastic expansion",
                )
            )
            findings.append(
                below(
                    f"change of the volume that points carry{end}",
                    abs(m["volume"]),
                    p.number("tip", 0.1) ** 2,
                    "what the chords take, the growth gives back; elastic: rho w^2 R^2/M",
                )
            )
            findings.append(
                near(
                    f"int (Txx + Tyy) dV over 2 KE{end}",
                    m["virial"],
                    1.0,
                    0.05,
                    "virial theorem, exact for a steady motion; 5 %: breathing that is left",
                )
            )
    return findings


def judge_cylinder(r: Results) -> list[Finding]:
    """TYPE 4."""
    findings = []
    if len(r.measures) > 1:
        order = Finding("order of the stress error", r.order("stress"), 0.8)
        order.reason = "1 at the rim, 2 inside; less than 1 would be O(1) somewhere"
        findings.append(order)
    for p, m in r:
        end = f", {p.cells} cells"
        bound = 2.0 * np.pi * (SPACING / radius(p)) ** 2
        findings.append(
            below(
                f"loss of angular momentum{end}",
                abs(m["loss"]),
                bound,
                "once, when the points' velocities adapt to the nodes' centroids: order (h/R)^2",
            )
        )
        findings.append(
            below(
                f"steady loss of angular momentum a revolution{end}",
                abs(m["steady loss"]),
                1e-3,
                "r v_theta is constant without torque: no loss that a steady state would have",
            )
        )
        findings.append(Finding(f"stress error{end}", m["stress"], 0.0, 1.0 / p.cells))
        findings[-1].reason = "of first order at least"
        findings.append(
            near(
                f"hoop stress in the axis cell over the exact one{end}",
                m["axis"],
                1.0,
                1.0 / p.cells,
                "regular on the axis",
            )
        )
        findings.append(
            below(
                f"torsional stress in the axis cell{end}",
                m["twist"],
                1e-3,
                "a rigid spin has none: v_theta vanishes on the axis",
            )
        )
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Spinning bodies",
    statement="""
x
""",
    source="Derived here; Timoshenko and Goodier, Theory of Elasticity (rotating cylinder)",
    scene=scene,
    measure=measure,
    judge=judge,
)
