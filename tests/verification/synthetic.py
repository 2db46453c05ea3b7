"""Rows, records and cases for the tests of the harness, without a program."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.matrix import Row
from harness.runner import Program
from harness.scene import Scene

PROGRAM = Program(Path("/nowhere/mpm3d"), "mpm3d 1.2.3 (0123456789ab, GNU 12.2.0, Release)", "abc")


def no_scene(_parameters: Parameters) -> Scene:
    """Stand for a scene that no test asks for."""
    raise NotImplementedError


def no_measures(_parameters: Parameters, _output: Output) -> Measures:
    """Stand for measures that no test asks for."""
    raise NotImplementedError


def no_findings(_results: Results) -> list[Finding]:
    """Return nothing."""
    return []


def make_case(name: str = "bar", *, error: str = "e_u_l2", family: str = "Axial bar") -> Case:
    """Return a case of order 2 without functions."""
    case = Case(
        family=family,
        title=f"The {name}",
        statement="A *statement* with $x^2$.",
        source="Elementary",
        scene=no_scene,
        measure=no_measures,
        judge=no_findings,
        error=error,
        order=2.0,
    )
    case.name = name
    return case


def make_row(
    line: int,
    cells: Sequence[int] = (8, 16, 32),
    *,
    case: str = "bar",
    sim_type: int = 1,
    mapping: str = "linear",
    contact: str = "-",
    ppc: int = 2,
    options: Sequence[tuple[str, str]] = (),
) -> Row:
    """Return a row of the matrix."""
    return Row(
        line, case, sim_type, mapping, contact, ppc, tuple(cells), (), tuple(options), expect=()
    )


def make_record(row: Row, cells: int, measures: Measures, **changes: Any) -> dict[str, Any]:
    """Return the record of a run in one dimension at 100 ns a point and step."""
    points, steps = row.ppc * cells, 10 * cells
    parameters = next(p for p in row.runs(quick=False) if p.cells == cells)
    return {
        "key": "0123",
        "date": "2026-01-02T03:04:05Z",
        **parameters.record(),
        "problem": "",
        "measures": measures,
        "status": 0,
        "seconds": 0.5,
        "memory_mb": 20.0,
        "points": points,
        "steps": steps,
        "warnings": "",
        "loop_seconds": 1e-7 * points * steps,
        "ns_per_point_step": 100.0,
        "program": PROGRAM.version,
        "machine": "Some processor, 2 cores",
        "python": "3.11.7",
        **changes,
    }


def make_records(row: Row, error: Callable[[int], float], **changes: Any) -> list[dict[str, Any]]:
    """Return the records of a row whose error depends on the cells."""
    return [
        make_record(row, n, {"e_u_l2": error(n), "e_u_linf": 2 * error(n), "ratio": 1.0}, **changes)
        for n in row.cells
    ]
