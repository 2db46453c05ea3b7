"""Every wave that a grid can show: frequency and decay against the eigenvalues of a step."""

from __future__ import annotations

import numpy as np
from _waves import LENGTH, Bar, DiscreteWave, bar_wave, fit_oscillation, interpolate, walls_reflect
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.norms import linf
from harness.scene import Scene

#: Cells of the bar; the row refines the number of half waves on them.
CELLS = 24
#: Steps, each with a frame.
STEPS = 60
AMPLITUDE = 1e-10


def wave_number(p: Parameters) -> float:
    """Return k."""
    return p.cells * np.pi / LENGTH


def bar(p: Parameters) -> Bar:
    """Return the bar."""
    return Bar(p, cells=CELLS, periodic=not walls_reflect(p))


def time_step(p: Parameters) -> float:
    """Return the time step."""
    return p.number("cfl", 0.3) * bar(p).h / bar(p).c


def shape(p: Parameters, x: np.ndarray) -> np.ndarray:
    """Return what points get of a sine on the grid."""
    k = wave_number(p)
    return interpolate(lambda s: np.sin(k * s), x, bar(p).h, p.mapping, p.ppc)


def scene(p: Parameters) -> Scene:
    """Return the bar with velocities from the grid, so that the points hold the wave alone."""
    speed = AMPLITUDE * wave_number(p) * bar(p).c
    result = bar(p).scene(lambda x: speed * shape(p, x), STEPS * time_step(p), STEPS)
    result.dt = time_step(p)
    return result


def wave(p: Parameters) -> DiscreteWave:
    """Return the wave of the discrete equations."""
    this = bar(p)
    shift = p.number("shift", 0.0)
    return bar_wave(wave_number(p) * this.h, p.ppc, this.c, this.h, shift, p.mapping)


def measure(p: Parameters, out: Output) -> Measures:
    """Return frequency and decay of the wave, and its difference from the discrete equations."""
    along = bar(p).axis
    profile = shape(p, out.scene.bodies[0].points.x[:, along])
    omega = wave_number(p) * bar(p).c
    march, _ = wave(p).march(wave(p).mu * omega, out.scene.dt, STEPS)
    times, amplitudes, deviation = [], [], 0.0
    for step, frame in enumerate(out.points()):
        u = frame["displacement"][:, along] / AMPLITUDE
        deviation = max(deviation, linf(u - profile * march[step]))
        times.append(frame.time)
        amplitudes.append(float(profile @ u / (profile @ profile)))
    guess = wave(p).frequency(out.scene.dt)
    frequency, decay = fit_oscillation(np.array(times), np.array(amplitudes), guess)
    return {
        "ratio": frequency / omega,
        "decay": decay / omega,
        "d_u": deviation / float(np.max(np.abs(march))),
    }


def judge(r: Results) -> list[Finding]:
    """Compare with the eigenvalues."""
    findings = []
    for p, m in r:
        label = f"{p.cells} half waves on {CELLS} cells"
        dt, omega = time_step(p), wave_number(p) * bar(p).c
        linear = 10.0 * wave_number(p) * AMPLITUDE * omega * STEPS * dt
        reason = "eigenvalues of a step; strains times phase for what is not linear"
        findings += [
            near(
                f"omega_h/omega, {label}",
                m["ratio"],
                wave(p).frequency(dt) / omega,
                1e-7 + linear,
                reason,
            ),
            near(
                f"decay/omega, {label}",
                m["decay"],
                wave(p).energy_loss(dt) / (2.0 * omega),
                1e-4,
                f"{reason}, larger by frequency over decay",
            ),
            below(
                f"d_u, {label}",
                m["d_u"],
                1e-7 + linear,
                "the discrete equations solved in closed form; strains times phase",
            ),
        ]
    return findings


CASE = Case(
    family="Axial bar",
    title="Dispersion and decay of every wave of a bar",
    statement=r"""
Standing waves of $m$ half waves, the resolution of this case, on the 24 cells of a bar between two
walls, down to nearly one half wave a cell. Velocities at the start are those that a sine on the
grid gives to the points. Measured at each of 60 steps: frequency and decay by a fit, and the
difference of the displacements from the solution of the discrete equations.

Expected: with $s = \sin^2(kh/2)$, $K = 4s/h^2$, $\mu = 1 - 4s\,\overline{\xi(1-\xi)}$ ($\xi$ the
places of the points in their cells) and $z = c^2K\Delta t^2$, a step has the eigenvalues of
$\begin{pmatrix}1 & \mu\\ -z & 1-z\end{pmatrix}$: their angle is the frequency, their magnitude,
$\sqrt{1-(1-\mu)z}$, the decay. It holds for any offset of the points between two walls.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
)
