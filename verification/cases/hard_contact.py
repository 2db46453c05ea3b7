"""Bars of very unequal density or stiffness, and bars whose contact lies on walls."""

from __future__ import annotations

from _bars import judge, measure, scene
from harness.case import Case

CASE = Case(
    family="Hard cases",
    title="Contact of unequal bars, on walls, and with a layer on a wall",
    statement=r"""
The bars of *Two bars collide* under hard conditions.

- `kind=impedance ratio=1000`: density and modulus 1:1000, equal transit times. Exact: the
  rigid-body result with $e = 1$, contact for $2L/c$. The heavy bar covers the node and acts as a
  mirror that rests; the lumped contact gives $1 - e$.
- `kind=stiff ratio=10000`: modulus 1:10000, density and length equal. The stiff bar moves as a
  rigid body of the mass $m = \rho L A$: $\rho c A (v - V) = m \dot V$ until the wave in the soft
  bar is back, so that the contact stress is $\rho c v\,e^{-ct/L}$, it leaves with $v (1 -
  e^{-2})$, and $e = 1 - 2 e^{-2} = 0.729$.
- `kind=layer`: bar 2 is one cell thick and fixed to the end of the grid: a rigid wall, $e = 1$.
- Bars one cell wide between smooth walls: every node of the contact lies on a wall. The walls
  must not matter: all as in TYPE 1.
- Equal bars with steps close to the limit of the edges. An edge point alone on a node of weight
  $w$ makes $K = 1/(w h^2)$ once its box is inside the cell, $16 n^2 w/h^2$ before: at most
  $4n/h^2$, at $w = 1/(4n)$, and the filter is $\mu = w$. The condition $c^2 K \Delta t^2 \le 4/(2
  - \mu)$ becomes a Courant number of at most $1/\sqrt{2n - 1/4}$: 0.516, 0.417, 0.359 for 2, 3, 4
  points per cell, less than inside a body (0.756 to 0.770). Contacts hold edges at such weights
  for long. Runs just below must not gain energy.
""",
    source="Characteristics of rods.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="defect_size",
    order=1.0,
)
