"""A soft cantilever that hangs down under its weight."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import free_box
from _self_weight import self_weight
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import DIM, Array, Body, Scene, lattice, pressure_wave_modulus

DENSITY, YOUNG, HEIGHT = 1000.0, 1e6, 1.0
MARGIN = 3
#: Rise of gravity and settling, in periods of the first mode.
RAMP, SETTLE = 2.0, 1.5


def length(p: Parameters) -> float:
    """Return length of the beam."""
    return p.number("slenderness", 10) * HEIGHT


def load(p: Parameters) -> float:
    """Return weight of the beam times L^2 over E'I."""
    return p.number("load", 3.0)


def plate_modulus(p: Parameters) -> float:
    """Return E' of bending in plane strain."""
    return YOUNG / (1.0 - p.number("nu", 0.0) ** 2)


def gravity(p: Parameters) -> float:
    """Return gravity of that load."""
    return load(p) * plate_modulus(p) * HEIGHT**2 / (12.0 * DENSITY * length(p) ** 3)


def elastica(k: float, steps: int = 2000) -> tuple[Array, Array, Array]:
    """Return places x, y and angles of an inextensible cantilever of length 1 under its weight.

    theta'' = -k (1 - s) cos theta, theta(0) = 0, theta'(1) = 0, by shooting.
    """
    ds = 1.0 / steps

    def shoot(curvature: float) -> Array:
        state = np.zeros((steps + 1, 4))
        state[0] = [0.0, 0.0, 0.0, curvature]

        def rate(s: float, u: Array) -> Array:
            return np.array([math.cos(u[2]), math.sin(u[2]), u[3], -k * (1.0 - s) * math.cos(u[2])])

        for i in range(steps):
            s, u = i * ds, state[i]
            a = rate(s, u)
            b = rate(s + ds / 2, u + ds / 2 * a)
            c = rate(s + ds / 2, u + ds / 2 * b)
            d = rate(s + ds, u + ds * c)
            state[i + 1] = u + ds / 6 * (a + 2 * b + 2 * c + d)
        return state

    low, high = 0.0, k / 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if shoot(middle)[-1, 3] > 0.0:
            high = middle
        else:
            low = middle
    state = shoot(0.5 * (low + high))
    return state[:, 0], state[:, 1], state[:, 2]


def period(p: Parameters) -> float:
    """Return period of the first mode."""
    ratio = plate_modulus(p) * HEIGHT**2 / (12.0 * DENSITY * length(p) ** 4)
    return 2.0 * math.pi / (1.8751040687**2 * math.sqrt(ratio))


def scene(p: Parameters) -> Scene:
    """Return the scene: gravity rises slowly, with critical damping of the first mode."""
    dim, h = DIM[p.sim_type], HEIGHT / p.cells
    size = [round(length(p) * p.cells), p.cells]
    sag = math.ceil(1.02 * float(np.max(elastica(load(p), 200)[1])) * size[0])
    counts = [size[0] + MARGIN, size[1] + sag + 2 * MARGIN]
    lower = np.array([0.0, sag + MARGIN])
    points = lattice(p.sim_type, lower * h, (lower + size) * h, [n * p.ppc for n in size], DENSITY)
    c = math.sqrt(pressure_wave_modulus(YOUNG, p.number("nu", 0.0)) / DENSITY)
    t_stop = (RAMP + SETTLE) * period(p)
    steps = math.ceil(t_stop * c / (p.number("cfl", 0.25) * h))
    return Scene(
        p.sim_type,
        [n * h for n in counts],
        counts,
        [Body("beam", points, YOUNG, p.number("nu", 0.0), free_box(dim, {"x_lower": 0}))],
        t_stop,
        t_stop / steps,
        1,
        p.mapping,
        driver=self_weight(
            t_stop,
            gravity(p),
            1.0,
            DENSITY,
            YOUNG,
            p.number("nu", 0.0),
            t_ramp=RAMP * period(p),
            damping=4.0 * math.pi / period(p),
            exact_start=False,
        ),
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return places of columns of points against the elastica, over the length."""
    points, frame = out.scene.bodies[0].points, out.points()[-1]
    x, y, theta = elastica(load(p))
    s = np.linspace(0.0, 1.0, len(x))
    columns = np.unique(np.round(points.x[:, 0], 9))
    middle = np.mean(points.x[:, 1])
    worst = 0.0
    for column in columns:
        chosen = np.abs(points.x[:, 0] - column) < 1e-6
        place = np.mean(frame.x[chosen, :2], axis=0) - [0.0, middle]
        exact = [np.interp(column / length(p), s, x), -np.interp(column / length(p), s, y)]
        worst = max(worst, float(np.hypot(*(place / length(p) - exact))))
    angle = np.interp(column / length(p), s, theta)
    across = frame.x[chosen, :2]
    top, bottom = across[np.argmax(points.x[chosen, 1])], across[np.argmin(points.x[chosen, 1])]
    turned = math.atan2(top[0] - bottom[0], top[1] - bottom[1])
    return {
        "place": worst,
        "sag": -place[1] / length(p) / -exact[1],
        "reach": place[0] / length(p) / exact[0],
        "angle": turned / angle,
        "tip": float(-place[1] / length(p)),
    }


def stiffening(p: Parameters) -> float:
    """Return bending stiffness of the cells over the exact one, see the case of locking; nu = 0."""
    return 1.0 + (1.5 * (1.0 - 1.0 / p.ppc**2) - 1.0) / p.cells**2


def judge(r: Results) -> list[Finding]:
    """Expect the elastica, by linear theory to the stiffness of the cells, beyond to the noise."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells across"
        # E'/(3 kappa G) (H/L)^2 with nu = 0 and kappa = 5/6.
        shear = 0.8 * (HEIGHT / length(p)) ** 2
        expected, margin, why = 1.0, 0.05, "strains of 10 %, stiffness of the cells, and shear"
        if load(p) < 0.5:
            expected = 1.0 / stiffening(p) + shear
            margin, why = 0.015, "stiffness of the cells, and shear"
        elif p.ppc < 3:
            margin, why = 0.15, "noise of crossed node lines at two points a cell: a plateau"
        for name in ("sag", "angle"):
            found = Finding(f"{name} of the tip over the elastica's{end}", m[name])
            found.expected = expected
            found.low, found.high, found.reason = expected - margin, expected + margin, why
            findings.append(found)
        place = Finding(f"largest distance from the elastica over L{end}", m["place"], 0.0)
        place.high, place.reason = (margin + abs(expected - 1.0)) * m["tip"], why
        findings.append(place)
    return findings


CASE = Case(
    family="Hard cases",
    title="Large rotation of a soft beam",
    statement=r"""
A cantilever of height $H$ and length $10H$, $\nu = 0$, hangs down under gravity that rises over
two periods of its first mode, with critical damping, and settles. *Exact*: the elastica under its
own weight $w$ per length, $E' I \theta'' = -w (L - s) \cos\theta$, solved by shooting. With $w
L^3/(E'I) = 3$ the tip sinks by $0.34 L$ and turns by 26 degrees, with 8 by $0.64 L$ and 54
degrees.

*Small load* (0.1): the deflection must be that of bilinear cells, by the law of the case of
locking, and shear. *Large loads* take the points through many cells at strains of some 10 %:
corner averages over boxes that neither grow nor turn have forces with noise. With three points a
cell the beam is within 5 % of the elastica, with two within 15 %, and refinement does not help:
the plateau of stresses under crossed node lines.
""",
    source="Elastica: Euler (1744), with distributed load: Bickley (1934)",
    scene=scene,
    measure=measure,
    judge=judge,
)
