"""Errors and costs of the rows of the matrix as curves, and what follows from their comparison."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .case import Case, Finding
from .matrix import Row
from .scene import DIM
from .scheme import OPTIONS, Scheme

#: A row of the matrix, the records of its runs by rising resolution, and its findings.
Judged = tuple[Row, list[dict[str, Any]], list[Finding]]
#: Levels of error that tables look for, where they lie within the measured range.
LEVELS = tuple(10.0**-n for n in range(1, 10))
#: The coarsest levels of a problem that a table shows.
SHOWN_LEVELS = 3


@dataclass(frozen=True, order=True)
class Method:
    """What a user chooses for a given problem."""

    mapping: str
    contact: str
    ppc: int
    #: What differs from USL with FLIP.
    scheme: str = ""

    @property
    def kind(self) -> str:
        """Mapping, scheme and contact rule."""
        contact = "" if self.contact == "-" else self.contact
        return ", ".join(filter(None, [self.mapping, self.scheme, contact]))

    def __str__(self) -> str:
        """Return the name for legends and tables."""
        return f"{self.kind}, {self.ppc} ppc"


@dataclass(frozen=True)
class Curve:
    """Errors and costs of one method by rising resolution; only runs with an error above 0."""

    method: Method
    cells: tuple[int, ...]
    errors: tuple[float, ...]
    #: Points times steps.
    point_steps: tuple[float, ...]
    #: Time of the loop over steps without frames; nan where it was not measured. [s]
    seconds: tuple[float, ...]

    @property
    def is_timed(self) -> bool:
        """Whether all runs have a time."""
        return all(map(math.isfinite, self.seconds))


@dataclass(frozen=True)
class Problem:
    """What the same exact answer is asked of: a case in one TYPE with one set of options."""

    case: str
    sim_type: int
    #: Options in which the rows of the case differ.
    options: tuple[tuple[str, str], ...]
    #: Name of the measure that is the error.
    measure: str
    #: Expected order in 1/cells; 0: none.
    order: float
    curves: tuple[Curve, ...]

    @property
    def title(self) -> str:
        """Name of the problem."""
        return ", ".join([f"{self.case}, TYPE {self.sim_type}", *self.option_texts])

    @property
    def option_texts(self) -> list[str]:
        """Options as texts."""
        return [f"{key}={value}" for key, value in self.options]

    @property
    def growth(self) -> float:
        """Power s of point-steps ~ cells^s: the refined directions, and 1 for the time steps."""
        rates = [
            math.log(c.point_steps[-1] / c.point_steps[0]) / math.log(c.cells[-1] / c.cells[0])
            for c in self.curves
            if len(c.cells) > 1
        ]
        measured = float(np.median(rates)) if rates else 0.0
        near = float(round(measured))
        return near if near > 0 and abs(measured - near) < 0.25 else DIM[self.sim_type] + 1.0

    @property
    def is_timed(self) -> bool:
        """Whether all runs have a time."""
        return all(curve.is_timed for curve in self.curves)


def find_problems(cases: Mapping[str, Case], judged: Sequence[Judged]) -> list[Problem]:
    """Gather the problems of cases with an error, in the order of the matrix."""
    groups: dict[tuple[str, int, tuple[tuple[str, str], ...]], list[Curve]] = {}
    for row, records, _ in judged:
        curve = make_curve(row, records, cases[row.case].error)
        if curve is not None:
            options = tuple(item for item in row.options if item[0] not in OPTIONS)
            groups.setdefault((row.case, row.sim_type, options), []).append(curve)
    shared = {
        name: shared_options([row for row, _, _ in judged if row.case == name]) for name in cases
    }
    return [
        Problem(
            name,
            sim_type,
            tuple(item for item in options if item not in shared[name]),
            cases[name].error,
            cases[name].order,
            tuple(curves),
        )
        for (name, sim_type, options), curves in groups.items()
    ]


def shared_options(rows: Sequence[Row]) -> set[tuple[str, str]]:
    """Return the options that all rows have."""
    options = [set(row.options) for row in rows]
    return set.intersection(*options) if options else set()


def make_curve(row: Row, records: Sequence[dict[str, Any]], measure: str) -> Curve | None:
    """Return the curve of a row, None when no run has an error."""
    good = [record for record in records if has_error(record, measure)]
    if not good:
        return None
    return Curve(
        Method(row.mapping, row.contact, row.ppc, Scheme.of(dict(row.options)).label),
        tuple(record["cells"] for record in good),
        tuple(record["measures"][measure] for record in good),
        tuple(float(record["points"] * record["steps"]) for record in good),
        tuple(float(record.get("loop_seconds") or math.nan) for record in good),
    )


def compared(problems: Sequence[Problem]) -> list[Problem]:
    """Return the problems with several methods, one of them at several resolutions at least."""
    return [
        problem
        for problem in problems
        if len(problem.curves) > 1 and any(len(curve.cells) > 1 for curve in problem.curves)
    ]


def has_error(record: dict[str, Any], measure: str) -> bool:
    """Tell whether a run has an error above 0 and a cost."""
    error = record["measures"].get(measure)
    return (
        not record["problem"]
        and error is not None
        and math.isfinite(error)
        and error > 0.0
        and record["points"] * record["steps"] > 0
    )


@dataclass(frozen=True)
class Cost:
    """What a method needs to reach a level of error."""

    value: float
    method: Method
    #: The coarsest run is better than the level: a coarser one would cost less.
    is_bound: bool = False


def cost_at(curve: Curve, costs: Sequence[float], level: float) -> Cost | None:
    """Return the least cost at which a curve reaches a level; log-log between resolutions."""
    if curve.errors[0] <= level:
        return Cost(costs[0], curve.method, is_bound=curve.errors[0] < level)
    for i in range(1, len(costs)):
        if curve.errors[i] <= level:
            ratio = math.log(curve.errors[i - 1] / level)
            ratio /= math.log(curve.errors[i - 1] / curve.errors[i])
            return Cost(costs[i - 1] * (costs[i] / costs[i - 1]) ** ratio, curve.method)
    return None


@dataclass(frozen=True)
class Choice:
    """The methods that reach a level of error, the cheapest first."""

    problem: Problem
    level: float
    by_seconds: tuple[Cost, ...]
    by_point_steps: tuple[Cost, ...]


def choices(problem: Problem) -> list[Choice]:
    """Compare the methods of a problem at the levels that lie in the range of at least one."""
    found = []
    for level in LEVELS:
        work = [cost_at(curve, curve.point_steps, level) for curve in problem.curves]
        if not any(cost is not None and not cost.is_bound for cost in work):
            continue
        timed = [cost_at(c, c.seconds, level) for c in problem.curves if c.is_timed]
        found.append(Choice(problem, level, in_order(timed), in_order(work)))
    return found[:SHOWN_LEVELS]


def in_order(costs: Sequence[Cost | None]) -> tuple[Cost, ...]:
    """Sort by value; ties by method."""
    return tuple(sorted(filter(None, costs), key=lambda cost: (cost.value, cost.method)))


@dataclass(frozen=True)
class EqualCost:
    """Errors of rows that differ in their points per cell only, at the same points times steps."""

    kind: str
    ppc: tuple[int, ...]
    #: Points times steps.
    costs: tuple[float, ...]
    #: By cost, then by ppc.
    errors: tuple[tuple[float, ...], ...]


def equal_costs(problem: Problem) -> list[EqualCost]:
    """Compare points per cell at the ends and the middle of the costs that all have."""
    kinds: dict[str, list[Curve]] = {}
    for curve in problem.curves:
        if len(curve.cells) > 1:
            kinds.setdefault(curve.method.kind, []).append(curve)
    compared = {
        kind: sorted(curves, key=lambda curve: curve.method.ppc)
        for kind, curves in kinds.items()
        if len({curve.method.ppc for curve in curves}) > 1
    }
    every = [curve for curves in compared.values() for curve in curves]
    if not every:
        return []
    low = max(curve.point_steps[0] for curve in every)
    high = min(curve.point_steps[-1] for curve in every)
    if low > high:
        return []
    costs = (low, math.sqrt(low * high), high) if high > 2.0 * low else (math.sqrt(low * high),)
    return [
        EqualCost(
            kind,
            tuple(curve.method.ppc for curve in curves),
            costs,
            tuple(tuple(error_at(curve, cost) for curve in curves) for cost in costs),
        )
        for kind, curves in compared.items()
    ]


def error_at(curve: Curve, point_steps: float) -> float:
    """Return the error at a cost within the range of a curve, log-log between resolutions."""
    logs = np.interp(math.log(point_steps), np.log(curve.point_steps), np.log(curve.errors))
    return float(np.exp(logs))
