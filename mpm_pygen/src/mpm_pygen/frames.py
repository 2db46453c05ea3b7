"""Frames of a run, read back: legacy VTK files as mpm3d writes them, and VTKHDF."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpm_pygen.clouds import Cloud
from mpm_pygen.config import Config
from mpm_pygen.config_reader import parse_config, read_config
from mpm_pygen.errors import PygenError
from mpm_pygen.shape import FloatArray
from mpm_pygen.vtk_hdf import HdfSeries
from mpm_pygen.vtk_legacy import read_legacy, read_title

if TYPE_CHECKING:
    from mpm_pygen.history import History

_NAME = re.compile(r"(fpd|fnd)\.(\d+)\.(.+)\.(\d{10})\.vtk")
_HDF_NAME = re.compile(r"(points|nodes)\.(\d+)\.(.+)\.vtkhdf")
_KINDS = {"points": "fpd", "nodes": "fnd"}


@dataclass(frozen=True)
class Frame:
    """One frame: the points and nodes of all bodies at one time.

    Parameters
    ----------
    frames : Frames
        The run.
    number : int
        Number of the frame in its files.
    time : float
        Of the state. [s]
    """

    frames: Frames
    number: int
    time: float

    def __getitem__(self, body: str) -> Cloud:
        """Give the points of a body."""
        return self.points(body)

    def points(self, body: str) -> Cloud:
        """Read the points of a body.

        Parameters
        ----------
        body : str
            Its name.
        """
        return self.frames.read("fpd", body, self.number)

    def nodes(self, body: str) -> Cloud:
        """Read the nodes of the grid with the fields of a body.

        Parameters
        ----------
        body : str
            Its name.
        """
        return self.frames.read("fnd", body, self.number)


class Frames:
    """The frames of a run.

    `len(frames)`, `frames[k]`, `frames[-1]` and loops are those of a list of `Frame`.

    Parameters
    ----------
    folder : str or PathLike
        The folder of the frames.
    config : str, PathLike or Config, optional
        Config of the run. It tells the TYPE, elastic constants, and with its points file the
        masses, where the frames do not. VTKHDF files hold it themselves.
    sim_type : int, optional
        TYPE of the run, 1 to 5, when there is no config to tell it.

    Attributes
    ----------
    bodies : list[str]
        Names, in the order of the config.
    times : FloatArray
        `(frames,)` [s]
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        *,
        config: str | os.PathLike[str] | Config | None = None,
        sim_type: int | None = None,
    ) -> None:
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise PygenError(f"there is no folder {self.folder}")
        self.config_path = None if config is None or isinstance(config, Config) else Path(config)
        self.config = config if isinstance(config, Config) else None
        if self.config_path is not None:
            if not self.config_path.is_file():
                raise PygenError(f"there is no file {self.config_path}")
            self.config = read_config(self.config_path)
        self._sim_type = sim_type
        self._hdf: dict[tuple[str, str], HdfSeries] = {}
        self._ids: dict[str, int] = {}
        numbers: set[int] = set()
        for path in self.folder.iterdir():
            if match := _NAME.fullmatch(path.name):
                self._ids[match[3]] = int(match[2])
                if match[1] == "fpd":
                    numbers.add(int(match[4]))
            elif match := _HDF_NAME.fullmatch(path.name):
                self._ids[match[3]] = int(match[2])
                series = self._hdf[_KINDS[match[1]], match[3]] = HdfSeries(path)
                if match[1] == "points":
                    numbers.update(range(len(series)))
        if not numbers:
            raise PygenError(
                f"{self.folder} has no frames (fpd.<number>.<body>.<frame>.vtk, or "
                "points.<number>.<body>.vtkhdf)"
            )
        told = next(iter(self._hdf.values()), None)
        if told is not None:
            self._sim_type = self._sim_type or told.sim_type
            if self.config is None and told.config:
                self.config = parse_config(told.config, str(told.path))
        self.bodies = sorted(self._ids, key=self._ids.__getitem__)
        self.numbers = sorted(numbers)
        self.times = np.array([self._time(number) for number in self.numbers])

    def __len__(self) -> int:
        """Count the frames."""
        return len(self.numbers)

    def __getitem__(self, index: int) -> Frame:
        """Give a frame by its place, from 0, or from the end with negative places."""
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are {len(self)} frames in {self.folder}, no number {index}")
        return Frame(self, self.numbers[index], float(self.times[index]))

    def __iter__(self) -> Iterator[Frame]:
        """Go through the frames."""
        return (self[k] for k in range(len(self)))

    def at(self, time: float) -> Frame:
        """Give the frame whose time is nearest.

        Parameters
        ----------
        time : float
            In seconds.
        """
        return self[int(np.argmin(np.abs(self.times - time)))]

    def series(self, body: str, field: str) -> FloatArray:
        """Read a field of the points in all frames, `(frames, points)` and more for components.

        Parameters
        ----------
        body : str
            Its name.
        field : str
            As in the brackets of `Cloud`, or "position".
        """
        clouds = (frame.points(body) for frame in self)
        return np.stack([c.position if field == "position" else c[field] for c in clouds])

    def history(self, *, contacts: bool = True) -> History:
        """Make histories of masses, momenta, energies and centres of mass: `make_history`.

        Parameters
        ----------
        contacts : bool
            Sum the contact forces of the node files as well.
        """
        from mpm_pygen.history import make_history

        return make_history(self, contacts=contacts)

    @property
    def sim_type(self) -> int:
        """TYPE of the run: as told, of the config, or else 1, 2 or 3 from the cells of the grid.

        Types 4 and 5 look like 2 in the frames.
        """
        if self._sim_type is not None:
            return self._sim_type
        if self.config is not None:
            return self.config.job.sim_type
        sizes = {1: 0, 2: 1, 3: 2, 4: 2, 8: 3}
        for body in self.bodies:
            try:
                nodes = self[0].nodes(body)
            except PygenError:
                continue
            dimension = sizes.get(nodes.cell_size, 0)
            # Tetrahedra have as many corners as pixels.
            if dimension == 2 and np.ptp(nodes.position[:, 2]) > 0.0:
                dimension = 3
            if dimension:
                return dimension
        spread = np.ptp(self[0].points(self.bodies[0]).position, axis=0)
        return max(1, int(np.max(np.flatnonzero(spread), initial=0)) + 1)

    def grid_nodes(self) -> FloatArray:
        """Give the positions of the grid's nodes; none without node files."""
        for body in self.bodies:
            try:
                return self[0].nodes(body).position
            except PygenError:
                continue
        return np.zeros((0, 3))

    def grid_lines(self) -> list[FloatArray]:
        """Give the coordinates of the grid's nodes in each direction; none without node files."""
        nodes = self.grid_nodes()
        axes = [np.unique(column) for column in nodes.T]
        # Unstructured nodes make no lines.
        if len(nodes) > 0 and math.prod(map(len, axes)) == len(nodes):
            return [axis for axis in axes if len(axis) > 1]
        return []

    def read(self, kind: str, body: str, number: int) -> Cloud:
        """Read a file.

        Parameters
        ----------
        kind : str
            "fpd" for points, "fnd" for nodes.
        body : str
            Its name.
        number : int
            Of the frame.
        """
        if body not in self._ids:
            raise PygenError(f"there is no body {body!r}; there are {', '.join(self.bodies)}")
        series = self._hdf.get((kind, body))
        if series is not None:
            return series.read(number)
        path = self._path(kind, body, number)
        if not path.is_file():
            raise PygenError(f"there is no frame {path}")
        return read_legacy(path)

    def _path(self, kind: str, body: str, number: int) -> Path:
        """Name a legacy file."""
        return self.folder / f"{kind}.{self._ids[body]}.{body}.{number:010d}.vtk"

    def _time(self, number: int) -> float:
        """Find the time of a frame in the file of any body."""
        for body in self.bodies:
            series = self._hdf.get(("fpd", body))
            if series is not None and number < len(series):
                return float(series.times[number])
            path = self._path("fpd", body, number)
            if path.is_file():
                return read_title(path)
        raise PygenError(f"frame {number} of {self.folder} has no points")


def by_name(values: object) -> Mapping[str, object]:
    """Give the named entries of a list of properties.

    Parameters
    ----------
    values : object
        A list of a config.
    """
    if isinstance(values, Mapping):
        return values
    last = values[-1] if isinstance(values, tuple) and values else None
    return last if isinstance(last, Mapping) else {}
