"""Frames as MP4, by ffmpeg, to which they are handed as they are drawn."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.base.suffixes import suffix_for

MP4 = suffix_for("animation", "mp4")
# A frame takes a whole number of this many parts of a second, as in all films made for screens.
CLOCK = 90_000
# H.264 at a quality at which lines stay sharp (0 is lossless, 23 usual).
QUALITY = 18
# The last lines of what ffmpeg says tell why it fails.
TOLD = 4


def require_ffmpeg() -> str:
    """Where ffmpeg is; raises InvalidInput where it is not installed."""
    found = shutil.which("ffmpeg")
    if found is None:
        remedy = "install it (https://ffmpeg.org), or save a .gif or .svg, which do without"
        raise InvalidInput(Problem(MP4, "MP4 needs the program ffmpeg, which is not on the PATH", remedy))
    return found


def mp4(
    frame: Callable[[int], Number],
    count: int,
    hold: float,
    size: tuple[int, int],
    progress: Callable[[int, int], None],
) -> bytes:
    """Frames, arrays of pixels shown for `hold` seconds each, as the bytes of an MP4 file.

    Raises InvalidInput where ffmpeg is not installed or fails, with what it says.
    """
    with TemporaryDirectory() as folder, TemporaryFile() as said:
        path = Path(folder) / "film.mp4"
        words = _words(require_ffmpeg(), size, Fraction(CLOCK, max(1, round(CLOCK * hold))), path)
        with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said) as process:
            try:
                _hand_over(process, frame, count, progress)
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


def _hand_over(
    process: subprocess.Popen[bytes], frame: Callable[[int], Number], count: int, progress: Callable[[int, int], None]
) -> None:
    assert process.stdin is not None
    try:
        for k in range(count):
            process.stdin.write(frame(k).tobytes())
            progress(k + 1, count)
        process.stdin.close()
    except BrokenPipeError:
        # it has ended by itself, and says why
        with suppress(BrokenPipeError):
            process.stdin.close()


def _failed(said: str) -> InvalidInput:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    what = "; ".join(lines[-TOLD:]) or "it says nothing"
    return InvalidInput(Problem(MP4, f"ffmpeg failed: {what}", "save a .gif or .svg, which do without it"))
