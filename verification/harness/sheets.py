"""Sheets of figures: panels of equal size under a legend, and the looks of the methods."""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image  # matplotlib writes PNG files with it

from .curves import Method, Problem, equal_costs
from .scheme import GRIDS

#: Width on paper [inch], resolution, and size of all text [pt].
WIDTH, DPI, FONT = 6.9, 150, 8.0
#: Colours that differ also for colour-blind readers and in grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
DASHES = ("-", (0, (5, 2)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5)), (0, (3, 1, 1, 1, 1, 1)))
#: Markers by points per cell; their sizes by mapping and rule, so that equal results show. [pt]
SIZES = (3.2, 4.8, 5.8, 6.6)
MARKERS = {1: "o", 2: "s", 3: "^", 4: "D", 5: "v", 6: "p"}
GREY, DARK = "#777777", "#444444"
#: Shades of a colour towards white in the files.
SHADES = 6
STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": FONT,
    "axes.titlesize": FONT,
    "axes.labelsize": FONT,
    "xtick.labelsize": FONT,
    "ytick.labelsize": FONT,
    "legend.fontsize": FONT,
    "axes.linewidth": 0.6,
    "axes.unicode_minus": True,
    "text.hinting": "none",
}
#: Heights of parts of a figure. [inch]
TITLE_LINE, LEGEND_LINE, AXIS_LABELS, PANEL = 0.145, 0.19, 0.44, 1.45
#: Room for the labels left of a panel, and between the panels of a problem. [inch]
LEFT, GAP = 0.64, 0.24
#: Marks of the problems in a panel.
LETTERS = "abcd"
#: Problems that share axes.
Panel = Sequence[Problem]


@dataclass(frozen=True)
class Look:
    """How a mapping with a contact rule is drawn."""

    colour: str
    dashes: str | tuple[float, tuple[float, ...]]
    size: float
    is_filled: bool


def looks(problems: Sequence[Problem]) -> dict[str, Look]:
    """Give each mapping and contact rule a look; all figures of the same problems agree."""
    methods = {curve.method for problem in problems for curve in problem.curves}
    kinds = list(dict.fromkeys(m.kind for m in sorted(methods, key=lambda m: (rank(m), m))))
    return {
        kind: Look(
            COLOURS[i % len(COLOURS)],
            DASHES[i % len(DASHES)],
            SIZES[min(i, len(SIZES) - 1)],
            is_filled=i == 0,
        )
        for i, kind in enumerate(kinds)
    }


def rank(method: Method) -> tuple[int, int]:
    """Order mappings and contact rules as a reader expects them."""
    mappings, rules = tuple(GRIDS), ("-", "implicit", "explicit")
    return (
        rules.index(method.contact) if method.contact in rules else len(rules),
        mappings.index(method.mapping) if method.mapping in mappings else len(mappings),
    )


def line_style(look: Look, ppc: int) -> dict[str, object]:
    """Return the keywords of a line: colour and dashes by kind, marker by points per cell."""
    return {
        "color": look.colour,
        "linestyle": look.dashes,
        "linewidth": 1.0,
        "marker": MARKERS.get(ppc, "*"),
        "markersize": look.size,
        "markerfacecolor": look.colour if look.is_filled else "none",
        "markeredgewidth": 0.8,
    }


def split(panels: Sequence[Panel], columns: int) -> list[Sequence[Panel]]:
    """Split panels over sheets of up to four lines, evenly."""
    if not panels:
        return []
    lines = math.ceil(len(panels) / columns)
    size = math.ceil(lines / math.ceil(lines / 4)) * columns
    return [panels[i : i + size] for i in range(0, len(panels), size)]


def numbered(path: Path, number: int) -> Path:
    """Return the name of a sheet."""
    return path.with_stem(f"{path.stem}_{number + 1}") if number else path


class Sheet:
    """A figure of the width of a page with a legend above rows of panels."""

    def __init__(
        self,
        groups: Sequence[Panel],
        columns: int,
        panels: int,
        style: dict[str, Look],
        *,
        has_slope: bool = True,
        ppc: bool = True,
    ) -> None:
        self.columns, self.panels = columns, panels
        self.width = WIDTH / columns
        letters = int((self.width - 0.2) / 0.064)
        self.titles = [title_lines(group, letters) for group in groups]
        self.lines = [self.titles[i : i + columns] for i in range(0, len(groups), columns)]
        problems = [problem for group in groups for problem in group]
        self.tops = [TITLE_LINE * max(map(len, titles)) + 0.1 for titles in self.lines]
        handles = legend_handles(
            problems, style, ppc=ppc, has_slope=has_slope and any(p.order for p in problems)
        )
        rows = legend_rows(handles)
        head = LEGEND_LINE * len(rows) + 0.06
        self.height = head + sum(self.tops) + len(self.tops) * (PANEL + AXIS_LABELS)
        self.figure = Figure(figsize=(WIDTH, self.height), dpi=DPI)
        FigureCanvasAgg(self.figure)
        self.head = head
        for place, row in enumerate(rows):
            self.legend(row, self.height - 0.03 - LEGEND_LINE * place)

    def legend(self, handles: Sequence[Line2D], top: float) -> None:
        """Draw a line of the legend."""
        self.figure.legend(
            handles=list(handles),
            loc="upper center",
            bbox_to_anchor=(0.5, top / self.height),
            ncol=len(handles),
            frameon=False,
            borderpad=0.0,
            borderaxespad=0.0,
            handlelength=2.6,
            columnspacing=1.4,
        )

    def axes(self, index: int, place: int) -> Axes:
        """Make the axes of a problem's panel, with the title above the first."""
        line, column = divmod(index, self.columns)
        above = sum(self.tops[: line + 1]) + line * (PANEL + AXIS_LABELS)
        bottom = self.height - self.head - above - PANEL
        width = (self.width - LEFT - 0.12 - GAP * (self.panels - 1)) / self.panels
        left = column * self.width + LEFT + place * (width + GAP)
        axes = self.figure.add_axes(
            (left / WIDTH, bottom / self.height, width / WIDTH, PANEL / self.height)
        )
        axes.tick_params(length=2.5, width=0.6, pad=2)
        axes.tick_params(which="minor", length=1.5, width=0.4)
        axes.xaxis.labelpad = 2
        axes.yaxis.set_label_coords(-0.46 / width, 0.5)
        if place == 0:
            self.figure.text(
                (column * self.width + 0.1) / WIDTH,
                (bottom + PANEL + 0.05) / self.height,
                "\n".join(self.titles[index]),
                ha="left",
                va="bottom",
                linespacing=1.15,
            )
        return axes

    def save(self, path: Path) -> str:
        """Write a PNG with a palette; return its name."""
        buffer = io.BytesIO()
        self.figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
        buffer.seek(0)
        picture = Image.open(buffer).convert("RGB")
        picture.quantize(palette=palette(), dither=Image.Dither.NONE).save(path, optimize=True)
        return path.name


def title_lines(group: Panel, letters: int) -> list[str]:
    """Return the title of a panel, options below."""
    lines = textwrap.wrap(f"{group[0].case}, TYPE {group[0].sim_type}", letters)
    for letter, problem in zip(LETTERS, group, strict=False):
        options = ", ".join(problem.option_texts)
        if len(group) > 1:
            options = f"{letter}: {options or 'default'}"
        lines += textwrap.wrap(options, letters, subsequent_indent="    " * (len(group) > 1))
    return lines


def legend_handles(
    problems: Sequence[Problem], style: dict[str, Look], *, ppc: bool, has_slope: bool
) -> list[Line2D]:
    """Return an entry for each method that occurs, and for the reference slope."""
    methods = {curve.method for problem in problems for curve in problem.curves}
    if not ppc:
        drawn = {group.kind for problem in problems for group in equal_costs(problem)}
        methods = {method for method in methods if method.kind in drawn}
    ordered = sorted(methods, key=lambda method: (rank(method), method))
    entries = {
        (str(m) if ppc else m.kind): line_style(style[m.kind], m.ppc if ppc else 1) for m in ordered
    }
    handles = [Line2D([], [], label=label, **line) for label, line in entries.items()]
    if not ppc:
        handles.append(Line2D([], [], linestyle="none", label="at the lines: point-steps"))
    if has_slope:
        handles.append(Line2D([], [], color=GREY, linewidth=1.2, label="expected order"))
    return handles


def legend_rows(handles: Sequence[Line2D]) -> list[list[Line2D]]:
    """Break the legend into lines that fit the width."""
    rows: list[list[Line2D]] = []
    used = math.inf
    for handle in handles:
        width = 0.56 + 0.062 * len(str(handle.get_label()))
        if used + width > WIDTH:
            rows.append([])
            used = 0.0
        rows[-1].append(handle)
        used += width
    return rows


def palette() -> Image.Image:
    """Return the colours of the figures in a few shades up to white; few colours, small files."""
    colours = [(255, 255, 255)]
    for name in (*COLOURS, DARK):
        full = [int(name[i : i + 2], 16) for i in (1, 3, 5)]
        for part in (np.arange(SHADES) + 1.0) / SHADES:
            colours.append(tuple(round(255 + part * (value - 255)) for value in full))
    image = Image.new("P", (1, 1))
    image.putpalette([value for colour in colours for value in colour])
    return image
