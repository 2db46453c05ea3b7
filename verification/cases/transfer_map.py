"""What transfers do to the velocities of a body without forces."""

from __future__ import annotations

from functools import reduce

import numpy as np
from _freebodies import ALL_DIGITS, EPS, lopsided
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.frames import Frame
from harness.scene import DIM, NVEL, Array, Body, Scene, lattice
from harness.steps import LEAST_SPREAD
from harness.theory import node_functions

SPACING, DENSITY, SPEED = 0.1, 1000.0, 1.0
#: Way of a point in a step, and c dt, in cells: nothing moves, and stress does nothing.
WAY, COURANT = 1e-10, 1e-8
STEPS, MARGIN = 8, 4
#: Place of the body's corner in its cell.
PLACE = np.array([0.3, 0.17, 0.41])


def scene(p: Parameters) -> Scene:
    """Return a free block with velocities of which the grid sees a part."""
    dim = DIM[p.sim_type]
    lower = (MARGIN + PLACE[:dim]) * SPACING
    upper = lower + p.cells * SPACING

    def velocity(x: Array) -> Array:
        v = lopsided(p.sim_type, (x - lower) / (upper - lower))
        noise = np.random.default_rng(3).uniform(-0.3, 0.3, v.shape)
        turn = np.zeros_like(v)
        if dim > 1:
            turn[:, 0], turn[:, 1] = -(x[:, 1] - lower[1]) / SPACING, (x[:, 0] - lower[0]) / SPACING
        return SPEED * (v + noise + turn / p.cells)

    points = lattice(p.sim_type, lower, upper, [p.cells * p.ppc] * dim, DENSITY, velocity)
    dt = WAY * SPACING / SPEED
    modulus = DENSITY * (COURANT * SPACING / dt) ** 2
    cells = [p.cells + 2 * MARGIN + 1] * dim
    body = Body("block", points, modulus)
    return Scene(
        p.sim_type,
        [n * SPACING for n in cells],
        cells,
        [body],
        STEPS * dt,
        dt,
        STEPS,
        p.mapping,
        digits=ALL_DIGITS,
    )


class Maps:
    """The maps between points and nodes, as matrices.

    Parameters
    ----------
    p : Parameters
        The run; its scheme chooses the transfer.
    scene : Scene
        Its scene.
    """

    def __init__(self, p: Parameters, scene: Scene) -> None:
        self.scheme, points = p.scheme, scene.bodies[0].points
        dim = DIM[p.sim_type]
        lines = []
        for d in range(dim):
            distance = points.x[:, d, None] / SPACING - np.arange(scene.cells[d] + 1)
            value, slope = node_functions(p.mapping, distance, p.ppc)
            spread = np.sum(value * distance**2, axis=1, keepdims=True)
            fitted = (spread > LEAST_SPREAD) & (p.mapping != "linear")
            fit = np.where(fitted, -value * distance / np.where(fitted, spread, 1.0), slope)
            lines.append((value, fit, -distance * value))

        def product(chosen: list[Array]) -> Array:
            return reduce(lambda a, b: (b[:, :, None] * a[:, None, :]).reshape(len(a), -1), chosen)

        self.values = product([one[0] for one in lines])
        along = range(dim)
        self.fit = [product([one[int(e == d)] for e, one in enumerate(lines)]) for d in along]
        self.arm = [product([one[2 * (e == d)] for e, one in enumerate(lines)]) for d in along]
        self.mass = points.total_mass
        nodal = self.mass @ self.values
        self.inverse = np.where(nodal > 0.0, 1.0 / np.where(nodal > 0.0, nodal, 1.0), 0.0)

    def to_nodes(self, velocity: Array, affine: list[Array] | None = None) -> Array:
        """Return nodal velocities."""
        momentum = self.values.T @ (self.mass[:, None] * velocity)
        for arm, slope in zip(self.arm, affine or [], strict=False):
            momentum += arm.T @ (self.mass[:, None] * slope)
        return self.inverse[:, None] * momentum

    def run(self, velocity: Array, steps: int) -> list[Array]:
        """Return the velocities of the points after 0, 1, ... steps without forces."""
        v, affine, shown = velocity, None, [velocity]
        if self.scheme.transfer in ("APIC", "MLS"):
            affine = [fit @ self.to_nodes(v) for fit in self.fit]
        for _ in range(steps):
            nodes = self.to_nodes(v, affine)
            if affine is not None:
                affine = [fit @ nodes for fit in self.fit]
            new = nodes.copy()
            if self.scheme.transfer == "XPIC":
                rest = nodes
                for _ in range(self.scheme.xpic - 1):
                    rest = rest - self.to_nodes(self.values @ rest)
                    new += rest
            kept = self.scheme.flip if self.scheme.transfer == "FLIP" else 0.0
            v = kept * v + (1.0 - kept) * (self.values @ new)
            shown.append(v)
        return shown


def spin(frame: Frame, center: Array) -> Array:
    """Return the angular momentum of points or nodes."""
    return frame["mass"] @ np.cross(frame.x - center, frame["velocity"])


def measure(p: Parameters, out: Output) -> Measures:
    """Return differences from the maps, and changes of momentum, angular momentum and energy."""
    points = out.scene.bodies[0].points
    nvel, mass = NVEL[p.sim_type], points.total_mass
    known = Maps(p, out.scene).run(points.velocity, STEPS)
    frames, nodes = list(out.points()), list(out.nodes())
    first, total = frames[0], float(np.sum(mass))
    center = mass @ first.x / total
    size = p.cells * SPACING
    turns, grid = np.zeros((STEPS, 3)), np.zeros((STEPS, 3))
    difference = momentum = 0.0
    for step, frame in enumerate(frames[1:], 1):
        v = frame["velocity"]
        difference = max(difference, float(np.max(np.abs(v[:, :nvel] - known[step]))) / SPEED)
        change = np.max(np.abs(mass @ (v - first["velocity"]))) / (total * SPEED)
        momentum = max(momentum, float(change))
        turns[step - 1], grid[step - 1] = spin(frame, center), spin(nodes[step], center)
    scale = total * SPEED * size
    start = spin(first, center)
    aim = np.zeros_like(frames[0]["velocity"])
    aim[:, :nvel] = known[-1]
    lost = mass @ np.cross(first.x - center, aim) - start
    about = slice(0, 3) if DIM[p.sim_type] == 3 else slice(2, 3)
    energies = [float(mass @ np.sum(v**2, axis=1)) for v in (known[0], known[-1])]
    return {
        "d_v": difference,
        "momentum": momentum,
        "spin of points": float(np.max(np.abs(turns - start)[:, about])) / scale,
        "spin of the grid": float(np.max(np.abs(grid - grid[0])[:, about])) / scale,
        "start": float(np.max(np.abs(grid[0] - start)[about])) / scale,
        "spin lost": float(np.linalg.norm((turns[-1] - start)[about])) / scale,
        "spin lost, known": float(np.linalg.norm(lost[about])) / scale,
        "energy": energies[1] / energies[0],
    }


def judge(r: Results) -> list[Finding]:
    """Compare with the maps, and with what each transfer conserves."""
    findings = []
    for p, m in r:
        label = f"{p.cells} cells"
        frozen = "points move 1e-10 of a cell a step, which changes weights by as much; roundings"
        bound = 40.0 * STEPS * WAY
        flip = p.scheme.transfer == "FLIP" and p.scheme.flip >= 1.0
        findings += [
            below(f"d_v, {label}", m["d_v"], bound, f"the maps as matrices; {frozen}"),
            below(
                f"momentum, {label}",
                m["momentum"],
                10.0 * STEPS * EPS * (p.cells * p.ppc),
                "functions sum to 1; roundings of the sums",
            ),
            Finding(
                f"kinetic energy after {STEPS} steps over that of the start, {label}",
                m["energy"],
                0.0,
                1.0 + bound,
                reason="no transfer makes energy",
            ),
        ]
        if DIM[p.sim_type] == 1:
            continue
        if p.scheme.transfer in ("APIC", "MLS"):
            findings += [
                below(
                    f"angular momentum on the grid, {label}",
                    m["spin of the grid"],
                    bound,
                    f"points and affine fields carry all of it; {frozen}",
                ),
                near(
                    f"angular momentum that the points alone lose over m v L, {label}",
                    m["spin lost"],
                    m["spin lost, known"],
                    bound / m["spin lost, known"],
                    "a part goes to the affine fields, of order (h/L)^2; the maps as matrices",
                ),
            ]
        elif flip:
            findings.append(below(f"angular momentum, {label}", m["spin of points"], bound, frozen))
        else:
            findings.append(
                near(
                    f"angular momentum lost in {STEPS} steps over m v L, {label}",
                    m["spin lost"],
                    m["spin lost, known"],
                    bound / m["spin lost, known"],
                    f"the maps as matrices; {frozen}, over the loss",
                )
            )
        if p.scheme.transfer not in ("APIC", "MLS"):
            findings.append(
                below(
                    f"angular momentum from the points to the grid, {label}",
                    m["start"],
                    bound,
                    "the mean place of a point's nodes is the point: the map conserves it",
                )
            )
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Transfers of velocity without forces",
    statement=r"""
A free block, its edges anywhere in their cells, gets velocities that are smooth, that turn, and
that alternate at random from point to point. Steps are so short that no point moves, and stresses
do nothing: only the transfer acts. Measured over 8 steps: the velocities of all points against the
maps $S$ (nodes to points) and $S^+$ (points to nodes) written as matrices a second time; linear and
angular momentum; energy.

Expected, with $Q = S^+S$: FLIP changes nothing; a blend applies $a + (1-a) S S^+$, PIC $S S^+$,
XPIC of order $k$ the map $S (1 + (1-Q) + \dots + (1-Q)^{k-1}) S^+$, APIC and MLS the map of
velocities and affine fields, which begin as the fit to what the points map alone. All conserve
linear momentum to round-off. The way to the nodes conserves angular momentum, the way back loses
the moment $\sum_p m_p \sum_i N_i (x_i - x_p) \times v_i$ of order $(h/L)^2$ in each step, unless
the affine fields carry it: with APIC and MLS the angular momentum of the *nodes*, which has both,
stays to round-off, while that of the points alone does not.
""",
    source="Jiang, Schroeder, Selle, Teran and Stomakhin, ACM Trans. Graph. 34 (2015) 51 (affine "
    "fields); Hammerquist and Nairn, CMAME 318 (2017) 724-738 (XPIC); matrices derived here",
    scene=scene,
    measure=measure,
    judge=judge,
)
