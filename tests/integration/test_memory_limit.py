"""Sizes are bounded before anything of that size is made: --max-memory, or what the machine has."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from bad_input import BAD_INPUT, CONFIG, expect_failure, write_scene
from scene import Body, Run, Scene, block, drop_scene, run_scene, write_points

LATTICE = 'Lx = {1, 1} Nx = {40000, 40000} lmpp = 1 rho = 1\npart { class = "Box" properties = {'


def changed(old: str, new: str) -> str:
    """Return the good config with one change."""
    assert old in CONFIG
    return CONFIG.replace(old, new, 1)


def far_apart() -> Scene:
    """Make a body of two parts, between which lie many nodes."""
    rows = block(2, [0.1, 0.1], [0.2, 0.2], [2, 2])
    other = block(2, [999.8, 999.8], [999.9, 999.9], [2, 2])
    return drop_scene(
        lengths=[1000.0, 1000.0], cells=[10000, 10000], bodies=[Body("a", [*rows, *other])]
    )


def test_estimate_of_check(mpm3d: Run, tmp_path: Path) -> None:
    """--check tells what points and nodes take, and of how much."""
    drop_scene().write(tmp_path)
    text = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path).stdout
    assert re.search(r"^memory: .* bytes a point, of [\d.]+ [MG]B \(of this machine\)$", text, re.M)
    result = mpm3d("-c", "scene.cfg", "--check", "--max-memory", "512MiB", cwd=tmp_path)
    assert "bytes a point, of 537 MB (--max-memory)" in result.stdout


def test_estimate_has_what_frames_keep(mpm3d: Run, tmp_path: Path) -> None:
    """A shear rate for MinimalVTK, a velocity gradient for all fields, nothing for chosen ones."""
    n = 1000
    body = Body("a", block(3, [0.2] * 3, [0.8] * 3, [10] * 3))
    # Digits of text, and the deflate level of VTKHDF.
    settings = {"lengths": [1.0] * 3, "cells": [5] * 3, "bodies": [body], "digits": 9}

    def stated(serializer: str, *options: str) -> float:
        folder = tmp_path / f"{serializer}{len(options)}"
        drop_scene(sim_type=3, serializer=serializer, **settings).write(folder)
        text = mpm3d("-c", "scene.cfg", "--check", *options, cwd=folder).stdout
        found = re.search(r"^memory: +(\S+) MB", text, re.M)
        assert found, text
        return 1e6 * float(found[1]) / n

    # Three digits of some 200 bytes.
    rounding = 1.0
    least = stated("VTKHDF", "--set", "serializer.str-properties={f, save, run, velocity}")
    assert stated("MinimalVTK") - least == pytest.approx(8, abs=rounding)
    assert stated("DefaultVTK") - least == pytest.approx(72, abs=rounding)
    assert stated("VTKHDF") - least == pytest.approx(72, abs=rounding)


def test_same_frames(mpm3d: Run, tmp_path: Path) -> None:
    """A limit that is wide enough changes nothing."""
    for name, options in (("a", ()), ("b", ("--max-memory", "1M"))):
        run_scene(mpm3d, drop_scene(rate=100.0), tmp_path / name, *options)
    frames = [path.name for path in (tmp_path / "a/frames").glob("*.vtk")]
    assert len(frames) == 4
    for name in frames:
        assert (tmp_path / "a/frames" / name).read_bytes() == (
            tmp_path / "b/frames" / name
        ).read_bytes()


@pytest.mark.parametrize("size", ["1k", "3k"])
def test_table(mpm3d: Run, tmp_path: Path, size: str) -> None:
    """A table: its text, or what is made of it, is more than the limit."""
    write_scene(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--max-memory", size, cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, "first.points: ", "than")
    assert "more than there is" in result.stderr or "bytes, more than the memory" in result.stderr


def test_second_body(mpm3d: Run, tmp_path: Path) -> None:
    """All bodies count."""
    write_scene(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--max-memory", "5k", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, "second.points: ", "16 points need")
    assert "use fewer points, or allow more with --max-memory SIZE" in result.stderr


def test_nodes(mpm3d: Run, tmp_path: Path) -> None:
    """The nodes around a body."""
    far_apart().write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--max-memory", "1G", cwd=tmp_path)
    expect_failure(
        result, tmp_path, BAD_INPUT, "scene.cfg: ", 'body "a" reaches over 100000000 nodes'
    )
    assert "--max-memory" in result.stderr


def test_generator(mpm3d: Run, tmp_path: Path) -> None:
    """A generator text: positions are counted up to the limit only."""
    write_scene(
        tmp_path, changed('"DefaultPoints"', '"CartesianPoints"').replace("first.points", "a.parts")
    )
    (tmp_path / "a.parts").write_text(LATTICE + "0, 0, 1, 1} }\n")
    result = mpm3d("-c", "scene.cfg", "--max-memory", "10M", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, "a.parts: ", "points need")
    assert "more than " in result.stderr


def test_reserve(mpm3d: Run, tmp_path: Path) -> None:
    """Points in reserve."""
    points = '"ImprovedQuadraturePoints"\n    point-int-props = {position = 1, quadrature = 0}\n'
    points += "    point-props = {r = 0.025, merge = 0.5, buffer = 1e300}"
    write_scene(tmp_path, changed('"DefaultPoints"', points))
    result = mpm3d("-c", "scene.cfg", "--max-memory", "10M", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, "scene.cfg:", "with those in reserve")


def test_lists_of_nodes(mpm3d: Run, tmp_path: Path) -> None:
    """Nodes of the domains of many points in few cells."""
    points = '"ImprovedQuadraturePoints"\n    point-int-props = {position = 0, quadrature = 3}'
    config = changed('"DefaultPoints"', points).replace("CartesianLinear", "CartesianQuadratic")
    write_scene(tmp_path, config)
    write_points(tmp_path / "first.points", block(2, [0.2, 0.2], [0.4, 0.4], [40, 40]))
    # A point takes 180 bytes and 70 of text when it is read, 160 later, and 9 nodes or more of 28.
    result = mpm3d("-c", "scene.cfg", "--max-memory", "450k", "--check", cwd=tmp_path)
    expect_failure(
        result, tmp_path, BAD_INPUT, "scene.cfg: ", 'the domains of the points of body "first"'
    )
    assert "--max-memory" in result.stderr
    result = mpm3d("-c", "scene.cfg", "--max-memory", "5M", "--check", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
