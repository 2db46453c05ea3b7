"""VTKHDF files on a file system that has no second names of files (hard links), such as FAT."""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest
from checkpoints import contents
from scene import drop_scene

#: Numbers of the calls `link` and `linkat` by machine.
CALLS = {"x86_64": (86, 265), "aarch64": (37,)}
#: PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP with a filter; what a filter says: go ahead, or an error.
NO_NEW_PRIVILEGES, SECCOMP, FILTER = 38, 22, 2
ALLOW, ERROR = 0x7FFF0000, 0x00050000
LOAD, JUMP_IF_EQUAL, RETURN = 0x20, 0x15, 0x06
HDF = (
    *("--set", "serializer.class=VTKHDF"),
    *("--set", "serializer.int-properties={nodes = 1}"),
    *("--set", 'serializer.str-properties={"hdf", "save", "test"}'),
)

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() not in CALLS, reason="numbers of system calls"
)


def forbid_links() -> None:
    """Let the kernel refuse the calls of link with EPERM, as such a file system does."""
    calls = CALLS[platform.machine()]
    rules = [(LOAD, 0, 0, 0)]
    rules += [(JUMP_IF_EQUAL, len(calls) - k, 0, call) for k, call in enumerate(calls)]
    rules += [(RETURN, 0, 0, ALLOW), (RETURN, 0, 0, ERROR | errno.EPERM)]
    code = ctypes.create_string_buffer(b"".join(struct.pack("HBBI", *rule) for rule in rules))
    program = ctypes.create_string_buffer(struct.pack("HP", len(rules), ctypes.addressof(code)))
    libc = ctypes.CDLL(None, use_errno=True)
    for call in (
        (NO_NEW_PRIVILEGES, 1, 0, 0, 0),
        (SECCOMP, FILTER, ctypes.addressof(program), 0, 0),
    ):
        if libc.prctl(*map(ctypes.c_ulong, call)) != 0:
            raise OSError(ctypes.get_errno(), "prctl")


def test_links_are_refused(tmp_path: Path) -> None:
    """The filter does what the other tests need."""
    (tmp_path / "a").write_text("")
    command = [sys.executable, "-c", "import os; os.link('a', 'b')"]
    result = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, preexec_fn=forbid_links
    )
    assert "PermissionError" in result.stderr
    assert os.listdir(tmp_path) == ["a"]


def test_same_series(executable: Path, tmp_path: Path) -> None:
    """The files are those of a file system that has links, with no leftovers."""
    found = []
    for name, limit in (("with", None), ("without", forbid_links)):
        folder = tmp_path / name
        drop_scene(rate=200.0, t_stop=0.05).write(folder)
        command = [str(executable), "-c", "scene.cfg", "-q", *HDF]
        result = subprocess.run(
            [*command, "--set", "serializer.properties={200}"],
            cwd=folder,
            capture_output=True,
            text=True,
            preexec_fn=limit,
        )
        assert (result.returncode, result.stderr) == (0, "")
        found.append({path.name: contents(path) for path in (folder / "hdf").iterdir()})
    assert sorted(found[0]) == ["nodes.0.drop.vtkhdf", "points.0.drop.vtkhdf"]
    assert found[0] == found[1]


@pytest.mark.parametrize("wait", [0.0, 0.02, 0.1])
def test_whole_when_killed(executable: Path, tmp_path: Path, wait: float) -> None:
    """The name leads to a whole file at each instant."""
    drop_scene(rate=1e3, t_stop=1e3).write(tmp_path)
    path = tmp_path / "hdf" / "points.0.drop.vtkhdf"
    command = [str(executable), "-c", "scene.cfg", "-q", *HDF]
    command += ["--set", "serializer.properties={1e3}"]
    with subprocess.Popen(command, cwd=tmp_path, preexec_fn=forbid_links) as process:
        deadline = time.monotonic() + 60.0
        while not path.exists() or path.stat().st_size < 40000:
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.01)
        time.sleep(wait)
        process.send_signal(signal.SIGKILL)
        process.wait()
    values = contents(path)
    steps = len(values["VTKHDF/Steps/Values"]) // 8
    assert steps > 0
    assert len(values["VTKHDF/PointData/mass"]) >= steps * 16 * 8
