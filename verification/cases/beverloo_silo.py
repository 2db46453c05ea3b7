"""A silo empties through a slot in its floor: the flux by the law of Beverloo."""

from __future__ import annotations

import math

import numpy as np
from _sand import DENSITY, GRAVITY, RestingBody, Sand
from harness.case import Case, Finding, Measures, Output, Parameters, Published, Results
from harness.scene import Body, Scene, lattice, numbers, stable_dt
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Widths of the slot: width of the silo (all of it), height of the filling; where a row refines.
SILO, FILLING = 4.0, 4.0
#: Cells of the half silo and of the filling where the slot is varied at one spacing.
HALF, HIGH = 32, 48
#: Cells of the floor's thickness, and below it.
FLOOR, BELOW = 2, 4
#: Modulus over the weight of the filling, Courant number, friction of floor and walls.
STIFFNESS, CFL, RUBBING = 500.0, 0.4, 0.4
#: Time of the run over sqrt(D/g), of which the second half is measured; frames.
TIMES, FRAMES = 5.0, 40
#: C of Q = C sqrt(g) D^(3/2), an area over time, for the law of friction below.
CONTINUUM, SOURCE = 1.504, "Staron et al. 2012, Basilisk"
#: Cells by which contact narrows the slot: one at each edge.
NARROWER = 2
LAW = {"mu_s": 0.4, "mu_2": 0.68, "i_0": 0.4}


class Silo:
    """The numbers of one run, from its parameters; lengths in widths of the slot or cells."""

    def __init__(self, p: Parameters) -> None:
        #: With `vary=slot` the resolution is that of the slot in a silo of one size.
        self.varies = p.text("vary", "silo") == "slot"
        #: Width of the slot.
        self.slot = 1.0
        self.h = self.slot / p.cells
        self.half = HALF if self.varies else round(0.5 * SILO * p.cells)
        self.high = HIGH if self.varies else round(FILLING * p.cells)
        self.base = (BELOW + FLOOR) * self.h
        self.height = self.high * self.h
        # Twenty grains a slot where the silo is refined, and three a cell where the slot varies.
        self.sand = Sand.under(self.height, STIFFNESS, self.h / 3 if self.varies else 0.05, **LAW)
        self.stop = TIMES * math.sqrt(self.slot / GRAVITY)


def scene(p: Parameters) -> Scene:
    """Return half a silo: a smooth plane of symmetry, a floor of rigid points with a slot."""
    run, n = Silo(p), p.ppc
    width, floor = run.half * run.h, BELOW * run.h
    if p.cells % 2:
        raise ValueError("half of the slot has whole cells")
    rows = [run.half * n, run.high * n]
    filling = lattice(2, [0.0, run.base], [width, run.base + run.height], rows, DENSITY)
    edge = p.cells // 2
    ledge = lattice(
        2,
        [edge * run.h, floor],
        [width, run.base],
        [(run.half - edge) * n, FLOOR * n],
        100.0 * DENSITY,
    )
    walls = 'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {1, 1, -1, -1}'
    held = 'boundary-class = "AssignedVelocity"\n    boundary-props = {0.0, 0.0}'
    contact = f"""contact
{{
    class = "ContactRigid_ReflectedBoundary"
    name = "floor"
    properties = {{{numbers([RUBBING])}}}
    str-properties = {{"ledge", "sand"}}
}}
"""
    sand = RestingBody(
        "sand", filling, 1.0, 0.0, walls, run.sand.material(), surface=0.5 * run.h / n
    )
    cells = [run.half, run.high + FLOOR + BELOW + 2]
    return Scene(
        2,
        [k * run.h for k in cells],
        cells,
        [sand, Body("ledge", ledge, run.sand.youngs_modulus, 0.3, held)],
        run.stop,
        stable_dt(run.slot, p.cells, run.sand.wave_speed, run.stop, CFL, FRAMES),
        FRAMES,
        p.mapping,
        gravity=[0.0, -GRAVITY],
        contacts=[contact],
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return the flux through the slot once it is steady, and how it changes."""
    run, frames = Silo(p), out.points()
    volume = out.scene.bodies[0].points.volume
    middle = (BELOW + 0.5 * FLOOR) * run.h
    times, gone = [], []
    for frame in frames:
        times.append(frame.time)
        gone.append(2.0 * float(np.sum(volume[frame.x[:, 1] < middle])))
    t, area = np.array(times), np.array(gone)

    def rate(begin: float, end: float) -> float:
        part = (t >= begin * run.stop) & (t <= end * run.stop)
        return float(np.polyfit(t[part], area[part], 1)[0])

    flux, early, late = rate(0.5, 1.0), rate(0.5, 0.75), rate(0.75, 1.0)
    last = frames[-1]
    head = float(np.max(last.x[last.x[:, 0] > 0.5 * run.half * run.h, 1])) - run.base
    return {
        "c": flux / (math.sqrt(GRAVITY) * run.slot**1.5),
        "drift": late / early - 1.0,
        "emptied": area[-1] / (2.0 * float(np.sum(volume))),
        "head": head / run.slot,
        "flux": flux,
    }


def fit(r: Results) -> tuple[float, float, float]:
    """Return C and k of a line through Q^(2/3) over D, and the exponent of D - 2 h; k in cells.

    The spacing is the length of all runs, which a slot of width 1 has as 1/cells.
    """
    slots = np.array(r.cells, dtype=float)
    # Q/sqrt(g h^3), from Q/sqrt(g D^3).
    flux = np.array(r.column("c")) * slots**1.5
    slope, start = np.polyfit(slots, flux ** (2.0 / 3.0), 1)
    exponent = float(np.polyfit(np.log(slots - NARROWER), np.log(flux), 1)[0])
    return float(slope) ** 1.5, -float(start / slope), exponent


def judge(r: Results) -> list[Finding]:
    """Compare flux, its drift, and the form of the law."""
    findings = []
    for p, m in r:
        findings.append(
            Finding(
                f"drift of the flux, {p.cells} cells",
                m["drift"],
                -0.15,
                0.15,
                0.0,
                "the flux does not depend on the head as long as that exceeds the slot twice; "
                "5 % are published, and each half lasts so short that a tenth more is noise",
            )
        )
    if Silo(r.first).varies:
        constant, k, exponent = fit(r)
        findings += [
            Finding("C of the fit", constant, 0.8 * CONTINUUM, 1.2 * CONTINUUM, CONTINUUM, FIFTH),
            Finding(
                "k of the fit in cells",
                k,
                1.0,
                3.0,
                NARROWER,
                "contact begins when both bodies reach the same node, up to a cell before their "
                "points meet, at each of the two edges; half a cell at each",
            ),
            Finding(
                "exponent of D - 2 h",
                exponent,
                1.4,
                1.6,
                1.5,
                "Beverloo's law in a plane; 0.1 by the published scatter",
            ),
        ]
    else:
        p, m = r.parameters[-1], r.measures[-1]
        findings.append(
            Finding(
                f"C, {p.cells} cells",
                m["c"] / (1.0 - NARROWER / p.cells) ** 1.5,
                0.8 * CONTINUUM,
                1.2 * CONTINUUM,
                CONTINUUM,
                FIFTH + ", with D - 2 h in place of D: a cell less at each edge",
            )
        )
    return findings


#: Why C has its bounds.
FIFTH = "that of the continuum with the same mu(I); a fifth: it changes so with walls and d"


def published(r: Results) -> list[Published]:
    """Return the constant of the continuum, and the exponent."""
    if Silo(r.first).varies:
        constant, _, exponent = fit(r)
        return [
            Published("C of Q = C sqrt(g) (D - k h)^1.5, k fitted", SOURCE, CONTINUUM, constant),
            Published("exponent of D - 2 h", "Beverloo et al. 1961, plane", 1.5, exponent),
        ]
    c, cells = r.measures[-1]["c"], r.parameters[-1].cells
    narrowed = c / (1.0 - NARROWER / cells) ** 1.5
    return [
        Published("C of Q = C sqrt(g) (D - 2 h)^1.5", SOURCE, CONTINUUM, narrowed),
        Published("C of Q = C sqrt(g) D^1.5", SOURCE, CONTINUUM, c),
    ]


CASE = Case(
    family="Granular",
    title="A silo empties through a slot",
    statement=r"""
A silo with smooth walls empties through a slot of the width $D$ in its floor (half of it, TYPE 2,
`Sand_SachithLocal`, pressure of rest at the start; the floor is a body of `AssignedVelocity`, with
friction by `ContactRigid_ReflectedBoundary`). Beverloo's law in a plane, with the flux $Q$ as area
over time:

$$Q = C\sqrt{g}\,(D - kd)^{3/2},$$

independent of the head. The continuum with $\mu_s = 0.4$, $\mu_2 = 0.68$, $I_0 = 0.4$ has $C =
1.504$ and $k = 0$ (Staron, Lagrée and Popinet, as given by the pages of Basilisk: read there).

Measured: the flux in the second half of $5\sqrt{D/g}$, and its change between the two halves of
that. The *grid* narrows the slot: contact with the floor begins where both bodies reach the same
node, up to a cell before their points meet, so that $D - 2h$ takes the place of $D - kd$.

- Silo refined with the slot (silo and filling 4 $D$): $C$ within a fifth of the published one at
  the finest resolution, with a cell less at each edge.
- `vary=slot`: slots of several widths in one silo of 64 by 48 cells; the resolution is the width in
  cells. The line through $Q^{2/3}$ over $D$ gives $C$ by its slope and $k$, in cells, by its zero;
  the exponent is that of $D - 2h$.

The sand is softer than grains are: $M = 500\,\rho g$ times the depth of the filling.
""",
    source="Beverloo, Leniger and van de Velde, Chem. Eng. Sci. 15 (1961) 260-269; Staron, Lagrée "
    "and Popinet, Phys. Fluids 24 (2012) 103301",
    scene=scene,
    measure=measure,
    judge=judge,
)
