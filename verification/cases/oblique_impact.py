"""A block or a disc hits a plate, or the wall of the grid, at an angle."""

from __future__ import annotations

import numpy as np
from _contact import sums
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

#: Width of the block or diameter of the disc, density, wave speed.
SIZE, DENSITY, SPEED = 1.0, 1000.0, 100.0
FRAMES = 40


class Impact:
    """The numbers of one run, from its parameters."""

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.h = SIZE / p.cells
        self.round = p.text("shape", "block") == "disc"
        self.on_wall = p.text("base", "plate") == "wall"
        self.mu = p.number("mu", 0.3)
        #: Speed towards the plate, and along it over that.
        self.normal = SPEED * p.number("v", 0.005)
        self.slide = self.normal * p.number("slide", 3.0)
        #: Component of the speed along the plate.
        self.along = 2 if p.text("along", "x") == "z" else 0
        #: Thickness of the block in cells: flat blocks do not turn much.
        self.tall = p.cells if self.round else max(2, p.cells // 2)
        #: Cells through the plate.
        self.plate = max(4, p.cells // 2)
        self.gap = 1.0
        # The wall lets go when the wave is back, and then holds the block: look before.
        transits = 1.5 if self.on_wall else p.number("transits", 8.0 if self.round else 5.0)
        self.stop = self.gap * self.h / self.normal + transits * self.tall * self.h / SPEED
        if self.on_wall:
            self.gap = 0.0
            self.stop = transits * self.tall * self.h / SPEED


def scene(p: Parameters) -> Scene:
    """Place a body above a free plate, or on the wall, and let it fly there."""
    run, dim, up, nvel = Impact(p), DIM[p.sim_type], UP[p.sim_type], NVEL[p.sim_type]
    h, nu = run.h, p.number("nu", 0.3 if not run.on_wall else 0.0)
    base = 0 if run.on_wall else run.plate + 3
    run_way = int(np.ceil(run.slide * run.stop / h)) if run.along == 0 else 0
    cells = [2] * dim
    cells[0], cells[up] = p.cells + 6 + run_way, base + run.tall + 4
    lower, counts = [0.0] * dim, [2 * p.ppc] * dim
    upper = [2 * h] * dim
    lower[0], upper[0], counts[0] = 3 * h, (3 + p.cells) * h, p.cells * p.ppc
    lower[up], counts[up] = (base + run.gap) * h, run.tall * p.ppc
    upper[up] = lower[up] + run.tall * h
    velocity = [0.0] * nvel
    velocity[up], velocity[run.along] = -run.normal, run.slide
    if dim == 3:
        cells[1], lower[1], upper[1] = p.cells + 4, 2 * h, 2 * h + SIZE
        counts[1] = p.cells * p.ppc
    points = lattice(p.sim_type, lower, upper, counts, DENSITY, velocity)
    if run.round:
        middle = 0.5 * (np.array(lower) + np.array(upper))
        points = points.keep(np.sum((points.x - middle) ** 2, axis=1) <= 0.25 * SIZE**2)
    young = DENSITY * SPEED**2 / pressure_wave_modulus(1.0, nu)
    bodies, contacts = [Body("body", points, young, nu)], []
    if run.on_wall:
        codes = [-1] * (2 * dim)
        codes[2 * up] = 2
        bodies[0].boundary = (
            'boundary-class = "CartesianBoxCustom"\n'
            f"    boundary-int-props = {{{', '.join(map(str, codes))}, unilateral = 1}}\n"
            f"    boundary-props = {{{run.mu!r}}}"
        )
    else:
        low, high = [h] * dim, [(n - 1) * h for n in cells]
        low[up], high[up] = 3 * h, base * h
        counts = [round((b - a) / h) * p.ppc for a, b in zip(low, high, strict=True)]
        plate = lattice(p.sim_type, low, high, counts, DENSITY)
        bodies.append(Body("plate", plate, young, nu))
        contacts.append(huang("plate", "body", run.mu, int(p.number("normals", 0))))
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        bodies,
        run.stop,
        stable_dt(SIZE, p.cells, SPEED, run.stop, p.number("cfl", 0.3), FRAMES),
        FRAMES,
        p.mapping,
        "implicit" if run.on_wall else p.contact,
        contacts=contacts,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Impulses from the momentum of the body, spin, momentum and energy of both."""
    run, up = Impact(p), UP[p.sim_type]
    mass = out.scene.bodies[0].points.mass
    normals, ratios, totals, energies = [], [], [], []
    count = len(out.scene.bodies)
    for k in range(len(out.points())):
        frames = [out.points(b)[k] for b in range(count)]
        states = [sums(out, b, f) for b, f in enumerate(frames)]
        velocity = states[0].velocity
        normals.append((velocity[up] + run.normal) / run.normal)
        ratios.append((run.slide - velocity[run.along]) / run.normal)
        totals.append(np.sum([s.momentum for s in states], axis=0))
        energies.append(sum(s.kinetic + s.strain for s in states))
    normal, tangential, total = np.array(normals), np.array(ratios), np.array(totals)
    body = frames[0]
    arm = body.x - states[0].centre
    speed = body["velocity"] - states[0].velocity
    turn = mass * (arm[:, up] * speed[:, 0] - arm[:, 0] * speed[:, up])
    spin = np.sum(turn) / np.sum(mass * (arm[:, up] ** 2 + arm[:, 0] ** 2))
    return {
        "normal_impulse": float(normal[-1]),
        "ratio_error": float(np.max(np.abs(tangential - run.mu * normal))),
        "ratio": float(tangential[-1] / normal[-1]),
        "spin": spin * 0.5 * SIZE / (run.mu * run.normal * normal[-1]) if run.mu > 0.0 else 0.0,
        "momentum_error": float(np.max(np.abs(total - total[0])))
        / (np.sum(mass) * max(run.slide, run.normal)),
        "energy_max": float(np.max(energies)) / energies[0],
        "tangential_end": float(tangential[-1]),
    }


def judge(r: Results) -> list[Finding]:
    """Coulomb friction between impulses."""
    findings = []
    for p, m in r:
        run, label = Impact(p), f"{p.cells} cells"
        findings += [
            below(
                f"largest |J_t - mu J_n| over m v_n, {label}",
                m["ratio_error"],
                run.normal / SPEED * m["normal_impulse"],
                "exact while the body slides; the plate's normal turns by about the strain v_n/c",
            ),
            Finding(
                f"J_n over m v_n, {label}",
                m["normal_impulse"],
                0.0 if run.on_wall else 0.3,
                2.0,
                reason="between a plastic impact on a light plate and an elastic one",
            ),
            below(f"largest energy, {label}", m["energy_max"], 1.0 + 1e-3, "no source of energy"),
        ]
        if not run.on_wall:
            findings.append(
                below(f"momentum, {label}", m["momentum_error"], 1e-12, "forces are opposite")
            )
        if run.round and run.mu > 0.0:
            findings.append(
                Finding(
                    f"R omega k^2/(J_t/m), {label}",
                    0.5 * m["spin"],
                    1.0 - 1.0 / (p.cells * run.mu),
                    1.0 + 1.0 / (p.cells * run.mu) + 2.0 / p.cells,
                    1.0,
                    "moment of the friction; its arm is longer than R by at most a cell, and the "
                    "centre of pressure is off by at most half a cell",
                )
            )
    return findings


CASE = Case(
    family="Contact",
    title="Oblique impact with friction",
    statement=r"""
A flat block or a disc hits a free plate, or lies on the wall with friction and moves towards it,
at an angle. No gravity.

**Exact**: while the body slides on the plate, Coulomb friction acts at every node and at every
time, so that the impulses obey $J_t = \mu J_n$, and $v_t' = v_t - \mu(1 + e) v_n m_r/m$ for the
restitution that is measured. The speed along the plate is three times that towards it, so that
sliding lasts. For the disc, the moment of the friction gives $k^2 R\,\omega' = J_t/m$.

**Expected**: exact but for the turn of the plate's normal by its strain, about $v_n/c$; on the
wall, whose normal is fixed, to round-off. The plate is the first body, with `normals=0`. The
speed along the plate can also be that out of the plane (TYPE 5).
""",
    source="Coulomb friction between impulses.",
    scene=scene,
    measure=measure,
    judge=judge,
)
