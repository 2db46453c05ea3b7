"""Modes of a bar: measures and findings that `standing_wave` and `fixed_free_mode` share.

u = A sin(kX) sin(w t), w = k c, from the velocity A w sin(kX) at zero displacement.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from _waves import (
    FREE,
    SLIP,
    Bar,
    BarScheme,
    DiscreteWave,
    bar_wave,
    fit_oscillation,
    interpolate,
    slope,
    symbols,
    walls_reflect,
)
from harness.case import (
    Finding,
    Measures,
    Output,
    Parameters,
    Results,
    below,
    near,
    observed_order,
)
from harness.norms import Errors, linf
from harness.scene import Scene
from harness.theory import dispersion_constant, stress_constant

FRAMES = 40
EPSILON = float(np.finfo(float).eps)


def amplitude(p: Parameters) -> float:
    """Return A; so small by default that strains stay far below the errors that are asserted."""
    return p.number("amplitude", 1e-8)


def period(p: Parameters, k: float) -> float:
    """Return the time of a period."""
    return 2.0 * np.pi / (k * Bar(p).c)


def mode_scene(p: Parameters, bar: Bar, k: float) -> Scene:
    """Return the scene of a mode over one period."""
    speed = amplitude(p) * k * bar.c

    def velocity(x: np.ndarray) -> np.ndarray:
        return speed * np.sin(k * x)

    return bar.scene(velocity, period(p, k), int(p.number("frames", FRAMES)))


def discrete(p: Parameters, k: float) -> DiscreteWave:
    """Return the wave of the discrete equations."""
    bar = Bar(p)
    return bar_wave(k * bar.h, p.ppc, bar.c, bar.h, basis=p.mapping)


def fields(bar: Bar, k: float, dt: float, steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what the discrete equations make of the wave at the points of a row along the bar.

    Displacements over A, increments of velocities over A omega and strains over k A:
    (frames, points).
    """
    p, omega = bar.p, k * bar.c
    every = steps // int(p.number("frames", FRAMES))
    scheme = BarScheme(bar)
    if not walls_reflect(p):
        start = omega * np.sin(k * scheme.x)
        march, kicks = scheme.march(start, np.zeros(len(scheme.mass)), dt, steps, every)
        return march @ scheme.values.T, kicks @ scheme.values.T / omega, march @ scheme.slopes.T / k

    def wave(s: np.ndarray) -> np.ndarray:
        return np.sin(k * s)

    seen = interpolate(wave, scheme.x, bar.h, p.mapping, p.ppc)
    strain = slope(wave, scheme.x, bar.h, p.mapping, p.ppc) / k
    start = symbols(k * bar.h, p.ppc, basis=p.mapping).s.real * omega
    march, kicks = (a[::every, None] for a in discrete(p, k).march(start, dt, steps))
    return march * seen, kicks * seen / omega, march * strain


def frequency(bar: Bar, k: float, dt: float) -> float:
    """Return the frequency of the discrete equations."""
    guess = discrete(bar.p, k).frequency(dt)
    if walls_reflect(bar.p):
        return guess
    return float(np.angle(BarScheme(bar).eigenvalue(dt, guess))) / dt


def time_step(p: Parameters, k: float) -> float:
    """Return the time step of a run."""
    return Bar(p).dt(period(p, k), int(p.number("frames", FRAMES)))


def measure_mode(p: Parameters, out: Output, k: float, end: int = SLIP) -> Measures:
    """Measure errors over all frames, all in units of the wave's amplitudes.

    `e_u`, `e_v`, `e_s`: displacement, velocity and stress along the bar; `e_w`: velocity against
    the exact one half a step earlier; `e_c`: stress in the middle of the cells; `d_u`, `d_v`,
    `d_s`: difference from the discrete equations; `across`: motion across the bar; `lateral`:
    stress across the bar.
    """
    bar, dt = Bar(p, end=end), out.scene.dt
    points, a, omega = out.scene.bodies[0].points, amplitude(p), k * bar.c
    x, volume = points.x[:, bar.axis], points.measure
    shape, strain = np.sin(k * x), np.cos(k * x)
    line = np.searchsorted(BarScheme(bar).x, x - 1e-9 * bar.h)
    expected = [rows[:, line] for rows in fields(bar, k, dt, out.scene.steps)]
    ratio = p.number("nu", 0.0) / (1.0 - p.number("nu", 0.0))
    column = np.floor(x / bar.h).astype(int)
    weight = np.bincount(column, volume)
    middle = np.cos(k * bar.h * (np.arange(len(weight)) + 0.5))
    errors, cells = Errors(volume), Errors(weight)
    largest = dict.fromkeys(("d_u", "d_v", "d_s", "across", "lateral"), 0.0)

    def note(name: str, difference: np.ndarray) -> None:
        largest[name] = max(largest[name], linf(difference))

    times, amplitudes = [], []
    others = [i for i in range(3) if i != bar.axis]
    for number, frame in enumerate(out.points()):
        t = frame.time
        u = frame["displacement"][:, bar.axis] / a
        v = frame["velocity"][:, bar.axis] / (a * omega)
        s = frame["cauchy_stress"][:, bar.axis, bar.axis] / (a * k * bar.modulus)
        errors.add("e_u", u - shape * np.sin(omega * t))
        errors.add("e_v", v - shape * np.cos(omega * t))
        errors.add("e_w", v - shape * np.cos(omega * max(0.0, t - dt / 2)))
        errors.add("e_s", s - strain * np.sin(omega * t))
        mean = np.bincount(column, volume * s) / weight
        cells.add("e_c", mean - middle * np.sin(omega * t))
        note("d_u", u - expected[0][number])
        note("d_v", v - shape - expected[1][number])
        note("d_s", s - expected[2][number])
        note("across", frame["displacement"][:, others] / a)
        sides = frame["cauchy_stress"][:, others, others] / (a * k * bar.modulus)
        note("lateral", sides - ratio * s[:, None])
        times.append(t)
        amplitudes.append(np.sum(volume * shape * u) / np.sum(volume * shape**2))
    found, _ = fit_oscillation(np.array(times), np.array(amplitudes), omega)
    return {
        **errors.measures(),
        **cells.measures(),
        **largest,
        "frequency_ratio": found / omega,
        "e_u_absolute": errors.largest["e_u_l2"] * a,
    }


def judge_mode(
    r: Results, wave_number: Callable[[Parameters], float], end: int = SLIP
) -> list[Finding]:
    """Return the findings of a mode."""
    findings = orders(r, wave_number)
    for p, m in r:
        findings += judge_run(p, m, wave_number(p), end)
    return findings


def orders(r: Results, wave_number: Callable[[Parameters], float]) -> list[Finding]:
    """Return orders in h at a fixed Courant number."""
    second = "lumped mass and symplectic steps: order 2; 0.1 for the next terms from kh = 0.4 on"
    first = (
        "linear functions give all points of a cell one stress: order 1; more by errors of second "
        "order from kh = 0.2 on"
    )
    least = 1.9
    if r.first.mapping == "cubic":
        # The light nodes next to walls take the share 0.44 h/L of the dispersion away.
        least, second = 1.75, second + "; 0.15 for the walls of cubic functions, of order h (kh)**2"
    wanted = [
        ("order of e_u", "e_u_l2", 0.4, least, 2.1, 2.0, second),
        ("order of e_u, l1", "e_u_l1", 0.4, least, 2.1, 2.0, second),
        ("order of e_u, linf", "e_u_linf", 0.4, least, 2.1, 2.0, second),
        ("order of e_v half a step earlier", "e_w_l2", 0.4, least, 2.1, 2.0, second),
        ("order of e_s in the middle of cells", "e_c_l2", 0.4, 1.85, 2.1, 2.0, second),
    ]
    if stress_constant(r.first.ppc, basis=r.first.mapping) < 1e-12:
        wanted.append(("order of e_s", "e_s_l2", 0.4, 1.85, 2.1, 2.0, second))
    else:
        wanted.append(("order of e_s", "e_s_l2", 0.2, 0.95, 1.2, 1.0, first))
    findings = []
    for name, key, largest, low, high, expected, reason in wanted:
        fine = [(p.cells, m[key]) for p, m in r if wave_number(p) * Bar(p).h < largest]
        if len(fine) > 1:
            order = observed_order(*zip(*fine, strict=True))
            findings.append(Finding(name, order, low, high, expected, reason))
    return findings


def judge_run(p: Parameters, m: Measures, k: float, end: int) -> list[Finding]:
    """Return the findings of one run."""
    bar = Bar(p, end=end)
    kh, dt = k * bar.h, time_step(p, k)
    cfl, strain = bar.cfl(dt), k * amplitude(p)
    label = f"{p.cells} cells"
    kappa = dispersion_constant(p.ppc, p.mapping) - cfl**2 / 24.0
    theory = 1.0 - frequency(bar, k, dt) / (k * bar.c)
    nonlinear = 5.0 * strain
    linear = (
        "the discrete equations solved in closed form, or for splines as matrices; 5 strains for "
        "what is not linear: the second harmonic grows to omega t/16 strains, its gradient to "
        "twice that"
    )
    if p.mapping == "ugimp" and end == FREE:
        nonlinear += amplitude(p) / bar.h
        linear += "; u/h: boxes that reach over the free end pull at a node of next to no mass"
    findings = [
        near(
            f"1 - omega_h/omega, {label}",
            1.0 - m["frequency_ratio"],
            theory,
            0.005,
            "eigenvalues of a step; 0.5 %: points' part that the grid does not see, fit",
        ),
        below(f"d_u, {label}", m["d_u"], nonlinear, linear),
        below(f"d_v, {label}", m["d_v"], nonlinear, linear),
        below(f"d_s, {label}", m["d_s"], nonlinear, linear),
        below(
            f"across, {label}",
            m["across"],
            1e3 * EPSILON / kh,
            "nothing moves across the bar; roundings of a thousand forces in units of the wave",
        ),
        below(
            f"lateral, {label}",
            m["lateral"],
            1e4 * EPSILON,
            "stress across the bar is nu/(1 - nu) of that along it; roundings of a sum over steps",
        ),
    ]
    if p.cells >= 32:
        findings += [
            near(
                f"1 - omega_h/omega by kappa, {label}",
                1.0 - m["frequency_ratio"],
                kappa * kh**2,
                0.03,
                "(kappa - CFL^2/24)(kh)^2; 3 %: the next term of the series",
            ),
            near(
                f"e_u by kappa, {label}",
                m["e_u_l2"],
                2.0 * np.pi * kappa * kh**2 / np.sqrt(2.0),
                0.03,
                "phase error at the end of the period; 3 %: the next term of the series",
            ),
        ]
        spread = stress_constant(p.ppc, basis=p.mapping)
        if spread > 1e-12:
            findings.append(
                near(
                    f"e_s, {label}",
                    m["e_s_l2"],
                    kh * spread / np.sqrt(2.0),
                    0.05,
                    "one stress for all points of a cell: kh times their mean distance from its "
                    "middle; 5 %: errors of second order",
                )
            )
    return findings
