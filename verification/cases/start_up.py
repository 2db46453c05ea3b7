"""Start from the largest displacement, with and without staggered velocities."""

from __future__ import annotations

import numpy as np
from _axis_aligned import (
    LENGTH,
    WAVE_NUMBER,
    judge_modes,
    make_scene,
    solution,
    starts_early,
    steps_of,
)
from _manufactured import fitted, judge_start, measure_solution
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import Scene
from harness.steps import ModeSteps

FRAMES = 20


def resolution(p: Parameters) -> tuple[int, int]:
    """Return cells and steps: a row refines the cells (refine=cells) or the steps (steps)."""
    if p.text("refine", "cells") == "steps":
        return int(p.number("grid", 32)), p.cells
    return p.cells, steps_of(p, p.cells, FRAMES)


def scene(p: Parameters) -> Scene:
    """Return a box of small waves that start at their largest displacement."""
    return make_scene(p, *resolution(p), FRAMES)


def measure(p: Parameters, out: Output) -> Measures:
    """Measure errors, and the lead of the first mode over a cosine."""
    exact = solution(p)
    measures = measure_solution(exact, out, staggered=starts_early(p) > 0)
    cells = resolution(p)[0]
    courant = exact.wave_speed * out.scene.dt * cells / LENGTH
    steps = ModeSteps.of(p.scheme, np.pi / cells, p.ppc, basis=p.mapping)
    omega = float(np.angle(steps.eigenvalue(courant))) / out.scene.dt
    points = out.scene.bodies[0].points
    shape = np.sin(WAVE_NUMBER * points.x[:, 0])
    times, modes = [], []
    for frame in out.points():
        times.append(frame.time)
        modes.append(np.sum(shape * frame["displacement"][:, 0]) / np.sum(shape**2))
    angles = omega * np.array(times)
    basis = np.column_stack([np.cos(angles), np.sin(angles)])
    cosine, sine = np.linalg.lstsq(basis, np.array(modes), rcond=None)[0]
    return {**measures, "lead": abs(sine / cosine), "step_angle": exact.omega * out.scene.dt}


def judge(r: Results) -> list[Finding]:
    """Judge the errors of the linear steps; the lead is half a step, or of second order."""
    staggered = starts_early(r.first) > 0 or r.first.scheme.staggered
    found = judge_start(r, WAVE_NUMBER * r.first.number("amplitude", 1e-6))
    for p, m in r:
        found += judge_modes(p, m, *resolution(p), FRAMES)
        step = m["step_angle"]
        # The next terms: of the step, of the grid, and of the strain as in judge_modes.
        cells = resolution(p)[0]
        margin = step**2 + 0.5 * step * (np.pi / cells) ** 2 + 2e-6 * np.pi
        lead = 0.0 if staggered else 0.5 * step
        name = f"lead over the cosine, {p.cells} {p.text('refine', 'cells')}"
        cause = "none: staggered start" if staggered else "half a step of velocity is missing"
        reason = f"{cause}; next order in dt and kh"
        low, high = max(0.0, lead - margin), lead + margin
        found.append(Finding(name, m["lead"], low, high, lead, reason))
    if not staggered:
        found += fitted(r, "lead", 0.97, 1.03, "half a step of velocity is missing: order 1")
    if r.first.text("refine", "cells") == "steps":
        return found
    if staggered:
        return found + fitted(r, "u_l2", 1.9, 2.1, "staggered start: order 2")
    reason = "half a step of velocity is missing, dt = C h/c: order 1 takes over from order 2"
    return found + fitted(r, "u_l2", 0.7, 1.3, reason, first=32)


CASE = Case(
    family="Manufactured solutions",
    title="Start from the largest displacement",
    statement=r"""
The standing wave along the axes of a box, $u_i = A \sin(\pi X_i) \cos(\pi c t + \phi_i)$ with $A
= 10^{-6}$ m, begins with an acceleration. Symplectic Euler steps take the first velocity for that
of half a step before the start. Given the velocity of the start itself, the motion becomes $\cos
\omega t - \tfrac12 \omega \Delta t \sin \omega t$: an error of order 1 that no refinement of the
grid alone removes. With the velocity of half a step earlier (`staggered = 1`) the order is 2. A
start at rest position hides the difference, since its first acceleration is 0.

Measured: errors as for the standing waves, which must be those of the linear steps followed in
closed form, and the share of the sine in the first mode along $x$, by least squares with the
frequency of the discrete dispersion relation. Rows refine cells at a fixed Courant number, or the
steps of a period on a fixed grid.
""",
    source="Derived here from the recursion of symplectic Euler steps",
    scene=scene,
    measure=measure,
    judge=judge,
    error="u_l2",
    order=2.0,
)
