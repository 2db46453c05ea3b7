"""A shear flow that viscosity brings to rest."""

from __future__ import annotations

import math

import numpy as np
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import Body, Scene, lattice

HEIGHT, DENSITY, VISCOSITY = 1.0, 1000.0, 10.0
K = math.pi / HEIGHT
#: nu k**2, and the time in which the flow falls to 1/e.
RATE = VISCOSITY / DENSITY * K**2
TIME = 1.0 / RATE
#: nu dt/h**2.
DIFFUSION = 0.02
#: Displacement of the fastest points, over the spacing of the coarsest grid: none changes its cell.
SHIFT = 0.01
#: Component of the velocity that flows, by TYPE.
ALONG = {2: 0, 5: 2}


def scene(p: Parameters) -> Scene:
    """Return a fluid between smooth walls; in TYPE 2 periodic along the flow."""
    h = HEIGHT / p.cells
    cells = [2, p.cells]
    along = ALONG[p.sim_type]
    speed = SHIFT * RATE * HEIGHT / 8

    def velocity(x: np.ndarray) -> np.ndarray:
        v = np.zeros((len(x), 2 if p.sim_type == 2 else 3))
        v[:, along] = speed * np.cos(K * x[:, 1])
        return v

    points = lattice(
        p.sim_type,
        [0.0, 0.0],
        [2 * h, HEIGHT],
        [n * p.ppc for n in cells],
        DENSITY,
        velocity=velocity,
    )
    steps = 2 * math.ceil(0.5 * TIME / (DIFFUSION * h**2 * DENSITY / VISCOSITY))
    # Sound is no faster than viscosity diffuses over the coarsest cells.
    bulk = DENSITY * (VISCOSITY / DENSITY / (HEIGHT / 8)) ** 2
    fluid = (
        f'material-class = "BarotropicViscousFluid"\n    material-props = {{{bulk}, {VISCOSITY}}}'
    )
    walls = "3, 3" if p.sim_type == 2 else "1, 1"
    boundary = f'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {{{walls}, 1, 1}}'
    return Scene(
        p.sim_type,
        [2 * h, HEIGHT],
        cells,
        [Body("fluid", points, 1.0, 0.0, boundary, fluid)],
        TIME,
        TIME / steps,
        2,
        p.mapping,
        periodic=(True, False) if p.sim_type == 2 else (),
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return the rate of decay between half of the time and its end, and the flow across."""
    points, frames = out.scene.bodies[0].points, out.points()
    along = ALONG[p.sim_type]
    shape = np.cos(K * points.x[:, 1])
    sizes = [float(np.sum(frame["velocity"][:, along] * shape)) for frame in frames]
    across = max(float(np.max(np.abs(frame["velocity"][:, 1]))) for frame in frames)
    rate = math.log(sizes[1] / sizes[2]) / (0.5 * TIME)
    return {
        "e_rate": abs(rate / RATE - 1.0),
        "rate": rate / RATE - 1.0,
        "across": across / (sizes[0] / float(np.sum(shape**2))),
    }


def judge(r: Results) -> list[Finding]:
    """Expect the error of lumped mass, of second order, and no flow across."""
    findings = []
    for p, m in r:
        kh = K * HEIGHT / p.cells
        kappa = 1.0 / 8.0 + 1.0 / (24.0 * p.ppc**2)
        expected = -2.0 * kappa * kh**2
        finding = Finding(f"rate of decay over nu k² less 1, {p.cells} cells", m["rate"])
        # The next terms of the series, and those of the step: nu k² dt of order one.
        margin = kh**4 + 2.0 * DIFFUSION * kh**2
        finding.low, finding.high, finding.expected = expected - margin, expected + margin, expected
        finding.reason = "forces act at half a cell, and lumped mass filters them"
        findings.append(finding)
        calm = Finding(f"velocity across over that along, {p.cells} cells", m["across"])
        calm.low, calm.high, calm.reason = 0.0, 1e-3, "shear has no pressure"
        findings.append(calm)
    if len(r.measures) > 1:
        order = Finding("order of the rate of decay", r.order("e_rate"), 1.9, 2.1, 2.0)
        order.reason = "second order: dt falls with h²"
        findings.append(order)
    return findings


CASE = Case(
    family="Fluid",
    title="Shear flow that viscosity brings to rest",
    statement=r"""
A Newtonian fluid between two smooth walls at $y = 0$ and $H$ moves with $A\cos(ky)$, $k = \pi/H$,
along $x$ (TYPE 2, periodic) or out of the plane (TYPE 5), so slowly that no point comes to another
cell. *Exact*: $A\cos(ky)\,e^{-\nu k^2 t}$, $\nu = \eta/\rho$; no pressure and no flow across.

Measured: the rate of decay between $t = 1/(2\nu k^2)$ and $1/(\nu k^2)$, by projection on the
cosine.

Expected: **second order**, with the error of lumped mass that waves have, twice since it is the
square of a frequency: $-2\kappa(kh)^2$, $\kappa = 1/8 + 1/(24n^2)$ for $n$ points a cell. The step
is $\nu\,dt = 0.02\,h^2$, so that its error is small beside that.
""",
    source="Batchelor, An Introduction to Fluid Dynamics (1967), 4.3; error law derived here",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_rate",
    order=2.0,
)
