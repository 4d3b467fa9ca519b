"""Frames as GIF, by Pillow, and as MP4, by ffmpeg."""

from __future__ import annotations

import io
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, missing_extra
from compoundkin.base.suffixes import suffix_for

# Two colours of a palette differ by more than this, red, green and blue together: no eye misses what is between.
APART = 40
# Of each of red, green and blue so many bits tell which colour of the palette is the nearest.
BITS = 5
LEVELS = 1 << BITS
# Browsers show a frame that should be shorter than this, hundredths of a second, for a tenth of a second.
SHORTEST = 2
# So many frames tell which colours there are; one colour is left for what stays as it was.
SAMPLED, MOST_COLOURS = 6, 255
MP4 = suffix_for("animation", "mp4")
# A frame takes a whole number of this many parts of a second, as in all films made for screens.
CLOCK = 90_000
# H.264 at a quality at which lines stay sharp (0 is lossless, 23 usual).
QUALITY = 18
# The last lines of what ffmpeg says tell why it fails.
TOLD = 4
# What progress reports: how many frames are done, of how many.
Progress: TypeAlias = Callable[[int, int], None]


@dataclass(frozen=True)
class FilmFrames:
    """The frames of a film, made one by one. They are arrays of pixels of one size, each shown for `hold` seconds."""

    frame: Callable[[int], Number]
    count: int
    hold: float
    size: tuple[int, int]


def colour_palette(pixels: Number, most: int) -> Number:
    """Return at most so many colours of some pixels, (..., 3). The most frequent come first, (colours, 3).

    What is drawn in one colour keeps it exactly; edges, whose colours lie between two, go to one nearby.

    >>> colour_palette(np.array([[255, 255, 255], [0, 0, 0], [255, 255, 255], [250, 250, 250]]), 4).tolist()
    [[255, 255, 255], [0, 0, 0]]
    """
    flat = np.reshape(pixels, (-1, 3)).astype(np.int64) @ np.array([1 << 16, 1 << 8, 1])
    colours, counts = np.unique(flat, return_counts=True)
    ordered = colours[np.argsort(-counts, kind="stable")]
    left = np.stack([ordered >> 16, (ordered >> 8) & 255, ordered & 255], axis=-1)
    found: list[Number] = []
    while len(left) and len(found) < most:
        found.append(left[0])
        left = left[np.abs(left - left[0]).sum(axis=1) > APART]
    return np.array(found)


def nearest_table(colours: Number) -> Number:
    """Return which colour of a palette is the nearest to any other. It is a table for `indices`."""
    levels = np.arange(LEVELS) * (256 // LEVELS) + 128 // LEVELS
    any_colour = np.stack(np.meshgrid(levels, levels, levels, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    parts = np.array_split(any_colour, LEVELS)
    nearest = [np.argmin(((part - colours) ** 2).sum(axis=-1), axis=1) for part in parts]
    return np.concatenate(nearest).astype(np.uint8)


def indices(pixels: Number, table: Number) -> Number:
    """Return the numbers of a palette's colours nearest to those of pixels. The pixels are (..., 3)."""
    red, green, blue = np.moveaxis(pixels >> (8 - BITS), -1, 0).astype(np.intp)
    return np.asarray(table[(red * LEVELS + green) * LEVELS + blue])


def gif(frames: FilmFrames, progress: Progress) -> bytes:
    """Return frames, arrays of pixels, as the bytes of a GIF. Each is shown for `hold` seconds.

    Raises InvalidInput where Pillow is not installed, and for more frames a second than a GIF can have.
    """
    image = require_pillow()
    count = frames.count
    if count > 1 and 100.0 * frames.hold < SHORTEST - 1e-9:
        what = f"a GIF has at most {100 // SHORTEST} frames a second"
        raise InvalidInput(Problem("fps", what, "ask for fewer, for more seconds, or for an .mp4"))
    known = {k: frames.frame(k) for k in sorted({count * n // SAMPLED for n in range(SAMPLED)})}
    colours = colour_palette(np.concatenate(list(known.values())), MOST_COLOURS)
    table = nearest_table(colours)

    def images() -> Iterator[Any]:
        for k in range(count):
            numbers = indices(known.pop(k) if k in known else frames.frame(k), table)
            shown = image.frombytes("P", frames.size, numbers.tobytes())
            shown.putpalette(colours.astype(np.uint8).tobytes())
            yield shown
            progress(k + 1, count)

    first, *others = images()
    written = io.BytesIO()
    first.save(
        written,
        "GIF",
        save_all=True,
        append_images=others,
        duration=_durations(count, frames.hold),
        loop=0,
        optimize=False,
    )
    return written.getvalue()


def require_pillow() -> Any:
    """Return Pillow's images. Raises InvalidInput where it is not installed."""
    try:
        from PIL import Image
    except ImportError:
        where = suffix_for("animation", "gif")
        raise missing_extra(where, "GIF needs Pillow", "animation", "save an .svg") from None
    return Image


def _durations(count: int, hold: float) -> list[int]:
    """For how long each frame is shown, milliseconds in whole hundredths of a second whose sum is the whole.

    >>> _durations(4, 0.055)
    [60, 50, 60, 50]
    """
    ends = [round(100.0 * hold * k + 1e-9) for k in range(count + 1)]
    return [10 * (b - a) for a, b in pairwise(ends)]


def require_ffmpeg() -> str:
    """Return where ffmpeg is; raises InvalidInput where it is not installed."""
    found = shutil.which("ffmpeg")
    if found is None:
        remedy = "install it (https://ffmpeg.org), or save a .gif or .svg, which do without"
        raise InvalidInput(Problem(MP4, "MP4 needs the program ffmpeg, which is not on the PATH", remedy))
    return found


def mp4(frames: FilmFrames, progress: Progress) -> bytes:
    """Return frames, arrays of pixels, as the bytes of an MP4 file. Each is shown for `hold` seconds.

    Raises InvalidInput where ffmpeg is not installed or fails, with what it says.
    """
    with TemporaryDirectory() as folder, TemporaryFile() as said:
        path = Path(folder) / "film.mp4"
        words = _words(require_ffmpeg(), frames.size, Fraction(CLOCK, max(1, round(CLOCK * frames.hold))), path)
        with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said) as process:
            try:
                _hand_over(process, frames, progress)
            except BaseException:
                process.kill()
                raise
        if process.returncode or not path.exists():
            said.seek(0)
            raise _failed(said.read().decode("utf-8", "replace"))
        return path.read_bytes()


def _words(program: str, size: tuple[int, int], rate: Fraction, path: Path) -> Sequence[str]:
    """The command: no dates, no versions, one thread, so that the same film is the same file."""
    read = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-video_size", f"{size[0]}x{size[1]}", "-framerate", str(rate)]
    colours = ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"]
    even = ["-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"]
    code = ["-c:v", "libx264", "-preset", "medium", "-crf", str(QUALITY), "-threads", "1", "-pix_fmt", "yuv420p"]
    same = ["-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart"]
    start = [program, "-nostdin", "-hide_banner", "-loglevel", "error", "-y"]
    return [*start, *read, "-i", "-", "-an", *even, *code, *colours, *same, str(path)]


def _hand_over(process: subprocess.Popen[bytes], frames: FilmFrames, progress: Progress) -> None:
    assert process.stdin is not None
    try:
        for k in range(frames.count):
            process.stdin.write(frames.frame(k).tobytes())
            progress(k + 1, frames.count)
        process.stdin.close()
    except BrokenPipeError:
        # it has ended by itself, and says why
        with suppress(BrokenPipeError):
            process.stdin.close()


def _failed(said: str) -> InvalidInput:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    what = "; ".join(lines[-TOLD:]) or "it says nothing"
    return InvalidInput(Problem(MP4, f"ffmpeg failed: {what}", "save a .gif or .svg, which do without it"))
