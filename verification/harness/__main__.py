"""Command line of the harness; `scripts/verify --help` shows it."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from .case import Case, Finding, Parameters, Results, load_cases
from .matrix import Row, read_matrix
from .report import write_report
from .runner import Program, Records, run_all

ROOT = Path(__file__).resolve().parent.parent.parent


def main() -> int:
    """Run a tier of the matrix and judge it; return the exit status."""
    arguments = parse_arguments()
    cases, rows = load_cases(), read_matrix()
    unknown = sorted({row.case for row in rows} - set(cases))
    if unknown:
        sys.exit(f"scripts/verify: the matrix names cases without a file: {', '.join(unknown)}")
    if arguments.list:
        # A reader that has seen enough, such as head, ends the list without a traceback.
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
        list_cases(cases, rows)
        return 0
    chosen = [row for row in rows if is_chosen(row, cases[row.case], arguments)]
    if not chosen:
        sys.exit("scripts/verify: no row of the matrix matches")
    program = Program.find(arguments.program)
    tier = "quick" if arguments.quick else "full"
    records = Records(arguments.records / f"{tier}.jsonl", fresh=arguments.fresh)
    timed = arguments.timed or (not arguments.quick and not arguments.untimed)
    session = Session(cases, chosen, arguments.quick, fail_fast=arguments.fail_fast)
    run_all(
        program,
        session.wanted,
        records,
        jobs=arguments.jobs,
        timed=timed,
        cheapest_first=arguments.fail_fast,
        done=session.done,
    )
    session.finish()
    if arguments.junit is not None:
        write_junit(arguments.junit, session)
    whole = not (arguments.quick or arguments.names or arguments.type)
    report = arguments.report or (ROOT / "docs/verification" if whole else None)
    if report is not None:
        write_report(report, cases, session.judged, program)
        print(f"report: {report}")
    return 1 if session.failures else 0


def parse_arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(
        prog="scripts/verify",
        description="Check the program against analytic answers, as verification/matrix.csv says.",
    )
    parser.add_argument("names", nargs="*", help="cases or families; all when left out")
    parser.add_argument("--quick", action="store_true", help="the quick tier: part of scripts/test")
    parser.add_argument("--list", action="store_true", help="list families, cases and rows")
    parser.add_argument("--type", type=int, help="only rows of this simulation TYPE")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at a time")
    parser.add_argument("--fresh", action="store_true", help="repeat runs that have a record")
    parser.add_argument("--fail-fast", action="store_true", help="stop at the first failed row")
    parser.add_argument("--timed", action="store_true", help="quick tier: also time the runs")
    parser.add_argument("--untimed", action="store_true", help="full matrix: do not time the runs")
    parser.add_argument(
        "--program",
        type=Path,
        default=ROOT / "build/release/bin/mpm3d-verification",
        help="the program under test",
    )
    parser.add_argument(
        "--records",
        type=Path,
        default=ROOT / "build/verification",
        help="folder of the records, a JSON line a run",
    )
    parser.add_argument(
        "--report", type=Path, help="write page, figures and records to this folder"
    )
    parser.add_argument("--junit", type=Path, help="write a JUnit file with a test a row")
    return parser.parse_args()


def is_chosen(row: Row, case: Case, arguments: argparse.Namespace) -> bool:
    """Tell whether a row takes part."""
    if arguments.quick and not row.quick:
        return False
    if arguments.type is not None and row.sim_type != arguments.type:
        return False
    names = {row.case, case.family.lower().replace(" ", "_"), case.family}
    return not arguments.names or bool(names & set(arguments.names))


def list_cases(cases: dict[str, Case], rows: list[Row]) -> None:
    """Print families, cases and rows."""
    for family in sorted({case.family for case in cases.values()}):
        print(family)
        for name, case in cases.items():
            if case.family != family:
                continue
            print(f"  {name}: {case.title}")
            for row in rows:
                if row.case == name:
                    cells = " ".join(str(n) + "q" * (n in row.quick) for n in row.cells)
                    print(f"    {row.label.partition(', ')[2]}: {cells}")


class Session:
    """Collects finished runs; judges and prints each row as soon as all of its runs are there."""

    def __init__(
        self, cases: dict[str, Case], rows: list[Row], quick: bool, *, fail_fast: bool
    ) -> None:
        self.cases = cases
        self.fail_fast = fail_fast
        self.runs = {row.line: row.runs(quick) for row in rows}
        self.rows = rows
        self.records: dict[str, dict[str, Any]] = {}
        self.judged: list[tuple[Row, list[dict[str, Any]], list[Finding]]] = []
        self.waiting = {row.line: row for row in rows}
        self.failures = 0
        self.begin = time.perf_counter()

    @property
    def wanted(self) -> list[Parameters]:
        """All runs, each once."""
        unique = {repr(p.record()): p for runs in self.runs.values() for p in runs}
        return list(unique.values())

    def done(self, parameters: Parameters, record: dict[str, Any]) -> bool:
        """Take a finished run; return whether to go on."""
        self.records[repr(parameters.record())] = record
        for row in list(self.waiting.values()):
            keys = [repr(p.record()) for p in self.runs[row.line]]
            if all(key in self.records for key in keys):
                del self.waiting[row.line]
                self.judge(row, [self.records[key] for key in keys])
        return not (self.fail_fast and self.failures)

    def judge(self, row: Row, records: list[dict[str, Any]]) -> None:
        """Judge a row and print it."""
        problems = [record["problem"] for record in records if record["problem"]]
        if problems:
            findings = [Finding("runs to its end", 0.0, 1.0, 1.0, 1.0, problems[0])]
        else:
            results = Results(self.runs[row.line], [record["measures"] for record in records])
            try:
                findings = row.bound(self.cases[row.case].judge(results))
            except Exception as problem:
                text = f"{type(problem).__name__}: {problem}"
                findings = [Finding("can be judged", 0.0, 1.0, 1.0, 1.0, text)]
        self.judged.append((row, records, findings))
        failed = [finding for finding in findings if not finding.passed]
        self.failures += len(failed)
        seconds = sum(record.get("seconds", 0.0) for record in records)
        number = f"{len(self.judged)}/{len(self.rows)}"
        asserted = sum(finding.is_asserted for finding in findings)
        verdict = "FAILED" if failed else "ok"
        print(
            f"{number:>9}  {verdict:6} {row.label}: {asserted} checks, {seconds:.1f} s", flush=True
        )
        for finding in failed:
            print(f"           {describe(finding)}", flush=True)

    def finish(self) -> None:
        """Print the sum of it all; a row that was not judged has failed, unless asked to stop."""
        self.judged.sort(key=lambda item: item[0].line)
        if not self.fail_fast:
            self.failures += len(self.waiting)
        checks = sum(f.is_asserted for _, _, findings in self.judged for f in findings)
        print(
            f"{len(self.judged)} of {len(self.rows)} rows, {len(self.records)} runs, "
            f"{checks} checks, {self.failures} failed, {time.perf_counter() - self.begin:.0f} s"
        )


def write_junit(path: Path, session: Session) -> None:
    """Write a JUnit file: a test for each row, failed when one of its findings is."""
    suite = ElementTree.Element("testsuite", name="verification", tests=str(len(session.judged)))
    failures = 0
    for row, records, findings in session.judged:
        seconds = sum(record.get("seconds", 0.0) for record in records)
        test = ElementTree.SubElement(
            suite, "testcase", classname=row.case, name=row.label, time=f"{seconds:.3f}"
        )
        failed = [describe(finding) for finding in findings if not finding.passed]
        failures += bool(failed)
        if failed:
            ElementTree.SubElement(test, "failure", message=failed[0]).text = "\n".join(failed)
    suite.set("failures", str(failures))
    path.parent.mkdir(parents=True, exist_ok=True)
    ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)


def describe(finding: Finding) -> str:
    """Return a line about a finding."""
    return (
        f"{finding.name} = {finding.value:.6g}, wanted {finding.low:.6g} .. {finding.high:.6g}"
        f" ({finding.reason})"
    )


if __name__ == "__main__":
    sys.exit(main())
