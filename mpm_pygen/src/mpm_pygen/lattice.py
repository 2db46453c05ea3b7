"""Filling a shape with points at the centres of equal cells."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.points import Points
from mpm_pygen.shapes import FloatArray, Shape
from mpm_pygen.simulation_type import SimulationType

#: A side fits when it holds a whole number of cells to this part of a cell, so that 0.3333333
#: fits a side of 1. The spacing in use is then the side divided by that number.
FIT = 1e-6

#: More cells than this in the box around a shape are taken for a slip of the pen: three
#: coordinates of each would fill more than 2 GB.
MOST_CELLS = 10**8


def fill(
    shape: Shape,
    sim_type: SimulationType,
    *,
    spacing: float | Sequence[float],
    density: float,
    velocity: Sequence[float] | None = None,
) -> Points:
    """Fill a shape with points of one size, density and velocity.

    Parameters
    ----------
    shape : Shape
        In as many dimensions as the grid of the simulation has. In TYPE 4 it is the meridian
        section, in the coordinates r and z, with r >= 0.
    sim_type : SimulationType
        Kind of simulation.
    spacing : float or Sequence[float]
        Distance of neighbours, one for all directions or one for each. [m]
    density : float
        Above 0. [kg/m^3]
    velocity : Sequence[float], optional
        One number for each component; at rest when left out. [m/s]

    Returns
    -------
    Points
        Ordered with the last direction fastest, all active.
    """
    if shape.dimension != sim_type.dimension:
        raise PygenError(
            f"TYPE {int(sim_type)} has {sim_type.dimension} grid directions, "
            f"the shape {shape.dimension}"
        )
    if not (math.isfinite(density) and density > 0.0):
        raise PygenError(f"the density is a number above 0, not {density!r}")
    if sim_type is SimulationType.AXISYMMETRIC and shape.bounds[0][0] < 0.0:
        raise PygenError(
            f"the shape reaches r = {float(shape.bounds[0][0])!r}, but r >= 0 in TYPE 4"
        )
    if velocity is None:
        velocity = [0.0] * sim_type.components
    if len(velocity) != sim_type.components:
        names = ", ".join(sim_type.coordinates)
        raise PygenError(
            f"a velocity of TYPE {int(sim_type)} has {sim_type.components} components "
            f"({names}), not {len(velocity)}"
        )
    position, cell = lattice(shape, spacing)
    n = len(position)
    return Points(
        sim_type=sim_type,
        mass=np.full(n, density * cell),
        volume=np.full(n, cell),
        position=position,
        velocity=np.tile(np.array(velocity, dtype=float), (n, 1)),
        active=np.ones(n, dtype=bool),
    )


def lattice(shape: Shape, spacing: float | Sequence[float]) -> tuple[FloatArray, float]:
    """Give the centres of the cells of a lattice that lie in a shape.

    Parameters
    ----------
    shape : Shape
        What to fill.
    spacing : float or Sequence[float]
        Sides of a cell.

    Returns
    -------
    position : FloatArray
        `(n, dimension)`, first direction slowest.
    cell : float
        Length, area or volume of a cell.
    """
    sides = _spacings(spacing, shape.dimension)
    lower, upper = shape.bounds
    origin = shape.origin
    starts, ends = [], []
    for k in range(shape.dimension):
        low, high = float(lower[k]), float(upper[k])
        if k in shape.flat_directions:
            sides[k] = _fitted(k, low, high, sides[k])
            starts.append(round((low - origin[k]) / sides[k]))
            ends.append(round((high - origin[k]) / sides[k]))
        else:
            starts.append(math.floor((low - origin[k]) / sides[k]))
            ends.append(math.ceil((high - origin[k]) / sides[k]))
    cells = math.prod(end - start for start, end in zip(starts, ends, strict=True))
    if cells > MOST_CELLS:
        raise PygenError(
            f"a spacing of {_text(sides)} asks for {cells} points, more than {MOST_CELLS}"
        )
    axes = [origin[k] + (np.arange(starts[k], ends[k]) + 0.5) * sides[k] for k in range(len(sides))]
    position = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    position = position[shape.contains(position)]
    if len(position) == 0:
        raise PygenError(f"no point lies in the shape: the spacing {_text(sides)} is too wide")
    return position, math.prod(sides)


def _spacings(spacing: float | Sequence[float], dimension: int) -> list[float]:
    """Give one checked spacing for each direction."""
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
