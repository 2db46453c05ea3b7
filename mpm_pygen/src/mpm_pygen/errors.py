"""Errors of this package; every message is one line that names the thing and the way out."""

from __future__ import annotations

from pathlib import Path


class PygenError(ValueError):
    """A shape, a number or a file that cannot be used."""


class PointsFileError(PygenError):
    """A points file that cannot be read.

    Parameters
    ----------
    path : Path
        The file.
    line : int
        Line of the cause, from 1; 0 when it is the file as a whole.
    message : str
        What is wrong, without a full stop.
    """

    def __init__(self, path: Path, line: int, message: str) -> None:
        place = f"{path}:{line}" if line > 0 else f"{path}"
        super().__init__(f"{place}: {message}")
        self.path = path
        self.line = line
