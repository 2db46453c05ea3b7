"""VTKHDF files: VTK's reader and h5py find what the legacy frames have."""

from __future__ import annotations

import signal
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from checkpoints import contents
from frames import Array, read_series
from scene import Body, Run, Scene, block, huang, run_scene
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

KINDS = {"points": "fpd", "nodes": "fnd"}


class Series:
    """A file as VTK's reader sees it; any complaint fails the test."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.complaints: list[str] = []
        self.reader = vtkHDFReader()
        for event in ("ErrorEvent", "WarningEvent"):
            self.reader.AddObserver(event, lambda _reader, kind: self.complaints.append(kind))
        self.reader.SetFileName(str(path))
        self.reader.UpdateInformation()
        self.n = self.reader.GetNumberOfSteps()

    def frame(self, step: int) -> tuple[float, Array, dict[str, Array], list[int]]:
        """Return time, positions, fields and cell types of a frame."""
        self.reader.SetStep(step)
        self.reader.Update()
        assert not self.complaints, f"{self.path}: {self.complaints}"
        data = self.reader.GetOutputDataObject(0)
        point_data = data.GetPointData()
        names = [point_data.GetArrayName(i) for i in range(point_data.GetNumberOfArrays())]
        return (
            self.reader.GetTimeValue(),
            vtk_to_numpy(data.GetPoints().GetData()).copy(),
            {name: vtk_to_numpy(point_data.GetArray(name)).copy() for name in names},
            [data.GetCellType(i) for i in range(data.GetNumberOfCells())],
        )


def two_blocks(sim_type: int = 2, **changes: object) -> Scene:
    """Make two bodies that collide."""
    low, high = ([0.3, 0.3, 0.3], [0.6, 0.6, 0.6]), ([0.3, 0.62, 0.3], [0.5, 0.8, 0.6])
    dim = {1: 1, 3: 3}.get(sim_type, 2)
    boundary = 'boundary-class = "CartesianBox"'
    first = block(sim_type, low[0][:dim], low[1][:dim], [6] * dim)
    second = block(sim_type, high[0][:dim], high[1][:dim], [5] * dim)
    if dim == 1:
        second = block(sim_type, [0.62], [0.8], [5])
    second[:, -2] = -0.5
    settings: dict[str, object] = {
        "lengths": [1.0] * dim,
        "cells": [10] * dim,
        "bodies": [Body("a", first, more=boundary), Body("b", second, more=boundary)],
        "contacts": [huang("a", "b")],
        "t_stop": 0.03,
        "rate": 100.0,
    }
    return Scene(sim_type, **{**settings, **changes})  # type: ignore[arg-type]


def use_hdf(integers: str = "nodes = 1", more: str = "", saving: str = "") -> tuple[str, ...]:
    """Return options that choose the serializer."""
    return (
        *("--set", "serializer.class=VTKHDF"),
        *("--set", f"serializer.int-properties={{{integers}}}"),
        *("--set", f'serializer.str-properties={{"hdf", "save", "test"{more}}}'),
        *("--set", f"serializer.properties={{100.0{saving}}}"),
    )


@pytest.mark.parametrize("sim_type", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("deflate", [0, 6])
def test_same_as_legacy_frames(mpm3d: Run, tmp_path: Path, sim_type: int, deflate: int) -> None:
    """Every step and field, bit by bit; the legacy frames have 17 digits."""
    scene = two_blocks(sim_type)
    run_scene(mpm3d, scene, tmp_path)
    run_scene(mpm3d, scene, tmp_path, *use_hdf(f"deflate = {deflate}, nodes = 1"))
    assert len(list((tmp_path / "hdf").iterdir())) == 4
    moved = 0
    for i, name in enumerate(("a", "b")):
        for prefix, kind in KINDS.items():
            legacy = read_series(tmp_path / "frames", kind, i, name)
            series = Series(tmp_path / "hdf" / f"{prefix}.{i}.{name}.vtkhdf")
            assert series.n == len(legacy) == 4
            for step, expected in enumerate(legacy):
                t, positions, fields, cell_types = series.frame(step)
                assert t == expected.time
                np.testing.assert_array_equal(positions, expected.positions)
                assert fields.keys() == expected.fields.keys()
                for field, values in fields.items():
                    np.testing.assert_array_equal(
                        values.reshape(expected.fields[field].shape), expected.fields[field], field
                    )
                assert cell_types == expected.cell_types
                moved += int(np.any(positions != legacy[0].positions))
    assert moved == 6


def test_layout(mpm3d: Run, tmp_path: Path) -> None:
    """Datasets are chunked, compressed when asked; the config stands beside VTK's group."""
    scene = two_blocks()
    run_scene(mpm3d, scene, tmp_path, *use_hdf("deflate = 4, nodes = 1"))
    version = mpm3d("--version", cwd=tmp_path).stdout
    with h5py.File(tmp_path / "hdf" / "points.1.b.vtkhdf") as file:
        assert set(file) == {"VTKHDF", "mpm3d"}
        about = file["mpm3d"]
        assert about["config"][()].decode() == (tmp_path / "scene.cfg").read_text()
        assert about.attrs["program"].decode() in version
        assert about.attrs["revision"].decode() in version
        assert about.attrs["compiler"].decode() in version
        assert about.attrs["body"] == b"b"
        assert about.attrs["type"] == 2
        assert "Pa" in about.attrs["units"].decode()
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"PolyData"
        assert root.attrs["Version"].tolist() == [2, 0]
        assert root["Steps"].attrs["NSteps"] == 4
        stress = root["PointData/cauchy_stress"]
        assert stress.shape == (4 * 25, 9)
        assert stress.chunks == (25, 9)
        assert stress.compression == "gzip"
        assert stress.compression_opts == 4
        assert stress.maxshape == (None, 9)
        assert stress.dtype == np.float64
    run_scene(mpm3d, scene, tmp_path, *use_hdf("deflate = 0"))
    with h5py.File(tmp_path / "hdf" / "points.1.b.vtkhdf") as file:
        assert file["VTKHDF/PointData/cauchy_stress"].compression is None


def test_chosen_fields(mpm3d: Run, tmp_path: Path) -> None:
    """Only what is named is written."""
    run_scene(mpm3d, two_blocks(), tmp_path, *use_hdf(more=', "velocity", "pressure"'))
    fields = Series(tmp_path / "hdf" / "points.0.a.vtkhdf").frame(3)[2]
    assert set(fields) == {"velocity", "pressure"}
    fields = Series(tmp_path / "hdf" / "nodes.0.a.vtkhdf").frame(3)[2]
    assert set(fields) == {"velocity"}
    result = mpm3d("-c", "scene.cfg", *use_hdf(more=', "speed"'), cwd=tmp_path)
    assert result.returncode == 2
    assert 'there is no field "speed"' in result.stderr


def test_bodies_that_wait(mpm3d: Run, tmp_path: Path) -> None:
    """Fields of nodes that come later are 0 before; those of points are always there."""
    driver = """driver
{
    class = "BallisticDriver"
    properties = {0.03, 0.0, -0.5}
    str-properties = {"b"}
}
"""
    scene = two_blocks(driver=driver, t_start=-0.015, rate=200.0)
    run_scene(mpm3d, scene, tmp_path, *use_hdf())
    points = Series(tmp_path / "hdf" / "points.1.b.vtkhdf")
    assert points.n == 5
    assert np.all(points.frame(0)[2]["velocity"][:, 1] == -0.5)
    assert np.all(points.frame(1)[1] == points.frame(0)[1])
    nodes = Series(tmp_path / "hdf" / "nodes.1.b.vtkhdf")
    assert [np.any(nodes.frame(step)[2]["mass"] > 0.0) for step in range(5)] == [
        *(False, False),
        *(True, True, True),
    ]


def test_restart_goes_on_in_the_file(mpm3d: Run, tmp_path: Path) -> None:
    """Frames behind the checkpoint are written again, those before it stay as they are."""
    options = use_hdf(saving=", save_time = 0.014")
    run_scene(mpm3d, two_blocks(), tmp_path, *options)
    paths = sorted((tmp_path / "hdf").iterdir())
    expected = [contents(path) for path in paths]
    for path in paths:
        with h5py.File(path, "r+") as file:
            root = file["VTKHDF"]
            n = len(root["PointData/velocity"]) // 4
            for values in root["PointData"].values():
                values[2 * n :] = -1.0
            root["Steps/Values"][2:] = -1.0
    assert [contents(path) for path in paths] != expected
    result = mpm3d("-r", "save/test.000000000014.h5", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert [contents(path) for path in paths] == expected


@pytest.mark.parametrize("wait", [0.0, 0.013, 0.05])
def test_readable_during_and_after(executable: Path, tmp_path: Path, wait: float) -> None:
    """A reader finds whole frames while the run goes on, and when it was killed."""
    two_blocks(t_stop=1e3, rate=1e3).write(tmp_path)
    command = [
        executable,
        "-c",
        "scene.cfg",
        "-q",
        *use_hdf(),
        "--set",
        "serializer.properties={1e3}",
    ]
    path = tmp_path / "hdf" / "points.0.a.vtkhdf"
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE) as process:
        deadline = time.monotonic() + 60.0
        n = 0
        while n < 3:
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.01)
            if path.exists():
                process.send_signal(signal.SIGSTOP)
                n = Series(path).n
                process.send_signal(signal.SIGCONT)
        time.sleep(wait)
        process.send_signal(signal.SIGKILL)
        process.wait()
    series = Series(path)
    assert series.n >= n
    for step in range(series.n):
        t, positions, fields, _ = series.frame(step)
        assert t == pytest.approx(step * 1e-3, rel=1e-12)
        assert positions.shape == (36, 3)
        assert np.all(fields["mass"] > 0.0)
