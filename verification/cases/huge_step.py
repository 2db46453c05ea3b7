"""A time step above the stability limit."""

from __future__ import annotations

import re

import numpy as np
from _freebodies import free_faces, lopsided
from harness.case import Case, Finding, Measures, Output, Parameters, Results, near
from harness.scene import DIM, Body, Scene, lattice, pressure_wave_modulus

SPACING, DENSITY, YOUNG, POISSON = 0.1, 1000.0, 1e6, 0.3
WAVE_SPEED = float(np.sqrt(pressure_wave_modulus(YOUNG, POISSON) / DENSITY))
MARGIN, STEPS = 3, 2000
NUMBER = r"([0-9.eE+-]+)"
WARNING = re.compile(rf'dt = {NUMBER} s is above the stable step of body "block", {NUMBER} s')
REASON = re.compile(
    r'error: body "block": point \d+ (?:moved more than a cell|is no longer finite|has lost its'
    rf" volume) in step (\d+).*\n  dt is above the stable step of this body, {NUMBER} s"
)


def limit(p: Parameters) -> float:
    """Return the stability limit for n points a cell and direction, not for one with hats."""
    courant = 1.0 / np.sqrt(5.0 / 3.0 + 1.0 / (3.0 * p.ppc**2))
    return float(courant * SPACING / WAVE_SPEED)


def scene(p: Parameters) -> Scene:
    """Return the scene: a free block with some motion, and a step of `factor` times the limit."""
    dim = DIM[p.sim_type]
    lower = np.full(dim, float(MARGIN))
    if p.sim_type == 4:
        lower[0] = 0.0
    points = lattice(
        p.sim_type,
        lower * SPACING,
        (lower + p.cells) * SPACING,
        [p.cells * p.ppc] * dim,
        DENSITY,
        lambda x: 1e-3 * WAVE_SPEED * lopsided(p.sim_type, x / (p.cells * SPACING)),
    )
    counts = [p.cells + 2 * MARGIN] * dim
    dt = p.number("factor", 2.0) * limit(p)
    return Scene(
        p.sim_type,
        [n * SPACING for n in counts],
        counts,
        [Body("block", points, YOUNG, POISSON, free_faces(p))],
        STEPS * dt,
        dt,
        1,
        p.mapping,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return exit status and what the messages tell."""
    warning, reason = WARNING.search(out.errors), REASON.search(out.errors)
    return {
        "status": float(out.status),
        "warned": float(warning[2]) if warning else 0.0,
        "told": float(reason[2]) if reason else 0.0,
        "step": float(reason[1]) if reason else float(STEPS),
        "frames": float(len(out.points())),
    }


def judge(r: Results) -> list[Finding]:
    """Expect a warning, then status 3 with the reason, and a whole first frame."""
    findings = []
    for p, m in r:
        end = f", {p.cells} cells"
        status = Finding(f"exit status{end}", m["status"], 3.0, 3.0, 3.0)
        status.reason = "the simulation went bad"
        step = Finding(f"step in which it ended{end}", m["step"], 1.0, STEPS - 1.0)
        step.reason = "exponential growth"
        frames = Finding(f"frames left behind{end}", m["frames"], 1.0, 1.0, 1.0)
        frames.reason = "frames written before are whole"
        law = "C h/c, C = 1/sqrt(5/3 + 1/(3 n^2)); six digits"
        findings += [
            status,
            near(f"stable step in the warning{end}", m["warned"], limit(p), 1e-4, law),
            near(f"stable step in the reason{end}", m["told"], limit(p), 1e-4, law),
            step,
            frames,
        ]
    return findings


CASE = Case(
    family="Hard cases",
    title="A time step above the stability limit",
    statement=r"""
A free block moves a little, and the time step is several times the stability limit $C h/c$, $C =
1/\sqrt{5/3 + 1/(3n^2)}$. The program must warn before the first step, end with exit status 3,
name the point and what happened to it, and tell *the stable step as the cause*, which must be the
formula's. (Where between stable and unstable the limit lies is the subject of the scan of the
time step.)
""",
    source="Dispersion relation of the scheme, derived here",
    scene=scene,
    measure=measure,
    judge=judge,
    may_fail=True,
)
