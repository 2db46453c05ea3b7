"""The scheme of a run: integrator, transfer, smoothing, domains of points, as options of a row.

Every case runs with every scheme: the runner gives the options of this module to the scene, and a
case looks at them only where theory says something else about a scheme.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

#: Grid class by the column `mapping`; its class with seams is the same with `Custom`.
GRIDS = {
    "linear": "CartesianLinear",
    "cpdi": "CartesianLinear",
    "ugimp": "CartesianUGIMP",
    "quadratic": "CartesianQuadratic",
    "cubic": "CartesianCubic",
}
#: Nodes that a basis reaches beyond the cell of a point, and fewest cells between walls.
FEWEST_CELLS = {"linear": 1, "cpdi": 1, "ugimp": 3, "quadratic": 3, "cubic": 3}
SOLVERS = {"USL": "ExplicitUSL", "MUSL": "ExplicitMUSL", "USF": "ExplicitUSF"}
TRANSFERS = ("FLIP", "PIC", "APIC", "MLS", "XPIC")
SMOOTHING = {
    "cells": "USE_ZHANG_CELLS",
    "functions": "USE_MAST_CELLS",
    "flux": "USE_ZHANG_FLUX",
}
#: Domains of points on linear functions, and integers of ImprovedQuadraturePoints; they are boxes
#: of the mapping `ugimp` that follow the deformation, but for those of the same name.
DOMAINS = {"ugimp": 1, "cpgimp": 2, "cpdi": 3, "cpdi2": 4}
#: Options of a row that choose the scheme.
OPTIONS = ("solver", "transfer", "flip", "xpic", "smoothing", "staggered", "rate", "domains")


@dataclass(frozen=True)
class Scheme:
    """Integrator, transfer, smoothing, objective rate and domains of points.

    Parameters
    ----------
    solver : str
        USL, MUSL or USF.
    transfer : str
        FLIP, PIC, APIC, MLS or XPIC.
    flip : float
        Part of FLIP; the rest is PIC.
    xpic : int
        Order of XPIC.
    smoothing : str
        Way to smooth volumes, one of `SMOOTHING`; empty: none.
    staggered : bool
        Velocities half a step before positions from the start.
    rate : str
        Objective rate of the elastic law.
    domains : str
        Domains of points, one of `DOMAINS`; empty: what the grid's functions have.
    """

    solver: str = "USL"
    transfer: str = "FLIP"
    flip: float = 1.0
    xpic: int = 2
    smoothing: str = ""
    staggered: bool = False
    rate: str = "jaumann"
    domains: str = ""

    def __post_init__(self) -> None:
        """Refuse what the program does not have."""
        known = {
            "solver": (self.solver, SOLVERS),
            "transfer": (self.transfer, TRANSFERS),
            "smoothing": (self.smoothing, ["", *SMOOTHING]),
            "rate": (self.rate, ("jaumann", "hughes_winget")),
            "domains": (self.domains, ["", *DOMAINS]),
        }
        for name, (value, values) in known.items():
            if value not in values:
                raise ValueError(
                    f'{name} "{value}" is not one of {", ".join(filter(None, values))}'
                )
        if self.smoothing and (self.solver, self.transfer, self.flip) != ("USL", "FLIP", 1.0):
            raise ValueError("smoothing goes with USL and FLIP")

    @classmethod
    def of(cls, options: Mapping[str, str]) -> Scheme:
        """Return the scheme that the options of a row choose."""
        return cls(
            solver=options.get("solver", "USL"),
            transfer=options.get("transfer", "FLIP"),
            flip=float(options.get("flip", 1.0)),
            xpic=int(options.get("xpic", 2)),
            smoothing=options.get("smoothing", ""),
            staggered=options.get("staggered", "no") == "yes",
            rate=options.get("rate", "jaumann"),
            domains=options.get("domains", ""),
        )

    @property
    def label(self) -> str:
        """What differs from USL with FLIP, for legends and tables."""
        transfer = self.transfer
        if transfer == "XPIC":
            transfer += f"({self.xpic})"
        elif self.flip < 1.0:
            transfer = f"{self.flip:g} FLIP"
        parts = [
            f"{self.domains} domains" if self.domains else "",
            self.solver if self.solver != "USL" else "",
            transfer if transfer != "FLIP" else "",
            f"smoothed ({self.smoothing})" if self.smoothing else "",
            "staggered" if self.staggered else "",
            self.rate.replace("_", "-") if self.rate != "jaumann" else "",
        ]
        return " ".join(filter(None, parts))

    @property
    def solver_class(self) -> str:
        """Class of the solver."""
        if self.smoothing:
            return "ExplicitUSLwithVolumetricStrainSmoothing"
        return SOLVERS[self.solver]

    def functions(self, mapping: str) -> str:
        """Return the mapping, or the domains that replace its boxes."""
        return f"{self.domains} domains" if self.domains else mapping

    @property
    def points_class(self) -> str:
        """Class of the points, with its properties."""
        if not self.domains:
            return 'point-class = "DefaultPoints"'
        rule = DOMAINS[self.domains]
        return f'point-class = "ImprovedQuadraturePoints"\n    point-int-props = {{{rule}}}'

    def solver_section(self, averaged: bool, implicit: bool) -> str:
        """Return the section `solver` of a config."""
        integers = f"cpdi = {int(averaged)}, contact = {int(implicit)}"
        if self.staggered:
            integers += ", staggered = 1"
        if self.transfer == "XPIC":
            integers += f", xpic_order = {self.xpic}"
        lines = [f'    class = "{self.solver_class}"', f"    int-properties = {{{integers}}}"]
        if self.flip < 1.0:
            lines.append(f"    properties = {{flip = {self.flip!r}}}")
        if self.smoothing:
            lines.append(f'    str-properties = {{"{SMOOTHING[self.smoothing]}"}}')
        elif self.transfer != "FLIP":
            lines.append(f'    str-properties = {{transfer = "{self.transfer}"}}')
        return "\n".join(["solver", "{", *lines, "}"])
