"""Reading frames back: fields, what follows from them, VTKHDF, histories."""

from __future__ import annotations

import math
from pathlib import Path

import h5py
import numpy as np
import pytest
from runs import Array, square_body, write_frame
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from mpm_pygen import Body, Cloud, Frames, HalfCircle, History, PygenError, fill, read_history
from mpm_pygen.charts import chart
from mpm_pygen.config import Config, Job, Object
from mpm_pygen.vtk_hdf import HdfSeries

EPS = float(np.finfo(float).eps)


def _random_body(n: int, seed: int) -> dict[str, Array]:
    """Make points with fields of all kinds and all digits."""
    rng = np.random.default_rng(seed)
    return {
        "position": rng.normal(size=(n, 3)),
        "velocity": rng.normal(size=(n, 3)) * 1e-7,
        "mass": 10.0 ** rng.uniform(-200, 200, n),
        "cauchy_stress": rng.normal(size=(n, 3, 3)),
        "active": np.ones(n),
    }


def _config(sim_type: int, **bodies: Body) -> Config:
    """Make a config around bodies."""
    some = Object("X")
    return Config(Job(1e-3, sim_type), some, some, some, some, list(bodies.values()))


def test_fields_read_back_with_all_bits(tmp_path: Path) -> None:
    """Bodies in the order of their numbers, frames of theirs, each field as it was written."""
    runs = [{"b": _random_body(3, k), "a.x": _random_body(5, 10 + k)} for k in range(3)]
    for k, bodies in enumerate(runs):
        write_frame(tmp_path, 2 * k, 0.5 * k, bodies)
    frames = Frames(tmp_path)
    assert frames.bodies == ["b", "a.x"]
    assert frames.times.tolist() == [0.0, 0.5, 1.0]
    assert len(frames) == 3 and frames[-1].number == 4
    assert [frame.time for frame in frames] == [0.0, 0.5, 1.0]
    assert frames.at(0.6).number == 2
    for frame, bodies in zip(frames, runs, strict=True):
        for name, fields in bodies.items():
            cloud = frame[name]
            assert cloud.position.tobytes() == fields["position"].tobytes()
            assert list(cloud.fields) == list(fields)[1:]
            for key, values in cloud.fields.items():
                assert values.tobytes() == fields[key].tobytes()
    speeds = frames.series("b", "velocity.y")
    assert speeds.shape == (3, 3)
    assert speeds[1].tolist() == runs[1]["b"]["velocity"][:, 1].tolist()
    assert frames.series("b", "position").shape == (3, 3, 3)


def test_what_follows_from_fields() -> None:
    """Closed forms: uniaxial stress, simple shear, components, magnitudes."""
    stress, gradient = np.zeros((2, 3, 3)), np.zeros((2, 3, 3))
    stress[0, 0, 0] = -3.0
    stress[1, 0, 1] = stress[1, 1, 0] = 2.0
    gradient[:, 0, 1] = 4.0
    cloud = Cloud(
        np.zeros((2, 3)),
        {
            "velocity": np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 2.0]]),
            "cauchy_stress": stress,
            "velocity_gradient": gradient,
        },
    )
    expected = {
        "speed": [5, 2],
        "pressure": [1, 0],
        "mises": [3, math.sqrt(3) * 2],
        "tau_bar": [math.sqrt(3), 2],
        "max_stress": [0, 2],
        "min_stress": [-3, -2],
        "gamma_dot": [4, 4],
        "divergence": [0, 0],
        "vorticity": [-4, -4],
        "velocity.z": [0, 2],
        "cauchy_stress.xy": [0, 2],
    }
    for name, values in expected.items():
        assert cloud[name] == pytest.approx(values, rel=8 * EPS, abs=8 * EPS), name
    assert cloud.scalar("velocity").tolist() == [5, 2]
    assert cloud.scalar("cauchy_stress") == pytest.approx([3, math.sqrt(8)], rel=4 * EPS)
    for name in ("x", "velocity.xy", "velocity.w", "cauchy_stress.x", "velocity.q.x"):
        with pytest.raises(PygenError, match="no field"):
            _ = cloud[name]


def test_grid_and_type_from_node_files(tmp_path: Path) -> None:
    """Lines of the grid; 1D to 3D by the cells, 4 and 5 as told or of the config."""
    for cells in ((4,), (4, 5), (4, 5, 6)):
        folder = tmp_path / str(len(cells))
        write_frame(folder, 0, 0.0, {"a": square_body((0.1,) * len(cells), 2, 0.1)}, cells)
        frames = Frames(folder)
        assert frames.sim_type == len(cells)
        lines = frames.grid_lines()
        assert [line.tolist() for line in lines] == [
            np.linspace(0, 1, n + 1).tolist() for n in cells
        ]
    plane = tmp_path / "2"
    assert Frames(plane, sim_type=4).sim_type == 4
    assert Frames(plane, config=_config(5)).sim_type == 5
    write_frame(tmp_path / "bare", 0, 0.0, {"a": square_body((0.1, 0.1), 2, 0.1)})
    assert Frames(tmp_path / "bare").sim_type == 2
    assert Frames(tmp_path / "bare").grid_lines() == []


def test_folders_and_files_that_cannot_be_read(tmp_path: Path) -> None:
    """Each says what is wrong."""
    with pytest.raises(PygenError, match="no folder"):
        Frames(tmp_path / "missing")
    with pytest.raises(PygenError, match="no frames"):
        Frames(tmp_path)
    write_frame(tmp_path, 0, 0.0, {"a": square_body((0, 0), 2, 0.5)})
    frames = Frames(tmp_path)
    with pytest.raises(PygenError, match="no body 'b'; there are a"):
        frames[0].points("b")
    with pytest.raises(PygenError, match=r"no frame .*fnd"):
        frames[0].nodes("a")
    with pytest.raises(IndexError, match="1 frames"):
        _ = frames[1]
    with pytest.raises(PygenError, match="no file"):
        Frames(tmp_path, config=tmp_path / "missing.cfg")
    path = tmp_path / "fpd.0.a.0000000000.vtk"
    path.write_text(
        path.read_text().replace("VECTORS velocity double\n", "VECTORS velocity double\n1 ")
    )
    with pytest.raises(PygenError, match="velocity has 13 numbers where 12"):
        _ = frames[0]["a"]["velocity"]
    path.write_text("no\nframe\n")
    with pytest.raises(PygenError, match="second line"):
        Frames(tmp_path)


def _write_hdf(path: Path, steps: list[dict[str, Array]]) -> None:
    """Write PolyData with steps: counts differ; stresses of the second step are the first's."""
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0]
        root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", 8))
        counts = [len(step["position"]) for step in steps]
        offsets = np.concatenate([[0], np.cumsum(counts)[:-1]])
        n = len(steps)
        root["NumberOfPoints"] = counts
        root["Points"] = np.concatenate([step["position"] for step in steps])
        for kind in ("Vertices", "Lines", "Polygons", "Strips"):
            group = root.create_group(kind)
            cells = counts if kind == "Vertices" else [0] * n
            group["NumberOfCells"] = cells
            group["NumberOfConnectivityIds"] = cells
            group["Offsets"] = np.concatenate([np.arange(c + 1) for c in cells])
            group["Connectivity"] = np.concatenate([np.arange(c) for c in cells]).astype(int)
        data, stepped = root.create_group("PointData"), root.create_group("Steps")
        for name in ("velocity", "mass", "cauchy_stress"):
            values = np.concatenate([step[name].reshape(len(step[name]), -1) for step in steps])
            data[name] = values[:, 0] if values.shape[1] == 1 else values
        stepped.attrs["NSteps"] = n
        stepped["Values"] = 0.25 * np.arange(n)
        stepped["PartOffsets"] = np.arange(n)
        stepped["NumberOfParts"] = np.ones(n, dtype=int)
        stepped["PointOffsets"] = offsets
        for name in ("velocity", "mass", "cauchy_stress"):
            stepped[f"PointDataOffsets/{name}"] = offsets
        cell_offsets = np.zeros((n, 4), dtype=int)
        cell_offsets[:, 0] = offsets
        stepped["CellOffsets"] = cell_offsets
        stepped["ConnectivityIdOffsets"] = cell_offsets


def test_vtk_hdf_reads_as_vtk_reads_it(tmp_path: Path) -> None:
    """Steps of different sizes, mixed with legacy files of another body."""
    steps = [_random_body(3, 1), _random_body(5, 2), _random_body(4, 3)]
    path = tmp_path / "points.0.a.vtkhdf"
    _write_hdf(path, steps)
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    frames = Frames(tmp_path)
    assert frames.times.tolist() == list(times) == [0.0, 0.25, 0.5]
    for k, step in enumerate(steps):
        reader.SetStep(k)
        reader.Update()
        output = reader.GetOutput()
        cloud = frames[k]["a"]
        assert cloud.position.tolist() == step["position"].tolist()
        assert vtk_to_numpy(output.GetPoints().GetData()).tolist() == cloud.position.tolist()
        for name in ("velocity", "mass", "cauchy_stress"):
            assert cloud[name].tolist() == step[name].tolist()
            seen = vtk_to_numpy(output.GetPointData().GetArray(name))
            assert seen.ravel().tolist() == cloud[name].ravel().tolist()
    with pytest.raises(PygenError, match="3 steps"):
        HdfSeries(path).read(3)


def test_vtk_hdf_tells_type_and_config(tmp_path: Path) -> None:
    """The group of mpm3d has both: no config to be named."""
    path = tmp_path / "points.0.a.vtkhdf"
    _write_hdf(path, [_random_body(3, 1)])
    assert Frames(tmp_path).config is None
    scene = _config(4, a=Body("a", material=Object("IsotropicLinearElasticity", (1e5, 0.3))))
    with h5py.File(path, "a") as file:
        group = file.create_group("mpm3d")
        group.attrs["type"] = 4
        group["config"] = np.bytes_(scene.text().encode())
    frames = Frames(tmp_path)
    assert frames.sim_type == 4
    assert frames.config == scene
    path.write_text("no")
    with pytest.raises(PygenError, match="no HDF5"):
        Frames(tmp_path)
    with h5py.File(path, "w") as file:
        file["a"] = 1
    with pytest.raises(PygenError, match="no group VTKHDF"):
        Frames(tmp_path)


def test_history_in_closed_form(tmp_path: Path) -> None:
    """A body that moves and turns, and is stretched: mass, momentum, energies, centre of mass."""
    side, count = 0.125, 4
    for k in range(3):
        body = square_body((0.25 * k, 0.5), count, side)
        centre = np.array([0.25 * k + 0.25, 0.75, 0.0])
        offset = body["position"] - centre
        body["velocity"] = np.array([2.0, -1.0, 0.0]) + 3.0 * np.column_stack(
            [-offset[:, 1], offset[:, 0], 0 * offset[:, 0]]
        )
        body["cauchy_stress"] = np.zeros((count**2, 3, 3))
        body["cauchy_stress"][:, 0, 0] = 100.0 * k
        body["cauchy_stress"][:, 0, 1] = body["cauchy_stress"][:, 1, 0] = 50.0
        write_frame(tmp_path, k, 0.1 * k, {"a": body}, (2, 2))
    material = Object("IsotropicLinearElasticity", (2e4, {"nu": 0.25}))
    config = _config(2, a=Body("a", material=material))
    history = Frames(tmp_path, config=config).history()
    mass, n = 250.0, count**2
    # Second moment of the points about the centre: two directions of side^2 (count^2 - 1)/12.
    inertia = mass * 2 * side**2 * (count**2 - 1) / 12
    shear = 2e4 / (2 * 1.25)
    expected = {
        "a.mass": [mass] * 3,
        "a.centre_x": [0.25, 0.5, 0.75],
        "a.centre_y": [0.75] * 3,
        "a.momentum_x": [2 * mass] * 3,
        "a.momentum_y": [-mass] * 3,
        "a.kinetic_energy": [0.5 * mass * 5 + 0.5 * 9 * inertia] * 3,
        "a.strain_energy": [0.25 * ((100 * k) ** 2 / 4e4 + 50**2 / (2 * shear)) for k in range(3)],
        "contact.force_by_a_on_b_x": [9.0] * 3,
        "contact.force_by_a_on_b_y": [9.0] * 3,
    }
    assert list(history.columns) == list(expected)
    for name, values in expected.items():
        assert history[name] == pytest.approx(values, rel=8 * n * EPS), name
    assert history.time.tolist() == [0.0, 0.1, 0.2]
    # Of two bodies of the same kind the energies add up.
    assert history.sum("kinetic_energy").tolist() == history["a.kinetic_energy"].tolist()
    history.write(tmp_path / "h.csv")
    again = read_history(tmp_path / "h.csv")
    assert {k: v.tobytes() for k, v in again.columns.items()} == {
        k: v.tobytes() for k, v in history.columns.items()
    }
    assert again.time.tobytes() == history.time.tobytes()
    titles = [axes.get_title() for axes in chart(history).axes]
    assert titles == ["centre of mass (m)", "momentum (kg m/s)", "energy (J)", "contact force (N)"]


def test_history_of_bodies_that_come_later_and_points_that_go(tmp_path: Path) -> None:
    """NaN where a body has positions only; inactive points do not count."""
    late = square_body((0.5, 0.5), 2, 0.1, (1, 0, 0))
    late["active"] = np.array([1.0, 1.0, 1.0, 0.0])
    early = {"position": late["position"]}
    there = square_body((0, 0), 2, 0.1, (0, 1, 0))
    write_frame(tmp_path, 0, 0.0, {"a": there, "b": early})
    write_frame(tmp_path, 1, 1.0, {"a": there, "b": late})
    history = Frames(tmp_path).history()
    assert np.isnan(history["b.mass"][0])
    assert history["b.mass"][1] == pytest.approx(30.0)
    assert history.sum("mass") == pytest.approx([40.0, 70.0])
    history.write(tmp_path / "h.csv")
    assert np.isnan(read_history(tmp_path / "h.csv")["b.mass"][0])
    with pytest.raises(PygenError, match="no column"):
        _ = history["c.mass"]
    with pytest.raises(PygenError, match="no body has"):
        history.sum("heat")


def test_masses_of_a_points_file(tmp_path: Path) -> None:
    """Frames of few fields: the config's points file, times r in TYPE 4."""
    points = fill(HalfCircle((0.0, 0.5), 0.4), 4, spacing=0.05, density=900.0)
    position = np.zeros((len(points), 3))
    position[:, :2] = points.position
    velocity = np.tile([0.0, -2.0, 0.0], (len(points), 1))
    write_frame(tmp_path, 0, 0.0, {"ball": {"position": position, "velocity": velocity}})
    with pytest.raises(PygenError, match="name the config"):
        Frames(tmp_path).history()
    scene = _config(4, ball=Body("ball", points))
    with pytest.raises(PygenError, match="neither"):
        Frames(tmp_path, config=scene).history()
    scene.write(tmp_path / "ball.cfg")
    history = Frames(tmp_path, config=tmp_path / "ball.cfg").history()
    assert history["ball.mass"][0] == pytest.approx(points.total_mass, rel=len(points) * EPS)
    assert history["ball.momentum_z"][0] == pytest.approx(-2 * points.total_mass, rel=1e-14)
    assert history["ball.centre_z"][0] == pytest.approx(0.5, rel=1e-14)


def test_tables_that_are_no_histories(tmp_path: Path) -> None:
    """The first column is time, all lines have its columns, all entries are numbers."""
    path = tmp_path / "h.csv"
    for text, words in (
        ("t,a\n1,2\n", "first column"),
        ("time,a\n1,x\n", "could not convert"),
        ("time,a\n1,2,3\n", "columns"),
        ("", "first column"),
    ):
        path.write_text(text)
        with pytest.raises(PygenError, match=words):
            read_history(path)
    path.write_text("# of a program\ntime [s],a\n1,2\n3,\n")
    assert read_history(path)["a"][0] == 2.0
    assert np.isnan(read_history(path)["a"][1])
    with pytest.raises(PygenError, match="no column that changes"):
        chart(History(np.zeros(2), {"a.mass": np.ones(2)}))
