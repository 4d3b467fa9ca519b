"""What stands below an animation: where the drivers are, the links by their numbers, the scales of arrows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.model.attributes import after_number
from compoundkin.view.animation.timeline import times_of
from compoundkin.view.sketch.moving_sketch import MovingSketch
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Shape, Text, sheet
from compoundkin.view.sketch.shown_pose import pose_notes
from compoundkin.view.sketch.sketch_labels import BELOW, below, lines_of_text
from compoundkin.view.sketch.sketch_style import LINE
from compoundkin.view.sketch.vectors import VectorScale, scale_shapes

LEFT = 16.0
# A gauge is so long: this part of the picture's width, but no longer than this.
GAUGE, LONGEST_GAUGE = 0.3, 160.0
# Times are shown with so many digits of the whole.
DIGITS = 3


@dataclass(frozen=True, eq=False)
class Gauge:
    """A line with a dot that shows where a driver is, or the time. Its `values` are those over the assembled poses."""

    text: str
    values: Number
    start: complex
    length: float

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """The line and what it stands for."""
        stop = self.start + self.length
        return Polyline((self.start, stop), "edge"), Text(stop + 10.0, self.text, "note", "start")

    @property
    def dot(self) -> CircleShape:
        """The dot, as seen from where it is."""
        return CircleShape(0j, 3.2, "dot")

    @property
    def places(self) -> Number:
        """Where the dot is, (poses,)."""
        low, span = self.values.min(), np.ptp(self.values)
        return self.start + self.length * (self.values - low) / (span or 1.0)


@dataclass(frozen=True, eq=False, repr=False)
class Caption(PrintsShort):
    """The lines below a moving sketch; the first of them change with the pose."""

    sketch: MovingSketch
    poses: Number  # those that are ever shown as frames
    names: tuple[str, ...]
    scales: tuple[VectorScale, ...]
    is_told: bool = True  # else there are scales only

    @property
    def window(self) -> Window:
        """The window of the sketch."""
        return self.sketch.window

    @property
    def description(self) -> str:
        """What is shown, in a sentence for those who do not see it."""
        mechanism = self.sketch.scene.mechanism
        return f"Motion of {mechanism.title}: {mechanism.in_numbers}"

    def notes(self, k: int) -> list[str]:
        """Return the time and the drivers' values at the k-th assembled pose."""
        if not self.is_told:
            return []
        scene, motion = self.sketch.scene, self.sketch.motion
        here = replace(scene, pose=(scene.pose[0], int(scene.known[k])))
        times = [] if motion.time is None else [f"at {self._times[k]:.{self._decimals}f} s"]
        return [*times, *pose_notes(here)]

    def shapes(self, k: int) -> tuple[list[Shape], float]:
        """Return the texts at the k-th assembled pose, and the picture's height. The height is that with them."""
        lines = lines_of_text(self.notes(k), self._room)
        lines += [""] * (self._changing - len(lines)) + lines_of_text(self.names, self._room)
        found, height = below(lines, self.window.height)
        return self._scaled([shape for shape in found if not isinstance(shape, Text) or shape.text], height)

    def gauges(self) -> tuple[list[Gauge], list[Shape], float]:
        """Return lines with dots in the place of texts that change. What else stands there, and the height with all."""
        told = list(self._gauged()) if self.is_told else []
        moving = [(text, values) for text, values in told if np.ptp(values) > 0]
        start = complex(LEFT, self.window.height + BELOW)
        length = min(GAUGE * self.window.width, LONGEST_GAUGE)
        found = [Gauge(text, v, start + 1j * LINE * n, length) for n, (text, v) in enumerate(moving)]
        lines = ["" for _ in moving] + lines_of_text([*self._still(told), *self.names], self._room)
        texts, height = below(lines, self.window.height)
        texts = [shape for shape in texts if not isinstance(shape, Text) or shape.text]
        return found, *self._scaled(texts, height)

    @property
    def _room(self) -> float:
        return self.window.width - 2.0 * LEFT

    @cached_property
    def _changing(self) -> int:
        """How many lines the notes take at most, so that pictures are equally high."""
        return max((len(lines_of_text(self.notes(int(k)), self._room)) for k in self.poses), default=0)

    @cached_property
    def _times(self) -> Number:
        """The times of the assembled poses, seconds."""
        return times_of(self.sketch.motion, self.sketch.design)[self.sketch.scene.known]

    @cached_property
    def _decimals(self) -> int:
        span = float(np.max(np.abs(self._times))) or 1.0
        return int(max(0, DIGITS - 1 - np.floor(np.log10(span))))

    def _gauged(self) -> Iterator[tuple[str, Number]]:
        """What a gauge shows, with its values over the assembled poses."""
        scene, motion = self.sketch.scene, self.sketch.motion
        if motion.time is not None:
            low, high = self._times.min(), self._times.max()
            yield f"time, {low:.6g} to {high:.6g} s", self._times
        shape = motion.inputs.designs, motion.inputs.poses
        for step in scene.driven:
            name = step.drive.name
            values = np.broadcast_to(motion.inputs.drives[name][0], shape)[scene.pose[0]][scene.known]
            shown = np.rad2deg(values) if step.pair.free_is_angle else values
            unit = after_number(step.pair.free_is_angle, scene.mechanism.unit)
            yield f"{name}, {shown.min():.5g} to {shown.max():.5g}{unit}", np.asarray(values, dtype=float)

    def _still(self, told: Sequence[tuple[str, Number]]) -> list[str]:
        """The notes of what does not change."""
        notes = self.notes(0)
        return [note for note, (_, values) in zip(notes, told, strict=True) if np.ptp(values) == 0]

    def _scaled(self, texts: list[Shape], height: float) -> tuple[list[Shape], float]:
        for scale in self.scales:
            texts += scale_shapes(scale, height)
            height += LINE
        return texts, height

    def paper(self, height: float) -> Polygon:
        """Return the paper of a picture so high."""
        wide = self.window.width
        return sheet(wide, height)
