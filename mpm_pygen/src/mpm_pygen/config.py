"""Configs of mpm3d, built from Python: the sections as dataclasses, their text, their check."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from mpm_pygen.errors import PygenError
from mpm_pygen.points import Points, write_points

Value = float | int | str
#: Entries in their order, or by name, or a sequence whose last entry is a mapping of named ones.
Values = Sequence[Value | Mapping[str, Value]] | Mapping[str, Value]


@dataclass
class Object:
    """What a config makes of a class: serializer, driver, solver, grid, contact, part of a body.

    Parameters
    ----------
    class_name : str
        As `mpm3d --list` has it.
    properties, int_properties, str_properties : Values
        Reals, integers, strings, as `mpm3d --describe` has them.
    name : str
        Of contacts and others that `--set` speaks of; left out when empty.
    """

    class_name: str
    properties: Values = ()
    int_properties: Values = ()
    str_properties: Values = ()
    name: str = ""

    def __post_init__(self) -> None:
        """Let lists and tuples be equal."""
        self.properties = _frozen(self.properties)
        self.int_properties = _frozen(self.int_properties)
        self.str_properties = _frozen(self.str_properties)

    def entries(self, prefix: str = "", ending: str = "properties") -> Iterator[str]:
        """Give the lines of a section or part.

        Parameters
        ----------
        prefix : str
            "point-" and the like for the parts of a body.
        ending : str
            "props" for those.
        """
        yield f"{prefix}class = {_text(self.class_name)}"
        if self.name:
            yield f"name = {_text(self.name)}"
        for kind, values in (
            ("", self.properties),
            ("int-", self.int_properties),
            ("str-", self.str_properties),
        ):
            if values:
                yield f"{prefix}{kind}{ending} = {_list(values)}"


@dataclass
class Job:
    """The section `job`.

    Parameters
    ----------
    dt : float
        Time step. [s]
    sim_type : int
        TYPE, 1 to 5.
    t : float
        Start time. [s]
    threads : int
        Number of threads, 0 for all.
    """

    dt: float
    sim_type: int
    t: float = 0.0
    threads: int = 0


@dataclass
class Parts:
    """The generator text of `CartesianPoints`, which the program fills with points itself.

    Parameters
    ----------
    lengths, cells : Sequence
        Of the lattice, one number for each direction.
    per_cell : int
        Points for each cell and direction.
    density : float
        Of all points.
    parts : Sequence[Object]
        Box, Ball, ...; a point is kept if it lies in any.
    """

    lengths: Sequence[float]
    cells: Sequence[int]
    per_cell: int
    density: float
    parts: Sequence[Object]

    def __post_init__(self) -> None:
        """Let lists and tuples be equal."""
        self.lengths, self.cells = tuple(self.lengths), tuple(self.cells)
        self.parts = tuple(self.parts)

    def text(self) -> str:
        """Write the file."""
        lines = [
            f"Lx = {_list(self.lengths)}",
            f"Nx = {_list(self.cells)}",
            f"lmpp = {self.per_cell}",
            f"rho = {_value(self.density)}",
        ]
        return "\n".join(lines) + "\n" + "".join(_section("part", p.entries()) for p in self.parts)


@dataclass
class Body:
    """A section `body`.

    Parameters
    ----------
    name : str
        Unique.
    points : Points or Parts, optional
        What `Config.write` writes into the points file; that of `point_file` is there already
        when left out.
    material, boundary : Object, optional
        Left out of the section when None.
    point_file : str
        Name of the file; from the name of the body when empty.
    body, point, node : Object, optional
        Classes of the body itself, its points (DefaultPoints, or CartesianPoints for `Parts`) and
        nodes.
    """

    name: str
    points: Points | Parts | None = field(default=None, compare=False)
    material: Object | None = None
    boundary: Object | None = None
    point_file: str = ""
    body: Object = field(default_factory=lambda: Object("DefaultBody"))
    point: Object | None = None
    node: Object = field(default_factory=lambda: Object("DefaultNodes"))

    def __post_init__(self) -> None:
        """Fill in what follows from the points."""
        generated = isinstance(self.points, Parts)
        if not self.point_file:
            self.point_file = f"{self.name}.{'parts' if generated else 'points'}"
        if self.point is None:
            self.point = Object("CartesianPoints" if generated else "DefaultPoints")

    def entries(self) -> Iterator[str]:
        """Give the lines of the section."""
        yield from self.body.entries()
        yield f"name = {_text(self.name)}"
        yield f"point-file = {_text(self.point_file)}"
        for prefix in ("point", "node", "material", "boundary"):
            part: Object | None = getattr(self, prefix)
            if part is not None:
                yield from part.entries(f"{prefix}-", "props")

    def write_points(self, folder: Path) -> None:
        """Write the points file, if the body has points."""
        path = folder / self.point_file
        if isinstance(self.points, Parts):
            path.write_text(self.points.text(), "utf-8")
        elif self.points is not None:
            write_points(path, self.points)


@dataclass
class Config:
    """A whole config, with the points of its bodies.

    Parameters
    ----------
    job : Job
        Start, step, TYPE.
    serializer, driver, solver, grid : Object
        One each.
    bodies : Sequence[Body]
        At least one.
    contacts : Sequence[Object]
        In the order in which they act.
    probes : Sequence[Object]
        What the history tells besides the sums over bodies; each needs a name.
    remark : str
        Comment above the first section.
    """

    job: Job
    serializer: Object
    driver: Object
    solver: Object
    grid: Object
    bodies: Sequence[Body]
    contacts: Sequence[Object] = ()
    probes: Sequence[Object] = ()
    remark: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        """Let lists and tuples be equal."""
        self.bodies, self.contacts = tuple(self.bodies), tuple(self.contacts)
        self.probes = tuple(self.probes)

    def text(self) -> str:
        """Write the config."""
        job = [f"t = {_value(self.job.t)}", f"dt = {_value(self.job.dt)}"]
        job.append(f"TYPE = {int(self.job.sim_type)}")
        if self.job.threads:
            job.append(f"threads = {self.job.threads}")
        sections = [_section("job", iter(job))]
        for role in ("serializer", "driver", "solver", "grid"):
            sections.append(_section(role, getattr(self, role).entries()))
        sections += [_section("body", body.entries()) for body in self.bodies]
        sections += [_section("contact", contact.entries()) for contact in self.contacts]
        sections += [_section("probe", probe.entries()) for probe in self.probes]
        remark = "".join(f"# {line}".rstrip() + "\n" for line in self.remark.splitlines())
        return remark + "".join(sections)[0 if remark else 1 :]

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the config, and the points of its bodies into the same folder.

        Parameters
        ----------
        path : str or PathLike
            The config. Its folder is made when missing.
        """
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        for body in self.bodies:
            body.write_points(path.parent)
        path.write_text(self.text(), "utf-8")

    def check(self, program: str | os.PathLike[str] | None = None) -> str:
        """Let the program check the config and its points, without running it.

        Parameters
        ----------
        program : str or PathLike, optional
            mpm3d; looked for by `find_program` when left out.

        Returns
        -------
        str
            The report of `mpm3d --check`.

        Raises
        ------
        PygenError
            With the message of the program when it refuses the config, or when there is no program.
        """
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "scene.cfg"
            self.write(path)
            for body in self.bodies:
                if body.points is None and Path(body.point_file).is_file():
                    shutil.copy(body.point_file, Path(folder) / body.point_file)
            return check_config(path, program)


def check_config(
    path: str | os.PathLike[str], program: str | os.PathLike[str] | None = None
) -> str:
    """Let the program check a config.

    Parameters
    ----------
    path : str or PathLike
        The config.
    program : str or PathLike, optional
        mpm3d; looked for by `find_program` when left out.
    """
    path = Path(path).resolve()
    found = Path(program).resolve() if program else find_program()
    if found is None:
        raise PygenError(
            "mpm3d was not found: put it on the PATH, or its path into the variable MPM3D"
        )
    result = subprocess.run(
        [found, "-c", path.name, "--check"],
        cwd=path.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode != 0:
        raise PygenError(result.stderr.strip() or f"mpm3d ended with status {result.returncode}")
    return result.stdout


def find_program() -> Path | None:
    """Look for mpm3d: the variable MPM3D, the PATH, a build beside this package."""
    named = os.environ.get("MPM3D")
    if named:
        return Path(named).resolve()
    on_path = shutil.which("mpm3d")
    if on_path:
        return Path(on_path).resolve()
    built = Path(__file__).resolve().parents[3] / "build" / "release" / "bin" / "mpm3d"
    return built if built.is_file() else None


def _section(name: str, entries: Iterator[str]) -> str:
    """Write a section, with an empty line before it."""
    return f"\n{name}\n{{\n" + "".join(f"    {entry}\n" for entry in entries) + "}\n"


def _frozen(values: Values) -> Values:
    """Make a tuple of a list."""
    return values if isinstance(values, Mapping) else tuple(values)


def _list(values: Values) -> str:
    """Write a list in braces."""
    if isinstance(values, Mapping):
        values = [values]
    items: list[str] = []
    for k, value in enumerate(values):
        if isinstance(value, Mapping):
            if k != len(values) - 1:
                raise PygenError("entries by name come last in a list")
            items += [f"{name} = {_value(entry)}" for name, entry in value.items()]
        else:
            items.append(_value(value))
    return "{" + ", ".join(items) + "}"


def _value(value: Value) -> str:
    """Write a value."""
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        raise PygenError("a config has 0 and 1 in place of False and True")
    if isinstance(value, int):
        return str(int(value))
    return repr(float(value)).removesuffix(".0")


def _text(word: str) -> str:
    """Put quotes around text."""
    if not word.isprintable() or ('"' in word and "'" in word):
        raise PygenError(f"text in a config is one line with quotes of one kind, not {word!r}")
    return f"'{word}'" if '"' in word else f'"{word}"'
