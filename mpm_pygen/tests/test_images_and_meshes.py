"""Shapes from pictures and from surface meshes."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from mpm_pygen import Mesh, PygenError, fill, lattice, read_image, read_mesh

EPS = float(np.finfo(float).eps)
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)])
#: The faces of the box, counter-clockwise from outside.
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = np.array([[f[0], f[k], f[k + 1]] for f in FACES for k in (1, 2)])


def _picture(path: Path) -> None:
    """Draw 6 by 4 pixels: 5 red, 3 blue, 1 nearly red, 1 transparent green."""
    picture = Image.new("RGBA", (6, 4), (255, 255, 255, 255))
    for place in ((0, 3), (1, 3), (2, 3), (0, 2), (5, 0)):
        picture.putpixel(place, (255, 0, 0, 255))
    for place in ((3, 3), (4, 3), (5, 3)):
        picture.putpixel(place, (0, 0, 255, 255))
    picture.putpixel((1, 2), (250, 4, 0, 255))
    picture.putpixel((3, 0), (0, 255, 0, 100))
    picture.save(path)


def test_colours_of_a_picture_are_bodies(tmp_path: Path) -> None:
    """Counts and places of the pixels; the lowest row of the picture has the lowest y."""
    _picture(tmp_path / "a.png")
    found = read_image(tmp_path / "a.png", pixel=0.5, lower=(1.0, 2.0))
    assert list(found) == ["#ff0000", "#0000ff", "#fa0400"]
    assert [shape.measure for shape in found.values()] == [5 * 0.25, 3 * 0.25, 0.25]
    blue, _ = lattice(found["#0000ff"], 0.5)
    assert blue.tolist() == [[2.75, 2.25], [3.25, 2.25], [3.75, 2.25]]
    red = fill(found["#ff0000"], 2, spacing=0.125, density=8.0)
    assert len(red) == 5 * 16
    assert red.total_mass == 10.0
    assert [x.tolist() for x in found["#ff0000"].bounds] == [[1.0, 2.0], [4.0, 4.0]]
    about_red = read_image(tmp_path / "a.png", pixel=0.5, colours=["#FF0000"], tolerance=5)
    assert about_red["#ff0000"].measure == 6 * 0.25
    with pytest.raises(PygenError, match="no multiple"):
        lattice(found["#ff0000"], 0.4)


def test_pictures_that_cannot_be_used(tmp_path: Path) -> None:
    """No such colour, no picture, nothing in it."""
    _picture(tmp_path / "a.png")
    with pytest.raises(PygenError, match="no pixel of the colour #123456"):
        read_image(tmp_path / "a.png", pixel=1.0, colours=["#123456"])
    for colour in ("red", "#12", "#gggggg"):
        with pytest.raises(PygenError, match="written #rrggbb"):
            read_image(tmp_path / "a.png", pixel=1.0, colours=[colour])
    (tmp_path / "b.png").write_text("no picture")
    with pytest.raises(PygenError, match="no picture"):
        read_image(tmp_path / "b.png", pixel=1.0)
    Image.new("RGB", (3, 3), "white").save(tmp_path / "c.png")
    with pytest.raises(PygenError, match="not background"):
        read_image(tmp_path / "c.png", pixel=1.0)


def _write_stl(path: Path, binary: bool) -> None:
    """Write the box as STL."""
    corners = CUBE[TRIANGLES]
    if binary:
        facets = [struct.pack("<12fH", 0, 0, 0, *facet.ravel(), 0) for facet in corners]
        path.write_bytes(
            b"solid looks like text".ljust(80) + struct.pack("<I", 12) + b"".join(facets)
        )
        return
    lines = ["solid box"]
    for facet in corners:
        lines += ["facet normal 0 0 0", " outer loop"]
        lines += [f"  vertex {x} {y} {z}" for x, y, z in facet.tolist()]
        lines += [" endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid box", ""]))


def _write_obj(path: Path) -> None:
    """Write the box as OBJ, with square faces, comments and texture numbers."""
    lines = ["# box", *(f"v {x} {y} {z}" for x, y, z in CUBE.tolist()), "vn 0 0 1"]
    for k, face in enumerate(FACES):
        # The last face counts from the end.
        numbers = [i - 8 if k == 5 else i + 1 for i in face]
        lines.append("f " + " ".join(f"{i}//1" for i in numbers) + "  # face")
    path.write_text("\n".join(lines))


def test_mesh_formats_agree(tmp_path: Path) -> None:
    """STL as text and binary, OBJ, and PLY by trimesh: the same box of 1 by 2 by 3."""
    _write_stl(tmp_path / "text.stl", binary=False)
    _write_stl(tmp_path / "binary.STL", binary=True)
    _write_obj(tmp_path / "box.obj")
    trimesh.Trimesh(CUBE, TRIANGLES, process=False).export(tmp_path / "box.ply")
    for path in sorted(tmp_path.iterdir()):
        mesh = read_mesh(path)
        assert mesh.measure == pytest.approx(6.0, rel=16 * EPS)
        points = fill(mesh, 3, spacing=0.25, density=2.0)
        assert len(points) == 4 * 8 * 12
        assert points.total_mass == 12.0
    assert len(list(tmp_path.iterdir())) == 4
    small = read_mesh(tmp_path / "box.obj", scale=0.001)
    assert small.measure == pytest.approx(6e-9, rel=16 * EPS)


def test_volume_of_a_mesh_of_a_sphere() -> None:
    """Lattice against polyhedron: within the cells on the surface; rays pass through corners."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=1.0)
    mesh = Mesh(np.array(ball.vertices), np.array(ball.faces))
    assert mesh.measure == pytest.approx(float(ball.volume), rel=1e-12)
    h = 0.125
    # The middle of the bounds is the centre; a lattice through it hits corners and edges.
    points = fill(mesh, 3, spacing=h, density=1.0, origin=(h / 2, h / 2, h / 2))
    half = 0.5 * h * math.sqrt(3.0)
    area = float(ball.area)
    assert abs(points.total_volume - mesh.measure) < area * half + 4 * math.pi * half**2
    x = np.random.default_rng(1).uniform(-1.1, 1.1, (4000, 3))
    # Inside of a convex body is below the planes of all faces.
    below = np.einsum("nk,fk->nf", x, ball.face_normals) <= np.einsum(
        "fk,fk->f", ball.triangles[:, 0], ball.face_normals
    )
    assert (mesh.contains(x) == below.all(axis=1)).all()


def test_hollow_and_touching_meshes() -> None:
    """A cavity is outside; rays along upright faces and through edges do no harm."""
    inner = CUBE * 0.5 + 0.25
    mesh = Mesh(np.concatenate([CUBE, inner]), np.concatenate([TRIANGLES, TRIANGLES[:, ::-1] + 8]))
    assert mesh.measure == pytest.approx(6.0 - 0.75, rel=32 * EPS)
    position, cell = lattice(mesh, 0.125)
    assert len(position) * cell == 6.0 - 0.75
    # Rays through the upright faces and the diagonals of the box.
    x = np.array([[0.0, 0.5, 4.0], [0.0, 0.5, -1.0], [0.5, 1.0, 3.5], [0.5, 1.0, -0.5], [1, 2, -1]])
    assert not mesh.contains(x).any()
    turned = trimesh.creation.cylinder(radius=0.5, height=1.0, sections=33)
    upright = Mesh(np.array(turned.vertices), np.array(turned.faces))
    on_rim = np.array(turned.vertices)[:, :2]
    above = np.column_stack([on_rim, np.full(len(on_rim), -2.0)])
    assert not upright.contains(above).any()


def test_meshes_that_are_refused(tmp_path: Path) -> None:
    """Open, inside out, empty, malformed."""
    with pytest.raises(PygenError, match=r"not closed.*3 edges"):
        Mesh(CUBE, TRIANGLES[:-1])
    with pytest.raises(PygenError, match="inside out"):
        Mesh(CUBE, TRIANGLES[:, ::-1])
    for name, text, words in (
        ("a.stl", "solid\nvertex 1 2\n", "a.stl:2: a vertex has three"),
        ("b.stl", "solid\nendsolid\n", "no triangle"),
        ("c.obj", "v 0 0 0\nf 1 2 3\n", "c.obj:2: a face"),
        ("d.obj", "v 0 0 0\nf a b c\n", "d.obj:2: a face"),
        ("e.stl", "solid\nvertex 1 2 3\n", "1 vertices"),
        ("f.xyz", "", "f.xyz"),
    ):
        (tmp_path / name).write_text(text)
        with pytest.raises(PygenError, match=words):
            read_mesh(tmp_path / name)
    (tmp_path / "g.stl").write_bytes(bytes(range(255)))
    with pytest.raises(PygenError, match="no text"):
        read_mesh(tmp_path / "g.stl")
