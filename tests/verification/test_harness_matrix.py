"""The matrix: rows, their bounds, and messages about bad ones."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from harness.case import Finding
from harness.matrix import COLUMNS, read_matrix, run_key

HEAD = ",".join(COLUMNS)
GOOD = "bar,2,cpdi,-,3,8 16 32,16 32,nu=0.3 axis=1,order of e_u 1.9..2.05; ratio ..1"


def write(folder: Path, *lines: str) -> Path:
    """Write a matrix."""
    path = folder / "matrix.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_row_is_read(tmp_path: Path) -> None:
    """Comments and empty lines count as lines but are no rows."""
    (row,) = read_matrix(write(tmp_path, "# comment, with comma", HEAD, "", "# more", GOOD))
    assert row.line == 5
    assert (row.case, row.sim_type, row.mapping, row.contact, row.ppc) == ("bar", 2, "cpdi", "-", 3)
    assert (row.cells, row.quick) == ((8, 16, 32), (16, 32))
    assert row.options == (("axis", "1"), ("nu", "0.3"))
    assert row.expect == (("order of e_u", 1.9, 2.05), ("ratio", -math.inf, 1.0))
    assert row.label == "bar, TYPE 2, cpdi, 3 ppc, axis=1, nu=0.3"


def test_label_names_the_rule_of_contact(tmp_path: Path) -> None:
    """Rows that differ in the rule have different labels."""
    (row,) = read_matrix(write(tmp_path, HEAD, "bars,1,linear,explicit,2,8,,,"))
    assert row.label == "bars, TYPE 1, linear, explicit, 2 ppc"


def test_runs_of_the_tiers(tmp_path: Path) -> None:
    """The quick tier is a part of the full one."""
    (row,) = read_matrix(write(tmp_path, HEAD, GOOD))
    assert [p.cells for p in row.runs(quick=False)] == [8, 16, 32]
    quick = row.runs(quick=True)
    assert [p.cells for p in quick] == [16, 32]
    assert quick[0].options == {"axis": "1", "nu": "0.3"}
    assert (quick[0].case, quick[0].sim_type, quick[0].ppc) == ("bar", 2, 3)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("bar,2,cpdi,-,3,8 16,16", "7 columns instead of 9"),
        ("bar,two,cpdi,-,3,8 16,16,,", "two"),
        ("bar,2,cpdi,-,3,8 16.5,,,", "16.5"),
        ("bar,2,cpdi,-,3,8 16,32,,", "quick must be a part"),
        ("bar,2,cpdi,-,3,16 8,8,,", "resolutions must rise"),
        ("bar,2,cpdi,-,3,8 8,8,,", "resolutions must rise"),
        ("bar,2,cpdi,-,3,8,8,nu 0.3,", 'option "nu" is not key=value'),
        ("bar,2,cpdi,-,3,8,8,,order 2", 'bound "order 2" is not: name low..high'),
        ("bar,2,cpdi,-,3,8,8,,1..2", 'bound "1..2" is not: name low..high'),
        ("bar,2,cpdi,-,3,8,8,,order 1..x", "x"),
    ],
)
def test_bad_row_is_named_by_file_and_line(tmp_path: Path, line: str, message: str) -> None:
    """The message says where and what."""
    path = write(tmp_path, "# comment", HEAD, GOOD, line)
    with pytest.raises(ValueError, match=r"matrix\.csv:4: ") as caught:
        read_matrix(path)
    assert str(caught.value).startswith(f"{path}:4: ")
    assert message in str(caught.value)


def test_wrong_head_is_named(tmp_path: Path) -> None:
    """Columns in another order are refused."""
    with pytest.raises(ValueError, match=r"matrix\.csv:2: the columns must be case,type"):
        read_matrix(write(tmp_path, "# comment", "type,case", GOOD))


def test_bounds_of_a_row_replace_those_of_the_case(tmp_path: Path) -> None:
    """A bound without finding fails."""
    (row,) = read_matrix(write(tmp_path, HEAD, GOOD))
    order, other = Finding("order of e_u", 1.0, 0.9, 1.1, 1.0, "why"), Finding("other", 3.0)
    found = {finding.name: finding for finding in row.bound([order, other])}
    assert list(found) == ["order of e_u", "other", "ratio"]
    assert not found["order of e_u"].passed
    assert found["other"].passed
    assert not found["ratio"].passed


def test_key_changes_with_all_that_decides_a_run(tmp_path: Path) -> None:
    """Parameters, sources and timing each make another key; the order of options does not."""
    turned = GOOD.replace("nu=0.3 axis=1", "axis=1 nu=0.3")
    others = GOOD.replace("nu=0.3", "nu=0.2"), GOOD.replace("cpdi", "linear")
    first, same, *rest = read_matrix(write(tmp_path, HEAD, GOOD, turned, *others))
    run = first.runs(quick=False)[0]
    key = run_key(run, "sources", timed=False)
    assert key == run_key(same.runs(quick=False)[0], "sources", timed=False)
    keys = {key, run_key(run, "others", timed=False), run_key(run, "sources", timed=True)}
    keys |= {run_key(p, "sources", timed=False) for p in first.runs(quick=False)[1:]}
    keys |= {run_key(row.runs(quick=False)[0], "sources", timed=False) for row in rest}
    assert len(keys) == 7
