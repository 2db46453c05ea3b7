"""Filling a shape with points: where they are, what they weigh, how fast they are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.expressions import evaluate
from mpm_pygen.lattice import lattice, spacings
from mpm_pygen.points import Points
from mpm_pygen.shape import FloatArray, Shape
from mpm_pygen.simulation_type import SimulationType

#: A number, an expression of the coordinates, or a function of positions `(n, dimension)`.
Field = float | str | Callable[[FloatArray], FloatArray]


def fill(
    shape: Shape,
    sim_type: SimulationType | int,
    *,
    density: Field,
    spacing: float | Sequence[float] | None = None,
    cell: float | Sequence[float] | None = None,
    per_cell: int | Sequence[int] = 2,
    velocity: Sequence[float | str] | Callable[[FloatArray], FloatArray] | None = None,
    fitted: bool = False,
    jitter: float = 0.0,
    seed: int = 0,
    origin: Sequence[float] | None = None,
    exact: bool = False,
) -> Points:
    """Fill a shape with points.

    Parameters
    ----------
    shape : Shape
        In as many dimensions as the grid of the simulation has. In TYPE 4 it is the meridian
        section, in the coordinates r and z, with r >= 0.
    sim_type : SimulationType
        Kind of simulation.
    density : float, str or callable
        Above 0 at all points. [kg/m^3]
    spacing : float or Sequence[float], optional
        Distance of neighbours, one for all directions or one for each. [m]
    cell, per_cell
        In place of `spacing`: sides of a cell of the grid, and points for each cell and
        direction; each is one number or one for each direction.
    velocity : Sequence of float or str, or callable, optional
        One number or expression for each component, or a function that gives
        `(n, components)`; at rest when left out. [m/s]
    fitted : bool
        Divide the shape into cells that follow its surface, and put points into their centroids,
        in place of a lattice. Sizes sum to the measure of the shape.
    jitter : float
        From 0 to 1: points are moved at random, in each direction by up to this part of half a
        spacing. A point that would leave the shape stays.
    seed : int
        Of the random numbers; the same seed gives the same points.
    origin : Sequence[float], optional
        A position at which cells of the lattice meet, for example a node of the grid.
    exact : bool
        Scale all sizes by one factor, so that they sum to the measure of the shape.

    Returns
    -------
    Points
        A lattice is ordered with the last direction fastest; all are active.
    """
    sim_type = SimulationType(sim_type)
    if shape.dimension != sim_type.dimension:
        raise PygenError(
            f"TYPE {int(sim_type)} has {sim_type.dimension} grid directions, "
            f"the shape {shape.dimension}"
        )
    sides = _sides(spacing, cell, per_cell, sim_type.dimension)
    if fitted:
        if origin is not None:
            raise PygenError("a body-fitted fill has no lattice, and so no origin")
        position, size = shape.fitted(sides)
    else:
        position, side_product = lattice(shape, sides, origin=origin)
        size = np.full(len(position), side_product)
    if jitter:
        position = _jittered(shape, position, size, sides, jitter, seed)
    if sim_type is SimulationType.AXISYMMETRIC and np.any(position[:, 0] < 0.0):
        raise PygenError(
            f"the shape reaches r = {float(shape.bounds[0][0])!r}, but r >= 0 in TYPE 4"
        )
    if exact:
        size = size * (shape.measure / float(np.sum(size)))
    n = len(position)
    return Points(
        sim_type=sim_type,
        mass=_density(density, position, sim_type) * size,
        volume=size,
        position=position,
        velocity=_velocity(velocity, position, sim_type),
        active=np.ones(n, dtype=bool),
    )


def mixture(
    points: Points,
    *,
    porosity: Field,
    grain_density: Field,
    fluid_density: Field,
) -> tuple[Points, Points]:
    """Make the two bodies of a mixture of grains and pore fluid.

    Both have the positions, volumes and velocities of `points`: a volume is that of the mixture.
    With the porosity n, grains have the mass (1 - n) times their density times volume, the fluid n
    times its density times volume.

    Parameters
    ----------
    points : Points
        The mixture as a whole, whose masses are not used.
    porosity : float, str or callable
        Part of the volume that is not grains, above 0 and below 1.
    grain_density, fluid_density : float, str or callable
        Densities of the substances. [kg/m^3]

    Returns
    -------
    grains, fluid : Points
        The two bodies.
    """
    pores = _field("porosity", porosity, points.position, points.sim_type)
    if not np.all((pores > 0.0) & (pores < 1.0)):
        raise PygenError("a porosity is above 0 and below 1 at every point")
    grains = _density(grain_density, points.position, points.sim_type)
    fluid = _density(fluid_density, points.position, points.sim_type)
    return (
        replace(points, mass=(1.0 - pores) * grains * points.volume),
        replace(points, mass=pores * fluid * points.volume),
    )


def _sides(
    spacing: float | Sequence[float] | None,
    cell: float | Sequence[float] | None,
    per_cell: int | Sequence[int],
    dimension: int,
) -> list[float]:
    """Give the spacings, from themselves or from cells of the grid."""
    if (spacing is None) == (cell is None):
        raise PygenError("give either the spacing of the points or the cells of the grid")
    if spacing is not None:
        return spacings(spacing, dimension)
    assert cell is not None
    counts = [per_cell] if isinstance(per_cell, int) else list(per_cell)
    counts = counts * dimension if len(counts) == 1 else counts
    if len(counts) != dimension or any(count < 1 for count in counts):
        raise PygenError(f"points per cell are 1 number or {dimension}, each 1 or more")
    return [h / n for h, n in zip(spacings(cell, dimension), counts, strict=True)]


def _jittered(
    shape: Shape,
    position: FloatArray,
    size: FloatArray,
    sides: Sequence[float],
    jitter: float,
    seed: int,
) -> FloatArray:
    """Move points at random inside of their cells."""
    if not 0.0 < jitter <= 1.0:
        raise PygenError(f"the jitter is from 0 to 1, not {jitter!r}")
    random = np.random.default_rng(seed).uniform(-0.5, 0.5, position.shape)
    # Cells of body-fitted fills differ in size, hence the cube root of the share.
    share = (size / np.prod(sides)) ** (1.0 / len(sides))
    moved = position + jitter * random * np.array(sides) * np.minimum(share, 1.0)[:, None]
    return np.where(shape.contains(moved)[:, None], moved, position)


def _density(density: Field, position: FloatArray, sim_type: SimulationType) -> FloatArray:
    """Evaluate and check a density."""
    values = _field("density", density, position, sim_type)
    sound = np.isfinite(values) & (values > 0.0)
    if not np.all(sound):
        p = int(np.argmin(sound))
        raise PygenError(
            f"the density is a number above 0, not {float(values[p])!r}"
            + ("" if isinstance(density, float | int) else f" at {position[p].tolist()}")
        )
    return values


def _velocity(
    velocity: Sequence[float | str] | Callable[[FloatArray], FloatArray] | None,
    position: FloatArray,
    sim_type: SimulationType,
) -> FloatArray:
    """Evaluate a velocity, one column a component."""
    wanted = (len(position), sim_type.components)
    if velocity is None:
        return np.zeros(wanted)
    if callable(velocity):
        values = np.array(velocity(position), dtype=float)
        if values.shape != wanted:
            raise PygenError(f"the velocity has the shape {values.shape}, {wanted} is needed")
        return values
    if isinstance(velocity, str) or len(velocity) != sim_type.components:
        names = ", ".join(sim_type.coordinates)
        raise PygenError(
            f"a velocity of TYPE {int(sim_type)} has {sim_type.components} components "
            f"({names}), not {1 if isinstance(velocity, str) else len(velocity)}"
        )
    columns = [_field("velocity", component, position, sim_type) for component in velocity]
    return np.stack(columns, axis=1)


def _field(name: str, field: Field, position: FloatArray, sim_type: SimulationType) -> FloatArray:
    """Evaluate a number, an expression or a function at all points."""
    if isinstance(field, str):
        coordinates = sim_type.coordinates[: sim_type.dimension]
        return evaluate(field, dict(zip(coordinates, position.T, strict=True)))
    if callable(field):
        values = np.array(field(position), dtype=float)
        if values.shape != (len(position),):
            raise PygenError(
                f"the {name} has the shape {values.shape}, ({len(position)},) is needed"
            )
        return values
    return np.full(len(position), float(field))
