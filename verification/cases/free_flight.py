"""Free flight and free fall of stress-free bodies through many cells."""

from __future__ import annotations

import numpy as np
from _freebodies import ALL_DIGITS, EPS, directions, free_faces, join, upward
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import (
    DIM,
    NVEL,
    UP,
    Array,
    Body,
    Points,
    Scene,
    lattice,
    pressure_wave_modulus,
    section,
)

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
MODULUS = pressure_wave_modulus(YOUNG, POISSON)
WAVE_SPEED = float(np.sqrt(MODULUS / DENSITY))
#: Cells from the middle of the grid to where the flights begin, by directions of the grid.
RING = {1: 3, 2: 16, 3: 7}
#: Cells that falling bodies fall in addition to their flight.
FALL = 4.0
#: Velocity out of the plane over that in the plane, TYPE 5.
OUT_OF_PLANE = 0.7


def speed(p: Parameters) -> float:
    """Return speed of the flights; `cells` is the number of cells on their way."""
    return p.number("speed", 10.0) * WAVE_SPEED


def duration(p: Parameters) -> float:
    """Return time of the flights."""
    return p.cells * SPACING / speed(p)


def steps(p: Parameters) -> int:
    """Return at most 0.23 cells and a Courant number of 0.2 a step."""
    stride = min(0.23, 0.2 * p.number("speed", 10.0))
    return int(np.ceil(p.cells / stride))


def gravity(p: Parameters) -> float:
    """Return acceleration that makes the bodies fall by FALL cells."""
    return p.number("gravity", 0) * 2.0 * FALL * SPACING / duration(p) ** 2


def ring(p: Parameters) -> int:
    """Return the radius of the ring; wider functions need more room between the bodies."""
    wider = {"quadratic": 3, "cubic": 6}.get(p.mapping, 0) if DIM[p.sim_type] > 1 else 1
    return RING[DIM[p.sim_type]] + wider


def half_width(p: Parameters) -> int:
    """Return cells from the middle of the grid to its faces."""
    return ring(p) + p.cells + 4 + int(p.number("gravity", 0) * FALL)


def flights(p: Parameters) -> list[Points]:
    """Return small bodies on a ring, each with a velocity outwards, so that none meet."""
    if p.sim_type == 4:
        ways = [(r, way) for r in (0, 5) for way in directions(4)]
    else:
        ways = [(half_width(p), way) for way in directions(p.sim_type)]
    middle = half_width(p)
    size = 1 if p.sim_type == 3 else 2
    parts = []
    for first, way in ways:
        start = np.full(DIM[p.sim_type], float(middle))
        start[0] = first
        corner = np.round(start + ring(p) * way)
        velocity = np.zeros(NVEL[p.sim_type])
        velocity[: len(way)] = speed(p) * way
        if p.sim_type == 5:
            velocity[2] = OUT_OF_PLANE * speed(p)
        if p.number("single", 0):
            lower, counts = corner + 0.37, [1] * len(way)
            upper = lower + 1.0 / p.ppc
        else:
            lower, upper, counts = corner, corner + size, [size * p.ppc] * len(way)
        parts.append(
            lattice(p.sim_type, lower * SPACING, upper * SPACING, counts, DENSITY, list(velocity))
        )
    return parts


def scene(p: Parameters) -> Scene:
    """Return the scene: one body of many parts that fly apart in a grid without walls."""
    dim, n = DIM[p.sim_type], 2 * half_width(p)
    counts = [12 if p.sim_type == 4 and d == 0 else n for d in range(dim)]
    # On the axis of TYPE 4 the radial velocity is 0; all other faces are free.
    boundary = free_faces(p)
    body = Body("flights", join(flights(p)), YOUNG, POISSON, boundary)
    fall = upward(p.sim_type, -gravity(p))
    t_stop = duration(p)
    return Scene(
        p.sim_type,
        [count * SPACING for count in counts],
        counts,
        [body],
        t_stop,
        t_stop / steps(p),
        frames=2,
        mapping=p.mapping,
        driver=section("UserDefinedGravityDriver", [t_stop, *fall]),
        digits=ALL_DIGITS,
    )


def exact(p: Parameters, points: Points, t: float, dt: float) -> tuple[Array, Array]:
    """Return displacement and velocity of symplectic Euler: t (t + dt)/2 in place of t^2/2."""
    fall = upward(p.sim_type, -gravity(p))
    return points.velocity * t + 0.5 * fall * t * (t + dt), points.velocity + fall * t


def measure(p: Parameters, out: Output) -> Measures:
    """Return largest deviations over all points and frames after the first."""
    points, dt, n = out.scene.bodies[0].points, out.scene.dt, NVEL[p.sim_type]
    worst = dict.fromkeys(["position", "velocity", "stress", "volume", "spare"], 0.0)

    def note(name: str, deviation: Array | float) -> None:
        worst[name] = max(worst[name], float(np.max(np.abs(deviation), initial=0.0)))

    frames = list(out.points())
    for frame in frames[1:]:
        u, v = exact(p, points, frame.time, dt)
        moved = frame.x[:, : DIM[p.sim_type]] - points.x
        note("position", (moved - u[:, : DIM[p.sim_type]]) / SPACING)
        note("position", (frame["displacement"][:, :n] - u) / SPACING)
        note("velocity", (frame["velocity"][:, :n] - v) / speed(p))
        note("spare", frame["displacement"][:, n:])
        note("spare", frame["velocity"][:, n:])
        note("stress", frame["cauchy_stress"] / MODULUS)
        note("volume", frame["volume"] / frames[0]["volume"] - 1.0)
    lost = sum(float(np.sum(frame["active"] != 1.0)) for frame in frames)
    signature = 1.0
    if gravity(p) > 0.0:
        t = frames[-1].time
        fallen = points.velocity * t - frames[-1]["displacement"][:, :n]
        late = fallen[:, UP[p.sim_type]] - 0.5 * gravity(p) * t**2
        signature = float(np.mean(late)) / (0.5 * gravity(p) * t * dt)
    return {**worst, "lost": lost, "signature": signature}


def bounds(p: Parameters) -> dict[str, float]:
    """Return the round-off of sums over the points of a node, added up over the way."""
    dim, way, slow = DIM[p.sim_type], p.cells, 1.0 / p.number("speed", 10.0)
    width = {"ugimp": 3, "quadratic": 3, "cubic": 4}.get(p.mapping, 2)
    terms = (width * p.ppc) ** dim + 2
    scale = 1.0 + (OUT_OF_PLANE if p.sim_type == 5 else 0.0)
    stress = 2 * dim * terms * EPS * way * scale
    velocity = stress * min(way * slow**2, 4.0 * slow) + 4 * EPS * (1 + steps(p) * (gravity(p) > 0))
    position = EPS * (steps(p) * 2 * half_width(p) + terms * way) + velocity * way
    return {"stress": stress, "volume": stress, "velocity": velocity, "position": position}


def judge(r: Results) -> list[Finding]:
    """Expect all deviations are round-off, and the fall shows the scheme's g t dt/2."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells"
        for name, bound in bounds(p).items():
            findings.append(below(f"{name} error{end}", m[name], bound, "round-off, see statement"))
        findings.append(below(f"points lost{end}", m["lost"], 0.0, "no path leaves the grid"))
        findings.append(
            below(f"components that the TYPE lacks{end}", m["spare"], 0.0, "they are never written")
        )
        if gravity(p) > 0.0:
            margin = bounds(p)["position"] * SPACING / (0.5 * gravity(p) * duration(p)) * steps(p)
            findings.append(
                near(
                    f"(fall - g t^2/2)/(g t dt/2){end}",
                    m["signature"],
                    1.0,
                    margin / duration(p),
                    "x = v t + g t (t + dt)/2 exactly; round-off of positions",
                )
            )
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Free flight and free fall",
    statement=r"""
Small bodies without stress fly apart from a ring, along all axes, diagonals and directions in
between (TYPE 4: along the axis, one of them around it), each through as many cells as the
resolution says; with `gravity` they fall by 4 cells besides. With `single` each body is a single
point. *Exact*: a rigid translation. The velocity stays what it was, stress and change of volume
are 0, and positions are $x_0 + v t + g\,t (t + \Delta t)/2$: symplectic Euler has $t (t + \Delta
t)$ in place of $t^2$, the signature of the scheme.

*Bounds.* A nodal velocity is a quotient of sums of $m = (2n)^d + 2$ terms with $n$ points a cell
and direction, so it is off by at most $m \epsilon v$, and the velocity gradient by $2 d m
\epsilon v/h$. Over a way of $D$ cells that adds up to a strain of $2 d m \epsilon D$. The stress
from it accelerates points by $c^2/h$ times the strain for a time $D h/v$; in slow flight the body
vibrates instead, with $c$ times the strain. Positions take one rounding a step besides. Any
gradient that does not sum to 0, or weight that does not sum to 1, is off by many orders of
magnitude.
""",
    source="Elementary; estimates of round-off",
    scene=scene,
    measure=measure,
    judge=judge,
)
