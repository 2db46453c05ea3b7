"""A column under drivers that choose their steps, and that damp."""

from __future__ import annotations

import numpy as np
from _waves import FREE, LENGTH, Bar, fit_oscillation, interpolate
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.norms import Errors, l1, linf
from harness.scene import Array, Scene, section

FRAMES = 40
#: Strain rho g L/M of the weight at the base.
STRAIN = 1e-7
K = 0.5 * np.pi / LENGTH


def kind(p: Parameters) -> str:
    """Return the driver: adaptive, viscous or kinetic."""
    return p.text("driver", "adaptive")


def bar(p: Parameters) -> Bar:
    """Return the column, fixed at its base."""
    return Bar(p, end=FREE)


def gravity(p: Parameters) -> float:
    """Return gravity of the strain."""
    return STRAIN * bar(p).c ** 2 / LENGTH


def viscosity(p: Parameters) -> float:
    """Return the damping, a part of what is critical for the slowest mode."""
    part = p.number("damping", 0.5) if kind(p) == "viscous" else 0.0
    return part * 2.0 * K * bar(p).c


def fraction(p: Parameters) -> float:
    """Return the step over the stable one that the driver takes."""
    return p.number("cfl", 0.4)


def longest(p: Parameters) -> float:
    """Return the step that stability allows, at most that of the job."""
    this = bar(p)
    stable = 1.0 / np.sqrt(5.0 / 3.0 + 1.0 / (3.0 * p.ppc**2))
    step = fraction(p) * stable * this.h / this.c
    return min(float(step), job_step(p))


def job_step(p: Parameters) -> float:
    """Return dt of the job: a bound that does not matter unless the row has a `cap`."""
    this = bar(p)
    return p.number("cap", 10.0) * this.h / this.c


def end(p: Parameters) -> float:
    """Return the time of the run: in periods of the slowest mode, 4 L/c."""
    return p.number("periods", 1.0 if kind(p) == "adaptive" else 4.0) * 4.0 * LENGTH / bar(p).c


def scene(p: Parameters) -> Scene:
    """Return the column with its weight from the start."""
    this = bar(p)
    made = this.scene(np.zeros_like, end(p), FRAMES)
    pull = [0.0] * len(made.bodies[0].points.velocity[0])
    pull[this.axis] = -gravity(p)
    names = dict(zip(("gx", "gy", "gz"), pull, strict=False))
    reals = {"t_stop": end(p), **names, "cfl": fraction(p)}
    if kind(p) == "adaptive":
        made.driver = section("AdaptiveDriver", reals)
    else:
        reals["viscous"] = viscosity(p)
        made.driver = section("QuasiStaticDriver", reals, {"kinetic": int(kind(p) == "kinetic")})
    made.dt = job_step(p)
    return made


def frame_times(p: Parameters) -> list[float]:
    """Return the times that the frames are asked for; the last one is the end of the run."""
    rate = FRAMES / end(p) * (1.0 + 1e-9)
    return [k / rate for k in range(FRAMES)] + [end(p)]


def step_lengths(p: Parameters) -> list[list[float]]:
    """Return the lengths of the steps between frames: the longest, and two halves of the rest."""
    result, time, most = [], 0.0, longest(p)
    for goal in frame_times(p)[1:]:
        lengths = []
        while goal - time > most * (1.0 + 1e-9):
            lengths.append(min(most, 0.5 * (goal - time)))
            time += lengths[-1]
        lengths.append(goal - time)
        time = goal
        result.append(lengths)
    return result


def march(p: Parameters, lengths: list[list[float]]) -> Array:
    """Return displacements of the nodes at the frames, by the linear steps of USL with FLIP.

    Parameters
    ----------
    p : Parameters
        The run.
    lengths : list[list[float]]
        Steps before each frame but the first.
    """
    this = bar(p)
    n, h, nodes = p.ppc, this.h, np.arange(this.cells + 1)
    places = (np.arange(n * this.cells) + 0.5) / n
    weights = np.maximum(0.0, 1.0 - np.abs(places[:, None] - nodes))
    mass = weights.sum(axis=0)
    loop = (weights.T / mass[:, None]) @ weights
    v, u, shown = np.zeros(len(nodes)), np.zeros(len(nodes)), [np.zeros(len(nodes))]
    damping, g, stiffness = viscosity(p), gravity(p), n * this.c**2 / h**2
    for steps in lengths:
        for dt in steps:
            pull = stiffness * np.diff(u)
            force = np.zeros(len(nodes))
            force[:-1] += pull
            force[1:] -= pull
            f = dt * (force / mass - g)
            f[0] = 0.0
            v = np.exp(-damping * dt) * v
            u = u + dt * (v + f)
            v = v + loop @ f
            v[0] = 0.0
        shown.append(u)
    return np.array(shown)


def exact(p: Parameters, x: Array, time: float) -> Array:
    """Return the displacement without damping: the sum of waves that the base sends."""
    c, t, total = bar(p).c, time, -0.5 * time**2 * np.ones_like(x)
    for m in range(int(c * time / (2.0 * LENGTH)) + 1):
        there, back = t - (2 * m * LENGTH + x) / c, t - (2 * (m + 1) * LENGTH - x) / c
        total += 0.5 * (-1) ** m * (np.maximum(there, 0.0) ** 2 + np.maximum(back, 0.0) ** 2)
    return gravity(p) * total


def measure(p: Parameters, out: Output) -> Measures:
    """Compare frames with the linear steps, with the exact motion, and with the state of rest."""
    this, points = bar(p), out.scene.bodies[0].points
    x = points.x[:, this.axis]
    unit = STRAIN * LENGTH
    shape = interpolate(lambda s: np.sin(K * s), x, this.h)
    known = march(p, step_lengths(p))
    fixed = march(p, even_steps(p))
    errors, even = Errors(points.measure), Errors(points.measure)
    times, modes, difference, late = [], [], 0.0, 0.0
    for index, frame in enumerate(out.points()):
        u = frame["displacement"][:, this.axis] / unit
        own, other = (interpolate_nodes(a[index], x, this.h) / unit for a in (known, fixed))
        difference = max(difference, linf(u - own))
        asked = frame_times(p)[index]
        nearest = abs(frame.time - asked)
        if index == FRAMES:  # the rate is a little above FRAMES over the time
            nearest = min(nearest, abs(frame.time - asked / (1.0 + 1e-9)))
        late = max(late, nearest)
        errors.add("e_u", u - exact(p, x, frame.time) / unit)
        even.add("e_fixed", other - exact(p, x, frame.time) / unit)
        times.append(frame.time)
        modes.append(points.measure @ (shape * u))
    last = out.points()[-1]
    stress = last["cauchy_stress"][:, this.axis, this.axis] / (this.modulus * STRAIN)
    rest = stress + 1.0 - x / LENGTH
    cell = np.floor(x / this.h).astype(int)
    mean = np.bincount(cell, rest) / np.bincount(cell)
    t, q = np.array(times), np.array(modes) - static_mode(p, x, points.measure * shape)
    decay = np.nan
    if kind(p) == "viscous":
        guess = np.sqrt((K * this.c) ** 2 - viscosity(p) ** 2 / 4.0)
        _, decay = fit_oscillation(t, q / np.max(np.abs(q)), guess)
    return {
        **errors.measures(),
        **even.measures(),
        "d_u": difference,
        "late": late / end(p),
        "decay": decay,
        "rest in cells": linf(mean),
        "rest": l1(rest, points.measure),
    }


def interpolate_nodes(values: Array, x: Array, h: float) -> Array:
    """Return what points get of values on the nodes."""
    return np.interp(x / h, np.arange(len(values)), values)


def even_steps(p: Parameters) -> list[list[float]]:
    """Return steps of one length that is as long as stability allows and hits each frame."""
    each = end(p) / FRAMES
    number = int(np.ceil(each / longest(p) - 1e-9))
    return [[each / number] * number for _ in range(FRAMES)]


def static_mode(p: Parameters, x: Array, weight: Array) -> float:
    """Return the share of the first mode in the state of rest, with the stiffness of the grid."""
    this = bar(p)
    nodes = np.arange(this.cells + 1) * this.h
    # Strains of the cells are those of the weight above their middles.
    strain = -(1.0 - (nodes[:-1] + 0.5 * this.h) / LENGTH)
    u = np.concatenate([[0.0], np.cumsum(strain * this.h)]) / LENGTH
    return float(weight @ interpolate_nodes(u, x, this.h))


def judge(r: Results) -> list[Finding]:
    """Compare with the linear steps, and with what the driver is for."""
    findings = []
    for p, m in r:
        label = f"{p.cells} cells"
        findings.append(
            below(
                f"frame times off over the end, {label}",
                m["late"],
                1e-15 * 16,
                "steps end at the times of the frames; roundings of times",
            )
        )
        if kind(p) != "kinetic":
            findings.append(
                below(
                    f"d_u, {label}",
                    m["d_u"],
                    20.0 * STRAIN * 2.0 * np.pi * p.number("periods", 4.0),
                    "the linear steps with the lengths that the driver must choose; strains times "
                    "phase for what is not linear, speeds of points included",
                )
            )
        if kind(p) == "adaptive":
            findings.append(
                Finding(
                    f"e_u over that of equal steps, {label}",
                    m["e_u_l2"] / m["e_fixed_l2"],
                    0.0,
                    1.0 + 2.0 / FRAMES,
                    reason="the start costs half a step: never longer than an equal one by more "
                    "than the two halves that meet a frame make up for",
                )
            )
        if kind(p) == "viscous":
            findings += judge_decay(p, m, label)
        if kind(p) == "kinetic":
            findings += judge_rest(p, m, label, 1e-2)
    return findings


def judge_decay(p: Parameters, m: Measures, label: str) -> list[Finding]:
    """Expect the decay of the slowest mode, and the state of rest in the end."""
    this = bar(p)
    rate = 0.5 * viscosity(p)
    # The filter of USL, as a rate: c^2 K (1 - mu) dt/2 = a (kh)^2 (kc)^2 dt/2.
    filtered = 0.5 * (1.0 / 6.0 + 1.0 / (12.0 * p.ppc**2)) * (K * this.h) ** 2
    filtered *= (K * this.c) ** 2 * longest(p)
    margin = 1e-3 * rate + filtered
    found = Finding(f"rate of decay over viscous/2, {label}", m["decay"] / rate)
    found.low, found.high = 1.0 - margin / rate, 1.0 + margin / rate + filtered / rate
    found.expected = 1.0 + filtered / rate
    found.reason = "v' = -viscous v: exp(-viscous t/2), and the filter; 0.1 %: unequal steps"
    left = float(np.exp(-rate * end(p))) * 2.0
    return [found, *judge_rest(p, m, label, left)]


def judge_rest(p: Parameters, m: Measures, label: str, left: float) -> list[Finding]:
    """Expect the exact stress in the middle of the cells, and steps within them."""
    offsets = np.abs((np.arange(p.ppc) + 0.5) / p.ppc - 0.5)
    steps = float(np.mean(offsets)) / p.cells
    reason = "the stress of a cell is that of the weight above its middle; motion that is left"
    found = [below(f"stress of cells at the end, {label}", m["rest in cells"], left, reason)]
    error = Finding(f"e_stress in L1 at the end, {label}", m["rest"], steps - left, steps + left)
    error.expected = steps
    error.reason = "one stress a cell: mean distance of the points from its middle"
    return [*found, error]


CASE = Case(
    family="Axial bar",
    title="Drivers that choose their steps, and that damp",
    statement=r"""
A column on a fixed base gets its weight at once, $\rho g L/M = 10^{-7}$.

*AdaptiveDriver*: one period. Frames have exactly the times asked for. The steps must be `cfl` times
the stable step (or dt of the job if that is less), and two equal ones before a frame: with these
lengths the linear equations of the scheme, followed step by step, must give the displacements.
The error against the exact waves is that of the start, half a step, and so not larger than with
equal steps of the same Courant number.

*QuasiStaticDriver, viscous*: damping of half of what is critical for the slowest mode, four
periods. Expected: the linear equations again, with the factor $e^{-\alpha\Delta t}$ of the
velocities before each step; the slowest mode decays at the rate $\alpha/2$, to which the filter of
USL adds $a (kh)^2 (kc)^2 \Delta t/2$; at the end the column is at rest in the exact state that the
grid can have, the weight above the middle of each cell. *Kinetic*: the same state of rest; the
motion is stopped when its energy has passed a maximum.
""",
    source="Elementary; closed form of sudden gravity by reflected waves",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=1.0,
)
