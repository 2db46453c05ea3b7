"""The page of a family of cases: statements, tables of runs, findings, figures."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from .case import Case, Finding, Results, observed_order
from .curves import Choice, Cost, Judged, Problem, choices, compared
from .matrix import Row

#: First line of every page.
MARK = "<!-- Written by scripts/verify; changes here are lost. -->"
#: Columns of measures in a table of runs.
MOST_MEASURES = 5
#: Rows of a case that are shown unfolded.
MOST_OPEN = 3
#: What stands where there is no number.
NONE = "-"
NORMS = ("_l2", "_l1", "_linf")
#: Costs that differ by less than this part are named together: times of equal runs scatter.
SAME_TIME, SAME_WORK = 0.1, 0.005
CAPTIONS = {
    "convergence": "Error against resolution. The grey line has the expected order. Letters tell"
    " options of the same case and TYPE apart.",
    "untimed": "Error against points times steps. The grey line has the slope that the expected"
    " order gives.",
    "work": "Error against the time of the loop over steps (one thread, no frames), and against"
    " points times steps. The grey line has the slope that the expected order gives.",
    "ppc": "Error against points per cell at equal points times steps (numbers at the lines),"
    " interpolated between resolutions.",
}
#: Head of a table of findings.
FINDINGS = (
    "| finding | at | value | expected | bounds | why | passed |",
    "|---|---|--:|--:|--:|--:|--:|",
)
#: Head of the table of published values.
PUBLISHED = "Against published values"
PUBLISHED_COLUMNS = [
    "case",
    "TYPE",
    "method",
    "quantity",
    "published (source)",
    "ours",
    "difference",
    "cells",
    "points",
    "processor time [s]",
]
Record = dict[str, Any]


def family_page(
    family: str,
    cases: Mapping[str, Case],
    judged: Sequence[Judged],
    problems: Sequence[Problem],
    figures: Mapping[str, Sequence[str]],
) -> list[str]:
    """Return the lines of a family's page.

    Parameters
    ----------
    family : str
        The family.
    cases : Mapping[str, Case]
        All cases by their names.
    judged : Sequence[Judged]
        The rows of the family in the order of the matrix.
    problems : Sequence[Problem]
        The problems of the family that have an error.
    figures : Mapping[str, Sequence[str]]
        Files of figures by their kind.

    Returns
    -------
    list[str]
        The lines.
    """
    names = list(dict.fromkeys(row.case for row, _, _ in judged))
    lines = [f"# {family}", "", "[Results](README.md)", ""]
    for name in names:
        title = heading(cases[name])
        lines.append(f"- [{title}](#{slug(title)})")
    compared_values = published_section(cases, judged)
    if compared_values:
        lines.insert(4, f"- [{PUBLISHED}](#{slug(PUBLISHED)})")
    speed = speed_section(problems, figures)
    if speed:
        lines.append("- [Error against resolution and cost](#error-against-resolution-and-cost)")
    lines += ["", *compared_values]
    for name in names:
        lines += case_section(cases[name], [item for item in judged if item[0].case == name])
    return [*lines, *speed] if speed else lines[:-1]


def published_section(cases: Mapping[str, Case], judged: Sequence[Judged]) -> list[str]:
    """Return the table of published values beside ours; nothing when no case has any."""
    lines = []
    for row, records, _ in judged:
        case = cases[row.case]
        if case.published is None or any(record["problem"] for record in records):
            continue
        # A report holds None for what is not finite.
        measures = [
            {key: math.nan if value is None else value for key, value in record["measures"].items()}
            for record in records
        ]
        runs = {p.cells: p for p in row.runs(quick=False)}
        results = Results([runs[record["cells"]] for record in records], measures)
        sim_type, _, method = row.label.partition(", ")[2].partition(", ")
        for item in case.published(results):
            record = records[item.run]
            title = heading(case)
            cells = [f"[{text_cell(case.title)}](#{slug(title)})", sim_type.removeprefix("TYPE ")]
            cells += [text_cell(method), text_cell(item.quantity)]
            cells.append(text_cell(f"{number(item.value)} ({item.source})"))
            cells += [number(item.ours), signed_percent(item.difference), str(record["cells"])]
            cells.append(str(record.get("points", NONE)))
            cells.append(number(record.get("loop_seconds", record.get("seconds")), 3))
            lines.append(table_row(cells))
    if not lines:
        return []
    about = (
        "Difference: ours less the published value, over the published value. Cells, points and"
        " processor time (one thread) are those of the run that gave ours: the finest of its row,"
        " if a case does not say otherwise. Sources stand with the cases."
    )
    head = table_head(PUBLISHED_COLUMNS, left=5)
    return [f"## {PUBLISHED}", "", about, "", *head, *lines, ""]


def heading(case: Case) -> str:
    """Return the heading of a case, which no other case has."""
    return f"{case.title} ({case.name})"


def case_section(case: Case, judged: Sequence[Judged]) -> list[str]:
    """Return the part of a page about one case."""
    lines = [
        f"## {heading(case)}",
        "",
        case.statement.strip(),
        "",
        f"Source: {case.source.strip()}",
        "",
        f"[Case](../../verification/cases/{case.name}.py); `scripts/verify {case.name}`",
        "",
        *summary_table(case, judged),
        "",
    ]
    reasons: dict[str, int] = {}
    folded = len(judged) > MOST_OPEN
    single = [item for item in judged if len(item[1]) == 1]
    if len(single) < 2:
        single = []
    for place, (row, records, findings) in enumerate(judged, 1):
        if single and len(records) == 1:
            continue
        about = [*runs_table(case, records), ""]
        if findings:
            about += [*FINDINGS, *finding_lines(row, findings, reasons), ""]
        lines += block(f"Row {place}: {row_text(row)}", about, folded)
    if single:
        about = [*single_runs_table(case, judged), "", *FINDINGS]
        for place, (row, records, findings) in enumerate(judged, 1):
            if len(records) == 1:
                about += finding_lines(row, findings, reasons, f"{place}: ")
        about += [""]
        lines += block("Rows of one run", about, folded)
    if reasons:
        numbered = [f"{place}. {text_line(reason)}" for reason, place in reasons.items()]
        lines += ["Why these values and bounds:", "", *numbered, ""]
    return lines


def block(title: str, lines: Sequence[str], folded: bool) -> list[str]:
    """Return lines under a title, folded when there are many such blocks."""
    if folded:
        return [f"<details><summary>{title}</summary>", "", *lines, "</details>", ""]
    return [f"**{title}**", "", *lines]


def summary_table(case: Case, judged: Sequence[Judged]) -> list[str]:
    """Return a line a row: range of resolutions, error and order, checks."""
    columns = ["row", "", "resolution"]
    if case.error:
        columns += [f"{case.error}, coarsest", "finest", "order"]
    columns += ["time of one core [s]", "checks", "failed"]
    lines = table_head(columns, left=2)
    for place, (row, records, findings) in enumerate(judged, 1):
        cells = [record["cells"] for record in records]
        texts = [str(place), row_text(row), " to ".join(dict.fromkeys(map(str, ends(cells))))]
        if case.error:
            first, last = ends([record["measures"].get(case.error) for record in records])
            order = order_texts(case.error, case, records)
            texts += [number(first), number(last) if len(records) > 1 else ""]
            texts.append(order[0] if order else "")
        asserted = [finding for finding in findings if finding.is_asserted]
        failed = sum(not finding.passed for finding in asserted)
        texts.append(number(sum(record.get("seconds") or 0.0 for record in records), 3))
        texts += [str(len(asserted)), f"**{failed}**" if failed else "0"]
        lines.append(table_row(texts))
    return lines


def ends(items: Sequence[Any]) -> tuple[Any, Any]:
    """Return the first and the last item."""
    return items[0], items[-1]


def row_text(row: Row) -> str:
    """Return the label of a row without the name of its case."""
    return text_cell(row.label.partition(", ")[2])


def choose_measures(case: Case, records: Iterable[Record]) -> tuple[list[str], int]:
    """Return the measures for a table, the error first, and how many more there are."""
    names = list(dict.fromkeys(name for record in records for name in record["measures"]))

    def rank(name: str) -> int:
        if name == case.error:
            return 0
        is_norm = name.endswith(NORMS)
        return 1 if name.endswith("_l2") else 3 if is_norm else 2

    ordered = sorted(names, key=lambda name: (rank(name), names.index(name)))
    return ordered[:MOST_MEASURES], len(ordered[MOST_MEASURES:])


COST_COLUMNS = ["points", "steps", "wall time [s]", "ns a point and step"]


def costs(record: Record) -> list[str]:
    """Return points, steps and times of a run as cells."""
    return [
        str(record.get("points", NONE)),
        str(record.get("steps", NONE)),
        number(record.get("seconds"), 3),
        number(record.get("ns_per_point_step"), 3),
    ]


def runs_table(case: Case, records: Sequence[Record]) -> list[str]:
    """Return the runs of a row, and the orders of its errors below."""
    names, more = choose_measures(case, records)
    failed = any(record.get("status") for record in records)
    columns = ["resolution", *names, *COST_COLUMNS, *["exit status"] * failed]
    lines = table_head(columns, left=0)
    for record in records:
        values = [number(record["measures"].get(name)) for name in names]
        status = [str(record.get("status", NONE))] * failed
        lines.append(table_row([str(record["cells"]), *values, *costs(record), *status]))
    orders = {name: order_texts(name, case, records) for name in names}
    if any(orders.values()):
        rest = [""] * (len(columns) - 1 - len(names))
        for place, title in enumerate(("order", "between neighbours")):
            texts = [orders[name][place] if orders[name] else "" for name in names]
            if any(texts):
                lines.append(table_row([title, *texts, *rest]))
    if more:
        lines += ["", f"{more} more measures of each run: [results.jsonl](results.jsonl)."]
    return lines


def order_texts(name: str, case: Case, records: Sequence[Record]) -> list[str]:
    """Return the order of an error by least squares and between neighbours; empty: no error."""
    if len(records) < 2 or not (name == case.error or name.endswith(NORMS)):
        return []
    cells = [record["cells"] for record in records]
    errors = [record["measures"].get(name) for record in records]
    if any(error is None or error <= 0.0 for error in errors):
        return []
    halvings = [observed_order(cells[i : i + 2], errors[i : i + 2]) for i in range(len(cells) - 1)]
    texts = [f"{value:.2f}" for value in halvings] if len(halvings) > 1 else []
    return [f"**{observed_order(cells, errors):.2f}**", ", ".join(texts)]


def single_runs_table(case: Case, judged: Sequence[Judged]) -> list[str]:
    """Return the rows that have one run each in one table."""
    single = [(n, row, r[0]) for n, (row, r, _) in enumerate(judged, 1) if len(r) == 1]
    names, more = choose_measures(case, [record for _, _, record in single])
    failed = any(record.get("status") for _, _, record in single)
    columns = ["row", "resolution", *names, *COST_COLUMNS, *["exit status"] * failed]
    lines = table_head(columns, left=0)
    for place, _, record in single:
        values = [number(record["measures"].get(name)) for name in names]
        status = [str(record.get("status", NONE))] * failed
        cells = [str(place), str(record["cells"])]
        lines.append(table_row([*cells, *values, *costs(record), *status]))
    if more:
        lines += ["", f"{more} more measures of each run: [results.jsonl](results.jsonl)."]
    return lines


def finding_lines(
    row: Row, findings: Sequence[Finding], reasons: dict[str, int], before: str = ""
) -> list[str]:
    """Return the findings of a row; reasons of bounds are numbered and collected.

    A finding that comes for several resolutions stands in one line.
    """
    lines = []
    for base, members in grouped(row, findings):
        places = [place for place, _ in members]
        found = [finding for _, finding in members]
        why = ""
        if found[0].reason:
            why = str(reasons.setdefault(found[0].reason, len(reasons) + 1))
        texts = [bound_texts(finding) for finding in found]
        failed = [place for place, finding in members if not finding.passed]
        if failed:
            passed = "**no**" if len(failed) == len(members) else f"**no**: {', '.join(failed)}"
        else:
            passed = "yes" if found[0].is_asserted else NONE
        cells = [before + text_cell(base), ", ".join(places), ", ".join(text[0] for text in texts)]
        cells += [listed([text[column] for text in texts]) for column in (1, 2)]
        lines.append(table_row([*cells, why, passed]))
    return lines


def listed(texts: Sequence[str]) -> str:
    """Return a list in words, without repetition of a text or of a sign before all of them."""
    if len(set(texts)) == 1:
        return texts[0]
    signs = {text.partition(" ")[0] for text in texts}
    if len(signs) == 1 and all(" " in text and "…" not in text for text in texts):
        return f"{signs.pop()} " + ", ".join(text.partition(" ")[2] for text in texts)
    return ", ".join(texts)


def grouped(row: Row, findings: Sequence[Finding]) -> list[tuple[str, list[tuple[str, Finding]]]]:
    """Group findings that differ by the resolution in `name, 16 cells` only, with their places."""
    groups: dict[tuple[str, str, str, bool], list[tuple[str, Finding]]] = {}
    resolution = re.compile(rf"\b(?:{'|'.join(map(str, row.cells)) or 'none'})\b")
    for finding in findings:
        base, _, place = finding.name.rpartition(", ")
        pattern = resolution.sub("#", place)
        if not base or pattern == place:
            base, place, pattern = finding.name, "", finding.name
        key = (base, pattern, finding.reason, finding.is_asserted)
        groups.setdefault(key, []).append((place.removesuffix(" cells"), finding))
    return [(base, members) for (base, *_), members in groups.items()]


def bound_texts(finding: Finding) -> list[str]:
    """Return value, expectation and bounds, with as many digits as tell them apart."""
    low, high, value, expected = finding.low, finding.high, finding.value, finding.expected
    different = {x for x in (low, high, value) if math.isfinite(x)}
    digits = 4
    while digits < 12 and len({number(x, digits) for x in different}) < len(different):
        digits += 1
    texts = {x: number(x, digits) for x in (low, high)}
    margin = 0.5 * (high - low)
    if not finding.is_asserted:
        bounds = NONE
    elif low == high:
        bounds = f"= {texts[low]}"
    elif not math.isfinite(low) or (low == 0.0 and math.isnan(expected) and value >= 0.0):
        bounds = f"≤ {texts[high]}"
    elif not math.isfinite(high):
        bounds = f"≥ {texts[low]}"
    elif abs(low + high - 2.0 * expected) <= 1e-6 * margin:
        relative = margin / abs(expected) if expected else math.inf
        is_relative = 1e-4 <= relative < 1.0 and not finding.name.startswith("order")
        bounds = f"± {percent(relative) if is_relative else number(margin, 3)}"
    else:
        bounds = f"{texts[low]} … {texts[high]}"
    return [number(value, min(digits, 8)), number(expected, min(digits, 8)), bounds]


def speed_section(problems: Sequence[Problem], figures: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the figures, and the cheapest method for given errors."""
    lines = ["## Error against resolution and cost", ""]
    is_timed = all(problem.is_timed for problem in compared(problems))
    for kind, names in figures.items():
        caption = CAPTIONS[kind if is_timed or kind != "work" else "untimed"]
        for name in names:
            lines.append(f"![{caption}]({name})")
        if names:
            lines += ["", caption, ""]
    lines += choice_table([choice for problem in problems for choice in choices(problem)])
    return lines[:-1] if len(lines) > 2 else []


def choice_table(found: Sequence[Choice]) -> list[str]:
    """Return the cheapest methods by problem and level of error."""
    found = [choice for choice in found if len(choice.problem.curves) > 1]
    if not found:
        return []
    timed = any(choice.by_seconds for choice in found)
    columns = ["problem", "error"]
    if timed:
        columns += ["least time", "[s]", "next"]
    columns += ["least points times steps", "", "next"]
    lines = ["Cheapest method for a given error:", "", *table_head(columns, left=2)]
    for choice in found:
        cells = [text_cell(choice.problem.title), percent(choice.level)]
        if timed:
            cells += choice_cells(choice.by_seconds, SAME_TIME)
        lines.append(table_row([*cells, *choice_cells(choice.by_point_steps, SAME_WORK)]))
    same = f"{percent(SAME_TIME)} in time, {percent(SAME_WORK)} in points times steps"
    return [
        *lines,
        "",
        "Costs are interpolated between resolutions; ≤: the coarsest run is better than the error"
        f" asked for. Methods whose costs agree to {same} stand together.",
        "",
    ]


def choice_cells(ordered: Sequence[Cost], same: float) -> list[str]:
    """Return the cheapest method, its cost, and the next method with its factor."""
    if not ordered:
        return [NONE, NONE, NONE]
    least = ordered[0]
    equal = [cost for cost in ordered if cost.value <= least.value * (1.0 + same)]
    rest = ordered[len(equal) :]
    after = f"{rest[0].method} ({number(rest[0].value / least.value, 3)} times)" if rest else NONE
    value = ("≤ " if least.is_bound else "") + number(least.value, 3)
    return ["; ".join(str(cost.method) for cost in equal), value, after]


def table_head(columns: Sequence[str], left: int) -> list[str]:
    """Return the head of a table; the first columns are aligned to the left."""
    rules = ["---" if place < left else "--:" for place in range(len(columns))]
    return [table_row([text_cell(column) for column in columns]), "|" + "|".join(rules) + "|"]


def table_row(cells: Sequence[str]) -> str:
    """Return a line of a table."""
    return "| " + " | ".join(cells) + " |"


def number(value: float | None, digits: int = 4) -> str:
    """Return a number with significant digits, a dash when there is none."""
    if value is None or math.isnan(value):
        return NONE
    text = f"{value + 0.0:.{digits}g}"
    if "e" in text and 1.0 <= abs(value) < 1e6:
        return f"{float(text):.0f}"
    return re.sub(r"e([+-])0*(\d+)", lambda m: f"e{m[1].strip('+')}{m[2]}", text)


def percent(part: float) -> str:
    """Return a part in per cent."""
    return f"{number(100.0 * part, 2 if part < 0.995 else 3)} %"


def signed_percent(part: float) -> str:
    """Return a difference in per cent, with its sign."""
    return NONE if math.isnan(part) else f"{'+' * (part >= 0.0)}{percent(part)}"


def text_line(text: str, most: int = 600) -> str:
    """Return a text as one line of Markdown without markup."""
    line = " ".join(text.split())
    line = line if len(line) <= most else line[:most] + " …"
    return re.sub(r"([*`<>]|\](?=\())", r"\\\1", line)


def text_cell(text: str) -> str:
    """Return a text for the cell of a table."""
    return text_line(text).replace("|", r"\|")


def slug(title: str) -> str:
    """Return the anchor of a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
