"""`animate` and `Animation`: a motion as pictures one after another, saved as GIF, MP4 or SVG."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import ChangePointWarning, InvalidInput, Problem, UnassembledPoses
from compoundkin.base.suffixes import Kind, file_format
from compoundkin.dynamics.forces import Forces
from compoundkin.files.atomic import write_atomically
from compoundkin.files.saved_files import Savable
from compoundkin.kinematics import Motion, solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure
from compoundkin.view.animation.films import FilmFrames, Progress, gif, mp4, require_ffmpeg, require_pillow
from compoundkin.view.animation.moving_svg import smil
from compoundkin.view.animation.overlays import (
    Arrows,
    Caption,
    Marked,
    moving_centres,
    with_arrows,
    with_force_arrows,
)
from compoundkin.view.animation.timeline import Timeline, timeline_of
from compoundkin.view.sketch.kinematic_sketch import MovingSketch, moving_sketch
from compoundkin.view.sketch.picture import PAGE, Picture, checked_size
from compoundkin.view.sketch.picture_options import label_kinds, path_letters, scene_in
from compoundkin.view.sketch.shapes import ArcShape, Shape
from compoundkin.view.sketch.svg import NATURAL, pixel_size, pixels, require_cairo
from compoundkin.view.sketch.vectors import vector_kinds

# A mechanism's own range is shown in at least so many steps, as a full turn is.
FEWEST = 72


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
    marks: tuple[Marked, ...] = ()
    size: float | None = None

    def __len__(self) -> int:
        """The number of frames."""
        return len(self.timeline.frames)

    @property
    def seconds(self) -> float:
        """Its duration, seconds."""
        return self.timeline.seconds

    def frame(self, k: int) -> Picture:
        """Return the k-th frame; raises InvalidInput where there is none."""
        if isinstance(k, bool) or not isinstance(k, int) or not -len(self) <= k < len(self):
            raise InvalidInput(Problem("frame", f"there is no frame {k!r}", f"0 to {len(self) - 1}"))
        place = self.timeline.frames[k]
        pose, way = int(self.timeline.poses[place]), int(self.timeline.directions[place])
        shapes = self._shapes(pose, way)
        texts, height = self.caption.shapes(pose)
        window, mechanism = self.sketch.window, self.sketch.scene.mechanism
        said = "; ".join([self.caption.description, *self.caption.notes(pose)])
        shown = (self.caption.paper(height), *shapes, *texts)
        return Picture(shown, window.width, height, mechanism.title, said, self.size, window)

    def _shapes(self, pose: int, way: int) -> list[Shape]:
        """The sketch without its paper at the k-th assembled pose; arrows and what goes along are below the labels."""
        shapes = self.sketch.shapes(pose)[1:]
        labels = sum(part.is_label for part in self.sketch.parts)
        arrows = [shape for one in self.arrows for shape in one.shapes(pose, way)]
        marks = [shape for one in self.marks for shape in one.shapes(pose)]
        end = len(shapes) - labels
        return [*shapes[:end], *arrows, *marks, *shapes[end:]]

    @cached_property
    def svg(self) -> str:
        """Its source as SVG that moves by itself. The first pose where that is not supported."""
        scale = self.displayed_size / self.longer
        return smil(self.timeline, self.caption, self.arrows, self.marks, scale)

    def save(self, path: str | os.PathLike[str], progress: Progress | None = None) -> None:
        """Write it to a .gif, .mp4 or .svg file, whole or not at all.

        `progress(done, total)` is called with every frame.

        Raises InvalidInput for another suffix, where the file cannot be written, for GIF and MP4 where CairoSVG and
        Pillow are not installed, and for MP4 where there is no ffmpeg or it fails.
        """
        made = self.content(ready_for(path), progress)
        write_atomically(path, lambda file: file.write(made))

    def content(self, form: str, progress: Progress | None = None) -> bytes:
        """Return the bytes of a file in the form "gif", "mp4" or "svg". The same every time."""
        if form == "svg":
            (progress or _no_progress)(len(self), len(self))
            return self.svg.encode("utf-8")
        size = pixel_size(self.sketch.window.width, self.frame(0).height, self.displayed_size)
        write = {"gif": gif, "mp4": mp4}[form]

        def drawn(k: int) -> Number:
            return pixels(self.frame(k).svg, *size)

        return write(FilmFrames(drawn, len(self), self.timeline.hold, size), progress or _no_progress)

    @cached_property
    def longer(self) -> float:
        """The longer side of a frame, picture units."""
        return max(self.sketch.window.width, self.frame(0).height)

    @property
    def displayed_size(self) -> float:
        """The longer side of a frame in pixels."""
        return min(NATURAL * self.longer, PAGE) if self.size is None else self.size

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"Animation({self.sketch.scene.mechanism.title!r}, {len(self)} frames, {self.seconds:.3g} s)"


def ready_for(path: str | os.PathLike[str]) -> str:
    """Return the form of a file that can be written. Raises InvalidInput where it cannot, before anything is drawn."""
    form = file_format("animation", path)
    if not Path(path).absolute().parent.is_dir():
        raise InvalidInput(Problem(str(path), "it cannot be written: there is no such folder", "make it first"))
    if form == "mp4":
        require_ffmpeg()
    if form != "svg":
        require_cairo(form)
    if form == "gif":
        require_pillow()
    return form


def _no_progress(done: int, total: int) -> None:
    """Report no progress."""


@checked
def animate(
    what: Motion | Mechanism | Structure | Forces,
    *,
    design: int = 0,
    paths: str | Sequence[str] | bool = (),
    vectors: Any = (),
    centres: bool = False,
    labels: bool | str | Sequence[str] = True,
    seconds: float | None = None,
    fps: float | None = None,
    back: bool | None = None,
    size: float | None = None,
) -> Animation:
    """Animate a motion, to be saved as GIF, MP4 or SVG.

    A mechanism is solved over its drivers' own ranges, finely enough. Forces are arrows to one scale on their motion.

    `paths`, `vectors`, `centres`, `labels` and `size` are those of `draw`; vectors have one scale throughout. A motion
    in time is shown as fast as it is, any other one takes about four seconds, or `seconds`; `fps` is how many frames
    there are a second at most, 25 if left out. A motion that ends as it begins goes on for ever; any other one goes
    back the way it came, unless `back` is False. Poses that cannot be assembled are left out.

    Raises InvalidInput, UnknownName for what does not fit, NotAssembled where no pose is, and what `solve` raises.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> len(animate(crank))
    72
    """
    kinds, named, shown_size = vector_kinds(vectors), label_kinds(labels), checked_size(size)
    motion = what.motion if isinstance(what, Forces) else _motion(what)
    scene = scene_in(motion, None, None, design)
    sketch = moving_sketch(motion, design, paths=path_letters(scene.mechanism, paths), labels=named)
    timeline = timeline_of(sketch.scene, motion, design, back, seconds, fps)
    sketch, arrows = with_arrows(sketch, kinds, bool((timeline.directions < 0).any()))
    marks: tuple[Marked, ...] = ()
    if isinstance(what, Forces):
        sketch, arrows, marks = with_force_arrows(sketch, what, arrows, named=bool(named))
    names = [f"{number} {name}" for name, number in scene.legend.items()] if "links" in named else []
    turning = any(isinstance(shape, ArcShape) for mark in marks for shape in mark.marks)
    names += ["arcs: moments, not to scale"] if turning and named else []
    shown = timeline.poses[timeline.frames]
    caption = Caption(sketch, shown, tuple(names), tuple(one.scale for one in arrows), bool(named))
    here = moving_centres(sketch) if centres else ()
    return Animation(sketch, timeline, caption, arrows, (*marks, *here), shown_size)


def _motion(what: Motion | Mechanism | Structure) -> Motion:
    if isinstance(what, Motion):
        return what
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        warnings.simplefilter("ignore", ChangePointWarning)
        motion = solve(what)
        finer = finer_values(motion)
        return motion if finer is None else solve(what, finer)


def finer_values(motion: Motion) -> dict[str, Number] | None:
    """Return the drivers' values with others evenly between them. Others are added where there are too few to be shown.

    None where there are enough, and where rates or dimensions change along the motion with the values.
    """
    count, drives = motion.inputs.poses, motion.inputs.drives
    parts = -(-FEWEST // max(count - 1, 1))
    rates = [np.shape(rate)[-1:] for numbers in drives.values() for rate in numbers[1:]]
    if motion.time is not None or motion.inputs.designs > 1 or not 1 < count <= FEWEST or (count,) in rates:
        return None
    places = np.linspace(0.0, count - 1.0, (count - 1) * parts + 1)
    rows = {name: np.broadcast_to(np.ravel(numbers[0]), (count,)) for name, numbers in drives.items()}
    return {name: np.interp(places, np.arange(count), row) for name, row in rows.items()}
