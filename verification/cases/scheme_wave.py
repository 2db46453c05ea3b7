"""Waves of every integrator, transfer and basis against their closed steps."""

from __future__ import annotations

import numpy as np
from _waves import LENGTH, SLIP, Bar, Walls
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.norms import Errors, linf
from harness.scene import DIM, Array, Scene
from harness.steps import March, ModeSteps, PointSums, march

#: Cells of a bar whose waves the row refines, and steps, each with a frame.
CELLS, STEPS = 24, 60
#: Frames of a run over a period.
FRAMES = 20
AMPLITUDE = 1e-10
#: Code of CartesianBoxCustom.
PERIODIC = 3


def refines(p: Parameters) -> str:
    """Return what the resolution is: waves on 24 cells, cells, or steps of a period."""
    return p.text("refine", "waves")


def has_walls(p: Parameters) -> bool:
    """Tell whether the bar lies between walls; else it is periodic."""
    return p.text("ends", "seam") == "walls"


def bar(p: Parameters) -> Bar:
    """Return the bar."""
    cells = {"waves": CELLS, "cells": p.cells, "steps": int(p.number("grid", 256))}
    return Bar(p, cells=cells[refines(p)])


def wave_number(p: Parameters) -> float:
    """Return k: the resolution is the number of waves, of half waves between walls."""
    number = p.cells if refines(p) == "waves" else 1
    return number * np.pi * (1.0 if has_walls(p) else 2.0) / LENGTH


def courant(p: Parameters) -> float:
    """Return c dt/h."""
    if refines(p) == "waves":
        return p.number("cfl", 0.3)
    this = bar(p)
    return 2.0 * np.pi / (wave_number(p) * this.h * steps_of(p))


def steps_of(p: Parameters) -> int:
    """Return the number of steps: 60, or those of a period."""
    if refines(p) == "waves":
        return STEPS
    if refines(p) == "steps":
        return p.cells
    this, unit = bar(p), p.number("cfl", 0.5)
    per_frame = 2.0 * np.pi / (wave_number(p) * this.h * unit * FRAMES)
    return FRAMES * int(np.ceil(per_frame - 1e-9))


def sums(p: Parameters) -> PointSums:
    """Return the sums of the points of a cell."""
    kh = wave_number(p) * bar(p).h
    return PointSums.of(kh, p.ppc, p.number("shift", 0.0), p.mapping)


def mode(p: Parameters) -> ModeSteps:
    """Return the steps of the wave."""
    kh = wave_number(p) * bar(p).h
    return ModeSteps.of(p.scheme, kh, p.ppc, p.number("shift", 0.0), p.mapping)


def start(p: Parameters) -> complex:
    """Return the velocity of the grid at the start, over that of the points.

    Affine fields begin as the fit to the velocities that the points map alone.
    """
    one = complex(np.mean(np.conj(sums(p).s)))
    if p.scheme.transfer in ("APIC", "MLS"):
        return one * (1.0 + mode(p).mu_affine - mode(p).mu)
    return one


def closed(p: Parameters) -> March:
    """Return the amplitudes of all steps; times are in units of dt, velocities in those of v."""
    return march(mode(p), start(p), courant(p), steps_of(p))


def scene(p: Parameters) -> Scene:
    """Return the bar with the velocities of a sine."""
    this, k = bar(p), wave_number(p)
    speed = AMPLITUDE * k * this.c
    dt = courant(p) * this.h / this.c
    frames = FRAMES if refines(p) != "waves" else STEPS
    walls = None
    if not has_walls(p):
        codes = [SLIP] * (2 * DIM[p.sim_type])
        codes[2 * this.axis : 2 * this.axis + 2] = [PERIODIC] * 2
        walls = Walls(codes)
    made = this.scene(lambda x: speed * np.sin(k * x), steps_of(p) * dt, frames, walls=walls)
    made.dt = dt
    if not has_walls(p):
        made.periodic = [d == this.axis for d in range(DIM[p.sim_type])]
    return made


def shapes(p: Parameters, x: Array) -> tuple[Array, Array]:
    """Return what all points see of a wave of the grid: value and gradient over k, complex."""
    one, h = sums(p), bar(p).h
    nearest = np.argmin(np.abs(np.mod(x[:, None] / h - one.places + 0.5, 1.0) - 0.5), axis=1)
    slope = one.fit if p.scheme.transfer == "MLS" else one.g
    wave = np.exp(1j * wave_number(p) * x)
    return one.s[nearest] * wave, slope[nearest] * wave / (wave_number(p) * h)


def recurrence(values: Array) -> tuple[float, float]:
    """Return trace and determinant of a step from u_(n+1) = trace u_n - determinant u_(n-1)."""
    rows = np.column_stack([values[1:-1], -values[:-2]])
    trace, determinant = np.linalg.lstsq(rows, values[2:], rcond=None)[0]
    return float(trace), float(determinant)


def measure(p: Parameters, out: Output) -> Measures:
    """Return differences from the closed steps, and from the exact wave where a row refines."""
    this, dt, k = bar(p), out.scene.dt, wave_number(p)
    omega, points = k * this.c, out.scene.bodies[0].points
    x = points.x[:, this.axis]
    value, gradient = shapes(p, x)
    known = closed(p)
    # u/(A), over dt of the steps: velocities are A omega.
    unit = omega * dt
    first = np.sin(k * x)
    fine = np.sqrt(mode(p).k2 * mode(p).gained) * this.c / this.h
    errors = Errors(points.measure)
    largest = dict.fromkeys(("d_u", "d_v", "d_s", "momentum"), 0.0)
    stresses = []
    shape = np.imag(gradient * start(p))
    for frame in out.points():
        step = round(frame.time / dt)
        u = frame["displacement"][:, this.axis] / AMPLITUDE
        v = frame["velocity"][:, this.axis] / (AMPLITUDE * omega)
        s = frame["cauchy_stress"][:, this.axis, this.axis] / (AMPLITUDE * k * this.modulus)
        found = {
            "d_u": u - unit * np.imag(value * known.moved[step]),
            "d_v": v - known.own[step] * first - np.imag(value * known.given[step]),
            "d_s": s - unit * np.imag(gradient * known.stress[step]),
            "momentum": np.array([points.total_mass @ v / np.sum(points.total_mass)]),
        }
        for name, difference in found.items():
            largest[name] = max(largest[name], linf(difference))
        stresses.append(float(shape @ s / (shape @ shape)))
        errors.add("e_u", u - first * np.sin(omega * frame.time))
        # Against steps of no length, of which damping transfers know none.
        limit = np.imag(value * start(p)) * omega / fine * np.sin(fine * frame.time)
        errors.add("e_t", u - limit)
    # A staggered start is a step of its own.
    trace, determinant = recurrence(np.array(stresses[1:]))
    between = unit * steps_of(p) / (len(stresses) - 1)
    return {
        **largest,
        **errors.measures(),
        "trace": trace,
        "determinant": determinant,
        "rate": -float(np.log(determinant)) / (2.0 * between),
    }


def judge(r: Results) -> list[Finding]:
    """Compare with the closed steps, and their orders with theory."""
    findings = []
    for p, m in r:
        label = f"{p.cells} {refines(p)}"
        k, this = wave_number(p), bar(p)
        time = k * this.h * courant(p) * steps_of(p)
        bound = 1e-9 + 20.0 * k * AMPLITUDE * (1.0 + time)
        reason = (
            "the closed steps; strains times phase for what is not linear, 1e-9 for roundings of "
            "places over displacements"
        )
        findings += [
            below(f"{name}, {label}", m[name], bound, reason) for name in ("d_u", "d_v", "d_s")
        ]
        if not has_walls(p):
            findings.append(
                below(
                    f"momentum, {label}",
                    m["momentum"],
                    1e-13 * (1 + steps_of(p)),
                    "functions sum to 1: no force on the whole; roundings of each step",
                )
            )
        findings += judge_step(p, m, label, bound)
    if len(r.measures) > 1:
        findings += judge_orders(r)
    return findings


def rate(p: Parameters) -> float:
    """Return the rate at which amplitudes decay, over the frequency."""
    dt = wave_number(p) * bar(p).h * courant(p)
    return -float(np.log(mode(p).determinant(courant(p)))) / (2.0 * dt)


def judge_step(p: Parameters, m: Measures, label: str, bound: float) -> list[Finding]:
    """Compare what frames tell of a step with its matrix."""
    matrix, cfl = mode(p).matrix(courant(p)), courant(p)
    reason = "matrix of a step; tolerance of the stress over its second difference"
    if refines(p) != "waves":
        # Frames are some steps apart: their phases differ by a twentieth of a period.
        spread = bound / (2.0 * np.pi / FRAMES) ** 3
        decay = rate(p)
        name = f"rate of decay over the frequency, {label}"
        return [Finding(name, m["rate"], decay - spread, decay + spread, decay, reason)]
    spread = bound / min(1.0, mode(p).k2 * cfl**2)
    trace, determinant = float(np.trace(matrix)), mode(p).determinant(cfl)
    return [
        Finding(
            f"trace of a step, {label}",
            m["trace"],
            trace - spread,
            trace + spread,
            trace,
            f"twice the cosine of omega dt times the decay: {reason}",
        ),
        Finding(
            f"determinant of a step, {label}",
            m["determinant"],
            determinant - spread,
            determinant + spread,
            determinant,
            f"factor of the energy: {reason}",
        ),
    ]


def is_filtered(p: Parameters) -> bool:
    """Tell whether a step damps by the filter, whatever its length."""
    return p.scheme.flip < 1.0 or p.scheme.transfer in ("PIC", "XPIC")


def judge_orders(r: Results) -> list[Finding]:
    """Compare orders with the leading terms of the closed steps."""
    p, scheme = r.first, r.first.scheme
    late = scheme.solver == "USF" and not scheme.staggered
    ahead = "stress updated first: displacements lead by a step"
    higher = scheme.transfer == "XPIC" and scheme.xpic > 1
    if refines(p) == "cells":
        order, reason = 2.0, "dispersion, and steps of order 2"
        if is_filtered(p) and not higher:
            order, reason = 1.0, "damping by (1 - mu)/(2 dt), 1 - mu = a (kh)^2, dt = C h/c"
        elif late:
            order, reason = 1.0, ahead
        value = r.order("e_u_l2")
        return [Finding("order of e_u in h", value, order - 0.15, order + 0.1, order, reason)]
    if refines(p) != "steps":
        return []
    findings = []
    order, reason = 1.0, "increments lose 1 - mu: c^2 K dt (1 - mu)/2"
    if is_filtered(p):
        order = -1.0
        reason = "a part of the velocity in each step: the rate grows with the number of steps"
    if is_filtered(p) or (scheme.solver, scheme.transfer) == ("USL", "FLIP"):
        name = "order of the rate of decay in dt"
        value = r.order("rate")
        findings.append(Finding(name, value, order - 0.05, order + 0.05, order, reason))
    if not is_filtered(p):
        order, reason = (1.0, ahead) if late else (2.0, "symplectic steps from displacement 0")
        reason += "; 0.2: terms of order 1 in dt, smaller by (kh)^2"
        value = r.order("e_t_l2")
        name = "order of e_t in dt"
        findings.append(Finding(name, value, order - 0.2, order + 0.1, order, reason))
    return findings


CASE = Case(
    family="Axial bar",
    title="Waves of every integrator and transfer",
    statement=r"""
Standing waves of a uniform bar, periodic or between walls, at every point and every step (or frame)
against the *closed steps* of integrator, transfer and basis. With $S_p = \sum_i N_i e^{ik(x_i -
x_p)}$, $G_p$ the same with the slopes of the functions, $T_p$ with $N_i (x_i - x_p)$ and $D_p =
\sum_i N_i (x_i - x_p)^2$, means over the points of a cell give $\mu = \overline{|S|^2}$, $K =
\overline{|G|^2}$ and $\mu_A = \mu + \overline{|T|^2/D}$, and a step is

$$f = -\Delta t\, c^2 K U, \qquad V' = \nu V + \beta f, \qquad U' = U + \Delta t\, \bar V$$

with $\bar V = V + f$ in USL, $V'$ in MUSL and $V$, before the forces, in USF; FLIP has $\nu = 1$,
$\beta = \mu$, PIC $\nu = \beta = \mu$, a blend $\nu = a + (1-a)\mu$, XPIC of order $j$ $\nu = 1 -
(1-\mu)^j$, APIC and MLS $\nu = \beta = \mu_A$ (MLS with $T/D$ in place of $G$). Velocities at the
start are those of a sine, of which the grid sees a part: FLIP keeps the rest, a blend shrinks it by
$a$ a step, all others forget it at once.

Measured: `d_u`, `d_v`, `d_s`, the largest differences of displacement, velocity and stress at
points;
trace and determinant of a step by least squares from the sequence of stresses, no theory put in;
`e_u` against the exact wave, `e_t` against steps of no length. Rows refine the waves on 24 cells,
the
cells of a period, or its steps (*fixed grid*).

Expected: differences of round-off. The determinant is the factor of the energy in a step: 1 in MUSL
and USF with FLIP and in all of hats with APIC, $1 - (1-\mu)z$ in USL with FLIP, $\mu$ in PIC,
$1 - (1-\mu)^j$ in XPIC with MUSL. In $h$ at a fixed Courant number: order 2; 1 for PIC and blends,
whose damping $(1-\mu)/(2\Delta t)$ is of order $h$; 1 for USF, whose displacements lead by a step
unless `staggered`. In $\Delta t$ on a fixed grid: order 2 (USF: 1), and the damping of PIC, blends
and XPIC *diverges* like $1/\Delta t$: with $\Delta t \sim h^2$ a PIC wave dies at a rate that does
not fall with $h$.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
)
