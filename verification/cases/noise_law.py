"""Forces of uniform stress on points that do not fit the cells."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import (
    DIM,
    Body,
    Points,
    Scene,
    pressure_wave_modulus,
    section,
    stable_dt,
)
from harness.theory import crossing_noise, node_functions

Array = npt.NDArray[np.float64]

YOUNG, DENSITY = 1e7, 1000.0
#: Half a wave of the body force that stretches the bar: over the bar it is uniform.
WAVE = 1e4
#: The bar before it is stretched, on a grid from 0 to 1 m.
BEGIN, END = 0.1, 0.75


def stretch(p: Parameters) -> float:
    """Return F, 1 and an irrational strain, so that the points take all places in cells."""
    return 1.0 + p.number("percent", 1.0) * 0.01 * np.sqrt(2.0)


def width(p: Parameters) -> int:
    """Return cells across in 2D and 3D: the node in the middle must be off the walls."""
    return 2 if p.mapping in ("linear", "cpdi") else 4


def poisson(p: Parameters) -> float:
    """Return the Poisson ratio: any but 0 would do in 1D too."""
    return 0.0 if p.sim_type == 1 else 0.3


def scene(p: Parameters) -> Scene:
    """Return a bar along x that the driver stretches uniformly at the start."""
    dim, h = DIM[p.sim_type], 1.0 / p.cells
    spacing = h / p.ppc
    # A lattice that begins at 0, so that its points stay k + 1/2 spacings times F.
    along = (np.arange(round(BEGIN / spacing), round(END / spacing)) + 0.5) * spacing
    across = (np.arange(width(p) * p.ppc) + 0.5) * spacing
    axes = np.meshgrid(*[along, *[across] * (dim - 1)], indexing="ij")
    x = np.column_stack([axis.ravel() for axis in axes])
    volume = np.full(len(x), spacing**dim)
    components = 3 if p.sim_type > 2 else dim
    points = Points(p.sim_type, x, volume, DENSITY * volume, np.zeros((len(x), components)))
    speed = np.sqrt(pressure_wave_modulus(YOUNG, poisson(p)) / DENSITY)
    dt = 0.1 * stable_dt(1.0, p.cells, speed, 1.0)
    constants = {
        "t_stop": dt,
        "amplitude": float((stretch(p) - 1.0) * WAVE / np.pi),
        "length": WAVE,
        "density": DENSITY,
        "E": YOUNG,
        "nu": poisson(p),
        "phi_x": float(np.pi / 2),
    }
    return Scene(
        p.sim_type,
        [1.0] + [width(p) * h] * (dim - 1),
        [p.cells] + [width(p)] * (dim - 1),
        [Body("bar", points, YOUNG, poisson(p), "CartesianSmoothBox")],
        dt,
        dt,
        1,
        p.mapping,
        driver=section("AxisAlignedDriver", constants),
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Measure forces along the bar at the nodes of its middle line, over stress times area."""
    dim, h, f = DIM[p.sim_type], 1.0 / p.cells, stretch(p)
    frame = out.nodes()[0]
    inside = (frame.x[:, 0] > BEGIN * f + 4 * h) & (frame.x[:, 0] < END * f - 4 * h)
    for d in range(1, dim):
        inside &= np.abs(frame.x[:, d] - 0.5 * width(p) * h) < 0.5 * h
    stress = out.points()[0]["cauchy_stress"][:, 0, 0]
    area = h ** (dim - 1)
    force = frame["force"][inside, 0] / (stress[0] * area)
    expected = f / p.ppc * surplus(p, frame.x[inside, 0] / h)
    acceleration = frame["force"][inside, 0] / frame["mass"][inside]
    speed_squared = pressure_wave_modulus(YOUNG, poisson(p)) / DENSITY
    return {
        "pattern": float(np.max(np.abs(force - expected))),
        "peak": float(np.max(np.abs(force))),
        "rms": float(np.sqrt(np.mean(force**2))),
        "acceleration": float(np.sqrt(np.mean(acceleration**2)) / speed_squared),
        "stress_spread": float(np.ptp(stress) / abs(stress[0])),
        "stress": float(stress[0] / (speed_squared * DENSITY * np.log(f))),
    }


def surplus(p: Parameters, nodes: Array) -> Array:
    """Return the sum over the points of the slopes of the functions of nodes at given places.

    Places are in cells; the sum over the lattice is direct.
    """
    step = stretch(p) / p.ppc
    count = int(np.ceil(2.5 / step))
    first = np.floor(nodes / step).astype(int)
    points = (first[:, None] + np.arange(-count, count + 1) + 0.5) * step
    return -np.sum(node_functions(p.mapping, points - nodes[:, None], p.ppc)[1], axis=1)


def judge(r: Results) -> list[Finding]:
    """Judge peak and mean of the forces; the mean acceleration grows with 1/h."""
    found = []
    for p, m in r:
        peak, rms = crossing_noise(p.ppc, stretch(p), p.mapping)
        label = f"{p.cells} cells"
        reason = (
            "sum over the lattice; F uniform to (pi/WAVE)^2, and places off by a third of that of "
            "the length, against the width of the pattern beside each point"
        )
        wide = abs(p.ppc / stretch(p) - round(p.ppc / stretch(p)))
        off = (np.pi / WAVE) ** 2 / 3.0 * p.cells * p.ppc / wide
        bound = 1e-4 if p.mapping in ("linear", "cpdi") else peak * off
        found.append(below(f"difference of forces, {label}", m["pattern"], bound, reason))
        reason = "the largest of these; 5 % less: the nodes do not take all places"
        name = f"largest force, {label}"
        found.append(Finding(name, m["peak"], 0.95 * peak, 1.0001 * peak, peak, reason))
        reason = "the same, mean over all places; 5 %: they are not all taken equally often"
        found.append(near(f"mean force, {label}", m["rms"], rms, 0.05, reason))
        reason = "M ln F at all points, F uniform to (pi/WAVE)^2"
        found.append(near(f"stress, {label}", m["stress"], 1.0, 1e-6, reason))
    if len(r.cells) > 1:
        reason = "forces do not depend on h, masses do: order -1"
        found.append(
            Finding("order of acceleration", r.order("acceleration"), -1.05, -0.95, -1.0, reason)
        )
    return found


CASE = Case(
    family="Manufactured solutions",
    title="Noise of forces in a uniformly stretched bar",
    statement=r"""
A bar of a lattice that fits the cells ($n$ points in each direction) is stretched by a uniform
$F$ along itself; its stress is uniform. The nodal forces inside should be 0. At a node the force
is the stress times the area times the difference of the numbers of points in the cells beside it,
times $F/n$: with linear functions **$F/n$** at places where one cell has one point more. The
corner-averaged functions take means over boxes of half the width of the points' own, which keep
their width: the largest force is **$2 F |F - 1|$**, whatever $n$ is, until that reaches $F/n$.
Boxes as wide as the points' own (uGIMP) and quadratic B-splines give **$|F - 1| F/n$**, cubic ones
**$\frac23 (F-1)^2 F/n$**; boxes that stretch would give 0. Also the root mean square has a closed
form: with $e$ the distance of $n/F$ from a whole number $(F/n)\sqrt{2e}$,
$2 e (F^2/n)\sqrt{4e/3}$, $|F-1|(F/n)\sqrt{2e-|1-1/F|}$, $|F-1|(F/n)\sqrt e$ and
$(F-1)^2(F/n)\sqrt{2e/3}$.

The forces do not depend on $h$, so that accelerations are wrong by a multiple of $1/h$. This is
why refinement at a fixed number of points per cell does not converge once points cross cells.

Measured: largest and root mean square force at the nodes of the middle line in the first node
frame, before any step, over stress times $h^{d-1}$; root mean square of force over mass, over
$c^2$.
""",
    source="Derived here; compare Steffen, Kirby and Berzins, Int. J. Numer. Meth. Engng 76 (2008)",
    scene=scene,
    measure=measure,
    judge=judge,
)
