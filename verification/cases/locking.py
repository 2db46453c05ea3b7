"""A cantilever under gravity, up to incompressible."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import free_box
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import (
    DIM,
    Body,
    Scene,
    lattice,
    pressure_wave_modulus,
    shear_modulus,
    stable_dt,
)

DENSITY, YOUNG, HEIGHT = 1000.0, 1e6, 1.0
#: Cells between the beam and the free faces of the grid.
MARGIN, FRAMES = 2, 40
#: Deflection of the tip over the length; far less than a cell.
DEFLECTION = 1e-3


def poisson(p: Parameters) -> float:
    """Return Poisson's ratio."""
    return p.number("nu", 0.3)


def slenderness(p: Parameters) -> float:
    """Return length over height."""
    return p.number("slenderness", 8)


def plate_modulus(p: Parameters) -> float:
    """Return E' = E/(1 - nu^2), of bending in plane strain."""
    return YOUNG / (1.0 - poisson(p) ** 2)


def stiffening(p: Parameters) -> float:
    """Return the bending stiffness of `cells` cells across the height over the exact one."""
    mean_square = (1.0 - 1.0 / p.ppc**2) / 12.0
    shear = shear_modulus(YOUNG, poisson(p))
    moduli = shear + (shear if p.scheme.smoothing else pressure_wave_modulus(YOUNG, poisson(p)))
    return 1.0 + (12.0 * mean_square * moduli / plate_modulus(p) - 1.0) / p.cells**2


def gravity(p: Parameters) -> float:
    """Return gravity that deflects the tip by DEFLECTION, by the theory of beams."""
    length = slenderness(p) * HEIGHT
    return DEFLECTION * length * plate_modulus(p) * HEIGHT**2 / (1.5 * DENSITY * length**4)


def profile(p: Parameters, x: float) -> tuple[float, float]:
    """Return deflections by bending and by shear at a distance from the wall."""
    length = slenderness(p) * HEIGHT
    load = DENSITY * gravity(p) * HEIGHT
    bending = load * (x**4 - 4.0 * length * x**3 + 6.0 * length**2 * x**2)
    bending /= 24.0 * plate_modulus(p) * HEIGHT**3 / 12.0
    shear = load * (length * x - 0.5 * x**2)
    return bending, shear / (5.0 / 6.0 * shear_modulus(YOUNG, poisson(p)) * HEIGHT)


def frequency(p: Parameters) -> float:
    """Return first angular frequency of the exact beam."""
    ratio = plate_modulus(p) * HEIGHT**2 / (12.0 * DENSITY * (slenderness(p) * HEIGHT) ** 4)
    return 1.8751040687**2 * math.sqrt(ratio)


def scene(p: Parameters) -> Scene:
    """Return the scene: gravity acts at once; one period of the first mode as the cells have it."""
    dim, h = DIM[p.sim_type], HEIGHT / p.cells
    size = [round(slenderness(p) * p.cells), p.cells, 1][:dim]
    lower = np.array([0.0, MARGIN, 0.0][:dim])
    points = lattice(p.sim_type, lower * h, (lower + size) * h, [n * p.ppc for n in size], DENSITY)
    counts = [size[0] + MARGIN, size[1] + 2 * MARGIN, 1][:dim]
    walls = {"x_lower": 0}
    if dim == 3:
        walls |= {"z_lower": 1, "z_upper": 1}
    c = math.sqrt(pressure_wave_modulus(YOUNG, poisson(p)) / DENSITY)
    t_stop = 2.0 * math.pi / (frequency(p) * math.sqrt(stiffening(p)))
    return Scene(
        p.sim_type,
        [n * h for n in counts],
        counts,
        [Body("beam", points, YOUNG, poisson(p), free_box(dim, walls))],
        t_stop,
        stable_dt(h, 1, c, t_stop, p.number("cfl", 0.3), FRAMES),
        FRAMES,
        p.mapping,
        gravity=[0.0, -gravity(p)],
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return mean deflection and frequency of the last column of points, by a fit."""
    points = out.scene.bodies[0].points
    last = points.x[:, 0] > np.max(points.x[:, 0]) - 1e-6
    frames = list(out.points())
    times = np.array([f.time for f in frames])
    tip = -np.array([np.mean(f["displacement"][last, 1]) for f in frames])
    omega = 2.0 * math.pi / times[-1]
    fit = np.zeros(3)
    for _ in range(50):
        sine, cosine = np.sin(omega * times), np.cos(omega * times)
        basis = np.column_stack([np.ones_like(times), sine, cosine])
        fit = np.linalg.lstsq(basis, tip, rcond=None)[0]
        slope = times * (fit[1] * cosine - fit[2] * sine)
        full = np.column_stack([basis, slope])
        change = np.linalg.lstsq(full, tip, rcond=None)[0][3]
        omega += change
        if abs(change) < 1e-12 * omega:
            break
    bending, shear = profile(p, float(np.max(points.x[:, 0])))
    share = fit[0] / (bending + shear)
    return {
        "deflection": share,
        "predicted": (bending / stiffening(p) + shear) / (bending + shear),
        "product": share * (omega / frequency(p)) ** 2,
    }


def judge(r: Results) -> list[Finding]:
    """Expect the deflection that the energy of bilinear cells gives, and its frequency."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells across"
        locked = poisson(p) > 0.4 and not p.scheme.smoothing
        deflection = Finding(f"tip deflection over the exact one{end}", m["deflection"])
        deflection.expected = m["predicted"]
        # The clamp holds back the lateral strain over a length of some H/4, all the more the less
        # volume can change.
        margin = 0.01 + 0.06 * poisson(p) + (0.1 if locked else 0.0)
        if p.scheme.smoothing:
            # H/4 at the clamp makes 4 (1/4)/8 = 1/8 of the deflection; lateral strain that it
            # lacks is all of it for nu = 1/2, and fades over that length.
            margin = 0.01 + poisson(p) / 8.0
        deflection.low = m["predicted"] * (1.0 - margin)
        deflection.high = m["predicted"] * (1.0 + 0.02)
        deflection.reason = "energy of bilinear cells, see statement; margin: clamp"
        bending, shear = profile(p, slenderness(p) * HEIGHT)
        rayleigh = Finding(f"deflection times frequency squared, over exact{end}", m["product"])
        rayleigh.expected = bending / (bending + shear)
        rayleigh.low, rayleigh.high = 0.94 * rayleigh.expected, 1.02 * rayleigh.expected
        rayleigh.reason = "one stiffness for both; 6 %: rotary inertia, filter, shape of the mode"
        findings += [deflection, rayleigh]
        if locked and poisson(p) > 0.495 and p.cells <= 4:
            lost = Finding(f"locked: tip deflection over the exact one{end}", m["deflection"], 0.0)
            lost.high, lost.reason = 0.25, "a reference that does not lock gives 1"
            findings.append(lost)
    if len(r.measures) > 2 and poisson(r.first) < 0.1:
        errors = [abs(1.0 - value) for value in r.column("deflection")]
        slope = float(np.log2(errors[0] / errors[1]))
        order = Finding("order of the tip deflection", slope, 1.5, 2.6)
        order.expected, order.reason = 2.0, "stiffening of order (h/H)^2"
        findings.append(order)
    return findings


CASE = Case(
    family="Hard cases",
    title="Locking of a cantilever up to incompressible",
    statement=r"""
A cantilever of height $H$ and length $8H$ in plane strain swings under its weight; the deflection
of the tip is a thousandth of the length. *Reference*: theory of beams with $E' = E/(1-\nu^2)$ and
shear, for which Poisson's ratio matters little: 1 throughout.

The scheme sees the strains of bilinear cells at its points. With the exact curvature $\kappa$
such a cell has the strains $\kappa y$ along the beam, its middle's lateral strain only, and a
shear strain $\kappa (x - x_c)$ that should not be. Its energy over the exact one, with $n$ points
a cell and direction and $M = \lambda + 2G$, makes the beam stiffer by

$$1 + \left[\left(1 - \frac{1}{n^2}\right)\frac{M + G}{E'} - 1\right]\left(\frac{h}{H}\right)^2$$

For $\nu = 0.3$ that is a correction of second order. For $\nu \to 1/2$ the modulus $M$ grows
without bound: with 4 cells across and two points the deflection falls to 0.65 at $\nu = 0.49$ and
to 0.17 at $\nu = 0.499$, **volumetric locking**; a single point a cell does not lock, and is too
soft instead. The deflection, the mean of a swing, must agree with that, and with the frequency of
the swing.

With *smoothed volumes* (`smoothing`) the points of a cell have one change of volume. Of the strain
$\kappa(y - y_c)$ its deviator is left, $\pm\kappa(y - y_c)/2$ along and across, so that $G$ takes
the place of $M$: no locking at any $\nu$, and a beam a little too soft, by
$[1 - (1 - 1/n^2)(1 - \nu)]\,(h/H)^2$.
""",
    source="Energy of bilinear cells derived here; theory of beams: Timoshenko",
    scene=scene,
    measure=measure,
    judge=judge,
)
