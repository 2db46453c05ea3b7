"""Figures of the results: convergence, work against precision, points per cell at equal cost.

The same records give the same bytes: no dates, no names of programs in the files.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .curves import Curve, EqualCost, Problem, compared, equal_costs
from .sheets import (
    DARK,
    GREY,
    LETTERS,
    STYLE,
    Look,
    Panel,
    Sheet,
    line_style,
    looks,
    numbered,
    split,
)

#: Height as a logarithm, text, and kind of line for the colour; empty: of several kinds.
Label = tuple[float, str, str]


def draw_convergence(path: Path, problems: Sequence[Problem]) -> list[str]:
    """Draw error against resolution, a panel a case and TYPE; letters tell options apart.

    Parameters
    ----------
    path : Path
        File to write; further sheets get a number.
    problems : Sequence[Problem]
        The problems; those with one resolution only are left out.

    Returns
    -------
    list[str]
        Names of the files; empty when there is nothing to draw.
    """
    shown = [p for p in problems if any(len(curve.cells) > 1 for curve in p.curves)]
    style, names = looks(problems), []
    for number, part in enumerate(split(panels_of(shown), columns=3)):
        with matplotlib.rc_context(STYLE):
            sheet = Sheet(part, columns=3, panels=1, style=style)
            for index, group in enumerate(part):
                axes = sheet.axes(index, 0)
                curves = [curve for problem in group for curve in problem.curves]
                for curve in curves:
                    plot_curve(axes, curve, "cells", style)
                order = group[0].order
                finish(axes, curves, "cells", -order if order else None, f"order {order:g}")
                resolution_ticks(axes, curves)
                if len(group) > 1:
                    write_letters(axes, group, style)
                axes.set_xlabel("resolution [cells]")
                axes.set_ylabel(f"{group[0].measure} [-]")
            names.append(sheet.save(numbered(path, number)))
    return names


def panels_of(problems: Sequence[Problem]) -> list[Panel]:
    """Gather the problems that differ in their options only, a few to a panel."""
    groups: dict[tuple[str, int], list[Problem]] = {}
    for problem in problems:
        groups.setdefault((problem.case, problem.sim_type), []).append(problem)
    panels: list[Panel] = []
    for group in groups.values():
        parts = math.ceil(len(group) / len(LETTERS))
        size = math.ceil(len(group) / parts)
        panels += [group[i : i + size] for i in range(0, len(group), size)]
    return panels


def write_letters(axes: Axes, group: Panel, style: dict[str, Look]) -> None:
    """Write the letters of problems at the ends of their curves."""
    ends: dict[int, list[Label]] = {}
    for letter, problem in zip(LETTERS, group, strict=False):
        for curve in problem.curves:
            height = math.log10(curve.errors[-1])
            ends.setdefault(curve.cells[-1], []).append((height, letter, curve.method.kind))
    low, high = axes.get_xlim()
    axes.set_xlim(low, high * (high / low) ** 0.08)
    for cells, labels in ends.items():
        for height, letter, kind in spread(labels, *np.log10(axes.get_ylim())):
            axes.annotate(
                letter,
                (cells, 10.0**height),
                xytext=(5, 0),
                textcoords="offset points",
                ha="left",
                va="center",
                color=style[kind].colour if kind else DARK,
            )


def draw_work(path: Path, problems: Sequence[Problem]) -> list[str]:
    """Draw error against time and against points times steps, panels side by side a problem.

    Parameters
    ----------
    path : Path
        File to write; further sheets get a number.
    problems : Sequence[Problem]
        The problems; those with one method are left out.

    Returns
    -------
    list[str]
        Names of the files; empty when there is nothing to draw.
    """
    shown = compared(problems)
    style, names = looks(problems), []
    is_timed = all(problem.is_timed for problem in shown)
    costs = [("seconds", "time of the loop [s]")] if is_timed else []
    costs.append(("point_steps", "point-steps"))
    columns = 2 if is_timed else 3
    for number, part in enumerate(split([[problem] for problem in shown], columns)):
        with matplotlib.rc_context(STYLE):
            sheet = Sheet(part, columns, panels=len(costs), style=style)
            for index, (problem,) in enumerate(part):
                pair = [sheet.axes(index, place) for place in range(len(costs))]
                for axes, (cost, label) in zip(pair, costs, strict=True):
                    for curve in problem.curves:
                        plot_curve(axes, curve, cost, style)
                    slope = -problem.order / problem.growth if problem.order else None
                    finish(axes, problem.curves, cost, slope, slope_text(slope))
                    axes.set_xlabel(label)
                share_errors(pair)
                pair[0].set_ylabel(f"{problem.measure} [-]")
            names.append(sheet.save(numbered(path, number)))
    return names


def draw_points_per_cell(path: Path, problems: Sequence[Problem]) -> list[str]:
    """Draw error against points per cell at equal points times steps.

    Parameters
    ----------
    path : Path
        File to write; further sheets get a number.
    problems : Sequence[Problem]
        The problems; those without rows that differ in points per cell only are left out.

    Returns
    -------
    list[str]
        Names of the files; empty when there is nothing to draw.
    """
    shown = [[problem] for problem in problems if equal_costs(problem)]
    style, names = looks(problems), []
    for number, part in enumerate(split(shown, columns=3)):
        with matplotlib.rc_context(STYLE):
            sheet = Sheet(part, columns=3, panels=1, style=style, has_slope=False, ppc=False)
            for index, (problem,) in enumerate(part):
                axes = sheet.axes(index, 0)
                groups = equal_costs(problem)
                plot_equal_costs(axes, groups, style)
                axes.set_xlabel("points per cell and direction")
                axes.set_ylabel(f"{problem.measure} [-]")
            names.append(sheet.save(numbered(path, number)))
    return names


def plot_curve(axes: Axes, curve: Curve, cost: str, style: dict[str, Look]) -> None:
    """Draw the errors of one method against its cells, seconds or point_steps."""
    look = style[curve.method.kind]
    axes.plot(getattr(curve, cost), curve.errors, **line_style(look, curve.method.ppc))


def finish(axes: Axes, curves: Sequence[Curve], cost: str, slope: float | None, text: str) -> None:
    """Scale axes and draw the reference slope below all curves."""
    x = np.array([value for curve in curves for value in getattr(curve, cost)], dtype=float)
    y = np.array([value for curve in curves for value in curve.errors])
    low, high = y.min(), y.max()
    axes.set_xscale("log")
    axes.set_yscale("log")
    if slope is not None and x.max() > x.min():
        # Half of the range is enough; the line keeps away from the nearest point.
        middle = math.sqrt(x.min() * x.max())
        ends = np.array([math.sqrt(x.min() * middle), math.sqrt(middle * x.max())])
        line = 0.45 * lowest_factor(curves, cost, slope, ends) * ends**slope
        axes.plot(ends, line, color=GREY, linewidth=1.2, solid_capstyle="butt", zorder=1)
        axes.annotate(
            text,
            (middle, math.sqrt(line[0] * line[1])),
            xytext=(-1, -1),
            textcoords="offset points",
            ha="right",
            va="top",
            color=DARK,
        )
        low = min(low, line.min())
    set_limits(axes.set_xlim, x.min(), x.max())
    set_limits(axes.set_ylim, low, high)
    decade_ticks(axes.xaxis, *axes.get_xlim(), most=3)
    decade_ticks(axes.yaxis, *axes.get_ylim(), most=5)
    axes.grid(True, color="#DDDDDD", linewidth=0.5, zorder=0)
    axes.set_axisbelow(True)


def lowest_factor(
    curves: Sequence[Curve], cost: str, slope: float, ends: npt.NDArray[np.float64]
) -> float:
    """Return the largest f with f x^slope below all curves between two ends."""
    samples = np.log(np.geomspace(ends[0], ends[1], 9))
    lowest = math.inf
    for curve in curves:
        order = np.argsort(getattr(curve, cost))
        x = np.log(np.array(getattr(curve, cost), dtype=float)[order])
        errors = np.interp(samples, x, np.log(curve.errors)[order])
        inside = (samples >= x[0] - 1e-9) & (samples <= x[-1] + 1e-9)
        for at, error in [*zip(samples[inside], errors[inside], strict=True)]:
            lowest = min(lowest, math.exp(error - slope * at))
        for at, error in zip(x, np.log(curve.errors)[order], strict=True):
            if samples[0] <= at <= samples[-1]:
                lowest = min(lowest, math.exp(error - slope * at))
    if math.isinf(lowest):
        lowest = min(min(curve.errors) for curve in curves) / float(np.max(ends**slope))
    return lowest


def share_errors(pair: Sequence[Axes]) -> None:
    """Give panels side by side the same axis of errors, with numbers at the first."""
    limits = [axes.get_ylim() for axes in pair]
    low, high = min(low for low, _ in limits), max(high for _, high in limits)
    for axes in pair:
        axes.set_ylim(low, high)
        decade_ticks(axes.yaxis, low, high, most=5)
    for axes in pair[1:]:
        axes.tick_params(labelleft=False)


def set_limits(setter: object, low: float, high: float) -> None:
    """Set limits with margins that hold two decade ticks at least."""
    low, high = math.log10(low), math.log10(high)
    margin = 0.07 * max(high - low, 0.5)
    low, high = low - margin, high + margin
    if math.floor(high) - math.ceil(low) < 1:
        below, above = math.floor(low), math.ceil(high)
        if math.floor(high) < math.ceil(low):  # no tick inside
            low, high = below - 0.04, above + 0.04
        elif low - below <= above - high:
            low = below - 0.04 if low > below else low
        else:
            high = above + 0.04
    setter(10.0**low, 10.0**high)  # type: ignore[operator]


def decade_ticks(axis: object, low: float, high: float, most: int) -> None:
    """Set ticks at powers of ten, no more than a panel has room for."""
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    step = max(1, math.ceil((last - first + 1) / most))
    axis.set_major_locator(FixedLocator([10.0**n for n in range(first, last + 1, step)]))
    minor = [m * 10.0**n for n in range(first - 1, last + 1) for m in range(2, 10)]
    axis.set_minor_locator(FixedLocator(minor) if step == 1 else NullLocator())
    axis.set_major_formatter(FuncFormatter(power_text))
    axis.set_minor_formatter(FuncFormatter(lambda _value, _place: ""))


def power_text(value: float, _place: int | None = None) -> str:
    """Return a power of ten without superscripts, which are too small in print."""
    return f"{value:g}" if 0.01 <= value <= 100 else f"1e{round(math.log10(value))}"


def resolution_ticks(axes: Axes, curves: Sequence[Curve]) -> None:
    """Set ticks at the resolutions that were run, as many as there is room for."""
    cells = sorted({n for curve in curves for n in curve.cells})
    low, high = axes.get_xlim()
    if cells[0] == cells[-1]:
        low, high = cells[0] / 1.5, cells[0] * 1.5
    else:
        margin = (cells[-1] / cells[0]) ** 0.08
        low, high = cells[0] / margin, cells[-1] * margin
    axes.set_xlim(low, high)
    gap, kept = 0.17 * math.log(high / low), []
    for n in cells:
        if not kept or math.log(n / kept[-1]) >= gap:
            kept.append(n)
    axes.xaxis.set_major_locator(FixedLocator(kept))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _place: f"{value:g}"))


def plot_equal_costs(axes: Axes, groups: Sequence[EqualCost], style: dict[str, Look]) -> None:
    """Draw a line for each cost, its value at the right end."""
    axes.set_yscale("log")
    for group in groups:
        look = style[group.kind]
        for errors in group.errors:
            line = line_style(look, 1)
            axes.plot(group.ppc, errors, **line)
    every = [value for group in groups for errors in group.errors for value in errors]
    set_limits(axes.set_ylim, min(every), max(every))
    decade_ticks(axes.yaxis, *axes.get_ylim(), most=5)
    ppc = sorted({n for group in groups for n in group.ppc})
    span = ppc[-1] - ppc[0]
    axes.set_xlim(ppc[0] - 0.12 * span, ppc[-1] + 0.45 * span)
    axes.xaxis.set_major_locator(FixedLocator(ppc))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _place: f"{value:g}"))
    axes.grid(True, color="#DDDDDD", linewidth=0.5, zorder=0)
    axes.set_axisbelow(True)
    ends = [
        (math.log10(errors[-1]), cost_text(cost), group.kind)
        for group in groups
        for cost, errors in zip(group.costs, group.errors, strict=True)
    ]
    for height, text, kind in spread(ends, *np.log10(axes.get_ylim())):
        colour = style[kind].colour if kind else DARK
        axes.text(ppc[-1] + 0.08 * span, 10.0**height, text, va="center", ha="left", color=colour)


def spread(ends: Sequence[Label], low: float, high: float) -> list[Label]:
    """Return labels at the ends of lines so that none covers another.

    Equal texts at nearly the same height share a label, which has no kind when their kinds differ;
    labels that would cover each other move up.
    """
    line = 0.1 * (high - low)
    wanted: list[Label] = []
    for height, text, kind in ends:
        near = [w for w in wanted if w[1] == text and abs(w[0] - height) < 0.5 * line]
        for other in near:
            wanted.remove(other)
        alike = all(other[2] == kind for other in near)
        wanted.append((near[0][0] if near else height, text, kind if alike else ""))
    labels: list[Label] = []
    for height, text, kind in sorted(wanted):
        labels.append((max(height, labels[-1][0] + line) if labels else height, text, kind))
    excess = max(0.0, labels[-1][0] - (high - 0.5 * line))
    return [(height - excess, text, kind) for height, text, kind in labels]


def cost_text(cost: float) -> str:
    """Return a cost with two digits."""
    digits, exponent = f"{cost:.1e}".split("e")
    return f"{digits.removesuffix('.0')}e{int(exponent)}"


def slope_text(slope: float | None) -> str:
    """Return a slope as a fraction."""
    if slope is None:
        return ""
    return f"slope -{Fraction(-slope).limit_denominator(8)}"
