"""Links as parts: contours, holes, profiles, guides and wheels in each link's own frame, at true size."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.curves import Curve
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, Series
from compoundkin.files.exchange.dxf.outline_contours import Contour, contours, covers
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.kinematics import Motion
from compoundkin.model.outlines.outline_shapes import OutlineShape, outline_shapes
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.guide_ends import as_ended, bounds_name
from compoundkin.model.pairs.profile_contact import as_profiled
from compoundkin.model.pairs.symbols import Groove, Mark, Sliding, Strap, Track, Wheel

Circle: TypeAlias = "tuple[complex, float]"
Line: TypeAlias = "tuple[complex, ...]"


@dataclass(frozen=True)
class Sheet:
    """What of a link lies on one layer: contours and holes for pins."""

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
    grooves: tuple[tuple[complex, float, float, float], ...]
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
    marks = [one for pair in shown.pairs for one in _marks(shown, pair, motion)]
    return tuple(
        _part(shown, link, shapes, [mark for on, mark in marks if on == link])
        for link in shown.points
        if link not in mechanism.led_links
    )


def _part(shown: ShownMechanism, link: str, shapes: Sequence[OutlineShape], marks: Sequence[Mark]) -> LinkPart:
    profiled = [found for pair in shown.pairs if (found := as_profiled(pair)) is not None and found.on == link]
    return LinkPart(
        link,
        shown.points[link],
        tuple(_sheets(link, shown.points[link], shapes)),
        tuple({id(pair.curve): pair.curve for pair in profiled}.values()),
        tuple(_grooves(shown, link, marks)),
        tuple(_guide(mark) for mark in marks if isinstance(mark, Sliding | Track)),
        tuple((complex(mark.at), float(mark.radius)) for mark in marks if isinstance(mark, Wheel)),
        tuple(tuple(map(complex, mark.line)) for mark in marks if isinstance(mark, Strap)),
    )


def _sheets(link: str, points: Mapping[str, complex], shapes: Sequence[OutlineShape]) -> Iterator[Sheet]:
    own = [shape for shape in shapes if shape.body == link]
    pins = pin_radii(shapes)
    for layer in sorted({layer for shape in own for layer in shape.layers}):
        there = [shape for shape in own if layer in shape.layers]
        holes = [(points[k], r) for k, (links, r) in pins.items() if link in links and k in points]
        yield Sheet(layer, contours(there), tuple(hole for hole in holes if covers(there, hole[0])))


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


def _marks(shown: ShownMechanism, pair: Pair, motion: Motion | None) -> Iterator[tuple[str, Mark]]:
    """Yield what there is to see of a pair, each with the link that has it."""
    if not shown.mechanism.led_links.isdisjoint(pair.members):
        return
    ends = shown.ends[pair.name]
    poses = tuple(shown.poses[name] if motion is None else _assembled(motion, name) for name in pair.members)
    marks, ended = pair.glyph(ends, poses), as_ended(pair)
    if ended is not None:
        known = shown.ends.get(bounds_name(pair))
        bounds = ended.bounds(shown.mechanism.geometry) if known is None else [side.point for side in known]
        marks = ended.with_ends(marks, (first_entry(bounds[0]), first_entry(bounds[1])), ends, poses)
    for mark in marks:
        yield pair.members[0 if isinstance(mark, Sliding) else mark.member], mark


def _assembled(motion: Motion, link: str) -> Pose:
    """Return the poses of a link that are assembled, (poses,)."""
    known = np.flatnonzero(motion.failed[0] == 0)

    def row(value: Number) -> Number:
        flat = np.ravel(value)
        return flat[known] if flat.size > 1 else flat[0]

    return motion.poses[link].mapped(lambda series: Series((row(series.c[0]),)))


def _grooves(shown: ShownMechanism, link: str, marks: Sequence[Mark]) -> Iterator[tuple[complex, float, float, float]]:
    """Yield the arcs of circular slots: of their pairs the circles, of their marks from where to where."""
    lines = [mark.line for mark in marks if isinstance(mark, Groove)]
    arcs = [shown.ends[pair.name][0] for pair in shown.pairs if pair.table == "arcs" and pair.members[0] == link]
    for end in arcs:
        for line in lines:
            arms = np.asarray(line, complex) - complex(end.point)
            if np.allclose(np.abs(arms), float(end.measure)):
                angles = np.unwrap(np.angle(arms))
                yield complex(end.point), float(end.measure), float(angles.min()), float(angles.max())


def _guide(mark: Sliding | Track) -> Line:
    """The line of a straight guide."""
    return complex(mark.at + mark.along * mark.low), complex(mark.at + mark.along * mark.high)
