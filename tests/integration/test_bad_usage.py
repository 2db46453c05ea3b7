"""Wrong command lines: exit code 1, and no frame."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from bad_input import BAD_INPUT, USAGE, expect_failure, write_scene
from scene import Run


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        pytest.param([], USAGE, "nothing to do", id="nothing"),
        pytest.param(["-c"], USAGE, "-c needs a config file", id="no-file"),
        pytest.param(["-c", ""], USAGE, "-c needs a config file", id="empty-file"),
        pytest.param(["scene.cfg"], USAGE, 'unexpected argument "scene.cfg"', id="no-option"),
        pytest.param(["--check"], USAGE, "--check needs a config", id="check-alone"),
        pytest.param(["--estimate"], USAGE, "--estimate needs a config", id="estimate-alone"),
        pytest.param(
            ["-c", "scene.cfg", "--check", "--estimate"],
            USAGE,
            "--check and --estimate exclude each other",
            id="check-and-estimate",
        ),
        pytest.param(["--chekc"], USAGE, "did you mean --check?", id="misspelt"),
        pytest.param(
            ["-r", "save/a.h5", "-c", "scene.cfg"],
            USAGE,
            "-c and -r exclude each other",
            id="config-and-restart",
        ),
        pytest.param(["-r"], USAGE, "-r needs a checkpoint", id="restart-without-file"),
        pytest.param(["--" + 5000 * "x"], USAGE, "unknown option", id="long-option"),
        pytest.param(["--check", "--version"], USAGE, "exclude each other", id="two-actions"),
        pytest.param(["--describe"], USAGE, "--describe needs a class", id="describe-nothing"),
        pytest.param(["--describe", "Nothing"], USAGE, "there is no class", id="describe-unknown"),
        pytest.param(
            ["--describe", "ContactHuan"], USAGE, 'did you mean "ContactHuang"?', id="describe-near"
        ),
        pytest.param(["--describe-run"], USAGE, "--describe-run needs a file", id="run-nothing"),
        pytest.param(["--list", "things"], USAGE, "things", id="list-unknown"),
        pytest.param(
            ["-c", "scene.cfg", "--threads", "0"], USAGE, "not a number from 1", id="threads-0"
        ),
        pytest.param(
            ["-c", "scene.cfg", "--threads", "2.5"], USAGE, "not a number from 1", id="threads-real"
        ),
        pytest.param(
            ["-c", "scene.cfg", "--threads", "-2"], USAGE, "not a number from 1", id="threads-neg"
        ),
        pytest.param(["-c", "scene.cfg", "--threads"], USAGE, "needs a number", id="threads-none"),
        pytest.param(
            ["-c", "scene.cfg", "--threads", "99999"], USAGE, "not a number", id="threads-many"
        ),
        pytest.param(
            ["-c", "scene.cfg", "--max-memory"], USAGE, "needs a size", id="memory-nothing"
        ),
        pytest.param(
            ["-c", "scene.cfg", "--max-memory", "0"], USAGE, "not a size above 0", id="memory-0"
        ),
        pytest.param(
            ["-c", "scene.cfg", "--max-memory", "8 G"], USAGE, "not a size above 0", id="memory-two"
        ),
        pytest.param(["-c", "scene.cfg", "--set"], USAGE, "--set needs", id="set-nothing"),
        pytest.param(
            ["-c", "scene.cfg", "--set", "dt=1"],
            USAGE,
            "not section.key=value",
            id="set-no-section",
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "job.dt"],
            USAGE,
            "not section.key=value",
            id="set-no-value",
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "job.dt="],
            BAD_INPUT,
            '--set job.dt=: error: "dt" takes one value',
            id="set-empty",
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "jbo.dt=1"], USAGE, 'no section "jbo"', id="set-section"
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "body.third.properties={}"],
            USAGE,
            'no section "body.third"',
            id="set-body",
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "body.name=x"], USAGE, 'no section "body"', id="set-which"
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "grid.properties={1, 2"],
            USAGE,
            "never closed",
            id="set-unclosed",
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "job.dt=1 job.t=2"],
            USAGE,
            "unexpected",
            id="set-two",
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "job.dt=0"],
            BAD_INPUT,
            "--set job.dt=0: error: dt = 0 is not a time step",
            id="set-bad-value",
        ),
        pytest.param(
            ["-c", "scene.cfg", "--set", "job.step=1"],
            BAD_INPUT,
            'unknown key "step"',
            id="set-unknown-key",
        ),
    ],
)
def test_bad_command_line(
    mpm3d: Run, tmp_path: Path, arguments: list[str], code: int, message: str
) -> None:
    """Wrong usage has its own exit code; a bad value of --set is bad input."""
    write_scene(tmp_path)
    result = mpm3d(*arguments, cwd=tmp_path)
    assert re.match(r"(--set .*: |scene\.cfg:\d+: )?error: ", result.stderr), result.stderr
    assert result.stdout == ""
    expect_failure(result, tmp_path, code, result.stderr[: result.stderr.index("error: ")], message)
