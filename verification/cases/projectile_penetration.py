"""A ball falls on grains: how deep it goes."""

from __future__ import annotations

import math

import numpy as np
from _sand import DENSITY, GRAVITY, POISSON, RestingBody, Sand
from harness.case import Case, Finding, Measures, Output, Parameters, Published, Results
from harness.scene import Body, Scene, huang, lattice, pressure_wave_modulus, stable_dt

#: Diameter of the ball, radius and depth of the bed, air above it, in diameters.
DIAMETER, RADIUS, DEPTH, AIR = 1.0, 4.0, 6.0, 2.5
#: Cells a diameter where something else is refined.
COARSE = 6
#: Modulus of the sand over rho g D; Courant number; friction between ball and sand.
STIFFNESS, CFL, RUBBING = 5000.0, 0.3, 0.3819
#: Time of the run over sqrt(D/g), frames.
TIMES, FRAMES = 4.0, 40
#: Prefactor of the depth over (rho_b/rho)^(1/2) D^(2/3) H^(1/3), times the friction.
PREFACTOR, SOURCE = 0.14, "Uehara et al. 2003"


class Impact:
    """The numbers of one run, from its parameters."""

    def __init__(self, p: Parameters) -> None:
        #: What is refined: cells a diameter, or the height of the fall in diameters, or the
        #: density of the ball over that of the bed.
        vary = p.text("vary", "size")
        self.cells = p.cells if vary == "size" else COARSE
        self.fall = p.cells if vary == "fall" else p.number("fall", 2.0)
        self.density = p.cells if vary == "density" else p.number("density", 2.0)
        self.vary = vary
        self.h = DIAMETER / self.cells
        self.sand = Sand.under(DIAMETER, STIFFNESS, 0.02 * DIAMETER)
        self.speed = math.sqrt(2.0 * GRAVITY * self.fall * DIAMETER)

    def depth(self, total: float) -> float:
        """Return the published depth over D for a total drop height over D."""
        friction = self.sand.mu_s
        return PREFACTOR / friction * math.sqrt(self.density) * total ** (1.0 / 3.0)


def scene(p: Parameters) -> Scene:
    """Return a bed in a can, and a ball that touches it and moves down."""
    run, n = Impact(p), p.ppc
    cells = [round(k * run.cells) for k in (RADIUS, DEPTH + AIR)]
    top = DEPTH * DIAMETER
    counts = [cells[0] * n, round(DEPTH * run.cells) * n]
    bed = lattice(4, [0.0, 0.0], [RADIUS * DIAMETER, top], counts, DENSITY)
    # A cell of air: contact begins, and bodies stay apart, where both reach the same node.
    centre = top + 0.5 * DIAMETER + run.h
    size = run.cells // 2 + 1
    box = lattice(
        4,
        [0.0, centre - size * run.h],
        [size * run.h, centre + size * run.h],
        [size * n, 2 * size * n],
        run.density * DENSITY,
        [0.0, -run.speed, 0.0],
    )
    ball = box.keep(np.hypot(box.x[:, 0], box.x[:, 1] - centre) < 0.5 * DIAMETER)
    exact = run.density * DENSITY * DIAMETER**3 / 12.0
    ball.mass[:] = ball.volume * exact / float(np.sum(ball.volume * ball.x[:, 0]))
    walls = 'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {1, 1, 0, -1}'
    sand = RestingBody("sand", bed, 1.0, 0.0, walls, run.sand.material(), surface=0.5 * run.h / n)
    # Waves as fast as those of the sand.
    young = run.sand.modulus * run.density / pressure_wave_modulus(1.0, POISSON)
    t_stop = TIMES * math.sqrt(DIAMETER / GRAVITY)
    speed = run.sand.wave_speed + run.speed
    return Scene(
        4,
        [k * run.h for k in cells],
        cells,
        [sand, Body("ball", ball, young, POISSON, walls)],
        t_stop,
        stable_dt(DIAMETER, run.cells, speed, t_stop, CFL, FRAMES),
        FRAMES,
        p.mapping,
        gravity=[0.0, -GRAVITY],
        contacts=[huang("ball", "sand", RUBBING, 0)],
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return the deepest place of the ball, and when it was there."""
    run = Impact(p)
    ball = out.scene.bodies[1].points
    mass = ball.total_mass / np.sum(ball.total_mass)
    times, ways, speeds = [], [], []
    for frame in out.points(1):
        times.append(frame.time)
        ways.append(-float(mass @ frame["displacement"][:, 1]))
        speeds.append(-float(mass @ frame["velocity"][:, 1]))
    depth = max(ways)
    total = run.fall + depth / DIAMETER
    return {
        "depth": depth / DIAMETER,
        "total": total,
        "law": run.depth(total),
        "stop": times[int(np.argmax(ways))] / math.sqrt(DIAMETER / GRAVITY),
        "last": ways[-1] / DIAMETER,
        "speed": speeds[-1] / run.speed,
    }


def exponent(r: Results) -> float:
    """Return that of the depth in the total height of the fall, or in the density of the ball.

    In rows that vary the density the height follows the depth: it is divided out as H^(1/3).
    """
    depth, total = np.array(r.column("depth")), np.array(r.column("total"))
    if Impact(r.first).vary == "density":
        return float(np.polyfit(np.log(r.cells), np.log(depth / total ** (1.0 / 3.0)), 1)[0])
    return float(np.polyfit(np.log(total), np.log(depth), 1)[0])


def judge(r: Results) -> list[Finding]:
    """Compare exponents and depths with the law of Uehara et al."""
    findings = []
    vary = Impact(r.first).vary
    for p, m in r:
        label = f"{p.cells} " + {"size": "cells", "fall": "D", "density": "rho"}[vary]
        findings.append(
            Finding(
                f"depth over that of the law, {label}",
                m["depth"] / m["law"],
                0.5,
                2.0,
                1.0,
                "the prefactor of the law is from memory, holds for dry beads with the tangent of "
                "the angle of repose as friction, and changes with walls: a factor of 2",
            )
        )
        findings.append(
            Finding(
                f"speed at the end over that of the impact, {label}",
                m["speed"],
                -0.05,
                0.05,
                0.0,
                "at rest",
            )
        )
    if len(r.measures) > 1 and vary == "fall":
        findings.append(
            Finding(
                "exponent of the depth in the total height",
                exponent(r),
                1.0 / 3.0 - 0.07,
                1.0 / 3.0 + 0.07,
                1.0 / 3.0,
                "Uehara et al.; 0.07: what experiments over a decade scatter",
            )
        )
    if len(r.measures) > 1 and vary == "density":
        findings.append(
            Finding(
                "exponent of the depth in the density, the height divided out",
                exponent(r),
                0.4,
                0.6,
                0.5,
                "Uehara et al.; 0.1 by the published scatter",
            )
        )
    if len(r.measures) > 1 and vary == "size":
        a, b = r.column("depth")[-2:]
        findings.append(
            Finding(
                "change of the depth in the last refinement",
                b / a - 1.0,
                -0.15,
                0.15,
                0.0,
                "the ball meets the bed within a cell, a sixth of D or less",
            )
        )
    return findings


def published(r: Results) -> list[Published]:
    """Return exponents, or the depth where the grid is refined."""
    vary = Impact(r.first).vary
    if vary == "size" or len(r.measures) == 1:
        m = r.measures[-1]
        return [Published("depth/D", SOURCE, m["law"], m["depth"])]
    names = {"fall": ("height of the fall", 1.0 / 3.0), "density": ("density of the ball", 0.5)}
    name, value = names[vary]
    return [Published(f"exponent of the depth in the {name}", SOURCE, value, exponent(r))]


CASE = Case(
    family="Granular",
    title="A ball falls on grains",
    statement=r"""
A ball of the diameter $D$ and the density $\rho_b$ meets a bed of dry sand with the speed
$\sqrt{2gh}$ and goes down to the depth $d$ (TYPE 4, `Sand_SachithLocal` with $\mu_s = 0.3819$,
contact with friction; can of radius $4D$ and depth $6D$, pressure of rest at the start).
Experiments with beads give

$$d = \frac{0.14}{\mu}\left(\frac{\rho_b}{\rho}\right)^{1/2} D^{2/3} H^{1/3}, \qquad H = h + d$$

(Uehara et al. 2003; the exponents are read in its abstract, the prefactor is from memory).
Dunatunga and Kamrin (2017) calculate such impacts with this material.

Measured: the deepest place of the ball's centre of mass below that of its first contact, within
$4\sqrt{D/g}$. Contact begins when both bodies reach the same node, and keeps them a cell apart: the
ball starts a cell above the bed and is in contact at once.

- `vary=fall`: the resolution is that of the height, $h/D$ from 1 to 10, with 6 cells a diameter;
  expected is the exponent 1/3 ± 0.07.
- `vary=density`: it is that of $\rho_b/\rho$; expected is the exponent 1/2 ± 0.1.
- else cells a diameter, with $h = 2D$, $\rho_b = 2\rho$: depths within a factor of 2 of the law.

The sand is softer than grains are: $M = 5000\,\rho gD$, so that waves are 16 times as fast as the
fastest ball and more.
""",
    source="Uehara, Ambroso, Ojha and Durian, Phys. Rev. Lett. 90 (2003) 194301; Dunatunga and "
    "Kamrin, J. Mech. Phys. Solids 100 (2017) 45-60",
    scene=scene,
    measure=measure,
    judge=judge,
)
