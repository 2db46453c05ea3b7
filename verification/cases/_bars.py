"""Two elastic bars that collide: scene, measures and theory for the cases that share them."""

from __future__ import annotations

import math

import numpy as np
from _contact import Lumped, contact_force, contact_gap, sums
from harness.case import Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import (
    DIM,
    NVEL,
    Body,
    Points,
    Scene,
    huang,
    lattice,
    pressure_wave_modulus,
    stable_dt,
)
from harness.theory import filter_constant

#: Length, density and wave speed of bar 1.
LENGTH, DENSITY, SPEED = 1.0, 1000.0, 100.0
FRAMES = 100
#: Gap at the start beyond that at which contact begins, in cells.
APPROACH = 0.25
#: 1 - e of two bars by a small separate code, with linear functions averaged over whole domains
#: (CPDI), v_rel = 0.05 c, Courant number 0.3, by cells along a bar.
PROTOTYPE = {20: 0.064, 40: 0.031, 80: 0.0156, 160: 0.0080}


class Collision:
    """The numbers of one run, from its parameters."""

    def __init__(self, p: Parameters) -> None:
        self.p = p

    @property
    def n(self) -> int:
        """Points per cell."""
        return self.p.ppc

    @property
    def h(self) -> float:
        """Cell size."""
        return LENGTH / self.p.cells

    @property
    def axis(self) -> int:
        """Direction of the bars."""
        return int(self.p.number("axis", 0))

    @property
    def v(self) -> float:
        """Speed of approach."""
        return SPEED * self.p.number("v", 0.01)

    @property
    def kind(self) -> str:
        """Return which bars collide.

        `equal`; `longer`: bar 2 is `ratio` times as long; `impedance`: both E and rho of bar 2 are
        `ratio` times as large; `stiff`: only E is; `layer`: bar 2 is `ratio` cells thick and fixed
        to the end of the grid.
        """
        return self.p.text("kind", "equal")

    @property
    def ratio(self) -> float:
        """Length or impedance of bar 2 over that of bar 1."""
        return self.p.number("ratio", 1.0)

    @property
    def length_ratio(self) -> float:
        """L2/L1."""
        if self.kind == "layer":
            return self.ratio / self.p.cells
        return self.ratio if self.kind == "longer" else 1.0

    @property
    def impedance_ratio(self) -> float:
        """Z2/Z1, with equal wave speeds."""
        return self.ratio if self.kind == "impedance" else 1.0

    @property
    def stiffness_ratio(self) -> float:
        """E2/E1."""
        return self.ratio if self.kind in ("impedance", "stiff") else 1.0

    @property
    def rigid(self) -> bool:
        """Whether bar 2 hardly moves."""
        return self.kind == "layer" or self.impedance_ratio >= 100.0

    @property
    def masses(self) -> tuple[float, float]:
        """Masses over that of bar 1."""
        if self.kind == "layer":
            return 1.0, 1e30
        return 1.0, self.length_ratio * self.impedance_ratio

    @property
    def velocities(self) -> tuple[float, float]:
        """Velocities: those with which the surface of contact stands still, or bar 2 at rest."""
        if self.p.text("frame", "contact") == "target" or self.kind == "layer":
            return self.v, 0.0
        r = self.impedance_ratio
        return self.v * r / (1 + r), -self.v / (1 + r)

    @property
    def stress(self) -> float:
        """Stress of contact Z1 Z2/(Z1 + Z2) v_rel."""
        if self.kind in ("layer", "stiff"):
            return DENSITY * SPEED * self.v
        r = self.impedance_ratio
        return DENSITY * SPEED * self.v * r / (1 + r)

    @property
    def exact_restitution(self) -> float:
        """1; L1/L2; or 1 - 2/e^2.

        A bar that hits a rigid body of the same mass: rho c A (v - V) = m dV/dt until the wave is
        back at 2 L/c, hence V = v (1 - exp(-2)).
        """
        if self.kind == "stiff":
            return 1.0 - 2.0 * math.exp(-2.0)
        return 1.0 / self.length_ratio if self.kind == "longer" else 1.0

    @property
    def phase(self) -> float:
        """Distance of the middle of the gap from the node below, in cells."""
        return self.p.number("phase", 0.0)

    @property
    def gap(self) -> float:
        """Gap, in cells, at which contact begins."""
        return contact_gap(self.n, self.p.mapping, min(self.phase, 1.0 - self.phase))

    @property
    def duration(self) -> float:
        """Duration of contact of the exact solution."""
        return 2.0 * LENGTH / SPEED

    @property
    def parting(self) -> float:
        """Time from first contact to the parting of the bars in the exact solution."""
        return self.duration * max(1.0, self.length_ratio)

    @property
    def start(self) -> float:
        """Time of first contact."""
        return APPROACH * self.h / self.v

    @property
    def stop(self) -> float:
        """Time of the run: leaves a cell for the bars to part."""
        return self.start + 1.2 * self.parting + self.h / self.v

    @property
    def dt(self) -> float:
        """Time step."""
        cfl = self.p.number("cfl", 0.3)
        fastest = SPEED * (math.sqrt(self.ratio) if self.kind == "stiff" else 1.0)
        return stable_dt(LENGTH, self.p.cells, fastest, self.stop, cfl, FRAMES)

    @property
    def lumped(self) -> Lumped:
        """The lumped model of the contact.

        A heavy bar 2 that covers the node acts as the mirror image that stands still.
        """
        heavy = self.rigid
        return Lumped(
            self.n,
            SPEED * self.dt / self.h,
            (self.v if heavy else 0.5 * self.v) / SPEED,
            self.p.cells,
            self.p.contact,
            0.0 if heavy else min(self.phase, 1.0 - self.phase),
            self.p.mapping,
        )


def bar(
    p: Parameters, lower: float, length: float, density: float, velocity: float, wide: int
) -> Points:
    """Fill one bar, `wide` cells across."""
    run, dim = Collision(p), DIM[p.sim_type]
    corner, top = [0.0] * dim, [wide * run.h] * dim
    counts = [wide * p.ppc] * dim
    if p.text("sides", "walls") == "free":
        corner, top = [2 * run.h] * dim, [(2 + wide) * run.h] * dim
    corner[run.axis], top[run.axis] = lower, lower + length
    counts[run.axis] = round(length / run.h) * p.ppc
    speed = [0.0] * NVEL[p.sim_type]
    speed[run.axis] = velocity
    return lattice(p.sim_type, corner, top, counts, density, speed)


def scene(p: Parameters) -> Scene:
    """Two bars along one axis between smooth walls, or with free sides."""
    run, dim, nu = Collision(p), DIM[p.sim_type], p.number("nu", 0.0)
    wide = int(p.number("wide", 1))
    h, gap = run.h, (run.gap + APPROACH) * run.h
    travel = [abs(v) * run.stop for v in run.velocities]
    margin = 4 + math.ceil(max(travel) / h)
    # Where the middle of the gap must be at the start, so that it is at `phase` at first contact.
    middle = (margin + p.cells + run.phase) * h - 0.5 * sum(run.velocities) * run.start
    margin_cells = 2 * margin + math.ceil(gap / h)
    cells = [wide + (4 if p.text("sides", "walls") == "free" else 0)] * dim
    cells[run.axis] = p.cells + round(p.cells * run.length_ratio) + margin_cells
    if run.kind == "layer":  # its upper end is that of the grid
        end = middle + 0.5 * gap + LENGTH * run.length_ratio
        cells[run.axis] = round(end / h)
    modulus = DENSITY * SPEED**2
    young = modulus / pressure_wave_modulus(1.0, nu)
    first = bar(p, middle - 0.5 * gap - LENGTH, LENGTH, DENSITY, run.velocities[0], wide)
    second = bar(
        p,
        middle + 0.5 * gap,
        LENGTH * run.length_ratio,
        DENSITY * run.impedance_ratio,
        run.velocities[1],
        wide,
    )
    walls = "CartesianSmoothBox"
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        [
            Body("one", first, young, nu, walls),
            Body("two", second, young * run.stiffness_ratio, nu, walls),
        ],
        run.stop,
        run.dt,
        FRAMES,
        p.mapping,
        p.contact,
        contacts=[huang("one", "two", 0.0, int(p.number("normals", 1)))],
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Velocities after the collision, contact force over time, gap, momentum and energies."""
    run = Collision(p)
    axis, (body_one, body_two) = run.axis, out.scene.bodies
    first_mass = float(np.sum(body_one.points.total_mass))
    area = first_mass / (DENSITY * LENGTH)
    reference = body_one.points.x[:, axis]
    middle = np.abs(reference - np.mean(reference)) < 0.1 * LENGTH
    momentum, rows = [], []
    for nodes, one, two in zip(out.nodes(), out.points(0), out.points(1), strict=True):
        a, b = sums(out, 0, one), sums(out, 1, two)
        # Hoop stress changes the radial momentum of TYPE 4.
        momentum.append((a.momentum + b.momentum)[1 if p.sim_type == 4 else slice(None)])
        force = -np.sum(contact_force(nodes, "one", "two")[:, axis]) / (area * run.stress)
        side = 0.5 * run.h / p.ppc
        right = np.max(one.x[:, axis] + side * one["volume"] / body_one.points.measure)
        left = np.min(two.x[:, axis] - side * two["volume"] / body_two.points.measure)
        rows.append(
            [
                nodes.time,
                a.velocity[axis] / run.v,
                b.velocity[axis] / run.v,
                a.kinetic + b.kinetic,
                a.strain + b.strain,
                force,
                (left - right) / run.h,
                -np.mean(one["cauchy_stress"][middle, axis, axis]) / run.stress,
            ]
        )
    t, v1, v2, kinetic, strain, force, gap, stress = np.array(rows).T
    total = np.array(momentum)
    # Energy in the frame of the centre of mass, where it is what the collision is about.
    mass = first_mass + float(np.sum(body_two.points.total_mass))
    drift = float(np.sum(np.square(total[0]))) / (2 * mass)
    useful = kinetic[0] - drift
    m1, m2 = run.masses
    if run.kind == "layer":  # the wall takes momentum
        total, useful, drift = total[:1], kinetic[0], 0.0
        v2[:] = 0.0
    defect = 1.0 - (v2[-1] - v1[-1]) / run.exact_restitution
    change = (1 + run.exact_restitution) / (m1 + m2)
    return {
        "defect": defect,
        "defect_size": abs(defect),
        "v1_error": v1[-1] - v1[0] + change * m2,
        "v2_error": v2[-1] - v2[0] - change * m1,
        "momentum_error": float(np.max(np.abs(total - total[0]))) / (first_mass * run.v),
        "kinetic_end": (kinetic[-1] - drift) / useful,
        "energy_max": (np.max(kinetic + strain) - drift) / useful,
        "energy_end": (kinetic[-1] + strain[-1] - drift) / useful,
        **contact_measures(run, t, force, gap, stress),
    }


def contact_measures(
    run: Collision, t: np.ndarray, force: np.ndarray, gap: np.ndarray, stress: np.ndarray
) -> Measures:
    """Contact force, gap and stress at mid-length over time."""
    touching = np.flatnonzero(force > 0.0)
    if len(touching) == 0:
        raise ValueError("the bars never touch")
    above = np.flatnonzero(force > 0.5)
    if len(above) == 0:  # a contact too soft to stop the bars within 2 L/c
        begin, held = t[touching[0]], 0.0
    else:
        begin = crossing(t, force, above[0] - 1)
        held = crossing(t, force, above[-1]) - begin
    since = (t - begin) / run.duration
    inner = (since > 0.2) & (since < 0.8)
    late = (since > 0.4) & (since < 0.6)
    fading = (since > 0.1) & (since < 0.6) & (force > 0.0)
    decay = np.polyfit(t[fading] * SPEED / LENGTH, np.log(force[fading]), 1)[0]
    return {
        "decay": -float(decay),
        "plateau_mean": float(np.mean(force[inner])),
        "plateau_error": float(np.max(np.abs(force[inner] - 1.0))),
        "stress_error": float(np.mean(stress[late])) - 1.0,
        "duration": held / run.duration,
        "first_gap": float(gap[touching[0]]),
        "gap_step": run.v * float(t[1] - t[0]) / run.h,
        "smallest_gap": float(np.min(gap)),
        "force_end": float(force[-1]),
        "pull": float(max(0.0, -np.min(force))),
    }


def crossing(t: np.ndarray, force: np.ndarray, i: int) -> float:
    """Return the time between frames i and i + 1 at which the force is half of the exact one."""
    return float(np.interp(0.0, *ordered(force[i : i + 2] - 0.5, t[i : i + 2])))


def ordered(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return both arrays by rising x."""
    order = np.argsort(x)
    return x[order], y[order]


def judge(r: Results) -> list[Finding]:
    """Conservation for all; plateau, duration and restitution as far as theory goes."""
    findings = []
    for p, m in r:
        findings += judge_run(Collision(p), m, f"{p.cells} cells")
    p = r.first
    if p.contact == "implicit" and len(r.cells) > 1:
        order = Finding("order of |1 - e/e_exact|", r.order("defect_size"))
        if Collision(p).kind == "longer":
            order.value = r.halvings("defect_size")[-1]
        if p.text("frame", "contact") == "target" or p.mapping == "linear":
            order.high = 0.5
            order.reason = "hand-over from node to node, or crossing noise: does not converge"
        elif damped_part(p) > 0.0:
            order.low, order.high, order.expected = 0.25, 0.9, 0.5
            order.reason = "fronts that the transfer smears: sqrt(h/L), and what the layer adds"
        elif int(p.number("normals", 1)) == 1 or p.sim_type == 1:
            order.low, order.expected = 0.8, 1.0
            order.reason = "the contact is a layer of one cell: error of order h/L"
        findings.append(order)
    return findings


def judge_run(run: Collision, m: Measures, label: str) -> list[Finding]:
    """Compare one run with theory."""
    p = run.p
    steps = round(run.stop / run.dt)
    findings = [
        below(
            f"momentum, {label}",
            m["momentum_error"],
            2.2e-16 * (steps + 10.0 * p.cells),
            "contact forces are opposite; one rounding a step and sums over the points",
        ),
        below(f"KE after/before, {label}", m["kinetic_end"], 1.0 + 1e-12, "no source of energy"),
        below(f"largest energy, {label}", m["energy_max"], 1.005, energy_reason()),
        below(f"tension, {label}", m["pull"], 0.0, "contact forces only push"),
        Finding(
            f"gap at first contact/h, {label}",
            m["first_gap"],
            run.gap - m["gap_step"] - 1.01 * run.v * run.dt / run.h,
            run.gap + 1e-9,
            run.gap,
            "both edge points must reach one node; seen up to a frame and a step later",
        ),
    ]
    if p.contact == "explicit":
        return findings + judge_explicit(run, m, label)
    findings.append(
        Finding(
            f"smallest gap/h, {label}",
            m["smallest_gap"],
            0.0,
            reason="the edges do not overlap: a contact holds them apart",
        )
    )
    if run.kind != "longer":
        findings.append(
            Finding(
                f"e/e_exact, {label}",
                1.0 - m["defect"],
                0.0,
                1.0 / run.exact_restitution + 1e-9,
                1.0,
                "no source of energy: e <= 1",
            )
        )
    if p.text("frame", "contact") == "contact" and p.mapping == "cpdi":
        findings += judge_implicit(run, m, label)
    return findings


def damped_part(p: Parameters) -> float:
    """Return the part of the velocities that a transfer maps anew in each step: 1 in PIC."""
    if p.scheme.transfer == "PIC":
        return 1.0
    return 1.0 - p.scheme.flip


def smeared_loss(run: Collision) -> float:
    """Return 1 - e by fronts that PIC smears.

    A step takes the part a (kh)^2 of a wave's velocity, which is a viscosity of a h^2/dt and, for
    waves, a diffusion of half of it. After 2 L/c the front has the variance s^2 = 2 a h L/CFL. The
    bars part when their force passes 0, at the middle of the front: the impulse lost is the
    integral of its first half, 2 s/sqrt(2 pi) of the force.
    """
    cfl = run.dt * SPEED / run.h
    share = damped_part(run.p) * filter_constant(run.p.ppc)
    width = np.sqrt(2.0 * share * run.h / (LENGTH * cfl))
    return float(2.0 * width / np.sqrt(2.0 * np.pi))


def energy_reason() -> str:
    """Why the sum of both energies may rise a little above its start."""
    return (
        "stress and velocity of a frame lie half a step apart: omega dt/2 of the energy of the "
        "waves that the grid resolves least"
    )


def judge_implicit(run: Collision, m: Measures, label: str) -> list[Finding]:
    """Compare a run of the implicit rule with the rod and the lumped contact."""
    p = run.p
    findings = []
    resolved = p.cells >= 80 and run.p.number("v", 0.01) >= 0.01
    resolved = resolved and run.kind not in ("impedance", "stiff")
    aligned = p.sim_type == 1 or int(p.number("normals", 1)) == 1
    if resolved and aligned and p.ppc > 1:
        findings += [
            below(
                f"contact stress, 0.2 to 0.8 of contact, {label}",
                m["plateau_error"],
                0.02,
                "1/2 rho c v_rel of the rod; 2 %: 1 + strain/2 and the end of the soft start",
            ),
            near(f"duration of contact/(2 L/c), {label}", m["duration"], 1.0, 0.05, "waves"),
            below(
                f"stress at mid-length, {label}",
                abs(m["stress_error"]),
                0.02,
                "-1/2 rho c v_rel between the passing of the fronts",
            ),
        ]
    if run.kind == "stiff":
        return [
            near(
                f"decay of the contact force in L/c, {label}",
                m["decay"],
                1.0,
                0.1 if p.cells < 40 else 0.05,
                "exp(-ct/L) while a rod pushes a rigid body of the same mass; errors of order h/L",
            )
        ]
    restitution, depth = run.lumped.collide()
    slow = run.p.number("v", 0.01) <= 0.01
    lumpable = p.ppc > 1 and aligned and (run.kind == "equal" or run.rigid)
    if lumpable and slow and p.cells >= 40:
        findings += [
            near(
                f"1 - e, {label}",
                m["defect"],
                1.0 - restitution,
                0.25,
                "lumped contact; 25 %: it drops terms of order w/CFL, at most 0.2",
            ),
            Finding(
                f"smallest gap/h of the lumped contact, {label}",
                m["smallest_gap"],
                (gap := run.gap - (1 if run.rigid else 2) * depth) - 0.03,
                gap + 0.03,
                gap,
                "lumped contact; 0.03: strain of the edge points",
            ),
        ]
    if run.kind == "longer":
        findings.append(judge_longer(run, m, 1.0 - restitution, label))
    if run.kind == "equal" and p.ppc == 2 and run.p.number("v", 0.01) == 0.05 and aligned:
        bound = PROTOTYPE.get(p.cells)
        if bound is not None and damped_part(p) > 0.0:
            smeared = smeared_loss(run)
            loss = Finding(f"1 - e of smeared fronts, {label}", m["defect"])
            loss.low, loss.high = 0.5 * smeared, smeared + 1.3 * bound
            loss.expected = smeared
            loss.reason = (
                "impulse that a front of the width sqrt(2 a h L/CFL) leaves for later; half of it "
                "at least, since the width is no small part of the bar; the layer adds its loss"
            )
            findings.append(loss)
        elif bound is not None:
            findings.append(
                below(
                    f"1 - e, {label}",
                    m["defect"],
                    1.3 * bound,
                    "1.3 times the value of a small separate code",
                )
            )
    return findings


def judge_longer(run: Collision, m: Measures, loss: float, label: str) -> Finding:
    """Bound the restitution with a longer bar.

    The spring of the contact is pressed by 2 w* h at each side, with w* = (v/(32 n c))^(1/3),
    when the exact force ends. The bars then rest against each other and the spring pushes until
    it is free: F opens it at 2 F/(rho c), which makes an impulse of at most 2 w* h rho c.
    """
    pressed = (0.5 * run.v / SPEED / (16.0 * run.n)) ** (1.0 / 3.0)
    extra = 2.0 * pressed * run.h / LENGTH * SPEED / run.v
    factor = 1.0 + run.length_ratio
    return Finding(
        f"e/e_exact, {label}",
        1.0 - m["defect"],
        1.0 - factor * 1.25 * loss,
        1.0 + factor * extra,
        1.0,
        "the spring of the contact gives back its energy; losses of the lumped contact",
    )


def judge_explicit(run: Collision, m: Measures, label: str) -> list[Finding]:
    """Compare a run of the explicit rule with the lumped contact, a dashpot."""
    time = (run.stop - run.start) * SPEED / run.h
    return [
        Finding(
            f"e, {label}",
            1.0 - m["defect"],
            (e := run.lumped.collide(time)[0]) - 0.03,
            e + 0.03,
            e,
            "lumped contact: an explicit contact is a dashpot of m/dt",
        )
    ]
