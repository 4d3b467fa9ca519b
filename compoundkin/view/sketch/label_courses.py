"""Labels of moving sketches: places that are in the way of least over the whole motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.sketch.label_obstacles import obstacles
from compoundkin.view.sketch.label_places import ROOM, Label, LabelCrowd, beyond, on_own, on_shapes, settled
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.slide_shapes import Laid, Layer

# So many poses of a sketch with few labels are looked at, fewer where there are many labels.
MOST, LEAST, LABELS = 12, 3, 240
# A label that leaves the picture makes it larger: that costs less than to be cut off.
LARGER = 0.02


@dataclass(frozen=True, eq=False)
class LabelCourse:
    """How places of a picture move. At each of some poses they are turned about zero, then shifted, complex (poses,).

    At the first pose, the one shown, they are where they are.
    """

    turn: Number
    shift: Number

    def at(self, places: Number) -> Number:
        """Return where places (...) are, (poses, ...)."""
        shape = (-1, *[1] * np.ndim(places))
        return places * self.turn.reshape(shape) + self.shift.reshape(shape)

    def seen(self, places: Number) -> Number:
        """Return places (poses, ...) as seen from what takes this course."""
        shape = (-1, *[1] * (np.ndim(places) - 1))
        return (places - self.shift.reshape(shape)) / self.turn.reshape(shape)


@dataclass(frozen=True, eq=False)
class LabelCourses:
    """The courses of what links carry. What stays upright at points has theirs, by letters."""

    of_links: Mapping[str, LabelCourse]
    of_points: Mapping[str, LabelCourse]
    others: LabelCourse

    def of(self, one: Laid) -> LabelCourse:
        """Return the course of a shape."""
        return self.of_points.get(one.letter, self.others) if one.letter else self.of_links.get(one.link, self.others)

    def of_label(self, key: str) -> LabelCourse:
        """Return the course of a label: "link crank" or "point A"."""
        kind, _, name = key.partition(" ")
        return (self.of_links if kind == "link" else self.of_points).get(name, self.others)


# Of a picture of one pose.
STILL = LabelCourses({}, {}, LabelCourse(np.ones(1, dtype=complex), np.zeros(1, dtype=complex)))


def poses_looked_at(shown: int, count: int, labels: int) -> Number:
    """Return indices of poses along a motion, that shown first."""
    wanted = int(np.clip(LABELS // max(labels, 1), LEAST, MOST))
    others = np.linspace(0, count - 1, min(wanted, count)).round().astype(int)
    return np.concatenate([[shown], others[others != shown]])


def courses_of(scene: Scene, window: Window, poses: Number) -> LabelCourses:
    """Return how links and points move over some poses. The first of them is the one shown."""
    links, points = {}, {}
    for name, pose in scene.whole.items():
        z, u = (np.broadcast_to(np.atleast_1d(v.c[0]), (scene.count,))[poses] for v in (pose.z, pose.u))
        turn, at = np.conjugate(u / u[0]), window.at(z)
        links[name] = LabelCourse(turn, at - at[0] * turn)
    for letter in scene.letters:
        at = window.at(np.broadcast_to(scene.places(letter), (scene.count,))[poses])
        points[letter] = LabelCourse(np.ones_like(at), at - at[0])
    still = LabelCourse(np.ones(len(poses), dtype=complex), np.zeros(len(poses), dtype=complex))
    return LabelCourses(links, points, still)


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Lines and circles that labels should not be on. They are those of some poses, complex (poses, count, 2)."""

    lines: Number
    rounds: Number
    width: float
    height: float

    @classmethod
    def of(cls, laid: Sequence[Laid], courses: LabelCourses, width: float, height: float) -> Surroundings:
        """Return those of shapes on their courses."""
        lines, rounds = [], []
        # on a hatching a label can be read: it has paper around it
        for one in (one for one in laid if one.layer > Layer.BACK):
            course, (straight, small) = courses.of(one), obstacles([one.shape])
            lines.append(course.at(straight))
            middles = course.at(small[:, 0])
            rounds.append(np.stack([middles, np.broadcast_to(small[:, 1], middles.shape)], axis=-1))
        nothing = np.zeros((len(courses.others.turn), 0, 2), dtype=complex)
        return cls(np.concatenate([nothing, *lines], axis=1), np.concatenate([nothing, *rounds], axis=1), width, height)

    def costs(self, label: Label, course: LabelCourse) -> Number:
        """Return what each place costs on the average of the poses."""
        at, half = np.array(label.places), label.half + ROOM * (1 + 1j)
        lines = course.seen(self.lines).reshape(-1, 2)
        middles = course.seen(self.rounds[..., 0])
        rounds = np.stack([middles, self.rounds[..., 1]], axis=-1).reshape(-1, 2)
        poses = len(course.turn)
        outside = beyond(course.at(at), half, self.width, self.height)
        found: Number = np.array(label.costs) + on_shapes(at, half, lines, rounds) / poses - on_own(label, at, half)
        return found + LARGER * outside.mean(axis=0)


def placed_along(labels: Sequence[Label], courses: LabelCourses, around: Surroundings) -> dict[str, complex]:
    """Return a place for each label at the pose shown."""
    own = [courses.of_label(label.key) for label in labels]
    fixed = {label.key: around.costs(label, course) for label, course in zip(labels, own, strict=True)}
    nothing: Number = np.zeros((len(courses.others.turn), 0), dtype=complex)
    turn = np.column_stack([nothing, *(course.turn for course in own)])
    shift = np.column_stack([nothing, *(course.shift for course in own)])
    return settled(labels, fixed, LabelCrowd(labels, turn, shift))
