"""A good scene to spoil, and what all failures of the program have in common."""

from __future__ import annotations

import re
from pathlib import Path

from scene import Result, block, write_points

USAGE, BAD_INPUT, BAD_OUTPUT = 1, 2, 4

#: A good config; each case below changes one thing in it.
CONFIG = """\
job
{
    dt = 1e-3
    TYPE = 2
}
serializer
{
    class = "DefaultVTK"
    properties = {100}
    str-properties = {"frames", "save", "test"}
}
driver
{
    class = "DefaultDriver"
    properties = {0.01}
}
solver
{
    class = "ExplicitUSL"
    int-properties = {1, 1}
}
grid
{
    class = "CartesianLinear"
    properties = {1.0, 1.0}
    int-properties = {10, 10}
}
body
{
    class = "DefaultBody"
    name = "first"
    point-file = "first.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
    material-class = "IsotropicLinearElasticity"
    material-props = {1e5, 0.3}
    boundary-class = "CartesianBox"
}
body
{
    class = "DefaultBody"
    name = "second"
    point-file = "second.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
}
contact
{
    class = "ContactHuang"
    name = "touch"
    properties = {0.4}
    str-properties = {"first", "second"}
}
"""


def line_number(text: str, start: str) -> int:
    """Return the line that starts with a text; `text#2` is the second one."""
    start, _, which = start.partition("#")
    found = [i for i, line in enumerate(text.split("\n"), 1) if line.startswith(start)]
    return found[int(which or 1) - 1]


def write_scene(folder: Path, config: str = CONFIG) -> None:
    """Write a config and the two points files of the good one."""
    write_points(folder / "first.points", block(2, [0.2, 0.2], [0.4, 0.4], [4, 4]))
    write_points(folder / "second.points", block(2, [0.5, 0.2], [0.7, 0.4], [4, 4]))
    (folder / "scene.cfg").write_bytes(config.encode())


def expect_failure(result: Result, folder: Path, code: int, place: str, message: str) -> None:
    """Check exit code, place and message, and that there is neither a trace nor a frame."""
    errors = result.stderr
    assert result.returncode == code, (result.returncode, errors[:1000])
    assert re.match(rf"{re.escape(place)}(\d+: )?error: ", errors), errors[:1000]
    assert message in errors
    for trace in ("Fortran runtime error", "Backtrace", "At line", "Program received", "SIG"):
        assert trace not in errors
    # A message, a hint, and no more than what a terminal shows at one glance.
    assert len(errors.splitlines()) <= 2
    assert len(errors) < 1000
    assert not list(folder.rglob("*.vtk*"))
