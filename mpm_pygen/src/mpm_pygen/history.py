"""Histories in time: masses, momenta, energies and centres of mass of the bodies of a run."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpm_pygen.clouds import Cloud
from mpm_pygen.config import Body, Config
from mpm_pygen.errors import PygenError
from mpm_pygen.frames import Frames, by_name
from mpm_pygen.points import read_points
from mpm_pygen.shape import FloatArray
from mpm_pygen.simulation_type import SimulationType

_AXES = {4: ("r", "z", "theta")}


@dataclass(frozen=True, eq=False)
class History:
    """A table over time.

    Parameters
    ----------
    time : FloatArray
        `(n,)` [s]
    columns : dict[str, FloatArray]
        By name, `(n,)`; `block.kinetic_energy` for a body, `contact.force_by_b_on_a_x` for
        a contact. What is not known at a time is NaN.
    """

    time: FloatArray
    columns: dict[str, FloatArray]

    def __getitem__(self, name: str) -> FloatArray:
        """Give a column."""
        if name not in self.columns:
            raise PygenError(f"there is no column {name!r}; there are {', '.join(self.columns)}")
        return self.columns[name]

    def sum(self, quantity: str) -> FloatArray:
        """Add a quantity of all bodies that have it at a time, for example the kinetic energy.

        Parameters
        ----------
        quantity : str
            Last part of the names of the columns.
        """
        found = [values for name, values in self.columns.items() if name.endswith(f".{quantity}")]
        if not found:
            raise PygenError(f"no body has a column {quantity!r}")
        return np.asarray(np.nansum(found, axis=0))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a CSV file with a line of names; numbers read back as the same bits.

        Parameters
        ----------
        path : str or PathLike
            The file.
        """
        with open(path, "w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["time", *self.columns])
            for row in zip(self.time, *self.columns.values(), strict=True):
                writer.writerow([repr(float(value)) for value in row])


def read_history(path: str | os.PathLike[str]) -> History:
    """Read a CSV file: a line of names, the first of which is `time`, and lines of numbers.

    Parameters
    ----------
    path : str or PathLike
        The file; lines that start with # do not count.
    """
    path = Path(path)
    with open(path, encoding="utf-8", newline="") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    if not rows or not rows[0][0].strip().startswith("time"):
        raise PygenError(f"{path}: the first column of a history is time")
    names = [name.strip() for name in rows[0]]
    try:
        table = np.array(
            [[float(value) if value.strip() else np.nan for value in row] for row in rows[1:]]
        )
    except ValueError as error:
        raise PygenError(f"{path}: {error}") from None
    if table.shape != (len(rows) - 1, len(names)):
        raise PygenError(f"{path}: a line has not the {len(names)} columns of the first one")
    return History(table[:, 0], dict(zip(names[1:], table[:, 1:].T, strict=True)))


def make_history(frames: Frames, *, contacts: bool = True) -> History:
    """Make the histories of the bodies from frames.

    Masses are those of the frames, or else of the points file of the config. The strain energy
    needs a config with `IsotropicLinearElasticity`. In TYPE 1, 2 and 5 all is for a unit area or
    depth, in TYPE 4 for one radian.

    Parameters
    ----------
    frames : Frames
        The run.
    contacts : bool
        Sum the contact forces of the node files as well, if there are any.
    """
    # Without a config TYPE 2 and TYPE 5 look the same.
    count = SimulationType(frames.sim_type).components if frames.config else 3
    axes = _AXES.get(frames.sim_type, ("x", "y", "z"))[:count]
    columns: dict[str, list[float]] = {}
    for frame in frames:
        row: dict[str, float] = {}
        for body in frames.bodies:
            for name, value in _of_body(frames, body, frame.points(body), axes):
                row[f"{body}.{name}"] = value
            if contacts:
                try:
                    nodes = frame.nodes(body)
                except PygenError:
                    continue
                for name in nodes.fields:
                    if name.startswith("contact_force_by_"):
                        total = nodes[name].sum(axis=0)[: len(axes)]
                        for axis, value in zip(axes, total.tolist(), strict=True):
                            row[f"contact.{name.removeprefix('contact_')}_{axis}"] = value
        place = len(next(iter(columns.values()), []))
        for name in row:
            columns.setdefault(name, [np.nan] * place)
        for name, values in columns.items():
            values.append(row.get(name, np.nan))
    return History(frames.times.copy(), {name: np.array(v) for name, v in columns.items()})


def _of_body(
    frames: Frames, body: str, cloud: Cloud, axes: tuple[str, ...]
) -> Iterator[tuple[str, float]]:
    """Give the quantities of a body in a frame that can be had."""
    if "velocity" not in cloud.fields:
        return
    mass = cloud.fields.get("mass")
    if mass is None:
        mass = _initial_mass(frames, body, len(cloud))
    kept = cloud.active
    mass, velocity, position = mass[kept], cloud["velocity"][kept], cloud.position[kept]
    total = float(mass.sum())
    yield "mass", total
    if total > 0.0:
        grid = axes[: SimulationType(frames.sim_type).dimension]
        for axis, value in zip(grid, (mass @ position / total).tolist(), strict=False):
            yield f"centre_{axis}", value
    for axis, value in zip(axes, (mass @ velocity).tolist(), strict=False):
        yield f"momentum_{axis}", value
    yield "kinetic_energy", float(0.5 * mass @ np.sum(velocity**2, axis=1))
    constants = _elastic_constants(frames.config, body)
    if constants is not None and {"volume", "cauchy_stress"} <= set(cloud.fields):
        modulus, poisson = constants
        stress, volume = cloud["cauchy_stress"][kept], cloud["volume"][kept]
        trace = np.trace(stress, axis1=1, axis2=2)
        square = np.sum(stress**2, axis=(1, 2))
        density = ((1.0 + poisson) * square - poisson * trace**2) / (2.0 * modulus)
        yield "strain_energy", float(volume @ density)


def _section(config: Config | None, body: str) -> Body | None:
    """Find the section of a body; a / in a name is a _ in those of files."""
    if config is None:
        return None
    return next((b for b in config.bodies if b.name.replace("/", "_") == body), None)


def _initial_mass(frames: Frames, body: str, count: int) -> FloatArray:
    """Read the masses of a points file."""
    section = _section(frames.config, body)
    if section is None:
        raise PygenError(
            f"the frames of {body} have no masses (MinimalVTK): name the config of the run"
        )
    places = [Path()] if frames.config_path is None else [Path(), frames.config_path.parent]
    for place in places:
        path = place / section.point_file
        if path.is_file() and path.suffix != ".parts":
            points = read_points(path, frames.sim_type)
            mass = points.mass * points.factor
            if len(mass) == count:
                return mass
    raise PygenError(f"the masses of {body} are in neither the frames nor a points file")


def _elastic_constants(config: Config | None, body: str) -> tuple[float, float] | None:
    """Give Young's modulus and Poisson's ratio of an elastic body."""
    section = _section(config, body)
    if section is None or section.material is None:
        return None
    if section.material.class_name != "IsotropicLinearElasticity":
        return None
    values = section.material.properties
    named = dict(by_name(values))
    if isinstance(values, tuple):
        named |= dict(
            zip(("E", "nu"), (v for v in values if not isinstance(v, dict)), strict=False)
        )
    try:
        return float(str(named["E"])), float(str(named["nu"]))
    except (KeyError, ValueError):
        return None
