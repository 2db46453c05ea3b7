"""The optimized program asks for the points ahead by instructions of the processor."""

from __future__ import annotations

import platform
import shutil
import subprocess
from pathlib import Path

import pytest
from scene import Run

#: Procedure whose loop the compiler puts them into.
PROCEDURE = "__mpm_prefetch_MOD_prefetch_rows"
#: What they are called.
INSTRUCTIONS = {"x86_64": "prefetch", "aarch64": "prfm"}


def test_prefetch_instructions(executable: Path, mpm3d: Run, tmp_path: Path) -> None:
    """A compiler that leaves them out would only be seen by the time that a step takes."""
    version = mpm3d("--version", cwd=tmp_path).stdout
    if "GNU" not in version or "Release" not in version:
        pytest.skip("only gfortran is asked to make them, and only in the Release build")
    name = INSTRUCTIONS.get(platform.machine())
    if name is None or shutil.which("objdump") is None:
        pytest.skip("no name of the instructions, or no objdump")
    listing = subprocess.run(
        ["objdump", "--no-show-raw-insn", f"--disassemble={PROCEDURE}", str(executable)],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    assert PROCEDURE in listing
    assert name in listing.split(f"<{PROCEDURE}>:")[1].replace(PROCEDURE, "")
