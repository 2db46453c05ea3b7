"""The commands that make points files: `mpm-pygen block`, ..., `fill` and `image`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from mpm_pygen.errors import PygenError
from mpm_pygen.filling import fill, mixture
from mpm_pygen.points import Points, write_points
from mpm_pygen.raster import read_image
from mpm_pygen.shape import Shape
from mpm_pygen.shape_text import MAKERS, read_shape
from mpm_pygen.shapes import Block, Circle, Cylinder, HalfCircle, Sphere
from mpm_pygen.simulation_type import SimulationType

FILL_HELP = f"""\
shapes:     {", ".join(list(MAKERS)[:8])},
            {", ".join(list(MAKERS)[8:])}
            with the arguments of Python's classes and functions of the same names
operators:  a | b union, a - b difference, a & b intersection
methods:    .translated(dx, dy), .rotated(degrees, centre=(x, y)), .scaled(factor),
            .mirrored(direction, at=0)

mpm-pygen fill "block((0, 0), (1, 0.5)) - circle((0.5, 0.25), 0.1)" --type 2 --spacing 0.025 \\
  --density "1000 + 50*y" --velocity 0.1*y 0 -o plate.points
"""


def add_commands(commands: Any) -> None:
    """Add the commands to the parser.

    Parameters
    ----------
    commands : Any
        What `add_subparsers` of argparse made.
    """
    parents = [_common_options()]
    block = commands.add_parser(
        "block", parents=parents, help="points of an interval, rectangle or box along the axes"
    )
    for option, end in (("--min", "lower"), ("--max", "upper")):
        block.add_argument(
            option, type=float, nargs="+", required=True, metavar="X", help=f"{end} corner"
        )
    circle = commands.add_parser("circle", parents=parents, help="points of a disc (TYPE 2, 4, 5)")
    cylinder = commands.add_parser(
        "cylinder", parents=parents, help="points of a cylinder (TYPE 3)"
    )
    sphere = commands.add_parser(
        "sphere",
        parents=parents,
        help="points of a sphere (TYPE 3; TYPE 4 with its centre on the axis)",
    )
    for round_shape in (circle, cylinder, sphere):
        round_shape.add_argument("--centre", type=float, nargs="+", required=True, metavar="X")
        round_shape.add_argument("--radius", type=float, required=True, metavar="R")
    cylinder.add_argument("--length", type=float, required=True, metavar="L")
    cylinder.add_argument("--axis", choices=["x", "y", "z"], default="z")

    any_shape = commands.add_parser(
        "fill",
        parents=parents,
        help="points of any shape, or combination of shapes, written as an expression",
        epilog=FILL_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    any_shape.add_argument("expression", metavar="SHAPE", help="see below")

    image = commands.add_parser(
        "image", parents=parents, help="points of the pixels of one colour of a picture"
    )
    image.add_argument("picture", metavar="PICTURE", help="PNG file; white is nothing")
    image.add_argument("--pixel", type=float, required=True, metavar="H", help="side of a pixel")
    image.add_argument(
        "--min", type=float, nargs=2, default=[0.0, 0.0], metavar="X", help="its lower left corner"
    )
    image.add_argument("--colour", required=True, metavar="#RRGGBB", help="colour of the body")
    image.add_argument(
        "--tolerance", type=int, default=0, metavar="N", help="how far off a colour may be, 0-255"
    )
    for name in _SHAPES:
        commands.choices[name].set_defaults(run=make_points)


def make_points(arguments: argparse.Namespace) -> int:
    """Make the points file, or the two of a mixture.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the command line.
    """
    sim_type = SimulationType(arguments.type)
    try:
        shape = _SHAPES[arguments.command](arguments, sim_type)
    except OSError as error:
        raise PygenError(f"cannot read {error.filename}: {error.strerror or error}") from None
    points = fill(
        shape,
        sim_type,
        spacing=arguments.spacing,
        cell=arguments.cell,
        per_cell=arguments.per_cell,
        density=_number_or_text(arguments.density),
        velocity=arguments.velocity and [_number_or_text(v) for v in arguments.velocity],
        fitted=arguments.fitted,
        jitter=arguments.jitter,
        seed=arguments.seed,
        origin=arguments.origin,
        exact=arguments.exact,
    )
    if arguments.porosity is None:
        _write(arguments.output, points)
        return 0
    if arguments.fluid_density is None or arguments.fluid_output is None:
        raise PygenError("--porosity needs --fluid-density and --fluid-output")
    grains, fluid = mixture(
        points,
        porosity=_number_or_text(arguments.porosity),
        grain_density=_number_or_text(arguments.density),
        fluid_density=_number_or_text(arguments.fluid_density),
    )
    _write(arguments.output, grains)
    _write(arguments.fluid_output, fluid)
    return 0


def _common_options() -> argparse.ArgumentParser:
    """Describe the options of all shapes."""
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument(
        "--type",
        type=int,
        required=True,
        choices=[int(t) for t in SimulationType],
        help="TYPE of the job: 1 uniaxial strain, 2 plane strain, 3 3D, 4 axisymmetric, "
        "5 2D with out-of-plane motion",
    )
    common.add_argument(
        "--spacing",
        type=float,
        nargs="+",
        metavar="H",
        help="distance of the points: one number, or one for each direction",
    )
    common.add_argument(
        "--cell",
        type=float,
        nargs="+",
        metavar="H",
        help="in place of --spacing: sides of a cell of the grid",
    )
    common.add_argument(
        "--per-cell",
        type=int,
        nargs="+",
        default=[2],
        metavar="N",
        help="with --cell: points for each cell and direction (default: 2)",
    )
    common.add_argument(
        "--density",
        required=True,
        metavar="RHO",
        help="a number, or an expression of the coordinates x y z or r z",
    )
    common.add_argument(
        "--velocity",
        nargs="+",
        metavar="V",
        help="components: x; x y; x y z; r z theta; x y z for TYPE 1 to 5; numbers or "
        "expressions (default: at rest)",
    )
    common.add_argument(
        "--fitted", action="store_true", help="cells that follow the surface, no lattice"
    )
    common.add_argument(
        "--jitter",
        type=float,
        default=0.0,
        metavar="J",
        help="move points at random by up to J half spacings, 0 to 1",
    )
    common.add_argument("--seed", type=int, default=0, help="of the jitter (default: 0)")
    common.add_argument(
        "--origin",
        type=float,
        nargs="+",
        metavar="X",
        help="where cells of the lattice meet, for example a node of the grid",
    )
    common.add_argument(
        "--exact", action="store_true", help="scale sizes so that they sum to that of the shape"
    )
    common.add_argument(
        "--porosity", metavar="N", help="make grains and pore fluid; --density is that of grains"
    )
    common.add_argument("--fluid-density", metavar="RHO", help="with --porosity")
    common.add_argument("--fluid-output", metavar="FILE", help="with --porosity: second file")
    common.add_argument(
        "-o", "--output", required=True, metavar="FILE", help="points file to write"
    )
    return common


def _number_or_text(word: str) -> float | str:
    """Take what is a number for one, and all else for an expression."""
    try:
        return float(word)
    except ValueError:
        return word


def _write(path: str, points: Points) -> None:
    """Write a file and say so."""
    write_points(path, points)
    unit = ("kg/m^2", "kg/m", "kg", "kg/rad", "kg/m")[points.sim_type - 1]
    print(f"{path}: {len(points)} points, mass {points.total_mass:.6g} {unit}")


def _block(arguments: argparse.Namespace, sim_type: SimulationType) -> Shape:
    """Make the block of the command line."""
    for option, corner in (("--min", arguments.min), ("--max", arguments.max)):
        _check_length(option, corner, sim_type)
    return Block(arguments.min, arguments.max)


def _circle(arguments: argparse.Namespace, sim_type: SimulationType) -> Shape:
    """Make the circle of the command line."""
    if sim_type.dimension != 2:
        raise PygenError(
            f"a circle has no place in TYPE {int(sim_type)}; "
            + ("use block" if sim_type.dimension == 1 else "use cylinder or sphere")
        )
    _check_length("--centre", arguments.centre, sim_type)
    return Circle(arguments.centre, arguments.radius)


def _cylinder(arguments: argparse.Namespace, sim_type: SimulationType) -> Shape:
    """Make the cylinder of the command line."""
    if sim_type is not SimulationType.THREE_D:
        way_out = {
            SimulationType.UNIAXIAL_STRAIN: "block",
            SimulationType.AXISYMMETRIC: "block with r from 0 to its radius",
        }.get(sim_type, "circle")
        raise PygenError(f"cylinder is for TYPE 3; in TYPE {int(sim_type)} use {way_out}")
    _check_length("--centre", arguments.centre, sim_type)
    axis = "xyz".index(arguments.axis)
    return Cylinder(arguments.centre, arguments.radius, arguments.length, axis)


def _sphere(arguments: argparse.Namespace, sim_type: SimulationType) -> Shape:
    """Make the sphere of the command line."""
    if sim_type not in (SimulationType.THREE_D, SimulationType.AXISYMMETRIC):
        way_out = "block" if sim_type.dimension == 1 else "circle"
        raise PygenError(f"sphere is for TYPE 3 and 4; in TYPE {int(sim_type)} use {way_out}")
    _check_length("--centre", arguments.centre, sim_type)
    if sim_type is SimulationType.THREE_D:
        return Sphere(arguments.centre, arguments.radius)
    if arguments.centre[0] != 0.0:
        raise PygenError(
            f"the centre of a sphere has r = 0 in TYPE 4, not {arguments.centre[0]!r}; "
            "for a ring use circle"
        )
    return HalfCircle(arguments.centre, arguments.radius)


def _expression(arguments: argparse.Namespace, sim_type: SimulationType) -> Shape:
    """Make the shape of an expression."""
    return read_shape(arguments.expression)


def _image(arguments: argparse.Namespace, sim_type: SimulationType) -> Shape:
    """Make the shape of a colour."""
    found = read_image(
        arguments.picture,
        pixel=arguments.pixel,
        lower=arguments.min,
        colours=[arguments.colour],
        tolerance=arguments.tolerance,
    )
    return found[arguments.colour.lower()]


_SHAPES = {
    "block": _block,
    "circle": _circle,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "fill": _expression,
    "image": _image,
}


def _check_length(option: str, values: Sequence[float], sim_type: SimulationType) -> None:
    """Check that a position has the coordinates of the grid."""
    if len(values) != sim_type.dimension:
        names = ", ".join(sim_type.coordinates[: sim_type.dimension])
        raise PygenError(
            f"{option} takes {sim_type.dimension} numbers ({names}) in TYPE {int(sim_type)}, "
            f"not {len(values)}"
        )
