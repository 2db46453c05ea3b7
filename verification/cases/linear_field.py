"""Patch test: a velocity field that is linear in the position."""

from __future__ import annotations

import numpy as np
from _freebodies import ALL_DIGITS, EPS, free_faces
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import DIM, NVEL, Array, Body, Scene, lattice, shear_modulus
from harness.theory import filter_constant, node_functions

SPACING, DENSITY, YOUNG, POISSON, RATE = 0.1, 1000.0, 1e6, 0.3, 0.7
#: Smooth functions, and the nodes that they have at a point in each direction.
SMOOTH = {"ugimp": 3, "quadratic": 3, "cubic": 4}
#: Cells between the grid's faces and the body.
MARGIN = 2
#: Rates of the velocity components along the directions of the grid, over RATE: no two agree.
FIELDS = {
    1: [[0.9]],
    2: [[0.9, -0.4], [0.7, -0.6]],
    3: [[0.9, -0.4, 0.3], [0.7, -0.6, -0.8], [0.5, 0.2, 0.4]],
    4: [[0.9, 0.0], [0.0, -0.6], [0.7, 0.0]],
    5: [[0.9, -0.4], [0.7, -0.6], [0.5, -0.3]],
}


def field(p: Parameters) -> Array:
    """Return the velocity gradient (nvel, dim); TYPE 4: v_r, v_z, v_theta over r and z."""
    return RATE * np.array(FIELDS[p.sim_type])


def shift(p: Parameters) -> float:
    """Return offset of the lattice from the cells along each direction, in cells."""
    return p.number("shift", 0.0)


def scene(p: Parameters) -> Scene:
    """Return the scene: one step of a body away from the walls; TYPE 4: it begins on the axis."""
    dim = DIM[p.sim_type]
    first = np.full(dim, float(MARGIN)) + shift(p) * (1.0 + 0.3 * np.arange(dim))
    if p.sim_type == 4:
        first[0] = 0.0
    counts = [p.cells + 2 * MARGIN + 1] * dim
    velocity = np.zeros((NVEL[p.sim_type], dim)) + field(p)
    points = lattice(
        p.sim_type,
        first * SPACING,
        (first + p.cells) * SPACING,
        [p.cells * p.ppc] * dim,
        DENSITY,
        lambda x: x @ velocity.T,
    )
    dt = 1e-3
    return Scene(
        p.sim_type,
        [n * SPACING for n in counts],
        counts,
        [Body("patch", points, YOUNG, POISSON, free_faces(p))],
        dt,
        dt,
        mapping=p.mapping,
        digits=ALL_DIGITS,
    )


def gradient(p: Parameters, x: Array) -> Array:
    """Return the velocity gradient that points (n, 3, 3) must see, in all nine components."""
    exact = np.zeros((len(x), 3, 3))
    a = field(p)
    if p.sim_type != 4:
        exact[:, : len(a), : a.shape[1]] = a
        return exact
    r_rate, z_rate, t_rate = a[0, 0], a[1, 1], a[2, 0]
    radial, hoop = axisymmetric_factors(p, x[:, 0])
    exact[:, 0, 0], exact[:, 1, 1], exact[:, 2, 2] = r_rate * radial, z_rate, r_rate * hoop
    exact[:, 2, 0], exact[:, 0, 2] = t_rate * radial, -t_rate * hoop
    return exact


def axisymmetric_factors(p: Parameters, r: Array) -> tuple[Array, Array]:
    """Return dv/dr and v/r as found for v = r; a node's velocity is r_i + a h^2/r_i."""
    h, a = SPACING, filter_constant(p.ppc)
    cell = np.floor(r / h)
    inner, outer = cell * h, (cell + 1) * h
    at_inner = np.where(cell > 0, inner + a * h**2 / np.where(cell > 0, inner, 1.0), 0.0)
    at_outer = outer + a * h**2 / outer
    share = (r - inner) / h
    return (at_outer - at_inner) / h, ((1.0 - share) * at_inner + share * at_outer) / r


def in_turned_basis(stress: Array, angle: Array) -> Array:
    """Return stresses (n, 3, 3) in bases r, z, theta that have turned about the axis z."""
    turn = np.zeros_like(stress)
    turn[:, 0, 0] = turn[:, 2, 2] = np.cos(angle)
    turn[:, 0, 2], turn[:, 2, 0] = np.sin(angle), -np.sin(angle)
    turn[:, 1, 1] = 1.0
    return np.einsum("nik,nkl,njl->nij", turn, stress, turn)


def inside(p: Parameters, x: Array, points: Array) -> Array:
    """Tell which points see only nodes whose functions lie within the body."""
    far = {"cpdi": 1.0 + 0.25 / p.ppc, "ugimp": 1.0 + 0.5 / p.ppc, "quadratic": 1.5, "cubic": 2.0}
    reach = far.get(p.mapping, 1.0) + 1e-9
    # A node whose function does not end within the body lacks points.
    reach = 2.0 * reach if p.mapping in SMOOTH else reach + (shift(p) > 0)
    spread = 0.5 / p.ppc
    deep = np.ones(len(x), bool)
    for d in range(points.shape[1]):
        low, high = points[:, d].min() / SPACING - spread, points[:, d].max() / SPACING + spread
        s = x[:, d] / SPACING
        deep &= s <= high - reach
        if not (p.sim_type == 4 and d == 0):
            deep &= s >= low + reach
    return deep


def measure(p: Parameters, out: Output) -> Measures:
    """Return errors of the velocity gradient and of the stress after one step."""
    points, frame, dt = out.scene.bodies[0].points, out.points()[1], out.scene.dt
    deep = inside(p, points.x, points.x)
    exact = gradient(p, points.x)[deep]
    found = frame["velocity_gradient"][deep]
    g = shear_modulus(YOUNG, POISSON)
    lame = 2.0 * g * POISSON / (1.0 - 2.0 * POISSON)
    rate = 0.5 * (exact + np.swapaxes(exact, 1, 2))
    trace = np.trace(exact, axis1=1, axis2=2)
    stress = dt * (2.0 * g * rate + lame * trace[:, None, None] * np.eye(3))
    if p.sim_type == 4:
        stress = in_turned_basis(stress, dt * -exact[:, 0, 2])
    grown = frame["volume"][deep] / out.points()[0]["volume"][deep]
    worst = {
        "gradient": np.max(np.abs(found - exact)) / RATE,
        "stress": np.max(np.abs(frame["cauchy_stress"][deep] - stress)) / (g * dt * RATE),
        "volume": np.max(np.abs(grown - np.exp(dt * trace))) / (dt * RATE),
        "points": float(np.sum(deep)),
    }
    if p.sim_type == 4:
        edge = points.x[:, 0] < SPACING
        middle = deep & edge
        worst["hoop in the axis cell"] = float(
            np.mean(frame["velocity_gradient"][middle, 2, 2]) / field(p)[0, 0]
        )
    if p.sim_type == 1:
        last = np.argmax(points.x[:, 0])
        worst["edge"] = frame["velocity_gradient"][last, 0, 0] / field(p)[0, 0]
    return worst


def edge(p: Parameters) -> float:
    """Return L at the point next to the edge over the exact one, in one dimension.

    With linear functions 2/3 - 1/(6 n^2); with others a direct sum.
    """
    if p.mapping not in SMOOTH:
        return 2.0 / 3.0 - 1.0 / (6.0 * p.ppc**2)
    x, nodes = -(np.arange(6 * p.ppc) + 0.5) / p.ppc, np.arange(-3, 4)
    values, slopes = node_functions(p.mapping, x[:, None] - nodes, p.ppc)
    mass = values.sum(axis=0)
    velocity = np.where(mass > 0.0, x @ values / np.where(mass > 0.0, mass, 1.0), 0.0)
    return float(slopes[0] @ velocity)


def judge(r: Results) -> list[Finding]:
    """Expect exact to round-off inside; closed forms at the edge and on the axis."""
    findings = []
    for p, m in r:
        terms = (SMOOTH.get(p.mapping, 2) * p.ppc) ** DIM[p.sim_type] + 2
        extent = np.sqrt(DIM[p.sim_type]) * (p.cells + 2 * MARGIN)
        bound = 2 * DIM[p.sim_type] * terms * EPS * extent * 2
        why = "round-off: 2 d m eps v/h, v up to the rate times the extent of the grid"
        end = f", {p.cells} cells"
        findings.append(below(f"error of L{end}", m["gradient"], bound, why))
        # One rounding of the volume itself is 1/(dt rate) larger than that of its change.
        small = 2 * EPS / (1e-3 * RATE)
        findings.append(below(f"error of the stress{end}", m["stress"], 8 * bound, why))
        findings.append(below(f"error of V exp(dt tr L){end}", m["volume"], 3 * bound + small, why))
        layer = {"ugimp": 6, "quadratic": 7, "cubic": 9}.get(p.mapping, 4)
        fewest = float((p.ppc * (p.cells - layer)) ** DIM[p.sim_type])
        inner = Finding(f"points inside{end}", m["points"], fewest, reason="points of the lattice")
        findings.append(inner)
        if p.sim_type == 4:
            findings.append(
                near(
                    f"hoop rate in the axis cell over the exact one{end}",
                    m["hoop in the axis cell"],
                    1.0 + filter_constant(p.ppc),
                    bound,
                    "1 + a: the mean radius of the points around the node at h",
                )
            )
        if p.sim_type == 1 and shift(p) == 0.0:
            findings.append(
                near(
                    f"L at the edge over the exact one{end}",
                    m["edge"],
                    edge(p),
                    bound,
                    "the edge nodes have the mean velocity of the points on one side",
                )
            )
    return findings


CASE = Case(
    family="Invariance and conservation",
    title="Patch test: linear velocity field",
    statement=r"""
A lattice of points gets velocities $v = A x$; $A$ has all components that the TYPE has, no two of
them alike. After one step the velocity gradient of every point inside is $A$, the stress $\Delta
t\,(2 G D + \lambda\,\mathrm{tr} D\,1)$, the volume $V \exp(\Delta t\,\mathrm{tr} A)$, *to
round-off*: a node's velocity is $A$ times the centroid of what it is given, which is off the node
by the same amount everywhere (`shift` puts the lattice off the cells). The out-of-plane rows of
TYPE 5 and all six stresses of TYPE 3 are among them.

*Where it can't be exact.* At an edge the outermost node has points on one side only, so that $L$
in the edge cell is $A\,(2/3 - 1/(6 n^2))$ with $n$ points a cell and direction (smooth functions:
sums over the points). In TYPE 4 masses
grow with $r$, and the centroid of node $i$ lies at $r_i + a h^2/r_i$, $a = 1/6 + 1/(12 n^2)$: for
$v_r = A r$ the radial rate between nodes $i$ and $i+1$ is $A\,(1 - a h^2/(r_i r_{i+1}))$, the
hoop rate too large by the like, and in the axis cell both are $A\,(1 + a)$. The swirl $v_\theta =
A r$ is mapped alike; on the axis it must vanish as $v_r$ does, whatever the wall. Stresses are
told in the basis of the moved point, which has turned by $\Delta t\,v_\theta/r$. These closed
forms hold to round-off too. The error near the axis is one of lumped masses and does not shrink
with $h$.
""",
    source="Irons' patch test; centroids of hat functions, derived here",
    scene=scene,
    measure=measure,
    judge=judge,
)
