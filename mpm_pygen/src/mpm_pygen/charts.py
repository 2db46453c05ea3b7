"""Charts of histories."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from mpm_pygen.drawing import need_matplotlib
from mpm_pygen.errors import PygenError
from mpm_pygen.history import History
from mpm_pygen.movies import render, save_png

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: What a panel shows: the start of the last part of the names of its columns, and its title.
_PANELS = (
    ("centre", "centre of mass (m)"),
    ("momentum", "momentum (kg m/s)"),
    ("", "energy (J)"),
    ("force", "contact force (N)"),
    ("impulse", "contact impulse (N s)"),
    ("mass", "mass (kg)"),
)


def chart(history: History) -> Figure:
    """Draw a panel for each kind of quantity; columns that stay 0 are left out.

    Parameters
    ----------
    history : History
        The table. A mass is drawn only when it changes.
    """
    need_matplotlib()
    from matplotlib.figure import Figure

    panels = []
    for start, title in _PANELS:
        names = [name for name in history.columns if _kind(name) == start and _moves(history, name)]
        if names:
            panels.append((title, names))
    if not panels:
        raise PygenError("the history has no column that changes")
    rows = (len(panels) + 1) // 2
    columns = min(2, len(panels))
    figure = Figure(figsize=(4.8 * columns, 3.0 * rows), dpi=100)
    figure.set_layout_engine("constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for place, (title, names) in zip(axes, panels, strict=False):
        for name in names:
            place.plot(history.time, history[name], linewidth=1.1, label=_label(name))
        if title.startswith("energy"):
            total = np.nansum([history[name] for name in names], axis=0)
            place.plot(history.time, total, "k--", linewidth=1.1, label="sum")
        place.set_title(title, fontsize=10)
        place.set_xlabel("t (s)", fontsize=9)
        place.tick_params(labelsize=8)
        place.legend(fontsize=7)
        place.grid(color="0.92", linewidth=0.6)
    for place in axes[len(panels) :]:
        place.set_axis_off()
    return figure


def save_chart(history: History, path: str | os.PathLike[str], few_colours: int = 0) -> None:
    """Draw the chart into a PNG file.

    Parameters
    ----------
    history : History
        The table.
    path : str or PathLike
        The file.
    few_colours : int
        Largest number of colours of the file; 0: all.
    """
    save_png(render(chart(history)), path, few_colours)


def _kind(name: str) -> str | None:
    """Tell the panel of a column."""
    last = name.split(".")[-1]
    if "energy" in last:
        return ""
    return next((start for start, _ in _PANELS if start and last.startswith(start)), None)


def _label(name: str) -> str:
    """Name a line: the body, and its quantity in words."""
    body, _, quantity = name.rpartition(".")
    return f"{body} {quantity.replace('_', ' ')}".strip()


def _moves(history: History, name: str) -> bool:
    """Tell whether a column has something to show."""
    values = history[name][np.isfinite(history[name])]
    if len(values) == 0 or not np.any(values):
        return False
    if _kind(name) == "mass":
        return bool(np.ptp(values) > 1e-9 * np.max(np.abs(values)))
    return True
