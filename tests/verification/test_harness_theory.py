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


@pytest.mark.parametrize("basis", theory.BASES)
@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("shift", [0.0, 0.13])
def test_series_is_the_limit_of_the_symbols(basis: str, n: int, shift: float) -> None:
    """For long waves: the next term is (kh)^2 times smaller; 0.3 and more of each constant."""
    kh = 0.02
    kappa, a = theory.series(n, shift, basis)
    k2, mu = theory.symbols(kh, n, shift, basis)
    assert (1.0 - mu) / kh**2 == pytest.approx(a, rel=kh**2)
    assert (1.0 - math.sqrt(k2 * mu) / kh) / kh**2 == pytest.approx(kappa, rel=kh**2)


@pytest.mark.parametrize("basis", theory.BASES)
@pytest.mark.parametrize("n", [1, 2, 3, 4, 7, 100])
def test_constants_of_the_bases(basis: str, n: int) -> None:
    """Closed forms for symmetric points against sums over the points."""
    kappa, a = theory.series(n, basis=basis)
    assert theory.dispersion_constant(n, basis) == pytest.approx(kappa, rel=1e-12)
    assert theory.filter_constant(n, basis) == pytest.approx(a, rel=1e-12)


@pytest.mark.parametrize(
    ("basis", "kappas", "limit", "a"),
    [
        ("ugimp", [1 / 6, 0.13542, 0.12963, 0.12760], 1 / 8, 1 / 6),
        ("cpdi", [1 / 6, 0.13542, 0.12963, 0.12760], 1 / 8, 1 / 6),
        ("quadratic", [1 / 6, 0.26042, 0.24074, 0.25260], 1 / 4, 1 / 4),
        ("cubic", [1 / 3, 1 / 3, 1 / 3, 1 / 3], 1 / 3, 1 / 3),
    ],
)
def test_derived_constants_of_the_bases(
    basis: str, kappas: list[float], limit: float, a: float
) -> None:
    """Five digits for 1 to 4 points per cell, and many points: 1/n^2 away at most."""
    for n, kappa in enumerate(kappas, 1):
        assert theory.series(n, basis=basis)[0] == pytest.approx(kappa, abs=6e-6)
    assert theory.series(100, basis=basis) == pytest.approx((limit, a), abs=1e-4)


@pytest.mark.parametrize(
    ("basis", "symmetric", "worst"), [("quadratic", 1.350, 1.033), ("cubic", 1.486, 1.486)]
)
def test_stability_limits_of_splines(basis: str, symmetric: float, worst: float) -> None:
    """Two points per cell, on symmetric places and on the worst of all places."""
    assert theory.stability_limit(2, basis=basis) == pytest.approx(symmetric, abs=6e-4)
    limits = [theory.stability_limit(2, shift, basis) for shift in np.linspace(0.0, 0.5, 11)]
    assert min(limits) == pytest.approx(worst, abs=6e-4)


def test_boxes_of_half_a_cell_are_quadratic() -> None:
    """Boxes as wide as a cell make the quadratic B-spline, narrow boxes the hat."""
    x = np.linspace(-2.0, 2.0, 161)
    for one, two in zip(
        theory.node_functions("ugimp", x, 1), theory.node_functions("quadratic", x, 3), strict=True
    ):
        assert one.tolist() == two.tolist()
    narrow = theory.node_functions("ugimp", x, 1e6)[0]
    assert narrow == pytest.approx(theory.tent(x), abs=1e-6)


@pytest.mark.parametrize("basis", theory.BASES)
def test_slopes_are_derivatives(basis: str) -> None:
    """By central differences between the kinks; of the averages only far from them."""
    x = np.arange(-2.0, 2.0, 0.1) + 0.0503
    if basis == "cpdi":
        x = x[np.abs(np.abs(x) - np.round(np.abs(x))) > 0.13]
    step = 1e-6
    values = [theory.node_functions(basis, x + d, 2)[0] for d in (-step, step)]
    slopes = theory.node_functions(basis, x, 2)[1]
    assert (values[1] - values[0]) / (2 * step) == pytest.approx(slopes, abs=1e-8)


@pytest.mark.parametrize("basis", theory.BASES)
@pytest.mark.parametrize("n", [1, 2, 3])
def test_grid_functions_keep_linear_fields_between_walls(basis: str, n: int) -> None:
    """Sums are 1, positions are reproduced, and at a wall its node counts alone."""
    x = theory.point_offsets(5 * n) * 5
    values, slopes = theory.grid_functions(basis, x, 5, n)
    nodes = np.arange(6)
    assert values.sum(axis=1) == pytest.approx(np.ones(len(x)), rel=1e-14)
    assert values @ nodes == pytest.approx(x, rel=1e-14)
    assert slopes.sum(axis=1) == pytest.approx(np.zeros(len(x)), abs=1e-14)
    assert slopes @ nodes == pytest.approx(np.ones(len(x)), rel=1e-13)
    if basis != "cpdi":
        ends = theory.grid_functions(basis, np.array([0.0, 5.0]), 5, n)[0]
        assert ends == pytest.approx(np.eye(6)[[0, 5]], abs=1e-14)


@pytest.mark.parametrize(
    ("basis", "volumes"),
    [("quadratic", [13 / 24, 23 / 24]), ("cubic", [7 / 12, 11 / 12]), ("ugimp", [1 / 2, 1])],
)
def test_node_volumes_next_to_walls(basis: str, volumes: list[float]) -> None:
    """Integrals of the functions, by many points."""
    n = 400
    values = theory.grid_functions(basis, theory.point_offsets(4 * n) * 4, 4, n)[0]
    found = values.sum(axis=0) / n
    assert found == pytest.approx([*volumes, 1.0, *volumes[::-1]], abs=1 / n**2 + 1e-12)


@pytest.mark.parametrize("basis", theory.BASES)
def test_seams_carry_the_symbols(basis: str) -> None:
    """A wave of a periodic grid gives its points S and D."""
    cells, n, shift, k = 6, 2, 0.17, 2.0 * math.pi / 6
    x = (theory.point_offsets(cells * n) * cells + shift) % cells
    wave = np.exp(1j * k * np.arange(cells))
    values, slopes = theory.grid_functions(basis, x, cells, n, periodic=True)
    s, d = theory.cell_symbols(k, n, shift, basis)
    back = np.exp(1j * k * x)
    assert values @ wave == pytest.approx(np.tile(s, cells) * back, rel=1e-12)
    assert slopes @ wave == pytest.approx(np.tile(d, cells) * back, rel=1e-12)


@pytest.mark.parametrize("basis", theory.BASES)
@pytest.mark.parametrize(("n", "stretch"), [(1, 1.03), (2, 1.01), (2, 0.98), (3, 1.02), (4, 0.985)])
def test_crossing_noise_is_that_of_direct_sums(basis: str, n: int, stretch: float) -> None:
    """Nodes at all places of a lattice, 1/4000 of a spacing apart; patterns are 0.015 and wider."""
    places = np.linspace(0.0, 1.0, 4001)[:-1] * stretch / n
    points = (np.arange(-6 * n, 6 * n) + 0.5) * stretch / n
    distance = points[None, :] - places[:, None]
    force = -stretch / n * np.sum(theory.node_functions(basis, distance, n)[1], axis=1)
    peak, mean = theory.crossing_noise(n, stretch, basis)
    assert np.max(np.abs(force)) == pytest.approx(peak, rel=2e-2)
    assert np.sqrt(np.mean(force**2)) == pytest.approx(mean, rel=2e-2)


@pytest.mark.parametrize(
    ("basis", "stretch", "peak", "rel"),
    [
        ("linear", 1.157, 0.579, 1e-3),
        ("ugimp", 1.01, 5.05e-3, 1e-3),
        ("quadratic", 1.05, 2.63e-2, 3e-3),
        ("quadratic", 1.157, 9.09e-2, 2e-3),
        ("cubic", 1.05, 8.2e-4, 0.1),
        ("cubic", 1.157, 9.5e-3, 0.01),
    ],
)
def test_measured_crossing_noise(basis: str, stretch: float, peak: float, rel: float) -> None:
    """Two points per cell; the values of cubic functions were measured at few nodes."""
    assert theory.crossing_noise(2, stretch, basis)[0] == pytest.approx(peak, rel=rel)


def test_noise_law_needs_patterns_that_do_not_meet() -> None:
    """Corner averages at large strain."""
    with pytest.raises(ValueError, match="smaller strain"):
        theory.crossing_noise(4, 1.14, "cpdi")


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_stress_constant(n: int) -> None:
    """Distance from the middle of a cell for linear functions, 0 for splines; and the symbols."""
    mean = math.sqrt((1.0 - 1.0 / n**2) / 12.0)
    for basis in ("linear", "cpdi", "ugimp"):
        assert theory.stress_constant(n, basis=basis) == pytest.approx(mean, abs=1e-14)
    for basis in ("quadratic", "cubic"):
        assert theory.stress_constant(n, 0.13, basis) == pytest.approx(0.0, abs=1e-14)
    kh = 1e-3
    gradient = theory.cell_symbols(kh, n, 0.1, "linear")[1]
    error = np.sqrt(np.mean(np.abs(gradient / (1j * kh) - 1.0) ** 2)) / kh
    assert theory.stress_constant(n, 0.1) == pytest.approx(error, rel=1e-5)


@pytest.mark.parametrize("basis", theory.BASES)
def test_energy_loss_of_the_bases(basis: str) -> None:
    """|lambda|^2 over the steps of a period, up to the next term in kh."""
    kh, cfl = 0.05, 0.2
    size = float(np.max(np.abs(theory.amplification(kh, 2, cfl, basis))))
    loss = 1.0 - size ** (4.0 * math.pi / (cfl * kh))
    assert loss == pytest.approx(theory.energy_loss_per_period(kh, 2, cfl, basis), rel=kh)
