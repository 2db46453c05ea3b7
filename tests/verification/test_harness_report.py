"""Pages, figures and records of a report."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from harness.case import Finding, Published, Results, below, near
from harness.curves import Judged, find_problems
from harness.pages import (
    bound_texts,
    grouped,
    number,
    percent,
    signed_percent,
    slug,
    text_cell,
)
from harness.plots import draw_convergence, draw_points_per_cell, draw_work
from harness.report import clean, used, write_report
from harness.sheets import DPI, WIDTH
from synthetic import PROGRAM, make_case, make_record, make_records, make_row

CASES = {
    "bar": make_case(),
    "wave": make_case("wave"),
    "block": make_case("block", error="", family="Hard cases"),
}


def make_judged(**changes: Any) -> list[Judged]:
    """Return rows of two families, with one failed check."""
    judged: list[Judged] = []
    for line, (mapping, ppc) in enumerate([(m, n) for m in ("linear", "cpdi") for n in (1, 2, 3)]):
        row = make_row(10 + line, (8, 16, 32, 64), mapping=mapping, ppc=ppc)
        records = make_records(row, lambda n, p=ppc: (1.0 + 1.0 / p) * 4.0 / n**2, **changes)
        findings = [near("order of e_u", 2.0, 2.0, 0.05, "theory | of order")]
        findings += [
            near(f"e_u, {n} cells", 1.01 / n, 1.0 / n, 0.03, "a series") for n in row.cells
        ]
        judged.append((row, records, findings))
    row = make_row(30, (8, 16), case="wave", sim_type=2, options=[("nu", "0.3")])
    failed = Finding("ratio", math.nan, 0.9, 1.1, 1.0, "theory")
    judged.append((row, make_records(row, lambda n: 1.0 / n, **changes), [failed]))
    for line, angle in enumerate(("10", "20"), 20):
        row = make_row(line, (8,), case="block", sim_type=2, options=[("angle", angle)])
        record = make_record(row, 8, {"slip": 0.5}, **changes)
        judged.append((row, [record], [below("slip", 0.5, 1.0, "Coulomb")]))
    return judged


def anchors(text: str) -> set[str]:
    """Return the anchors of the headings of a page."""
    return {slug(title) for title in re.findall(r"^#+ (.*)$", text, re.MULTILINE)}


def test_report_has_index_pages_figures_and_records(tmp_path: Path) -> None:
    """A page a family in the order of the matrix; links lead somewhere."""
    write_report(tmp_path, CASES, list(reversed(make_judged())), PROGRAM)
    assert {path.name for path in tmp_path.iterdir()} == {
        "README.md",
        "axial_bar.md",
        "axial_bar_convergence.png",
        "axial_bar_work.png",
        "axial_bar_ppc.png",
        "hard_cases.md",
        "results.jsonl",
    }
    index = (tmp_path / "README.md").read_text()
    assert index.index("[Axial bar](axial_bar.md) |") < index.index("[Hard cases](hard_cases.md) |")
    assert PROGRAM.version in index
    assert "9 rows of the matrix, 28 runs" in index
    assert "| checks | 33, **1 failed** |" in index
    assert "| wave, TYPE 2, linear, 2 ppc, nu=0.3 | ratio | [Axial bar](axial_bar.md) |" in index
    for page in tmp_path.glob("*.md"):
        for target, anchor in re.findall(r"\]\(([\w.]*)#([^)]*)\)", page.read_text()):
            assert anchor in anchors((tmp_path / (target or page.name)).read_text())
        for target in re.findall(r"\]\((\w+\.\w+)\)", page.read_text()):
            assert (tmp_path / target).is_file()


def test_tables_have_as_many_cells_as_columns(tmp_path: Path) -> None:
    """A line of a table never breaks it, whatever texts are in it."""
    write_report(tmp_path, CASES, make_judged(), PROGRAM)
    tables = 0
    for page in tmp_path.glob("*.md"):
        columns = 0
        for line in page.read_text().splitlines():
            bars = len(re.findall(r"(?<!\\)\|", line))
            if line.startswith("|"):
                tables += columns == 0
                columns = columns or bars
                assert bars == columns, line
            else:
                columns = 0
    assert tables > 15


def test_family_page_tells_orders_findings_and_reasons(tmp_path: Path) -> None:
    """Observed orders by row; findings for several resolutions on one line; reasons once."""
    write_report(tmp_path, CASES, make_judged(), PROGRAM)
    page = (tmp_path / "axial_bar.md").read_text()
    assert "A *statement* with $x^2$." in page
    assert (
        "| 1 | TYPE 1, linear, 1 ppc | 8 to 64 | 0.125 | 0.001953 | **2.00** | 2 | 5 | 0 |" in page
    )
    assert "| between neighbours | 2.00, 2.00, 2.00 |" in page
    assert "| order of e_u |  | 2 | 2 | ± 0.1 | 1 | yes |" in page
    assert "| e_u | 8, 16, 32, 64 | 0.1263, " in page
    assert "| ± 3 % | 2 | yes |" in page
    assert "| ratio |  | - | 1 | ± 10 % | 1 | **no** |" in page
    assert page.count("theory | of order") == 1
    hard = (tmp_path / "hard_cases.md").read_text()
    assert "| 1 | 8 | 0.5 | 16 | 80 | 0.5 | 100 |" in hard
    assert hard.count("Coulomb") == 1
    assert "![" not in hard


def test_published_values_stand_beside_ours(tmp_path: Path) -> None:
    """A line for each value, with the run that gave ours; only for cases that have some."""

    def published(results: Results) -> list[Published]:
        ours = results.column("slip")
        return [
            Published("slip", "Author 1999 | table", 2.0, ours[-1]),
            Published("slip", "Author 2000", 0.25, ours[0], run=0),
        ]

    case = make_case("block", error="", family="Hard cases")
    case.published = published
    row = make_row(7, (8, 16), case="block", sim_type=2, options=[("angle", "10")])
    records = [make_record(row, 8, {"slip": 0.5}), make_record(row, 16, {"slip": 1.5})]
    bad = make_row(8, (8,), case="block", sim_type=2)
    failed = make_record(bad, 8, {}, problem="exit status 1")
    judged: list[Judged] = [(row, records, []), (bad, [failed], []), make_judged()[0]]
    write_report(tmp_path, {**CASES, "block": case}, judged, PROGRAM)
    page = (tmp_path / "hard_cases.md").read_text()
    assert "- [Against published values](#against-published-values)" in page
    start = "| [The block](#the-block-block) | 2 | linear, 2 ppc, angle=10 | slip |"
    assert rf"{start} 2 (Author 1999 \| table) | 1.5 | -25 % | 16 | 32 | 0.000512 |" in page
    assert f"{start} 0.25 (Author 2000) | 0.5 | +100 % | 8 | 16 | 0.000128 |" in page
    assert page.count("(Author") == 2
    assert "Against published values" not in (tmp_path / "axial_bar.md").read_text()


def test_cheapest_method_is_named(tmp_path: Path) -> None:
    """Two mappings with equal errors and costs stand together."""
    write_report(tmp_path, CASES, make_judged(), PROGRAM)
    page = (tmp_path / "axial_bar.md").read_text()
    # 1 point: 8/n^2 = 1 %, 10 n^2 point-steps; 2 points: 6/n^2, 20 n^2.
    both = "cpdi, 1 ppc; linear, 1 ppc"
    wanted = f"| bar, TYPE 1 | 1 % | {both} | 0.0008 | cpdi, 2 ppc (1.5 times) | {both} | 8000 |"
    assert wanted in page


def test_same_records_give_the_same_bytes(tmp_path: Path) -> None:
    """Whatever the order in which rows were judged."""
    judged = make_judged()
    write_report(tmp_path / "a", CASES, judged, PROGRAM)
    write_report(tmp_path / "b", CASES, judged[::-1], PROGRAM)
    first = {path.name: path.read_bytes() for path in (tmp_path / "a").iterdir()}
    assert first == {path.name: path.read_bytes() for path in (tmp_path / "b").iterdir()}


def test_former_report_is_removed_and_nothing_else(tmp_path: Path) -> None:
    """Pages and figures of families that are gone; not what a user put there."""
    for name in ("notes.md", "other.png", "data.txt"):
        (tmp_path / name).write_text("mine")
    judged = make_judged()
    write_report(tmp_path, CASES, judged, PROGRAM)
    write_report(tmp_path, CASES, [item for item in judged if item[0].case == "block"], PROGRAM)
    assert {path.name for path in tmp_path.iterdir()} == {
        "README.md",
        "hard_cases.md",
        "results.jsonl",
        "notes.md",
        "other.png",
        "data.txt",
    }


def test_records_are_in_the_order_of_the_matrix(tmp_path: Path) -> None:
    """With the label of their row; every number is JSON's."""
    judged = make_judged(problem="can't open /tmp/some/folder/frames/a.vtk of 1/2")
    judged[0][1][0]["measures"]["bad"] = math.inf
    judged[0][1][0]["measures"]["long"] = 1.0 / 3.0
    write_report(tmp_path, CASES, judged[::-1], PROGRAM)

    def refuse(text: str) -> None:
        raise AssertionError(text)

    lines = (tmp_path / "results.jsonl").read_text().splitlines()
    records = [json.loads(line, parse_constant=refuse) for line in lines]
    rows = [
        row.label for row, found, _ in sorted(judged, key=lambda item: item[0].line) for _ in found
    ]
    assert [record["row"] for record in records] == rows
    assert [record["cells"] for record in records[:4]] == [8, 16, 32, 64]
    assert records[0]["measures"]["bad"] is None
    assert records[0]["measures"]["long"] == 0.333333333333
    assert records[0]["problem"] == "can't open a.vtk of 1/2"
    assert all("key" not in record for record in records)


def test_failed_runs_have_a_page(tmp_path: Path) -> None:
    """A row of runs that failed before they had points is reported, not drawn."""
    row = make_row(1, (8, 16))
    records = [
        {**parameters.record(), "problem": "exit status 1: bad |\nvalue", "measures": {}}
        for parameters in row.runs(quick=False)
    ]
    finding = Finding("runs to its end", 0.0, 1.0, 1.0, 1.0, records[0]["problem"])
    write_report(tmp_path, CASES, [(row, records, [finding])], PROGRAM)
    page = (tmp_path / "axial_bar.md").read_text()
    assert "| runs to its end |  | 0 | 1 | = 1 | 1 | **no** |" in page
    assert "1. exit status 1: bad | value" in page
    assert not list(tmp_path.glob("*.png"))


def test_untimed_records_give_point_steps_alone(tmp_path: Path) -> None:
    """No time, no column of times."""
    judged = make_judged()
    for _, records, _ in judged:
        for record in records:
            del record["loop_seconds"], record["ns_per_point_step"]
    write_report(tmp_path, CASES, judged, PROGRAM)
    page = (tmp_path / "axial_bar.md").read_text()
    assert "| problem | error | least points times steps |  | next |" in page
    assert "against the time" not in page
    assert "loops" not in (tmp_path / "README.md").read_text()


@pytest.mark.parametrize("draw", [draw_convergence, draw_work, draw_points_per_cell])
def test_figures_are_small_and_as_wide_as_a_page(tmp_path: Path, draw: Any) -> None:
    """PNG files below 150 kB, not empty, white at the rim."""
    problems = find_problems(CASES, make_judged())
    assert draw(tmp_path / "figure.png", problems) == ["figure.png"]
    assert (tmp_path / "figure.png").stat().st_size < 150_000
    picture = matplotlib.image.imread(tmp_path / "figure.png")[..., :3]
    assert picture.shape[1] == round(WIDTH * DPI)
    assert np.mean(picture < 0.9) > 0.01
    rim = [picture[0], picture[-1], picture[:, 0], picture[:, -1]]
    assert min(float(line.min()) for line in rim) > 0.99


def test_many_problems_go_to_several_sheets(tmp_path: Path) -> None:
    """Four problems of a case and TYPE share a panel, twelve panels a sheet."""
    judged: list[Judged] = []
    for line in range(52):
        row = make_row(line, options=[("a", str(line))])
        judged.append((row, make_records(row, lambda n: 1.0 / n), []))
    names = draw_convergence(tmp_path / "figure.png", find_problems(CASES, judged))
    assert names == ["figure.png", "figure_2.png"]
    assert all((tmp_path / name).stat().st_size < 150_000 for name in names)


def test_odd_errors_can_be_drawn(tmp_path: Path) -> None:
    """Constant errors, rising errors, one resolution, an unknown mapping."""
    rows = [
        make_row(1, (8, 16)),
        make_row(2, (8, 16), mapping="spline", contact="other", ppc=7),
        make_row(3, (8,), mapping="cpdi"),
    ]
    errors = (lambda n: 0.03), (lambda n: 1e-9 * n), (lambda n: 0.03)
    judged = [(row, make_records(row, e), []) for row, e in zip(rows, errors, strict=True)]
    problems = find_problems(CASES, judged)
    for draw in (draw_convergence, draw_work):
        assert draw(tmp_path / "figure.png", problems) == ["figure.png"]
    assert draw_points_per_cell(tmp_path / "figure.png", problems) == []
    flat = find_problems(CASES, judged[:1])
    assert draw_convergence(tmp_path / "figure.png", flat) == ["figure.png"]


@pytest.mark.parametrize(
    ("finding", "part"),
    [
        (near("x", 1.02, 1.0, 0.04, ""), 0.5),
        (near("x", 0.99, 1.0, 0.04, ""), 0.25),
        (Finding("x", 1.05, 0.9, 1.1), 0.5),
        (below("x", 0.25, 1.0, ""), 0.25),
        (Finding("x", 1.0, 1.0, 1.0, 1.0), 0.0),
        (Finding("x", 2.0, 0.0, 1.0), math.nan),
        (Finding("x", 2.0, 1.0), math.nan),
        (Finding("x", 2.0), math.nan),
    ],
)
def test_used_part_of_a_tolerance(finding: Finding, part: float) -> None:
    """0 at the expected value, 1 at a bound."""
    assert used(finding) == pytest.approx(part, rel=1e-12, nan_ok=True)


@pytest.mark.parametrize(
    ("finding", "texts"),
    [
        (near("x", 1.02, 1.0, 0.04, ""), ["1.02", "1", "± 4 %"]),
        (near("order of e", 1.96, 2.0, 0.05, ""), ["1.96", "2", "± 0.1"]),
        (Finding("x", 1e-9, -1e-8, 1e-8, 0.0), ["1e-9", "0", "± 1e-8"]),
        (Finding("x", 0.5, 0.25, 0.75), ["0.5", "-", "0.25 … 0.75"]),
        (Finding("x", 0.5, high=0.75), ["0.5", "-", "≤ 0.75"]),
        (Finding("x", 0.5, 0.25), ["0.5", "-", "≥ 0.25"]),
        (below("x", 0.5, 0.75, ""), ["0.5", "-", "≤ 0.75"]),
        (Finding("x", -0.5, 0.0, 0.75), ["-0.5", "-", "0 … 0.75"]),
        (Finding("x", 3.0, 3.0, 3.0, 3.0), ["3", "3", "= 3"]),
        (Finding("x", 1.00001, high=1.0), ["1.00001", "-", "≤ 1"]),
        (Finding("x", 0.123456), ["0.1235", "-", "-"]),
    ],
)
def test_bounds_in_words(finding: Finding, texts: list[str]) -> None:
    """Digits suffice to tell a value from its bounds."""
    assert bound_texts(finding) == texts


def test_findings_of_several_resolutions_are_grouped() -> None:
    """Only those that differ by nothing but the resolution."""
    row = make_row(1, (8, 16))
    names = ["e, 8 cells", "e, 16 cells", "e, 32 cells", "f, 8 cells", "e", "e, l1"]
    findings = [Finding(name, 1.0, 0.0, 2.0, reason="why") for name in names]
    groups = [(base, [place for place, _ in members]) for base, members in grouped(row, findings)]
    assert groups == [
        ("e", ["8", "16"]),
        ("e, 32 cells", [""]),
        ("f", ["8"]),
        ("e", [""]),
        ("e, l1", [""]),
    ]
    findings[1].reason = "another"
    assert [len(members) for _, members in grouped(row, findings)] == [1] * 6


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (1.43153e-7, "1.432e-7"),
        (12345.6, "12350"),
        (2.5e10, "2.5e10"),
        (math.nan, "-"),
        (None, "-"),
        (math.inf, "inf"),
    ],
)
def test_numbers(value: float | None, text: str) -> None:
    """Four digits, short exponents."""
    assert number(value) == text


def test_texts() -> None:
    """Markup and bars of texts are escaped; per cent have two digits."""
    assert text_cell("a | b*c\n <d> [e](f)") == r"a \| b\*c \<d\> [e\](f)"
    assert percent(0.001) == "0.1 %"
    assert percent(0.976) == "98 %"
    assert percent(1.0) == "100 %"
    assert [signed_percent(x) for x in (0.05, -0.05, math.nan)] == ["+5 %", "-5 %", "-"]
    assert slug("A wave, TYPE 2 (wave_2)") == "a-wave-type-2-wave_2"
    assert clean({"a": [1], "b": -math.inf, "key": "x"}) == {"a": [1], "b": None}
