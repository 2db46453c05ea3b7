"""The scenes of `configs/`, made from parameters.

Each function gives a `Config` with the points of its bodies. `cells` is the number of cells along
the first side of the grid; the time step follows it. With the default values they are the scenes of
the folder `configs`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mpm_pygen.config import Body, Config, Job, Object, Parts
from mpm_pygen.filling import fill
from mpm_pygen.points import Points
from mpm_pygen.shape import Shape
from mpm_pygen.shapes import Block, Circle, HalfCircle, Sphere

#: Corner-averaged mapping and implicit contact.
SOLVER = Object("ExplicitUSL", int_properties=(1, 1))
DENSITY = 1000.0


def bar_1d(cells: int = 50, per_cell: int = 2) -> Config:
    """Impact of two bars in uniaxial strain.

    Parameters
    ----------
    cells : int
        Along the box of 1 m.
    per_cell : int
        Points in a cell.
    """
    h = 1.0 / cells
    bars = (Block((0.1,), (0.4,)), Block((0.5,), (0.8,)))
    moving, resting = (
        _points(bar, 1, h, per_cell, v) for bar, v in zip(bars, ((1.0,), (0.0,)), strict=True)
    )
    material = elastic(1e6, 0)
    return Config(
        job=Job(dt=2e-4 * 50 / cells, sim_type=1),
        serializer=frames("bar_1d", 200),
        driver=Object("UserDefinedGravityDriver", (0.2, 0)),
        solver=SOLVER,
        grid=grid((1.0,), (cells,)),
        bodies=[
            Body("bar_0", moving, material, Object("CartesianBox")),
            Body("bar_1", resting, material, Object("CartesianBox")),
        ],
        contacts=[contact("impact", 0, "bar_0", "bar_1")],
        remark="A moving elastic bar hits an equal bar at rest and hands its velocity over.",
    )


def two_blocks(cells: int = 20, per_cell: int = 2) -> Config:
    """Collision of a soft and a stiff block in plane strain, with gravity.

    Parameters
    ----------
    cells : int
        Along each side of the box of 1 m.
    per_cell : int
        Points in a cell and direction.
    """
    h = 1.0 / cells
    standing = _points(Block((0.35, 0.0), (0.65, 0.3)), 2, h, per_cell)
    thrown = _points(Block((0.1, 0.5), (0.3, 0.7)), 2, h, per_cell, (1.0, 0.0))
    return Config(
        job=Job(dt=2.5e-5 * 20 / cells, sim_type=2),
        serializer=frames("two_blocks", 60),
        driver=Object("DefaultDriver", (1,)),
        solver=SOLVER,
        grid=grid((1.0, 1.0), (cells, cells)),
        bodies=[
            Body("block_0", standing, elastic(1e5, 0.3), Object("CartesianBox")),
            Body(
                "block_1",
                thrown,
                Object("IsotropicLinearElasticity", (1e8, 0.4)),
                Object("CartesianBox"),
            ),
        ],
        contacts=[contact("collision", 0.4, "block_0", "block_1")],
        remark="A stiff block is thrown onto a soft one that stands on the floor.",
    )


def two_discs(cells: int = 20, per_cell: int = 2) -> Config:
    """Head-on collision of two discs without gravity.

    Parameters
    ----------
    cells : int
        Along each side of the box of 1 m.
    per_cell : int
        Points in a cell and direction.
    """
    free = Object("CartesianBoxCustom", int_properties=(-1, -1, -1, -1))
    bodies = []
    for k, (place, v) in enumerate(((0.2, 0.1), (0.8, -0.1))):
        points = _points(Circle((place, place), 0.2), 2, 1.0 / cells, per_cell, (v, v))
        bodies.append(Body(f"disc_{k}", points, elastic(1000, 0.3), free))
    return Config(
        job=Job(dt=1e-3 * 20 / cells, sim_type=2),
        serializer=frames("two_discs", 20),
        driver=Object("UserDefinedGravityDriver", (3.5, 0, 0)),
        solver=SOLVER,
        grid=grid((1.0, 1.0), (cells, cells)),
        bodies=bodies,
        contacts=[contact("collision", 0, "disc_0", "disc_1")],
        remark="Two elastic discs collide head-on without gravity.",
    )


def two_spheres_3d(cells: int = 20, per_cell: int = 2) -> Config:
    """Oblique impact of two spheres in 3D.

    Parameters
    ----------
    cells : int
        Along each side of the box of 1 m.
    per_cell : int
        Points in a cell and direction.
    """
    bodies = []
    for k, (x, y, v) in enumerate(((0.3, 0.45, 0.5), (0.7, 0.55, -0.5))):
        sphere = Sphere((x, y, 0.5), 0.15)
        points = _points(sphere, 3, 1.0 / cells, per_cell, (v, 0.0, 0.0))
        bodies.append(Body(f"sphere_{k}", points, elastic(2e4, 0.3), Object("CartesianBox")))
    return Config(
        job=Job(dt=1e-3 * 20 / cells, sim_type=3),
        serializer=frames("two_spheres_3d", 60, "MinimalVTK"),
        driver=Object("UserDefinedGravityDriver", (0.5, 0, 0, 0)),
        solver=SOLVER,
        grid=grid((1.0, 1.0, 1.0), (cells, cells, cells)),
        bodies=bodies,
        contacts=[contact("collision", 0.4, "sphere_0", "sphere_1")],
        remark="Two elastic spheres meet off centre without gravity and leave on bent paths.",
    )


def ball_axisymmetric(cells: int = 20, per_cell: int = 2) -> Config:
    """Bounce of a ball, in its meridian section.

    Parameters
    ----------
    cells : int
        Along r, 0.5 m; an even number.
    per_cell : int
        Points in a cell and direction.
    """
    ball = _points(HalfCircle((0.0, 0.3), 0.2), 4, 0.5 / cells, per_cell)
    slip = Object("CartesianBoxCustom", int_properties=(1, 1, 1, 1))
    return Config(
        job=Job(dt=2.5e-4 * 20 / cells, sim_type=4),
        serializer=frames("ball_axisymmetric", 60),
        driver=Object("DefaultDriver", (1,)),
        solver=SOLVER,
        grid=grid((0.5, 0.75), (cells, cells * 3 // 2)),
        bodies=[Body("ball", ball, elastic(1e5, 0.3), slip)],
        remark="An elastic ball falls on a smooth floor and bounces, seen in its meridian section.",
    )


def sheared_block_2_5d(cells: int = 20, per_cell: int = 2) -> Config:
    """Friction that acts out of the plane.

    Parameters
    ----------
    cells : int
        Along x, 1 m; an even number.
    per_cell : int
        Points in a cell and direction.
    """
    h = 1.0 / cells
    block = _points(Block((0.1, 0.0), (0.9, 0.2)), 5, h, per_cell)
    slider = _points(Block((0.3, 0.2), (0.7, 0.4)), 5, h, per_cell, (0.0, 0.0, 1.0))
    return Config(
        job=Job(dt=2.5e-4 * 20 / cells, sim_type=5),
        serializer=frames("sheared_block_2_5d", 60),
        driver=Object("UserDefinedGravityDriver", (0.5, 0, -9.81, 0)),
        solver=SOLVER,
        grid=grid((1.0, 0.5), (cells, cells // 2)),
        bodies=[
            Body("block", block, elastic(1e6, 0.3), Object("CartesianBox")),
            Body("slider", slider, elastic(1e6, 0.3), Object("CartesianBox")),
        ],
        contacts=[contact("friction", 0.4, "block", "slider")],
        remark="A slider moves out of the plane over a block and is brought to rest by friction.",
    )


def generated_block(cells: int = 10, per_cell: int = 2) -> Config:
    """Fall of a block with a dome, whose points the program generates.

    Parameters
    ----------
    cells : int
        Along each side of the box of 1 m.
    per_cell : int
        Points in a cell and direction.
    """
    lengths, counts = (1.0, 1.0, 1.0), (cells, cells, cells)
    parts = Parts(
        lengths,
        counts,
        per_cell,
        DENSITY,
        [
            Object("Box", (0.3, 0.3, 0.2, 0.7, 0.7, 0.5)),
            Object("Ball", (0.5, 0.5, 0.5, 0.2)),
        ],
    )
    return Config(
        job=Job(dt=1e-3 * 10 / cells, sim_type=3),
        serializer=frames("generated_block", 60, "MinimalVTK"),
        driver=Object("DefaultDriver", (1,)),
        solver=SOLVER,
        grid=grid(lengths, counts),
        bodies=[
            Body(
                "block",
                parts,
                elastic(2e5, 0.3),
                Object("CartesianSmoothBox"),
                point_file="generated_block.parts",
            )
        ],
        remark="A block with a dome falls on a smooth floor.",
    )


def ballistic(cells: int = 40, per_cell: int = 2) -> Config:
    """Shot of a disc at a standing wall, after that has settled.

    Parameters
    ----------
    cells : int
        Along each side of the box of 1 m.
    per_cell : int
        Points in a cell and direction.
    """
    h = 1.0 / cells
    wall = _points(Block((0.6, 0.0), (0.8, 0.5)), 2, h, per_cell)
    disc = _points(Circle((0.15, 0.35), 0.075), 2, h, per_cell)
    return Config(
        job=Job(dt=2e-4 * 40 / cells, sim_type=2, t=-0.2),
        serializer=frames("ballistic", 60),
        driver=Object("BallisticDriver", (0.5, 4.0, 0.5), str_properties=("projectile",)),
        solver=SOLVER,
        grid=grid((1.0, 1.0), (cells, cells)),
        bodies=[
            Body("wall", wall, elastic(5e5, 0.3), Object("CartesianBox")),
            Body("projectile", disc, elastic(5e5, 0.3), Object("CartesianBox")),
        ],
        contacts=[contact("hit", 0.4, "wall", "projectile")],
        remark="A disc is shot at a standing wall, which settles under its weight before t = 0.",
    )


#: The scenes by name.
SCENES: dict[str, Callable[..., Config]] = {
    make.__name__: make
    for make in (
        two_blocks,
        bar_1d,
        two_discs,
        two_spheres_3d,
        ball_axisymmetric,
        sheared_block_2_5d,
        generated_block,
        ballistic,
    )
}


def elastic(modulus: float, poisson: float) -> Object:
    """Make an elastic material.

    Parameters
    ----------
    modulus, poisson : float
        Young's modulus [Pa] and Poisson's ratio.
    """
    return Object("IsotropicLinearElasticity", {"E": modulus, "nu": poisson})


def frames(name: str, rate: float, class_name: str = "DefaultVTK") -> Object:
    """Make a serializer that writes into `output/NAME`.

    Parameters
    ----------
    name : str
        Of the run.
    rate : float
        Frames per second.
    class_name : str
        DefaultVTK or MinimalVTK.
    """
    folder = f"output/{name}"
    return Object(class_name, (rate,), str_properties=(folder, folder, name))


def grid(
    lengths: Sequence[float], cells: Sequence[int], class_name: str = "CartesianLinear"
) -> Object:
    """Make a grid of equal cells.

    Parameters
    ----------
    lengths, cells : Sequence
        Sides of the box [m] and numbers of cells along them.
    class_name : str
        A Cartesian grid.
    """
    return Object(class_name, tuple(lengths), tuple(cells))


def contact(name: str, friction: float, first: str, second: str) -> Object:
    """Make a contact of two bodies.

    Parameters
    ----------
    name : str
        Of the contact.
    friction : float
        Coefficient of friction.
    first, second : str
        Names of the bodies.
    """
    return Object("ContactHuang", (friction,), str_properties=(first, second), name=name)


def _points(
    shape: Shape, sim_type: int, cell: float, per_cell: int, velocity: Sequence[float] | None = None
) -> Points:
    """Fill a shape at the density of all scenes."""
    return fill(shape, sim_type, cell=cell, per_cell=per_cell, density=DENSITY, velocity=velocity)
