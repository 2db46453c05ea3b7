"""Curves of error against cost, and their comparison."""

from __future__ import annotations

import math

import pytest
from harness.curves import (
    Cost,
    Method,
    choices,
    cost_at,
    equal_costs,
    find_problems,
    make_curve,
)
from synthetic import make_case, make_record, make_records, make_row

CASES = {"bar": make_case()}
METHOD = Method("linear", "-", 2)


def curve(errors: list[float], cells: tuple[int, ...] = (8, 16, 32)) -> object:
    """Return a curve with given errors."""
    row = make_row(1, cells)
    records = [make_record(row, n, {"e_u_l2": e}) for n, e in zip(cells, errors, strict=True)]
    return make_curve(row, records, "e_u_l2")


def test_curve_has_the_runs_with_an_error() -> None:
    """Problems, zeros and missing errors are left out."""
    row = make_row(1, (4, 8, 16, 32, 64))
    records = make_records(row, lambda n: 1.0 / n)
    records[0]["problem"] = "exit status 1"
    records[1]["measures"]["e_u_l2"] = 0.0
    records[2]["measures"]["e_u_l2"] = None
    del records[3]["measures"]["e_u_l2"]
    found = make_curve(row, records, "e_u_l2")
    assert found.cells == (64,)
    assert found.point_steps == (128 * 640.0,)
    assert found.seconds == pytest.approx((1e-7 * 128 * 640,), rel=1e-14)
    assert make_curve(row, records[:4], "e_u_l2") is None


def test_untimed_runs_have_no_seconds() -> None:
    """A missing time is nan."""
    row = make_row(1)
    records = make_records(row, lambda n: 1.0 / n)
    assert make_curve(row, records, "e_u_l2").is_timed
    del records[1]["loop_seconds"]
    found = make_curve(row, records, "e_u_l2")
    assert not found.is_timed
    assert math.isnan(found.seconds[1])


def test_cost_between_resolutions_is_interpolated_in_logarithms() -> None:
    """Error ~ cost^-1: a tenth of the way in error is one in cost."""
    found = curve([1.0, 0.25, 0.0625])
    assert cost_at(found, (1.0, 4.0, 16.0), 0.1) == Cost(pytest.approx(10.0, rel=1e-13), METHOD)
    assert cost_at(found, (1.0, 4.0, 16.0), 0.25).value == pytest.approx(4.0, rel=1e-13)
    assert cost_at(found, (1.0, 4.0, 16.0), 0.01) is None


def test_coarsest_run_bounds_the_cost() -> None:
    """A level above all errors needs no more than the coarsest run."""
    assert cost_at(curve([0.5, 0.2, 0.1]), (3.0, 4.0, 5.0), 1.0) == Cost(3.0, METHOD, is_bound=True)
    assert not cost_at(curve([0.5, 0.2, 0.1]), (3.0, 4.0, 5.0), 0.5).is_bound


def test_first_crossing_counts_when_errors_rise_again() -> None:
    """The cheapest way, whatever finer runs do."""
    found = curve([1.0, 0.01, 1.0])
    assert cost_at(found, (1.0, 100.0, 1e4), 0.1).value == pytest.approx(10.0, rel=1e-13)


def test_problems_differ_in_case_type_and_options() -> None:
    """Options that all rows of a case share are no part of the title."""
    cases = {"bar": make_case(), "rod": make_case("rod"), "none": make_case("none", error="")}
    rows = [
        make_row(1, options=[("a", "1"), ("nu", "0")]),
        make_row(2, options=[("a", "1"), ("nu", "0")], mapping="cpdi"),
        make_row(3, options=[("a", "2"), ("nu", "0")]),
        make_row(4, options=[("a", "1"), ("nu", "0")], sim_type=3),
        make_row(5, case="rod", options=[("b", "1")]),
        make_row(6, case="none"),
    ]
    judged = [(row, make_records(row, lambda n: 1.0 / n), []) for row in rows]
    found = find_problems(cases, judged)
    assert [problem.title for problem in found] == [
        "bar, TYPE 1, a=1",
        "bar, TYPE 1, a=2",
        "bar, TYPE 3, a=1",
        "rod, TYPE 1",
    ]
    assert [len(problem.curves) for problem in found] == [2, 1, 1, 1]
    assert [str(c.method) for c in found[0].curves] == ["linear, 2 ppc", "cpdi, 2 ppc"]


def test_method_names_the_rule_of_contact() -> None:
    """A dash is no rule."""
    assert str(Method("cpdi", "explicit", 3)) == "cpdi, explicit, 3 ppc"
    assert Method("cpdi", "-", 3).kind == "cpdi"


def test_growth_is_that_of_the_runs() -> None:
    """A bar in TYPE 2 that is refined along one axis costs cells^2, not cells^3."""
    row = make_row(1, sim_type=2)
    (problem,) = find_problems(CASES, [(row, make_records(row, lambda n: 1.0 / n), [])])
    assert problem.growth == 2.0
    single = make_row(1, (8,), sim_type=2)
    (problem,) = find_problems(CASES, [(single, make_records(single, lambda n: 1.0 / n), [])])
    assert problem.growth == 3.0


def test_cheapest_method() -> None:
    """Three points per cell: half the error at 1.5 times the cost."""
    rows = make_row(1, (8, 16, 32, 64)), make_row(2, (8, 16, 32, 64), ppc=3)
    judged = [
        (rows[0], make_records(rows[0], lambda n: 16.0 / n**2), []),
        (rows[1], make_records(rows[1], lambda n: 8.0 / n**2), []),
    ]
    (problem,) = find_problems(CASES, judged)
    found = choices(problem)
    # 1 % lies in the range, 25 % .. 0.2 %, of both; 0.1 % below.
    assert [choice.level for choice in found] == [0.1, 0.01]
    for choice in found:
        methods = [cost.method.ppc for cost in choice.by_point_steps]
        if choice.level == 0.01:
            assert methods == [3, 2]
            # Cells sqrt(16/0.01) with 2, sqrt(8/0.01) with 3 points; 10 ppc cells^2 point-steps.
            wanted = [10 * 3 * 800.0, 10 * 2 * 1600.0]
            values = [cost.value for cost in choice.by_point_steps]
            assert values == pytest.approx(wanted, rel=1e-12)
            seconds = [cost.value for cost in choice.by_seconds]
            assert seconds == pytest.approx([1e-7 * value for value in wanted], rel=1e-12)


def test_level_that_only_coarsest_runs_pass_is_no_choice() -> None:
    """Nothing is known about the cost at 10 % when all errors are below."""
    row = make_row(1, (8, 16, 32, 64))
    (problem,) = find_problems(CASES, [(row, make_records(row, lambda n: 0.05 / n), [])])
    assert [choice.level for choice in choices(problem)] == [10.0**-3]


def test_points_per_cell_at_equal_cost() -> None:
    """The error of each at costs that all have, from lines in logarithms."""
    rows = [make_row(n, (8, 16, 32), ppc=n) for n in (4, 1, 2)]
    judged = [(row, make_records(row, lambda n, p=row.ppc: p / n**2), []) for row in rows]
    (problem,) = find_problems(CASES, judged)
    (found,) = equal_costs(problem)
    assert found.kind == "linear"
    assert found.ppc == (1, 2, 4)
    # From the coarsest run with 4 points to the finest with 1.
    assert found.costs == pytest.approx((2560.0, math.sqrt(2560.0 * 10240.0), 10240.0), rel=1e-14)
    for cost, errors in zip(found.costs, found.errors, strict=True):
        assert errors == pytest.approx([p * 10 * p / cost for p in (1, 2, 4)], rel=1e-12)


def test_no_comparison_without_common_cost() -> None:
    """Ranges that do not overlap, or one number of points only."""
    rows = make_row(1, (8, 16), ppc=1), make_row(2, (64, 128), ppc=4)
    judged = [(row, make_records(row, lambda n: 1.0 / n), []) for row in rows]
    (problem,) = find_problems(CASES, judged)
    assert equal_costs(problem) == []
    (problem,) = find_problems(CASES, judged[:1])
    assert equal_costs(problem) == []
