"""Standing wave in a bar between two walls."""

from __future__ import annotations

import numpy as np
from _modes import judge_mode, measure_mode, mode_scene
from _waves import LENGTH, Bar
from harness.case import Case, Finding, Measures, Output, Parameters, Results, near
from harness.scene import Scene

#: Published E_u of linear functions, 2 points per cell, A = 1e-4, CFL 0.2, by cells.
PUBLISHED = {
    2: 6.80998e-5,
    4: 3.11462e-5,
    8: 8.91691e-6,
    16: 2.27846e-6,
    32: 5.72048e-7,
    64: 1.43153e-7,
    128: 3.58410e-8,
}


def wave_number(p: Parameters) -> float:
    """Return k of mode `mode`."""
    return p.number("mode", 1.0) * np.pi / LENGTH


def scene(p: Parameters) -> Scene:
    """Return a bar along one axis with smooth walls all around."""
    return mode_scene(p, Bar(p), wave_number(p))


def measure(p: Parameters, out: Output) -> Measures:
    """Return the errors."""
    return measure_mode(p, out, wave_number(p))


def judge(r: Results) -> list[Finding]:
    """Compare with theory and, where the row says so, with published values."""
    findings = judge_mode(r, wave_number)
    if r.first.text("published", "no") == "yes":
        for p, m in r:
            findings.append(
                near(
                    f"published E_u, {p.cells} cells",
                    m["e_u_absolute"],
                    PUBLISHED[p.cells],
                    1e-3 if p.cells <= 64 else 2e-3,
                    "Nguyen, de Vaucorbeil and Bordas (2023), companion data; three digits: the "
                    "source takes the largest of all steps and weighs with current volumes",
                )
            )
    return findings


CASE = Case(
    family="Axial bar",
    title="Standing wave in a bar between two walls",
    statement=r"""
A bar $0 \le X \le L$ in uniaxial strain, both ends fixed, starts with the velocity
$A\omega\sin kX$ at zero displacement. Exact: $u = A \sin kX \sin \omega t$, $\omega = kc$,
$c = \sqrt{M/\rho}$, $M = \lambda + 2G$, $k = \pi/L$; stress $MkA\cos kX\sin\omega t$, and
$\nu/(1-\nu)$ of it across the bar.

Measured at 40 instants of one period: errors of displacement, velocity and stress; the frequency,
by a fit; the difference from the wave that the discrete equations have by theory. The bar lies
along each axis of each TYPE; in TYPE 4 along the axis of symmetry, solid or a tube.

Expected: order 2 for the displacement, with just the phase error of lumped mass,
$1-\omega_h/\omega = (\kappa-\mathrm{CFL}^2/24)(kh)^2$, $\kappa = 1/8+1/(24n^2)$ for $n$ points per
cell. Order 2 for velocities against the exact ones half a step before, to which those of a frame
belong. Order 1 for stresses at points, since a linear function gives all points of a cell the same;
order 2 in the middle of the cells. With symmetric points the corner-averaged functions have the
same discrete equations.
""",
    source=r"""Elementary. Discrete equations: `docs/verification.md`. Published values of $E_u$:
Nguyen, de Vaucorbeil and Bordas, The Material Point Method (2023), companion data; their body force
does not matter at $A = 10^{-4}$.""",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
