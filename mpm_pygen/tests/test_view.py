"""Pictures and movies: colours where they belong, areas, grids, mirrored and turned bodies."""

from __future__ import annotations

import math
import os
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image
from runs import Array, square_body, write_frame

from mpm_pygen import Frames, PygenError
from mpm_pygen.camera import Camera, revolve
from mpm_pygen.cli import main
from mpm_pygen.deformation import Deformation, surface_points
from mpm_pygen.drawing import Painter, Style
from mpm_pygen.movies import find_ffmpeg, movie, picture, render

EPS = float(np.finfo(float).eps)
WHITE = (255, 255, 255)


def _colour(value: float, light: float = 1.0) -> Array:
    """Give red, green, blue of a value from 0 to 1."""
    return np.array(mpl.colormaps["viridis"](value)[:3]) * 255.0 * light


class _Seen:
    """A drawn picture, asked at positions of the scene."""

    def __init__(self, painter: Painter) -> None:
        figure = painter.figure()
        self.pixels = render(figure).astype(float)
        self.axes = figure.axes

    def at(self, x: float, y: float, panel: int = 0) -> Array:
        """Give the colour of the pixel at a position."""
        column, row = self.axes[panel].transData.transform((x, y))
        return np.asarray(self.pixels[len(self.pixels) - 1 - int(row), int(column)])

    def scale(self, panel: int = 0) -> float:
        """Give pixels per metre."""
        (x0, _), (x1, _) = self.axes[panel].transData.transform([(0, 0), (1, 0)])
        return float(x1 - x0)

    def count(self, colour: Array) -> int:
        """Count the pixels of a colour within the first axes."""
        near = np.abs(self.pixels - colour).max(axis=-1) <= 1.5
        box = self.axes[0].get_window_extent()
        rows = len(near) - np.array([box.y1, box.y0])
        return int(near[int(rows[0]) : int(rows[1]), int(box.x0) : int(box.x1)].sum())


def _two_squares(folder: Path) -> Frames:
    """Write two squares of speeds 1 and 3 in a box of 4 by 4 cells; the first one moves."""
    for k in range(3):
        first = square_body((0.125 + 0.25 * k, 0.125), 4, 0.0625, (1, 0, 0))
        second = square_body((0.125, 0.625), 2, 0.125, (0, -3, 0))
        write_frame(folder, k, 0.25 * k, {"a": first, "b": second}, (4, 4))
    return Frames(folder)


def test_squares_have_their_places_areas_and_colours(tmp_path: Path) -> None:
    """Each body covers its area, up to the pixels of its outline, in the colour of its speed."""
    painter = Painter(_two_squares(tmp_path), Style(limits=(0.0, 4.0), grid=False), [0])
    seen = _Seen(painter)
    scale = seen.scale()
    assert scale > 300.0
    for value, place in ((0.25, (0.28, 0.28)), (0.75, (0.2, 0.7))):
        colour = _colour(value)
        assert np.abs(seen.at(*place) - colour).max() <= 1.0
        # 0.25 m by 0.25 m; the outline is four sides, blurred by a pixel on both sides of each.
        assert abs(seen.count(colour) - (0.25 * scale) ** 2) <= 4 * 0.25 * scale * 2
    for place in ((0.05, 0.25), (0.5, 0.5), (0.75, 0.75), (0.25, 0.5)):
        assert tuple(seen.at(*place)) == WHITE


def test_limits_are_those_of_the_frames(tmp_path: Path) -> None:
    """Without limits the lowest and highest speeds get the ends of the colours."""
    seen = _Seen(Painter(_two_squares(tmp_path), Style(), [0]))
    assert np.abs(seen.at(0.28, 0.28) - _colour(0.0)).max() <= 1.0
    assert np.abs(seen.at(0.2, 0.7) - _colour(1.0)).max() <= 1.0
    bar = seen.axes[-1]
    assert bar.get_ylabel() == "speed (m/s)"
    assert bar.get_ylim() == (1.0, 3.0)


def test_frames_side_by_side_with_their_times(tmp_path: Path) -> None:
    """In each panel the body is where it is at that time."""
    seen = _Seen(Painter(_two_squares(tmp_path), Style(bodies=["a"], limits=(0, 4)), [0, 2]))
    assert [axes.get_title() for axes in seen.axes[:2]] == ["t = 0.000 s", "t = 0.500 s"]
    moved = [
        np.abs(seen.at(x, 0.28, k) - _colour(0.25)).max() <= 1 for k in (0, 1) for x in (0.28, 0.78)
    ]
    assert moved == [True, False, False, True]
    # The other body is not drawn.
    assert tuple(seen.at(0.2, 0.8)) == WHITE


def test_grid_lines_are_there_when_wanted(tmp_path: Path) -> None:
    """Grey lines on the nodes; none without the grid."""
    frames = _two_squares(tmp_path)
    for grid in (True, False):
        seen = _Seen(Painter(frames, Style(grid=grid), [0]))
        scale = seen.scale()
        around = [seen.at(0.75 + k / scale, 0.6).min() for k in range(-2, 3)]
        assert (min(around) < 245.0) == grid
        assert tuple(seen.at(0.65, 0.6)) == WHITE


def test_turned_square_has_no_gaps(tmp_path: Path) -> None:
    """A body turned by 45 degrees is drawn of turned squares: no white pixel inside."""
    body = square_body((0.25, 0.25), 8, 0.0625, (1, 0, 0))
    write_frame(tmp_path, 0, 0.0, {"a": body}, (2, 2))
    turned = dict(body)
    offset = body["position"][:, :2] - 0.5
    c = math.sqrt(0.5)
    turned["position"] = body["position"].copy()
    turned["position"][:, :2] = 0.5 + offset @ [[c, c], [-c, c]]
    write_frame(tmp_path, 1, 1.0, {"a": turned}, (2, 2))
    seen = _Seen(Painter(Frames(tmp_path), Style(limits=(0, 4), grid=False), [1]))
    # Lines in both diagonal directions, nearly from side to side.
    for t in np.linspace(-0.24, 0.24, 201):
        for s in (-0.2, 0.01, 0.2):
            for x, y in ((t + s, t - s), (t + s, s - t)):
                if abs(x + y) < 0.34 and abs(x - y) < 0.34:
                    assert seen.at(0.5 + x, 0.5 + y).max() < 200.0
    # Thin seams are blurred by up to a pixel: 7 lines of 0.5 m in two directions, and the outline.
    scale = seen.scale()
    assert abs(seen.count(_colour(0.25)) - (0.5 * scale) ** 2) < (2 * 7 + 4) * 0.5 * scale * 2


def test_deformation_of_neighbours() -> None:
    """A linear motion is found exactly; points that were thrown together say nothing."""
    x = square_body((0, 0), 5, 0.1)["position"][:, :2]
    f = np.array([[1.2, 0.3], [-0.1, 0.9]])
    deformation = Deformation(x, np.full(25, 0.1))
    gradient, sound = deformation.gradients(x @ f.T + [1.0, 2.0])
    assert sound.all()
    assert np.abs(gradient - f).max() < 100 * EPS
    _, sound = deformation.gradients(np.random.default_rng(1).permutation(x))
    assert not sound.any()
    # A row has neighbours in one direction only.
    row = np.column_stack([0.1 * np.arange(5), np.zeros(5)])
    assert not Deformation(row, np.full(5, 0.1)).gradients(row)[1].any()
    # Neighbours of random points: those that all distances tell.
    some = np.random.default_rng(2).uniform(-1.0, 1.0, (300, 2))
    found = Deformation(some, np.full(300, 0.1))
    gap = np.sqrt(((some[:, None] - some[None]) ** 2).sum(axis=2))
    near = {(i, j) for i, j in np.argwhere(gap <= 0.16).tolist() if i != j}
    assert {*zip(found.first.tolist(), found.second.tolist(), strict=True)} == near
    assert len(found.first) == len(near)
    burst = np.array([[0.0, 0.0], [1e300, 0.0], [0.1, 0.1]])
    assert surface_points(burst, np.full(3, 0.1)).all()
    outside = surface_points(x, np.full(25, 0.1)).reshape(5, 5)
    assert not outside[1:-1, 1:-1].any()
    assert outside.sum() == 16


def test_mirrored_meridian_section(tmp_path: Path) -> None:
    """TYPE 4: the square at r = 0.5 is at -0.5 as well; other types refuse."""
    body = square_body((0.375, 0.375), 2, 0.125, (1, 0, 0))
    body["volume"] = body["volume"] * body["position"][:, 0]
    write_frame(tmp_path, 0, 0.0, {"a": body}, (4, 4))
    frames = Frames(tmp_path, sim_type=4)
    seen = _Seen(Painter(frames, Style(mirror=True, limits=(0, 4)), [0]))
    for r, there in ((0.56, True), (-0.56, True), (0.3, False), (-0.3, False), (0.2, False)):
        assert (np.abs(seen.at(r, 0.56) - _colour(0.25)).max() <= 1) == there
    assert seen.axes[0].get_xlim() == (-1.0, 1.0)
    assert seen.axes[0].get_xlabel() == "r (m)"
    # Sides are those of the areas in the plane, not of the volumes.
    assert Painter(frames, Style(), [0])._side(frames[0]["a"], "a") == pytest.approx([0.125] * 4)
    for style in (Style(mirror=True), Style(revolve=True)):
        with pytest.raises(PygenError, match="TYPE 4"):
            Painter(Frames(tmp_path), style, [0])


def test_camera_sees_boxes_as_they_are() -> None:
    """A unit cube from the front and from above at 45 degrees: areas of its faces, and order."""
    corners, _, light = Camera(azimuth=-90.0, elevation=0.0).faces(
        np.zeros((1, 3)), np.full((1, 3), 0.5)
    )
    # Looking along y: x is to the right and z up; one face, straight on.
    assert corners.shape == (1, 4, 2)
    assert sorted(map(tuple, np.round(corners[0], 12).tolist())) == [
        (-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5),
    ]  # fmt: skip
    assert light[0] == pytest.approx(0.56)
    camera = Camera(azimuth=30.0, elevation=35.0)
    assert camera.frame @ camera.frame.T == pytest.approx(np.eye(3), abs=4 * EPS)
    corners, box, _ = camera.faces(np.array([[0.0, 0, 0], [3.0, 0, 0]]), np.full((2, 3), 0.5))
    x, y = np.moveaxis(corners, 2, 0)
    areas = 0.5 * np.abs(np.sum(x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1), axis=1))
    # Each face shows its share of the direction to the viewer; the nearer box comes last.
    assert sorted(areas[:3]) == pytest.approx(sorted(np.abs(camera.frame[2])), rel=16 * EPS)
    assert box.tolist() == [0, 0, 0, 1, 1, 1]


def test_near_cubes_hide_far_ones(tmp_path: Path) -> None:
    """3D: where two cubes lie behind each other, the nearer one's colour is seen."""
    near = square_body((0.1, 0.1, 0.4), 2, 0.1, (1, 0, 0))
    far = square_body((0.1, 0.7, 0.4), 2, 0.1, (0, 3, 0))
    write_frame(tmp_path, 0, 0.0, {"far": far, "near": near}, (2, 2, 2))
    front = Camera(azimuth=-90.0, elevation=0.0)
    style = Style(limits=(0, 4), camera=front, grid=False)
    seen = _Seen(Painter(Frames(tmp_path), style, [0]))
    light = 0.55 + 0.45 * 0.56
    assert np.abs(seen.at(0.2, 0.5) - _colour(0.25, light)).max() <= 1.5
    behind = _Seen(Painter(Frames(tmp_path), Style(limits=(0, 4), camera=Camera(90.0, 0.0)), [0]))
    assert np.abs(behind.at(-0.2, 0.5) - _colour(0.75, light)).max() <= 1.5
    assert tuple(seen.at(0.5, 0.5)) == WHITE
    area = seen.count(_colour(0.25, light))
    assert abs(area - (0.2 * seen.scale()) ** 2) <= 4 * 0.2 * seen.scale() * 2


def test_many_points_are_drawn_as_squares(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same place and about the same size as boxes."""
    write_frame(
        tmp_path, 0, 0.0, {"a": square_body((0.4, 0.4, 0.4), 4, 0.05, (1, 0, 0))}, (2, 2, 2)
    )
    monkeypatch.setattr("mpm_pygen.drawing.MOST_BOXES", 10)
    style = Style(limits=(0, 4), camera=Camera(-90.0, 0.0), grid=False)
    seen = _Seen(Painter(Frames(tmp_path), style, [0]))
    assert np.abs(seen.at(0.5, 0.5) - _colour(0.25)).max() <= 2.0
    assert tuple(seen.at(0.3, 0.5)) == WHITE
    assert tuple(seen.at(0.7, 0.5)) == WHITE


def test_revolved_boxes_make_a_ring(tmp_path: Path) -> None:
    """Volumes of the boxes sum to that of the swept ring; a quarter faces the viewer open."""
    r = np.array([[1.0, 0.5]])
    centre, half, axes, source = revolve(r, np.array([0.1]), np.array([True]), (0.0, 270.0))
    assert np.hypot(centre[:, 0], centre[:, 1]) == pytest.approx(1.0)
    assert np.einsum("nij,nkj->nik", axes, axes) == pytest.approx(
        np.tile(np.eye(3), (len(axes), 1, 1)), abs=1e-15
    )
    volume = float(np.sum(8.0 * np.prod(half, axis=1)))
    # The outer side of a box is as long as the outer circle asks for, (1 + 0.05) tan.
    assert 1.5 * math.pi * 0.01 < volume < 1.5 * math.pi * 0.01 * 1.06
    assert set(source.tolist()) == {0}
    angles = np.degrees(np.arctan2(centre[:, 1], centre[:, 0])) % 360.0
    assert angles.max() < 270.0
    inner = revolve(r, np.array([0.1]), np.array([False]), (0.0, 270.0))
    assert len(inner[0]) == 2
    body = square_body((0.0, 0.3), 4, 0.1, (1, 0, 0))
    body["volume"] = body["volume"] * body["position"][:, 0]
    write_frame(tmp_path, 0, 0.0, {"a": body}, (4, 4))
    frames = Frames(tmp_path, sim_type=4)
    style = Style(revolve=True, limits=(0, 4), camera=Camera(0.0, 0.0), grid=False)
    seen = _Seen(Painter(frames, style, [0]))
    # From the front the cut faces are seen at both sides of the axis, up to r = 0.4 in the plane
    # at 45 degrees, and behind them the surface to its full radius.
    for right in (-0.2, 0.2, -0.35, 0.35):
        assert seen.at(right, 0.5).max() < 200.0
    assert tuple(seen.at(0.45, 0.5)) == WHITE
    assert tuple(seen.at(0.2, 0.75)) == WHITE


def test_one_dimension_is_a_curve(tmp_path: Path) -> None:
    """The field is the upright axis; each body has a line through its values."""
    body = square_body((0.25,), 8, 0.0625)
    body["velocity"][:, 0] = np.linspace(-1.0, 1.0, 8)
    write_frame(tmp_path, 0, 0.0, {"a": body, "b": square_body((0.8,), 2, 0.05)}, (4,))
    figure = Painter(Frames(tmp_path), Style(shown="velocity.x"), [0]).figure()
    (axes,) = figure.axes
    first, second = axes.get_lines()[:2]
    assert (
        first.get_xydata().tolist()
        == np.column_stack([body["position"][:, 0], body["velocity"][:, 0]]).tolist()
    )
    assert second.get_ydata().tolist() == [0.0, 0.0]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["a", "b"]
    assert axes.get_ylabel() == "velocity.x (m/s)"
    assert axes.get_xlim() == (0.0, 1.0)


def test_bodies_that_are_not_there_yet_are_grey(tmp_path: Path) -> None:
    """Positions only: grey, and not counted for the limits; inactive points are not drawn."""
    late = square_body((0.5, 0.25), 4, 0.0625)
    there = square_body((0.0, 0.25), 4, 0.0625, (2, 0, 0))
    there["active"][:8] = 0.0
    write_frame(tmp_path, 0, 0.0, {"a": there, "b": {"position": late["position"]}}, (4, 4))
    painter = Painter(Frames(tmp_path), Style(grid=False), [0])
    seen = _Seen(painter)
    assert painter.limits == (1.5, 2.5)
    assert np.abs(seen.at(0.66, 0.4) - 0.75 * 255).max() <= 1.0
    assert tuple(seen.at(0.06, 0.4)) == WHITE
    assert np.abs(seen.at(0.22, 0.4) - _colour(0.5)).max() <= 1.5


def test_gif_moves(tmp_path: Path) -> None:
    """As many pictures as frames, at the asked rate; the body moves by a quarter of the box."""
    frames = _two_squares(tmp_path / "run")
    path = tmp_path / "run.gif"
    style = Style(bodies=["a"], limits=(0, 4), grid=False, width=300)
    movie(frames, path, style=style, rate=20.0)
    middles = []
    with Image.open(path) as gif:
        assert gif.n_frames == 3
        assert gif.info["loop"] == 0
        for k in range(3):
            gif.seek(k)
            assert gif.info["duration"] == 50
            pixels = np.asarray(gif.convert("RGB"), dtype=float)[:, :300]
            near = np.abs(pixels - _colour(0.25)).max(axis=-1) <= 8.0
            middles.append(np.argwhere(near).mean(axis=0))
    steps = np.diff(middles, axis=0)
    assert np.abs(steps[:, 0]).max() < 0.5
    assert steps[0, 1] == pytest.approx(steps[1, 1], abs=1.0)
    assert 30.0 < steps[0, 1] < 75.0


def test_mp4_is_handed_to_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stand-in gets all pixels of all frames; its failure is told."""
    frames = _two_squares(tmp_path / "run")
    program = tmp_path / "ffmpeg"
    program.write_text(
        f'#!/bin/sh\nfor last; do :; done\necho "$@" > {tmp_path}/words\nwc -c > "$last"\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    assert find_ffmpeg() == str(program)
    movie(frames, tmp_path / "run.mp4", [0, 2], Style(width=301), rate=12.5)
    words = (tmp_path / "words").read_text().split()
    width, height = map(int, words[words.index("-s") + 1].split("x"))
    assert int((tmp_path / "run.mp4").read_text()) == 2 * 3 * width * height
    assert words[words.index("-r") + 1] == "12.5"
    program.write_text('#!/bin/sh\necho "no such codec" >&2\nexit 1\n')
    with pytest.raises(OSError, match="no such codec"):
        movie(frames, tmp_path / "run.mp4")
    for name in ("run.avi", "run"):
        with pytest.raises(PygenError, match=r"\.gif or \.mp4"):
            movie(frames, tmp_path / name)
    with pytest.raises(PygenError, match="rate"):
        movie(frames, tmp_path / "run.gif", rate=0.0)


def test_png_with_few_colours_is_nearly_the_same(tmp_path: Path) -> None:
    """A smaller file of the same size and about the same pixels."""
    frames = _two_squares(tmp_path / "run")
    picture(frames, tmp_path / "all.png", [0])
    picture(frames, tmp_path / "few.png", [0], few_colours=32)
    with Image.open(tmp_path / "all.png") as whole, Image.open(tmp_path / "few.png") as small:
        assert whole.size == small.size
        assert len(small.convert("RGB").getcolors(10**6)) <= 32
        gap = np.abs(np.asarray(whole, dtype=float) - np.asarray(small.convert("RGB"), dtype=float))
    assert np.mean(gap) < 2.0
    sizes = [(tmp_path / name).stat().st_size for name in ("few.png", "all.png")]
    assert sizes[0] < sizes[1]


def test_commands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Files of view and history, their default names, lists; errors with status 2 and 4."""
    monkeypatch.chdir(tmp_path)
    _two_squares(tmp_path / "run")
    assert main(["view", "run", "--limits", "0", "4", "--width", "300"]) == 0
    with Image.open("run.png") as image:
        # The last frame: the lower square is at the right.
        pixels = np.asarray(image, dtype=float)
    columns = np.argwhere(np.abs(pixels[:, :260] - _colour(0.25)).max(axis=-1) <= 1.5)[:, 1]
    assert columns.min() > 150
    assert (
        main(["view", "run", "--time", "0", "0.4", "--field", "velocity.y", "-o", "two.png"]) == 0
    )
    with Image.open("two.png") as image:
        assert image.width == 2 * 480 + 95
    assert main(["view", "run", "--every", "2", "-o", "run.gif", "--width", "200"]) == 0
    with Image.open("run.gif") as gif:
        assert gif.n_frames == 2
    capsys.readouterr()
    assert main(["view", "run", "--list"]) == 0
    assert "a: 16 points; mass" in capsys.readouterr().out
    assert main(["history", "run", "-o", "h.csv", "--plot", "h.png"]) == 0
    assert "3 times, 17 columns" in capsys.readouterr().out
    assert main(["history", "h.csv", "--plot", "again.png"]) == 0
    assert Path("h.png").read_bytes() == Path("again.png").read_bytes()
    for words, message in (
        (["view", "run", "--field", "heat"], "no field 'heat'"),
        (["view", "run", "--frame", "3"], "3 frames"),
        (["view", "run", "--frame", "0", "--time", "0"], "either"),
        (["view", "run", "--bodies", "c"], "no body 'c'"),
        (["view", "run", "--mirror"], "TYPE 4"),
        (["view", "run", "--colours", "nice"], "colour map"),
        (["view", "run", "--zoom", "0", "1"], "4 numbers"),
        (["view", "run", "-o", "a.jpg"], ".png, .gif or .mp4"),
        (["view", "missing"], "no folder"),
        (["history", "run"], "nothing to do"),
    ):
        assert main(words) == 2, words
        assert message in capsys.readouterr().err
    assert main(["view", "run", "-o", "missing/a.png"]) == 4
    assert "cannot write missing/a.png" in capsys.readouterr().err
