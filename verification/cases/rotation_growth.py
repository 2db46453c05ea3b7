"""What forward Euler steps of a rotation do to volume and stress."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from _manufactured import fitted, judge_start, measure_solution
from _rotating import block, block_scene
from _solutions import RotatingBlock
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import DIM, Scene

#: What a rotation does to stress by the rule of Hughes and Winget.
NONE = "a step along chords is a rotation: no strain, no growth; what comes in from the faces"
#: Cells beside the faces whose points are not judged.
EDGE = 6.0


def solution(p: Parameters) -> RotatingBlock:
    """Return the exact solution of a row: soft, and so slow that strains stay as they are."""
    spin = float(2 * np.pi)
    amplitude = p.number("amplitude", 0.05)
    exact = block(p.sim_type, DIM[p.sim_type], amplitude, 1e-6, spin, spin / 400)
    exact.time = 1.0 / spin
    return exact


def cells(p: Parameters) -> int:
    """Return the cells along a side of the block: the rows refine the steps."""
    return int(p.number("grid", 24))


def scene(p: Parameters) -> Scene:
    """Return half a turn, from the largest strain on."""
    exact = solution(p)
    start, length = float(0.5 * np.pi / exact.omega), float(np.pi / exact.spin)
    return block_scene(
        p.sim_type, exact, cells(p), p.ppc, start, length, length / p.cells, p.mapping
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Measure the start, and volume and stress of the points inside at the end."""
    exact = solution(p)
    whole = measure_solution(exact, out, staggered=True)
    measures = {name: whole[name] for name in ("start", "load", "jaumann")}
    points, frame = out.scene.bodies[0].points, out.points()[-1]
    reference = exact.place(points)
    depth = 0.5 - np.max(np.abs(reference[:, :2] - 1.0), axis=1)
    inside = depth * cells(p) > EDGE
    stress = frame["cauchy_stress"][inside, :2, :2]
    aim = exact.stress(reference[inside], frame.time)[:, :2, :2]
    excess = np.mean(np.trace(stress - aim, axis1=1, axis2=2)) / 2
    measures["pressure"] = float(-excess / exact.youngs_modulus)
    measures["shrinkage"] = float(-np.mean(np.log(frame["volume"] / points.volume)[inside]))
    if exact.amplitude > 0.0:
        product = np.sum(deviator(stress) * deviator(aim))
        measures["growth"] = float(product / np.sum(deviator(aim) ** 2))
    return measures


def deviator(stress: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the deviators of tensors in the plane."""
    return stress - 0.5 * np.trace(stress, axis1=1, axis2=2)[:, None, None] * np.eye(2)


def judge(r: Results) -> list[Finding]:
    """Judge the start, and the closed forms of the steps."""
    amplitude = r.first.number("amplitude", 0.05)
    found = judge_start(r, np.pi * amplitude or 1.0, 1e-9)
    if amplitude == 0.0:
        for p, m in r:
            # Steps by the angle a = pi/steps; see the statement.
            angle = np.pi / p.cells
            expected = p.cells * angle * np.sin(0.5 * angle) * direction(p)
            reason = "tr L = -2 s sin(s dt/2) of the chord; 3 %: what comes in from the faces"
            name = f"pressure/E, {p.cells} steps"
            if is_objective(p):
                found.append(below(name, abs(m["pressure"]), 0.03 * abs(expected), NONE))
            else:
                found.append(near(name, m["pressure"], expected, 0.03, reason))
            name = f"-ln(V/V0), {p.cells} steps"
            found.append(near(name, m["shrinkage"], 2 * expected, 0.03, reason))
        if is_objective(r.first):
            return found
        if direction(r.first) < 0.0:
            return found
        return found + fitted(r, "pressure", 0.97, 1.03, "half a step of spin: order 1 in dt")
    for (p, m), (q, n) in pairwise(r):
        value = float(np.log(m["growth"] / n["growth"]))
        reason = (
            "deviator times sqrt(1 + 4 s^2 dt^2) a step; the quotient leaves out what depends on "
            "h alone; 6 %: squares of both"
        )
        name = f"growth of the deviator, {p.cells} over {q.cells} steps"
        expected = log_growth(p.cells) - log_growth(q.cells)
        if is_objective(p):
            found.append(below(name, abs(value), 0.06 * expected, NONE))
        else:
            found.append(near(name, value, expected, 0.06, reason))
    return found


def direction(p: Parameters) -> float:
    """Return 1 where places are those of the begin of a step, -1 for its end (USF)."""
    return -1.0 if p.scheme.solver == "USF" else 1.0


def is_objective(p: Parameters) -> bool:
    """Tell whether a step of rotation turns the stress and strains nothing."""
    return p.scheme.rate == "hughes_winget"


def log_growth(steps: int) -> float:
    """Return the logarithm of the growth of the deviator over half a turn."""
    spin = np.pi / steps * np.cos(0.5 * np.pi / steps)
    return float(0.5 * steps * np.log1p(4 * spin**2))


CASE = Case(
    family="Manufactured solutions",
    title="Volume and stress under rotation",
    statement=r"""
The rotating block with a spin of $s = 2\pi$ 1/s, so soft that its stress moves nothing ($E =
10^{-6}$ Pa, waves of 1 mm/s), makes half a turn under the exact body force. The resolution is the
number of steps. Points within 6 cells of the faces are left out: nodes with little mass spoil the
rotation there.

**Without strain**, points go along chords: the velocity of the middle of a step, seen from the
places of its begin, has the gradient $-s \sin(s \Delta t/2)\, 1$ in the plane beside the spin $s
\cos(s \Delta t/2)$. So the rates give each step the pressure $E \Delta t\, s \sin(s \Delta t/2)$
and the factor $e^{-2 s \Delta t \sin(s \Delta t/2)}$ of the volume, though nothing is compressed:
together a pressure of $\pi^2/2$ over the number of steps, of order 1 in $\Delta t$.

**With strain** held at its largest ($A = 0.05$ m in $y_i = X_i + A \sin^2(\pi X_i)$), the
rotation of the stress by forward Euler steps multiplies the deviator by $\sqrt{1 + 4 s^2 \Delta
t^2 \cos^2(s \Delta t/2)}$ a step. The growth also has a part that depends on the grid alone,
which drops out of the quotient of two runs.

USF forms the gradient at the end of a step: the same velocities, seen from the places that they
lead to, have the gradient $+s \sin(s \Delta t/2)\,1$: pressure and volume change their signs.

With `rate=hughes_winget` the strain of a step is that of its middle, which a rotation does not
have, and the stress turns by an orthogonal matrix: neither pressure nor growth. The volumes that
the points carry follow tr $L$ as before.
""",
    source="Forward Euler steps of a rotation: derived here",
    scene=scene,
    measure=measure,
    judge=judge,
)
