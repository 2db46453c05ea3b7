"""Scenes of the verification cases: a config and its points files, made from parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from .scheme import GRIDS, Scheme

Array = npt.NDArray[np.float64]

#: Directions of the grid, and components of velocities, by TYPE.
DIM = {1: 1, 2: 2, 3: 3, 4: 2, 5: 2}
NVEL = {1: 1, 2: 2, 3: 3, 4: 3, 5: 3}
#: Component of the vertical, by TYPE.
UP = {1: 0, 2: 1, 3: 2, 4: 1, 5: 1}
#: Courant number of a case that does not choose one.
CFL = 0.2


def pressure_wave_modulus(youngs_modulus: float, poisson: float) -> float:
    """Return M = lambda + 2 G."""
    return youngs_modulus * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))


def shear_modulus(youngs_modulus: float, poisson: float) -> float:
    """Return G."""
    return youngs_modulus / (2 * (1 + poisson))


@dataclass
class Points:
    """Material points as arrays, in the order of the points file and of the frames.

    In TYPE 4 `volume` is the area of the meridian section and `mass` density times that area, as in
    the points file; `measure` has the volume per radian.
    """

    sim_type: int
    #: (n, dim)
    x: Array
    #: (n,)
    volume: Array
    mass: Array
    #: (n, nvel)
    velocity: Array

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.x)

    @property
    def measure(self) -> Array:
        """Volumes as the program counts them: in TYPE 4 per radian."""
        return self.volume * self.x[:, 0] if self.sim_type == 4 else self.volume

    @property
    def total_mass(self) -> Array:
        """Masses as the program counts them: in TYPE 4 per radian."""
        return self.mass * self.x[:, 0] if self.sim_type == 4 else self.mass

    def keep(self, inside: npt.NDArray[np.bool_]) -> Points:
        """Return the points where `inside` holds."""
        return Points(
            self.sim_type,
            self.x[inside],
            self.volume[inside],
            self.mass[inside],
            self.velocity[inside],
        )

    def write(self, path: Path) -> None:
        """Write the points file, with all digits."""
        nvel = NVEL[self.sim_type]
        position = np.zeros((len(self), nvel))
        position[:, : self.x.shape[1]] = self.x
        table = np.column_stack([self.mass, self.volume, position, self.velocity])
        with path.open("w") as file:
            file.write(f"{len(self)}\n")
            file.writelines(" ".join(map(repr, row)) + " 1\n" for row in table.tolist())


def lattice(
    sim_type: int,
    lower: Sequence[float],
    upper: Sequence[float],
    counts: Sequence[int],
    density: float,
    velocity: Sequence[float] | Callable[[Array], Array] = (),
) -> Points:
    """Fill a box with points at the middles of equal sub-boxes, x fastest.

    Parameters
    ----------
    sim_type : int
        TYPE of the job.
    lower, upper : Sequence[float]
        Corners of the box, a number for each direction of the grid.
    counts : Sequence[int]
        Points along each direction.
    density : float
        Density.
    velocity : Sequence[float] or callable
        Velocity of all points, or a function from positions (n, dim) to velocities (n, nvel).

    Returns
    -------
    Points
        The points.
    """
    dim, nvel = DIM[sim_type], NVEL[sim_type]
    sides = [(b - a) / n for a, b, n in zip(lower, upper, counts, strict=True)]
    axes = [
        a + side * (np.arange(n) + 0.5) for a, side, n in zip(lower, sides, counts, strict=True)
    ]
    mesh = np.meshgrid(*reversed(axes), indexing="ij")
    x = np.column_stack([mesh[dim - 1 - d].ravel() for d in range(dim)])
    volume = np.full(len(x), float(np.prod(sides)))
    v = np.zeros((len(x), nvel))
    if callable(velocity):
        v[:] = velocity(x)
    elif len(velocity) > 0:
        v[:, : len(velocity)] = velocity
    return Points(sim_type, x, volume, density * volume, v)


@dataclass
class Body:
    """A body, of elastic material unless it says otherwise."""

    name: str
    points: Points
    youngs_modulus: float
    poisson: float = 0.0
    #: Boundary: a class name, or lines of config.
    boundary: str = ""
    #: Lines of config that replace the elastic material.
    material: str = ""

    def section(self, scheme: Scheme) -> str:
        """Return the section of the config."""
        rate = scheme.rate
        law = "" if rate == "jaumann" else f'material-str-props = {{rate = "{rate}"}}'
        material = self.material or (
            'material-class = "IsotropicLinearElasticity"\n'
            f"    material-props = {{{self.youngs_modulus!r}, {self.poisson!r}}}\n    {law}"
        )
        boundary = self.boundary
        if boundary and "=" not in boundary:
            boundary = f'boundary-class = "{boundary}"'
        return f"""body
{{
    class = "DefaultBody"
    name = "{self.name}"
    point-file = "{self.name}.points"
    {scheme.points_class}
    node-class = "DefaultNodes"
    {material}
    {boundary}
}}
"""


@dataclass
class Scene:
    """A config and its points files."""

    sim_type: int
    #: Lengths of the grid, which begins at 0, and numbers of cells.
    lengths: Sequence[float]
    cells: Sequence[int]
    bodies: Sequence[Body]
    t_stop: float
    dt: float
    #: Frames after the first, at equal intervals.
    frames: int = 1
    #: One of `scheme.GRIDS`; `cpdi`: corner-averaged linear functions.
    mapping: str = "linear"
    #: `implicit` or `explicit`.
    contact_rule: str = "implicit"
    #: Acceleration by gravity; ignored when `driver` is given.
    gravity: Sequence[float] = ()
    #: The section driver, when it is not UserDefinedGravityDriver.
    driver: str = ""
    contacts: Sequence[str] = field(default_factory=list)
    t_start: float = 0.0
    #: Significant digits of the frames.
    digits: int = 15
    #: Directions in which the grid repeats, for each direction; none when empty.
    periodic: Sequence[bool] = ()
    #: `ugimp`: width of the boxes over the size of a cell along x.
    box: float = 0.5
    scheme: Scheme = field(default_factory=Scheme)

    @property
    def steps(self) -> int:
        """Number of steps."""
        return round((self.t_stop - self.t_start) / self.dt)

    @property
    def point_steps(self) -> float:
        """Points times steps: the cost."""
        return float(sum(len(body.points) for body in self.bodies) * self.steps)

    def config(self) -> str:
        """Return the text of the config."""
        gravity = [*self.gravity, *[0.0] * (NVEL[self.sim_type] - len(self.gravity))]
        driver = self.driver or section("UserDefinedGravityDriver", [self.t_stop, *gravity])
        # The rate lies a little above the intended one, so that no frame is missed by rounding.
        rate = self.frames / (self.t_stop - self.t_start) * (1.0 + 1e-9)
        head = f"""job {{ t = {self.t_start!r}  dt = {self.dt!r}  TYPE = {self.sim_type} }}
serializer
{{
    class = "DefaultVTK"
    properties = {{{rate!r}}}
    int-properties = {{{self.digits}}}
    str-properties = {{"frames", "save", "verification"}}
}}
driver
{driver}
{self.scheme.solver_section(self.mapping == "cpdi", self.contact_rule == "implicit")}
{self.grid_section()}
"""
        bodies = [body.section(self.scheme) for body in self.bodies]
        return head + "".join([*bodies, *self.contacts])

    def grid_section(self) -> str:
        """Return the section `grid` of the config."""
        if self.mapping not in GRIDS:
            raise ValueError(f'mapping "{self.mapping}" is not one of {", ".join(GRIDS)}')
        name, reals, integers = GRIDS[self.mapping], list(self.lengths), list(self.cells)
        boxes = self.mapping == "ugimp"
        if self.scheme.domains:
            if not boxes:
                raise ValueError('domains of points go with the mapping "ugimp"')
            name, boxes = GRIDS["linear"], False
        if any(self.periodic):
            integers += map(int, self.periodic)
            name = "CartesianCustom" if name == "CartesianLinear" else f"{name}Custom"
        if boxes:
            reals.append(0.5 * self.box * self.lengths[0] / self.cells[0])
        return f"grid\n{section(name, reals, integers)}"

    def write(self, folder: Path) -> Path:
        """Write points files and config; return the config."""
        folder.mkdir(parents=True, exist_ok=True)
        for body in self.bodies:
            body.points.write(folder / f"{body.name}.points")
        path = folder / "scene.cfg"
        path.write_text(self.config())
        return path


def numbers(values: Sequence[float]) -> str:
    """Return a list of numbers with all digits."""
    return ", ".join(repr(v.item() if isinstance(v, np.generic) else v) for v in values)


def section(
    class_name: str,
    properties: Sequence[float] | dict[str, float],
    integers: Sequence[int] | dict[str, int] = (),
    strings: Sequence[str] = (),
) -> str:
    """Return the braces of a section that names a class; properties by place or by name."""

    def listed(values: Sequence[float] | dict[str, float]) -> str:
        if isinstance(values, dict):
            return ", ".join(f"{key} = {numbers([value])}" for key, value in values.items())
        return numbers(values)

    lines = [f'    class = "{class_name}"', f"    properties = {{{listed(properties)}}}"]
    if integers:
        lines.append(f"    int-properties = {{{listed(integers)}}}")
    if strings:
        texts = ", ".join(f'"{text}"' for text in strings)
        lines.append(f"    str-properties = {{{texts}}}")
    return "\n".join(["{", *lines, "}"])


def huang(first: str, second: str, friction: float = 0.0, normals: int = 1) -> str:
    """Return a section contact; normals 1 averages those of both bodies, 0 takes the first's."""
    return f"""contact
{{
    class = "ContactHuang"
    name = "{first}_{second}"
    properties = {{{friction!r}}}
    int-properties = {{normals = {normals}}}
    str-properties = {{"{first}", "{second}"}}
}}
"""


def stable_dt(
    length: float, cells: int, wave_speed: float, t_stop: float, cfl: float = CFL, frames: int = 1
) -> float:
    """Return the largest dt with a Courant number <= cfl whose multiples hit every frame.

    Parameters
    ----------
    length, cells : float, int
        A length and the cells on it.
    wave_speed : float
        Speed of pressure waves.
    t_stop : float
        Time of the run.
    cfl : float
        Largest Courant number c dt/h.
    frames : int
        Number of equal intervals between frames.
    """
    steps = int(np.ceil(t_stop * wave_speed * cells / (length * cfl * frames) - 1e-9)) * frames
    return t_stop / steps
