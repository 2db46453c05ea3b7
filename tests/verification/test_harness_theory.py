"""Closed forms against their expansions, limits and values that were derived by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from harness import theory


@pytest.mark.parametrize(
    ("n", "kappa", "a"), [(1, 1 / 6, 1 / 4), (2, 13 / 96, 3 / 16), (4, 0.127604, 0.171875)]
)
def test_constants(n: int, kappa: float, a: float) -> None:
    """Fractions for few points per cell."""
    assert theory.dispersion_constant(n) == pytest.approx(kappa, rel=1e-5)
    assert theory.filter_constant(n) == pytest.approx(a, rel=1e-14)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_constants_are_the_limits_of_the_symbols(n: int) -> None:
    """For long waves: the next term is (kh)^2 times smaller."""
    kh = 0.02
    k2, mu = theory.symbols(kh, n)
    assert (1.0 - mu) / kh**2 == pytest.approx(theory.filter_constant(n), rel=kh**2)
    ratio = math.sqrt(k2 * mu) / kh
    assert (1.0 - ratio) / kh**2 == pytest.approx(theory.dispersion_constant(n), rel=kh**2)


@pytest.mark.parametrize("kh", [0.1, 1.0, 3.0])
def test_one_point_at_the_middle(kh: float) -> None:
    """The difference and the mean of two nodes."""
    k2, mu = theory.symbols(kh, 1)
    assert k2 == pytest.approx(4.0 * math.sin(kh / 2) ** 2, rel=1e-13)
    assert mu == pytest.approx(math.cos(kh / 2) ** 2, rel=1e-13)


def test_points_on_nodes_are_not_filtered() -> None:
    """A shift by half a cell puts the single point on a node, where the filter is 1."""
    assert theory.symbols(1.0, 1, shift=0.5)[1] == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_frequency_ratio_has_the_term_of_the_time_step(n: int) -> None:
    """1 - ratio = (kappa - CFL^2/24)(kh)^2, up to the next term in kh."""
    kh, cfl = 0.05, 0.5
    constant = (1.0 - theory.frequency_ratio(kh, n, cfl)) / kh**2
    assert constant == pytest.approx(theory.dispersion_constant(n) - cfl**2 / 24, rel=2 * kh)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_stability_limit(n: int) -> None:
    """The shortest wave decides: 1/sqrt(5/3 + 1/(3 n^2)); waves were sampled up to it."""
    limit = theory.stability_limit(n)
    formula = 1.0 / math.sqrt(5.0 / 3.0 + 1.0 / (3.0 * n**2))
    assert limit == pytest.approx(formula, rel=2e-6)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_eigenvalues_leave_the_unit_circle_at_the_limit(n: int) -> None:
    """The shortest wave grows above the limit and no wave does below."""
    limit = theory.stability_limit(n)

    def largest(cfl: float) -> float:
        waves = np.linspace(0.01, math.pi, 300)
        return max(np.max(np.abs(theory.amplification(kh, n, cfl))) for kh in waves)

    assert largest(0.999 * limit) <= 1.0 + 1e-12
    assert largest(1.001 * limit) > 1.0 + 1e-4


@pytest.mark.parametrize("n", [1, 2, 4])
def test_energy_loss_is_that_of_the_eigenvalues(n: int) -> None:
    """|lambda|^2 over the steps of a period, up to the next term in kh."""
    kh, cfl = 0.05, 0.2
    size = float(np.max(np.abs(theory.amplification(kh, n, cfl))))
    steps = 2.0 * math.pi / (cfl * kh)
    loss = 1.0 - size ** (2.0 * steps)
    assert loss == pytest.approx(theory.energy_loss_per_period(kh, n, cfl), rel=kh)


def test_published_energy_loss() -> None:
    """32 cells, half a wave, two points per cell, CFL 0.2: 2.230e-4."""
    assert theory.energy_loss_per_period(math.pi / 32, 2, 0.2) == pytest.approx(2.230e-4, rel=5e-4)


def test_tent() -> None:
    """The linear function and the places of points."""
    assert theory.tent(np.array([-1.5, -1.0, -0.25, 0.0, 0.5, 2.0])).tolist() == [
        0.0,
        0.0,
        0.75,
        1.0,
        0.5,
        0.0,
    ]
    assert theory.point_offsets(2).tolist() == [0.25, 0.75]
    assert theory.point_offsets(1, shift=0.25).tolist() == [0.75]
