"""Steady flow of grains down a chute: the profile of Bagnold."""

from __future__ import annotations

import math

import numpy as np
from _sand import DENSITY, GRAIN_DENSITY, GRAVITY, Sand
from harness.case import Case, Finding, Measures, Output, Parameters, Published, Results, below
from harness.frames import Frame
from harness.scene import Body, Scene, lattice, section, stable_dt
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Depth of the bed, depth over diameter of the grains.
HEIGHT, GRAINS = 1.0, 10.0
#: Modulus over the pressure at the floor, as if the bed were level: strains of 1e-3.
STIFFNESS = 1000.0
#: Cells along the flow, and above the bed; frames, and those at the end that are averaged.
ALONG, ABOVE, FRAMES, LATE = 2, 2, 20, 5
#: Parts of a cell for the exact integral.
PARTS = 1000
#: First zero of the Bessel function J of order -1/3.
ZERO = 1.8663508


class Chute:
    """The numbers of one run, from its parameters."""

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.h = HEIGHT / p.cells
        self.degrees = p.number("theta", 25.0)
        self.angle = math.radians(self.degrees)
        #: Modulus over rho g H.
        self.stiffness = p.number("stiffness", STIFFNESS)
        self.sand = Sand.under(HEIGHT, self.stiffness, HEIGHT / GRAINS)
        slope = math.tan(self.angle)
        #: Inertial number of the steady flow, the same at every depth.
        self.inertial = self.sand.i_0 * (slope - self.sand.mu_s) / (self.sand.mu_2 - slope)
        #: rho g cos(theta): the pressure grows by it with depth.
        self.weight = DENSITY * GRAVITY * math.cos(self.angle)
        #: Part of the steady velocity at the start.
        self.start = p.number("start", 1.0)
        #: Time of the run in units of that in which a disturbance falls to 1/e.
        self.times = p.number("times", 5.0)

    @property
    def factor(self) -> float:
        """Factor of H^1.5 - (H - y)^1.5 in the velocity."""
        return (
            2.0 / 3.0 * self.inertial / self.sand.diameter * math.sqrt(self.weight / GRAIN_DENSITY)
        )

    def velocity(self, y: Array) -> Array:
        """Return the steady velocity of Bagnold."""
        return self.factor * (HEIGHT**1.5 - np.maximum(HEIGHT - y, 0.0) ** 1.5)

    @property
    def relaxation(self) -> float:
        """Time in which the slowest small disturbance of the steady flow falls to 1/e.

        dv/dt = d/ds (K sqrt(s) dv/ds), s = H - y, v = 0 at the floor: s^(1/4) J_(-1/3)(k s^(3/4)).
        """
        sand, i = self.sand, self.inertial
        slope = (sand.mu_2 - sand.mu_s) * sand.i_0 / (sand.i_0 + i) ** 2
        k = sand.diameter * slope * math.sqrt(self.weight * GRAIN_DENSITY) / DENSITY
        return HEIGHT**1.5 / (k * (0.75 * ZERO) ** 2)

    def rate(self, y: Array) -> Array:
        """Return the shear rate of steady flow when grains are elastic.

        T_yy is the weight of what lies above, and T_xy that times tan(theta). The elastic part
        turns with the spin, T_yy = -p - tau^2/G, so that p is less than the weight.
        """
        weight = self.weight * (HEIGHT - y)
        shear = math.tan(self.angle) * weight
        pressure = weight - shear**2 / self.sand.shear_modulus
        friction, sand = shear / pressure, self.sand
        inertial = sand.i_0 * (friction - sand.mu_s) / (sand.mu_2 - friction)
        return inertial / sand.diameter * np.sqrt(pressure / GRAIN_DENSITY)

    def steps(self, parts: int) -> Array:
        """Return the steady velocities of the nodes from the floor up.

        With linear functions a cell has one shear rate, and one pressure, for its points see the
        same strains: those of its middle, one part. With many parts a cell it is the integral.
        """
        y = (np.arange(parts * self.p.cells) + 0.5) * self.h / parts
        return np.concatenate([[0.0], np.cumsum(self.rate(y)) * self.h / parts])[::parts]


def scene(p: Parameters) -> Scene:
    """Return a bed with a multiple of its steady velocity, periodic along the flow."""
    run = Chute(p)
    cells = [ALONG, p.cells + ABOVE]

    def velocity(x: Array) -> Array:
        return np.column_stack([run.start * run.velocity(x[:, 1]), np.zeros(len(x))])

    counts = [ALONG * p.ppc, p.cells * p.ppc]
    upper = [ALONG * run.h, HEIGHT]
    points = lattice(2, [0.0, 0.0], upper, counts, DENSITY, velocity)
    boundary = 'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {3, 3, 0, -1}'
    sand = run.sand
    t_stop = run.times * run.relaxation
    law = [sand.mu_s, sand.mu_2, sand.i_0, sand.diameter, GRAIN_DENSITY]
    bed = [HEIGHT, run.degrees, DENSITY / GRAIN_DENSITY]
    driver = section("ChuteFlowDriver", [t_stop, GRAVITY, *law, *bed], (), ["chute.csv"])
    return Scene(
        2,
        [n * run.h for n in cells],
        cells,
        [Body("bed", points, 1.0, 0.0, boundary, sand.material())],
        t_stop,
        stable_dt(HEIGHT, p.cells, sand.wave_speed, t_stop, 0.4, FRAMES),
        FRAMES,
        p.mapping,
        driver=driver,
        periodic=(True, False),
    )


def profile(run: Chute, frame: Frame) -> Array:
    """Return the velocities of the nodes at x = 0 below the surface, from the floor up."""
    there = (np.abs(frame.x[:, 0]) < 0.1 * run.h) & (frame.x[:, 1] < HEIGHT + 0.1 * run.h)
    order = np.argsort(frame.x[there, 1])
    return frame["velocity"][there, 0][order]


def measure(p: Parameters, out: Output) -> Measures:
    """Compare nodal velocities, averaged over the last frames, with the steady flow."""
    run, nodes = Chute(p), out.nodes()
    shown = [profile(run, nodes[k]) for k in range(len(nodes) - LATE, len(nodes))]
    found, last = np.mean(shown, axis=0), shown[-1]
    y = np.arange(p.cells + 1) * run.h
    part = np.full(p.cells + 1, run.h)
    part[[0, -1]] *= 0.5
    exact = run.velocity(y)

    def norm(difference: Array) -> float:
        return math.sqrt(part @ difference**2 / (part @ exact**2))

    table = np.loadtxt(out.folder / "chute.csv", delimiter=",", skiprows=1)
    told = table[-1, 2] / math.sqrt(part @ exact**2 * ALONG * run.h)
    points = out.points()[-1]
    measures = {
        "e_v_l2": norm(found - exact),
        "e_elastic": norm(found - run.steps(PARTS)),
        "surface_velocity": found[-1],
        "mean": part @ found / HEIGHT,
        "change": norm(shown[-1] - shown[0]),
        "sinking": float(np.max(np.abs(points["displacement"][:, 1]))) / HEIGHT,
        "mach": found[-1] / run.sand.wave_speed,
    }
    if p.mapping == "linear":
        measures["e_discrete"] = norm(found - run.steps(1))
        measures["told"] = told - norm(last - exact)
    return measures


def judge(r: Results) -> list[Finding]:
    """Compare with Bagnold's profile, and with the steady state of the discrete equations."""
    findings = []
    run = Chute(r.first)
    #: What is left of the difference at the start.
    left = math.exp(-run.times) * max(abs(1.0 - run.start), 0.01)
    for p, m in r:
        label = f"{p.cells} cells"
        if p.mapping == "linear":
            findings.append(
                below(
                    f"difference to the discrete steady state, {label}",
                    m["e_discrete"],
                    left + 1.0 / run.stiffness,
                    "what is left of the start (0.01 at least at its beginning), and the elastic "
                    "strain at the floor, by which the bed sinks",
                )
            )
            findings.append(
                below(
                    f"difference that the driver tells less ours, {label}",
                    abs(m["told"]),
                    1e-7,
                    "the same norm of the same nodes; single nodes near 0 lose digits in frames",
                )
            )
        if p.cells >= 20:
            findings.append(
                below(
                    f"difference to Bagnold's profile, {label}",
                    m["e_v_l2"],
                    0.02,
                    "2 % from 20 cells on: (h/s)² of the shear rates at the depth s, and elastic "
                    "strains",
                )
            )
    if len(r.measures) > 2 and run.stiffness > STIFFNESS:
        findings.append(
            Finding(
                "order of the difference to the steady flow of elastic grains",
                r.order("e_elastic"),
                1.35,
                2.15,
                1.5,
                "rule of the midpoint: h² where the shear rate is smooth, h^(3/2) at the surface, "
                "where it is the square root of the depth",
            )
        )
    return findings


def published(r: Results) -> list[Published]:
    """Return surface and mean velocity of Bagnold's profile."""
    run = Chute(r.first)
    scale = math.sqrt(GRAVITY * HEIGHT)
    surface = float(run.velocity(np.array([HEIGHT]))[0]) / scale
    source = "MiDi 2004"
    m = r.measures[-1]
    return [
        Published("surface velocity/sqrt(gH)", source, surface, m["surface_velocity"] / scale),
        Published(
            "mean over surface velocity", source, 0.6, m["mean"] / HEIGHT / m["surface_velocity"]
        ),
    ]


CASE = Case(
    family="Granular",
    title="Grains flow down a chute",
    statement=r"""
A bed of grains, $H$ deep, flows down a rough slope of the angle $\theta$ (`ChuteFlowDriver`,
`Sand_SachithLocal`, TYPE 2, periodic along the slope). *Exact* steady state of the local
$\mu(I)$ law: the inertial number is the same at every depth, $\mu(I) = \tan\theta$, and

$$v(y) = \frac{2I}{3d}\sqrt{\phi g\cos\theta}\,\left(H^{3/2} - (H - y)^{3/2}\right), \qquad
I = I_0\,\frac{\tan\theta - \mu_s}{\mu_2 - \tan\theta},$$

the profile of Bagnold; its mean is 3/5 of its surface velocity. $H = 10\,d$, $\phi = 0.6$,
$\mu_s = 0.3819$, $\mu_2 = 0.6435$, $I_0 = 0.279$ (glass beads). The sand is softer than grains
are: $M = 1000\,\rho g H$ or `stiffness` times that weight, so that elastic strains are below 0.001
and waves 30 times as fast as the flow or more.

The bed starts with the pressure of rest and `start` times the exact velocity, 1 unless told, and
runs for 5 (or `times`) times $H^{3/2}/(1.96\,K)$, $K = d\,\mu'(I)\sqrt{g\cos\theta/\phi}$, in
which the slowest disturbance falls to 1/e: it solves $\dot v = (K\sqrt{s}\,v')'$, a Bessel
function of order $-1/3$ of $s^{3/4}$ with $s = H - y$.

Measured: the difference of nodal velocities, averaged over the last quarter of the run, to the
exact ones in the $L_2$ norm, over the norm of these.

Expected with linear functions: the points of a cell share strains, so that it has one shear rate
and one pressure (at its density the bed opens in the first motion, and gets its pressure anew).
The **discrete steady state** is then Bagnold's shear rate in the middle of each cell, and the
program must find it to the elastic strain at the floor. The elastic stress turns with the spin,
which makes $p$ less than the weight by $\tau^2/G$ and the flow faster, by 0.4 % at
$M = 1000\,\rho gH$; with `stiffness=10000`, where this is small, the distance to the exact flow
must fall with order 1.5 (next to the surface) to 2.
""",
    source="MiDi, Eur. Phys. J. E 14 (2004) 341-365; constants of Jop, Forterre and Pouliquen, "
    "Nature 441 (2006) 727-730; discrete steady state and relaxation derived here",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_v_l2",
    order=1.5,
)
