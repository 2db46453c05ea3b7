"""The results as Markdown pages with figures, and the records beside them.

The same records give the same bytes.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .case import Case, Finding
from .curves import Judged, find_problems
from .pages import MARK, NONE, family_page, heading, number, percent, slug, text_cell
from .plots import draw_convergence, draw_points_per_cell, draw_work
from .runner import Program

#: Ends of the names of figures.
FIGURES = ("convergence", "work", "ppc")
#: Digits of the numbers in the records.
DIGITS = 12
#: Failed checks of a row that the index names.
MOST_NAMED = 3
FOLDERS = re.compile(r"(?<![\w.])/(?:[\w.+-]+/)+")


def write_report(
    folder: Path, cases: Mapping[str, Case], judged: Sequence[Judged], program: Program
) -> None:
    """Write the index, a page and figures for each family, and the records.

    Parameters
    ----------
    folder : Path
        Where to write; pages and figures of a former report there are removed.
    cases : Mapping[str, Case]
        The cases by their names.
    judged : Sequence[Judged]
        Rows of the matrix with their records, by rising resolution, and findings.
    program : Program
        The program under test.
    """
    folder.mkdir(parents=True, exist_ok=True)
    remove_former(folder)
    ordered = sorted(
        [
            (row, [clean(record) for record in records], findings)
            for row, records, findings in judged
        ],
        key=lambda item: item[0].line,
    )
    families = dict.fromkeys(cases[row.case].family for row, _, _ in ordered)
    for family in families:
        part = [item for item in ordered if cases[item[0].case].family == family]
        problems = find_problems(cases, part)
        drawn = {
            name: draw(folder / f"{stem(family)}_{name}.png", problems)
            for name, draw in zip(
                FIGURES, (draw_convergence, draw_work, draw_points_per_cell), strict=True
            )
        }
        write(folder / f"{stem(family)}.md", family_page(family, cases, part, problems, drawn))
    write(folder / "README.md", index_page(cases, ordered, list(families), program))
    with (folder / "results.jsonl").open("w", encoding="utf-8") as file:
        for row, records, _ in ordered:
            for record in records:
                file.write(json.dumps({"row": row.label} | record, ensure_ascii=False) + "\n")


def stem(family: str) -> str:
    """Return the name of a family's files."""
    return family.lower().replace(" ", "_")


def write(path: Path, lines: Sequence[str]) -> None:
    """Write a page."""
    path.write_text("\n".join([MARK, *lines]) + "\n", encoding="utf-8")


def remove_former(folder: Path) -> None:
    """Remove pages and figures of a former report: its families may have other names."""
    for path in folder.glob("*.md"):
        if path.read_text(encoding="utf-8").startswith(MARK):
            path.unlink()
    for name in FIGURES:
        for path in [*folder.glob(f"*_{name}.png"), *folder.glob(f"*_{name}_[0-9].png")]:
            path.unlink()


def clean(value: Any) -> Any:
    """Return a record for publication: no folders of the machine, finite numbers, no key."""
    if isinstance(value, dict):
        return {key: clean(item) for key, item in value.items() if key != "key"}
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
    return FOLDERS.sub("", value) if isinstance(value, str) else value


def index_page(
    cases: Mapping[str, Case], judged: Sequence[Judged], families: Sequence[str], program: Program
) -> list[str]:
    """Return the lines of the page that sums up all families."""
    lines = [
        "# Results of the verification",
        "",
        "[Contents](../README.md) · [method, norms, how to add a case](../verification.md)",
        "",
        *head(judged, program),
        "",
        "| family | cases | rows | runs | checks | failed | closest to its bound |",
        "|---|--:|--:|--:|--:|--:|---|",
    ]
    for family in families:
        part = [item for item in judged if cases[item[0].case].family == family]
        findings = [finding for _, _, found in part for finding in found if finding.is_asserted]
        failed = sum(not finding.passed for finding in findings)
        cells = [
            f"[{family}]({stem(family)}.md)",
            len({row.case for row, _, _ in part}),
            len(part),
            len(runs(part)),
            len(findings),
            f"**{failed}**" if failed else "0",
            closest(part),
        ]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    lines += [
        "",
        "The last column names the passed check that uses most of its tolerance: 0 % is the"
        " expected value, 100 % the bound.",
        "",
        *failures(cases, judged),
        "## Cases",
        "",
    ]
    for family in families:
        names = dict.fromkeys(row.case for row, _, _ in judged if cases[row.case].family == family)
        lines += [f"{family}:", ""]
        for name in names:
            title = heading(cases[name])
            lines.append(f"- [{title}]({stem(family)}.md#{slug(title)})")
        lines.append("")
    return lines[:-1]


def head(judged: Sequence[Judged], program: Program) -> list[str]:
    """Return what was run, on what, when and for how long."""
    records = runs(judged)
    asserted = [f for _, _, findings in judged for f in findings if f.is_asserted]
    failed = sum(not finding.passed for finding in asserted)
    dates = sorted({record["date"][:10] for record in records if "date" in record})
    machines = sorted({record["machine"] for record in records if "machine" in record})
    total = sum(record.get("seconds") or 0.0 for record in records)
    loops = sum(record.get("loop_seconds") or 0.0 for record in records)
    time = f"{duration(total)} of one core for the runs"
    if loops:
        time += f"; {duration(loops)} for their loops over steps again without frames"
    return [
        "| | |",
        "|---|---|",
        f"| program | {text_cell(clean(program.version))} |",
        f"| machine | {text_cell('; '.join(machines))}, one thread a run |",
        f"| date | {' to '.join(dict.fromkeys([*dates[:1], *dates[-1:]]))} |",
        f"| extent | {len(judged)} rows of the matrix, {len(records)} runs |",
        f"| checks | {len(asserted)}, {f'**{failed} failed**' if failed else 'all passed'} |",
        f"| time | {time} |",
        "| records | [results.jsonl](results.jsonl), a JSON line a run |",
        "| command | `scripts/verify` |",
    ]


def duration(seconds: float) -> str:
    """Return a time in words."""
    return f"{number(seconds, 2)} s" if seconds < 100.0 else f"{round(seconds / 60)} min"


def runs(judged: Sequence[Judged]) -> list[dict[str, Any]]:
    """Return the records, each once: rows may share runs."""
    columns = ("case", "type", "mapping", "contact", "ppc", "cells", "options")
    unique = {
        json.dumps([record[name] for name in columns], sort_keys=True): record
        for _, records, _ in judged
        for record in records
    }
    return list(unique.values())


def used(finding: Finding) -> float:
    """Return the part of its tolerance that a value uses; 1 is at a bound, nan means no answer."""
    if not (finding.passed and finding.is_asserted and math.isfinite(finding.value)):
        return math.nan
    low, high, expected = finding.low, finding.high, finding.expected
    if math.isnan(expected):
        if not (math.isfinite(low) and math.isfinite(high)):
            return math.nan
        expected = 0.0 if low == 0.0 else 0.5 * (low + high)
    margin = high - expected if finding.value >= expected else expected - low
    return abs(finding.value - expected) / margin if margin > 0.0 else 0.0


def closest(judged: Sequence[Judged]) -> str:
    """Name the passed finding that is closest to its bound."""
    best, text = -1.0, NONE
    for row, _, findings in judged:
        for finding in findings:
            part = used(finding)
            if best < part < 1.0:  # a value on its bound is a flag or a number of things
                best = part
                text = f"{percent(part)}: {text_cell(finding.name)} ({text_cell(row.label)})"
    return text


def failures(cases: Mapping[str, Case], judged: Sequence[Judged]) -> list[str]:
    """Return a table of the rows with checks that failed."""
    lines = []
    for row, _, findings in judged:
        names = [text_cell(finding.name) for finding in findings if not finding.passed]
        if names:
            more = [f"{len(names) - MOST_NAMED} more"] if len(names) > MOST_NAMED else []
            family = cases[row.case].family
            listed = "; ".join([*names[:MOST_NAMED], *more])
            lines.append(f"| {text_cell(row.label)} | {listed} | [{family}]({stem(family)}.md) |")
    if not lines:
        return []
    return ["## Failed checks", "", "| row | checks | see |", "|---|---|---|", *lines, ""]
