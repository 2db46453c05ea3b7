"""Pictures and movies in files: PNG, GIF, MP4."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mpm_pygen.drawing import Painter, Style
from mpm_pygen.errors import PygenError
from mpm_pygen.frames import Frames

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pixels = NDArray[np.uint8]


def picture(
    frames: Frames,
    path: str | os.PathLike[str],
    numbers: Sequence[int] = (-1,),
    style: Style | None = None,
    *,
    few_colours: int = 0,
) -> None:
    """Draw frames side by side into a PNG file.

    Parameters
    ----------
    frames : Frames
        The run.
    path : str or PathLike
        The file.
    numbers : Sequence[int]
        Places of the frames; the last one when left out.
    style : Style, optional
        What to show.
    few_colours : int
        Largest number of colours of the file, up to 256, which makes it smaller; 0: all.
    """
    chosen = [_place(frames, number) for number in numbers]
    pixels = render(Painter(frames, style or Style(), chosen).figure())
    save_png(pixels, path, few_colours)


def movie(
    frames: Frames,
    path: str | os.PathLike[str],
    numbers: Sequence[int] | None = None,
    style: Style | None = None,
    *,
    rate: float = 15.0,
) -> None:
    """Draw frames one after the other into a GIF or MP4 file.

    Parameters
    ----------
    frames : Frames
        The run.
    path : str or PathLike
        The file; .mp4 needs ffmpeg, or the package imageio-ffmpeg.
    numbers : Sequence[int], optional
        Places of the frames; all when left out.
    style : Style, optional
        What to show.
    rate : float
        Frames per second of the movie.
    """
    path = Path(path)
    if not 0.0 < rate <= 100.0:
        raise PygenError(f"a movie has a rate above 0, up to 100 frames per second, not {rate!r}")
    chosen = range(len(frames)) if numbers is None else [_place(frames, k) for k in numbers]
    pictures = _pictures(frames, chosen, style or Style())
    if path.suffix.lower() == ".gif":
        _save_gif(pictures, path, rate)
    elif path.suffix.lower() == ".mp4":
        _save_mp4(pictures, path, rate)
    else:
        raise PygenError(f"a movie is a file .gif or .mp4, not {path.name}")


def render(figure: Figure) -> Pixels:
    """Draw a figure of Matplotlib without a screen.

    Parameters
    ----------
    figure : Figure
        What to draw.

    Returns
    -------
    Pixels
        `(height, width, 3)`.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba())[..., :3].copy()


def save_png(pixels: Pixels, path: str | os.PathLike[str], few_colours: int = 0) -> None:
    """Write a picture.

    Parameters
    ----------
    pixels : Pixels
        `(height, width, 3)`.
    path : str or PathLike
        The file.
    few_colours : int
        Largest number of colours, up to 256; 0: all.
    """
    from PIL import Image

    image = Image.fromarray(pixels)
    if few_colours:
        if not 2 <= few_colours <= 256:
            raise PygenError(f"few colours are 2 to 256, not {few_colours}")
        image = image.quantize(
            few_colours, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
        )
    image.save(path, format="PNG", optimize=True)


def find_ffmpeg() -> str | None:
    """Look for ffmpeg on the PATH, and in the package imageio-ffmpeg."""
    found = shutil.which("ffmpeg")
    if found:
        return found
    try:
        import imageio_ffmpeg
    except ImportError:
        return None
    return str(imageio_ffmpeg.get_ffmpeg_exe())


def _pictures(frames: Frames, numbers: Sequence[int], style: Style) -> Iterator[Pixels]:
    """Draw frame after frame in one layout, with the limits of all."""
    painter = Painter(frames, style, numbers)
    painter.numbers = [numbers[0]]
    figure = painter.figure()
    yield render(figure)
    # The layout of the first frame stays: to find one takes longer than to draw.
    figure.set_layout_engine("none")
    for number in numbers[1:]:
        figure.axes[0].clear()
        painter.draw(figure.axes[0], frames[number])
        yield render(figure)


def _save_gif(pictures: Iterator[Pixels], path: Path, rate: float) -> None:
    """Write a GIF that repeats for ever."""
    from PIL import Image

    images = [Image.fromarray(p).quantize(128, dither=Image.Dither.NONE) for p in pictures]
    # Times of a GIF are whole hundredths of a second.
    duration = 10 * max(1, round(100.0 / rate))
    images[0].save(
        path, format="GIF", save_all=True, append_images=images[1:], duration=duration, loop=0
    )


def _save_mp4(pictures: Iterator[Pixels], path: Path, rate: float) -> None:
    """Hand the pictures to ffmpeg."""
    program = find_ffmpeg()
    if program is None:
        raise PygenError(
            "an MP4 file needs ffmpeg on the PATH, or the package imageio-ffmpeg; "
            "a GIF file needs neither"
        )
    first = next(pictures)
    height, width, _ = first.shape
    command = [program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    command += ["-s", f"{width}x{height}", "-r", f"{rate:g}", "-i", "-"]
    # Sides of a video are even numbers.
    command += ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p"]
    command += ["-f", "mp4", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdin is not None and process.stderr is not None
        try:
            process.stdin.write(first.tobytes())
            for pixels in pictures:
                process.stdin.write(pixels.tobytes())
            process.stdin.close()
        except BrokenPipeError:
            pass
        message = process.stderr.read().decode(errors="replace").strip()
    if process.returncode != 0:
        raise OSError(
            None, f"ffmpeg: {message.splitlines()[-1] if message else 'failed'}", str(path)
        )


def _place(frames: Frames, number: int) -> int:
    """Give the place of a frame from the start."""
    if not -len(frames) <= number < len(frames):
        raise PygenError(f"there are {len(frames)} frames, from 0 on, and no number {number}")
    return number % len(frames)
