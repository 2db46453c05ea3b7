"""Error against the time step alone, at a fixed grid."""

from __future__ import annotations

import numpy as np
from _waves import LENGTH, Bar, DiscreteWave, bar_wave, interpolate, symbols
from harness.case import Case, Finding, Measures, Output, Parameters, Results, near, observed_order
from harness.norms import Errors, l2, linf
from harness.scene import Scene

FRAMES = 32
AMPLITUDE = 1e-8
K = np.pi / LENGTH


def bar(p: Parameters) -> Bar:
    """Return the bar; the row refines the steps in which a wave crosses a cell."""
    return Bar(p, cells=int(p.number("bar", 128)))


def period(p: Parameters) -> float:
    """Return the time of a period."""
    return 2.0 * LENGTH / bar(p).c


def time_step(p: Parameters) -> float:
    """Return the time step; the frames fall on its multiples."""
    return bar(p).h / (bar(p).c * p.cells)


def scene(p: Parameters) -> Scene:
    """Return the standing wave."""
    speed = AMPLITUDE * K * bar(p).c
    result = bar(p).scene(lambda x: speed * np.sin(K * x), period(p), FRAMES)
    result.dt = time_step(p)
    return result


def wave(p: Parameters) -> DiscreteWave:
    """Return the wave of the discrete equations."""
    this = bar(p)
    return bar_wave(K * this.h, p.ppc, this.c, this.h)


def continuous(p: Parameters, times: np.ndarray) -> np.ndarray:
    """Return the amplitude on the grid, over A, when time is not discrete."""
    this = wave(p)
    omega = np.sqrt(this.stiffness * this.mu)
    start = symbols(K * bar(p).h, p.ppc).s.real * K * bar(p).c
    return start / omega * np.sin(omega * times)


def measure(p: Parameters, out: Output) -> Measures:
    """Return the difference from the wave that is continuous in time."""
    points = out.scene.bodies[0].points
    x = points.x[:, bar(p).axis]
    profile = interpolate(lambda s: np.sin(K * s), x, bar(p).h)
    errors = Errors(points.measure)
    for frame in out.points():
        u = frame["displacement"][:, bar(p).axis] / AMPLITUDE
        errors.add("e_u", u - profile * float(continuous(p, np.array(frame.time))))
    return errors.measures()


def predicted(p: Parameters) -> dict[str, float]:
    """Return what the eigenvalues of a step make of the error."""
    dt = time_step(p)
    steps = round(period(p) / dt)
    start = symbols(K * bar(p).h, p.ppc).s.real * K * bar(p).c
    march, _ = wave(p).march(start, dt, steps)
    every = steps // FRAMES
    error = (march - continuous(p, dt * np.arange(steps + 1)))[::every]
    x = bar(p).points(lambda x: x).x[:, bar(p).axis]
    profile = interpolate(lambda s: np.sin(K * s), x, bar(p).h)
    largest = float(np.max(np.abs(error)))
    return {"e_u_l2": largest * l2(profile, np.ones(len(x))), "e_u_linf": largest * linf(profile)}


def judge(r: Results) -> list[Finding]:
    """Compare errors and orders with the prediction."""
    theory = [predicted(p) for p in r.parameters]
    findings = []
    for (p, m), expected in zip(r, theory, strict=True):
        for name in ("e_u_l2", "e_u_linf"):
            findings.append(
                near(
                    f"{name}, {p.cells} steps a cell",
                    m[name],
                    expected[name],
                    0.005,
                    "the discrete equations with and without time steps; 0.5 %: what is not linear",
                )
            )
    order = observed_order(r.cells, [expected["e_u_l2"] for expected in theory])
    reason = "order of the prediction; 0.01: the errors above agree to 0.5 %"
    findings.append(
        Finding("order of e_u", r.order("e_u_l2"), order - 0.01, order + 0.01, order, reason)
    )
    return findings


CASE = Case(
    family="Axial bar",
    title="Error against the time step alone",
    statement=r"""
The standing wave between two walls on one grid, the Courant number $1/R$ for $R$ steps in which a
wave crosses a cell; $R$ is the resolution of this case. Measured: the largest difference over a
period from the solution of the equations that are discrete in space alone,
$\omega_h = c\sqrt{K\mu}$.

Expected in a period: the phase error $2\pi(\omega\Delta t)^2/24$ of symplectic steps, order 2,
since the start at zero displacement needs no staggering; and the loss of amplitude
$\pi a(kh)^2\omega\Delta t$, order 1, by the filter $\mu = 1 - a(kh)^2$ that acts once a step. The
first dominates at Courant numbers above $12\,a\,kh$, the second below; the sum is known from the
eigenvalues of a step.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
)
