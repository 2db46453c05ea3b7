"""Long-time energy of a free bar."""

from __future__ import annotations

import numpy as np
from _freebodies import ALL_DIGITS, bulk_modulus, free_faces, kinetic_energy, strain_energy
from harness.case import Case, Finding, Measures, Output, Parameters, Results, near
from harness.scene import DIM, NVEL, Array, Body, Scene, lattice, shear_modulus, stable_dt
from harness.theory import amplification

LENGTH, DENSITY, YOUNG = 1.6, 1000.0, 1e6
WAVE_SPEED = float(np.sqrt(YOUNG / DENSITY))
#: Strain of the wave.
STRAIN = 1e-4
#: Frames in a period.
SAMPLES = 5
#: Cells between the bar and the faces; cells across it.
MARGIN, WIDTH = 2, {1: 1, 2: 2, 3: 1}


def axis(p: Parameters) -> int:
    """Direction of the bar."""
    return int(p.number("axis", 1 if p.sim_type == 4 else 0))


def wave_number(p: Parameters) -> float:
    """Half waves of the mode over the length."""
    return p.number("mode", 1) * np.pi / LENGTH


def periods(p: Parameters) -> int:
    """Periods of the run."""
    return int(p.number("periods", 60))


def scene(p: Parameters) -> Scene:
    """A bar with free faces on node lines, nu = 0, so that nothing happens across it."""
    dim, along, h = DIM[p.sim_type], axis(p), LENGTH / p.cells
    k = wave_number(p)
    size = np.full(dim, WIDTH[dim])
    size[along] = p.cells
    lower = np.full(dim, float(MARGIN))
    if p.sim_type == 4:
        lower[0] = 0.0

    def velocity(x: Array) -> Array:
        v = np.zeros((len(x), NVEL[p.sim_type]))
        v[:, along] = STRAIN * WAVE_SPEED * np.cos(k * (x[:, along] - MARGIN * h))
        return v

    points = lattice(
        p.sim_type, lower * h, (lower + size) * h, list(size * p.ppc), DENSITY, velocity
    )
    counts = [int(n) + 2 * MARGIN for n in size]
    t_stop = periods(p) * 2.0 * np.pi / (k * WAVE_SPEED)
    return Scene(
        p.sim_type,
        [n * h for n in counts],
        counts,
        [Body("bar", points, YOUNG, 0.0, free_faces(p))],
        t_stop,
        stable_dt(LENGTH, p.cells, WAVE_SPEED, t_stop, 0.2, SAMPLES * periods(p)),
        SAMPLES * periods(p),
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Slope of the logarithm of the energy over the time, per period."""
    shear, bulk = shear_modulus(YOUNG, 0.0), bulk_modulus(YOUNG, 0.0)
    frames = list(out.points())
    energy = [kinetic_energy(f) + strain_energy(f, shear, bulk) for f in frames]
    slope = np.polyfit(np.arange(len(frames)) / SAMPLES, np.log(energy), 1)[0]
    return {"loss": -slope, "courant": WAVE_SPEED * out.scene.dt * p.cells / LENGTH}


def judge(r: Results) -> list[Finding]:
    """The law of the filter."""
    findings = []
    for p, m in r:
        kh = wave_number(p) * LENGTH / p.cells
        size = np.max(np.abs(amplification(kh, p.ppc, m["courant"])))
        law = -2.0 * np.log(size) * 2.0 * np.pi / (kh * m["courant"])
        findings.append(
            near(
                f"energy lost in a period, {p.cells} cells",
                m["loss"],
                law,
                0.02,
                "eigenvalues of a step; 2 %: the energy seen at one instant swings by omega dt/2",
            )
        )
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Long-time energy of a free bar",
    statement="""
A bar with free ends on node lines (TYPE 2, 3, 4: with free sides and nu = 0) vibrates in its mode cos(k x),
k = pi/L, for `periods` periods, which are thousands of steps. The mapping to the nodes and back multiplies
velocity increments by mu = 1 - a (k h)^2, a = 1/6 + 1/(12 n^2) with n points a cell, so that the scheme loses energy:
with z = c^2 K dt^2 the eigenvalues of a step have the modulus of the matrix [[1, mu], [-z, 1 - z]], and in a period the part

    2 pi a (c dt/h) (k h)^3

is lost. The rate measured, from five frames a period, must be *that of the eigenvalues*: less would be as wrong as
more. Free ends add nothing, since the mode is even there.
""",
    source="Derived here",
    scene=scene,
    measure=measure,
    judge=judge,
)
