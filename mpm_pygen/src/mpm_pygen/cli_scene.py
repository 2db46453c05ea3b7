"""The commands `mpm-pygen scene`, `mpm-pygen check` and `mpm-pygen box-mesh`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mpm_pygen.box_mesh import write_box_mesh
from mpm_pygen.config import check_config, find_program
from mpm_pygen.errors import PygenError
from mpm_pygen.scenes import SCENES


def add_commands(commands: Any) -> None:
    """Add the commands to the parser.

    Parameters
    ----------
    commands : Any
        What `add_subparsers` of argparse made.
    """
    scene = commands.add_parser(
        "scene",
        help="config and points of a scene, at any number of cells",
        description="Scenes: "
        + "; ".join(
            f"{name}: {(make.__doc__ or '').split('.')[0]}" for name, make in SCENES.items()
        ),
    )
    scene.add_argument("scene", choices=list(SCENES), metavar="SCENE", help="name of the scene")
    scene.add_argument("--cells", type=int, metavar="N", help="along the first side of the grid")
    scene.add_argument(
        "--per-cell", type=int, metavar="N", help="points in a cell and direction (default: 2)"
    )
    scene.add_argument(
        "-o", "--output", metavar="FOLDER", help="where to write (default: the name of the scene)"
    )
    scene.set_defaults(run=make_scene)
    mesh = commands.add_parser(
        "box-mesh", help="Gmsh file of a box cut into triangles or tetrahedra"
    )
    mesh.add_argument(
        "--min", nargs="+", type=float, required=True, metavar="X", help="lower corner"
    )
    mesh.add_argument(
        "--max", nargs="+", type=float, required=True, metavar="X", help="upper corner"
    )
    mesh.add_argument(
        "--cells", nargs="+", type=int, required=True, metavar="N", help="along each side"
    )
    mesh.add_argument(
        "--map", nargs="+", default=[], metavar="F", help="positions as expressions of x y z"
    )
    mesh.add_argument("-o", "--output", required=True, metavar="FILE")
    mesh.set_defaults(run=make_mesh)
    check = commands.add_parser("check", help="let mpm3d check a config without running it")
    check.add_argument("config", metavar="CONFIG")
    check.add_argument("--program", metavar="FILE", help="mpm3d, when it is not on the PATH")
    check.set_defaults(run=check_scene)


def make_scene(arguments: argparse.Namespace) -> int:
    """Write a scene, and check it when the program is there.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the command line.
    """
    values = {"cells": arguments.cells, "per_cell": arguments.per_cell}
    given = {name: value for name, value in values.items() if value is not None}
    if any(value < 1 for value in given.values()):
        raise PygenError("cells and points per cell are 1 or more")
    config = SCENES[arguments.scene](**given)
    path = Path(arguments.output or arguments.scene) / f"{arguments.scene}.cfg"
    config.write(path)
    if find_program() is not None:
        check_config(path)
        print(f"{path}: written, and accepted by mpm3d --check")
    else:
        print(f"{path}: written")
    return 0


def make_mesh(arguments: argparse.Namespace) -> int:
    """Write a mesh.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the command line.
    """
    image = [text.strip() for text in arguments.map]
    n = write_box_mesh(arguments.output, arguments.min, arguments.max, arguments.cells, image)
    kind = "triangles" if len(arguments.cells) == 2 else "tetrahedra"
    print(f"{arguments.output}: {n} {kind}")
    return 0


def check_scene(arguments: argparse.Namespace) -> int:
    """Print the report of the program.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the command line.
    """
    if not Path(arguments.config).is_file():
        raise PygenError(f"there is no file {arguments.config}")
    print(check_config(arguments.config, arguments.program), end="")
    return 0
