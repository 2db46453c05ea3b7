"""Scenes for the tests: points tables and configs, written from a few numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Result = CompletedProcess[str]
#: Runs the program with the given arguments; see the fixture `mpm3d`.
Run = Callable[..., Result]

TYPES = (1, 2, 3, 4, 5)
#: Directions of the grid, and components of velocities, by TYPE.
DIM = {1: 1, 2: 2, 3: 3, 4: 2, 5: 2}
NVEL = {1: 1, 2: 2, 3: 3, 4: 3, 5: 3}
#: Component of gravity, by TYPE.
UP = {1: 0, 2: 1, 3: 2, 4: 1, 5: 1}
GRAVITY = 9.81
EPSILON = float(np.finfo(np.float64).eps)
#: Relative rounding error of one step: sums over at most 2^3 nodes and the points of 2^3 cells.
ROUNDING = 64.0 * EPSILON

#: Materials of the bodies that the example of a class speaks of, where not any material will do.
MATERIALS = {
    "ExplicitMixtureSolver": {
        "block_0": """    material-class = "SlurryGranularPhase"
    material-props = {1e5, 0.3, 0.38, 0.64, 1.23, 0.31, 4.7, 0, 0.585, 2700, 1e-3, 1e-3, 1000}""",
        "block_1": """    material-class = "BarotropicViscousFluid"
    material-props = {1e5, 1e-3}""",
    }
}


def block(
    sim_type: int,
    lower: Sequence[float],
    upper: Sequence[float],
    counts: Sequence[int],
    *,
    velocity: Sequence[float] = (),
    density: float = 1000.0,
) -> Array:
    """Make the rows of a points file for a block along the axes.

    Parameters
    ----------
    sim_type : int
        TYPE of the job.
    lower, upper : Sequence[float]
        Corners, one number for each direction of the grid.
    counts : Sequence[int]
        Points along each direction.
    velocity : Sequence[float]
        Velocity of all points; at rest when left out.
    density : float
        Density; in TYPE 4 the rows have mass and area of the meridian section.

    Returns
    -------
    Array
        Mass, volume, position, velocity and 1 for each point, x fastest.
    """
    dim, nvel = DIM[sim_type], NVEL[sim_type]
    sides = [(b - a) / n for a, b, n in zip(lower, upper, counts, strict=True)]
    axes = [
        a + side * (np.arange(n) + 0.5) for a, side, n in zip(lower, sides, counts, strict=True)
    ]
    lattice = np.meshgrid(*reversed(axes), indexing="ij")
    rows = np.zeros((int(np.prod(counts)), 3 + 2 * nvel))
    rows[:, 1] = np.prod(sides)
    rows[:, 0] = density * rows[:, 1]
    for direction in range(dim):
        rows[:, 2 + direction] = lattice[dim - 1 - direction].ravel()
    rows[:, 2 + nvel : 2 + nvel + len(velocity)] = velocity
    rows[:, -1] = 1.0
    return rows


def write_points(path: Path, rows: Array) -> None:
    """Write a points file with all digits."""
    lines = [str(len(rows))]
    lines += [" ".join([*map(repr, row[:-1].tolist()), str(int(row[-1]))]) for row in rows]
    path.write_text("\n".join(lines) + "\n")


def positions(rows: Array, sim_type: int) -> Array:
    """Return the positions of points as frames have them: three components, the unused ones 0."""
    x = np.zeros((len(rows), 3))
    x[:, : DIM[sim_type]] = rows[:, 2 : 2 + DIM[sim_type]]
    return x


@dataclass
class Body:
    """A body of a scene."""

    name: str
    rows: Array
    modulus: float = 1e5
    poisson: float = 0.3
    #: Lines of the section beside those of every body, for example its boundary.
    more: str = ""

    def section(self) -> str:
        """Return the section of the config."""
        return f"""body
{{
    class = "DefaultBody"
    name = "{self.name}"
    point-file = "{self.name}.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
    material-class = "IsotropicLinearElasticity"
    material-props = {{{self.modulus!r}, {self.poisson!r}}}
    {self.more}
}}
"""

    def wave_speed(self, density: float = 1000.0) -> float:
        """Return the speed of pressure waves."""
        e, nu = self.modulus, self.poisson
        return math.sqrt(e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / density)


@dataclass
class Scene:
    """A config and its points files."""

    sim_type: int
    lengths: Sequence[float]
    cells: Sequence[int]
    bodies: Sequence[Body]
    t_stop: float
    dt: float = 1e-3
    t_start: float = 0.0
    #: Frames per second.
    rate: float = 0.0
    digits: int = 17
    serializer: str = "DefaultVTK"
    #: Gravity of UserDefinedGravityDriver; None for DefaultDriver.
    gravity: Sequence[float] | None = None
    #: Flags of the solver: corner-averaged mapping, implicit contact.
    cpdi: int = 1
    implicit_contact: int = 1
    #: Sections after the bodies.
    contacts: Sequence[str] = field(default_factory=list)
    #: The section grid, when it is not CartesianLinear with the lengths and cells above.
    grid: str | None = None
    #: Lines of the section job.
    job: str = ""
    #: The section driver, when it is none of the two above.
    driver: str | None = None
    #: The section solver, when it is not ExplicitUSL with the two flags.
    solver: str | None = None

    def config(self) -> str:
        """Return the text of the config."""
        driver, reals = "DefaultDriver", [self.t_stop]
        if self.gravity is not None:
            driver, reals = "UserDefinedGravityDriver", [self.t_stop, *self.gravity]
        driver_section = f"""driver
{{
    class = "{driver}"
    properties = {{{numbers(reals)}}}
}}
"""
        grid_section = f"""grid
{{
    class = "CartesianLinear"
    properties = {{{numbers(self.lengths)}}}
    int-properties = {{{numbers(self.cells)}}}
}}
"""
        solver_section = f"""solver
{{
    class = "ExplicitUSL"
    int-properties = {{{self.cpdi}, {self.implicit_contact}}}
}}
"""
        head = f"""job
{{
    t = {self.t_start!r}
    dt = {self.dt!r}
    TYPE = {self.sim_type}
    {self.job}
}}
serializer
{{
    class = "{self.serializer}"
    properties = {{{self.rate!r}}}
    int-properties = {{{self.digits}}}
    str-properties = {{"frames", "save", "test"}}
}}
{self.driver or driver_section}{self.solver or solver_section}{self.grid or grid_section}"""
        return head + "".join([*(body.section() for body in self.bodies), *self.contacts])

    def write(self, folder: Path) -> Path:
        """Write points files and config; return the config."""
        folder.mkdir(parents=True, exist_ok=True)
        for body in self.bodies:
            write_points(folder / f"{body.name}.points", body.rows)
        path = folder / "scene.cfg"
        path.write_text(self.config())
        return path


def drop_scene(**changes: object) -> Scene:
    """Make one small body that falls freely in plane strain."""
    body = Body("drop", block(2, [0.4, 0.6], [0.6, 0.8], [4, 4]))
    settings: dict[str, object] = {
        "sim_type": 2,
        "lengths": [1.0, 1.0],
        "cells": [10, 10],
        "bodies": [body],
        "t_stop": 0.01,
    }
    return Scene(**{**settings, **changes})  # type: ignore[arg-type]


def numbers(values: Sequence[float]) -> str:
    """Return a list of numbers with all digits."""
    return ", ".join(map(repr, values))


def huang(first: str, second: str, friction: float = 0.4) -> str:
    """Return a section contact."""
    return f"""contact
{{
    class = "ContactHuang"
    name = "touch"
    properties = {{{friction!r}}}
    str-properties = {{"{first}", "{second}"}}
}}
"""


def run_scene(run: Run, scene: Scene, folder: Path, *options: str, **keywords: object) -> Result:
    """Write a scene, run it to its end, and expect nothing on the standard error."""
    scene.write(folder)
    result = run("-c", "scene.cfg", *options, cwd=folder, **keywords)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    return result
