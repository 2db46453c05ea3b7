"""A bar that is pulled until its points no longer share nodes."""

from __future__ import annotations

import numpy as np
from _freebodies import ALL_DIGITS, free_box, join
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import DIM, NVEL, UP, Array, Body, Points, Scene, lattice
from harness.scheme import FEWEST_CELLS

SPACING, DENSITY, YOUNG = 0.1, 1000.0, 1e6
WAVE_SPEED = float(np.sqrt(YOUNG / DENSITY))
#: Speed of the ends of the bar over that of waves: none comes far while it is pulled.
SPEED = 20.0
#: Stretch at the end, cells a step, frames.
LARGEST, STRIDE, FRAMES = 3.0, 0.05, 40
#: Cells across, by directions of the grid; rollers on the sides.
WIDTH = {1: 1, 2: 1, 3: 1}


def splits(p: Parameters) -> float:
    """Return stretch from which on neighbours can be without common node."""
    if p.scheme.domains not in ("", "ugimp"):
        return np.inf
    reach = {"cpdi": 1.0 + 0.25 / p.ppc, "ugimp": 1.0 + 0.5 / p.ppc, "quadratic": 1.5, "cubic": 2.0}
    return p.ppc * (2.0 * reach.get(p.mapping, 1.0) - 1.0)


def pairs(p: Parameters) -> bool:
    """Tell whether single pairs of points are looked at instead of a bar."""
    return "stretch" in p.options


def scene(p: Parameters) -> Scene:
    """Return the scene: a bar along the vertical, or pairs of points far apart along x."""
    return pair_scene(p) if pairs(p) else bar_scene(p)


def pair_scene(p: Parameters) -> Scene:
    """Return the scene: `cells` pairs at all phases to the nodes; one step."""
    gap = p.number("stretch", 1.0) / p.ppc
    box = SPACING / p.ppc
    apart = int(np.ceil(gap)) + 5
    parts: list[Points] = []
    for i in range(p.cells):
        first = (3 + apart * i + (i + 0.5) / p.cells) * SPACING
        for place, way in ((first, -1.0), (first + gap * SPACING, 1.0)):
            parts.append(
                lattice(1, [place - box / 2], [place + box / 2], [1], DENSITY, [way * WAVE_SPEED])
            )
    counts = [3 + apart * p.cells + 4]
    dt = 1e-3 * SPACING / WAVE_SPEED
    return Scene(
        1,
        [n * SPACING for n in counts],
        counts,
        [Body("pairs", join(parts), YOUNG, 0.0)],
        dt,
        dt,
        mapping=p.mapping,
        digits=ALL_DIGITS,
    )


def bar_scene(p: Parameters) -> Scene:
    """Return a bar with velocities in proportion to the distance from the middle."""
    dim, up, length = DIM[p.sim_type], UP[p.sim_type], p.cells * SPACING
    counts = [max(WIDTH[dim], FEWEST_CELLS[p.mapping])] * dim
    counts[up] = int(p.cells * LARGEST) + 6
    lower, upper = np.zeros(dim), np.array(counts, float)
    lower[up] = counts[up] / 2 - p.cells / 2
    upper[up] = lower[up] + p.cells
    speed = SPEED * WAVE_SPEED

    def velocity(x: Array) -> Array:
        v = np.zeros((len(x), NVEL[p.sim_type]))
        v[:, up] = speed * (2.0 * (x[:, up] - lower[up] * SPACING) / length - 1.0)
        return v

    size = np.round((upper - lower) * p.ppc).astype(int)
    points = lattice(p.sim_type, lower * SPACING, upper * SPACING, list(size), DENSITY, velocity)
    t_stop = (LARGEST - 1.0) * length / (2.0 * speed)
    steps = FRAMES * int(np.ceil(t_stop * speed / (STRIDE * SPACING) / FRAMES))
    sides = {f"{'xyz'[d]}_{end}": 1 for d in range(dim) if d != up for end in ("lower", "upper")}
    return Scene(
        p.sim_type,
        [n * SPACING for n in counts],
        counts,
        [Body("bar", points, YOUNG, 0.0, free_box(dim, sides))],
        t_stop,
        t_stop / steps,
        FRAMES,
        p.mapping,
        digits=ALL_DIGITS,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return share of pairs that feel each other; or stress and gaps of the middle of the bar."""
    if pairs(p):
        rate = np.abs(out.points()[1]["velocity_gradient"][:, 0, 0]) * SPACING / WAVE_SPEED
        felt = (rate > 1e-9).reshape(-1, 2)
        alone = np.sum(felt[:, 0] != felt[:, 1])
        return {"parted": float(np.mean(~felt)), "one-sided": float(alone)}
    up, length = UP[p.sim_type], p.cells * SPACING
    frames = list(out.points())
    start = frames[0].x[:, up]
    middle = np.abs(start - np.mean(start)) < 0.35 * length
    whole, scatter, gaps, last = 0.0, 0.0, 0.0, 0.0
    for frame in frames[2:]:
        stretch = 1.0 + 2.0 * SPEED * WAVE_SPEED * frame.time / length
        stress = frame["cauchy_stress"][middle, up, up] / (YOUNG * np.log(stretch))
        last = float(np.mean(stress)) - 1.0
        if stretch > splits(p):
            continue
        heights = np.unique(np.round(frame.x[middle, up] / SPACING, 9))
        whole = max(whole, abs(last))
        scatter = max(scatter, float(np.std(stress)))
        gaps = max(gaps, float(np.max(np.diff(heights))) * p.ppc / stretch)
    return {"mean": whole, "scatter": scatter, "gap": gaps, "last": last}


def judge(r: Results) -> list[Finding]:
    """Expect widths of the functions; the logarithmic law until then."""
    findings = []
    for p, m in r:
        end = f", {p.cells} {'pairs' if pairs(p) else 'cells'}"
        if pairs(p):
            share = (p.number("stretch", 1.0) - splits(p)) / p.ppc
            parted = Finding(f"share of pairs without common node{end}", m["parted"])
            parted.expected = min(1.0, max(0.0, share))
            parted.low = parted.expected - 1.5 / p.cells
            parted.high = parted.expected + 1.5 / p.cells
            parted.reason = (
                "(F - F_0)/n, F_0 as in the statement: phases at which the supports miss"
            )
            both = Finding(f"pairs of which only one feels{end}", m["one-sided"], 0.0, 0.0)
            both.reason = "sharing a node is mutual"
            findings += [parted, both]
            continue
        why = f"T = M ln F until F = {min(splits(p), LARGEST):g}"
        mean = Finding(f"mean of the stress over M ln F, less 1{end}", m["mean"], 0.0, 0.01)
        mean.reason = why + "; rate form: M dt int L^2/2, 0.15 %, and crossings"
        scatter = Finding(f"scatter of the stress over M ln F{end}", m["scatter"], 0.0, 0.03)
        scatter.reason = "velocities at the centroids of the nodes' points instead of the nodes"
        gap = Finding(f"largest gap between neighbours over the mean one{end}", m["gap"], 0.0, 1.2)
        gap.reason = "no split, which would leave twice the gap, while neighbours share nodes"
        findings += [mean, scatter, gap]
        fallen = Finding(f"mean of the stress over M ln F, less 1, at F = 3{end}", m["last"])
        if splits(p) < LARGEST:
            fallen.high, fallen.reason = -0.01, "parted points feel no more stretch"
        else:
            fallen.low, fallen.high, fallen.reason = -0.01, 0.01, why
        findings.append(fallen)
    return findings


CASE = Case(
    family="Hard cases",
    title="Tension to numerical fracture",
    statement=r"""
Neighbours can lose their last common node when their distance $F h/n$ exceeds what the functions
reach: $h$ for linear functions, $h + h/(2n)$ for corner averages over boxes that do not grow,
$h + h/n$ for uGIMP, $2h$ and $3h$ for quadratic and cubic splines. So a bar with $n$ points a cell
can break **from $F_0 = n$ on, with averages from $n + 1/2$, uGIMP $n + 1$, splines $2n$, $3n$**.
*Pairs* (`stretch`) of points at a distance $F h/n$ at all phases to the nodes fly apart: the
share $(F - F_0)/n$ of them must see no velocity gradient, both points of a
pair alike.

*Bar*: velocities grow in proportion to the distance from the middle, the ends at 20 times the
wave speed, so that inertia stretches the bar uniformly to $F = 3$. The stress is $T = M \ln F$.
It must be met within 1 % on average and without gaps up to the stretch above, and falls behind
after it.
""",
    source="Derived here from the widths of the functions",
    scene=scene,
    measure=measure,
    judge=judge,
)
