"""Scenes: lattices of points, points files, configs and time steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from harness.scene import (
    Body,
    Scene,
    huang,
    lattice,
    pressure_wave_modulus,
    section,
    shear_modulus,
    stable_dt,
)
from harness.scheme import Scheme


def test_moduli() -> None:
    """M = E and G = E/2 without, M = 1.35 E with a Poisson's ratio of 0.3."""
    assert pressure_wave_modulus(7.0, 0.0) == 7.0
    assert shear_modulus(7.0, 0.0) == 3.5
    assert pressure_wave_modulus(2.0, 0.25) == pytest.approx(2.4, rel=1e-15)
    assert shear_modulus(2.0, 0.25) == pytest.approx(0.8, rel=1e-15)


def test_lattice_fills_its_box() -> None:
    """The middles of sub-boxes, x fastest; mass and volume are those of the box."""
    points = lattice(2, [1.0, 0.0], [3.0, 0.5], [4, 2], 10.0, [0.5, -1.0])
    assert len(points) == 8
    assert points.x[:5].tolist() == [
        [1.25, 0.125],
        [1.75, 0.125],
        [2.25, 0.125],
        [2.75, 0.125],
        [1.25, 0.375],
    ]
    assert points.volume.sum() == pytest.approx(1.0, rel=1e-15)
    assert points.mass.sum() == pytest.approx(10.0, rel=1e-15)
    assert points.velocity.tolist() == [[0.5, -1.0]] * 8


def test_lattice_in_the_meridian_plane() -> None:
    """Measures are per radian: of a solid cylinder R^2 H/2, for any number of points."""
    points = lattice(4, [0.0, 0.0], [2.0, 3.0], [5, 4], 10.0)
    assert points.velocity.shape == (20, 3)
    assert points.measure.sum() == pytest.approx(6.0, rel=1e-14)
    assert points.total_mass.sum() == pytest.approx(60.0, rel=1e-14)
    assert points.volume.sum() == pytest.approx(6.0, rel=1e-14)


def test_velocity_may_be_a_field() -> None:
    """A function of the positions."""
    points = lattice(1, [0.0], [1.0], [2], 1.0, lambda x: 2.0 * x)
    assert points.velocity.tolist() == [[0.5], [1.5]]


def test_points_file_keeps_all_digits(tmp_path: Path) -> None:
    """TYPE 5: mass, volume, three coordinates, three velocities, body 1."""
    points = lattice(5, [0.0, 0.0], [1.0, 1.0], [3, 1], 0.1, [0.0, 0.0, 1.0 / 3.0])
    kept = points.keep(points.x[:, 0] > 0.3)
    assert len(kept) == 2
    kept.write(tmp_path / "bar.points")
    head, *lines = (tmp_path / "bar.points").read_text().splitlines()
    assert head == "2"
    table = np.array([[float(word) for word in line.split()] for line in lines])
    assert table.shape == (2, 9)
    assert table[:, 0].tolist() == kept.mass.tolist()
    assert table[:, 2:4].tolist() == kept.x.tolist()
    assert table[:, 4].tolist() == [0.0, 0.0]
    assert table[:, 7].tolist() == [1.0 / 3.0] * 2
    assert table[:, 8].tolist() == [1.0, 1.0]


def make_scene(**changes: object) -> Scene:
    """Return a scene of one bar."""
    points = lattice(1, [0.0], [1.0], [8], 1.0)
    values = dict(sim_type=1, lengths=[1.0], cells=[4], t_stop=0.5, dt=0.1)
    values["bodies"] = [Body("bar", points, 1e5, 0.25, "CartesianBox")]
    return Scene(**(values | changes))


def test_scene_counts_steps_and_cost() -> None:
    """Points times steps."""
    scene = make_scene()
    assert scene.steps == 5
    assert scene.point_steps == 40.0
    assert make_scene(t_start=0.2, t_stop=0.5).steps == 3


def test_config_names_what_the_scene_has(tmp_path: Path) -> None:
    """Flags of the solver, the frame rate, and files beside the config."""
    contact = huang("bar", "other", friction=0.5, normals=0)
    scene = make_scene(mapping="cpdi", contact_rule="explicit", frames=10, contacts=[contact])
    path = scene.write(tmp_path / "run")
    text = path.read_text()
    assert (tmp_path / "run" / "bar.points").is_file()
    assert "int-properties = {cpdi = 1, contact = 0}" in text
    assert "t = 0.0  dt = 0.1  TYPE = 1" in text
    assert 'boundary-class = "CartesianBox"' in text
    assert "material-props = {100000.0, 0.25}" in text
    assert 'name = "bar_other"' in text
    assert "int-properties = {normals = 0}" in text
    rate = float(text.partition("properties = {")[2].partition("}")[0])
    assert 20.0 < rate < 20.0 * (1 + 1e-8)


def test_mapping_and_seams_choose_the_grid() -> None:
    """Each basis has a class, and one with periodic directions; uGIMP takes half of its box."""
    assert 'class = "CartesianLinear"' in make_scene(mapping="cpdi").config()
    assert 'class = "CartesianQuadratic"' in make_scene(mapping="quadratic").config()
    seam = make_scene(mapping="cubic", periodic=[True]).grid_section()
    assert 'class = "CartesianCubicCustom"' in seam
    assert "int-properties = {4, 1}" in seam
    assert 'class = "CartesianCustom"' in make_scene(periodic=[True]).grid_section()
    assert "properties = {1.0, 0.0625}" in make_scene(mapping="ugimp").grid_section()
    with pytest.raises(ValueError, match="quartic"):
        make_scene(mapping="quartic").config()


def test_domains_go_with_boxes() -> None:
    """They stand on linear functions; other mappings refuse them."""
    scheme = Scheme(domains="cpgimp")
    text = make_scene(mapping="ugimp", scheme=scheme).config()
    assert 'class = "CartesianLinear"' in text
    assert "point-int-props = {2}" in text
    with pytest.raises(ValueError, match="ugimp"):
        make_scene(mapping="cubic", scheme=scheme).config()


def test_section_takes_properties_by_place_or_name() -> None:
    """Strings come last."""
    text = section("Some", {"a": 1.5, "b": np.float64(2.0)}, [1, 2], ["x"])
    assert "properties = {a = 1.5, b = 2.0}" in text
    assert "int-properties = {1, 2}" in text
    assert 'str-properties = {"x"}' in text


@pytest.mark.parametrize("frames", [1, 7, 40])
def test_stable_dt_hits_every_frame(frames: int) -> None:
    """The largest step with a Courant number up to the wanted one, frames at its multiples."""
    length, cells, speed, t_stop, cfl = 1.0, 32, 100.0, 0.02, 0.2
    dt = stable_dt(length, cells, speed, t_stop, cfl, frames)
    steps = round(t_stop / dt)
    assert steps % frames == 0
    assert steps * dt == pytest.approx(t_stop, rel=1e-14)
    assert speed * dt * cells / length <= cfl * (1 + 1e-9)
    assert speed * t_stop / (steps - frames) * cells / length > cfl
