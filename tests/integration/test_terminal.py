"""What people meet at a terminal: colours, estimates of run time, completion."""

from __future__ import annotations

import os
import pty
import re
import subprocess
from pathlib import Path

import pytest
from scene import Body, Run, block, drop_scene

ROOT = Path(__file__).resolve().parents[2]
COMPLETION = ROOT / "src/app/mpm3d.bash"


def on_terminal(executable: Path, folder: Path, *arguments: str, **environment: str) -> str:
    """Return what the program writes to a terminal as its standard error."""
    master, slave = pty.openpty()
    plain = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "TERM")}
    subprocess.run(
        [executable, *arguments],
        cwd=folder,
        env={**plain, "TERM": "xterm", **environment},
        stdout=subprocess.DEVNULL,
        stderr=slave,
        check=False,
    )
    os.close(slave)
    text = b""
    while True:
        try:
            part = os.read(master, 4096)
        except OSError:
            break
        if not part:
            break
        text += part
    os.close(master)
    return text.decode().replace("\r\n", "\n")


def test_colours_of_errors(executable: Path, mpm3d: Run, tmp_path: Path) -> None:
    """An error is red on a terminal, and plain with NO_COLOR, on a dumb terminal and in a file."""
    plain = mpm3d("-c", "none.cfg", cwd=tmp_path).stderr
    assert plain.startswith("none.cfg: error: ")
    coloured = on_terminal(executable, tmp_path, "-c", "none.cfg")
    assert coloured == plain.replace("error:", "\033[1;31merror:\033[0m", 1)
    for environment in ({"NO_COLOR": "1"}, {"TERM": "dumb"}, {"TERM": ""}):
        assert on_terminal(executable, tmp_path, "-c", "none.cfg", **environment) == plain
    # As no-color.org has it, an empty variable says nothing.
    assert on_terminal(executable, tmp_path, "-c", "none.cfg", NO_COLOR="") == coloured


def test_colours_of_warnings(executable: Path, tmp_path: Path) -> None:
    """A warning is yellow."""
    drop_scene(dt=0.01, t_stop=0.02).write(tmp_path)
    text = on_terminal(executable, tmp_path, "-c", "scene.cfg")
    assert text.startswith("\033[1;33mwarning:\033[0m dt = 0.01 s is above the stable step")


def test_estimate(mpm3d: Run, tmp_path: Path) -> None:
    """A few steps are timed, and nothing is written."""
    body = Body("drop", block(2, [0.4, 0.6], [0.6, 0.8], [40, 40]))
    scene = drop_scene(bodies=[body], dt=1e-4, t_stop=10.0, rate=1.0)
    scene.write(tmp_path)
    before = sorted(path.name for path in tmp_path.iterdir())
    result = mpm3d("-c", "scene.cfg", "--estimate", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert sorted(path.name for path in tmp_path.iterdir()) == before
    told = re.search(
        r"^estimate: (.+) for 100000 steps on 1 thread, frames not counted "
        r"\((\d+) steps took (\S+) s\)$",
        result.stdout,
        re.MULTILINE,
    )
    assert told, result.stdout
    seconds = 1e5 * float(told[3]) / int(told[2])
    given = re.fullmatch(r"(?:(\d+) h )?(?:(\d+) min ?)?(?:(\S+) s)?", told[1])
    assert given
    hours, minutes, rest = (float(value or 0) for value in given.groups())
    # Numbers are rounded to three digits or whole minutes.
    assert 3600 * hours + 60 * minutes + rest == pytest.approx(seconds, rel=0.02, abs=60)


def test_estimate_of_a_short_run(mpm3d: Run, tmp_path: Path) -> None:
    """A run of two steps is over before time is taken; quiet is no reason to say nothing."""
    drop_scene(dt=0.005, t_stop=0.01).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--estimate", "-q", cwd=tmp_path)
    assert result.returncode == 0
    assert result.stdout == "estimate: the run has too few steps to time some of them\n"


def completions(executable: Path, folder: Path, *words: str) -> list[str]:
    """Return what bash proposes for the last word of a command line."""
    script = f"""source {COMPLETION}
compopt() {{ :; }}
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_mpm3d
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
    command = ["bash", "-c", script, "bash", str(executable), *words]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    assert result.stderr == ""
    return result.stdout.split()


def test_completion(executable: Path, mpm3d: Run, tmp_path: Path) -> None:
    """Options, roles, classes and files are completed."""
    (tmp_path / "a.cfg").touch()
    (tmp_path / "a.points").touch()
    (tmp_path / "save").mkdir()
    (tmp_path / "run.000000000012.h5").touch()
    assert completions(executable, tmp_path, "--c") == ["--config", "--check"]
    assert sorted(completions(executable, tmp_path, "-c", "")) == ["a.cfg", "save"]
    assert completions(executable, tmp_path, "-r", "run") == ["run.000000000012.h5"]
    assert completions(executable, tmp_path, "--describe", "ContactH")[0] == "ContactHuang"
    assert "material" in completions(executable, tmp_path, "--list", "ma")
    assert completions(executable, tmp_path, "-c", "a.cfg", "--set", "ser") == ["serializer."]
    assert "1" in completions(executable, tmp_path, "--threads", "")
    # Every option of the help is known, and no other.
    text = mpm3d("--help", cwd=tmp_path).stdout
    told = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))
    offered = {word for word in completions(executable, tmp_path, "--") if word}
    assert told <= offered
    assert offered - told == {"--config", "--restart"}
