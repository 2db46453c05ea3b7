"""Filling a shape with points at the centres of equal cells."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.shape import FloatArray, Shape

#: A side fits when it holds a whole number of cells to this part of a cell, so that 0.3333333
#: fits a side of 1. The spacing in use is then the side divided by that number.
FIT = 1e-6

#: More cells than this in the box around a shape are taken for a slip of the pen: three
#: coordinates of each would fill more than 2 GB.
MOST_CELLS = 10**8


def lattice(
    shape: Shape,
    spacing: float | Sequence[float],
    *,
    origin: Sequence[float] | None = None,
) -> tuple[FloatArray, float]:
    """Give the centres of the cells of a lattice that lie in a shape.

    Parameters
    ----------
    shape : Shape
        What to fill.
    spacing : float or Sequence[float]
        Sides of a cell.
    origin : Sequence[float], optional
        A position at which cells meet, in place of that of the shape. No side of the shape has to
        be a multiple of the spacing then.

    Returns
    -------
    position : FloatArray
        `(n, dimension)`, first direction slowest.
    cell : float
        Length, area or volume of a cell.
    """
    sides = spacings(spacing, shape.dimension)
    lower, upper = shape.bounds
    flat = shape.flat_directions if origin is None else ()
    start = shape.origin if origin is None else np.array(origin, dtype=float)
    if start.shape != (shape.dimension,) or not np.all(np.isfinite(start)):
        raise PygenError(f"the origin of a lattice has {shape.dimension} numbers here")
    starts, ends = [], []
    for k in range(shape.dimension):
        low, high = float(lower[k]), float(upper[k])
        if k in flat:
            sides[k] = _fitted(k, low, high, sides[k])
            starts.append(round((low - start[k]) / sides[k]))
            ends.append(round((high - start[k]) / sides[k]))
        else:
            starts.append(math.floor((low - start[k]) / sides[k]))
            ends.append(math.ceil((high - start[k]) / sides[k]))
    cells = math.prod(last - first for first, last in zip(starts, ends, strict=True))
    if cells > MOST_CELLS:
        raise PygenError(
            f"a spacing of {_text(sides)} asks for {cells} points, more than {MOST_CELLS}"
        )
    axes = [start[k] + (np.arange(starts[k], ends[k]) + 0.5) * sides[k] for k in range(len(sides))]
    position = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    position = position[shape.contains(position)]
    if len(position) == 0:
        raise PygenError(f"no point lies in the shape: the spacing {_text(sides)} is too wide")
    return position, math.prod(sides)


def spacings(spacing: float | Sequence[float], dimension: int) -> list[float]:
    """Give one checked spacing for each direction.

    Parameters
    ----------
    spacing : float or Sequence[float]
        One number, or one for each direction.
    dimension : int
        Number of directions.
    """
    values = [spacing] if isinstance(spacing, float | int) else list(spacing)
    if len(values) == 1:
        values = values * dimension
    if len(values) != dimension:
        raise PygenError(
            f"the spacing is one number or {dimension}, one for each direction, not {len(values)}"
        )
    for value in values:
        if not (math.isfinite(value) and value > 0.0):
            raise PygenError(f"a spacing is a number above 0, not {value!r}")
    return [float(value) for value in values]


def _fitted(direction: int, low: float, high: float, spacing: float) -> float:
    """Give the spacing that divides a side exactly, when the wanted one does so nearly."""
    side = high - low
    ratio = side / spacing
    if not math.isfinite(ratio):
        raise PygenError(f"the spacing {spacing!r} is too small for a side of {side:.12g}")
    count = max(1, round(ratio))
    if abs(ratio - count) > FIT:
        # Of the two counts around the ratio, the one whose spacing is nearer to the wanted one.
        counts = {max(1, math.floor(ratio)), math.ceil(ratio)}
        nearest = min((side / n for n in counts), key=lambda h: abs(h - spacing))
        raise PygenError(
            f"the side {side:.12g} in direction {direction + 1} is no multiple of the spacing "
            f"{spacing!r}; the nearest spacing that fits is {nearest:.12g}"
        )
    # Where only round-off differs, the spacing keeps the few digits that it was given with.
    round_off = 4.0 * sys.float_info.epsilon * max(abs(low), abs(high))
    return spacing if abs(side - count * spacing) <= round_off else side / count


def _text(values: Sequence[float]) -> str:
    """Write spacings for a message."""
    return " ".join(f"{value:.12g}" for value in values)
