"""A free end of which only a sliver reaches into the next cell."""

from __future__ import annotations

import numpy as np
from _scheme_steps import SchemeMatrices
from _waves import DENSITY, FREE, SLIP, YOUNG, Walls, wave_speed
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.norms import linf
from harness.scene import Body, Points, Scene
from harness.steps import LEAST_SPREAD, ModeSteps
from harness.theory import node_functions

CELLS, EMPTY = 12, 3
FRAMES = 50


def steps(p: Parameters) -> int:
    """Return the number of steps."""
    return int(p.number("steps", 1500))


def noise(p: Parameters) -> float:
    """Return the velocities at the start, over the speed of waves."""
    return p.number("noise", 1e-13)


def courant(p: Parameters) -> float:
    """Return c dt/h."""
    return p.number("cfl", 0.3)


def weight(p: Parameters) -> float:
    """Return the weight of the last point on the last node, for linear functions."""
    if "weight" in p.options:
        return p.number("weight", 0.0)
    return 0.01 * p.cells * 2.0 * courant(p) ** 2 / (4.0 + courant(p) ** 2)


def sliver_grows(p: Parameters) -> bool:
    """Tell whether the last node grows when the node before it is as good as fixed."""
    distance = np.array([weight(p) - reach(p)])
    if p.mapping == "cpdi" and weight(p) >= 0.25 / p.ppc:
        mu, slope = weight(p), 1.0  # the whole box in the last cell
    else:
        mu, slope = (float(a[0]) for a in node_functions(p.mapping, distance, p.ppc))
    return courant(p) ** 2 * slope**2 / mu > 4.0 / (2.0 - mu)


def reach(p: Parameters) -> float:
    """Return the distance from a node, in cells, at which its function ends.

    That of a corner average is taken for that of a hat: a quarter of the box less.
    """
    return {"ugimp": 1.0 + 0.5 / p.ppc, "quadratic": 1.5, "cubic": 2.0}.get(p.mapping, 1.0)


def walls() -> Walls:
    """Return a smooth wall at the lower end; the upper one is free."""
    return Walls([SLIP, FREE])


def scene(p: Parameters) -> Scene:
    """Return a bar whose last point lies `weight` cells beyond where it reaches its last node."""
    h, c, n = 1.0 / CELLS, wave_speed(p), p.ppc
    # On a grid line less the part of the reach that is no whole cell.
    last = 1.0 + (weight(p) + np.ceil(reach(p)) - reach(p)) * h
    x = (last - h / n * np.arange(CELLS * n + 1))[::-1]
    x = x[x > 0.0][:, None]
    volume = np.full(len(x), h / n)
    velocity = noise(p) * c * np.random.default_rng(2).uniform(-1.0, 1.0, x.shape)
    points = Points(1, x, volume, DENSITY * volume, velocity)
    body = Body("bar", points, YOUNG, p.number("nu", 0.0), walls().section())
    dt = courant(p) * h / c
    cells = CELLS + EMPTY
    return Scene(1, [cells * h], [cells], [body], steps(p) * dt, dt, FRAMES, p.mapping)


def measure(p: Parameters, out: Output) -> Measures:
    """Return how the velocities grow, and what theory says of it."""
    start, times, speeds = noise(p) * wave_speed(p), [], []
    for frame in out.points():
        times.append(frame.time / out.scene.dt)
        speeds.append(linf(frame["velocity"]) / start)
    t, v = np.array(times), np.array(speeds)
    grown = (v > 1e2) & (v < 1e-6 / noise(p))
    rate = np.nan
    if np.count_nonzero(grown) >= 3:
        rate = float(np.polyfit(t[grown], np.log(v[grown]), 1)[0])
    scheme = SchemeMatrices(out.scene, list(walls().codes))
    return {
        "growth": float(np.max(v[1:])) if len(v) > 1 else np.inf,
        "failed": float(out.status == 3),
        "rate": rate,
        "theory_rate": float(np.log(scheme.growth(out.scene.dt))),
        "weight": weight(p),
    }


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    for p, m in r:
        label = f"weight {m['weight']:.4g}"
        grows = m["theory_rate"] > 1e-5
        plain = (p.scheme.solver, p.scheme.transfer, p.scheme.flip) == ("USL", "FLIP", 1.0)
        if not plain:
            findings.append(judge_cure(p, grows, label))
        elif "weight" not in p.options:
            expected = float(sliver_grows(p))
            findings.append(
                Finding(
                    f"grows by the matrices, {label}",
                    float(grows),
                    expected,
                    expected,
                    expected,
                    "mass and stiffness of the last node as if the node before were fixed",
                )
            )
        if not grows:
            findings += [
                below(f"growth, {label}", m["growth"], 100.0, "no eigenvalue of a step above 1"),
                below(f"failed, {label}", m["failed"], 0.0, "a stable run ends well"),
            ]
            continue
        findings.append(
            Finding(
                f"growth, {label}",
                m["growth"],
                float(np.exp(min(np.log(1e6), 0.8 * m["theory_rate"] * steps(p)))),
                np.inf,
                np.nan,
                "an eigenvalue of a step above 1, until the last point leaves its place",
            )
        )
        if np.isfinite(m["rate"]):
            findings.append(
                near(
                    f"logarithm of the growth in a step, {label}",
                    m["rate"],
                    m["theory_rate"],
                    0.02 + 0.3 / np.log(m["growth"]),
                    "largest eigenvalue of a step; other waves, and phases of the frames",
                )
            )
    return findings


def judge_cure(p: Parameters, grows: bool, label: str) -> Finding:
    """Compare the matrices with the last node as if the node before were fixed, a single wave."""
    nodes = np.arange(-2, 4)
    distance = weight(p) - nodes
    values, slopes = node_functions(p.mapping, distance, p.ppc)
    spread = float(np.sum(values * distance**2))
    fit = slopes
    if p.mapping != "linear" and spread > LEAST_SPREAD:
        fit = -values * distance / spread
    last = int(np.flatnonzero(nodes == 1)[0])
    mu, arm = values[last], -distance[last]
    slope = fit[last] if p.scheme.transfer == "MLS" else slopes[last]
    node = ModeSteps(p.scheme, slope**2 / mu, mu, mu + arm * fit[last])
    expected = float(node.growth(courant(p)) > 1.0 + 1e-6)
    found = Finding(f"grows by the matrices, {label}", float(grows), expected, expected, expected)
    found.reason = "kept and gained of the last node as if the node before were fixed"
    return found


CASE = Case(
    family="Hard cases",
    title="A free end with little mass on its last node",
    statement=r"""
A bar whose last point lies a little beyond a grid line, with the weight $\xi$ on a node that no
other point reaches; noise of $10^{-13}c$ in the velocities, 1500 steps. The resolution of this case
is $\xi$ in percent of $\xi_c = 2\,\mathrm{CFL}^2/(4+\mathrm{CFL}^2)$.

Expected: with linear functions the last node has the mass $\xi m$, but the force of a whole point:
$\mu = \xi$, $z = \mathrm{CFL}^2/\xi$ in the equations of a step, which grow for $\xi < \xi_c$ (up
to 7 % more, since the node before is not fixed). This is a property of the scheme. With the
corner-averaged functions the point has the weight $(\xi+q)/2$ and the slope $(\xi+q)/(2qh)$,
$q = 1/(4n)$, while it is within a quarter of its box of the grid line: bounded when
$\mathrm{CFL}^2 < 4q/(2-q)$, a Courant number of 0.52 with two points per cell. Smoother functions
have, at a distance $\delta$ (in cells) within the end of their reach, a weight and a slope with
$z/\mathrm{CFL}^2$ = slope$^2$/weight of $2n$ (uGIMP), 2 (quadratic) and $3\delta/2$ (cubic): stable
for Courant numbers below $1/\sqrt n$ with uGIMP, 1 with quadratic functions. A node with less than
$10^{-9}$ of the mean mass of the points does not take part in velocity gradients; what grows then
does so slowly, by $3\cdot10^{-4}$ a step. All growth is compared with the eigenvalues of the linear
scheme, as matrices.

Of the other schemes MUSL and USF are stable at any weight, since the velocities that their
gradients come from are means of those of points. The affine fields of hats (APIC, MLS) bring the
velocity of the node back to it unfiltered: with any integrator it grows for $\xi < \mathrm{CFL}^2/
4$. PIC and XPIC hardly move the bound of USL.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    may_fail=True,
)
