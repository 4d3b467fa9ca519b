"""The forces on the links at one pose and along a motion, with short names, as arrows; moments as arcs.

They are reactions, efforts of drivers, loads, weights and inertia forces.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.reactions.link_wrench import DRIVER, FRICTION, PAIR, WEIGHT, LinkWrench
from compoundkin.dynamics.reactions.link_wrench import INERTIA as OF_INERTIA
from compoundkin.model.geometry import FRAME
from compoundkin.view.sketch.labels import Label, label_around, text_half
from compoundkin.view.sketch.painter import curved_arrow
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.shapes import Shape, ShapeGroup, Text, arrow_shapes, unit_direction
from compoundkin.view.sketch.sketch_style import INERTIA, LOAD, REACTION, SMALL
from compoundkin.view.sketch.vectors import VectorScale, round_below

# The longest force is this part of the picture's diagonal.
LONGEST = 0.2
# What is smaller than this part of the largest force or moment is left out of a sketch, which has little room.
SMALL_PART = 0.03
# The kinds of arrows, as they are named below a picture.
KINDS = {REACTION: "reactions and drivers", LOAD: "loads and weights", INERTIA: "inertia"}
# The arc of a moment: its radius, what it goes through (radians), and how much farther the next one is.
ROUND, SWEEP, NEXT = 19.0, 2.7, 7.0
# Between the end of an arc and an arrow there is such an angle, if possible (radians).
ARC_ROOM = 0.3
# Arrows begin and end so far from the point at which they act, so that the pin stays visible.
CLEAR = 6.0
# Around a driven pin it is outside of the arrow of the driver.
AROUND_DRIVER = 34.0
# Arrows on one line are drawn so far beside each other; they are on one where they differ by less than this angle
# (radians) and cover each other by more than this length.
ASIDE, PARALLEL, CLOSE = 6.0, 0.05, 1.0
# Directions in which the arc of a moment is tried around its place, and what an arrow in it costs beside its own link.
TURNED, ON_ARROW, ON_LINK = 16, 2.0, 1.0
# A shorter arrow is not drawn, but listed below the picture.
SHORTEST = 5.0
# Digits of the values beside arrows.
DIGITS = 4
# Values of so many digits before the point are written without an exponent.
PLAIN = 8


def force_scale(forces: Sequence[ActingForce], length: float, unit: str) -> VectorScale | None:
    """Return the scale at which the longest force has a length. None without forces."""
    longest = max((abs(one.force) for one in forces), default=0.0)
    if longest <= 0:
        return None
    amount = round_below(longest)
    return VectorScale(REACTION, length / longest, amount, f"{amount:g} {unit}")


@dataclass(frozen=True)
class DrawnForce:
    """A force on a picture. `start` and `stop` are the ends of its arrow, `tip` where its name belongs."""

    force: ActingForce
    start: complex
    stop: complex
    away: complex

    @property
    def is_visible(self) -> bool:
        """Whether its arrow is long enough to be drawn."""
        return abs(self.stop - self.start) >= SHORTEST

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """The arrow."""
        title = f"{self.force.description}: {force_text(abs(self.force.force))}"
        made = arrow_shapes(self.start, self.stop, self.force.kind)
        return (ShapeGroup(made, title=title, links=(self.force.link,)),) if self.is_visible else ()

    def lies_on(self, other: DrawnForce) -> bool:
        """Return whether its arrow covers a part of another."""
        way, e = self.stop - self.start, unit_direction(other.stop - other.start)
        if not (self.is_visible and other.is_visible) or abs((np.conjugate(e) * way).imag) > PARALLEL * abs(way):
            return False
        ends = [np.conjugate(e) * (end - other.start) for end in (self.start, self.stop)]
        if abs(ends[0].imag + ends[1].imag) / 2.0 >= ASIDE - CLOSE:
            return False
        low, high = sorted(end.real for end in ends)
        return bool(min(high, abs(other.stop - other.start)) - max(low, 0.0) > CLOSE)

    def label(self, text: str, key: str) -> Label:
        """Return the label at the free end of the arrow."""
        is_ahead = (np.conjugate(self.away) * (self.stop - self.start)).real > 0.0
        at = self.stop if is_ahead else self.start
        return label_around(key, at, text_half(text, SMALL), 3.0, self.away)


def force_arrow(one: ActingForce, at: complex, scale: VectorScale, middle: complex | None = None) -> DrawnForce:
    """Return the arrow of a force at a place of the picture.

    It leads away from the place; into the place where it presses on a body whose middle is given.
    """
    way = complex(np.conjugate(one.force)) * scale.per_unit
    e = unit_direction(way)
    inward = (
        middle is not None and abs(middle - at) > CLEAR and (np.conjugate(e) * unit_direction(middle - at)).real > 0.2
    )
    if inward:
        return DrawnForce(one, at - e * CLEAR - way, at - e * CLEAR, -e)
    return DrawnForce(one, at + e * CLEAR, at + e * CLEAR + way, e)


def side_by_side(arrows: Sequence[DrawnForce]) -> list[DrawnForce]:
    """Return arrows of which none lies on another: one that would is shifted across its line.

    >>> one = ActingForce("F", "M", "", "a", "", "load", 0j, 10 + 0j, 0.0)
    >>> both = DrawnForce(one, 6 + 0j, 40 + 0j, 1 + 0j), DrawnForce(one, 60 + 0j, 6 + 0j, 1 + 0j)
    >>> [drawn.start for drawn in side_by_side(both)]
    [(6+0j), (60-6j)]
    """
    found: list[DrawnForce] = []
    for one in arrows:
        across = 1j * unit_direction(one.stop - one.start)
        # the nearest free line, on either side of its own
        shifts = (across * ASIDE * k for n in range(len(arrows) + 1) for k in dict.fromkeys((n, -n)))
        moved = (replace(one, start=one.start + shift, stop=one.stop + shift) for shift in shifts)
        found.append(next(own for own in moved if not any(map(own.lies_on, found))) if one.is_visible else one)
    return found


def moment_arc(one: ActingForce, at: complex, radius: float, toward: complex) -> tuple[Shape, ...]:
    """Draw a moment as an arc with a head beside its place. It is not to scale."""
    # counterclockwise is clockwise in coordinates whose y points downward
    sweep = -float(np.sign(one.moment)) * SWEEP
    arrow = curved_arrow(at, unit_direction(toward) * np.exp(-0.5j * sweep), sweep, radius, one.kind)
    title = f"moment, {one.description}: {force_text(abs(one.moment))}"
    return (ShapeGroup(arrow, title=title, links=(one.link,)),)


def moment_arcs(
    forces: Sequence[ActingForce],
    place: Callable[[complex], complex],
    toward: complex,
    first: float = ROUND,
    arrows: Sequence[DrawnForce] = (),
) -> Iterator[tuple[ActingForce, tuple[Shape, ...], Label]]:
    """Yield the arcs of all moments with labels. Several at one place are one around another.

    An arc is on the side away from the link where no arrow begins, as far as there is room.
    """
    taken: list[complex] = []
    for k, one in enumerate(one for one in forces if one.moment):
        at = place(one.at)
        radius = first if one.is_driver else ROUND
        radius += NEXT * sum(abs(other - at) < 1.0 for other in taken)
        taken.append(at)
        way = toward - at if abs(toward - at) > CLEAR else -1j
        outward = _free_side(at, radius, unit_direction(complex(way)), arrows)
        shapes = moment_arc(one, at, radius, outward)
        half = text_half(one.turning, SMALL)
        yield one, shapes, label_around(f"moment {k} {one.turning}", at + outward * radius, half, 5.0, outward)


def _free_side(at: complex, radius: float, inward: complex, arrows: Sequence[DrawnForce]) -> complex:
    """Return the direction of the middle of an arc that crosses the fewest arrows, else is farthest from its link."""
    near = (max((one.start, one.stop), key=lambda end: abs(end - at)) for one in arrows
            if one.is_visible and min(abs(one.start - at), abs(one.stop - at)) < radius)  # fmt: skip
    crossed = [(unit_direction(end - at), ON_ARROW) for end in near if abs(end - at) > radius]
    best, least = -inward, np.inf
    for k in range(TURNED):
        tried = complex(-inward * np.exp(2j * np.pi * k / TURNED))
        cost = sum(weight * _covered(tried, way) for way, weight in [*crossed, (inward, ON_LINK)])
        if cost < least - NOTHING:
            best, least = tried, cost
    return best


def _covered(middle: complex, way: complex) -> float:
    """Return how far a direction is within an arc: 1 in its middle, 0 from its ends with some room on."""
    return max(0.0, 1.0 - abs(float(np.angle(way * np.conjugate(middle)))) / (0.5 * SWEEP + ARC_ROOM))


def force_name(text: str, at: complex, kind: str) -> tuple[Shape, ...]:
    """Return the name of a force, readable on lines."""
    return Text(at, text, f"halo {kind}-name"), Text(at, text, f"{kind}-name")


def force_text(value: float) -> str:
    """Return a value as it stands beside an arrow.

    >>> force_text(12754.9), force_text(0.5)
    ('12750', '0.5')
    """
    return f"{float(f'{value + 0.0:.{DIGITS}g}'):.{PLAIN}g}"


LOWERED = str.maketrans("0123456789-", "₀₁₂₃₄₅₆₇₈₉₋")
# Forces below this part of the largest are rounding.
NOTHING = 1e-9
# Arcs are not to scale: a moment below this part of the largest force by the size would look like any other.
FAINT = 1e-5


@dataclass(frozen=True)
class ActingForce:
    """A force and a moment on a link at one pose.

    `name` and `turning` are their short names, `description` says it in words.
    `kind` is the style they are drawn in, `at` a place of the mechanism's plane.
    """

    name: str
    turning: str
    description: str
    link: str
    by: str
    kind: str
    at: complex
    force: complex
    moment: float
    is_driver: bool = False
    is_open: bool = False


def forces_in(forces: Forces, scene: Scene) -> Forces:
    """Return forces at the pose of a scene. They are found anew where it is between the poses of the motion."""
    if scene.shown is None or scene.shown is forces.motion:
        return forces
    return force_analysis(scene.shown, **forces.motion.loading)


@dataclass(frozen=True, eq=False)
class ForceCourse:
    """A force and a moment on a link along a motion.

    `shown` says what it is; `at`, `force` and `moment` are its numbers at all poses of one design, (poses,).
    """

    shown: ActingForce
    at: Number
    force: Number
    moment: Number

    def at_pose(self, k: int) -> ActingForce:
        """Return it at a pose."""
        return replace(self.shown, at=complex(self.at[k]), force=complex(self.force[k]), moment=float(self.moment[k]))


Courses: TypeAlias = Mapping[str, tuple[ForceCourse, ...]]


def force_courses(forces: Forces, scene: Scene, design: int) -> Courses:
    """Return what acts on every link at all poses of a design."""
    return {link: tuple(_courses(forces, scene, link, design)) for link in scene.legend}


def acting_forces(forces: Forces, scene: Scene) -> Mapping[str, tuple[ActingForce, ...]]:
    """Return what acts on every link at a pose, the frame included."""
    design, pose = scene.pose
    courses = force_courses(forces_in(forces, scene), scene, design)
    found = {link: tuple(one.at_pose(pose) for one in own) for link, own in courses.items()}
    force = largest_force(found)
    turning = force * scene.mechanism.geometry.size * FAINT
    return {link: tuple(_cleaned(one, force * NOTHING, turning) for one in own) for link, own in found.items()}


def is_drawn_once(one: ActingForce, legend: Mapping[str, int]) -> bool:
    """Return whether a force stands for itself and its opposite.

    The force of a pair does so on its later link, a force on the frame never.
    """
    place = list(legend)
    later = one.by in legend and place.index(one.by) > place.index(one.link)
    return one.link != FRAME and not (one.kind == REACTION and later)


def largest_force(found: Mapping[str, tuple[ActingForce, ...]]) -> float:
    """Return the largest force that acts anywhere."""
    sizes = [abs(one.force) for own in found.values() for one in own]
    return max((size for size in sizes if np.isfinite(size)), default=0.0)


def _cleaned(one: ActingForce, force: float, moment: float) -> ActingForce:
    """Rounding as zero; what equilibrium leaves open is named, and not drawn."""
    if not np.isfinite(one.force) or not np.isfinite(one.moment):
        return replace(one, force=0j, moment=0.0, is_open=True)
    return replace(
        one, force=0j if abs(one.force) <= force else one.force, moment=0.0 if abs(one.moment) <= moment else one.moment
    )


def _courses(forces: Forces, scene: Scene, link: str, design: int) -> Iterator[ForceCourse]:
    """Yield what acts on a link: the forces of pins that join more than two links as one each, then all others."""
    acting = tuple(forces.on(link))
    pins = [letter for letter, pin in forces.pins.items() if len(pin.links) > 2 and link in pin.links]
    twice = Counter(one.by for one in acting if one.kind == PAIR)
    for letter in pins:
        pin = _course(forces.pins[letter].on(link), design, f"F{_lowered(scene, link)}({letter})", "M")
        # the torque of a driver at the pin is drawn by itself
        turned = [_course(one, design, "", "").moment for one in acting if one.kind == DRIVER and one.at == letter]
        yield replace(pin, moment=pin.moment - sum(turned)) if turned else pin
    for one in acting:
        if one.kind != PAIR or one.at not in pins:
            yield _course(one, design, *_names(scene, one, twice[one.by] > 1))


def _names(scene: Scene, one: LinkWrench, several: bool) -> tuple[str, str]:
    """The names of a force and of a moment, by the numbers of the links."""
    own = _lowered(scene, one.on)
    if one.kind == PAIR:
        both = _lowered(scene, one.by, one.on)
        return f"F{both}" + (f"({one.name})" if several else ""), f"M{both}"
    if one.kind == DRIVER:
        return f"P{own}", f"T{own}"
    if one.kind == WEIGHT:
        return f"m{own}g", f"m{own}g"
    if one.kind == OF_INERTIA:
        return f"−m{own}a{own}", f"−J{own}α{own}"
    called = one.kind if one.name.startswith(f"{one.kind} on ") else one.name
    return called, called


def _lowered(scene: Scene, *links: str) -> str:
    """The numbers of links as an index: with a dash where one has two digits."""
    numbers = [str(scene.numbers[link]) for link in links]
    return ("-" if any(len(number) > 1 for number in numbers) else "").join(numbers).translate(LOWERED)


def _course(one: LinkWrench, design: int, name: str, turning: str) -> ForceCourse:
    description = described_wrench(one.kind, one.name, one.on, one.by)
    kind = REACTION if one.kind in (PAIR, DRIVER, FRICTION) else INERTIA if one.kind == OF_INERTIA else LOAD
    shown = ActingForce(name, turning, description, one.on, one.by, kind, 0j, 0j, 0.0, one.kind == DRIVER)

    def row(values: Any) -> Number:
        rows = np.broadcast_to(values, one.motion.shape).reshape(one.motion.inputs.designs, one.motion.inputs.poses)
        return rows[min(design, len(rows) - 1)]

    return ForceCourse(shown, row(one.place), row(one.force), row(one.moment))


def described_wrench(kind: str, name: str, on: str, by: str) -> str:
    """Return in words what acts on a link.

    >>> described_wrench("pair", "A", "rod", "crank")
    'pair A on rod by crank'
    """
    return f"{kind} {name} on {on}" + (f" by {by}" if by else "")


def drawn_force_courses(forces: Forces, scene: Scene, design: int) -> tuple[ForceCourse, ...]:
    """Return the forces that are drawn along a motion.

    That in each pair is drawn on its later link; forces that are always small beside the largest are left out.
    """
    found = force_courses(forces, scene, design)
    kept = [one for own in found.values() for one in own if is_drawn_once(one.shown, scene.legend)]
    largest = max(map(_longest, kept), default=0.0)
    return tuple(one for one in kept if largest and _longest(one) >= SMALL_PART * largest)


def drawn_moment_courses(forces: Forces, scene: Scene, design: int) -> tuple[ForceCourse, ...]:
    """Return the moments that are drawn along a motion, as its forces are."""
    found = force_courses(forces, scene, design)
    kept = [one for own in found.values() for one in own if is_drawn_once(one.shown, scene.legend)]
    force = max(map(_longest, kept), default=0.0) * scene.mechanism.geometry.size * FAINT
    turning = [float(np.max(np.abs(one.moment), initial=0.0, where=np.isfinite(one.moment))) for one in kept]
    least = max(force, SMALL_PART * max(turning, default=0.0))
    return tuple(one for one, most in zip(kept, turning, strict=True) if most > least)


def force_scales(forces: Forces, diagonal: float, courses: tuple[ForceCourse, ...]) -> tuple[VectorScale, ...]:
    """Return the scale of each kind of forces, one for all."""
    longest = max(map(_longest, courses), default=0.0)
    if not longest:
        return ()
    per_unit, amount = LONGEST * diagonal / longest, round_below(longest)
    kinds = dict.fromkeys(one.shown.kind for one in courses)
    return tuple(VectorScale(kind, per_unit, amount, f"{amount:g} {forces.units.force}") for kind in kinds)


def _longest(one: ForceCourse) -> float:
    """The greatest length of a force along the motion."""
    sizes = np.abs(one.force)
    return float(np.max(sizes, initial=0.0, where=np.isfinite(sizes)))
