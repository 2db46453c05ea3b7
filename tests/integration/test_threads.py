"""Where the number of threads comes from."""

from __future__ import annotations

from pathlib import Path

import pytest
from scene import Run, drop_scene


@pytest.mark.parametrize(
    ("job", "environment", "options", "threads"),
    [
        pytest.param("", "3", [], "3 threads", id="environment"),
        pytest.param("", "1", [], "1 thread", id="environment-1"),
        pytest.param("threads = 0", "3", [], "3 threads", id="job-0-means-environment"),
        pytest.param("threads = 2", "3", [], "2 threads", id="job"),
        pytest.param("threads = 1", "3", [], "1 thread", id="job-1"),
        pytest.param("threads = 2", "3", ["--threads", "4"], "4 threads", id="option"),
        pytest.param("", "3", ["--set", "job.threads=2"], "2 threads", id="set"),
    ],
)
def test_threads(
    mpm3d: Run, tmp_path: Path, job: str, environment: str, options: list[str], threads: str
) -> None:
    """The option, then `threads` of the job, then OMP_NUM_THREADS."""
    drop_scene(job=job).write(tmp_path)
    result = mpm3d(
        "-c", "scene.cfg", *options, cwd=tmp_path, environment={"OMP_NUM_THREADS": environment}
    )
    assert (result.returncode, result.stderr) == (0, "")
    assert f"running 10 steps on {threads}\n" in result.stdout
