"""The commands `mpm-pygen view` and `mpm-pygen history`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mpm_pygen.camera import Camera
from mpm_pygen.charts import save_chart
from mpm_pygen.drawing import Style
from mpm_pygen.errors import PygenError
from mpm_pygen.frames import Frames
from mpm_pygen.history import History, read_history
from mpm_pygen.movies import movie, picture

VIEW_HELP = """\
fields:  those of the frames, components like velocity.x or cauchy_stress.xy, and speed, pressure,
         mises, tau_bar, max_stress, min_stress, gamma_dot, divergence, vorticity where velocities,
         stresses or velocity gradients are there; vectors and tensors by their magnitude

mpm-pygen view output/two_blocks                           the last frame, coloured by speed
mpm-pygen view output/two_blocks --time 0 0.2 0.9 --field pressure -o three.png
mpm-pygen view output/two_blocks -o run.gif --fps 20
mpm-pygen view output/ball -c ball.cfg --revolve -o ball.png
"""


def add_commands(commands: Any) -> None:
    """Add the commands to the parser.

    Parameters
    ----------
    commands : Any
        What `add_subparsers` of argparse made.
    """
    view = commands.add_parser(
        "view",
        help="picture or movie of frames",
        epilog=VIEW_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    _add_run(view)
    view.add_argument("--field", default="speed", metavar="NAME", help="see below (default: speed)")
    view.add_argument("--list", action="store_true", help="list bodies, frames and fields")
    view.add_argument(
        "--frame", type=int, nargs="+", metavar="K", help="frames, from 0, or from the end: -1, -2"
    )
    view.add_argument("--time", type=float, nargs="+", metavar="T", help="frames next to times")
    view.add_argument(
        "--every", type=int, default=1, metavar="N", help="of a movie: each Nth frame"
    )
    view.add_argument(
        "--fps", type=float, default=15.0, metavar="F", help="of a movie (default 15)"
    )
    view.add_argument("--bodies", nargs="+", metavar="NAME", help="bodies to draw (default: all)")
    view.add_argument(
        "--limits", type=float, nargs=2, metavar=("LOW", "HIGH"), help="ends of the colours"
    )
    view.add_argument(
        "--colours", default="viridis", metavar="MAP", help="colour map of Matplotlib"
    )
    view.add_argument("--no-grid", action="store_true", help="leave the grid out")
    view.add_argument("--mirror", action="store_true", help="TYPE 4: both halves of the section")
    view.add_argument("--revolve", action="store_true", help="TYPE 4: in 3D, a quarter cut out")
    view.add_argument(
        "--camera",
        type=float,
        nargs=2,
        default=[-60.0, 20.0],
        metavar=("AZIMUTH", "ELEVATION"),
        help="of 3D views, in degrees (default: -60 20)",
    )
    view.add_argument(
        "--zoom", type=float, nargs="+", metavar="X", help="ends of the picture: x x y y"
    )
    view.add_argument("--width", type=int, default=480, metavar="N", help="of a frame, in pixels")
    view.add_argument(
        "--few-colours", type=int, default=0, metavar="N", help="of a PNG, to make it smaller"
    )
    view.add_argument(
        "-o", "--output", metavar="FILE", help=".png, .gif or .mp4 (default: <folder>.png)"
    )
    view.set_defaults(run=view_results)

    history = commands.add_parser(
        "history", help="table and chart of energies, momenta and centres of mass over time"
    )
    _add_run(history)
    history.add_argument("-o", "--output", metavar="FILE", help="CSV file to write")
    history.add_argument("--plot", metavar="FILE", help="PNG file to draw")
    history.add_argument("--no-contacts", action="store_true", help="do not read node files")
    history.add_argument("--few-colours", type=int, default=0, metavar="N", help="of the PNG")
    history.set_defaults(run=history_of_results)


def view_results(arguments: argparse.Namespace) -> int:
    """Draw the picture or movie.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the command line.
    """
    frames = _frames(arguments)
    if arguments.list:
        _list(frames)
        return 0
    output = Path(arguments.output or f"{frames.folder.resolve().name}.png")
    arguments.output = str(output)
    style = Style(
        shown=arguments.field,
        bodies=arguments.bodies,
        limits=tuple(arguments.limits) if arguments.limits else None,
        colours=arguments.colours,
        grid=not arguments.no_grid,
        mirror=arguments.mirror,
        revolve=arguments.revolve,
        camera=Camera(*arguments.camera),
        width=arguments.width,
        zoom=arguments.zoom,
    )
    if arguments.frame and arguments.time:
        raise PygenError("give either frames or times")
    numbers = arguments.frame
    if arguments.time:
        numbers = [frames.numbers.index(frames.at(time).number) for time in arguments.time]
    suffix = output.suffix.lower()
    if suffix == ".png":
        picture(frames, output, numbers or [-1], style, few_colours=arguments.few_colours)
    elif suffix in (".gif", ".mp4"):
        if arguments.every < 1:
            raise PygenError("--every is 1 or more")
        chosen = numbers or range(0, len(frames), arguments.every)
        movie(frames, output, chosen, style, rate=arguments.fps)
    else:
        raise PygenError(f"the output is a file .png, .gif or .mp4, not {output.name}")
    print(output)
    return 0


def history_of_results(arguments: argparse.Namespace) -> int:
    """Write the table and the chart.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of the command line.
    """
    if not (arguments.output or arguments.plot):
        raise PygenError("nothing to do: name a CSV file (-o), a PNG file (--plot), or both")
    path = Path(arguments.results)
    history: History
    if path.is_file():
        history = read_history(path)
    else:
        history = _frames(arguments).history(contacts=not arguments.no_contacts)
    if arguments.output:
        history.write(arguments.output)
        print(f"{arguments.output}: {len(history.time)} times, {len(history.columns)} columns")
    if arguments.plot:
        save_chart(history, arguments.plot, arguments.few_colours)
        print(arguments.plot)
    return 0


def _add_run(command: argparse.ArgumentParser) -> None:
    """Describe what names a run."""
    command.add_argument(
        "results",
        metavar="RESULTS",
        help="folder of the frames" + ("" if "view" in command.prog else ", or a CSV file"),
    )
    command.add_argument(
        "-c", "--config", metavar="FILE", help="config of the run: TYPE, materials, masses"
    )
    command.add_argument(
        "--type", type=int, choices=range(1, 6), help="TYPE of the run, when there is no config"
    )


def _frames(arguments: argparse.Namespace) -> Frames:
    """Open the folder."""
    return Frames(arguments.results, config=arguments.config, sim_type=arguments.type)


def _list(frames: Frames) -> None:
    """Print what there is to draw."""
    print(f"{len(frames)} frames, t = {frames.times[0]:g} to {frames.times[-1]:g} s")
    for body in frames.bodies:
        cloud = frames[-1].points(body)
        print(f"{body}: {len(cloud)} points; {', '.join(cloud.names)}")
