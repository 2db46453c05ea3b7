"""What a case is: a scene made from parameters, its measures, and what they must be."""

from __future__ import annotations

import importlib.util
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from .frames import Series as Frames
from .scene import Scene
from .scheme import Scheme

CASES = Path(__file__).resolve().parent.parent / "cases"


@dataclass(frozen=True)
class Parameters:
    """Parameters of one run; those that are not columns of the matrix are `options`."""

    case: str
    sim_type: int
    mapping: str
    contact: str
    #: Points per cell along each direction.
    ppc: int
    #: Cells along the length that the case refines; a case that refines something else says so.
    cells: int
    options: Mapping[str, str] = field(default_factory=dict)

    def number(self, name: str, default: float) -> float:
        """Return a numeric option."""
        return float(self.options.get(name, default))

    def text(self, name: str, default: str) -> str:
        """Return an option."""
        return self.options.get(name, default)

    @property
    def scheme(self) -> Scheme:
        """Integrator, transfer and smoothing."""
        return Scheme.of(self.options)

    def record(self) -> dict[str, Any]:
        """Return the parameters for a JSON line."""
        return {
            "case": self.case,
            "type": self.sim_type,
            "mapping": self.mapping,
            "contact": self.contact,
            "ppc": self.ppc,
            "cells": self.cells,
            "options": dict(sorted(self.options.items())),
        }


@dataclass
class Output:
    """What a run left behind, until it has been measured."""

    folder: Path
    scene: Scene
    #: Exit status of the program, what it printed, and what it wrote as errors and warnings.
    status: int
    text: str
    errors: str

    def points(self, body: int = 0) -> Frames:
        """Return the point frames of a body."""
        return Frames(self.folder / "frames", "fpd", body, self.scene.bodies[body].name)

    def nodes(self, body: int = 0) -> Frames:
        """Return the node frames of a body, which show the whole grid."""
        return Frames(self.folder / "frames", "fnd", body, self.scene.bodies[body].name)


Measures = dict[str, float]


@dataclass
class Finding:
    """One value and what it must be.

    A finding without bounds informs only. `reason` says where expectation and tolerance come from.
    """

    name: str
    value: float
    low: float = -math.inf
    high: float = math.inf
    #: What theory says; nan when it gives bounds only.
    expected: float = math.nan
    reason: str = ""

    @property
    def is_asserted(self) -> bool:
        """Whether the value has a bound; a bound that is nan counts, and fails."""
        return not (self.low == -math.inf and self.high == math.inf)

    @property
    def passed(self) -> bool:
        """Whether the value is within its bounds; nan never is."""
        return not self.is_asserted or self.low <= self.value <= self.high


def near(name: str, value: float, expected: float, relative: float, reason: str) -> Finding:
    """Return a finding that must agree with a value to a relative tolerance."""
    margin = abs(expected) * relative
    return Finding(name, value, expected - margin, expected + margin, expected, reason)


def below(name: str, value: float, bound: float, reason: str) -> Finding:
    """Return a finding for a magnitude, 0 or above, that must not exceed a bound."""
    return Finding(name, value, 0.0, bound, math.nan, reason)


@dataclass(frozen=True)
class Published:
    """A value that others have published, and ours."""

    #: What it is, with unit or scale.
    quantity: str
    #: Author and year.
    source: str
    value: float
    ours: float
    #: The run of the row that gave ours; -1 is the finest.
    run: int = -1

    @property
    def difference(self) -> float:
        """Ours less the published value, over the published value; nan when that is 0."""
        return (self.ours - self.value) / self.value if self.value else math.nan


@dataclass
class Results:
    """The runs of one row of the matrix, by rising resolution."""

    parameters: Sequence[Parameters]
    measures: Sequence[Measures]

    @property
    def cells(self) -> Sequence[int]:
        """Cells of each run."""
        return [p.cells for p in self.parameters]

    @property
    def first(self) -> Parameters:
        """Parameters of the coarsest run."""
        return self.parameters[0]

    def column(self, name: str) -> list[float]:
        """Return one measure of all runs."""
        return [m[name] for m in self.measures]

    def __iter__(self) -> Iterator[tuple[Parameters, Measures]]:
        """Visit the runs."""
        return iter(zip(self.parameters, self.measures, strict=True))

    def order(self, name: str) -> float:
        """Return the observed order of an error in 1/cells, by least squares over all runs."""
        return observed_order(self.cells, self.column(name))

    def halvings(self, name: str) -> list[float]:
        """Return the observed order between neighbouring runs."""
        errors, cells = self.column(name), self.cells
        return [observed_order(cells[i : i + 2], errors[i : i + 2]) for i in range(len(cells) - 1)]


def observed_order(cells: Sequence[float], errors: Sequence[float]) -> float:
    """Return q of error ~ cells^-q, by least squares of the logarithms."""
    if len(cells) < 2 or min(errors) <= 0.0 or not np.all(np.isfinite(errors)):
        return math.nan
    slope, _ = np.polyfit(np.log(cells), np.log(errors), 1)
    return -float(slope)


@dataclass
class Case:
    """A verification case: everything that one file of `cases/` says."""

    family: str
    title: str
    #: The problem, its exact solution and what is measured, in Markdown.
    statement: str
    #: Paper, textbook, or the derivation.
    source: str
    #: Make the scene of a run.
    scene: Callable[[Parameters], Scene]
    #: Measure a finished run.
    measure: Callable[[Parameters, Output], Measures]
    #: Compare the measures of a row of the matrix with theory.
    judge: Callable[[Results], list[Finding]]
    #: The measure that stands for the error in work-precision figures; empty: none.
    error: str = ""
    #: Expected order of `error` in h where the method converges; 0: none, no slope is drawn.
    order: float = 0.0
    #: Whether runs may end with exit status 3, the simulation went bad.
    may_fail: bool = False
    #: Values of the literature beside those of a row, for a table; bounds belong to `judge`.
    published: Callable[[Results], list[Published]] | None = None
    name: str = ""

    def make_scene(self, p: Parameters) -> Scene:
        """Return the scene of a run with the scheme of its row.

        Boxes of uGIMP are as wide as the points lie apart.
        """
        made = self.scene(p)
        made.scheme, made.box = p.scheme, 1.0 / p.ppc
        return made


def load_cases() -> dict[str, Case]:
    """Import every file of `cases/`; the stem of the file is the name of the case."""
    cases = {}
    for path in sorted(CASES.glob("*.py")):
        if path.stem.startswith("_"):
            continue
        cases[path.stem] = load_case(path)
    return cases


def load_case(path: Path) -> Case:
    """Import one case; it finds what it shares with others beside it.

    A function `published` of the file is that of the case.
    """
    if str(path.parent) not in sys.path:
        sys.path.insert(0, str(path.parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    case = module.CASE
    case.name = path.stem
    case.published = case.published or getattr(module, "published", None)
    return case
