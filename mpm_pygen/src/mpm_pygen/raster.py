"""Shapes from pictures: the pixels of one colour make one body."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mpm_pygen.errors import PygenError
from mpm_pygen.shape import BoolArray, FloatArray, Shape, check_finite, check_positive


@dataclass(frozen=True, eq=False)
class Raster(Shape):
    """Equal cells of a rectangle, some of which are filled.

    Parameters
    ----------
    filled : BoolArray
        `(nx, ny)`, x to the right and y upwards.
    lower : Sequence[float]
        Lower left corner of the rectangle.
    pixel : float
        Side of a cell.
    """

    filled: BoolArray
    lower: Sequence[float]
    pixel: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        check_positive("the side of a pixel", self.pixel)
        check_finite("lower corner of a picture", self.lower)
        if self.filled.ndim != 2 or len(self.lower) != 2 or not np.any(self.filled):
            raise PygenError("a raster has two directions and at least one filled cell")

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The rectangle around the filled cells."""
        columns, rows = np.nonzero(self.filled)
        origin = np.array(self.lower, dtype=float)
        first = np.array([columns.min(), rows.min()])
        last = np.array([columns.max() + 1, rows.max() + 1])
        return origin + first * self.pixel, origin + last * self.pixel

    @property
    def measure(self) -> float:
        """Area of the filled cells."""
        return int(np.count_nonzero(self.filled)) * self.pixel**2

    @property
    def origin(self) -> FloatArray:
        """Lower corner of the bounds."""
        return self.bounds[0]

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """Both."""
        return (0, 1)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are in a filled cell."""
        index = np.floor((x - np.array(self.lower, dtype=float)) / self.pixel).astype(int)
        within = np.all((index >= 0) & (index < self.filled.shape), axis=1)
        found = np.zeros(len(x), dtype=bool)
        found[within] = self.filled[tuple(index[within].T)]
        return found


def read_image(
    path: str | os.PathLike[str],
    *,
    pixel: float,
    lower: Sequence[float] = (0.0, 0.0),
    colours: Sequence[str] | None = None,
    background: str = "#ffffff",
    tolerance: int = 0,
) -> dict[str, Raster]:
    """Read a picture; each colour is a shape.

    Parameters
    ----------
    path : str or PathLike
        PNG, or what else Pillow reads.
    pixel : float
        Side of a pixel. [m]
    lower : Sequence[float]
        Position of the lower left corner of the picture.
    colours : Sequence[str], optional
        Colours to take, as "#rrggbb"; all but the background when left out.
    background : str
        Colour of nothing. Pixels that are more than half transparent are nothing as well.
    tolerance : int
        How far red, green and blue of a pixel (0 to 255) may be from those of `colours`.

    Returns
    -------
    dict[str, Raster]
        By colour, "#rrggbb", in the order of `colours`, or of the number of pixels.
    """
    pixels = _read_pixels(Path(path))
    # Rows of a picture go downwards.
    pixels = np.swapaxes(pixels[::-1], 0, 1)
    rgb = pixels[..., :3].astype(int)
    opaque = pixels[..., 3] >= 128
    if colours is None:
        if tolerance:
            raise PygenError("a tolerance needs the colours that it is about")
        code = (rgb[..., 0] << 16) | (rgb[..., 1] << 8) | rgb[..., 2]
        codes, counts = np.unique(code[opaque], return_counts=True)
        names = [f"#{c:06x}" for c in codes[np.argsort(-counts, kind="stable")].tolist()]
        found = [name for name in names if name != background.lower()]
        if len(found) > 64:
            raise PygenError(
                f"{path} has {len(found)} colours; name those to take, with a tolerance"
            )
        colours = found
    shapes: dict[str, Raster] = {}
    for colour in colours:
        near = np.abs(rgb - _components(colour)).max(axis=-1) <= tolerance
        if not np.any(near & opaque):
            raise PygenError(f"{path} has no pixel of the colour {colour}")
        shapes[colour.lower()] = Raster(near & opaque, lower, pixel)
    if not shapes:
        raise PygenError(f"{path} has no pixel that is not background")
    return shapes


def _read_pixels(path: Path) -> NDArray[np.uint8]:
    """Read red, green, blue and opacity, `(rows, columns, 4)`."""
    try:
        from PIL import Image, UnidentifiedImageError
    except ImportError:
        raise PygenError("pictures need the package Pillow (Debian: python3-pil)") from None
    try:
        with Image.open(path) as picture:
            return np.asarray(picture.convert("RGBA"), dtype=np.uint8)
    except UnidentifiedImageError:
        raise PygenError(f"{path}: this is no picture that Pillow reads") from None


def _components(colour: str) -> NDArray[np.int_]:
    """Give red, green and blue of "#rrggbb"."""
    digits = colour.removeprefix("#")
    try:
        value = int(digits, 16)
    except ValueError:
        value = -1
    if len(digits) != 6 or value < 0:
        raise PygenError(f"a colour is written #rrggbb, not {colour!r}")
    return np.array([value >> 16, value >> 8 & 255, value & 255])
