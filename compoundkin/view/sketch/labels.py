"""Labels of pictures: letters at points, numbers on links, and where they stand.

Of several places for each label the one that covers least is taken, the same every time. Obstacles are the lines and
small circles of shapes. A number is nearer to its own link than to any other; labels of a moving sketch cover least
over the whole motion.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.symbols import Sliding, Wheel
from compoundkin.view.sketch.painter import (
    Laid,
    Layer,
    Painter,
    edges,
    guide_line,
    joints,
    rod_line,
    skeleton,
)
from compoundkin.view.sketch.scene import Scene, Window
from compoundkin.view.sketch.shapes import (
    ArcShape,
    CircleShape,
    Polygon,
    Polyline,
    Shape,
    ShapeGroup,
    Strokes,
    Text,
    unit_direction,
)
from compoundkin.view.sketch.sketch_style import LETTER, NUMBER, PIN, SMALL, style_of

# Places along a bar for its number, the middle first; and how far beside it, in picture units.
ALONG = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74)
BESIDE = (0.0, 13.0, -13.0, 20.0, -20.0, 30.0, -30.0)
# Beside a bar is worse than on it by this.
OFF_BAR = 6.0
# Beside a wheel is worse than on it by this.
OUTSIDE = 30.0
# On the edge of a plate is worse than inside it by this.
ON_EDGE = 8.0


@dataclass(frozen=True, eq=False)
class LabelCourse:
    """The movement of places on a picture.

    At each of some poses they are turned about zero, then shifted, complex (poses,).

    At the first pose, the one shown, they are where they are.
    """

    turn: Number
    shift: Number

    def at(self, places: Number) -> Number:
        """Return where places (...) are, (poses, ...)."""
        shape = (-1, *[1] * np.ndim(places))
        return places * self.turn.reshape(shape) + self.shift.reshape(shape)

    def relative(self, places: Number) -> Number:
        """Return places (poses, ...) relative to this course."""
        shape = (-1, *[1] * (np.ndim(places) - 1))
        found = places - self.shift.reshape(shape)
        # points do not turn, and complex numbers are slow to divide
        return found if np.all(self.turn == 1.0) else found / self.turn.reshape(shape)

    def at_poses(self, poses: Number) -> LabelCourse:
        """Return the course at some of its poses."""
        return LabelCourse(self.turn[poses], self.shift[poses])


@dataclass(frozen=True, eq=False)
class LabelCourses:
    """The courses of links, and of points, by letters, for labels that stay upright."""

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


# The courses in a picture of one pose.
STILL = LabelCourses({}, {}, LabelCourse(np.ones(1, dtype=complex), np.zeros(1, dtype=complex)))


def labels_of(
    painter: Painter, laid: Sequence[Laid], kinds: Sequence[str], courses: LabelCourses = STILL
) -> list[Label]:
    """Return the requested labels. A number of a link is nearer to it than to any other."""
    numbers = beside_their_links(numbered(painter), laid, courses) if "links" in kinds else []
    return [*numbers, *(point_letters(painter) if "points" in kinds else [])]


def point_letters(painter: Painter) -> list[Label]:
    """Return a label for every point, away from the middle of the mechanism."""
    found = []
    for letter, at in painter.points.items():
        if not any(map(painter.shows, painter.scene.mechanism.carriers[letter])):
            continue
        away = at - painter.middle
        prefer = away / abs(away) + 0.4 * (0.7 - 0.7j) if abs(away) > 1.0 else 1 - 1j
        clear = PIN + (6.0 if len(joints(painter, letter)) > 1 else 3.0)
        found.append(label_around(f"point {letter}", at, text_half(letter, LETTER), clear, prefer))
    return found


def numbered(painter: Painter) -> list[Label]:
    """Return a label for the number of every link but the frame. On its bar or plate, else beside it."""
    return [_number(painter, name) for name in filter(painter.shows, painter.scene.legend) if name != FRAME]


def _number(painter: Painter, name: str) -> Label:
    corners = _cylinder(painter, name) or skeleton(painter.scene, painter.window, name)
    half = complex(NUMBER, NUMBER)
    key = f"link {name}"
    if not corners:
        return label_around(key, painter.middle, half, 0.0)
    if len(corners) == 1:
        inside = [s for s in painter.scene.pair_marks if isinstance(s.mark, Wheel) and s.link == name]
        if not inside:
            return label_around(key, corners[0], half, 10.0, -1 + 1j)
        radius = max(float(s.mark.radius) for s in inside if isinstance(s.mark, Wheel)) * painter.window.scale
        ring = [corners[0] + radius * 0.55 * complex(np.exp(2j * np.pi * (k + 0.5) / 12)) for k in range(12)]
        beside = label_around(key, corners[0], half, radius).places
        return Label(key, half, (*ring, *beside), (*[0.0] * len(ring), *[OUTSIDE] * len(beside)))
    # a plate has its number in its middle, and rather not on an edge
    places, costs = ([complex(np.mean(corners))], [0.0]) if len(corners) > 2 else ([], [])
    on_bar = 0.0 if len(corners) == 2 else ON_EDGE
    for a, b in edges(corners):
        across = 1j * (b - a) / abs(b - a)
        for share in ALONG:
            for off in BESIDE:
                places.append(a + (b - a) * share + across * off)
                costs.append(abs(off) / 4.0 + (OFF_BAR if off else on_bar) + 6.0 * abs(share - 0.5))
    return Label(key, half, tuple(places), tuple(costs), (*edges(corners), *_guides(painter, name)))


def _guides(painter: Painter, name: str) -> list[tuple[complex, complex]]:
    """The guides and rods of a link, which its number may be on too."""
    found = []
    for seen in painter.scene.pair_marks:
        if isinstance(seen.mark, Sliding) and not painter.is_cylinder(seen):
            line, own = (rod_line, 1) if painter.is_rod(seen) else (guide_line, 0)
            if name == seen.members[own] != FRAME:
                found.append(line(painter, name, seen.mark))
    return found


def _cylinder(painter: Painter, name: str) -> list[complex]:
    """Where the number of a cylinder's barrel may be, or that of its rod."""
    for seen in painter.scene.pair_marks:
        mark, alone = seen.mark, len(painter.scene.points[name]) == 1
        if isinstance(mark, Sliding) and alone and name in seen.members and painter.is_cylinder(seen):
            foot, eye = painter.place(seen.members[0], mark.at), painter.place(seen.members[1], mark.block)
            shares = (0.1, 0.6) if name == seen.members[0] else (0.6, 1.0)
            return [foot + (eye - foot) * share for share in shares]
    return []


def label_shapes(scene: Scene, found: dict[str, complex]) -> list[Shape]:
    """Return the labels as shapes, at their places."""
    shapes: list[Shape] = []
    for key, at in found.items():
        kind, _, name = key.partition(" ")
        if kind == "link":
            shapes.append(badge(scene, name, at))
        else:
            shapes.append(Text(at, name, "letter" if kind == "point" else "centre-name"))
    return shapes


def badge(scene: Scene, name: str, at: complex) -> Shape:
    """Return the number of a link in a circle of its colour."""
    rim = CircleShape(at, NUMBER, f"pin {style_of('ring', scene.groups[name])}")
    return ShapeGroup((rim, Text(at, str(scene.numbers[name]), "number")), links=(name,))


# The number of poses at which labels are compared: with few labels, at least, and labels times poses.
MOST, LEAST, LABELS = 12, 3, 240
# A label that leaves the picture makes it larger: that costs less than to be cut off.
LARGER = 0.02


def compared_poses(shown: int, count: int, labels: int) -> Number:
    """Return indices of poses along a motion, that shown first."""
    poses = int(np.clip(LABELS // max(labels, 1), LEAST, MOST))
    others = np.linspace(0, count - 1, min(poses, count)).round().astype(int)
    return np.concatenate([[shown], others[others != shown]])


def label_courses(scene: Scene, window: Window, poses: Number) -> LabelCourses:
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
        middle = at.mean()
        # what is farther than this from the middle of the places, at its pose, is on none of them
        reach, along = np.abs(at - middle).max() + abs(half) + TOUCHING, middle * course.turn + course.shift
        pose, line = np.nonzero(_are_near(self._spans, along, reach))
        lines = course.at_poses(pose).relative(self.lines[pose, line])
        pose, line = np.nonzero(_are_near(self._discs, along, reach))
        middles = course.at_poses(pose).relative(self.rounds[pose, line, 0])
        rounds = np.stack([middles, self.rounds[pose, line, 1]], axis=-1)
        outside = beyond(course.at(at), half, self.width, self.height)
        covered = on_shapes(at, half, lines, rounds) / len(course.turn)
        found: Number = np.array(label.costs) + covered - on_own(label, at, half)
        return found + LARGER * outside.mean(axis=0)

    @cached_property
    def _spans(self) -> tuple[Number, Number]:
        """The middles of the lines, and half their lengths."""
        one, two = self.lines[..., 0], self.lines[..., 1]
        return (one + two) / 2.0, np.abs(two - one) / 2.0

    @cached_property
    def _discs(self) -> tuple[Number, Number]:
        """The middles of the circles, and their radii."""
        return self.rounds[..., 0], self.rounds[..., 1].real


def _are_near(discs: tuple[Number, Number], along: Number, reach: float) -> Number:
    """Return which discs (poses, count) are nearer to a course (poses,) than so far. Rounding finds some more."""
    middles, radii = discs
    x, y = middles.real - along.real[:, None], middles.imag - along.imag[:, None]
    near: Number = x * x + y * y <= (radii + reach * (1.0 + TOUCHING)) ** 2
    return near


def placed_along(labels: Sequence[Label], courses: LabelCourses, around: Surroundings) -> dict[str, complex]:
    """Return a place for each label at the pose shown."""
    own = [courses.of_label(label.key) for label in labels]
    fixed = {label.key: around.costs(label, course) for label, course in zip(labels, own, strict=True)}
    nothing: Number = np.zeros((len(courses.others.turn), 0), dtype=complex)
    turn = np.column_stack([nothing, *(course.turn for course in own)])
    shift = np.column_stack([nothing, *(course.shift for course in own)])
    return arranged_labels(labels, fixed, LabelCrowd(labels, turn, shift))


# What it costs to be nearer to another link, and so much more for each picture unit; distances that differ by less are
# equal: links that lie on each other.
WRONG, WORSE, EQUAL = 400.0, 3.0, 0.5
# So much nearer than any other link it had better be, and what a picture unit less costs.
CLEARLY, UNCLEAR = 7.0, 1.5


def is_of_link(one: Laid) -> bool:
    """Return whether a shape shows which link it is of. Pins are of several, arrows and the frame of none."""
    return Layer.FRAME < one.layer < Layer.PIN and one.link != FRAME


def distances(at: Number, lines: Number) -> Number:
    """Return how far places are from lines, (places, lines)."""
    start, way = lines[None, :, 0], (lines[:, 1] - lines[:, 0])[None]
    off = at[:, None] - start
    length = np.abs(way) ** 2
    share = np.clip((np.conjugate(way) * off).real / np.where(length > 0, length, 1.0), 0.0, 1.0)
    return np.abs(off - share * way)


def own_distances(at: Number, shapes: Iterable[Laid]) -> Number:
    """Return how far places are from what is drawn of a link. Inside a plate or wheel it is nothing."""
    shapes = list(shapes)
    lines = np.array(list(straight_lines(one.shape for one in shapes)), dtype=complex).reshape(-1, 2)
    found = distances(at, lines).min(axis=1) if len(lines) else np.full(len(at), np.inf)
    for shape in (one.shape for one in shapes):
        if isinstance(shape, CircleShape):
            found = np.minimum(found, np.maximum(0.0, np.abs(at - shape.centre) - shape.radius))
        elif isinstance(shape, Polygon):
            corners = np.array(shape.points, dtype=complex)[:, None] - at
            winding = np.angle(np.roll(corners, -1, axis=0) * np.conjugate(corners)).sum(axis=0)
            found = np.where(np.abs(winding) > np.pi, 0.0, found)
    return found


def costs_of(own: Number, other: Number) -> Number:
    """Return what places cost by their distances to their own link and another."""
    wrong = own - other > EQUAL
    unclear = np.maximum(0.0, np.minimum(own, CLEARLY) - np.maximum(0.0, other - own)) * UNCLEAR
    return np.where(wrong, WRONG + WORSE * np.minimum(np.maximum(own - other, 0.0), own), 0.0) + np.where(
        own > EQUAL, unclear, 0.0
    )


def beside_their_links(labels: Sequence[Label], laid: Sequence[Laid], courses: LabelCourses = STILL) -> list[Label]:
    """Return labels, those of links with the costs of being nearer to another link. These are of all poses."""
    shown = [one for one in laid if is_of_link(one)]
    links = list(dict.fromkeys(one.link for one in shown))
    rows = [(courses.of(one), obstacles([one.shape])[0], links.index(one.link)) for one in shown]
    owner = np.repeat([k for *_, k in rows], [len(lines) for _, lines, _ in rows]) if rows else np.zeros(0, dtype=int)
    lines = np.concatenate([course.at(lines) for course, lines, _ in rows], axis=1) if rows else np.zeros((1, 0, 2))
    found = []
    for label in labels:
        kind, _, name = label.key.partition(" ")
        if kind == "link" and name in links and len(links) > 1:
            own = own_distances(np.array(label.places), [one for one in shown if one.link == name])
            others = courses.of_label(label.key).relative(lines[:, owner != links.index(name)])
            label = label.with_costs(_of_all_poses(np.array(label.places), own, others))
        found.append(label)
    return found


def _of_all_poses(at: Number, own: Number, lines: Number) -> Number:
    """What places cost on the average of the poses, by their own distances and those of other lines at each pose."""
    # what is farther than this from all places is none of the nearest that count
    middle, far = at.mean(), np.abs(at - at.mean()).max() + own.max() + CLEARLY
    costs = []
    for at_pose in lines:
        near = (
            np.abs((at_pose[:, 0] + at_pose[:, 1]) / 2.0 - middle) - np.abs(at_pose[:, 1] - at_pose[:, 0]) / 2.0 < far
        )
        other = distances(at, at_pose[near]).min(axis=1, initial=np.inf)
        costs.append(costs_of(own, other))
    return np.mean(costs, axis=0)


# Width of a letter in parts of its height, a little more than in the usual fonts.
WIDE = 0.62
# What it costs to be in the way: of another label, of the edge of the picture, of a line, of a circle.
LABEL, EDGE, LINE, ROUND = 1000.0, 4000.0, 12.0, 30.0
# Places are tried at so many directions and distances around a point.
DIRECTIONS = 16
RINGS = (0.0, 5.0, 11.0, 18.0, 27.0, 38.0, 52.0, 70.0)
AROUND = np.exp(2j * np.pi * np.arange(DIRECTIONS) / DIRECTIONS)
# What it costs to be a picture unit farther away.
FAR = 1.1
# Labels keep this distance.
ROOM = 1.5
# Costs that differ beyond these digits are equal: rounding must not decide.
DIGITS = 6
# What is drawn last is placed again so many times, when all others are known.
ROUNDS = 2


@dataclass(frozen=True)
class Label:
    """A label to be placed. Half its width and height, and its places in the order of preference, with their costs.

    `own` are lines that it may be on.
    """

    key: str
    half: complex
    places: tuple[complex, ...]
    costs: tuple[float, ...]
    own: tuple[tuple[complex, complex], ...] = ()

    def moved(self, by: complex) -> Label:
        """Return the same label elsewhere on the picture."""
        own = tuple((a + by, b + by) for a, b in self.own)
        return replace(self, places=tuple(place + by for place in self.places), own=own)

    def with_costs(self, more: Number) -> Label:
        """Return the same label, its places the dearer by some costs."""
        return replace(self, costs=tuple((np.array(self.costs) + more).tolist()))


def text_half(text: str, size: float) -> complex:
    """Return half the width and height of a line of text."""
    return complex(max(1, len(text)) * WIDE * size / 2.0, 0.42 * size)


def label_around(key: str, at: complex, half: complex, clear: float, prefer: complex = 1 - 1j) -> Label:
    """Return a label beside a point, from `clear` away on. Rather to the side `prefer`."""
    better = prefer / abs(prefer)
    reach = np.abs(AROUND.real) * half.real + np.abs(AROUND.imag) * half.imag
    rings = np.array(RINGS)[:, None]
    places = (at + AROUND * (clear + reach + rings)).ravel()
    costs = (FAR * rings + 2.5 * (1.0 - (np.conjugate(better) * AROUND).real)).ravel()
    return Label(key, half, tuple(places.tolist()), tuple(costs.tolist()))


def label_beside(
    key: str,
    text: str,
    line: tuple[complex, complex],
    middle: complex,
    shares: Sequence[float],
    offsets: Sequence[float],
    inside: float,
) -> Label:
    """Return a label beside a line, at shares of its length and distances from it.

    Rather away from the `middle` of a figure: on the side towards it places cost more by `inside`.
    """
    start, way = line[0], line[1] - line[0]
    half, across = text_half(text, SMALL), 1j * unit_direction(way)
    outside = 1.0 if (np.conjugate(across) * (start + way / 2.0 - middle)).real >= 0 else -1.0
    reach = abs(across.real) * half.real + abs(across.imag) * half.imag
    tried = [(share, off, side) for share in shares for off in offsets for side in (outside, -outside)]
    places = tuple(start + way * share + across * side * (reach + off) for share, off, side in tried)
    costs = tuple(20.0 * abs(share - 0.5) + off + (inside if side != outside else 0.0) for share, off, side in tried)
    return Label(key, half, places, costs)


def names_at_places(named: Iterable[tuple[str, complex]], nearest: float) -> list[tuple[list[str], complex]]:
    """Return the names of places; those of places nearer to each other than `nearest` are together."""
    found: list[tuple[list[str], complex]] = []
    for name, place in named:
        same = next((names for names, other in found if abs(other - place) < nearest), None)
        if same is None:
            found.append(([name], place))
        else:
            same.append(name)
    return found


def placed(labels: Sequence[Label], shapes: Iterable[Shape], width: float, height: float) -> dict[str, complex]:
    """Return a place for each label, in the order of the labels. All are placed again twice."""
    (lines, rounds), fixed = obstacles(shapes), dict[str, Number]()
    for some in _together(labels, len(lines)):
        counts = [len(label.places) for label in some]
        at, costs = (np.concatenate([getattr(label, which) for label in some]) for which in ("places", "costs"))
        half = np.repeat([label.half + ROOM * (1 + 1j) for label in some], counts)
        covered = on_shapes(at, half, lines, rounds) + beyond(at, half, width, height)
        found = costs + covered - _on_their_own(some, at, half, np.repeat(np.arange(len(some)), counts))
        fixed |= zip((label.key for label in some), np.split(found, np.cumsum(counts)[:-1]), strict=True)
    still = np.ones((1, len(labels)), dtype=complex)
    return arranged_labels(labels, fixed, LabelCrowd(labels, still, 0.0 * still))


# So many lines are compared with so many places at once.
PAIRS = 1 << 16


def _together(labels: Sequence[Label], lines: int) -> Iterator[list[Label]]:
    """Yield labels, in order, as many at once as have few places beside so many lines."""
    some, count = list[Label](), 0
    for label in labels:
        count += len(label.places)
        if some and count * lines > PAIRS:
            yield some
            some, count = [], len(label.places)
        some.append(label)
    if some:
        yield some


def arranged_labels(labels: Sequence[Label], fixed: Mapping[str, Number], crowd: LabelCrowd) -> dict[str, complex]:
    """Return a place for each label. All are placed again twice, by fixed costs and those of being on others."""
    own = [fixed[label.key] for label in labels]
    first = [int(np.argmin(np.round(costs, DIGITS))) for costs in own]
    found: dict[str, complex] = {}
    for _ in range(1 + ROUNDS):
        for k, label in enumerate(labels):
            if crowd.is_new_for(k):
                # others only make places dearer: where the best is on none of them, it stays the best
                is_free = crowd.is_free(k, first[k])
                best = first[k] if is_free else int(np.argmin(np.round(own[k] + crowd.costs(k), DIGITS)))
                found[label.key] = label.places[best]
                crowd.put(k, best)
    return found


class LabelCrowd:
    """Where labels are at some poses, and what others cost there.

    Places are turned about zero, then shifted: complex (poses, labels), both.
    """

    def __init__(self, labels: Sequence[Label], turn: Number, shift: Number) -> None:
        self._half = np.array([label.half for label in labels])
        # what is nowhere yet is near nothing
        self._middles: Number = np.full(turn.shape, complex(np.nan, np.nan))
        # of each label (poses, places)
        self._places: list[Number] = [
            np.array(label.places) * turn[:, k, None] + shift[:, k, None] for k, label in enumerate(labels)
        ]
        self._neighbours = self._that_may_meet(self._places)
        self._is_new = np.ones(len(labels), dtype=bool)

    def _that_may_meet(self, moved: Sequence[Number]) -> list[Number]:
        """Return for each label the indices of the others that it may ever be on: of all else nothing is counted."""
        if not moved:
            return []
        starts = np.cumsum([0, *(one.shape[1] for one in moved[:-1])])
        whole, reach = np.concatenate(moved, axis=1), self._half[:, None] + self._half + (ROOM + TOUCHING) * (1 + 1j)
        meets: Number = np.ones((len(whole), len(moved), len(moved)), dtype=bool)
        for part in (np.real, np.imag):
            least, most = (extreme.reduceat(part(whole), starts, axis=1) for extreme in (np.minimum, np.maximum))
            apart = least[:, None] - most[..., None]
            meets &= (apart < part(reach)) & (apart.swapaxes(1, 2) < part(reach))
        together = meets.any(axis=0)
        np.fill_diagonal(together, False)
        return [np.flatnonzero(row) for row in together]

    def is_new_for(self, k: int) -> bool:
        """Return whether any that a label may be on was put elsewhere since it was put."""
        return bool(self._is_new[k])

    def is_free(self, k: int, place: int) -> bool:
        """Return whether a label at one of its places is on none of the others."""
        others = self._neighbours[k]
        gap = self._places[k][:, place, None] - self._middles[:, others]
        return not crowded(gap, self._half[k], self._half[others]).any()

    def put(self, k: int, place: int) -> None:
        """Put a label at one of its places."""
        at = self._places[k][:, place]
        self._is_new[k] = False
        if not np.array_equal(at, self._middles[:, k]):
            self._middles[:, k] = at
            self._is_new[self._neighbours[k]] = True

    def costs(self, k: int) -> Number:
        """Return what each place of a label costs, on the average of the poses."""
        places = self._places[k]
        near = self._near(k, places)
        gap = places - self._middles[:, near].T[:, :, None]
        found: Number = crowded(gap, self._half[k], self._half[near][:, None, None]).sum(axis=0).mean(axis=0)
        return found

    def _near(self, k: int, places: Number) -> Number:
        """Indices of the others that any of the places is near at any pose: of all else nothing is counted."""
        others = self._neighbours[k]
        reach = self._half[k] + self._half[others] + ROOM * (1 + 1j)
        x, y, at = places.real, places.imag, self._middles[:, others]
        wide = (at.real - x.max(axis=1, keepdims=True) < reach.real) & (
            x.min(axis=1, keepdims=True) - at.real < reach.real
        )
        high = (at.imag - y.max(axis=1, keepdims=True) < reach.imag) & (
            y.min(axis=1, keepdims=True) - at.imag < reach.imag
        )
        near: Number = others[(wide & high).any(axis=0)]
        return near


def beyond(at: Number, half: complex | Number, width: float, height: float) -> Number:
    """Return what it costs places to be outside the picture."""
    outside = np.maximum(0.0, half.real - at.real) + np.maximum(0.0, at.real + half.real - width)
    return EDGE * (outside + np.maximum(0.0, half.imag - at.imag) + np.maximum(0.0, at.imag + half.imag - height))


def on_own(label: Label, at: Number, half: complex) -> Number:
    """Return what `on_shapes` counts of lines that a label may be on."""
    return LINE * lengths_in_boxes(at, half, np.array(label.own)) if label.own else 0.0


def _on_their_own(labels: Sequence[Label], at: Number, half: Number, owner: Number) -> Number:
    """Return what `on_shapes` counts of the lines that labels may be on; `owner` is whose a place is."""
    own = np.array([line for label in labels for line in label.own], dtype=complex).reshape(-1, 2)
    of = np.repeat(np.arange(len(labels)), [len(label.own) for label in labels])
    return LINE * lengths_in_boxes(at, half, own, owner[:, None] == of) if len(own) else np.zeros(len(at))


def on_shapes(at: Number, half: complex | Number, lines: Number, rounds: Number) -> Number:
    """Return what it costs places to be on lines and circles."""
    costs: Number = LINE * lengths_in_boxes(at, half, lines)
    if len(rounds):
        x, y, radius = rounds[:, 0].real, rounds[:, 0].imag, rounds[:, 1].real
        near = _within(at.real, half.real, x - radius, x + radius) & _within(at.imag, half.imag, y - radius, y + radius)
        x, y, radius = x[near], y[near], radius[near]
        wide, tall = (np.reshape(side, (-1, 1)) for side in (half.real, half.imag))
        gap = np.abs(at.real[:, None] - x) - wide - radius
        high = np.abs(at.imag[:, None] - y) - tall - radius
        costs = costs + ROUND * np.count_nonzero((gap < 0) & (high < 0), axis=1)
    return costs


def _within(along: Number, reach: float | Number, low: Number, high: Number) -> Number:
    """Return which of some ranges along an axis can be met by any of the places: the others cost nothing."""
    return (low <= (along + reach).max()) & (high >= (along - reach).min())


# Lines this near to a box, in picture units, may touch it.
TOUCHING = 1e-6


def lengths_in_boxes(at: Number, half: complex | Number, lines: Number, counted: Number | None = None) -> Number:
    """Return the lengths of all lines in the box around each place, together.

    Each is in parts of the box's half diagonal, at least one. `half` is of all boxes or of each, `counted` (places,
    lines) which lines count for which.
    """
    one, two = lines[:, 0], lines[:, 1]
    left, right = np.minimum(one.real, two.real), np.maximum(one.real, two.real)
    low, high = np.minimum(one.imag, two.imag), np.maximum(one.imag, two.imag)
    near = np.flatnonzero(
        _within(at.real, half.real + TOUCHING, left, right) & _within(at.imag, half.imag + TOUCHING, low, high)
    )
    left, right, low, high = left[near], right[near], low[near], high[near]
    x, y, reach = at.real[:, None], at.imag[:, None], np.reshape(half + TOUCHING * (1 + 1j), (-1, 1))
    meets = (left <= x + reach.real) & (right >= x - reach.real) & (low <= y + reach.imag) & (high >= y - reach.imag)
    # few lines meet few boxes: what follows is of these pairs alone
    place, line = np.nonzero(meets if counted is None else meets & counted[:, near])
    half = np.broadcast_to(half, len(at))[place]
    start, way = one[near][line] - at[place], (two - one)[near][line]
    first: Number = np.zeros(len(place))
    last = np.ones_like(first)
    with np.errstate(divide="ignore", invalid="ignore"):
        for begin, along, side in ((start.real, way.real, half.real), (start.imag, way.imag, half.imag)):
            entering, leaving = (-side - begin) / along, (side - begin) / along
            still = along == 0
            out = still & (np.abs(begin) > side)
            entry = np.where(still, -np.inf, np.minimum(entering, leaving))
            first = np.maximum(first, np.where(out, np.inf, entry))
            last = np.minimum(last, np.where(still, np.inf, np.maximum(entering, leaving)))
    length = np.maximum(last - first, 0.0) * np.abs(way)
    counts = np.where(last > first, 1.0 + length / np.abs(half), 0.0)
    return np.bincount(place, counts, len(at))


def crowded(gap: Number, half: complex, others: Number) -> Number:
    """Return what it costs labels to be on others. `gap` is from middle to middle."""
    wide = half.real + others.real + ROOM - np.abs(gap.real)
    high = half.imag + others.imag + ROOM - np.abs(gap.imag)
    return LABEL * np.where((wide > 0) & (high > 0), 1.0 + np.minimum(wide, high), 0.0)


# A larger circle is in the way with its line only.
BIG = 12.0
# Its line is so many chords.
CHORDS = 24


def obstacles(shapes: Iterable[Shape]) -> tuple[Number, Number]:
    """Return lines and circles that labels should not be on.

    They are (start, stop) and (middle, radius), complex (count, 2).
    """
    shapes = list(shapes)
    lines, rounds = list(straight_lines(shapes)), list(_rounds(shapes))
    return np.array(lines, dtype=complex).reshape(-1, 2), np.array(rounds, dtype=complex).reshape(-1, 2)


def straight_lines(shapes: Iterable[Shape]) -> Iterator[tuple[complex, complex]]:
    """Return the straight lines of shapes, those of large circles as chords."""
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from straight_lines(shape.shapes)
        elif isinstance(shape, Polyline):
            yield from pairwise(shape.points)
        elif isinstance(shape, Polygon):
            yield from pairwise((*shape.points, shape.points[0]))
        elif isinstance(shape, Strokes):
            yield from (line for whole in shape.lines for line in pairwise(whole))
        elif isinstance(shape, ArcShape):
            yield shape.start, shape.stop
        elif isinstance(shape, CircleShape) and shape.radius > BIG:
            rim = shape.centre + shape.radius * np.exp(2j * np.pi * np.arange(CHORDS + 1) / CHORDS)
            yield from pairwise(complex(p) for p in rim)


def _rounds(shapes: Iterable[Shape]) -> Iterator[tuple[complex, float]]:
    for shape in shapes:
        if isinstance(shape, ShapeGroup):
            yield from _rounds(shape.shapes)
        elif isinstance(shape, CircleShape) and shape.radius <= BIG:
            yield shape.centre, shape.radius
