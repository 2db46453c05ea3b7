"""Closed steps of integrators and transfers: special cases by hand, limits, and conservation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from harness import theory
from harness.scheme import Scheme
from harness.steps import (
    ModeSteps,
    PointSums,
    energy_loss_per_period,
    march,
    stability_limit,
)

SOLVERS = ("USL", "MUSL", "USF")
SCHEMES = [
    Scheme(solver=solver, transfer=transfer, flip=flip, xpic=3)
    for solver in SOLVERS
    for transfer, flip in (
        ("FLIP", 1.0),
        ("FLIP", 0.9),
        ("PIC", 1.0),
        ("XPIC", 1.0),
        ("APIC", 1.0),
        ("MLS", 1.0),
    )
]
BASES = ("linear", "cpdi", "ugimp", "quadratic", "cubic")
EPSILON = float(np.finfo(float).eps)


def test_flip_with_the_stress_last_is_the_theory_of_the_bases() -> None:
    """Eigenvalues of both forms of the step."""
    for basis in BASES:
        known = np.sort_complex(theory.amplification(0.7, 2, 0.4, basis))
        steps = ModeSteps.of(Scheme(), 0.7, 2, basis=basis)
        found = np.sort_complex(np.linalg.eigvals(steps.matrix(0.4)).astype(complex))
        assert found == pytest.approx(known, abs=100 * EPSILON)


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("kh", [0.3, 1.5, 3.0])
def test_affine_fields_of_hats_are_not_filtered(n: int, kh: float) -> None:
    """|S|^2 + xi (1 - xi) |difference of the nodes|^2 = 1 at every place."""
    for shift in (0.0, 0.2):
        assert ModeSteps.of(Scheme(), kh, n, shift).mu_affine == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize(("basis", "spread"), [("quadratic", 1 / 4), ("cubic", 1 / 3)])
def test_spread_of_splines_is_the_same_everywhere(basis: str, spread: float) -> None:
    """The fit is T over h^2/4 and h^2/3."""
    sums = PointSums.of(0.9, 5, 0.13, basis)
    assert sums.fit == pytest.approx(sums.t / spread, rel=1e-13)


@pytest.mark.parametrize(
    ("n", "flip", "filtered"), [(1, 1 / math.sqrt(2), 2.0), (2, 1 / math.sqrt(1.75), math.sqrt(3))]
)
def test_limits_of_flip(n: int, flip: float, filtered: float) -> None:
    """USL: 1/sqrt(5/3 + 1/(3 n^2)); MUSL and USF: 2 at s = 1 and sqrt 3 at s = 2/3."""
    assert stability_limit(Scheme(), n) == pytest.approx(flip, rel=1e-5)
    for solver in SOLVERS[1:]:
        assert stability_limit(Scheme(solver=solver), n) == pytest.approx(filtered, rel=1e-5)


def test_limit_of_affine_hats() -> None:
    """Leap-frog steps on K = 4/h^2: c dt = h, whatever the integrator."""
    for solver in SOLVERS:
        found = stability_limit(Scheme(solver=solver, transfer="APIC"), 2)
        assert found == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.label or "USL FLIP")
@pytest.mark.parametrize("basis", BASES)
def test_limit_is_where_eigenvalues_leave_the_circle(scheme: Scheme, basis: str) -> None:
    """A mode grows above its limit and not below."""
    steps = ModeSteps.of(scheme, 2.1, 2, basis=basis)
    assert steps.growth(0.999 * steps.limit()) <= 1.0 + 1e-7
    assert steps.growth(1.001 * steps.limit()) > 1.0 + 1e-4


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.label or "USL FLIP")
def test_determinant_is_the_factor_of_the_quadratic_form(scheme: Scheme) -> None:
    """Of the matrix, and of V x' for two steps that follow each other."""
    steps, cfl = ModeSteps.of(scheme, 0.8, 2, basis="cpdi"), 0.4
    matrix = steps.matrix(cfl)
    assert steps.determinant(cfl) == pytest.approx(np.linalg.det(matrix), abs=10 * EPSILON)
    state = np.array([0.3, -0.7])
    before, after = steps.energy(*state, cfl), steps.energy(*(matrix @ state), cfl)
    assert after == pytest.approx(steps.determinant(cfl) * before, abs=10 * EPSILON)


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.label or "USL FLIP")
def test_march_follows_the_matrix(scheme: Scheme) -> None:
    """Velocity and stress of the march are powers of the matrix."""
    steps, cfl = ModeSteps.of(scheme, 1.1, 3, 0.1, "quadratic"), 0.3
    found = march(steps, 0.8 - 0.3j, cfl, 7)
    state = np.linalg.matrix_power(steps.matrix(cfl), 7) @ np.array([0.8 - 0.3j, 0.0])
    assert [found.velocity[-1], found.stress[-1]] == pytest.approx(list(state), abs=100 * EPSILON)


def test_what_waves_lose() -> None:
    """FLIP with MUSL and USF: nothing; PIC: 2 pi a kh/C; its share in blends; XPIC: the square."""
    kh, n, cfl = 0.05, 2, 0.2
    a = theory.filter_constant(n)
    for solver in SOLVERS[1:]:
        assert energy_loss_per_period(Scheme(solver=solver), kh, n, cfl) < 1e-12
    loss = 1.0 - math.exp(-2.0 * math.pi * a * kh / cfl)
    for solver in SOLVERS:
        found = energy_loss_per_period(Scheme(solver=solver, transfer="PIC"), kh, n, cfl)
        assert found == pytest.approx(loss, rel=kh)
    blend = energy_loss_per_period(Scheme(solver="MUSL", flip=0.9), kh, n, cfl)
    assert blend == pytest.approx(1.0 - math.exp(-0.2 * math.pi * a * kh / cfl), rel=kh)
    second = energy_loss_per_period(Scheme(solver="USF", transfer="XPIC", xpic=2), kh, n, cfl)
    assert second == pytest.approx(2.0 * math.pi * (a * kh**2) ** 2 / (kh * cfl), rel=kh)


def test_points_of_a_blend_forget() -> None:
    """The velocities of the start shrink by the part that a blend keeps."""
    steps = ModeSteps.of(Scheme(flip=0.75), 1.0, 2)
    assert march(steps, 1.0, 0.2, 3).own == pytest.approx([1.0, 0.75, 0.75**2, 0.75**3])


def test_staggered_start_of_the_stress_updated_first() -> None:
    """The first step changes no stress; then the stress is that of the places a step before."""
    steps = ModeSteps.of(Scheme(solver="USF", staggered=True), 0.4, 2)
    found = march(steps, 1.0, 0.3, 3)
    assert found.stress[1] == 0.0
    assert found.stress[2] == pytest.approx(found.moved[1])
