"""The scenes of the bench suite: blocks that drift across the cells of their grid."""

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
    says of the material, `density` that of the block. A block that is `sheared` is compressed as
    well, so that a granular material flows.
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
    density: float = 1000.0
    sheared: bool = False

    @property
    def duration(self) -> float:
        """Simulated time of a run at most, in s.

        Blocks of few points would reach the floor; a sheared one deforms until nearly empty nodes,
        which `ExplicitUSL` with hats amplifies, ruin the fish.
        """
        return 0.0085 if self.sheared else 0.05

    @property
    def classes(self) -> list[str]:
        """Classes that a program must have to run the scene."""
        return [self.grid, self.solver, self.material.split()[2]]


def sheared(name: str, material: str, reals: str, density: float) -> Scene:
    """Return the scene of a material in 3D."""
    text = f"material-class = {material}  material-props = {{{reals}}}"
    return Scene(f"3d-{name}", 3, 0, material=text, density=density, sheared=True)


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
    sheared("elastic", "IsotropicLinearElasticity", "E = 1e6, nu = 0.3", 1000.0),
    sheared("neohookean", "CompressibleNeohookeanElasticity", "E = 1e6, nu = 0.3", 1000.0),
    sheared("fluid", "BarotropicViscousFluid", "K = 1e6, eta = 0.1", 1000.0),
    sheared(
        "tillotson",
        "TillotsonEOSFluid",
        "rho_0 = 998, rho_IV = 958, a = 0.7, b = 0.15, A = 1e6, B = 6e6, E_0 = 7e6, alpha = 10, "
        "beta = 5, E_IV = 4.19e5, E_CV = 2.69e6, c_v = 3690, T_0 = 293, eta_0 = 8.9e-4, "
        "P_cav = -1e5",
        1000.0,
    ),
    sheared(
        "sand",
        "Sand_SachithLocal",
        "E = 1e6, nu = 0.3, d = 0.005, mu_s = 0.3819, rho_s = 2450, rho_c = 1500, mu_2 = 0.6435, "
        "I_0 = 0.279",
        1500.0,
    ),
    sheared(
        "breakage",
        "BreakageMechanicsSand",
        "p_r = 1e3, K = 1200, G = 900, E_c = 3.5e4, M_0 = 1.2, gamma = 0.9, phi_l = 0.25, "
        "phi_u = 0.5, l = 0.2, u = 0.1, theta = 0.85, rho_0 = 2650, B_0 = 0, phi_0 = 0.4",
        1590.0,
    ),
    sheared(
        "slurry-grains",
        "SlurryGranularPhase",
        "E = 1e6, nu = 0.3, mu_1 = 0.3819, mu_2 = 0.6435, a = 1.23, b = 0.3085, K_3 = 4.7154, "
        "K_4 = 0, phi_m = 0.585, rho_s = 2700, eta_0 = 1e-3, d = 1e-3, rho_f = 1000",
        1580.0,
    ),
    sheared(
        "slurry-packing",
        "SlurryGranularPhase_wUnderCompaction",
        "E = 1e6, nu = 0.3, mu_1 = 0.3819, mu_2 = 0.6435, a = 1.23, b = 0.3085, K_3 = 0.5, "
        "K_4 = 0, phi_m = 0.585, rho_s = 2700, eta_0 = 1e-3, d = 1e-3, rho_f = 1000, phi_c = 0.55",
        1580.0,
    ),
    sheared("slurry-fluid", "SlurryFluidPhase", "K = 1e6, eta_0 = 0.1, rho_s = 2700", 1000.0),
    sheared(
        "cornstarch",
        "Cornstarch",
        "E = 1e6, nu = 0.3, mu_1 = 0.5, a_0 = 0.2, a_inf = 1, K_3 = 0.6, K_4 = 0, K_5 = 1, "
        "K_6 = 1e-3, phi_j = 0.6, phi_c = 0.55, Delta = 0.5, tau_star = 10, alpha = 1, "
        "rho_s = 1500, eta_0 = 1e-3, d = 1e-5, rho_f = 1000",
        870.0,
    ),
    sheared(
        "fish",
        "Fish",
        "E = 1e6, nu = 0.3, alpha_h = 0.02, alpha_a = 0.05, alpha_t = 0.1, beta_h = 6.28, "
        "beta_a = 6.28, beta_t = 6.28, gamma_h = 0, gamma_a = 0, gamma_t = 0",
        1000.0,
    ),
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
        moving: list[float | str] = [
            v + w for v, w in zip(velocity, fall + [0.0] * 3, strict=False)
        ]
        if scene.sheared:
            moving = ["0.1 + 2*(z - 0.5)", 0.2, "0.3 - 0.5*(z - 0.5)"]
        bodies.append(
            fill(
                Block(low, high),
                sim_type,
                spacing=spacing,
                density=scene.density,
                velocity=moving,
            )
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
