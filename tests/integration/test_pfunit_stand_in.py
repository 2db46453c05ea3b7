"""The stand-in for pFUnit (tests/pfunit): what passes, fails and is refused."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

STAND_IN = Path(__file__).resolve().parents[1] / "pfunit"
# Traps, as in the Debug build: comparing a NaN must not end a test program.
FLAGS = [
    "-std=f2008",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-ffree-line-length-none",
    "-ffpe-trap=invalid",
]
MODULES = ("pf_context", "pf_assert_equal", "pf_assert_true", "funit")

Result = subprocess.CompletedProcess[str]


def run(*command: object, cwd: Path) -> Result:
    """Run a command and keep what it prints."""
    return subprocess.run([*map(str, command)], cwd=cwd, capture_output=True, text=True)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the compiled module `funit`."""
    folder = tmp_path_factory.mktemp("funit")
    sources = [STAND_IN / f"{module}.f90" for module in MODULES]
    compiled = run("gfortran", *FLAGS, "-c", *sources, cwd=folder)
    assert compiled.returncode == 0, compiled.stderr
    return folder


@pytest.fixture
def run_pf(library: Path, tmp_path: Path) -> Callable[[str], Result]:
    """Return a function that runs a .pf text through preprocessor, compiler and program."""

    def run_text(text: str) -> Result:
        preprocessed = preprocess(text, tmp_path)
        assert preprocessed.returncode == 0, preprocessed.stderr
        objects = [library / f"{module}.o" for module in MODULES]
        options = [*FLAGS, f"-I{library}", "-o", "test_x"]
        compiled = run("gfortran", *options, "test_x.f90", *objects, cwd=tmp_path)
        if compiled.returncode != 0:
            return compiled
        return run(tmp_path / "test_x", cwd=tmp_path)

    return run_text


def preprocess(text: str, folder: Path) -> Result:
    """Write test_x.pf and run the preprocessor on it."""
    (folder / "test_x.pf").write_text(text)
    command = (sys.executable, STAND_IN / "pf_preprocess.py", "test_x.pf", "test_x.f90")
    return run(*command, cwd=folder)


def module_of(*body: str, declarations: str = "") -> str:
    """Return a .pf file with one test; its first line of the body is line 11."""
    head = f"""module test_x
  use, intrinsic :: ieee_arithmetic
  use, intrinsic :: iso_fortran_env, only: int64, wp => real64
  use funit
  implicit none
  {declarations}
contains
  @test
  subroutine test_one()
    real(wp), parameter :: pi(3) = [3.0_wp, 1.0_wp, 4.0_wp]
"""
    tail = """
    if (pi(1) < 0.0_wp .or. 1_int64 < 0) return
  end subroutine test_one
end module test_x
"""
    return head + "\n".join(body) + tail


PASSING = [
    "@assertEqual(3, 3)",
    "@assertEqual(3_int64, 3_int64, 'huge numbers')",
    "@assertEqual(1.0_wp, 1.0_wp + 1e-9_wp, tolerance=1e-8_wp, message='near')",
    "@assertEqual(1.0_wp, 1.5_wp, 'at the limit', tolerance=0.5_wp)",
    "@assertEqual([1, 2], [1, 2])",
    "@assertEqual(reshape([1, 2, 3, 4], [2, 2]), reshape([1, 2, 3, 4], [2, 2]))",
    "@assertEqual([1_int64, 2_int64], [1_int64, 2_int64])",
    "@assertEqual(pi, pi + 1e-9_wp, tolerance=1e-8_wp)",
    "@assertEqual(reshape(pi, [1, 3]), reshape(pi, [1, 3]))",
    "@assertEqual(7, [7, 7, 7])",
    "@assertEqual(0.0_wp, 0*pi)",
    "@assertEqual(0.0_wp, reshape(0*pi, [3, 1]))",
    "@assertEqual(5.0_wp, pi(:0))",
    "@assertEqual('a, b) ''c'' \"d', 'a, b) ''c'' \"d')",
    "@assertTrue(size(pi) == 3)",
    "@assertFalse(all([.true., .false.]), message='not all')",
    "@assertLessThan(1, 2)",
    "@assertLessThan(1.0_wp, 2.0_wp)",
    "@assertLessThanOrEqual(2, 2)",
    "@assertGreaterThan(3_int64, 2_int64)",
    "@assertGreaterThanOrEqual(2.0_wp, 2.0_wp, 'message')",
    "@ASSERTTRUE (.true.)",
    "@assertEqual(ieee_value(1.0_wp, ieee_positive_inf), ieee_value(1.0_wp, ieee_positive_inf))",
]


def test_assertions_that_hold_pass(run_pf: Callable[[str], Result]) -> None:
    """Every assertion of the subset passes when it holds."""
    result = run_pf(module_of(*PASSING))
    assert result.returncode == 0, result.stdout + result.stderr
    assert "test_x.test_one: ok" in result.stdout
    assert "test_x: 1 passed, 0 failed" in result.stdout


NAN = "ieee_value(1.0_wp, ieee_quiet_nan)"
INFINITY = "ieee_value(1.0_wp, ieee_positive_inf)"
FAILING = [
    ("@assertEqual(3, 4)", "expected 3, found 4"),
    ("@assertEqual(3_int64, 4_int64)", "expected 3, found 4"),
    ("@assertEqual(1.0_wp, 1.0_wp + epsilon(1.0_wp))", "tolerance 0.0"),
    ("@assertEqual(1.0_wp, 1.25_wp, tolerance=0.125_wp)", "expected 1.0"),
    ("@assertEqual([1, 2], [1, 3])", "expected 2, found 3 at (2)"),
    (
        "@assertEqual(reshape([1, 2, 3, 4], [2, 2]), reshape([1, 2, 5, 4], [2, 2]))",
        "expected 3, found 5 at (1, 2)",
    ),
    ("@assertEqual([1, 2], [1, 2, 3])", "expected shape 2, found shape 3"),
    ("@assertEqual(reshape(pi, [1, 3]), reshape(pi, [3, 1]))", "expected shape 1 x 3"),
    ("@assertEqual(3.0_wp, pi)", "at (2)"),
    ("@assertEqual(7, reshape([7, 8], [2, 1]))", "expected 7, found 8 at (2, 1)"),
    ("@assertEqual('a', 'b')", 'expected "a", found "b"'),
    ("@assertEqual('a', 'a ')", 'expected "a", found "a "'),
    ("@assertTrue(1 > 2, message='my words')", "my words"),
    ("@assertFalse(1 < 2)", "expected false, found true"),
    ("@assertLessThan(2, 2)", "expected 2 < 2"),
    ("@assertLessThanOrEqual(3.0_wp, 2.0_wp)", "<="),
    ("@assertGreaterThan(2_int64, 2_int64)", "expected 2 > 2"),
    ("@assertGreaterThanOrEqual(1, 2)", "expected 1 >= 2"),
    (f"@assertEqual(1.0_wp, {NAN}, tolerance=1e9_wp)", "found NaN"),
    (f"@assertEqual({NAN}, {NAN})", "found NaN"),
    (f"@assertLessThan({NAN}, 1.0_wp)", "NaN < 1.0"),
    (f"@assertEqual(1.0_wp, {INFINITY}, tolerance={INFINITY})", "Infinity"),
]


def test_assertions_that_do_not_hold_fail(run_pf: Callable[[str], Result]) -> None:
    """Every failure names the line, says what was found, and fails the program."""
    tests = "".join(
        f"  @test\n  subroutine test_{i}()\n    {assertion}\n  end subroutine test_{i}\n"
        for i, (assertion, _) in enumerate(FAILING)
    )
    text = module_of("    @assertTrue(.true.)")
    constant = "    real(wp), parameter :: pi(3) = [3.0_wp, 1.0_wp, 4.0_wp]\n"
    text = text.replace(constant, "").replace("contains", f"{constant}contains")
    result = run_pf(text.replace("end module", tests + "end module"))
    assert result.returncode == 1, result.stderr
    assert f"test_x: 1 passed, {len(FAILING)} failed" in result.stdout
    blocks = result.stdout.split("test_x.test_")
    for i, (assertion, expected) in enumerate(FAILING):
        (block,) = (block for block in blocks if block.startswith(f"{i}: "))
        line = (tests.splitlines().index(f"    {assertion}")) + 14
        assert block.startswith(f"{i}: FAILED"), assertion
        assert f"test_x.pf:{line}: " in block, assertion
        assert expected in block, assertion


def test_a_failed_assertion_ends_the_test(run_pf: Callable[[str], Result]) -> None:
    """As in pFUnit, the test returns; what follows does not run."""
    body = ("    @assertTrue(.false.)", "    print '(a)', 'went on'", "    @assertTrue(.false.)")
    result = run_pf(module_of(*body))
    assert result.returncode == 1
    assert "went on" not in result.stdout
    assert "test_x.pf:11: " in result.stdout
    assert "test_x.pf:13: " not in result.stdout


def test_before_and_after_surround_each_test(run_pf: Callable[[str], Result]) -> None:
    """A failing test does not keep the next from running; @after runs all the same."""
    result = run_pf("""module test_x
  use funit
  implicit none
contains
  @before
  subroutine set_up()
    print '(a)', 'before'
  end subroutine set_up
  @after
  subroutine tear_down()
    print '(a)', 'after'
  end subroutine tear_down
  @Test
  subroutine test_one ! a comment
    @assertEqual(1, 2)
  end subroutine test_one
  @test
  subroutine test_two()
    call helper(2)
  end subroutine test_two
  subroutine helper(n)
    integer, intent(in) :: n
    @assertEqual(2, n)
  end subroutine helper
end module test_x
""")
    assert result.returncode == 1
    assert result.stdout.count("before") == 2
    assert result.stdout.count("after") == 2
    assert "test_x: 1 passed, 1 failed" in result.stdout


def test_a_test_does_not_run_when_before_failed(run_pf: Callable[[str], Result]) -> None:
    """A failure in @before fails the test and skips it."""
    text = module_of("    print '(a)', 'test ran'")
    before = "  @before\n  subroutine set_up()\n    @assertTrue(.false.)\n  end subroutine set_up\n"
    result = run_pf(text.replace("end module", before + "end module"))
    assert result.returncode == 1
    assert "test ran" not in result.stdout
    assert "0 passed, 1 failed" in result.stdout


def test_no_test_is_a_failure(run_pf: Callable[[str], Result]) -> None:
    """A program without a test fails."""
    result = run_pf("module test_x\n  implicit none\nend module test_x\n")
    assert result.returncode == 1
    assert "no test" in result.stdout


def test_compiler_errors_name_the_line_of_the_pf_file(run_pf: Callable[[str], Result]) -> None:
    """Line markers lead back to the .pf file, in assertions and behind them."""
    result = run_pf(module_of("    @assertEqual(1, 'one')"))
    assert "test_x.pf:11:" in result.stderr
    result = run_pf(module_of("    @assertEqual(1, 1)", "    call nowhere(undeclared)"))
    assert "test_x.pf:12:" in result.stderr


MALFORMED = [
    (module_of("@assertNaN(pi(1))"), 11, "unknown directive @assertNaN"),
    (module_of("@assertEqual(1)"), 11, "compares 2 value(s)"),
    (module_of("@assertEqual(1, 2, 'a', 0.1)"), 11, "compares 2 value(s)"),
    (module_of("@assertEqual(1, 2, tol=1)"), 11, "no argument tol"),
    (module_of("@assertTrue(a, tolerance=1)"), 11, "no argument tolerance"),
    (module_of("@assertEqual(1, message='a', 2)"), 11, "follows a named one"),
    (module_of("@assertEqual(1, , 2)"), 11, "is empty"),
    (module_of("@assertTrue()"), 11, "is empty"),
    (module_of("@assertTrue"), 11, "needs arguments"),
    (module_of("@assertEqual(1, &", "  2)"), 11, "stands on one line"),
    (module_of("@assertEqual('a, 'a')"), 11, "is not closed"),
    (module_of("@assertTrue(.true.) ! because"), 11, "nothing may follow"),
    (module_of("@assertTrue(.true.)" + 120 * " " + "!"), 11, "longer than 126 columns"),
    (module_of("").replace("@test", "@test(ifdef=X)"), 8, "stands alone"),
    (module_of("").replace("@test", "@test\n"), 8, "must be followed"),
    (module_of("").replace("test_one()", "test_one(n)"), 8, "must be followed"),
    (module_of("").replace("test_one", 45 * "n"), 9, "longer than 44 characters"),
    (module_of("").replace("@test", "@mpiTest"), 8, "unknown directive @mpiTest"),
    (module_of("").replace("test_x", "test_y"), 1, "named like the file: test_x"),
    (module_of("") + "module test_z\nend module\n", 15, "a second module"),
    (module_of("") + "@before\nsubroutine a()\n@before\nsubroutine b()", 17, "a second @before"),
    (module_of("") + "@test", 15, "must be followed"),
    ("program a\nend program a\n", 2, "no module"),
]


@pytest.mark.parametrize(("text", "line", "message"), MALFORMED, ids=[m[2] for m in MALFORMED])
def test_malformed_files_are_refused(text: str, line: int, message: str, tmp_path: Path) -> None:
    """The preprocessor names file, line and fault, and writes nothing."""
    result = preprocess(text, tmp_path)
    assert result.returncode == 1
    assert f"test_x.pf:{line}: error: " in result.stderr
    assert message in result.stderr
    assert not (tmp_path / "test_x.f90").exists()
