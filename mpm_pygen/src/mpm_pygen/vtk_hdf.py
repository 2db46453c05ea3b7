"""VTKHDF files with steps: PolyData or UnstructuredGrid, as the VTK file format describes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mpm_pygen.clouds import Cloud
from mpm_pygen.errors import PygenError


class HdfSeries:
    """The steps of one file.

    Parameters
    ----------
    path : Path
        The file.

    Attributes
    ----------
    times : FloatArray
        `(steps,)` [s]
    sim_type : int or None
        TYPE of the run, where the file tells.
    config : str
        Text of the config of the run, empty when the file does not tell.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        with self._open() as file:
            if "VTKHDF" not in file:
                raise PygenError(f"{path}: there is no group VTKHDF in it")
            root = file["VTKHDF"]
            kind = root.attrs.get("Type", b"")
            kind = kind.decode() if isinstance(kind, bytes) else str(kind)
            if kind not in ("PolyData", "UnstructuredGrid"):
                raise PygenError(f"{path}: a file of type {kind or 'unknown'} has no points")
            own = file.get("mpm3d")
            told = None if own is None else own.attrs.get("type")
            self.sim_type = None if told is None else int(told)
            text = None if own is None else own.get("config")
            self.config = "" if text is None else bytes(text[()]).decode("utf-8", "replace")
            self.times = np.array(root["Steps/Values"] if "Steps" in root else [0.0], dtype=float)

    def __len__(self) -> int:
        """Count the steps."""
        return len(self.times)

    def read(self, step: int) -> Cloud:
        """Read a step.

        Parameters
        ----------
        step : int
            Number, from 0.
        """
        if not 0 <= step < len(self):
            raise PygenError(f"{self.path} has {len(self)} steps, no number {step}")
        with self._open() as file:
            root = file["VTKHDF"]
            part, parts = self._entry(root, "PartOffsets", step), 1
            if "Steps/NumberOfParts" in root:
                parts = int(root["Steps/NumberOfParts"][step])
            counts = np.array(root["NumberOfPoints"][part : part + parts])
            count = int(counts.sum())
            first = self._entry(root, "PointOffsets", step)
            fields: dict[str, Any] = {}
            for name, data in root.get("PointData", {}).items():
                start = self._entry(root, f"PointDataOffsets/{name}", step, first)
                values = np.array(data[start : start + count], dtype=float)
                if values.ndim == 2 and values.shape[1] == 9:
                    values = values.reshape(-1, 3, 3)
                fields[name] = values
            return Cloud(
                position=np.array(root["Points"][first : first + count], dtype=float),
                fields=fields,
                cell_size=self._cell_size(root),
            )

    def _open(self) -> Any:
        """Open the file."""
        try:
            import h5py
        except ImportError:
            raise PygenError(
                f"{self.path}: VTKHDF files need the package h5py (Debian: python3-h5py)"
            ) from None
        try:
            return h5py.File(self.path, "r")
        except OSError as error:
            raise PygenError(
                f"{self.path}: this is no HDF5 file that can be read: {error}"
            ) from None

    @staticmethod
    def _entry(root: Any, name: str, step: int, default: int = 0) -> int:
        """Read an entry of the group of steps."""
        path = f"Steps/{name}"
        return int(root[path][step]) if path in root else default

    @staticmethod
    def _cell_size(root: Any) -> int:
        """Tell how many points the first cell has; 1 for vertices of PolyData."""
        if "Offsets" not in root:
            return 1
        offsets = root["Offsets"]
        return int(offsets[1] - offsets[0]) if len(offsets) > 1 else 0
