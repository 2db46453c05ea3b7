"""A disc, or a sphere, on an incline: rolling and sliding."""

from __future__ import annotations

import math

import numpy as np
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import (
    DIM,
    UP,
    Body,
    Scene,
    huang,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)

#: Radius, density, wave speed, cells of the slab below.
RADIUS, DENSITY, SPEED, SLAB = 1.0, 1000.0, 100.0, 3
#: rho g R/M, about the strain by the weight.
STRAIN = 2e-3
#: Gap at the start in cells: about that at which the contact carries the weight.
GAP = 0.75
#: Frames, a number that does not make the many nodes of TYPE 3 dear.
FRAMES = 40


class Roll:
    """The numbers of one run, from its parameters."""

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.h = RADIUS / p.cells
        self.mu = p.number("mu", 0.6)
        self.angle = math.radians(p.number("angle", 30.0))
        #: Moment of inertia over m R^2.
        self.k2 = 0.4 if p.sim_type == 3 else 0.5
        self.gravity = STRAIN * SPEED**2 / RADIUS
        self.rolls = math.tan(self.angle) <= (1.0 + 1.0 / self.k2) * self.mu
        self.distance = p.number("distance", 5.0) * RADIUS
        self.stop = math.sqrt(2.0 * self.distance / (self.rigid()[0] * self.gravity))

    def rigid(self, gap: float = 0.0) -> tuple[float, float]:
        """Return acceleration over g and angular acceleration times R/g of the rigid body.

        With a gap the body rolls on a radius R + gap, and friction has that arm.
        """
        sine, cosine, arm = math.sin(self.angle), math.cos(self.angle), 1.0 + gap / RADIUS
        if self.rolls:
            a = sine / (1.0 + self.k2 / arm**2)
            return a, a / arm
        return sine - self.mu * cosine, self.mu * cosine * arm / self.k2


def scene(p: Parameters) -> Scene:
    """Place a body at rest a little above a slab; gravity is tilted."""
    run, dim, up = Roll(p), DIM[p.sim_type], UP[p.sim_type]
    h, nu = run.h, p.number("nu", 0.3)
    middle = [(2 + p.cells) * h] * dim
    middle[0], middle[up] = (3 + p.cells) * h, (SLAB + p.cells + GAP) * h
    cells = [2 * p.cells + 4] * dim
    cells[0] = 2 * p.cells + 6 + math.ceil(1.15 * run.distance / h)
    cells[up] = 2 * p.cells + SLAB + 4
    box = lattice(
        p.sim_type,
        [x - RADIUS for x in middle],
        [x + RADIUS for x in middle],
        [2 * p.cells * p.ppc] * dim,
        DENSITY,
    )
    points = box.keep(np.sum((box.x - np.array(middle)) ** 2, axis=1) <= RADIUS**2)
    top, counts = [n * h for n in cells], [n * p.ppc for n in cells]
    top[up], counts[up] = SLAB * h, SLAB * p.ppc
    slab = lattice(p.sim_type, [0.0] * dim, top, counts, DENSITY)
    young = DENSITY * SPEED**2 / pressure_wave_modulus(1.0, nu)
    gravity = [0.0] * dim
    gravity[0] = run.gravity * math.sin(run.angle)
    gravity[up] = -run.gravity * math.cos(run.angle)
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        [Body("body", points, young, nu), Body("slab", slab, young, nu, "CartesianBox")],
        run.stop,
        stable_dt(RADIUS, p.cells, SPEED, run.stop, p.number("cfl", 0.3), FRAMES),
        FRAMES,
        p.mapping,
        p.contact,
        gravity,
        contacts=[huang("slab", "body", run.mu, int(p.number("normals", 0)))],
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Accelerations and the ratio of rolling, over the last two thirds of the time."""
    run, up = Roll(p), UP[p.sim_type]
    mass = out.scene.bodies[0].points.mass
    rows = []
    for frame in out.points():
        centre = mass @ frame.x / np.sum(mass)
        velocity = mass @ frame["velocity"] / np.sum(mass)
        arm, speed = frame.x - centre, frame["velocity"] - velocity
        inertia = np.sum(mass * (arm[:, 0] ** 2 + arm[:, up] ** 2))
        spin = np.sum(mass * (arm[:, up] * speed[:, 0] - arm[:, 0] * speed[:, up])) / inertia
        gap = centre[up] - SLAB * run.h - RADIUS
        rows.append([frame.time, centre[0], velocity[0], spin, gap])
    t, way, speed, spin, gap = np.array(rows).T
    late = t >= run.stop / 3.0
    height = float(np.mean(gap[late]))
    a, alpha = run.rigid()
    turn = float(np.sum(0.5 * (spin[late][1:] + spin[late][:-1]) * np.diff(t[late])))
    measured_a = float(np.polyfit(t[late], speed[late], 1)[0]) / run.gravity
    measured_alpha = float(np.polyfit(t[late], spin[late], 1)[0]) * RADIUS / run.gravity
    exact_a, exact_alpha = run.rigid(height)
    return {
        "a": measured_a / a,
        "a_error": abs(measured_a / a - 1.0),
        "alpha": measured_alpha / alpha if alpha > 0.0 else 0.0,
        "a_lifted": measured_a / exact_a,
        "alpha_lifted": measured_alpha / exact_alpha if alpha > 0.0 else 0.0,
        "gap": height / run.h,
        "rolling": turn * (RADIUS + height) / float(way[late][-1] - way[late][0]),
        "way": float(way[-1] - way[0]) / run.distance,
    }


def judge(r: Results) -> list[Finding]:
    """Compare with the rigid body."""
    findings = []
    for p, m in r:
        run, label = Roll(p), f"{p.cells} cells"
        coarse = 0.5 / p.cells
        # Rolling: creep and arm; sliding: the moment of pressure that is off by up to h/2.
        turned = 0.75 / p.cells if run.rolls else 0.5 / (p.cells * max(run.mu, 0.1))
        kind = "rolling" if run.rolls else "sliding"
        findings += [
            near(
                f"a over that of the rigid body, {kind}, {label}",
                m["a"],
                1.0,
                max(0.02, coarse),
                "error of order h/R: the body floats at the height of the contact; "
                "5 % at 10 cells per radius",
            ),
            Finding(
                f"height of the contact/h, {label}",
                m["gap"],
                0.0,
                0.875,
                math.nan,
                "no overlap; contact begins when the lowest points reach the slab's top nodes, "
                "0.875 cells above them for 2 points a cell",
            ),
        ]
        if run.mu > 0.0:
            findings.append(
                near(
                    f"angular acceleration over that of the rigid body, {kind}, {label}",
                    m["alpha_lifted"],
                    1.0,
                    max(0.02, turned),
                    "radius and arm R + height of the contact, errors of order h/R; sliding: "
                    "centre of pressure within h/2",
                )
            )
        if run.rolls:
            findings += [
                near(
                    f"a with rolling radius R + height, {label}",
                    m["a_lifted"],
                    1.0,
                    max(0.02, 0.25 / p.cells),
                    "the stick is at the slab's top nodes, below the body",
                ),
                below(
                    f"|1 - omega (R + height)/v|, {label}",
                    abs(1.0 - m["rolling"]),
                    0.2 / math.sqrt(p.cells),
                    "creep: points that enter are sheared by up to h/4 before they stick, over "
                    "a length of contact of 2 sqrt(2 R d), d about 0.3 h",
                ),
            ]
    if len(r.cells) > 1 and Roll(r.first).rolls:
        findings.append(
            Finding(
                "order of |a/a_exact - 1|",
                r.order("a_error"),
                0.6,
                reason="first order: height of the contact over R",
                expected=1.0,
            )
        )
    return findings


CASE = Case(
    family="Contact",
    title="A disc or a sphere on an incline",
    statement=r"""
A disc (TYPE 2, 5) or a sphere (TYPE 3) on a slab; gravity is tilted by $\alpha$.

**Exact** (rigid body, $k^2 = 1/2$ or $2/5$): rolling for $\tan\alpha \le (1 + 1/k^2)\mu$ with $a
= g\sin\alpha/(1 + k^2)$ and $\omega R = v$; else sliding with $a = g(\sin\alpha - \mu\cos\alpha)$
and $\dot\omega = \mu g\cos\alpha/(k^2 R)$.

**Measured**: slopes of velocity and spin over the last two thirds of the run (the sudden weight
makes the disc bounce, so that single instants tell nothing), and the way rolled over the way
travelled.

**Expected**: the contact acts at the slab's uppermost nodes and carries the body at a height
$\delta$ of a fraction of a cell above them, where it touches with a small weight. It therefore
rolls on the radius $R + \delta$: $a = g\sin\alpha/(1 + k^2 R^2/(R + \delta)^2)$, 4 % more at 10
cells per radius, of first order in $h/R$. With the measured $\delta$ the acceleration must agree
to 2 %. Points that enter the contact are sheared by up to $h/4$ before they stick, over a contact
of length $2\sqrt{2 R d}$ with $d \approx 0.3 h$: a creep $1 - \omega(R + \delta)/v$ of up to
$0.2\sqrt{h/R}$. The centre of pressure is uncertain by a fraction of a cell, which turns a
sliding disc with a moment of that times the weight.
""",
    source="Rigid-body mechanics; the creep and the rolling radius: own derivation. Problem of "
    "Huang et al., Int. J. Numer. Meth. Engng 85 (2011) 498-517 and Bardenhagen et al., "
    "CMES 2 (2001) 509-522; their numbers are not at hand.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="a_error",
    order=1.0,
)
