"""A free block that rotates while it vibrates."""

from __future__ import annotations

import numpy as np
from _manufactured import fitted, halvings, judge_start, measure_solution
from _rotating import FRAMES, block, block_scene
from _solutions import RotatingBlock
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import DIM, Scene, stable_dt


def solution(p: Parameters) -> RotatingBlock:
    """Return the exact solution of a row: E = 1 Pa, so that waves move with 1 m/s."""
    spin = float(0.2 * np.pi)
    exact = block(p.sim_type, DIM[p.sim_type], p.number("amplitude", 0.02), 1.0, spin, float(np.pi))
    exact.time = 0.2
    return exact


def scene(p: Parameters) -> Scene:
    """Return a period of the vibration, a fifth of a turn."""
    dt = stable_dt(1.0, p.cells, 1.0, 2.0, p.number("cfl", 0.2), FRAMES)
    return block_scene(p.sim_type, solution(p), p.cells, p.ppc, 0.0, 2.0, dt, p.mapping)


def measure(p: Parameters, out: Output) -> Measures:
    """Measure the errors over all frames."""
    if out.status != 0:
        return {"finished": 0.0}
    return {"finished": 1.0, **measure_solution(solution(p), out, staggered=True)}


def judge(r: Results) -> list[Finding]:
    """Judge start and orders, or lost faces."""
    amplitude = r.first.number("amplitude", 0.02)
    good = [(p, m) for p, m in r if m["finished"] > 0.0]
    rest = Results([p for p, _ in good], [m for _, m in good])
    found = judge_start(rest, np.pi * amplitude or 1.0, 1e-9) if good else []
    found += halvings(rest, "u_l1", "u_l2", "u_linf", "stress_l2")
    if r.first.mapping == "linear" and amplitude > 0.0:
        for p, m in r:
            lost = float(m["finished"] < 1.0 or not m["stress_l2"] < 1.0)
            low = 1.0 if p.cells >= 32 else 0.0
            reason = "small masses of nodes at faces under stress that turn over them slowly"
            name = f"lost at the faces, {p.cells} cells"
            found.append(Finding(name, lost, low, 1.0, 1.0, reason))
        return found
    if r.first.mapping != "linear":
        for p, m in r:
            name = f"lost at the faces, {p.cells} cells"
            reason = "averaged and smooth functions: weight and gradient of a node vanish together"
            found.append(Finding(name, 1.0 - m["finished"], 0.0, 0.0, 0.0, reason))
    reason = "rotation of order 1 in dt, spin lost in a layer of h at the faces of order 2"
    return found + fitted(rest, "u_l2", 1.0, 2.1, reason)


CASE = Case(
    family="Manufactured solutions",
    title="A block that rotates and vibrates",
    statement=r"""
A block of 1 m side with free faces moves by $x = c + Q(s t)\,(y - c)$, a rotation about $z$ with
the spin $s = \pi/5$ 1/s laid over the vibration $y_i = X_i + A \sin^2(\pi X_i) \sin(\pi t)$ with
the wave speed 1 m/s and $\nu = 0$, for one period. The stress is $Q\, \mathrm{diag}(E \ln
F_{ii})\, Q^T$; it is 0 on the faces. The body force holds inertia, Coriolis and centripetal
terms. The start is staggered.

Measured: largest norms over the frames of the errors of displacement (in m), velocity (over half
of the spin times 1 m and the speed of the vibration) and stress (over $\pi A E$, without
vibration $E$).

Faces that turn meet nodes with little mass. Velocities mapped there are those of the masses'
middle, which is not at the node, so that a layer of cells loses spin: order 2 in the angle of the
whole block. The rotation of strains and stresses by forward Euler steps is of order 1 in $\Delta
t$. With linear functions a face under stress that turns slowly over nodes loses the run.
""",
    source=(
        "Fields after Wallstedt and Guilkey, J. Comput. Phys. 227 (2008) 9628-9642, with free "
        "faces and a rotation: derived here"
    ),
    scene=scene,
    measure=measure,
    judge=judge,
    error="u_l2",
    may_fail=True,
)
