"""The scenes of the bench suite: elastic blocks that drift across the cells of their grid."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mpm_pygen import Block, Points, SimulationType, fill, write_box_mesh, write_points

#: A Courant number of about 0.1 for the wave speed of the blocks.
COURANT, WAVE_SPEED = 0.1, 36.7
#: Grids that read a mesh: that of the box, its cells cut into triangles or tetrahedra.
MESHES = ("TriangularGridLinear", "TetrahedralGridLinear")


@dataclass(frozen=True)
class Scene:
    """Bodies in a unit box.

    `bodies` is 1, or 2 for two halves that are pressed together in a contact. `cells` is the number
    of cells along each side; by default the bodies fill 0.8 of it. `material` is what the config
    says of the material.
    """

    name: str
    sim_type: int
    cpdi: int
    grid: str = "CartesianLinear"
    solver: str = "ExplicitUSL"
    transfer: str = ""
    bodies: int = 1
    cells: int = 0
    material: str = "material-class = IsotropicLinearElasticity  material-props = {1e6, 0.3}"

    @property
    def classes(self) -> list[str]:
        """Classes that a program must have to run the scene."""
        return [self.grid, self.solver, self.material.split()[2]]


SCENES = (
    Scene("1d-linear", 1, 0),
    Scene("plane-linear", 2, 0),
    Scene("plane-cpdi", 2, 1),
    Scene("axisymmetric-linear", 4, 0),
    Scene("out-of-plane-linear", 5, 0),
    Scene("3d-linear", 3, 0),
    Scene("3d-cpdi", 3, 1),
    Scene("plane-ugimp", 2, 0, "CartesianUGIMP"),
    Scene("plane-quadratic", 2, 0, "CartesianQuadratic"),
    Scene("plane-cubic", 2, 0, "CartesianCubic"),
    Scene("3d-ugimp", 3, 0, "CartesianUGIMP"),
    Scene("3d-quadratic", 3, 0, "CartesianQuadratic"),
    Scene("3d-cubic", 3, 0, "CartesianCubic"),
    Scene("3d-linear-musl", 3, 0, solver="ExplicitMUSL"),
    Scene("3d-linear-usf", 3, 0, solver="ExplicitUSF"),
    Scene("3d-linear-blend", 3, 0, transfer="properties = {flip = 0.99}"),
    Scene("3d-linear-apic", 3, 0, transfer="str-properties = {APIC}"),
    Scene("3d-linear-xpic-2", 3, 0, transfer="str-properties = {XPIC}"),
    Scene("3d-cpdi-apic", 3, 1, transfer="str-properties = {APIC}"),
    Scene("3d-cpdi-mls", 3, 1, transfer="str-properties = {MLS}"),
    Scene("plane-triangles", 2, 0, "TriangularGridLinear"),
    Scene("plane-triangles-cpdi", 2, 1, "TriangularGridLinear"),
    Scene("3d-tetrahedra", 3, 0, "TetrahedralGridLinear"),
    Scene("3d-tetrahedra-cpdi", 3, 1, "TetrahedralGridLinear"),
    Scene("plane-contact", 2, 0, bodies=2),
    Scene("3d-contact", 3, 0, bodies=2),
    Scene("3d-cpdi-contact", 3, 1, bodies=2),
    Scene("3d-sparse", 3, 0, cells=1024),
)
SCENE = {scene.name: scene for scene in SCENES}


@dataclass(frozen=True)
class Case:
    """A scene on disk: its number of points, its time step, and the steps between frames."""

    scene: Scene
    folder: Path
    points: int
    dt: float


def write_scene(scene: Scene, folder: Path, points: int) -> Case:
    """Write the points files and the config of a scene with about so many points.

    There are two points a cell and direction.
    """
    sim_type = SimulationType(scene.sim_type)
    dim = sim_type.dimension
    across = max(2, 2 * round(points ** (1.0 / dim) / 2))
    cells = scene.cells or max(2, round(across / 2 / 0.8))
    spacing = 0.5 / cells
    lower = [max(1, round(0.1 * cells)) / cells] * dim
    upper = [low + across * spacing for low in lower]
    velocity = [0.1, 0.2, 0.3][: sim_type.components]
    if sim_type is SimulationType.AXISYMMETRIC:
        velocity = [0.0, 0.2, 0.0]
    bodies = []
    for number, (low, high) in enumerate(split(lower, upper, scene.bodies, 1.0 / cells)):
        # The upper half falls on the lower one.
        fall = [0.0] * (dim - 1) + [-0.1 * number]
        moving = [v + w for v, w in zip(velocity, fall + [0.0] * 3, strict=False)]
        bodies.append(
            fill(Block(low, high), sim_type, spacing=spacing, density=1000.0, velocity=moving)
        )
    dt = COURANT / cells / WAVE_SPEED
    write_files(scene, folder, bodies, cells, spacing, dt)
    return Case(scene, folder, sum(len(body.mass) for body in bodies), dt)


def split(
    lower: list[float], upper: list[float], bodies: int, cell: float
) -> list[tuple[list[float], list[float]]]:
    """Cut a block into one or two along the last direction, at a node line."""
    if bodies == 1:
        return [(lower, upper)]
    half = lower[-1] + max(1, round(0.5 * (upper[-1] - lower[-1]) / cell)) * cell
    return [(lower, [*upper[:-1], half]), ([*lower[:-1], half], upper)]


def write_files(
    scene: Scene, folder: Path, bodies: list[Points], cells: int, spacing: float, dt: float
) -> None:
    """Write the points files and the config."""
    dim = SimulationType(scene.sim_type).dimension
    # uGIMP: half of the width of a point.
    half_width = [repr(spacing / 2)] if scene.grid == "CartesianUGIMP" else []
    box = ", ".join(["1.0"] * dim + half_width)
    counts = ", ".join([str(cells)] * dim)
    lists = f"properties = {{{box}}}  int-properties = {{{counts}}}"
    if scene.grid in MESHES:
        write_box_mesh(folder / "box.msh", [0.0] * dim, [1.0] * dim, [cells] * dim)
        lists = "str-properties = {box.msh}"
    frames = "int-properties = {nodes = 0}" if scene.cells else ""
    text = f"""job {{ t = 0  dt = {dt!r}  TYPE = {scene.sim_type} }}
serializer {{
  class = MinimalVTK  properties = {{0}}  {frames}  str-properties = {{frames, save, bench}}
}}
driver {{ class = DefaultDriver  properties = {{1}} }}
solver {{ class = {scene.solver}  int-properties = {{{scene.cpdi}, 1}}  {scene.transfer} }}
grid {{ class = {scene.grid}  {lists} }}
"""
    for number, body in enumerate(bodies):
        write_points(folder / f"block_{number}.points", body)
        text += f"""body {{
  class = DefaultBody  name = block_{number}  point-file = block_{number}.points
  point-class = DefaultPoints  node-class = DefaultNodes
  {scene.material}
  boundary-class = CartesianSmoothBox
}}
"""
    if len(bodies) > 1:
        text += (
            "contact { class = ContactHuang  name = seam  properties = {0.3}\n"
            "  str-properties = {block_0, block_1} }\n"
        )
    (folder / "bench.cfg").write_text(text)
