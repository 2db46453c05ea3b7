#!/usr/bin/env python3
"""Draw the diagrams of the manual as SVG files beside this script, or in the folder that is named.

usage: make_diagrams.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape

HERE = Path(__file__).resolve().parent
INK, FRAME, PAPER = "#222222", "#555555", "#ffffff"
COLOURS = {"program": "#dfe7f3", "role": "#fdebc8", "data": "#e2f0dc", "soft": "#4878a8"}
STIFF = "#c44e52"


class Drawing:
    """Shapes of an SVG file."""

    def __init__(self, width: float, height: float) -> None:
        self.width, self.height = width, height
        self.parts: list[str] = []

    def box(
        self, x: float, y: float, w: float, h: float, lines: Sequence[str], kind: str = "role"
    ) -> None:
        """Draw a box with lines of text, the first one bold."""
        self.parts.append(
            f'<rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" rx="5" '
            f'fill="{COLOURS[kind]}" stroke="{FRAME}"/>'
        )
        top = y + h / 2 - 8 * (len(lines) - 1) + 4.5
        for i, line in enumerate(lines):
            self.text(x + w / 2, top + 16 * i, line, bold=i == 0, small=i > 0)

    def text(
        self,
        x: float,
        y: float,
        text: str,
        *,
        anchor: str = "middle",
        bold: bool = False,
        small: bool = False,
    ) -> None:
        """Write a line of text."""
        weight = ' font-weight="bold"' if bold else ""
        self.parts.append(
            f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" '
            f'font-size="{11.5 if small else 13:g}"{weight}>{escape(text)}</text>'
        )

    def line(
        self, points: Sequence[tuple[float, float]], *, arrow: bool = False, dashed: bool = False
    ) -> None:
        """Draw a line, with a head at its end if asked."""
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        head = ' marker-end="url(#head)"' if arrow else ""
        dash = ' stroke-dasharray="4 3"' if dashed else ""
        self.parts.append(
            f'<polyline points="{path}" fill="none" stroke="{FRAME}" stroke-width="1.2"'
            f"{dash}{head}/>"
        )

    def curve(self, points: Sequence[tuple[float, float]], colour: str) -> None:
        """Draw a coloured line."""
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        self.parts.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>'
        )

    def dot(self, x: float, y: float, colour: str, radius: float = 3.0) -> None:
        """Draw a point."""
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{colour}"/>')

    def rectangle(self, x: float, y: float, w: float, h: float, colour: str) -> None:
        """Draw a coloured rectangle, half transparent."""
        self.parts.append(
            f'<rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" fill="{colour}" '
            f'fill-opacity="0.35" stroke="{colour}"/>'
        )

    def save(self, path: Path) -> None:
        """Write the file."""
        path.write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width:g}" '
            f'height="{self.height:g}" viewBox="0 0 {self.width:g} {self.height:g}" '
            f'font-family="sans-serif" fill="{INK}">\n'
            f'<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" '
            f'markerHeight="8" orient="auto"><path d="M0 0L8 4L0 8z" fill="{FRAME}"/></marker>'
            f'</defs>\n<rect width="100%" height="100%" fill="{PAPER}"/>\n'
            + "\n".join(self.parts)
            + "\n</svg>\n",
            "utf-8",
        )


def objects() -> Drawing:
    """Draw which object holds which."""
    d = Drawing(760, 400)
    d.box(20, 20, 150, 50, ["main program", "app/mpm3d.f90"], "program")
    d.box(230, 20, 150, 50, ["configurator", "config, registries"], "program")
    d.box(440, 20, 130, 50, ["job", "everything of a run"], "data")
    d.line([(170, 45), (230, 45)], arrow=True)
    d.line([(380, 45), (440, 45)], arrow=True)
    d.text(410, 38, "makes", small=True)
    d.text(200, 38, "config", small=True)
    row = (
        (20, ["serializer", "frames, saving"], "role"),
        (170, ["driver", "loop over time"], "role"),
        (320, ["solver", "one step"], "role"),
        (470, ["model", "one time"], "data"),
        (620, ["checkpoints", "state on the disk"], "program"),
    )
    for x, lines, kind in row:
        d.box(x, 120, 125, 50, lines, kind)
        d.line([(505, 70), (505, 95), (x + 62, 95), (x + 62, 120)])
    below = (
        (320, ["grid", "domain, functions"], "role"),
        (470, ["bodies", "in order"], "role"),
        (620, ["contacts", "in order"], "role"),
    )
    for x, lines, kind in below:
        d.box(x, 220, 125, 50, lines, kind)
        d.line([(532, 170), (532, 195), (x + 62, 195), (x + 62, 220)])
    parts = (
        (170, ["points", "x, v, T, m, V"]),
        (320, ["nodes", "m, P, f, v"]),
        (470, ["material", "stress"]),
        (620, ["boundary", "faces of the grid"]),
    )
    for x, lines in parts:
        d.box(x, 330, 125, 50, lines)
        d.line([(532, 270), (532, 300), (x + 62, 300), (x + 62, 330)])
    d.text(20, 300, "yellow: roles, whose classes", anchor="start", small=True)
    d.text(20, 316, "a config names", anchor="start", small=True)
    return d


def step() -> Drawing:
    """Draw one step of ExplicitUSL."""
    d = Drawing(760, 330)
    d.text(20, 30, "nodes", anchor="start", bold=True)
    d.text(20, 300, "points", anchor="start", bold=True)
    d.line([(20, 165), (740, 165)], dashed=True)
    nodes = (
        (130, ["sums", "m, P = Σ m v, f"], "data"),
        (285, ["contacts", "f of two bodies"], "role"),
        (440, ["boundary", "v, P, f at faces"], "role"),
        (595, ["advance", "P += dt f, v = P/m"], "data"),
    )
    for x, lines, kind in nodes:
        d.box(x, 60, 130, 55, lines, kind)
    for x in (260, 415, 570):
        d.line([(x, 87), (x + 25, 87)], arrow=True)
    points = (
        (595, ["move", "x, v, then L = grad v"], "data"),
        (440, ["volume", "V ← V exp(dt tr L)"], "data"),
        (285, ["material", "T from L, dt, T"], "role"),
        (130, ["state", "x, v, m, V, T"], "data"),
    )
    for x, lines, kind in points:
        d.box(x, 215, 130, 55, lines, kind)
    for x in (595, 440, 285):
        d.line([(x, 242), (x - 25, 242)], arrow=True)
    d.line([(195, 215), (195, 115)], arrow=True)
    d.text(205, 150, "P2G: mass, momentum,", anchor="start", small=True)
    d.text(205, 184, "stress and body force", anchor="start", small=True)
    d.line([(660, 115), (660, 215)], arrow=True)
    d.text(650, 150, "G2P: Σ N v, Σ N Δv", anchor="end", small=True)
    d.text(650, 184, "Σ v ⊗ grad N", anchor="end", small=True)
    d.text(380, 310, "the next step begins at the left", small=True)
    return d


def cloud(centre: tuple[float, float], radius: float, squeeze: float) -> list[tuple[float, float]]:
    """Return points of a disc that is squeezed vertically by a factor."""
    spacing, found = 9.0, []
    n = math.ceil(radius / spacing)
    for i in range(-n, n):
        for j in range(-n, n):
            x, y = (i + 0.5) * spacing, (j + 0.5) * spacing
            if math.hypot(x, y) < radius:
                found.append((centre[0] + x / squeeze, centre[1] + y * squeeze))
    return found


def spaces() -> Drawing:
    """Draw two bodies on a grid at two times, and functions of nodes and points."""
    d = Drawing(760, 420)
    for left, title in ((40, "t = 0"), (420, "t = T")):
        d.text(left + 150, 25, title, bold=True)
        for k in range(11):
            d.line([(left + 30 * k, 40), (left + 30 * k, 220)])
        for k in range(7):
            d.line([(left, 40 + 30 * k), (left + 300, 40 + 30 * k)])
    first = ((110.0, 90.0), 38.0, 1.0, COLOURS["soft"]), ((240.0, 170.0), 42.0, 1.0, STIFF)
    second = ((555.0, 137.0), 38.0, 0.82, COLOURS["soft"]), ((640.0, 178.0), 42.0, 0.92, STIFF)
    for centre, radius, squeeze, colour in (*first, *second):
        for x, y in cloud(centre, radius, squeeze):
            d.dot(x, y, colour)
    d.text(92, 147, "body 1", anchor="start", small=True)
    d.text(292, 212, "body 2", anchor="start", small=True)
    # Functions of nodes and of points along a line.
    base, h = 320.0, 100.0
    d.text(40, 250, "node space: hats N_i over the cells", anchor="start", bold=True)
    d.line([(40, base), (740, base)])
    for k in range(8):
        d.dot(40 + h * k, base, INK, 4)
    for k, colour in ((2, COLOURS["soft"]), (3, STIFF)):
        middle = 40 + h * k
        d.curve([(middle - h, base), (middle, base - 55), (middle + h, base)], colour)
        d.text(middle, base + 18, "i" if k == 2 else "i + 1", small=True)
    d.text(40, 362, "point space: U_p, the boxes of the points", anchor="start", bold=True)
    d.line([(40, 400), (740, 400)])
    for k in range(8):
        d.rectangle(240 + 50 * k, 372, 50, 28, COLOURS["soft"])
        d.dot(265 + 50 * k, 400, COLOURS["soft"], 4)
    return d


DIAGRAMS = {"objects": objects, "step": step, "spaces": spaces}


def main() -> None:
    """Draw all diagrams."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    for name, draw in DIAGRAMS.items():
        draw().save(folder / f"{name}.svg")


if __name__ == "__main__":
    main()
