"""`Animation`: a motion as pictures one after another, saved as GIF, MP4 or SVG."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import Kind, form_of
from compoundkin.files.atomic import write_atomically
from compoundkin.files.saved_files import Savable
from compoundkin.view.animation.frame_caption import Caption
from compoundkin.view.animation.gif import gif, require_pillow
from compoundkin.view.animation.mp4 import mp4, require_ffmpeg
from compoundkin.view.animation.overlays import Arrows, MovingCentre
from compoundkin.view.animation.pixels import pixel_size, pixels, require_cairo
from compoundkin.view.animation.smil import smil
from compoundkin.view.animation.timeline import Timeline
from compoundkin.view.sketch.moving_sketch import MovingSketch
from compoundkin.view.sketch.picture import PAGE, Picture
from compoundkin.view.sketch.shapes import Shape
from compoundkin.view.sketch.svg import NATURAL

# What is told of progress: how many frames are done, of how many.
Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Animation(Savable):
    """A motion as frames, `len(animation)` of them, shown for `seconds`; made by `animate`.

    `timeline` says which poses they show, in which order and when; `sketch` holds the parts that move.
    """

    saved_as: ClassVar[Kind] = "animation"

    sketch: MovingSketch
    timeline: Timeline
    caption: Caption
    arrows: tuple[Arrows, ...] = ()
    centres: tuple[MovingCentre, ...] = ()
    size: float | None = None

    def __len__(self) -> int:
        """How many frames there are."""
        return len(self.timeline.frames)

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return self.timeline.seconds

    def frame(self, k: int) -> Picture:
        """The k-th frame; raises InvalidInput where there is none."""
        if isinstance(k, bool) or not isinstance(k, int) or not -len(self) <= k < len(self):
            raise InvalidInput(Problem("frame", f"there is no frame {k!r}", f"0 to {len(self) - 1}"))
        place = self.timeline.frames[k]
        pose, way = int(self.timeline.poses[place]), int(self.timeline.ways[place])
        shapes = self._shapes(pose, way)
        texts, height = self.caption.shapes(pose)
        window, mechanism = self.sketch.window, self.sketch.scene.mechanism
        said = "; ".join([self.caption.description, *self.caption.notes(pose)])
        shown = (self.caption.paper(height), *shapes, *texts)
        return Picture(shown, window.width, height, mechanism.title, said, self.size, window)

    def _shapes(self, pose: int, way: int) -> list[Shape]:
        """The sketch without its paper at the k-th assembled pose; arrows and centres are below the labels."""
        shapes = self.sketch.shapes(pose)[1:]
        labels = sum(part.is_label for part in self.sketch.parts)
        arrows = [shape for one in self.arrows for shape in one.shapes(pose, way)]
        centres = [shape for one in self.centres for shape in one.shapes(pose)]
        end = len(shapes) - labels
        return [*shapes[:end], *arrows, *centres, *shapes[end:]]

    @cached_property
    def svg(self) -> str:
        """Its source as SVG that moves by itself; the first pose where that is not supported."""
        scale = self.shown_size / self.longer
        return smil(self.timeline, self.caption, self.arrows, self.centres, scale)

    def save(self, path: str | os.PathLike[str], progress: Progress | None = None) -> None:
        """Write it to a .gif, .mp4 or .svg file, whole or not at all; `progress(done, total)` is told of every frame.

        Raises InvalidInput for another suffix, where the file cannot be written, for GIF and MP4 where CairoSVG and
        Pillow are not installed, and for MP4 where there is no ffmpeg or it fails.
        """
        made = self.content(ready_for(path), progress)
        write_atomically(path, lambda file: file.write(made))

    def content(self, form: str, progress: Progress | None = None) -> bytes:
        """The bytes of a file in the form "gif", "mp4" or "svg"; the same every time."""
        if form == "svg":
            (progress or _untold)(len(self), len(self))
            return self.svg.encode("utf-8")
        size = pixel_size(self.sketch.window.width, self.frame(0).height, self.shown_size)
        write = {"gif": gif, "mp4": mp4}[form]
        return write(lambda k: pixels(self.frame(k), *size), len(self), self.timeline.hold, size, progress or _untold)

    @cached_property
    def longer(self) -> float:
        """The longer side of a frame, picture units."""
        return max(self.sketch.window.width, self.frame(0).height)

    @property
    def shown_size(self) -> float:
        """The longer side of a frame in pixels."""
        return min(NATURAL * self.longer, PAGE) if self.size is None else self.size

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"Animation({self.sketch.scene.mechanism.title!r}, {len(self)} frames, {self.seconds:.3g} s)"


def ready_for(path: str | os.PathLike[str]) -> str:
    """The form of a file that can be written; raises InvalidInput where it cannot, before anything is drawn."""
    form = form_of("animation", path)
    if not Path(path).absolute().parent.is_dir():
        raise InvalidInput(Problem(str(path), "it cannot be written: there is no such folder", "make it first"))
    if form == "mp4":
        require_ffmpeg()
    if form != "svg":
        require_cairo(form)
    if form == "gif":
        require_pillow()
    return form


def _untold(done: int, total: int) -> None:
    """Tell nobody of progress."""
