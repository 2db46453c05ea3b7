"""What contact must not do: hold back, pull, drag, or break the balance of momentum."""

from __future__ import annotations

import numpy as np
from _contact import contact_force, contact_normal, sums
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import DIM, NVEL, Body, Scene, huang, lattice, stable_dt

#: Side of a block, density of the first, wave speed.
SIDE, DENSITY, SPEED = 1.0, 1000.0, 100.0
#: Density and modulus of the second block over those of the first.
HEAVY = 3.0
NU, MU = 0.3, 0.3
FRAMES = 10


class Pair:
    """The numbers of one run, from its parameters."""

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.dim, self.nvel = DIM[p.sim_type], NVEL[p.sim_type]
        self.h = SIDE / p.cells
        #: `together`, `apart`, `along`, `first_step` or `collide`.
        self.kind = p.text("kind", "together")
        #: Direction in which the blocks lie side by side.
        self.axis = int(p.number("axis", 1 if p.sim_type == 4 else 0))
        self.speed = 0.02 * SPEED
        self.normals = int(p.number("normals", 1))

    def velocities(self) -> tuple[list[float], list[float]]:
        """Velocities of both blocks."""
        # A direction that is no axis of the grid; TYPE 4: no motion along r, which strains a ring.
        oblique = [0.6, 0.5, 0.4][: self.nvel]
        if self.p.sim_type == 4:
            oblique = [0.0, 0.6, 0.0]
        one = [self.speed * c for c in oblique]
        two = list(one)
        if self.kind == "apart":
            two[self.axis] += self.speed
        elif self.kind == "along":
            two[self.across] += self.speed
        elif self.kind in ("first_step", "collide"):
            two = [-0.5 * c for c in one]
            if self.p.sim_type == 4:
                two[2] = 0.0
            two[self.axis] -= self.speed
        return one, two

    @property
    def across(self) -> int:
        """Component of the sliding of kind `along`."""
        return 2 if self.p.sim_type == 5 else (self.axis + 1) % self.dim

    @property
    def stop(self) -> float:
        """Time of the run: 6 transits of the block."""
        return 6.0 * SIDE / SPEED

    @property
    def dt(self) -> float:
        """Time step."""
        return stable_dt(SIDE, self.p.cells, SPEED, self.stop, 0.3, FRAMES)


def scene(p: Parameters) -> Scene:
    """Two touching blocks, the second heavier, in the middle of a grid without walls."""
    run = Pair(p)
    dim, h = run.dim, run.h
    one, two = run.velocities()
    # Room for the motion of 6 transits at up to 0.03 c.
    margin = 3 + int(np.ceil(0.2 * SIDE / h))
    cells = [p.cells + 2 * margin] * dim
    cells[run.axis] += p.cells
    low = [margin * h] * dim
    if p.sim_type == 4:
        cells[0], low[0] = p.cells + margin, 0.0
    first_low, second_low = list(low), list(low)
    second_low[run.axis] += SIDE
    counts, first_high = [p.cells * p.ppc] * dim, [x + SIDE for x in first_low]
    second = lattice(
        p.sim_type, second_low, [x + SIDE for x in second_low], counts, HEAVY * DENSITY, two
    )
    if run.kind == "along" and run.across < dim:  # on a plate that is longer than the block
        first_low[run.across] -= 2 * h
        first_high[run.across] += 3 * h
        counts = list(counts)
        counts[run.across] += 5 * p.ppc
    first = lattice(p.sim_type, first_low, first_high, counts, DENSITY, one)
    young = DENSITY * SPEED**2 * (1 + NU) * (1 - 2 * NU) / (1 - NU)
    stop = run.dt if run.kind == "first_step" else run.stop
    return Scene(
        p.sim_type,
        [n * h for n in cells],
        cells,
        [Body("one", first, young, NU), Body("two", second, HEAVY * young, NU)],
        stop,
        run.dt,
        1 if run.kind == "first_step" else FRAMES,
        p.mapping,
        p.contact,
        contacts=[huang("one", "two", MU, run.normals)],
        digits=17,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Largest contact force, changes of velocity and of momentum, balance at the nodes."""
    run = Pair(p)
    if run.kind == "first_step":
        return measure_step(run, out)
    one, two = run.velocities()
    initial = [np.pad(np.array(v), (0, 3 - len(v))) for v in (one, two)]
    mass = [np.sum(body.points.total_mass) for body in out.scene.bodies]
    #: Force that would stop the nodes of one body in a step.
    scale = np.max(out.nodes(0)[0]["mass"]) * run.speed / run.dt
    force = change = stress = 0.0
    totals = []
    for nodes, a, b in zip(out.nodes(0), out.points(0), out.points(1), strict=True):
        force = max(force, float(np.max(np.abs(contact_force(nodes, "one", "two")))))
        for k, frame in enumerate((a, b)):
            change = max(change, float(np.max(np.abs(frame["velocity"] - initial[k]))))
            stress = max(stress, float(np.max(np.abs(frame["cauchy_stress"]))))
        totals.append(sums(out, 0, a).momentum + sums(out, 1, b).momentum)
    # The radial momentum of TYPE 4 changes with the hoop stress.
    total = np.array(totals)[:, 1 if p.sim_type == 4 else slice(None)]
    return {
        "force": force / scale,
        "velocity": change / run.speed,
        "stress": stress / (DENSITY * SPEED**2),
        "momentum": float(np.max(np.abs(total - total[0]))) / (sum(mass) * run.speed),
        "exchanged": float(np.max(np.abs(sums(out, 0, a).velocity - initial[0]))) / run.speed,
    }


def measure_step(run: Pair, out: Output) -> Measures:
    """Compare the forces of the first step: without stress they are those of the contact."""
    before = [out.nodes(k)[0] for k in range(2)]
    after = [out.nodes(k)[1] for k in range(2)]
    m = [nodes["mass"][:, None] for nodes in before]
    momenta = [nodes["momentum"] for nodes in before]
    normal = contact_normal(after[0], "one", "two")
    found = contact_force(after[0], "one", "two")
    with np.errstate(invalid="ignore", divide="ignore"):
        stick = (m[0] * momenta[1] - m[1] * momenta[0]) / ((m[0] + m[1]) * run.dt)
        stick = np.where((m[0] > 0) & (m[1] > 0), stick, 0.0)
        pull = np.sum(stick * normal, axis=1, keepdims=True)
        slip = stick - pull * normal
        size = np.linalg.norm(slip, axis=1, keepdims=True)
        share = np.where(size > 0, np.minimum(1.0, MU * np.abs(pull) / size), 0.0)
    expected = np.where(pull < 0, pull * normal + share * slip, 0.0)
    scale = float(np.max(np.abs(expected)))
    length = np.linalg.norm(normal, axis=1)
    return {
        "balance": float(np.max(np.abs(after[0]["force"] + after[1]["force"]))) / scale,
        "formula": float(np.max(np.abs(found - expected))) / scale,
        "nodes_in_contact": float(np.sum(np.any(found != 0.0, axis=1))),
        "unit": float(np.max(np.abs(length[length > 0.0] - 1.0))),
        "applied": float(np.max(np.abs(after[0]["force"] - found))) / scale,
    }


def judge(r: Results) -> list[Finding]:
    """Round-off in all."""
    findings = []
    for p, m in r:
        run, label = Pair(p), f"{Pair(p).kind}, {p.cells} cells"
        eps = 2.2e-16
        steps = round(run.stop / run.dt)
        # Sums over the points of a node round off at the relative speed of their momenta.
        width = {"ugimp": 3, "quadratic": 3, "cubic": 4}.get(p.mapping, 2)
        sum_error = 4.0 * eps * (width * p.ppc) ** run.dim
        if run.kind == "first_step":
            findings += [
                below(f"F_1 + F_2 at the nodes, {label}", m["balance"], 0.0, "f1 + F, f2 - F"),
                below(f"F against the formula, {label}", m["formula"], 100 * eps, "round-off"),
                below(f"F against the force of the step, {label}", m["applied"], 0.0, "no stress"),
                below(f"|n| - 1, {label}", m["unit"], 4 * eps, "round-off"),
                Finding(
                    f"nodes in contact, {label}",
                    m["nodes_in_contact"],
                    (p.cells + 1.0) ** (run.dim - 1),
                    reason="all of the common face",
                ),
            ]
            continue
        findings.append(
            below(
                f"momentum, {label}",
                m["momentum"],
                eps * (steps + 10.0 * p.cells**run.dim),
                "opposite forces; a rounding a step, and sums over the points",
            )
        )
        if run.kind == "collide":
            findings.append(
                Finding(
                    f"velocity that the first block takes up, {label}",
                    m["exchanged"],
                    0.5,
                    reason="the blocks do collide",
                )
            )
            continue
        exact = run.kind == "apart"
        findings += [
            below(
                f"contact force over m_i v/dt, {label}",
                m["force"],
                0.0 if exact else sum_error,
                "no approach, no force: round-off of the momenta of the nodes",
            ),
            below(
                f"change of velocity over v, {label}",
                m["velocity"],
                steps * sum_error,
                "free flight: a rounding a step",
            ),
            below(
                f"stress over M, {label}",
                m["stress"],
                steps * sum_error,
                "no strain: roundings of the gradient, v dt/h a step",
            ),
        ]
    return findings


CASE = Case(
    family="Contact",
    title="What contact must not do",
    statement=r"""
Two touching blocks, the second three times as dense and stiff, without walls.

- `together`: both fly with one velocity, across the axes of the grid. No contact force, no
  stress, no change of velocity but for round-off.
- `apart`: they fly apart from the touch. No force at all: contact does not pull, though both
  still reach the same nodes.
- `along`: the second slides along the first, without load. No drag. (The first is a longer plate
  whose normal is used: a corner on a plane has no normal of its own.)
- `first_step`: one step of a collision, in which there is no stress yet. At each node the forces
  on the bodies are opposite to the last bit, and they are those of the formula: the force to a
  common velocity, its normal part when it pushes, and friction up to $\mu$ times that.
- `collide`: momentum is conserved to round-off through a collision with friction (TYPE 4: along
  the axis).
""",
    source="Definitions of the contact rule.",
    scene=scene,
    measure=measure,
    judge=judge,
)
