"""Two pulses that run apart and come back from the walls of a bar."""

from __future__ import annotations

import numpy as np
from _waves import LENGTH, Bar, BarScheme, symbols, walls_reflect
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.norms import Errors, linf
from harness.scene import Scene
from harness.theory import dispersion_constant, frequency_ratio

WIDTH, START, AMPLITUDE = 0.05, 0.35, 1e-9
#: Distance that the pulses run, the frames on it, and where both are apart and off the walls.
WAY, FRAMES = 1.25, 25
APART = (10, 17, 25)
#: The frame in which the way before the first pulse is looked at.
BEFORE = 5


def pulse(s: np.ndarray) -> np.ndarray:
    """Return the pulse."""
    return np.exp(-((s / WIDTH) ** 2))


def images(s: np.ndarray) -> np.ndarray:
    """Return the pulse at the start and its images in both walls, for |s| < 3 lengths."""
    places = [sign * START + 2.0 * LENGTH * j for sign in (1, -1) for j in (-2, -1, 0, 1, 2)]
    return np.sum([pulse(s - place) for place in places], axis=0)


def exact(x: np.ndarray, way: float) -> np.ndarray:
    """Return u/A after waves have run a way."""
    return images(x + way) - images(x - way)


def velocity(p: Parameters, x: np.ndarray) -> np.ndarray:
    """Return the velocity at the start."""
    s = (x - START) / WIDTH
    return -4.0 * AMPLITUDE * Bar(p).c / WIDTH * s * np.exp(-(s**2))


def scene(p: Parameters) -> Scene:
    """Return the bar between two walls."""
    return Bar(p).scene(lambda x: velocity(p, x), WAY / Bar(p).c, FRAMES)


def discrete(p: Parameters, dt: float, steps: int) -> np.ndarray:
    """Return the displacements of the nodes over A after each frame, as sines that do not mix."""
    bar, n = Bar(p), p.ppc
    nodes = np.arange(bar.cells + 1)
    modes = nodes[1:-1]
    means = [symbols(np.pi * m / bar.cells, n) for m in modes]
    mu = np.array([m.mu for m in means])
    z = (bar.cfl(dt)) ** 2 * np.array([m.k2 for m in means])
    scheme = BarScheme(bar)
    at_start = scheme.values.T @ velocity(p, scheme.x) / n / AMPLITUDE
    sines = np.sin(np.pi * np.outer(nodes, modes) / bar.cells)
    v = 2.0 / bar.cells * (at_start @ sines)
    u, frames = np.zeros_like(v), []
    for step in range(steps + 1):
        if step % (steps // FRAMES) == 0:
            frames.append(sines @ u)
        f = -z / dt * u
        u = u + dt * (v + f)
        v = v + mu * f
    return np.array(frames)


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors, the lag and height of the first pulse, and what runs before it."""
    bar, points = Bar(p), out.scene.bodies[0].points
    x, volume = points.x[:, bar.axis], points.measure
    scheme, dt, steps = BarScheme(bar), out.scene.dt, out.scene.steps
    line = np.searchsorted(scheme.x, x - 1e-9 * bar.h)
    if walls_reflect(p):
        theory = discrete(p, dt, steps)
    else:
        start = velocity(p, scheme.x) / AMPLITUDE
        theory, _ = scheme.march(start, np.zeros(p.cells + 1), dt, steps, steps // FRAMES)
    errors, result = Errors(volume), {"d_u": 0.0, "d_s": 0.0}
    for number, frame in enumerate(out.points()):
        u = frame["displacement"][:, bar.axis] / AMPLITUDE
        way = bar.c * frame.time
        errors.add("e_u", u - exact(x, way))
        s = frame["cauchy_stress"][:, bar.axis, bar.axis] * WIDTH / (bar.modulus * AMPLITUDE)
        step = 1e-6 * WIDTH
        gradient = (exact(x + step, way) - exact(x - step, way)) * WIDTH / (2.0 * step)
        errors.add("e_s", s - gradient)
        result["d_u"] = max(result["d_u"], linf(u - (scheme.values @ theory[number])[line]))
        result["d_s"] = max(result["d_s"], linf(s - WIDTH * (scheme.slopes @ theory[number])[line]))
        if number in APART:
            place = START + way
            turned = place > LENGTH
            centre = 2.0 * LENGTH - place if turned else place
            near_it = np.abs(x - centre) < 3.0 * WIDTH
            weight = volume[near_it] * u[near_it] ** 2
            centroid = weight @ x[near_it] / np.sum(weight)
            run = (2.0 * LENGTH - centroid if turned else centroid) - START
            result[f"lag_{number}"] = 1.0 - run / way
            result[f"height_{number}"] = float(np.max(np.abs(u[near_it])))
        if number == BEFORE:
            result["before"] = float(np.max(np.abs(u[x > START + way + 5.0 * WIDTH])))
    return {**errors.measures(), **result}


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    if len(r.cells) > 1:
        reason = "lumped mass: order 2; lower bounds for the next terms from h = w/10 on, where a "
        reason += "pulse lags by 10 % of its width, in proportion to kappa"
        lack = dispersion_constant(r.first.ppc, r.first.mapping) / dispersion_constant(r.first.ppc)
        for norm, less in (("l1", 0.1), ("l2", 0.2), ("linf", 0.25)):
            low, order = 2.0 - less * lack, r.order(f"e_u_{norm}")
            findings.append(Finding(f"order of e_u, {norm}", order, low, 2.05, 2.0, reason))
    for p, m in r:
        bar, label = Bar(p), f"{p.cells} cells"
        cfl = bar.cfl(bar.dt(WAY / bar.c, FRAMES))
        strain = AMPLITUDE / WIDTH
        kappa = dispersion_constant(p.ppc, p.mapping) - cfl**2 / 24.0
        # omega_h/omega = 1 - kappa q^2 + beta q^4: the mean of the group velocity over the
        # spectrum, exp(-(kw)^2/2), has <k^2> = 1/w^2 and <k^4> = 3/w^4.
        small = 0.2
        beta = (frequency_ratio(small, p.ppc, cfl, p.mapping) - 1.0 + kappa * small**2) / small**4
        lag = 3.0 * kappa * (bar.h / WIDTH) ** 2 - 15.0 * beta * (bar.h / WIDTH) ** 4
        for number in APART:
            way = number * WAY / FRAMES
            findings.append(
                near(
                    f"lag after {way:g}, {label}",
                    m[f"lag_{number}"],
                    lag,
                    0.03,
                    "3 (kappa - CFL^2/24)(h/w)^2, the mean group velocity, and the next term; 3 %: "
                    "the one after it",
                )
            )
        linear = "the discrete equations solved by sines; strain times phase for what is not linear"
        # exp(-k^2 w^2/4) spread by the phase kappa k^3 h^2 s: 1 - <(..)^2> of the square root.
        spread = kappa * (bar.h / WIDTH) ** 2 * WAY / WIDTH
        findings += [
            Finding(
                f"height at the end, {label}",
                m[f"height_{APART[-1]}"],
                1.0 - 60.0 * spread**2 - 0.5 * (bar.h / WIDTH / p.ppc) ** 2 - 0.01,
                1.0 + 1e-6,
                1.0,
                "dispersion only lowers a pulse: by half the variance, 60, of the phase after the "
                "lag; points beside the top",
            ),
            below(
                f"before the pulse, {label}",
                m["before"],
                1e-3,
                "lumped mass makes waves slower, so that nothing runs ahead",
            ),
            below(f"d_u, {label}", m["d_u"], 10.0 * strain * WAY / WIDTH, linear),
            below(f"d_s, {label}", m["d_s"], 20.0 * strain * WAY / WIDTH, linear),
        ]
    return findings


CASE = Case(
    family="Axial bar",
    title="Travelling pulses",
    statement=r"""
A bar at rest and free of stress between two walls gets the velocity $2cf'(X - X_0)$,
$f = A e^{-(s/w)^2}$, $w = L/20$: two pulses run apart, $u = f(X-X_0+ct) - f(X-X_0-ct)$, and come
back from the walls with the opposite sign (images in the walls). Measured over $ct = 1.25\,L$:
errors; the way that the centroid of $u^2$ of the first pulse lags behind $ct$, before and after its
reflection; its height; what runs before it; the difference from the discrete equations, whose
solution is a sum of sines.

Expected: order 2, and a relative lag $3(\kappa - \mathrm{CFL}^2/24)(h/w)^2$: the mean of the group
velocity over the spectrum of the pulse. Lumped mass makes waves slower, so that nothing runs ahead.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
