"""Two elastic bars collide."""

from __future__ import annotations

from _bars import judge, measure, scene
from harness.case import Case

CASE = Case(
    family="Contact",
    title="Two bars collide",
    statement=r"""
Two elastic bars in uniaxial strain meet with the speed $v$ and touch through `ContactHuang`. In
TYPE 2 to 5 they lie between smooth walls, or have free sides (nu = 0).

**Exact solution** (rods, $c = \sqrt{M/\rho}$, $Z = \rho c$):

- contact stress $Z_1 Z_2 v/(Z_1 + Z_2)$, for equal bars $\tfrac12 \rho c v$;
- equal bars: contact for $2L/c$, the velocities change places, $e = 1$, no vibration is left;
- $L_2 = 2 L_1$ or $3 L_1$, same $Z$: $e = L_1/L_2$, the rest of the energy is vibration;
- equal $L/c$ and $Z_2/Z_1 = r$: $e = 1$, the velocities after are those of rigid bodies.

**Measured**: $1 - e/e_\mathrm{exact}$, contact stress and stress at mid-length, duration, the gap
at which contact begins, the smallest gap, momentum, energies.

**Expected of the implicit rule**, which gives both bodies one velocity at a node after the step.
A contact acts from nodes that both bodies reach, so it begins at the gap $(2r - 2\varphi - 1/n)
h$ between the edges ($r = 1 + 1/(4n)$ the reach of a point, $\varphi$ the distance of the middle
of the gap from a node in cells), and the bars stay apart by about that gap. The layer in between
is a spring and a dashpot in one: an edge point at $x$ beyond its first reach has the weight $w =
x/(2h)$ and the gradient $4 n w/h$ at the node, so that its stress, in units of $\rho c v_0$,
grows to $S = 4 n w^2/\epsilon$ ($v_0 = v/2$, $\epsilon = v_0/c$); the node pushes with $4 w S =
16 n w^3/\epsilon$, and in each step it takes the share $w$ of the edge's momentum, which is a
dashpot of $w U/(n\,\mathrm{CFL})$. The bar answers with $V - U$. The edge comes to rest at $w^* =
(\epsilon/16n)^{1/3}$, and to leading order

$$1 - e = \frac{1.2}{n\,\mathrm{CFL}}\,\frac hL\,\epsilon^{-1/3} (16 n)^{-2/3}.$$

The runs are compared with the integral of this model, with the wave reflected by the free end;
for $\varphi = \tfrac14, \tfrac12$ the other body covers the node, which doubles the velocity, and
at $\tfrac12$ two nodes act. So $1 - e$ is of first order in $h$, and larger for slow collisions.

**Expected of the explicit rule**, which gives one velocity before the forces of the step act: the
nodes keep $\Delta t f/m$, no stress is stored in the layer, and the contact is a dashpot alone,
$F = w U/(n\,\mathrm{CFL})$ with the weight of all points. Slow or coarse collisions are plastic,
$e \to 0$; the bars overlap. The same model without its spring gives $e$. At a fixed Courant
number it does not converge to 1.

**Where the surface of contact moves through the grid** (`frame=target`: bar 2 rests at first),
nodes are handed over: the node leaves one bar before the next one reaches the other, the force
drops, and the gap closes anew. Each hand-over costs an impulse in proportion to $h$, and there
are $vL/(ch)$ of them: $1 - e$ does not go to 0 with $h$. The linear functions do not converge
either, because the strain makes points cross cells (noise of the size of the stress over $n$,
whatever $h$). They bear slow edges only with a Courant number below $v/c$.

A longer bar stays in contact without force from $2L_1/c$ to $2L_2/c$; the spring of the layer
then gives back its energy, an impulse of at most $2 w^* \rho c h$, so that $e > L_1/L_2$, of
first order in $h$.

The rows at $v = 0.05 c$ are also held against 1.3 times the values of a small separate code with
functions averaged over whole domains (CPDI): 0.064, 0.031, 0.0156, 0.0080 at 20 to 160 cells.
""",
    source="Rods: characteristics; St Venant for unequal lengths. Contact: Huang, Zhang, Ma and "
    "Huang, Int. J. Numer. Meth. Engng 85 (2011) 498-517, whose numbers are not at hand. "
    "Lumped contact: own derivation, above.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="defect_size",
    order=1.0,
)
