"""A block on an incline: sticking, sliding, stopping, sinking."""

from __future__ import annotations

import math

import numpy as np
from _contact import contact_normal
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import (
    DIM,
    NVEL,
    UP,
    Body,
    Scene,
    huang,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)

#: Width of the block, density, wave speed, cells of the slab below.
WIDTH, DENSITY, SPEED, SLAB = 1.0, 1000.0, 100.0, 3
FRAMES = 60


class Incline:
    """The numbers of one run, from its parameters."""

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.h = WIDTH / p.cells
        #: `slip`, `stick`, `stop` (no slope, with a speed at the start) or `sink` (no slope).
        self.motion = p.text("motion", "slip")
        #: Slope.
        flat = self.motion in ("stop", "sink")
        self.angle = math.radians(0.0 if flat else p.number("angle", 30.0))
        #: Coefficient of friction, given as it is or times tan(angle).
        self.mu = p.number("mu", 0.3)
        if "ratio" in p.options:
            self.mu = p.number("ratio", 1.0) * math.tan(self.angle)
        #: The block lies on a `slab` or on the `wall` of the grid.
        self.on_wall = p.text("base", "slab") == "wall"
        self.height = p.number("height", 1.0)
        #: Component along the slope.
        self.along = 2 if p.text("along", "x") == "z" else 0
        #: Time of the run in transits H/c.
        self.transits = p.number("transits", 400.0)
        self.stop = self.transits * WIDTH / SPEED
        #: Gravity: rho g H/M is about the strain of the block by its own weight.
        self.strain = p.number("strain", 4.0 / self.transits**2 * 0.4)
        self.gravity = self.strain * SPEED**2 / WIDTH
        #: Speed at the start.
        self.start = p.number("start", 0.0) * self.gravity * self.stop
        if self.motion == "stop":
            self.start = 0.5 * self.mu * self.gravity * self.stop
        #: Cells below the block.
        self.base = 0 if self.on_wall else SLAB

    @property
    def pull(self) -> float:
        """Acceleration of the rigid block over g while it slides downwards."""
        return math.sin(self.angle) - self.mu * math.cos(self.angle)

    @property
    def acceleration(self) -> float:
        """Acceleration of the rigid block over g at late times."""
        return 0.0 if self.motion in ("stick", "stop", "sink") else self.pull

    @property
    def travel(self) -> float:
        """Length of the way down."""
        if self.motion == "stop":
            return 0.5 * self.start * self.stop
        return self.start * self.stop + 0.5 * max(0.0, self.pull) * self.gravity * self.stop**2

    @property
    def bounce(self) -> float:
        """Bound of the vertical speed of the centre of mass, over g T.

        Weight that acts suddenly makes a column of height H swing: the base force is a triangle
        between 0 and twice the weight, so that the speed stays below g cos(a) H/(2c). The slab
        adds its height and the contact a cell; with free sides the wave speed is sqrt(E/(1 - nu^2)
        rho), 0.9 c for nu = 0.3, and a little less with bulging.
        """
        height = self.height + (self.base + 1) * self.h
        return 0.5 * math.cos(self.angle) * height / WIDTH / (0.85 * self.transits)


def scene(p: Parameters) -> Scene:
    """Place a block, at rest or with a speed, on a slab or on a wall with friction."""
    run, dim, up = Incline(p), DIM[p.sim_type], UP[p.sim_type]
    h, nu = run.h, p.number("nu", 0.3)
    tall = round(run.height / h)
    cells = [2] * dim
    cells[0] = p.cells + 6 + (math.ceil(run.travel / h) if run.along == 0 else 0)
    cells[up] = run.base + tall + 3
    lower, upper, counts = [0.0] * dim, [2 * h] * dim, [2 * p.ppc] * dim
    lower[0], upper[0], counts[0] = 3 * h, 3 * h + WIDTH, p.cells * p.ppc
    lower[up], upper[up], counts[up] = run.base * h, (run.base + tall) * h, tall * p.ppc
    if dim == 3:
        cells[1] = p.cells + 4
        lower[1], upper[1], counts[1] = 2 * h, 2 * h + WIDTH, p.cells * p.ppc
    velocity, gravity = [0.0] * NVEL[p.sim_type], [0.0] * NVEL[p.sim_type]
    velocity[run.along] = run.start
    gravity[run.along] = run.gravity * math.sin(run.angle)
    gravity[up] = -run.gravity * math.cos(run.angle)
    young = DENSITY * SPEED**2 / pressure_wave_modulus(1.0, nu)
    block = Body("block", lattice(p.sim_type, lower, upper, counts, DENSITY, velocity), young, nu)
    bodies, contacts = [block], []
    if run.on_wall:
        codes = [-1] * (2 * dim)
        codes[2 * up] = 2
        block.boundary = (
            'boundary-class = "CartesianBoxCustom"\n'
            f"    boundary-int-props = {{{', '.join(map(str, codes))}, unilateral = 1}}\n"
            f"    boundary-props = {{{run.mu!r}}}"
        )
    else:
        top = [n * h for n in cells]
        top[up] = SLAB * h
        counts = [n * p.ppc for n in cells]
        counts[up] = SLAB * p.ppc
        points = lattice(p.sim_type, [0.0] * dim, top, counts, DENSITY)
        bodies.append(Body("slab", points, young, nu, "CartesianBox"))
        pair = ("block", "slab") if p.text("first", "slab") == "block" else ("slab", "block")
        contacts.append(huang(*pair, run.mu, int(p.number("normals", 0))))
    cfl = p.number("cfl", 0.3)
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        bodies,
        run.stop,
        stable_dt(WIDTH, p.cells, SPEED, run.stop, cfl, FRAMES),
        FRAMES,
        p.mapping,
        "implicit" if run.on_wall else p.contact,
        gravity,
        contacts=contacts,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Motion of the centre of mass."""
    run, up = Incline(p), UP[p.sim_type]
    mass = out.scene.bodies[0].points.mass
    mass = mass / np.sum(mass)
    times, speeds, ways = [], [], []
    for frame in out.points():
        times.append(frame.time)
        speeds.append(mass @ frame["velocity"])
        ways.append(mass @ frame["displacement"][:, run.along])
    t, v, way = np.array(times), np.array(speeds), np.array(ways)
    down, normal = v[:, run.along], v[:, up]
    g, scale = run.gravity, run.gravity * run.stop
    late = t >= 0.5 * run.stop
    # J_t = mu J_n, with the impulses from the momentum of the block.
    tangential = run.start + g * math.sin(run.angle) * t - down
    normal_impulse = g * math.cos(run.angle) * t + normal
    # Twice the static displacement of the centre of mass by its weight, M instead of E.
    settlement = g * math.cos(run.angle) * run.height**2 / (2 * SPEED**2)
    measures = {
        "acceleration": float(np.polyfit(t[late], down[late], 1)[0]) / g,
        "acceleration_error": float(np.polyfit(t[late], down[late], 1)[0]) / g - run.acceleration,
        "impulse_error": float(np.max(np.abs(tangential - run.mu * normal_impulse))) / scale,
        "bounce": float(np.max(np.abs(normal))) / scale,
        "creep": float(way[-1] - way[np.argmax(late)]) / settlement,
        "way": float(way[-1]),
        "reverse": float(max(0.0, -np.min(down))) / scale,
        "late_speed": float(np.max(np.abs(down[t > 0.6 * run.stop]))) / scale,
    }
    if run.motion == "stop":
        measures["stop_way"] = float(way[-1]) / (0.25 * run.start * run.stop)
        early = t <= 0.45 * run.stop
        measures["braking"] = -float(np.polyfit(t[early], down[early], 1)[0]) / (run.mu * g)
    if not run.on_wall:
        measures |= measure_base(run, out, t, way, normal)
    return measures


def measure_base(
    run: Incline, out: Output, t: np.ndarray, way: np.ndarray, normal: np.ndarray
) -> Measures:
    """Tilt of the contact normals, and the sinking speed that the nodes' masses allow."""
    pair = ("block", "slab") if run.p.text("first", "slab") == "block" else ("slab", "block")
    up = UP[run.p.sim_type]
    block, slab = out.nodes(0)[-1], out.nodes(1)[-1]
    normals = contact_normal(slab, *pair)
    there = np.linalg.norm(normals, axis=1) > 0.5
    tilt = np.degrees(np.arccos(np.clip(np.abs(normals[there, up]), 0.0, 1.0)))
    both = (block["mass"] > 0.0) & (slab["mass"] > 0.0)
    reduced = np.sum(
        block["mass"][both] * slab["mass"][both] / (block["mass"] + slab["mass"])[both]
    )
    weight = np.sum(out.scene.bodies[0].points.mass) * run.gravity
    sinking = weight * out.scene.dt / reduced
    late = t >= 0.5 * run.stop
    return {
        "tilt": float(np.max(tilt)),
        "sinking": -float(np.mean(normal[late])) / sinking,
        "sinking_speed": -float(np.mean(normal[late])) / (run.gravity * run.stop),
    }


def judge(r: Results) -> list[Finding]:
    """Compare every run with the rigid block."""
    findings = []
    for p, m in r:
        findings += judge_run(Incline(p), m, f"{p.cells} cells")
    return findings


def judge_run(run: Incline, m: Measures, label: str) -> list[Finding]:
    """Compare one run with the rigid block."""
    p = run.p
    findings = []
    if p.contact == "implicit":
        findings.append(
            below(f"vertical speed/gT, {label}", m["bounce"], run.bounce, "swing of the column")
        )
    if int(p.number("normals", 0)) == 1 and not run.on_wall:
        return findings + judge_corner(run, m, label)
    # A straight line through a bounded disturbance e over a time T/2 is off by 6 e/T at most.
    margin = 6.0 * max(run.mu, 0.01) * run.bounce
    if run.motion in ("slip", "stick"):
        low, high = run.acceleration - margin, run.acceleration + margin
        findings.append(
            Finding(
                f"a/g, {label}",
                m["acceleration"],
                low,
                high,
                run.acceleration,
                "g (sin a - mu cos a), or 0; margin: slope of mu times the vertical swing",
            )
        )
    if run.motion == "stick" and p.contact == "implicit":
        findings.append(
            below(
                f"creep in the second half/settlement, {label}",
                abs(m["creep"]),
                0.1,
                "rest; what remains of the shear oscillation, at the start 2 settlements large",
            )
        )
    if run.motion == "slip" and run.start > 0.0:
        findings.append(
            below(
                f"J_t - mu J_n over m g T, {label}",
                m["impulse_error"],
                run.strain,
                "exact while all nodes slide; the slab's normal turns by about the strain",
            )
        )
    if run.motion == "stop":
        findings += judge_stop(run, m, label)
    if run.motion == "sink":
        findings.append(
            Finding(
                f"sinking speed over m g dt/m_nodes, {label}",
                m["sinking"],
                0.95,
                1.05,
                1.0,
                "explicit contacts are dashpots: each step takes m_nodes v, and the weight "
                "gives m g dt; 5 %: the block sinks into more mass, and its edges",
            )
        )
    return findings


def judge_stop(run: Incline, m: Measures, label: str) -> list[Finding]:
    """Compare a block that brakes on a plane with v0/(mu g) and v0^2/(2 mu g)."""
    swing = run.strain * SPEED / (run.gravity * run.stop) * 2.0
    return [
        Finding(
            f"braking over mu g, {label}",
            m["braking"],
            1.0 - 8.0 * run.bounce,
            1.0 + 8.0 * run.bounce,
            1.0,
            "rigid block; slope of the vertical swing over 0.45 T",
        ),
        Finding(
            f"way over v0^2/(2 mu g), {label}",
            m["stop_way"],
            0.98,
            1.02,
            1.0,
            "rigid block; 2 %: vertical swing, and shear that is released when it stops",
        ),
        below(
            f"speed after the stop/gT, {label}",
            m["late_speed"],
            swing,
            "no reversal: elastic swing of mu g H/c_s at most",
        ),
    ]


def judge_corner(run: Incline, m: Measures, label: str) -> list[Finding]:
    """Averaged normals turn at the front corner of the block, which holds it.

    There the mass of the block gives a normal between 45 and atan 2 n degrees from the vertical
    (the points in front reach the node with the gradient 4 n w/h, and 2 w/h across). The average
    with the slab's is turned by half of that: a step of more than 22.5 degrees at every node.
    """
    steepest = 0.5 * math.degrees(math.atan(2.0 * run.p.ppc))
    return [
        Finding(
            f"largest tilt of a normal in degrees, {label}",
            m["tilt"],
            22.5,
            steepest + 1.0,
            math.nan,
            "half of the angle of the block's own normal at its front corner",
        ),
        Finding(
            f"a/g, {label}",
            m["acceleration"],
            -0.05,
            0.1 * run.pull,
            0.0,
            "slopes below 22.5 degrees are held even without friction",
        ),
    ]


CASE = Case(
    family="Contact",
    title="A block on an incline",
    statement=r"""
An elastic block lies on a slab (through `ContactHuang`) or on the wall of the grid (friction,
`CartesianBoxCustom` code 2). Gravity is tilted by $\alpha$, not the grid, and acts suddenly at $t
= 0$.

**Exact** (rigid block): at rest for $\mu > \tan\alpha$, else $a = g(\sin\alpha - \mu\cos\alpha)$;
on a plane it stops after $v_0/(\mu g)$ and $v_0^2/(2\mu g)$ and does not turn back. While all of
the base slides, the impulses obey $J_t = \mu J_n$ exactly, whatever waves run through the block.

**Measured**: the slope of the velocity of the centre of mass over the second half of the run; the
ratio of the impulses; creep. The weight makes the block swing vertically with at most
$gH\cos\alpha/(2c)$, which bounds the error of the slope: a bounded disturbance $e$ turns a line
fitted over $T/2$ by at most $6e/T$. The transition is bracketed by $\mu = 0.98$ and
$1.02\,\tan\alpha$, with blocks of few cells and 1200 transits $H/c$, after which the method has
damped the swing.

- `normals=0` with the slab as first body: the normal is vertical up to the strain of the slab;
  all answers are those of the rigid block.
- `normals=1` (averaged): the mass of the block gives a normal of more than 45 degrees from the
  vertical at the nodes in front of its sharp corner, and the average with the slab's is turned by
  22.5 degrees or more. The block meets a step at every node and is held on slopes below that,
  even without friction. This asserts what the rule does; use the flat body's normal for blocks on
  planes.
- Explicit contact (`motion=sink`): a dashpot, see *Two bars collide*. A block at rest on a plane
  sinks with $m g \Delta t/\sum m_1 m_2/(m_1 + m_2)$ over the shared nodes.
""",
    source="Coulomb friction of a rigid block. Set-up after the incline problems of Bardenhagen "
    "et al., CMES 2 (2001) 509-522, and Huang et al., Int. J. Numer. Meth. Engng 85 "
    "(2011) 498-517; their numbers are not at hand.",
    scene=scene,
    measure=measure,
    judge=judge,
)
