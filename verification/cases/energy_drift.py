"""Energy, frequency and momentum over many periods."""

from __future__ import annotations

import numpy as np
from _waves import (
    DENSITY,
    LENGTH,
    Bar,
    DiscreteWave,
    bar_wave,
    fit_oscillation,
    interpolate,
    symbols,
)
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import Scene
from harness.steps import ModeSteps
from harness.theory import energy_loss_per_period

#: Frames in a period; not a whole number of halves, so that all phases of the wave are seen.
FRAMES = 2.15
AMPLITUDE = 1e-8
K = np.pi / LENGTH


def frames(p: Parameters) -> int:
    """Return the number of frames."""
    return round(FRAMES * p.number("periods", 100))


def end(p: Parameters) -> float:
    """Return the time of the run."""
    return p.number("periods", 100) * 2.0 * LENGTH / Bar(p).c


def scene(p: Parameters) -> Scene:
    """Return the standing wave."""
    speed = AMPLITUDE * K * Bar(p).c
    return Bar(p).scene(lambda x: speed * np.sin(K * x), end(p), frames(p))


def wave(p: Parameters) -> DiscreteWave:
    """Return the wave of the discrete equations."""
    bar = Bar(p)
    return bar_wave(K * bar.h, p.ppc, bar.c, bar.h)


def steps(p: Parameters) -> ModeSteps:
    """Return the steps of the scheme of a row."""
    return ModeSteps.of(p.scheme, K * Bar(p).h, p.ppc, basis=p.mapping)


def frequency(p: Parameters, dt: float) -> float:
    """Return the frequency of the wave with its time steps."""
    return float(np.angle(steps(p).eigenvalue(Bar(p).cfl(dt)))) / dt


def loss(p: Parameters, dt: float) -> float:
    """Return minus the logarithm of the energy that a period leaves."""
    value = steps(p).eigenvalue(Bar(p).cfl(dt))
    return -2.0 * float(np.log(np.abs(value))) * 2.0 * np.pi / float(np.angle(value))


def is_plain(p: Parameters) -> bool:
    """Tell whether the row has USL and FLIP."""
    return (p.scheme.solver, p.scheme.transfer, p.scheme.flip) == ("USL", "FLIP", 1.0)


def measure(p: Parameters, out: Output) -> Measures:
    """Fit the decay of energy, and the frequency in both halves of the run."""
    bar, points = Bar(p), out.scene.bodies[0].points
    omega = frequency(p, out.scene.dt)
    profile = np.sin(K * points.x[:, bar.axis])
    times, energies, modes, momenta = [], [], [], []
    for frame in out.points():
        v = frame["velocity"][:, bar.axis]
        s = frame["cauchy_stress"][:, bar.axis, bar.axis]
        kinetic = 0.5 * np.sum(points.total_mass * v**2)
        strain = 0.5 * np.sum(points.measure * s**2) / bar.modulus
        times.append(frame.time)
        energies.append(kinetic + strain)
        modes.append(points.measure @ (profile * frame["displacement"][:, bar.axis]))
        momenta.append(points.total_mass @ v)
    t, q = np.array(times), np.array(modes) / np.max(np.abs(modes))
    # v and stress are half a step apart, so that their energies swing by omega dt/2 about the sum.
    columns = [np.ones_like(t), t, np.cos(2.0 * omega * t), np.sin(2.0 * omega * t)]
    fit = np.linalg.lstsq(np.column_stack(columns), np.log(energies), rcond=None)[0]
    half = len(t) // 2
    first, decay = fit_oscillation(t[:half], q[:half], omega)
    second, _ = fit_oscillation(t[half:], q[half:], omega)
    scale = DENSITY * np.sum(points.measure) * AMPLITUDE * K * bar.c * 2.0 / np.pi
    period = 2.0 * np.pi / omega
    # The walls give and take the momentum of the wave; what the grid does not see of the points'
    # velocities stays.
    swings = np.column_stack([np.sin(omega * t), np.cos(omega * t)]) * np.exp(-decay * t)[:, None]
    columns = np.column_stack([swings, np.ones_like(t)])
    momentum = np.array(momenta) / scale
    parts = np.linalg.lstsq(columns, momentum, rcond=None)[0]
    return {
        "loss": -fit[1] * period,
        "swing": float(np.hypot(fit[2], fit[3])),
        "omega_dt": omega * out.scene.dt,
        "frequency_ratio": first / (K * bar.c),
        "frequency_drift": (second - first) / first,
        "momentum": momentum[0],
        "momentum_constant": parts[2],
        "momentum_rest": float(np.max(np.abs(momentum - columns @ parts))),
    }


def unseen_momentum(p: Parameters) -> float:
    """Return the part of the momentum that the grid does not see, over that of the sine."""
    bar = Bar(p)
    points = bar.points(np.zeros_like)
    x = points.x[:, bar.axis]
    means = symbols(K * bar.h, p.ppc)
    seen = means.s.real / means.mu * interpolate(lambda s: np.sin(K * s), x, bar.h)
    return float(points.measure @ (np.sin(K * x) - seen) / np.sum(points.measure) * np.pi / 2.0)


def judge(r: Results) -> list[Finding]:
    """Compare with the formula and with the eigenvalues."""
    findings = []
    for p, m in r:
        bar, label = Bar(p), f"{p.cells} cells"
        dt = bar.dt(end(p), frames(p))
        kh = K * bar.h
        if not is_plain(p):
            findings += judge_scheme(p, m, dt, label)
            continue
        period = 2.0 * np.pi / wave(p).frequency(dt)
        findings += [
            near(
                f"energy lost in a period, {label}",
                m["loss"],
                wave(p).energy_loss(dt) * period,
                0.01,
                "eigenvalues of a step; 1 %: products of swing and decay, points' part that the "
                "grid does not see",
            ),
            near(
                f"energy lost by the formula, {label}",
                m["loss"],
                energy_loss_per_period(kh, p.ppc, bar.cfl(dt)),
                0.02 + 0.5 * kh**2,
                "2 pi a CFL (kh)^3; the next term of the series",
            ),
            near(
                f"swing of the energy, {label}",
                m["swing"],
                0.5 * m["omega_dt"],
                0.05 + kh**2,
                "v and stress are half a step apart: omega dt/2; the next term of the series",
            ),
            near(
                f"1 - omega_h/omega, {label}",
                1.0 - m["frequency_ratio"],
                1.0 - wave(p).frequency(dt) / (K * bar.c),
                0.001,
                "eigenvalues of a step; 0.1 %: fit over 50 periods",
            ),
            below(
                f"drift of the frequency, {label}",
                abs(m["frequency_drift"]),
                1e-8,
                "a linear wave keeps its frequency; strain 3e-8 squared, and roundings of the fit",
            ),
            near(
                f"momentum at the start, {label}",
                m["momentum"],
                1.0,
                kh**2,
                "mean of the sine; the sum over the points is a rule of second order",
            ),
            near(
                f"constant momentum, {label}",
                m["momentum_constant"],
                unseen_momentum(p),
                0.01,
                "velocities that the grid does not see stay; 1 %: fit",
            ),
            below(
                f"other momentum, {label}",
                m["momentum_rest"],
                K * AMPLITUDE * 2.0 * np.pi * p.number("periods", 100) / 16.0 + 1e-8,
                "walls give and take the momentum of the wave alone; strains times phase/16 for "
                "what is not linear, fit",
            ),
        ]
    return findings


def judge_scheme(p: Parameters, m: Measures, dt: float, label: str) -> list[Finding]:
    """Compare another integrator or transfer with the eigenvalues of its steps."""
    lost, angle = loss(p, dt), 0.5 * m["omega_dt"]
    # Swing times decay, and a swing that the fit has not at the frequency of a wave that decays.
    margin = 0.01 * lost + 1e-3 * angle / p.number("periods", 100)
    found = Finding(f"energy lost in a period, {label}", m["loss"], lost - margin, lost + margin)
    found.expected = lost
    found.reason = (
        "eigenvalues of a step; 1 % for products of swing and decay, and a thousandth of the "
        "swing over the periods"
    )
    findings = [found]
    if lost < 0.01:
        findings += [
            near(
                f"swing of the energy, {label}",
                m["swing"],
                angle,
                0.05 + (K * Bar(p).h) ** 2,
                "v and stress are half a step apart: omega dt/2; the next term of the series",
            ),
        ]
    # The displacements of USF swing about a step of the first velocity.
    if lost < 0.01 and p.scheme.solver != "USF":
        findings.append(
            near(
                f"1 - omega_h/omega, {label}",
                1.0 - m["frequency_ratio"],
                1.0 - frequency(p, dt) / (K * Bar(p).c),
                0.001,
                "eigenvalues of a step; 0.1 %: fit over half of the periods",
            )
        )
    return findings


CASE = Case(
    family="Axial bar",
    title="Energy, frequency and momentum over 100 periods",
    statement=r"""
The standing wave between two walls over 100 periods. Measured: the rate of decay of kinetic and
strain energy, by a fit that leaves out their swing; the frequency in both halves of the run; the
momentum.

Expected: USL with FLIP loses a part $2\pi a\,\mathrm{CFL}(kh)^3$ of the energy in a period,
$a = 1/6 + 1/(12n^2)$, or exactly $1-|\lambda|^2$ a step with the eigenvalues $\lambda$ of a step.
Velocities and stresses are half a step apart, so that the sum of their energies swings by
$\omega\Delta t/2$. The frequency does not drift. The momentum follows the wave, but for
the part of the points' velocities that the grid does not see: it stays.

Other schemes lose what the eigenvalues of their steps say: MUSL and USF with FLIP nothing, APIC on
hats nothing, PIC $2\pi a kh/\mathrm{CFL}$, a blend $1 - \alpha$ of it, XPIC(2) in MUSL and USF
$2\pi a^2 (kh)^3/\mathrm{CFL}$. What is conserved exactly in the linear steps is the modified energy
of symplectic Euler, $V^2 + \mu c^2KU^2 - \mu c^2K\Delta t\,UV$ with MUSL: the energy of the points
swings about it by $\omega\Delta t/2$ and does not drift.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="loss",
    order=3.0,
)
