"""The convergence test matrix: `matrix.csv`, one row a series of runs."""

from __future__ import annotations

import csv
import hashlib
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from .case import Finding, Parameters
from .scheme import GRIDS, Scheme

MATRIX = Path(__file__).resolve().parent.parent / "matrix.csv"
COLUMNS = ("case", "type", "mapping", "contact", "ppc", "resolution", "quick", "options", "expect")


@dataclass(frozen=True)
class Row:
    """One series of runs over resolutions."""

    line: int
    case: str
    sim_type: int
    mapping: str
    contact: str
    ppc: int
    #: Cells along the refined length (or what the case refines instead) in the full matrix,
    #: and in the quick tier: a part of them, maybe none.
    cells: tuple[int, ...]
    quick: tuple[int, ...]
    options: tuple[tuple[str, str], ...]
    #: Bounds of findings, by their names.
    expect: tuple[tuple[str, float, float], ...]

    @property
    def label(self) -> str:
        """Name of the row in messages and tables."""
        parts = [self.case, f"TYPE {self.sim_type}", self.mapping]
        if self.contact != "-":
            parts.append(self.contact)
        parts.append(f"{self.ppc} ppc")
        parts += [f"{key}={value}" for key, value in self.options]
        return ", ".join(parts)

    def runs(self, quick: bool) -> list[Parameters]:
        """Return the runs of a tier, by rising resolution."""
        return [
            Parameters(
                self.case,
                self.sim_type,
                self.mapping,
                self.contact,
                self.ppc,
                cells,
                dict(self.options),
            )
            for cells in (self.quick if quick else self.cells)
        ]

    def bound(self, findings: Sequence[Finding]) -> list[Finding]:
        """Give findings the bounds that the row has for them; a name without finding fails."""
        found = {finding.name: finding for finding in findings}
        if len(found) < len(findings):
            raise ValueError("two findings have the same name")
        for name, low, high in self.expect:
            if name not in found:
                found[name] = Finding(
                    name, math.nan, low, high, reason="the case has no such finding"
                )
            else:
                found[name].low, found[name].high = low, high
        return list(found.values())


def read_matrix(path: Path = MATRIX) -> list[Row]:
    """Read the matrix; lines that begin with # are comments."""
    rows = []
    with path.open(newline="") as file:
        lines = list(enumerate(file, 1))
    table = [(n, text) for n, text in lines if text.strip() and not text.startswith("#")]
    header, *body = csv.reader(text for _, text in table)
    if tuple(header) != COLUMNS:
        raise ValueError(f"{path}:{table[0][0]}: the columns must be {','.join(COLUMNS)}")
    for (number, _), fields in zip(table[1:], body, strict=True):
        try:
            rows.append(read_row(number, [field.strip() for field in fields]))
        except ValueError as problem:
            raise ValueError(f"{path}:{number}: {problem}") from None
    return rows


def read_row(number: int, fields: list[str]) -> Row:
    """Read one row."""
    if len(fields) != len(COLUMNS):
        raise ValueError(f"{len(fields)} columns instead of {len(COLUMNS)}")
    case, sim_type, mapping, contact, ppc, cells, quick, options, expect = fields
    row = Row(
        number,
        case,
        int(sim_type),
        mapping,
        contact,
        int(ppc),
        tuple(map(int, cells.split())),
        tuple(map(int, quick.split())),
        tuple(sorted(read_options(options))),
        tuple(read_bounds(expect)),
    )
    if row.mapping not in GRIDS:
        raise ValueError(f'mapping "{row.mapping}" is not one of {", ".join(GRIDS)}')
    Scheme.of(dict(row.options))
    if not set(row.quick) <= set(row.cells) or list(row.cells) != sorted(set(row.cells)):
        raise ValueError("resolutions must rise, and quick must be a part of them")
    return row


def read_options(text: str) -> Iterator[tuple[str, str]]:
    """Read `key=value key=value`."""
    for item in text.split():
        key, separator, value = item.partition("=")
        if not separator:
            raise ValueError(f'option "{item}" is not key=value')
        yield key, value


def read_bounds(text: str) -> Iterator[tuple[str, float, float]]:
    """Read `name low..high; name low..high`; a side may be left out."""
    for item in filter(None, map(str.strip, text.split(";"))):
        name, _, bounds = item.rpartition(" ")
        low, separator, high = bounds.partition("..")
        if not separator or not name:
            raise ValueError(f'bound "{item}" is not: name low..high')
        yield (
            name.strip(),
            float(low) if low else -math.inf,
            float(high) if high else math.inf,
        )


def digest(*texts: str) -> str:
    """Return a short digest of texts."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def run_key(parameters: Parameters, sources: str, timed: bool) -> str:
    """Return the key under which a run's record is found again."""
    return digest(json.dumps(parameters.record(), sort_keys=True), sources, str(timed))
