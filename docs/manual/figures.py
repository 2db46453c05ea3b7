"""Figures of the class reference: what the verification measured with a class.

They are drawn from the records of the verification, docs/verification/results.jsonl, like its own
figures, with the lines of the class alone.
"""

from __future__ import annotations

import json
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from harness.curves import Curve, Problem

ROOT = Path(__file__).resolve().parents[2]
RECORDS = ROOT / "docs" / "verification" / "results.jsonl"
#: Problems of a case and TYPE that a figure shows.
MOST = 4


@dataclass(frozen=True)
class Choice:
    """What a figure shows."""

    #: Cases and TYPEs.
    panels: tuple[tuple[str, int], ...]
    #: Words on what is to be seen.
    text: str
    #: Column `mapping` of the matrix.
    mapping: str = r"\w+"
    #: What differs from USL with FLIP, or nothing.
    scheme: str = ""
    #: Options of the case.
    options: str = ".*"

    def shows(self, curve: Curve) -> bool:
        """Tell whether a line belongs to the figure."""
        method = curve.method
        return bool(
            re.fullmatch(self.mapping, method.mapping) and re.fullmatch(self.scheme, method.scheme)
        )


WAVE_AND_SOLUTION = (("standing_wave", 1), ("axis_aligned", 2))
SEAMS = (("periodic_wave", 1), ("periodic_wave", 2))
BASIS = "Waves between walls, and a manufactured solution at small and large strain"
SEAM = "Waves on a grid that repeats"
SMALL = "amplitude=1e-6"
SOLUTION = (("axis_aligned", 1),)
TRANSFERS = "A manufactured solution with linear and cubic functions, and every transfer"
#: Figures by class; classes that differ in their names only share one.
FIGURES = {
    "CartesianLinear": Choice(WAVE_AND_SOLUTION, BASIS, "linear|cpdi"),
    "CartesianUGIMP": Choice(WAVE_AND_SOLUTION, BASIS, "ugimp"),
    "CartesianQuadratic": Choice(WAVE_AND_SOLUTION, BASIS, "quadratic"),
    "CartesianCubic": Choice(WAVE_AND_SOLUTION, BASIS, "cubic"),
    "CartesianCustom": Choice(SEAMS, SEAM, "linear|cpdi"),
    "CartesianUGIMPCustom": Choice(SEAMS, SEAM, "ugimp"),
    "CartesianQuadraticCustom": Choice(SEAMS, SEAM, "quadratic"),
    "CartesianCubicCustom": Choice(SEAMS, SEAM, "cubic"),
    "ExplicitUSL": Choice(
        SOLUTION, TRANSFERS, "linear|cubic", r"|[\d.]+ FLIP|PIC|APIC|MLS|XPIC.*", SMALL
    ),
    "ExplicitMUSL": Choice(SOLUTION, TRANSFERS, "linear|cubic", "MUSL.*", SMALL),
    "ExplicitUSF": Choice(SOLUTION, TRANSFERS, "linear|cubic", "USF.*", SMALL),
    "ImprovedQuadraturePoints": Choice(
        (("standing_wave", 2), ("vortex", 2)),
        "Waves, and a vortex that turns and shears the domains of points",
        scheme=".*domains",
    ),
    "DefaultPoints": Choice(
        (("standing_wave", 1), ("standing_wave", 3)),
        "Waves with 1 to 4 points a cell",
        "linear|cpdi",
    ),
    "IsotropicLinearElasticity": Choice(
        (("roller_modes", 2), ("radial_waves", 4), ("rotating_block", 2)),
        "Waves of pressure and shear, radial waves, and a block that turns",
        scheme="|hughes-winget",
    ),
    "BarotropicViscousFluid": Choice(
        (("viscous_decay", 2), ("viscous_decay", 5)), "Decay of a shear flow: the rate"
    ),
    "CartesianBox": Choice(
        (("fixed_free_mode", 1), ("fixed_free_mode", 2)), "Waves between a wall and a free end"
    ),
    "CartesianSmoothBox": Choice(
        (("roller_modes", 2), ("roller_modes", 3)), "Waves in a square and a cube on smooth walls"
    ),
    "CartesianBoxCustom": Choice(
        (("antiplane", 5), ("torsional_wave", 4)), "Shear out of the plane, and torsion of a bar"
    ),
    "ContactHuang": Choice(
        (("colliding_bars", 1), ("rolling_disc", 2), ("elastic_discs", 2)),
        "Bars that collide, a disc that rolls, and two discs",
        "cpdi",
        options=r"|normals=0|v=0\.05|kind=impedance.*|angle=.*",
    ),
    "UserDefinedGravityDriver": Choice(
        (("sudden_gravity", 1), ("sudden_gravity", 2)),
        "A column under gravity that sets in at once",
    ),
    "AdaptiveDriver": Choice(
        (("driven_column", 1),),
        "A column with steps that the driver chooses",
        options=".*adaptive.*",
    ),
}


def read_problems() -> list[Problem]:
    """Return what was measured, by problem."""
    from harness.case import load_cases
    from harness.curves import find_problems
    from harness.matrix import read_matrix

    records: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for line in RECORDS.read_text("utf-8").splitlines():
        record = json.loads(line)
        records[record.pop("row")].append(record)
    rows = [row for row in read_matrix() if row.label in records]
    return find_problems(load_cases(), [(row, records[row.label], []) for row in rows])


def chosen(choice: Choice, problems: list[Problem]) -> Iterator[Problem]:
    """Yield the problems of a figure, with the lines that it shows."""
    from dataclasses import replace

    for panel in choice.panels:
        found = 0
        for problem in problems:
            if (problem.case, problem.sim_type) != panel or found == MOST:
                continue
            curves = tuple(c for c in problem.curves if choice.shows(c) and len(c.cells) > 1)
            if curves and re.fullmatch(choice.options, ", ".join(problem.option_texts)):
                found += 1
                yield replace(problem, curves=curves)


def draw_figures(folder: Path) -> None:
    """Draw all figures into a folder, in place of those that are there."""
    sys.path.insert(0, str(ROOT / "verification"))
    from harness.plots import draw_convergence

    problems = read_problems()
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("*.png"):
        path.unlink()
    for name, choice in FIGURES.items():
        shown = list(chosen(choice, problems))
        if {(p.case, p.sim_type) for p in shown} != set(choice.panels):
            raise ValueError(f"{RECORDS.name} does not have all of the figure of {name}")
        if len(draw_convergence(folder / f"{name}.png", shown)) > 1:
            raise ValueError(f"the figure of {name} has more than one sheet")


def figure_text(name: str, links: dict[str, str]) -> list[str]:
    """Return the lines that show the figure of a class, with links to the results of its cases."""
    choice = FIGURES.get(name)
    if choice is None:
        return []
    cases = dict.fromkeys(case for case, _ in choice.panels)
    told = ", ".join(links[case] for case in cases)
    return [
        f"![{choice.text}: error against resolution](../figures/{name}.png)",
        "",
        f"*{choice.text}. Error against resolution in rows of the verification with this class; "
        f"the grey line has the expected order, letters tell options apart. More: {told}.*",
        "",
    ]
