"""Links as parts: contours, holes, profiles, guides and wheels in each link's own frame, at true size."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.curves import Curve
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.files.exchange.dxf.contour_edges import ContourEdge
from compoundkin.files.exchange.dxf.outline_contours import Contour, contours, covers
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.model.outline_shapes import OutlineShape, outline_shapes
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.model.pairs.symbols import Groove, Mark, Sliding, Strap, Track, Wheel
from compoundkin.model.pairs.travel_limits import as_travel_limited, bounds_name

Circle: TypeAlias = "tuple[complex, float]"
Line: TypeAlias = "tuple[complex, ...]"
Arc: TypeAlias = "tuple[complex, float, float, float]"
Marked: TypeAlias = "tuple[Pair, Mark]"
# So many poses are looked at for each of the motion for the ends of guides, and so many at most.
FINER, MOST_POSES = 12, 6000
# The longest circular slot, radians.
MOST = 6.0
# Tables of pairs whose grooves are circles, and straight.
ARCS, SLOTS = "arcs", "slots"


@dataclass(frozen=True)
class Sheet:
    """What of a link lies on one layer: contours, slots, holes for pins."""

    layer: int
    contours: tuple[Contour, ...]
    holes: tuple[Circle, ...]


@dataclass(frozen=True)
class LinkPart:
    """A link as a part.

    Its `sheets` go from the lowest layer up, none without outlines. `profiles` are cams and curved slots, `grooves`
    arcs (centre, radius, angles from and to), `guides` straight lines, `wheels` circles, `belts` closed lines.
    """

    link: str
    points: Mapping[str, complex]
    sheets: tuple[Sheet, ...]
    profiles: tuple[Curve, ...]
    grooves: tuple[Arc, ...]
    guides: tuple[Line, ...]
    wheels: tuple[Circle, ...]
    belts: tuple[Line, ...]

    @property
    def is_cut(self) -> bool:
        """Whether there is a contour to be cut."""
        return bool(self.sheets) or any(curve.closed for curve in self.profiles)


def link_parts(shown: ShownMechanism, motion: Motion | None) -> tuple[LinkPart, ...]:
    """Return all links as parts, guides as long as their use over a motion."""
    mechanism = shown.mechanism
    shapes = outline_shapes(mechanism, shown.points)
    fine = None if motion is None or not shown.pairs else _refined(motion)
    marks = [one for pair in shown.pairs for one in _marks(shown, pair, fine)]
    return tuple(
        _part(shown, link, shapes, [(pair, mark) for on, pair, mark in marks if on == link])
        for link in shown.points
        if link not in mechanism.auxiliary_links
    )


def _part(shown: ShownMechanism, link: str, shapes: Sequence[OutlineShape], marks: Sequence[Marked]) -> LinkPart:
    profiled = [found for pair in shown.pairs if (found := as_profile_contact(pair)) is not None and found.on == link]
    grooves = {
        pair.letters[0]: _arc(shown, pair, mark) for pair, mark in marks if pair.table == ARCS and _is_groove(mark)
    }
    slots = {
        pair.letters[0]: _line(mark.line) for pair, mark in marks if pair.table == SLOTS and isinstance(mark, Groove)
    }
    pins = pin_radii(shapes)
    cut = [_slot(link, line, pins[pin][1]) for pin, line in slots.items() if pin in pins]
    # one that goes all around would cut the part in two
    cut += [_curved_slot(*arc, pins[pin][1]) for pin, arc in grooves.items() if pin in pins and arc[3] - arc[2] < MOST]
    return LinkPart(
        link,
        shown.points[link],
        tuple(_sheets(link, shown.points[link], shapes, cut)),
        tuple({id(pair.curve): pair.curve for pair in profiled}.values()),
        tuple(grooves.values()),
        (*slots.values(), *(_guide(mark) for _, mark in marks if isinstance(mark, Sliding | Track))),
        tuple((complex(mark.at), float(mark.radius)) for _, mark in marks if isinstance(mark, Wheel)),
        tuple(_line(mark.line) for _, mark in marks if isinstance(mark, Strap)),
    )


def _sheets(
    link: str, points: Mapping[str, complex], shapes: Sequence[OutlineShape], slots: Sequence[Contour]
) -> Iterator[Sheet]:
    own = [shape for shape in shapes if shape.body == link]
    pins = pin_radii(shapes)
    for layer in sorted({layer for shape in own for layer in shape.layers}):
        there = [shape for shape in own if layer in shape.layers]
        holes = [(points[k], r) for k, (links, r) in pins.items() if link in links and k in points]
        yield Sheet(
            layer,
            (*contours(there), *(slot for slot in slots if covers(there, slot[0].at(0.5)))),
            tuple(hole for hole in holes if covers(there, hole[0])),
        )


def pin_radii(shapes: Sequence[OutlineShape]) -> Mapping[str, tuple[frozenset[str], float]]:
    """Return the links that each pin joins, and its radius, by letters.

    Of several radii it is the largest.
    """
    found: dict[str, tuple[frozenset[str], float]] = {}
    for shape in shapes:
        for letter in shape.letters if shape.body.startswith("pin ") else ():
            links, radius = found.get(letter, (frozenset(), 0.0))
            found[letter] = links | set(shape.links), max(radius, shape.radius)
    return found


def _marks(shown: ShownMechanism, pair: Pair, motion: Motion | None) -> Iterator[tuple[str, Pair, Mark]]:
    """Yield what there is to see of a pair, each with the link that has it."""
    if not shown.mechanism.auxiliary_links.isdisjoint(pair.members):
        return
    ends = shown.ends[pair.name]
    poses = tuple(shown.poses[name] if motion is None else _assembled(motion, name) for name in pair.members)
    marks, ended = pair.glyph(ends, poses), as_travel_limited(pair)
    if ended is not None:
        known = shown.ends.get(bounds_name(pair))
        bounds = ended.bounds(shown.mechanism.geometry) if known is None else [side.point for side in known]
        marks = ended.with_ends(marks, (first_entry(bounds[0]), first_entry(bounds[1])), ends, poses)
    for mark in marks:
        yield pair.members[0 if isinstance(mark, Sliding) else mark.member], pair, mark


def _refined(motion: Motion) -> Motion:
    """Return a motion with more poses: a slot that ends a little before its pin would stop the machine."""
    last = motion.inputs.poses - 1
    return between(motion, 0, np.linspace(0.0, last, min(FINER * last, max(MOST_POSES, last)) + 1), order=0)


def _assembled(motion: Motion, link: str) -> Pose:
    """Return the poses of a link that are assembled, (poses,)."""
    known = np.flatnonzero(motion.failed[0] == 0)

    def row(value: Number) -> Number:
        flat = np.ravel(value)
        return flat[known] if flat.size > 1 else flat[0]

    return motion.poses[link].mapped(lambda series: Series((row(series.c[0]),)))


def _is_groove(mark: Mark) -> bool:
    return isinstance(mark, Groove)


def _arc(shown: ShownMechanism, pair: Pair, mark: Mark) -> Arc:
    """The middle line of a circular slot: of its pair the circle, of its mark from where to where."""
    assert isinstance(mark, Groove)
    circle = shown.ends[pair.name][0]
    angles = np.unwrap(np.angle(np.asarray(mark.line, complex) - complex(circle.point)))
    return complex(circle.point), float(circle.measure), float(angles.min()), float(angles.max())


def _slot(link: str, line: Line, radius: float) -> Contour:
    """The contour of a straight slot for a pin."""
    core = line if line[0] != line[-1] else line[:1]
    return contours([OutlineShape(link, (link,), core, False, radius, (), ("",) * len(core))])[0]


def _curved_slot(centre: complex, radius: float, start: float, stop: float, pin: float) -> Contour:
    """The contour of a circular slot for a pin, its ends half circles."""
    a, b = np.exp(1j * start), np.exp(1j * stop)
    ends = [centre + (radius + side * pin) * way for side, way in ((1, a), (1, b), (-1, b), (-1, a))]
    outer = ContourEdge(ends[0], ends[1], centre, stop - start)
    inner = ContourEdge(ends[2], ends[3], centre, start - stop)
    caps = (ContourEdge(x, y, centre + radius * way, np.pi) for x, y, way in ((*ends[1:3], b), (ends[3], ends[0], a)))
    return outer, next(caps), inner, next(caps)


def _line(places: Number) -> Line:
    return tuple(map(complex, places))


def _guide(mark: Sliding | Track) -> Line:
    """The line of a straight guide."""
    return complex(mark.at + mark.along * mark.low), complex(mark.at + mark.along * mark.high)
