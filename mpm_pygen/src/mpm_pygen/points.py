"""The points of one body, and the file that holds them.

The file is a table: the number of points, then for each point mass, volume, position, velocity
and 1 (active) or 0. In TYPE 4 mass and volume are those of the meridian section (density times
area, and area); the program multiplies both by r.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpm_pygen.errors import PointsFileError, PygenError
from mpm_pygen.shape import BoolArray, FloatArray
from mpm_pygen.simulation_type import SimulationType


@dataclass(frozen=True)
class Points:
    """Material points as a points file holds them.

    Parameters
    ----------
    sim_type : SimulationType
        Kind of simulation.
    mass : FloatArray
        `(n,)`; density times area of the meridian section in TYPE 4.
    volume : FloatArray
        `(n,)`; area of the meridian section in TYPE 4.
    position : FloatArray
        `(n, sim_type.dimension)`; the third coordinate of types 4 and 5 is always 0.
    velocity : FloatArray
        `(n, sim_type.components)`.
    active : BoolArray
        `(n,)`.
    """

    sim_type: SimulationType
    mass: FloatArray
    volume: FloatArray
    position: FloatArray
    velocity: FloatArray
    active: BoolArray

    def __post_init__(self) -> None:
        """Check sizes and values."""
        n = len(self.mass)
        if n == 0:
            raise PygenError("a body needs at least one point")
        wanted = {
            "mass": (n,),
            "volume": (n,),
            "position": (n, self.sim_type.dimension),
            "velocity": (n, self.sim_type.components),
            "active": (n,),
        }
        for name, shape in wanted.items():
            found = getattr(self, name).shape
            if found != shape:
                raise PygenError(
                    f"{name} has the shape {found}, TYPE {int(self.sim_type)} "
                    f"and {n} points need {shape}"
                )
        sound = (self.mass > 0.0) & np.isfinite(self.mass)
        sound &= (self.volume > 0.0) & np.isfinite(self.volume)
        sound &= np.all(np.isfinite(self.position), axis=1)
        sound &= np.all(np.isfinite(self.velocity), axis=1)
        if self.sim_type is SimulationType.AXISYMMETRIC:
            sound &= self.position[:, 0] > 0.0
        if not np.all(sound):
            p = int(np.argmin(sound))
            m, volume = float(self.mass[p]), float(self.volume[p])
            x, v = self.position[p].tolist(), self.velocity[p].tolist()
            raise PygenError(f"point {p}: {_fault(self.sim_type, m, volume, x, v)}")

    def __len__(self) -> int:
        """Count the points."""
        return len(self.mass)

    @property
    def total_mass(self) -> float:
        """Mass of the body: per unit area or depth in types 1, 2, 5, per radian in TYPE 4."""
        return math.fsum((self.mass * self.factor).tolist())

    @property
    def total_volume(self) -> float:
        """Volume of the body, in the same sense as `total_mass`."""
        return math.fsum((self.volume * self.factor).tolist())

    @property
    def factor(self) -> FloatArray:
        """What the program multiplies mass and volume by."""
        if self.sim_type is SimulationType.AXISYMMETRIC:
            return self.position[:, 0]
        return np.ones(len(self))


def write_points(path: str | os.PathLike[str], points: Points) -> None:
    """Write a points file: whole, or not at all.

    The numbers are the shortest ones that read back as the same bits.

    Parameters
    ----------
    path : str or PathLike
        The file. It is written under another name in the same folder and then renamed.
    points : Points
        What to write.
    """
    path = Path(path)
    temporary = path.parent / f".{path.name}.{os.getpid()}.tmp"
    try:
        with open(temporary, "x", encoding="ascii", newline="\n") as file:
            file.writelines(_lines(points))
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def read_points(path: str | os.PathLike[str], sim_type: SimulationType | int) -> Points:
    """Read a points file.

    Any white space separates numbers. In types 4 and 5 a line may leave out the third component
    of position and velocity; a third coordinate is not kept, since the program ignores it.

    Parameters
    ----------
    path : str or PathLike
        The file.
    sim_type : SimulationType or int
        Kind of simulation, which the file does not tell.

    Returns
    -------
    Points
        In the order of the file.

    Raises
    ------
    PointsFileError
        Naming the line, when the file is not a points file of this TYPE.
    OSError
        When it cannot be read at all.
    """
    path = Path(path)
    sim_type = SimulationType(sim_type)
    try:
        lines = path.read_text(encoding="ascii").splitlines()
    except UnicodeDecodeError:
        raise PointsFileError(path, 0, "this is no text file of numbers") from None
    count = _count(path, lines)
    while len(lines) > count + 1 and not lines[-1].strip():
        lines.pop()
    if len(lines) != count + 1:
        raise PointsFileError(path, 1, f"{count} points announced, {len(lines) - 1} lines follow")
    rows = np.array([_row(path, k + 1, lines[k], sim_type) for k in range(1, count + 1)])
    d, components = sim_type.dimension, sim_type.components
    return Points(
        sim_type=sim_type,
        mass=rows[:, 0],
        volume=rows[:, 1],
        position=rows[:, 2 : 2 + d],
        velocity=rows[:, 2 + components : 2 + 2 * components],
        active=rows[:, -1] == 1.0,
    )


def _lines(points: Points) -> Iterator[str]:
    """Give the lines of a points file."""
    yield f"{len(points)}\n"
    padding = " 0" * (points.sim_type.components - points.sim_type.dimension)
    for mass, volume, x, v, active in zip(
        points.mass.tolist(),
        points.volume.tolist(),
        points.position.tolist(),
        points.velocity.tolist(),
        points.active.tolist(),
        strict=True,
    ):
        position = " ".join(map(repr, x))
        velocity = " ".join(map(repr, v))
        yield f"{mass!r} {volume!r} {position}{padding} {velocity} {int(active)}\n"


def _count(path: Path, lines: list[str]) -> int:
    """Read the first line."""
    text = lines[0].strip() if lines else ""
    if not (text.isascii() and text.isdigit() and int(text) > 0):
        raise PointsFileError(path, 1, f"the first line is the number of points, not {text[:40]!r}")
    return int(text)


def _row(path: Path, line: int, text: str, sim_type: SimulationType) -> list[float]:
    """Read one point as a row of full width."""
    fields = text.split()
    if len(fields) not in sim_type.widths:
        widths = " or ".join(map(str, sim_type.widths))
        columns = " ".join(sim_type.columns)
        raise PointsFileError(
            path,
            line,
            f"a point of TYPE {int(sim_type)} has {widths} columns ({columns}), not {len(fields)}",
        )
    row = []
    for field in fields:
        try:
            row.append(float(field))
        except ValueError:
            raise PointsFileError(path, line, f"{field[:40]!r} is not a number") from None
    d = sim_type.dimension
    if len(row) == 3 + 2 * d and sim_type.components > d:
        row = [*row[: 2 + d], 0.0, *row[2 + d : 2 + 2 * d], 0.0, row[-1]]
    if row[-1] not in (0.0, 1.0):
        raise PointsFileError(path, line, f"the last column is 1 (active) or 0, not {fields[-1]!r}")
    wrong = _fault(sim_type, row[0], row[1], row[2 : 2 + d], row[2 + sim_type.components : -1])
    if wrong:
        raise PointsFileError(path, line, wrong)
    return row


def _fault(
    sim_type: SimulationType, mass: float, volume: float, x: list[float], v: list[float]
) -> str:
    """Say what is wrong with a point, or nothing."""
    for name, value in (("mass", mass), ("volume", volume)):
        if not (math.isfinite(value) and value > 0.0):
            return f"the {name} is a number above 0, not {value!r}"
    for name, values in (("position", x), ("velocity", v)):
        if not all(map(math.isfinite, values)):
            return f"the {name} {values} is not finite"
    if sim_type is SimulationType.AXISYMMETRIC and x[0] <= 0.0:
        return f"r is above 0 in TYPE 4, not {x[0]!r}"
    return ""
