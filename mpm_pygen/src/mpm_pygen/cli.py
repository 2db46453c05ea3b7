"""The command `mpm-pygen`."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

from mpm_pygen import cli_points, cli_results, cli_scene
from mpm_pygen.errors import PygenError

#: Exit statuses, those of mpm3d.
BAD_INPUT, BAD_OUTPUT = 2, 4

_NEGATIVE = re.compile(r"-([\d.(]|inf|nan|\w+[-+*/(])")


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
        status: int = arguments.run(arguments)
    except PygenError as error:
        print(f"mpm-pygen {arguments.command}: error: {error}", file=sys.stderr)
        return BAD_INPUT
    except OSError as error:
        reason = error.strerror or error
        # Files are written under another name first, which nobody asked for.
        name = getattr(arguments, "output", None) or error.filename
        print(
            f"mpm-pygen {arguments.command}: error: cannot write {name}: {reason}",
            file=sys.stderr,
        )
        return BAD_OUTPUT
    return status


def _parser() -> argparse.ArgumentParser:
    """Describe the command line."""
    parser = _Parser(
        prog="mpm-pygen", description="Make points files for mpm3d, and look at its results."
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    cli_points.add_commands(commands)
    cli_scene.add_commands(commands)
    cli_results.add_commands(commands)
    return parser


def _shielded(argv: Sequence[str]) -> list[str]:
    """Put a blank before negative numbers and expressions, which argparse takes for options."""
    return [f" {word}" if _NEGATIVE.match(word) else word for word in argv]
