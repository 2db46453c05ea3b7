"""Pictures of frames, drawn with Matplotlib without a screen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from mpm_pygen.camera import Camera, revolve
from mpm_pygen.clouds import Cloud, label
from mpm_pygen.deformation import MOST_POINTS, Deformation, surface_points
from mpm_pygen.errors import PygenError
from mpm_pygen.frames import Frame, Frames
from mpm_pygen.shape import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

#: More boxes than this are drawn as squares that face the viewer.
MOST_BOXES = 40_000
GREY = (0.75, 0.75, 0.75, 1.0)


@dataclass(frozen=True)
class Style:
    """What a picture shows.

    Parameters
    ----------
    shown : str
        Field, as in the brackets of a `Cloud`; vectors and tensors by their magnitude.
    bodies : Sequence[str], optional
        All when left out.
    limits : tuple[float, float], optional
        Values of the ends of the colours; those of the frames when left out.
    colours : str
        Name of a colour map of Matplotlib.
    grid : bool
        Draw the lines of the grid.
    mirror : bool
        TYPE 4: draw the other half of the meridian section too.
    revolve : bool
        TYPE 4: draw the body in 3D, with a quarter cut out.
    camera : Camera
        Of 3D views.
    width : int
        Of one frame. [pixels]
    zoom : Sequence[float], optional
        Lower and upper end of each direction of the picture; the whole grid when left out.
    """

    shown: str = "speed"
    bodies: Sequence[str] | None = None
    limits: tuple[float, float] | None = None
    colours: str = "viridis"
    grid: bool = True
    mirror: bool = False
    revolve: bool = False
    camera: Camera = field(default_factory=Camera)
    width: int = 480
    zoom: Sequence[float] | None = None


class Painter:
    """Draws frames of a run in one style.

    Parameters
    ----------
    frames : Frames
        The run.
    style : Style
        What to show.
    numbers : Sequence[int]
        Places of the frames that will be drawn; they give the limits of the colours.
    """

    def __init__(self, frames: Frames, style: Style, numbers: Sequence[int]) -> None:
        need_matplotlib()
        self.frames, self.style, self.numbers = frames, style, list(numbers)
        self.bodies = list(style.bodies) if style.bodies else frames.bodies
        for body in self.bodies:
            if body not in frames.bodies:
                raise PygenError(f"there is no body {body!r}; there are {', '.join(frames.bodies)}")
        self.sim_type = frames.sim_type
        if (style.mirror or style.revolve) and self.sim_type != 4:
            raise PygenError(
                "mirroring and revolving are for TYPE 4 (name the config, or the type)"
            )
        self.lines = frames.grid_lines()
        self.sides = {body: self._first_side(body) for body in self.bodies}
        self.limits = style.limits or self._limits()
        self.box = self._box()
        #: Lowest and highest value that was drawn.
        self.drawn = (math.inf, -math.inf)
        self.deformations = {} if self.solid or self.sim_type == 1 else self._deformations()

    @property
    def solid(self) -> bool:
        """Tell whether the view is one of 3D."""
        return self.sim_type == 3 or self.style.revolve

    def figure(self) -> Figure:
        """Draw the frames side by side, with one colour bar."""
        from matplotlib.figure import Figure

        count = len(self.numbers)
        width, height = self._size()
        room = 0.0 if self.sim_type == 1 else 0.95
        figure = Figure(figsize=(count * width + room, height), dpi=100.0)
        figure.set_layout_engine("constrained", h_pad=0.08, w_pad=0.06)
        panels = figure.subplots(1, count, squeeze=False)[0]
        drawn: ScalarMappable | None = None
        for panel, number in zip(panels, self.numbers, strict=True):
            drawn = self.draw(panel, self.frames[number])
        if drawn is not None:
            low, high = self.drawn
            ends = {(True, True): "both", (True, False): "min", (False, True): "max"}
            bar = figure.colorbar(
                drawn,
                ax=list(panels),
                pad=0.02,
                shrink=0.85,
                aspect=25,
                extend=ends.get((low < self.limits[0], high > self.limits[1]), "neither"),
            )
            bar.set_label(label(self.style.shown), size=9)
            bar.ax.tick_params(labelsize=8)
        return figure

    def draw(self, axes: Axes, frame: Frame) -> ScalarMappable | None:
        """Draw a frame.

        Parameters
        ----------
        axes : Axes
            Where.
        frame : Frame
            What.

        Returns
        -------
        ScalarMappable or None
            For the colour bar; none in TYPE 1, where the field is the upright axis.
        """
        axes.set_title(f"t = {frame.time:.{self._decimals()}f} s", fontsize=10)
        if self.sim_type == 1:
            self._draw_line(axes, frame)
            return None
        import matplotlib as mpl
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        if self.style.colours not in mpl.colormaps:
            raise PygenError(f"Matplotlib has no colour map {self.style.colours!r}")
        colours = ScalarMappable(Normalize(*self.limits), mpl.colormaps[self.style.colours])
        if self.solid:
            self._draw_solid(axes, frame, colours)
        else:
            self._draw_plane(axes, frame, colours)
        axes.set_aspect("equal")
        return colours

    def _draw_line(self, axes: Axes, frame: Frame) -> None:
        """Draw the field over x."""
        for k, body in enumerate(self.bodies):
            cloud = frame.points(body)
            values = _values(cloud, self.style.shown)
            if values is not None:
                kept = cloud.active
                x, y = cloud.position[kept, 0], values[kept]
                axes.plot(x, y, ".-", color=f"C{k}", markersize=4, linewidth=0.8, label=body)
        if self.style.grid and self.lines:
            for x in self.lines[0]:
                axes.axvline(x, color="0.9", linewidth=0.5, zorder=0)
        low, high = self.limits
        margin = 0.05 * (high - low)
        axes.set(xlim=self.box[:2], ylim=(low - margin, high + margin))
        axes.set_xlabel("x (m)", fontsize=9)
        axes.set_ylabel(label(self.style.shown), fontsize=9)
        axes.tick_params(labelsize=8)
        axes.legend(fontsize=8, loc="best")

    def _draw_plane(self, axes: Axes, frame: Frame, colours: ScalarMappable) -> None:
        """Draw points as squares of their areas."""
        from matplotlib.collections import LineCollection, PolyCollection

        signs = (1.0, -1.0) if self.style.mirror else (1.0,)
        left, right, low, high = self.box
        if self.style.grid and len(self.lines) == 2:
            xs, ys = self.lines
            segments = [[(s * x, ys[0]), (s * x, ys[-1])] for s in signs for x in xs]
            segments += [[(s * xs[0], y), (s * xs[-1], y)] for s in signs for y in ys]
            axes.add_collection(LineCollection(segments, colors="0.88", linewidths=0.5, zorder=0))
        elif self.style.grid:
            # The nodes of a mesh make no lines.
            nodes = self.frames.grid_nodes()
            for sign in signs:
                axes.plot(
                    sign * nodes[:, 0], nodes[:, 1], ".", color="0.8", markersize=1.5, zorder=0
                )
        for body in self.bodies:
            cloud = frame.points(body)
            outlines = self._outlines(cloud, body)[cloud.active]
            paint = self._paint(cloud, colours)[cloud.active]
            for sign in signs:
                squares: Any = outlines * [sign, 1.0]
                axes.add_collection(
                    PolyCollection(
                        squares, facecolors=paint, edgecolors=paint, linewidths=0.8, snap=False
                    )
                )
        if self.style.mirror:
            axes.axvline(0.0, color="0.4", linewidth=0.6, dashes=(6, 3, 1, 3))
        axes.set(xlim=(left, right), ylim=(low, high))
        names = ("r", "z") if self.sim_type == 4 else ("x", "y")
        axes.set_xlabel(f"{names[0]} (m)", fontsize=9)
        axes.set_ylabel(f"{names[1]} (m)", fontsize=9)
        axes.tick_params(labelsize=8)

    def _draw_solid(self, axes: Axes, frame: Frame, colours: ScalarMappable) -> None:
        """Draw points as boxes of their volumes, or squares when they are many."""
        from matplotlib.collections import LineCollection, PolyCollection

        camera = self.style.camera
        lists: tuple[list[FloatArray], ...] = ([], [], [], [])
        for body in self.bodies:
            cloud = frame.points(body)
            kept = cloud.active
            x, side = cloud.position[kept], self._side(cloud, body)[kept]
            paint = self._paint(cloud, colours)[kept]
            if self.style.revolve:
                sweep = (camera.azimuth + 45.0, camera.azimuth + 315.0)
                outside = surface_points(x[:, :2], side)
                centre, half, turn, source = revolve(x[:, :2], side, outside, sweep)
                paint = paint[source]
            else:
                centre, half = x, np.repeat(0.5 * side[:, None], 3, axis=1)
                turn = np.broadcast_to(np.eye(3), (len(x), 3, 3))
            for found, part in zip(lists, (centre, half, turn, paint), strict=True):
                found.append(part)
        centre, half, turn, paint = map(np.concatenate, lists)
        lower, upper = self._domain()
        if self.style.grid:
            edges: Any = camera.box_edges(lower, upper)
            axes.add_collection(LineCollection(edges, colors="0.7", linewidths=0.7, zorder=0))
            if len(self.lines) == 3 and camera.elevation > 0.0:
                floor: Any = self._floor(lower, upper)
                axes.add_collection(LineCollection(floor, colors="0.9", linewidths=0.4, zorder=0))
            self._name_axes(axes, lower, upper)
        if len(centre) > MOST_BOXES and not self.style.revolve:
            self._draw_squares(axes, centre, half, paint)
        else:
            faces: Any
            faces, box, light = camera.faces(centre, half, turn)
            shown = paint[box].copy()
            shown[:, :3] *= (0.55 + 0.45 * light)[:, None]
            axes.add_collection(
                PolyCollection(
                    faces, facecolors=shown, edgecolors=shown, linewidths=0.8, snap=False
                )
            )
        left, right, low, high = self.box
        axes.set(xlim=(left, right), ylim=(low, high), xticks=[], yticks=[])
        for spine in axes.spines.values():
            spine.set_visible(False)

    def _draw_squares(
        self, axes: Axes, centre: FloatArray, half: FloatArray, paint: FloatArray
    ) -> None:
        """Draw many points as squares, darker at the back."""
        seen = self.style.camera.project(centre)
        order = np.argsort(seen[:, 2], kind="stable")
        near, far = seen[order[-1], 2], seen[order[0], 2]
        shown = paint[order].copy()
        shown[:, :3] *= 0.6 + 0.4 * ((seen[order, 2] - far) / max(near - far, 1e-300))[:, None]
        left, right, _, _ = self.box
        points_per_metre = 0.72 * self.style.width / (right - left)
        size = (2.0 * half[order, 0] * points_per_metre) ** 2
        axes.scatter(seen[order, 0], seen[order, 1], s=size, c=shown, marker="s", linewidths=0)

    def _floor(self, lower: FloatArray, upper: FloatArray) -> FloatArray:
        """Give the lines of the grid on the floor, `(n, 2, 2)`."""
        xs, ys, _ = self.lines
        z = lower[2]
        ends = [[(x, lower[1], z), (x, upper[1], z)] for x in xs]
        ends += [[(lower[0], y, z), (upper[0], y, z)] for y in ys]
        seen = self.style.camera.project(np.array(ends).reshape(-1, 3))
        return seen[:, :2].reshape(-1, 2, 2)

    def _name_axes(self, axes: Axes, lower: FloatArray, upper: FloatArray) -> None:
        """Write x, y, z at the lower edges of the domain that are in front."""
        camera = self.style.camera
        towards = camera.frame[2]
        front = np.where(towards > 0.0, upper, lower)
        for k, name in enumerate("xyz"):
            place = front.copy()
            place[k] = 0.5 * (lower[k] + upper[k])
            if k < 2:
                place[2] = lower[2]
            else:
                # The upright edge at the left of the picture.
                ends = [(x, y) for x in (lower[0], upper[0]) for y in (lower[1], upper[1])]
                place[:2] = min(ends, key=lambda end: float(camera.frame[0, :2] @ end))
            right, up, _ = camera.project(place[None])[0]
            middle = camera.project(0.5 * (lower + upper)[None])[0]
            shift = 0.05 * (np.array([right, up]) - middle[:2])
            axes.text(
                right + shift[0],
                up + shift[1],
                name,
                fontsize=9,
                color="0.3",
                ha="center",
                va="center",
                clip_on=True,
            )

    def _paint(self, cloud: Cloud, colours: ScalarMappable) -> FloatArray:
        """Give the colour of each point; grey when it has no such field."""
        values = _values(cloud, self.style.shown)
        if values is None:
            return np.tile(np.array(GREY), (len(cloud), 1))
        if np.any(cloud.active):
            seen = values[cloud.active]
            low, high = self.drawn
            self.drawn = min(low, float(seen.min())), max(high, float(seen.max()))
        return np.asarray(colours.to_rgba(values), dtype=np.float64)

    def _side(self, cloud: Cloud, body: str) -> FloatArray:
        """Give the sides of the squares or cubes: of the volume, or as in the first frame."""
        volume = cloud.fields.get("volume")
        if volume is None:
            return np.full(len(cloud), self.sides[body])
        if self.sim_type == 4:
            volume = volume / cloud.position[:, 0]
        return np.asarray(np.maximum(volume, 0.0) ** (1.0 / (3 if self.sim_type == 3 else 2)))

    def _first_side(self, body: str) -> float:
        """Give a typical side of the points in the first frame."""
        cloud = self.frames[0].points(body)
        if "volume" in cloud.fields:
            return float(np.median(self._side(cloud, body)))
        return _sides(self.frames, body)

    def _outlines(self, cloud: Cloud, body: str) -> FloatArray:
        """Give the corners of the points, `(n, 4, 2)`: deformed squares, as neighbours went."""
        side = self._side(cloud, body)
        corners = 0.5 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        offsets = side[:, None, None] * corners
        deformation = self.deformations.get(body)
        if deformation is not None and len(cloud) == len(deformation.start):
            gradient, sound = deformation.gradients(cloud.position[:, :2])
            turned = np.einsum("nij,kj->nki", gradient, corners)
            offsets[sound] = deformation.side[sound, None, None] * turned[sound]
        return np.asarray(cloud.position[:, None, :2] + offsets)

    def _deformations(self) -> dict[str, Deformation]:
        """Take the first frame as the undeformed state of each body."""
        found = {}
        for body in self.bodies:
            cloud = self.frames[0].points(body)
            if 2 < len(cloud) <= MOST_POINTS:
                side = self._side(cloud, body)
                found[body] = Deformation(cloud.position[:, :2], side)
        return found

    def _limits(self) -> tuple[float, float]:
        """Give the extreme values of all frames to be drawn."""
        low, high, known = math.inf, -math.inf, False
        for number in self.numbers:
            for body in self.bodies:
                cloud = self.frames[number].points(body)
                values = _values(cloud, self.style.shown)
                if values is not None and np.any(cloud.active):
                    low = min(low, float(values[cloud.active].min()))
                    high = max(high, float(values[cloud.active].max()))
                    known = True
        if not known:
            _ = self.frames[self.numbers[-1]].points(self.bodies[0])[self.style.shown]
            return 0.0, 1.0
        # Colours need a span, also for a field that is the same everywhere but for round-off.
        span = 1e-9 * max(abs(low), abs(high))
        return (low, high) if high - low > span else (low - 0.5, high + 0.5)

    def _domain(self) -> tuple[FloatArray, FloatArray]:
        """Give the corners of the region in which the points are drawn."""
        if self.lines:
            lower = np.array([line[0] for line in self.lines])
            upper = np.array([line[-1] for line in self.lines])
        else:
            clouds = [self.frames[k].points(body) for k in self.numbers for body in self.bodies]
            x = np.concatenate([cloud.position[cloud.active] for cloud in clouds])
            dimension = (1, 2, 3, 2, 2)[self.sim_type - 1]
            lower, upper = x[:, :dimension].min(axis=0), x[:, :dimension].max(axis=0)
            margin = 0.05 * float(np.max(upper - lower)) + max(self.sides.values())
            lower, upper = lower - margin, upper + margin
            if self.sim_type == 4:
                lower[0] = 0.0
        if self.style.revolve:
            radius = upper[0]
            lower = np.array([-radius, -radius, lower[1]])
            upper = np.array([radius, radius, upper[1]])
        return lower, upper

    def _box(self) -> list[float]:
        """Give the ends of the picture: left, right, low, high."""
        if self.style.zoom is not None:
            wanted = 2 if self.sim_type == 1 else 4
            if len(self.style.zoom) != wanted:
                raise PygenError(f"a zoom has {wanted} numbers here: lower and upper ends")
            return [float(end) for end in self.style.zoom]
        lower, upper = self._domain()
        if self.solid:
            ends = np.stack([lower, upper])
            corners = np.stack(np.meshgrid(*ends.T, indexing="ij"), axis=-1).reshape(-1, 3)
            seen = self.style.camera.project(corners)[:, :2]
            lower, upper = seen.min(axis=0), seen.max(axis=0)
            margin = 0.04 * float(np.max(upper - lower))
            lower, upper = lower - margin, upper + margin
        elif self.style.mirror:
            lower[0] = -upper[0]
        return [float(end) for pair in zip(lower, upper, strict=True) for end in pair]

    def _size(self) -> tuple[float, float]:
        """Give width and height of one frame in inches."""
        width = self.style.width / 100.0
        if self.sim_type == 1:
            return width, 0.62 * width
        left, right, low, high = self.box
        # Labels and title need their room, whatever the shape of the domain is.
        room = (0.0, 0.3) if self.solid else (0.55, 0.75)
        ratio = (high - low) / (right - left)
        return width, min(max((width - room[0]) * ratio + room[1], 1.2), 3.0 * width)

    def _decimals(self) -> int:
        """Give as many decimals as tell the frames apart."""
        span = float(np.ptp(self.frames.times))
        return max(0, min(9, 2 - math.floor(math.log10(span)))) if span > 0.0 else 3


def _values(cloud: Cloud, name: str) -> FloatArray | None:
    """Give a field, or None for a body that is not there yet and has positions only."""
    if "velocity" not in cloud.fields and name not in cloud.names:
        return None
    return cloud.scalar(name)


def _sides(frames: Frames, body: str) -> float:
    """Estimate the side of a point that has no volume: the distance of neighbours at the start."""
    x = frames[0].points(body).position
    if len(x) < 2:
        return 0.0
    # A few points tell it.
    some = x[:: max(1, len(x) // 200)]
    distances = []
    for point in some:
        square = np.sum((x - point) ** 2, axis=1)
        distances.append(math.sqrt(float(np.partition(square, 1)[1])))
    return float(np.median(distances))


def need_matplotlib() -> None:
    """Say what to do when Matplotlib is not there."""
    if find_spec("matplotlib") is None:
        raise PygenError("pictures need the package matplotlib (Debian: python3-matplotlib)")
