"""A session of the command line: judgement, output, JUnit file."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from harness.__main__ import Session, write_junit
from harness.case import Case, Finding, Results, below, near
from synthetic import make_case, make_record, make_row


def judge(results: Results) -> list[Finding]:
    """Compare the order with 2."""
    return [near("order", results.order("e_u_l2"), 2.0, 0.05, "theory"), Finding("told", 1.0)]


def make_session(case: Case, *, fail_fast: bool = False) -> Session:
    """Return a session of two rows."""
    case.judge = judge
    rows = [make_row(1, (8, 16)), make_row(2, (8, 16), mapping="cpdi")]
    return Session({"bar": case}, rows, quick=False, fail_fast=fail_fast)


def finish_runs(session: Session, order: float, **changes: object) -> list[bool]:
    """Tell a session of its runs, the finest first; return its answers."""
    rows = {row.mapping: row for row in session.rows}
    return [
        session.done(
            p, make_record(rows[p.mapping], p.cells, {"e_u_l2": p.cells**-order}, **changes)
        )
        for p in reversed(session.wanted)
    ]


def test_rows_are_judged_when_their_runs_are_there(capsys: pytest.CaptureFixture[str]) -> None:
    """Lines of the output in the order of the ends, the list in that of the matrix."""
    session = make_session(make_case())
    assert finish_runs(session, 2.0) == [True] * 4
    session.finish()
    assert [row.line for row, _, _ in session.judged] == [1, 2]
    assert [[r["cells"] for r in records] for _, records, _ in session.judged] == [[8, 16]] * 2
    assert session.failures == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:2] == ["1/2", "ok"] and "cpdi" in lines[0] and "1 checks" in lines[0]
    assert lines[-1].startswith("2 of 2 rows, 4 runs, 2 checks, 0 failed")


def test_failed_check_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """With value, bounds and reason."""
    session = make_session(make_case())
    assert finish_runs(session, 1.0) == [True] * 4
    assert session.failures == 2
    output = capsys.readouterr().out
    assert "FAILED bar, TYPE 1, cpdi, 2 ppc" in output
    assert "order = 1, wanted 1.9 .. 2.1 (theory)" in output


def test_fail_fast_stops_at_the_first_failed_row() -> None:
    """The answer to the run that completed the row is no."""
    assert finish_runs(make_session(make_case(), fail_fast=True), 1.0)[:2] == [True, False]


def test_problem_and_exception_fail_the_row(capsys: pytest.CaptureFixture[str]) -> None:
    """What went wrong is the reason."""
    session = make_session(make_case())
    finish_runs(session, 2.0, problem="exit status 1: no memory")
    assert session.failures == 2
    assert "runs to its end = 0" in capsys.readouterr().out
    session = make_session(make_case())
    session.cases["bar"].judge = lambda results: [below("x", results.column("none")[0], 1.0, "")]
    finish_runs(session, 2.0)
    assert session.failures == 2
    assert "can be judged = 0" in (output := capsys.readouterr().out)
    assert "KeyError: 'none'" in output


def test_junit_file_has_a_test_a_row(tmp_path: Path) -> None:
    """Failures carry the findings."""
    session = make_session(make_case())
    finish_runs(session, 1.0)
    path = tmp_path / "new" / "results.xml"
    write_junit(path, session)
    suite = ElementTree.parse(path).getroot()
    assert (suite.get("tests"), suite.get("failures")) == ("2", "2")
    assert {test.get("name") for test in suite} == {row.label for row in session.rows}
    assert all("wanted 1.9 .. 2.1" in test.find("failure").get("message") for test in suite)
