"""A free soft beam that bends in flight."""

from __future__ import annotations

import math

import numpy as np
from _freebodies import (
    ALL_DIGITS,
    EPS,
    angular_momentum,
    bulk_modulus,
    free_box,
    kinetic_energy,
    momentum,
    strain_energy,
)
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import (
    DIM,
    NVEL,
    Array,
    Body,
    Scene,
    lattice,
    pressure_wave_modulus,
    shear_modulus,
)

WIDTH, LENGTH, DENSITY, YOUNG, T_STOP, FRAMES = 1.0, 6.0, 1100.0, 17e6, 2.5, 25


def poisson(p: Parameters) -> float:
    """Return Poisson's ratio."""
    return p.number("nu", 0.3)


def scene(p: Parameters) -> Scene:
    """Return the scene: the beam stands along y and is thrown along x with v = sin(pi y/L)."""
    dim, h = DIM[p.sim_type], WIDTH / p.cells
    size = [p.cells, round(LENGTH * p.cells), 1][:dim]
    lower = np.array([2 * p.cells, 2 * p.cells, 3][:dim], float)

    def velocity(x: Array) -> Array:
        v = np.zeros((len(x), NVEL[p.sim_type]))
        v[:, 0] = np.sin(np.pi * (x[:, 1] - lower[1] * h) / LENGTH)
        return v

    points = lattice(
        p.sim_type, lower * h, (lower + size) * h, [n * p.ppc for n in size], DENSITY, velocity
    )
    counts = [6 * p.cells, size[1] + 4 * p.cells, 7][:dim]
    c = math.sqrt(pressure_wave_modulus(YOUNG, poisson(p)) / DENSITY)
    steps = FRAMES * math.ceil(T_STOP * c / (0.2 * h) / FRAMES)
    return Scene(
        p.sim_type,
        [n * h for n in counts],
        counts,
        [Body("beam", points, YOUNG, poisson(p), free_box(dim))],
        T_STOP,
        T_STOP / steps,
        FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return the motion of the centre of mass, angular momentum and energy."""
    frames = list(out.points())
    mass = frames[0]["mass"]
    total = math.fsum(mass)
    shear, bulk = shear_modulus(YOUNG, poisson(p)), bulk_modulus(YOUNG, poisson(p))
    v0 = momentum(frames[0])[0] / total
    off, turns, energies = 0.0, 0.0, []
    for frame in frames:
        way = np.array([math.fsum(mass * frame["displacement"][:, c]) for c in range(2)]) / total
        off = max(off, float(np.max(np.abs(way - [v0 * frame.time, 0.0]))))
        center = mass @ frame.x / total
        turns = max(turns, abs(float(angular_momentum(frame, center)[2])))
        energies.append(kinetic_energy(frame) + strain_energy(frame, shear, bulk))
    return {
        "speed": v0,
        "way": off,
        "turns": turns / (total * v0 * LENGTH),
        "energy": max(energies) / energies[0],
        "steps": float(out.scene.steps),
    }


def judge(r: Results) -> list[Finding]:
    """Expect the centre of mass moves at 2/pi; nothing turns; no energy comes from nowhere."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells across"
        z = math.pi / (2.0 * LENGTH * p.cells * p.ppc)
        findings += [
            near(
                f"velocity of the centre of mass over 2/pi{end}",
                m["speed"] * math.pi / 2.0,
                z / math.sin(z),
                1e-12,
                "mean of the sine at the points: z/sin z, z = pi/(2 N) with N points along",
            ),
            below(
                f"centre of mass off its line (m){end}",
                m["way"],
                10 * m["steps"] * EPS,
                "one rounding of positions up to 10 m a step",
            ),
            below(
                f"angular momentum over m v L{end}",
                m["turns"],
                1e-9,
                "none by symmetry about the middle of the beam; round-off, amplified by crossings",
            ),
        ]
        energy = Finding(f"largest energy over the first{end}", m["energy"], 0.0, 1.02)
        energy.reason = "the filter only takes energy; C/2 (k h) between velocities and stresses"
        findings.append(energy)
    return findings


CASE = Case(
    family="Hard cases",
    title="A free soft beam that bends in flight",
    statement=r"""
A free beam, 1 m by 6 m, density 1100 kg/m³, $E$ = 17 MPa, gets $v_x = \sin(\pi y/L)$ m/s. It
flies, bends and vibrates for 2.5 s. *Exact*: the centre of mass moves at $2/\pi = 0.6366$ m/s (at
the mean of the sine at the points), the angular momentum stays 0 by symmetry, and no energy is
gained, for $\nu = 0.3$ as well as 0.499.
""",
    source="Set-up of a published comparison of locking; exact answers elementary",
    scene=scene,
    measure=measure,
    judge=judge,
)
