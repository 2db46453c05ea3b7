"""A suspension of grains that settles in a closed vessel."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from harness.case import (
    Case,
    Finding,
    Measures,
    Output,
    Parameters,
    Published,
    Results,
    below,
)
from harness.scene import NVEL, UP, Body, Scene, lattice, section
from harness.scheme import Scheme

HEIGHT, GRAVITY = 0.2, 9.81
#: Densities, diameter of the grains, viscosity of the fluid, packing at the start and of the bed.
GRAIN, WATER, DIAMETER, VISCOSITY, PACKING, BED = 2500.0, 1000.0, 0.002, 0.01, 0.3, 0.585
#: Young's modulus of the grains, bulk modulus of the fluid.
STIFFNESS, BULK = 1e5, 5e4
POROSITY = 1.0 - PACKING
#: Velocity of the grains in the suspension, downwards, and of the surface of the bed, upwards.
DRAG = 180.0 * PACKING**2 * VISCOSITY / (POROSITY * DIAMETER**2)
SLIP = POROSITY * PACKING * (GRAIN - WATER) * GRAVITY / DRAG
FALL = POROSITY * SLIP
RISE = PACKING * FALL / (BED - PACKING)
#: Time at which the surface of the bed meets the upper end of the suspension.
MEETING = HEIGHT / (FALL + RISE)
#: What the fluid expands by as the grains leave it, and that over the share of the height that
#: grains fall.
EXPANSION = PACKING * (GRAIN - WATER) * GRAVITY * HEIGHT / BULK
COMPRESSION = EXPANSION * HEIGHT / (MEETING * FALL)
#: Speed of waves, at most, in the bed: of grains, and of fluid and grains past each other.
SOUND = math.sqrt(
    1.35 * STIFFNESS / (BED * GRAIN) + BULK / WATER + BULK * BED / ((1.0 - BED) * GRAIN)
)
FRAMES = 20


@dataclass
class Liquid(Body):
    """A body that starts under the pressure which carries the grains as well."""

    def section(self, scheme: Scheme) -> str:
        """Return the section of the config."""
        mixture = PACKING * GRAIN + POROSITY * WATER
        sign = -1.0 if self.points.sim_type == 1 else 1.0
        load = f"properties = {{{sign * GRAVITY!r}, {mixture!r}}}"
        return super().section(scheme).replace('"DefaultBody"', f'"HydrostaticBody"\n    {load}', 1)


def scene(p: Parameters) -> Scene:
    """Return grains and fluid in a column with some cells above it."""
    up, h = UP[p.sim_type], HEIGHT / p.cells
    dim = up + 1
    cells = [3] * dim
    cells[up] = p.cells
    size = [n * h for n in cells]
    counts = [n * p.ppc for n in cells]
    cells[up] += 2
    sand = lattice(p.sim_type, [0.0] * dim, size, counts, PACKING * GRAIN)
    water = lattice(p.sim_type, [0.0] * dim, size, counts, POROSITY * WATER)
    codes = ", ".join(["1"] * (2 * dim - 1) + ["-1"])
    boundary = f'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {{{codes}}}'
    grains = (
        'material-class = "SlurryGranularPhase"\n'
        f"    material-props = {{{STIFFNESS!r}, 0.3, 0.3819, 0.6435, 1.23, 0.3085, 0.6, 0.0, "
        f"{BED!r}, {GRAIN!r}, {VISCOSITY!r}, {DIAMETER!r}, {WATER!r}}}\n"
        '    material-str-props = {"water"}'
    )
    fluid = (
        'material-class = "SlurryFluidPhase"\n'
        f"    material-props = {{{BULK!r}, {VISCOSITY!r}, {GRAIN!r}}}\n"
        '    material-str-props = {"sand"}'
    )
    mixture = "contact\n" + section(
        "SlurryMixture",
        [GRAIN, DIAMETER, VISCOSITY, WATER],
        (),
        ["sand", "water", "USE_CARMAN_KOZENY"],
    )
    t_stop = MEETING
    steps = FRAMES * math.ceil(t_stop * SOUND / (FRAMES * 0.4 * h))
    gravity = [0.0] * NVEL[p.sim_type]
    gravity[up] = -GRAVITY
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        [
            Body("sand", sand, 1.0, 0.0, boundary, grains),
            Liquid("water", water, 1.0, 0.0, boundary, fluid),
        ],
        t_stop,
        t_stop / steps,
        FRAMES,
        p.mapping,
        gravity=gravity,
        contacts=[mixture.replace("{", '{\n    name = "mixture"', 1) + "\n"],
    )


def centre(t: float) -> float:
    """Return the height of the centre of the grains at a time before MEETING."""
    return 0.5 * HEIGHT - FALL * t + 0.5 * FALL * (FALL + RISE) * t**2 / HEIGHT


def measure(p: Parameters, out: Output) -> Measures:
    """Return velocities in the suspension, errors of the centre and of the upper end."""
    up, dt, h = UP[p.sim_type], out.scene.dt, HEIGHT / p.cells
    start = out.scene.bodies[0].points.x[:, up]
    sand, water = list(out.points(0)), out.points(1)
    a, b = FRAMES // 10, 2 * FRAMES // 5
    first, second = sand[a], sand[b]
    time = second.time - first.time
    # Grains and fluid that are in the suspension all this time, far from both fronts.
    inside = (start > 0.5 * HEIGHT) & (start < 0.7 * HEIGHT)
    fall = float(np.mean(first.x[inside, up] - second.x[inside, up])) / time
    wet, later = water[a], water[b]
    inside_fluid = (wet.x[:, up] > 0.3 * HEIGHT) & (wet.x[:, up] < 0.6 * HEIGHT)
    rise = float(np.mean(later.x[inside_fluid, up] - wet.x[inside_fluid, up])) / time
    # Points start with the velocity of half a step before.
    centres = [float(np.mean(f.x[:, up])) - centre(f.time - 0.5 * dt) for f in sand]
    ends = [
        float(np.max(f.x[:, up])) + 0.5 * h / p.ppc - HEIGHT + FALL * (f.time - 0.5 * dt)
        for f in sand[: FRAMES // 2 + 1]
    ]
    packing = second["packing_fraction"][inside]
    return {
        "e_centre": max(map(abs, centres[: 9 * FRAMES // 10 + 1])) / HEIGHT,
        "fall": fall / FALL - 1.0,
        "rise": rise / (FALL * PACKING / POROSITY) - 1.0,
        "end": max(map(abs, ends)) / h,
        "packing_spread": float(np.std(packing)) / PACKING,
    }


def judge(r: Results) -> list[Finding]:
    """Expect the velocities of the suspension, and fronts as sharp as cells."""
    findings = []
    for p, m in r:
        fall = Finding(f"velocity of the grains over exact less 1, {p.cells} cells", m["fall"])
        fall.low, fall.high, fall.expected = -COMPRESSION, COMPRESSION, 0.0
        fall.reason = (
            "exact in a fluid that does not expand: by 1.8 % as the grains leave it, over the "
            "share of the height that they fall"
        )
        findings.append(fall)
        rise = Finding(f"velocity of the fluid over exact less 1, {p.cells} cells", m["rise"])
        if p.mapping != "linear":
            margin = COMPRESSION * POROSITY / PACKING
            rise.low, rise.high, rise.expected = -margin, margin, 0.0
            rise.reason = "as that of the grains, times (1 - packing)/packing, their ratio"
        findings.append(rise)
        centre_error = below(
            f"error of the centre of the grains over the height, {p.cells} cells",
            m["e_centre"],
            2.0 / p.cells,
            "a cell for each of the two fronts",
        )
        findings.append(centre_error)
        reach = 1.0 if p.mapping == "linear" else 2.0
        end = below(
            f"error of the upper end in cells, {p.cells} cells",
            m["end"],
            reach,
            "as far as the functions of a node reach, in which grains see clear fluid",
        )
        findings.append(end)
    return findings


def published(r: Results) -> list[Published]:
    """Return the velocities of the suspension beside the exact ones."""
    last = r.measures[-1]
    source = "exact: law of Carman 1937"
    back = FALL * PACKING / POROSITY
    return [
        Published("velocity of the grains [m/s]", source, FALL, FALL * (1.0 + last["fall"])),
        Published("velocity of the fluid [m/s]", source, back, back * (1.0 + last["rise"])),
    ]


CASE = Case(
    family="Fluid",
    title="Grains that settle in a fluid",
    statement=r"""
A suspension of sand, $\varphi = 0.3$ of the volume, in a viscous fluid fills a closed vessel to the
height $H = 0.2$ m and settles: `SlurryGranularPhase` and `SlurryFluidPhase` with `SlurryMixture`
and the drag of Carman and Kozeny. The fluid starts under the pressure that carries the grains.

*Exact*: no volume flows through a level, so that the fluid rises with $\varphi/n$ times the
velocity of the grains, $n = 1 - \varphi$, and drag balances buoyant weight where the grains fall
with

$$v_s = \frac{n^3 (\rho_s - \rho_f) g d^2}{180\,\varphi\,\eta} = 0.0374\ \mathrm{m/s}.$$

The upper end of the suspension falls with $v_s$, the surface of the bed, packed to $\varphi_m =
0.585$, rises with $w = \varphi v_s/(\varphi_m - \varphi)$ (Kynch): the centre of the grains is at
$\frac12 H - v_s t + \frac12 v_s (v_s + w)t^2/H$ until both meet at $H/(v_s + w) = 2.6$ s, when each
run ends.

Measured: mean velocities of grains that stay in the suspension, and of fluid there, from 0.1 to 0.4
of that time; the largest error of the centre before 0.9 of it; that of the foremost point of the
upper end, in cells, up to one half.

The velocities do not depend on the resolution, but for the compression of the fluid: its pressure
falls by $\varphi (\rho_s - \rho_f) g H$ at the floor, 1.8 % of the bulk modulus, and the fluid that
expands carries the grains up. The fronts are as sharp as cells: the bound of the centre is of
**first order**. With linear functions the points of the fluid drift by the noise of their pressure,
by a tenth and more of the fluid's velocity, which is told and not judged; with 40 cells it throws a
point out of the free surface and ends the run, so that the matrix has these functions with 20 cells
only. Cubic functions do not show it.
""",
    source=(
        "Kynch, Trans. Faraday Soc. 48 (1952) 166-176; Carman, Trans. IChemE 15 (1937) 150-166; "
        "equations of the mixture: Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764"
    ),
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_centre",
    order=1.0,
)
