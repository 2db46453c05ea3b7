"""Scenes of grains in a fluid, for the tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from scene import Array, Result, Run, block, numbers, write_points

RHO_GRAIN, RHO_FLUID = 2500.0, 1000.0
GRAVITY = 9.81


@dataclass
class Slurry:
    """Grains and fluid in one box of the grid, with materials that name each other."""

    sim_type: int
    lengths: Sequence[float]
    cells: Sequence[int]
    lower: Sequence[float]
    upper: Sequence[float]
    dt: float
    t_stop: float
    #: Packing fraction.
    packing: float = 0.5
    diameter: float = 2e-3
    viscosity: float = 0.1
    bulk: float = 1e5
    #: Length and strength of the shift of the fluid's points.
    shift: Sequence[float] = ()
    gravity: float = GRAVITY
    #: Density of the grains.
    grain: float = RHO_GRAIN
    #: Pressure of the fluid over depth times gravity.
    effective: float = 0.0
    #: Height of the surface above the highest point of the fluid.
    surface: float = 0.0
    grain_velocity: Sequence[float] = ()
    fluid_velocity: Sequence[float] = ()
    grid: str = "CartesianLinear"
    #: Which directions of CartesianCustom repeat.
    periodic: Sequence[int] = ()
    solver: str = "ExplicitUSL"
    boundary: str = 'boundary-class = "CartesianBox"'
    flags: str = ', "USE_CARMAN_KOZENY"'
    #: Frames per second.
    rate: float = 0.0
    #: Points in a cell and direction.
    per_cell: int = 2
    #: Further sections.
    more: Sequence[str] = field(default_factory=list)

    def points(self, density: float, velocity: Sequence[float]) -> Array:
        """Return the rows of a points file."""
        counts = [
            round((b - a) * n / length) * self.per_cell
            for a, b, n, length in zip(
                self.lower, self.upper, self.cells, self.lengths, strict=True
            )
        ]
        return block(
            self.sim_type, self.lower, self.upper, counts, velocity=velocity, density=density
        )

    def downwards(self) -> float:
        """Return gravity as HydrostaticBody takes it: in TYPE 1 with its sign."""
        return -self.gravity if self.sim_type == 1 else self.gravity

    def body(self, name: str, material: str, effective: float) -> str:
        """Return a section body."""
        return f"""body
{{
    class = "HydrostaticBody"
    name = "{name}"
    properties = {{{numbers([self.downwards(), effective])}, surface = {self.surface!r}}}
    point-file = "{name}.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
    {material}
    {self.boundary}
}}
"""

    def config(self) -> str:
        """Return the text of the config."""
        eta, d = self.viscosity, self.diameter
        gravity = [0.0] * len(self.lengths) + [0.0] * (self.sim_type in (4, 5))
        gravity[{1: 0, 2: 1, 3: 2, 4: 1, 5: 1}[self.sim_type]] = -self.gravity
        law = [1e4, 0.3, 0.3819, 0.6435, 1.23, 0.3085, 4.7154, 0.0, 0.585, self.grain]
        sand = f"""material-class = "SlurryGranularPhase"
    material-props = {{{numbers([*law, eta, d, RHO_FLUID])}}}
    material-str-props = {{"water"}}"""
        water = f"""material-class = "SlurryFluidPhase"
    material-props = {{{numbers([self.bulk, eta, self.grain, *self.shift])}}}
    material-str-props = {{"sand"}}"""
        sections = [
            f"job {{ dt = {self.dt!r} TYPE = {self.sim_type} }}\n",
            f'serializer {{ class = "DefaultVTK" properties = {{{self.rate!r}}} '
            'int-properties = {17} str-properties = {"frames", "save", "test"} }\n',
            'driver { class = "UserDefinedGravityDriver" '
            f"properties = {{{numbers([self.t_stop, *gravity])}}} }}\n",
            f'solver {{ class = "{self.solver}" }}\n',
            f'grid {{ class = "{self.grid}" properties = {{{numbers(self.lengths)}}} '
            f"int-properties = {{{', '.join(map(str, [*self.cells, *self.periodic]))}}} }}\n",
            self.body("sand", sand, 0.0),
            self.body("water", water, self.effective),
            'contact { class = "SlurryMixture" name = "mixture" '
            f"properties = {{{numbers([self.grain, d, eta, RHO_FLUID])}}} "
            f'str-properties = {{"sand", "water"{self.flags}}} }}\n',
        ]
        return "".join([*sections, *self.more])

    def write(self, folder: Path) -> None:
        """Write points files and config."""
        folder.mkdir(parents=True, exist_ok=True)
        phi = self.packing
        write_points(folder / "sand.points", self.points(phi * self.grain, self.grain_velocity))
        water = self.points((1.0 - phi) * RHO_FLUID, self.fluid_velocity)
        write_points(folder / "water.points", water)
        (folder / "scene.cfg").write_text(self.config())

    def run(self, run: Run, folder: Path, *options: str, **keywords: object) -> Result:
        """Write the scene, run it to its end, and expect nothing on the standard error."""
        self.write(folder)
        result = run("-c", "scene.cfg", *options, cwd=folder, **keywords)
        assert (result.returncode, result.stderr) == (0, "")
        return result

    def drag(self) -> float:
        """Return the drag of Carman and Kozeny per volume and velocity."""
        phi = self.packing
        return 180.0 * phi**2 * self.viscosity / ((1.0 - phi) * self.diameter**2)
