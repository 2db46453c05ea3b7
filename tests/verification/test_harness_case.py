"""Findings, results and observed orders."""

from __future__ import annotations

import math

import pytest
from harness.case import (
    CASES,
    Finding,
    Parameters,
    Results,
    below,
    load_cases,
    near,
    observed_order,
)
from harness.matrix import read_matrix


def make_parameters(cells: int) -> Parameters:
    """Return parameters with options."""
    return Parameters("bar", 2, "cpdi", "-", 2, cells, {"nu": "0.3", "axis": "1"})


@pytest.mark.parametrize("order", [-1.0, 0.5, 2.0])
def test_order_of_a_power_is_its_exponent(order: float) -> None:
    """An exact power has its exponent to round-off."""
    cells = [8, 16, 32, 64]
    errors = [3.0 * n**-order for n in cells]
    assert observed_order(cells, errors) == pytest.approx(order, abs=1e-12)


def test_order_is_the_least_squares_slope() -> None:
    """Three points, the middle one off by log(2): the slope of least squares ignores it."""
    assert observed_order([1, 2, 4], [1.0, 0.5, 0.0625]) == pytest.approx(2.0, abs=1e-12)
    # Off at an end by log(2): the slope changes by 1/2 of one halving.
    assert observed_order([1, 2, 4], [1.0, 0.25, 0.03125]) == pytest.approx(2.5, abs=1e-12)


@pytest.mark.parametrize("errors", [[1.0], [1.0, 0.0], [1.0, -1.0], [1.0, math.nan]])
def test_order_is_nan_without_two_errors_above_0(errors: list[float]) -> None:
    """No logarithm, no order."""
    assert math.isnan(observed_order([8, 16][: len(errors)], errors))


def test_results_give_columns_orders_and_halvings() -> None:
    """Columns follow the runs."""
    runs = [make_parameters(n) for n in (8, 16, 32)]
    results = Results(runs, [{"e": e} for e in (1.0, 0.5, 0.125)])
    assert results.cells == [8, 16, 32]
    assert results.column("e") == [1.0, 0.5, 0.125]
    assert results.order("e") == pytest.approx(1.5, abs=1e-12)
    assert results.halvings("e") == pytest.approx([1.0, 2.0], abs=1e-12)
    assert [(p.cells, m["e"]) for p, m in results] == [(8, 1.0), (16, 0.5), (32, 0.125)]
    assert results.first is runs[0]


def test_parameters_record_options_in_order() -> None:
    """The record does not depend on the order of options."""
    parameters = make_parameters(8)
    assert list(parameters.record()["options"]) == ["axis", "nu"]
    assert parameters.number("nu", 0.0) == 0.3
    assert parameters.number("cfl", 0.2) == 0.2
    assert parameters.text("axis", "0") == "1"


@pytest.mark.parametrize(
    ("value", "passed"), [(0.97, True), (1.03, True), (0.969, False), (1.031, False)]
)
def test_near_has_bounds_on_both_sides(value: float, passed: bool) -> None:
    """A value may differ by the relative tolerance either way."""
    assert near("x", value, 1.0, 0.0300001, "why").passed is passed
    assert near("x", -value, -1.0, 0.0300001, "why").passed is passed


def test_below_refuses_negative_values() -> None:
    """A magnitude below 0 is a mistake of the case."""
    assert below("x", 0.0, 1.0, "why").passed
    assert not below("x", 1.0000001, 1.0, "why").passed
    assert not below("x", -1e-9, 1.0, "why").passed


def test_nan_fails_when_there_is_a_bound() -> None:
    """A finding without bounds informs only; with one, nan never passes."""
    assert Finding("x", math.nan).passed
    assert not Finding("x", math.nan).is_asserted
    assert not Finding("x", math.nan, high=1.0).passed
    assert Finding("x", 0.5, high=1.0).is_asserted


def test_every_case_has_its_text_and_a_row() -> None:
    """A case says what it is about and runs at least once."""
    cases, rows = load_cases(), read_matrix()
    assert {row.case for row in rows} == set(cases)
    for name, case in cases.items():
        assert (CASES / f"{name}.py").is_file()
        assert case.title and case.statement and case.source, name
        assert "\n" not in case.title, name
