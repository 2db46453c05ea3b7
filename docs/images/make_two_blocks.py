#!/usr/bin/env python3
"""Draw two_blocks.png, four frames of the scene configs/two_blocks.

usage: make_two_blocks.py FRAMES, the folder of the frames (output/two_blocks).
Needs NumPy, Matplotlib and VTK.
"""

import re
import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader

FRAMES = (0, 10, 13, 54)
LARGEST_SPEED = 2.0
BODIES = ("0.block_0", "1.block_1")


def read_frame(path: Path) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Return the time of a frame and positions, sides and speeds of its points.

    Parameters
    ----------
    path : Path
        A points file of DefaultVTK.

    Returns
    -------
    tuple
        Time, positions (n, 2), sides of the points' squares (n), speeds (n).
    """
    reader = vtkUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.ReadAllScalarsOn()
    reader.ReadAllVectorsOn()
    reader.Update()
    time = float(re.search(r"Time (\S+)", reader.GetHeader()).group(1))
    fields = reader.GetOutput().GetPointData()
    positions = vtk_to_numpy(reader.GetOutput().GetPoints().GetData())[:, :2]
    speeds = np.linalg.norm(vtk_to_numpy(fields.GetArray("velocity")), axis=1)
    return time, positions, np.sqrt(vtk_to_numpy(fields.GetArray("volume"))), speeds


def draw_frame(axes: Axes, folder: Path, frame: int) -> PolyCollection:
    """Draw the points of both blocks as squares, coloured by speed.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    folder : Path
        Folder of the frames.
    frame : int
        Number of the frame.

    Returns
    -------
    PolyCollection
        What was drawn last, for the colour bar.
    """
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for body in BODIES:
        time, positions, sides, speeds = read_frame(folder / f"fpd.{body}.{frame:010d}.vtk")
        squares = positions[:, None, :] + sides[:, None, None] * corners
        drawn = PolyCollection(squares, edgecolors="white", linewidths=0.3, cmap="viridis")
        drawn.set_array(speeds)
        drawn.set_clim(0.0, LARGEST_SPEED)
        axes.add_collection(drawn)
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
    axes.set_title(f"t = {time:.2f} s", fontsize=11)
    axes.set_xticks(np.linspace(0, 1, 21), minor=True)
    axes.set_yticks(np.linspace(0, 1, 21), minor=True)
    axes.set(xticks=[], yticks=[])
    axes.tick_params(which="both", length=0)
    axes.grid(which="minor", color="0.9", linewidth=0.5)
    axes.set_axisbelow(True)
    return drawn


def main() -> None:
    """Draw the picture beside this script."""
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    figure, panels = plt.subplots(
        1, len(FRAMES), figsize=(11.2, 2.9), layout="constrained", dpi=110
    )
    for axes, frame in zip(panels, FRAMES, strict=True):
        drawn = draw_frame(axes, Path(sys.argv[1]), frame)
    figure.colorbar(drawn, ax=panels, label="speed (m/s)", extend="max", pad=0.01)
    figure.savefig(Path(__file__).with_name("two_blocks.png"), metadata={"Software": None})


if __name__ == "__main__":
    main()
