"""The command `mpm-pygen`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import NoReturn

from mpm_pygen.errors import PygenError
from mpm_pygen.lattice import fill
from mpm_pygen.points import write_points
from mpm_pygen.shapes import Block, Circle, Cylinder, HalfCircle, Shape, Sphere
from mpm_pygen.simulation_type import SimulationType

#: Exit statuses, those of mpm3d.
BAD_INPUT, BAD_OUTPUT = 2, 4


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        """Print the error and leave."""
        self.exit(BAD_INPUT, f"{self.prog}: error: {message} ({self.prog} --help)\n")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : Sequence[str], optional
        Arguments; those of the process when left out.

    Returns
    -------
    int
        0, or 2 for bad input and 4 for a file that cannot be written.
    """
    arguments = _parser().parse_args(_shielded(sys.argv[1:] if argv is None else argv))
    try:
        sim_type = SimulationType(arguments.type)
        shape = _SHAPES[arguments.shape](arguments, sim_type)
        points = fill(
            shape,
            sim_type,
            spacing=arguments.spacing,
            density=arguments.density,
            velocity=arguments.velocity,
        )
    except PygenError as error:
        print(f"mpm-pygen {arguments.shape}: error: {error}", file=sys.stderr)
        return BAD_INPUT
    try:
        write_points(arguments.output, points)
    except OSError as error:
        reason = error.strerror or error
        print(
            f"mpm-pygen {arguments.shape}: error: cannot write {arguments.output}: {reason}",
            file=sys.stderr,
        )
        return BAD_OUTPUT
    print(
        f"{arguments.output}: {len(points)} points, mass {points.total_mass:.6g} {_unit(sim_type)}"
    )
    return 0


def _parser() -> argparse.ArgumentParser:
    """Describe the command line."""
    common = _Parser(add_help=False)
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
        required=True,
        metavar="H",
        help="distance of the points: one number, or one for each direction",
    )
    common.add_argument("--density", type=float, required=True, metavar="RHO")
    common.add_argument(
        "--velocity",
        type=float,
        nargs="+",
        metavar="V",
        help="components: x; x y; x y z; r z theta; x y z for TYPE 1 to 5 (default: at rest)",
    )
    common.add_argument(
        "-o", "--output", required=True, metavar="FILE", help="points file to write"
    )

    parser = _Parser(
        prog="mpm-pygen", description="Make a points file for mpm3d from a simple shape."
    )
    shapes = parser.add_subparsers(dest="shape", required=True, metavar="SHAPE")

    block = shapes.add_parser(
        "block", parents=[common], help="interval, rectangle or box along the axes"
    )
    for option, end in (("--min", "lower"), ("--max", "upper")):
        block.add_argument(
            option, type=float, nargs="+", required=True, metavar="X", help=f"{end} corner"
        )

    circle = shapes.add_parser("circle", parents=[common], help="disc (TYPE 2, 4, 5)")
    cylinder = shapes.add_parser("cylinder", parents=[common], help="cylinder (TYPE 3)")
    sphere = shapes.add_parser(
        "sphere", parents=[common], help="sphere (TYPE 3; TYPE 4 with its centre on the axis)"
    )
    for round_shape in (circle, cylinder, sphere):
        round_shape.add_argument("--centre", type=float, nargs="+", required=True, metavar="X")
        round_shape.add_argument("--radius", type=float, required=True, metavar="R")
    cylinder.add_argument("--length", type=float, required=True, metavar="L")
    cylinder.add_argument("--axis", choices=["x", "y", "z"], default="z")
    return parser


def _shielded(argv: Sequence[str]) -> list[str]:
    """Put a blank before negative numbers, which argparse would take for options in -1e-3."""
    shielded = []
    for word in argv:
        try:
            float(word)
        except ValueError:
            shielded.append(word)
        else:
            shielded.append(f" {word}" if word.startswith("-") else word)
    return shielded


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


_SHAPES = {"block": _block, "circle": _circle, "cylinder": _cylinder, "sphere": _sphere}


def _check_length(option: str, values: Sequence[float], sim_type: SimulationType) -> None:
    """Check that a position has the coordinates of the grid."""
    if len(values) != sim_type.dimension:
        names = ", ".join(sim_type.coordinates[: sim_type.dimension])
        raise PygenError(
            f"{option} takes {sim_type.dimension} numbers ({names}) in TYPE {int(sim_type)}, "
            f"not {len(values)}"
        )


def _unit(sim_type: SimulationType) -> str:
    """Name the unit of a total mass."""
    return ("kg/m^2", "kg/m", "kg", "kg/rad", "kg/m")[sim_type - 1]
