"""A bar hits a rigid wall."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import ALL_DIGITS, free_box
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import (
    DIM,
    NVEL,
    UP,
    Body,
    Scene,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)

LENGTH, DENSITY, YOUNG = 1.0, 1000.0, 1e6
#: Time of the run after the bar has come to the wall, in transits of a wave.
TRANSITS, FRAMES = 5.0, 100
#: Cells across, by directions of the grid; rollers on the sides.
WIDTH = {1: 1, 2: 1, 3: 1}


def wave_speed(p: Parameters) -> float:
    """Return speed of pressure waves."""
    return math.sqrt(pressure_wave_modulus(YOUNG, p.number("nu", 0.0)) / DENSITY)


def mach(p: Parameters) -> float:
    """Return speed of the impact over that of waves."""
    return p.number("speed", 0.05)


def scene(p: Parameters) -> Scene:
    """Return the scene: the bar begins one cell above the lower face, which is the wall."""
    dim, up, h, c = DIM[p.sim_type], UP[p.sim_type], LENGTH / p.cells, wave_speed(p)
    lower, upper = np.zeros(dim), np.full(dim, WIDTH[dim] * h)
    lower[up], upper[up] = h, h + LENGTH
    velocity = np.zeros(NVEL[p.sim_type])
    velocity[up] = -mach(p) * c
    size = np.round((upper - lower) / h * p.ppc).astype(int)
    points = lattice(p.sim_type, lower, upper, list(size), DENSITY, list(velocity))
    t_stop = h / (mach(p) * c) + TRANSITS * LENGTH / c
    counts = [WIDTH[dim]] * dim
    counts[up] = p.cells + 3 + math.ceil(mach(p) * TRANSITS * p.cells)
    walls = {f"{'xyz'[d]}_{end}": 1 for d in range(dim) if d != up for end in ("lower", "upper")}
    walls[f"{'xyz'[up]}_lower"] = 1
    return Scene(
        p.sim_type,
        [n * h for n in counts],
        counts,
        [Body("bar", points, YOUNG, p.number("nu", 0.0), free_box(dim, walls))],
        t_stop,
        stable_dt(LENGTH, p.cells, c, t_stop, 0.2, FRAMES),
        FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return rebound, force of the wall, and energies from the momentum of the bar."""
    up, h, c = UP[p.sim_type], LENGTH / p.cells, wave_speed(p)
    frames = list(out.points())
    mass = frames[0]["mass"]
    times = np.array([f.time for f in frames])
    mean = np.array([mass @ f["velocity"][:, up] / np.sum(mass) for f in frames]) / (mach(p) * c)
    # A straight line through the middle of the impact: d(mean velocity)/dt = force/mass.
    pushed = np.abs(mean) < 0.6
    slope = np.polyfit(times[pushed], mean[pushed], 1)[0]
    lowest = min(float(np.min(f.x[:, up])) for f in frames) / h
    kinetic = [0.5 * mass @ f["velocity"][:, up] ** 2 / np.sum(mass) for f in frames]
    return {
        "loss": 1.0 - mean[-1],
        "force": slope * LENGTH / c,
        "lowest": lowest,
        "kinetic": kinetic[-1] / (0.5 * (mach(p) * c) ** 2),
    }


def judge(r: Results) -> list[Finding]:
    """Expect rebound and force of a bar of logarithmic elasticity."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells"
        # d'Alembert's 1 and the first order in v/c; at coarse grids the first cells of the way are
        # a cushion, of the length of a cell or two of the bar's.
        force = Finding(f"force of the wall over rho c v{end}", m["force"])
        force.expected = 1.0 + mach(p) / 4.0
        margin = 0.5 / p.cells + mach(p) ** 2
        force.low, force.high = force.expected - margin, force.expected + margin
        force.reason = "shock of the logarithmic law, 1 + v/(4 c); ends of a cell: 1/(2 N)"
        loss = Finding(f"1 - rebound{end}", m["loss"], expected=mach(p) / 8.0)
        loss.low, loss.high = 0.5 * mach(p) / 8.0, 1.5 * mach(p) / 8.0 + 0.1 / p.cells
        loss.reason = "the shock is slower than what relieves it: v/(8 c); filter at fronts: 1/N"
        lowest = Finding(f"lowest point above the wall, in cells{end}", m["lowest"], 0.0)
        lowest.reason = "no point passes the wall"
        kinetic = Finding(f"kinetic energy after over before{end}", m["kinetic"], 0.0, 1.0)
        kinetic.reason = "a wall does no work"
        findings += [force, loss, lowest, kinetic]
    return findings


CASE = Case(
    family="Hard cases",
    title="Impact on a wall",
    statement=r"""
A bar of length $L$ hits a rigid wall (a free-slip face of the grid; no contact rule) at the speed
$v$ of some hundredths of $c$. *Linear theory*: the force is $\rho c v$ for the time $2L/c$, and
the bar leaves with $-v$. The material's stress $M \ln F$ makes compression waves faster: the
shock has the speed $c\,(1 + v/(4c))$, so that the force is **$\rho c v\,(1 + v/(4c))$**; what
relieves it runs at $c\,(1 + v/(2c))$ at its head and at $c$ at its tail, the wall lets go when
half of that has come, and by the impulse the rebound is **$1 - v/(8c)$**. Both must be found, no
point may pass the wall, and no energy may be gained. The wall also holds a bar back until its
last points are a cell away; that costs little, since the bar's end is free of stress by then.
Corner averages only: with linear functions a slow end is unstable.
""",
    source="d'Alembert; corrections of first order derived here",
    scene=scene,
    measure=measure,
    judge=judge,
)
