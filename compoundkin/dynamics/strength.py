"""Strength at a glance: normal force, shear and bending moment along the bars of links; beam statics and no more."""

from __future__ import annotations

import inspect
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.dynamics.driver_course import Line, in_units, texts_of_designs
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.reactions.link_wrench import INERTIA, WEIGHT, LinkWrench
from compoundkin.kinematics.extremes import extended_to
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Quantity, Table, table_of
from compoundkin.model.attributes import DEGREES, VALUE, with_unit
from compoundkin.model.geometry import FRAME
from compoundkin.model.units import Units

# Points of a link within this part of its length of a line are on it: they are so but for rounding.
IN_LINE = 1e-9
# Every bar has so many stations at equal distances, beside those at its points, its loads and where the shear is zero.
EVEN_STATIONS = 21
# Diagrams have so many stations at equal distances, and others beside what acts by this part of the bar's length.
DRAWN, ASIDE = 161, 1e-9
# Places are told apart by so many digits of the bar's length.
JUMPS = 12
# A bar is pinned where the moment at its ends is below this part of the largest, the rounding of forces.
PINNED = 1e-9
# How a mass that is not assumed to be a uniform bar's acts.
POINT_MASS = "its mass acts as a force and a moment at its centre"
# The quantities along a bar.
NORMAL, SHEAR, BENDING, STATION = "normal force", "shear", "bending moment", "station"


class BarExtreme(NamedTuple):
    """The least or greatest value along a bar over all poses, its distance from the first point, and the pose."""

    value: float
    position: float
    pose: int


@dataclass(frozen=True, eq=False, repr=False)
class BarForces(ShortRepr):
    """Normal force, shear and bending moment along the bar of a link, in the mechanism's units.

    Arrays have the motion's shape and a last axis of stations, in order of their distance `position` from the first of
    the `letters`; places where something acts stand twice, before and behind it. The bar's x axis is from the first
    letter to the last, y is 90 degrees counterclockwise of it. The normal force is positive in tension; shear and
    bending moment are those of all that acts before the station, forces up positive, so that the bending moment
    grows along the bar as the shear. `assumed` says how its mass is counted.
    """

    motion: Motion = field(repr=False)
    link: str
    letters: tuple[str, ...]
    length: Number
    position: Number
    normal: Number
    shear: Number
    bending: Number
    assumed: str = ""

    @cached_property
    def _of_designs(self) -> Mapping[str, Number]:
        """Each quantity and the positions, (designs, poses, stations)."""
        shape = (*self.motion.failed.shape, -1)
        values = {STATION: self.position, NORMAL: self.normal, SHEAR: self.shear, BENDING: self.bending}
        return {name: value.reshape(shape) for name, value in values.items()}

    def extremes(self, what: str, design: int = 0) -> tuple[BarExtreme, BarExtreme]:
        """Return the least and the greatest "normal force", "shear" or "bending moment" of a design at its poses.

        NaN where no pose is known. Raises UnknownName for another quantity.
        """
        self._check(what)
        places = self._of_designs[STATION][design]
        values = np.where(_within(places, float(self.length[design])), self._of_designs[what][design], np.nan)
        if not np.isfinite(values).any():
            return (BarExtreme(np.nan, np.nan, 0),) * 2
        found = (np.unravel_index(find(values), values.shape) for find in (np.nanargmin, np.nanargmax))
        least, greatest = (BarExtreme(float(values[at]), float(places[at]), int(at[0])) for at in found)
        return least, greatest

    def stations(self, design: int = 0) -> Number:
        """Return distances from the first point for diagrams: even ones, and both sides of where something acts.

        The first is behind what acts at the first point, the last before what acts at the last.
        """
        length = float(self.length[design])
        aside = ASIDE * length
        own = self._of_designs[STATION][design]
        twice = np.unique(np.round(own[:, 1:][np.diff(own, axis=-1) == 0.0] / length, JUMPS)) * length
        # a load that moves along the bar has other places at every pose: there they are drawn as they come
        jumps = twice if len(twice) <= DRAWN else np.array(list(self.places(design).values()))
        beside = (np.array([place - aside, place + aside]) for place in jumps)
        found = [np.linspace(0.0, length, DRAWN), *beside]
        return np.unique(np.clip(np.concatenate(found), aside, length - aside))

    def places(self, design: int = 0) -> dict[str, float]:
        """Return the distances of its letters from the first one."""
        own = self.motion.mechanism.geometry.points[self.link]
        known = {letter: complex(_of_design(self.motion, own[letter], design)) for letter in self.letters}
        return {letter: abs(z - known[self.letters[0]]) for letter, z in known.items()}

    def envelope(self, what: str, design: int = 0) -> tuple[Number, Number, Number]:
        """Return the `stations` of a quantity, and its least and greatest value there over all poses, NaN if unknown.

        Raises UnknownName for another quantity.
        """
        places = self.stations(design)
        values = self.along(what, places, design)
        known = np.isfinite(values).any(axis=0)
        least, greatest = np.where(np.isnan(values), np.inf, values), np.where(np.isnan(values), -np.inf, values)
        return places, np.where(known, least.min(axis=0), np.nan), np.where(known, greatest.max(axis=0), np.nan)

    def along(self, what: str, places: Number, design: int = 0) -> Number:
        """Return "normal force", "shear" or "bending moment" at distances from the first point, (poses, places).

        Behind what acts where something does. Raises UnknownName for another quantity.
        """
        self._check(what)
        own, values = self._of_designs[STATION][design], self._of_designs[what][design]
        at = np.count_nonzero(own[:, :, None] <= np.asarray(places, dtype=float), axis=1)
        behind = np.clip(at, 1, own.shape[-1] - 1)
        low, high = (np.take_along_axis(own, behind - k, axis=-1) for k in (1, 0))
        start, end = (np.take_along_axis(values, behind - k, axis=-1) for k in (1, 0))
        part = np.divide(places - low, high - low, out=np.zeros(start.shape), where=high > low)
        part = np.clip(part, 0.0, 1.0)
        found: Number = start + part * (end - start)
        if what == BENDING:  # it grows as the shear: a cubic, by values and rates at both ends
            rates = (np.take_along_axis(self._of_designs[SHEAR][design], behind - k, axis=-1) for k in (1, 0))
            first, last = (rate * (high - low) - (end - start) for rate in rates)
            found = found + part * (1.0 - part) * ((1.0 - part) * first - part * last)
        return found

    def _check(self, what: str) -> None:
        known = (NORMAL, SHEAR, BENDING)
        if what not in known:
            raise UnknownName(Problem(str(what), "a bar has no such quantity", suggestion(str(what), known)))

    @property
    def is_clamped(self) -> bool:
        """Whether a moment acts at one of its ends."""
        size = np.abs(self.bending)
        ends = (self._of_designs[STATION] == 0.0) | (self._of_designs[STATION] == self.length[:, None, None])
        largest = max(self._largest(BENDING, k) for k in range(len(self.length)))
        return bool(np.nanmax(np.where(ends.reshape(size.shape), size, 0.0), initial=0.0) > PINNED * largest)

    def lines(self, design: int) -> Iterator[Line]:
        """Yield its lines of text: the extremes of each quantity with their places and poses."""
        units = self.motion.mechanism.stated_units
        yield (f"{self.link}: bar {'-'.join(self.letters)}", float(self.length[design]), units.length)
        for what, unit in ((NORMAL, units.force), (SHEAR, units.force), (BENDING, units.moment)):
            for word, one in zip(("least", "greatest"), self.extremes(what, design), strict=True):
                own = in_units(f"{word} {what}", _shown(one.value, self._largest(what, design)), unit)
                yield (*own, *[""] * (5 - len(own)), f"{one.position:.6g} {units.length} from {self.letters[0]}",
                       f"at {pose_text(self.motion, design, one.pose)}")  # fmt: skip
        if self.assumed:
            yield (f"assumed: {self.assumed}" if "uniform" in self.assumed else self.assumed,)

    def _largest(self, what: str, design: int) -> float:
        """The largest value of all, by which what is rounding is told."""
        size = max(max(abs(end.value) for end in self.extremes(name, design)) for name in (NORMAL, SHEAR))
        own = max(abs(end.value) for end in self.extremes(what, design))
        return max(own, size * float(self.length[design])) if what == BENDING else size


def _of_design(motion: Motion, value: Number, design: int) -> Any:
    """Return a value of the first pose of a design."""
    return np.broadcast_to(extended_to(motion, value), motion.failed.shape)[design, 0]


def _within(places: Number, length: float) -> Number:
    """Return which stations are on the bar: behind what acts at its first point, before what acts at its last."""
    start, end = places <= 0.0, places >= length
    again, since = np.roll(start, -1, axis=-1), np.roll(end, 1, axis=-1)
    again[..., -1], since[..., 0] = False, False
    return ~(start & again) & ~(end & since)


# In a text, values below this part of the largest are rounding of the forces.
ROUNDING = 1e-11


def _shown(value: float, largest: float) -> float:
    return 0.0 if abs(value) <= ROUNDING * largest else value


def pose_text(motion: Motion, design: int, pose: int) -> str:
    """Return "crank 35°", the drivers at a pose."""
    shape, texts = motion.failed.shape, []
    for name, drive in motion.drives.items():
        value = np.broadcast_to(drive.value, motion.shape).reshape(shape)[design, pose]
        number = f"{np.rad2deg(value) if drive.is_angle else value:.6g}"
        texts.append(f"{name} {with_unit(number, DEGREES if drive.is_angle else '')}")
    return ", ".join(texts) or f"pose {pose}"


@dataclass(frozen=True, eq=False, repr=False)
class Strength(ShortRepr):
    """Strength at a glance: the forces along the bars of links, by beam statics and no more.

    `bars` are by the link's name, the arms of a bell crank by it and their letters, "bell A-P"; `undefined` are the
    links without a bar, with the reason. `stresses` are those in the outermost fibre of links with a section, of the
    normal force over the area and the bending moment over the section modulus, in the shape of the bar's arrays;
    `buckling` the buckling loads of links with a section and a modulus of elasticity, `pins` the stresses of pins
    with a diameter.
    """

    forces: Forces = field(repr=False)
    bars: Mapping[str, BarForces]
    undefined: Mapping[str, str]
    stresses: Mapping[str, Number] = field(default_factory=dict)
    buckling: Mapping[str, BucklingLoad] = field(default_factory=dict)
    pins: Mapping[str, PinStress] = field(default_factory=dict)

    def __repr__(self) -> str:
        more = f"; no bar: {', '.join(self.undefined)}" if self.undefined else ""
        return f"Strength(bars {', '.join(self.bars) or 'none'}{more})"

    def text(self) -> str:
        """Return it as text, a block for each design: units named, moments in N m as well, angles in degrees."""
        return texts_of_designs(self.forces.motion.inputs.designs, self._lines)

    def table(self) -> Table:
        """Return all loads on each link in the link's own axes as columns, a row for each pose, as for finite elements.

        Each has its `place`, its `force` there and the `moment` about it; their sum with weight and inertia is zero.
        """
        motion = self.forces.motion
        whole = table_of(motion, *(f"{name}.{VALUE}" for name in motion.drives))
        links = dict.fromkeys([*(bar.link for bar in self.bars.values()), *self.undefined])
        own = (column for link in links for column in self._columns(link))
        return replace(whole, columns=(*whole.columns, *own))

    def _columns(self, link: str) -> Iterator[Quantity]:
        """Yield the columns of what acts on a link."""
        motion, units, seen = self.forces.motion, self.forces.units, Counter[str]()
        pose = motion.poses[link]
        for one in self.forces.on(link):
            name = f"{link}.{one.kind} {one.name}"
            seen[name] += 1
            name += f" {seen[name]}" if seen[name] > 1 else ""
            turn = np.where(motion.failed == 0, pose.u.c[0], 1.0)
            with np.errstate(invalid="ignore"):  # of poses that are not assembled or singular
                place, force = (one.attack - pose.z.c[0]) / turn, one.determined.force / turn
            columns = (("place", units.length, place, 0j), ("force", units.force, force, 0j),
                       ("moment", units.moment, one.moment, 0.0))  # fmt: skip
            for word, unit, value, zero in columns:
                shown = value if word == "moment" else motion.grid.known(value + zero)
                values = np.broadcast_to(shown, motion.shape).reshape(-1)
                yield from Quantity(f"{name}.{word}", unit, values).components

    def _lines(self, design: int) -> Iterator[Line]:
        yield ("beam statics: rigid links, forces at the poses solved; no deflection, notches, fatigue or impact",)
        for name, bar in self.bars.items():
            yield from bar.lines(design)
            yield from self._stress_lines(name, design)
        for letter, pin in self.pins.items():
            yield from pin.lines(letter, self.forces, design)
        for link, reason in self.undefined.items():
            yield (f"{link}: {reason}",)

    def _stress_lines(self, name: str, design: int) -> Iterator[Line]:
        units = self.forces.units
        if name in self.stresses:
            found = self.stresses[name].reshape(*self.forces.motion.failed.shape, -1)[design]
            yield "greatest stress", float(np.nanmax(found)) if np.isfinite(found).any() else np.nan, _pressure(units)
        if name in self.buckling:
            load, compression = (float(one[design]) for one in self.buckling[name][:2])
            words = "not pressed" if compression <= 0.0 else f"{load / compression:.4g} times the greatest compression"
            yield "buckling load (Euler)", load, units.force, "", "", words


class BucklingLoad(NamedTuple):
    """Euler's load of a bar pinned at both ends, and the greatest compression in it, (designs,).

    It is that of buckling in the plane of the mechanism, pi^2 E I / l^2; `safety` is infinite where nothing presses.
    """

    load: Number
    compression: Number

    @property
    def safety(self) -> Number:
        """The buckling load over the greatest compression."""
        with np.errstate(divide="ignore"):
            return np.where(self.compression > 0.0, self.load / np.abs(self.compression), np.inf)


class PinStress(NamedTuple):
    """The greatest force on a link at a pin, shear over the pin's section and pressure in its bearing, (designs,).

    The shear is F / A, its mean over one section or as many as are sheared, the pressure F / (d b).
    """

    force: Number
    shear: Number
    pressure: Number
    link: Sequence[str]
    pose: Number

    def lines(self, letter: str, forces: Forces, design: int) -> Iterator[Line]:
        """Yield its lines of text."""
        units = forces.units
        at = f"at {pose_text(forces.motion, design, int(self.pose[design]))}"
        where = f"on {self.link[design]}"
        yield f"pin {letter}: greatest force", float(self.force[design]), units.force, "", "", where, at
        yield "shear", float(self.shear[design]), _pressure(units)
        yield "bearing pressure", float(self.pressure[design]), _pressure(units)


def _pressure(units: Units) -> str:
    return f"{units.force}/{units.length}^2"


class BarSection(NamedTuple):
    """The area of a section, its second moment of area in the plane of the mechanism, and its section modulus."""

    area: float
    second_moment: float
    modulus: float


def _rectangle(width: float, height: float) -> BarSection:
    return BarSection(width * height, width * height**3 / 12.0, width * height**2 / 6.0)


def _circle(diameter: float) -> BarSection:
    return BarSection(np.pi * diameter**2 / 4.0, np.pi * diameter**4 / 64.0, np.pi * diameter**3 / 32.0)


def _tube(diameter: float, wall: float) -> BarSection:
    if 2.0 * wall > diameter:
        raise InvalidInput(Problem("wall", f"a wall of {wall:g} is more than half of the diameter {diameter:g}"))
    whole, hole = _circle(diameter), _circle(diameter - 2.0 * wall)
    second = whole.second_moment - hole.second_moment
    return BarSection(whole.area - hole.area, second, 2.0 * second / diameter)


# Sections by what is given of them; the height of a rectangle is across the bar, in the plane of the mechanism.
SECTIONS: tuple[Callable[..., BarSection], ...] = (_rectangle, _circle, _tube, BarSection)
SECTION_KEYS = {frozenset(inspect.signature(kind).parameters): kind for kind in SECTIONS}


def _section(link: str, given: Any) -> BarSection:
    """Return the section of a link. Raises InvalidInput for what is none."""
    where = f"sections[{link!r}]"
    make = SECTION_KEYS.get(frozenset(given)) if isinstance(given, Mapping) else None
    if make is None:
        known = "; ".join(", ".join(inspect.signature(kind).parameters) for kind in SECTIONS)
        raise InvalidInput(Problem(where, f"{given!r} is no section", f"a dictionary with one of: {known}"))
    for key, value in given.items():
        _positive(f"{where}.{key}", value)
    return make(**given)


def _positive(where: str, value: Any) -> float:
    """Return a number above zero. Raises InvalidInput for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) or not 0.0 < value < np.inf:
        raise InvalidInput(Problem(where, f"{value!r} is no number above zero"))
    return float(value)


@checked
def strength(
    forces: Forces,
    *links: str,
    sections: Mapping[str, Any] | None = None,
    elasticity: Mapping[str, Any] | None = None,
    pins: Mapping[str, Any] | None = None,
) -> Strength:
    """Return normal force, shear and bending moment along the bars of links at every pose, by beam statics.

    Without names those are all links but the frame. A link is a bar where all its points, or all points at which
    something acts, are in line; of another that has one pin on the frame each point has an arm from there. The mass
    of a uniform bar, where it is assumed to be one, acts along the bar; any other is a force and a moment at the mass
    centre. What acts beside the bar acts at the nearest place of it, with its moment about that.

    `sections` are of links, for stresses: {"rod": {"width": 8, "height": 20}}, the height in the plane, or "diameter",
    with a "wall" for a tube, or "area", "second_moment" and "modulus". With `elasticity`, {"rod": 210000}, follow
    buckling loads of bars pinned at their two ends. `pins` are diameters and widths in the bearing, {"B": (12, 20)},
    and, where it is not 1, the number of sections sheared, {"B": (12, 20, 2)}. All in the mechanism's units.

    Raises InvalidInput for a mechanism without masses and loads, for numbers not above zero, and for a modulus of
    elasticity without a section, UnknownName for an unknown link or pin.

    Source: any course of statics; R. C. Hibbeler, Engineering Mechanics: Statics, 14th ed., Pearson 2016, chapter 7.

    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.gravity import gravity
    >>> from compoundkin.model.loads.mass import mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> parts = link("frame", A=0), link("arm", A=0, B=2), drive("arm"), mass("arm", 3), gravity(0, -10)
    >>> arm = Mechanism("Arm", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> bar = strength(force_analysis(solve(arm, {"arm": [0.0]}))).bars["arm"]
    >>> [round(one, 9) for one in bar.extremes("bending moment")[0]]            # -m g l / 2 at A
    [-30.0, 0.0, 0]
    """
    mechanism = forces.mechanism
    if not (mechanism.masses or mechanism.loads):
        remedy = "give it masses or loads: ck.mass, ck.force, ck.gravity"
        raise InvalidInput(Problem("forces", "the mechanism has no masses and no loads", remedy))
    bars, undefined = _bars(forces, links)
    chosen = {
        name: _section(_with_bar(name, bars, undefined, "sections"), one) for name, one in (sections or {}).items()
    }
    stresses = {name: np.abs(bars[name].normal) / one.area + np.abs(bars[name].bending) / one.modulus
                for name, one in chosen.items()}  # fmt: skip
    buckling = {}
    for name, modulus in (elasticity or {}).items():
        section = chosen.get(_with_bar(name, bars, undefined, "elasticity"))
        buckling[name] = _buckling(bars[name], _stiffness(name, modulus, section))
    held = {letter: _pin_stress(forces, letter, given) for letter, given in (pins or {}).items()}
    return Strength(forces, bars, undefined, stresses, buckling, held)


def _bars(forces: Forces, links: Sequence[str]) -> tuple[dict[str, BarForces], dict[str, str]]:
    """Return the bars of links, of all but the frame where none is named; and why others are none."""
    own = [name for name in forces.mechanism.links if name != FRAME]
    for name in links:
        if name not in own:
            what = "the frame is no bar" if name == FRAME else "there is no such link"
            raise UnknownName(Problem(name, what, suggestion(name, own)))
    bars, undefined = dict[str, BarForces](), dict[str, str]()
    for name in links or own:
        points = bar_points(forces, name)
        if isinstance(points, str) and (middle := _middle(forces, name)):
            tips = [letter for letter in _loaded(forces, name) if letter != middle]
            bars |= {f"{name} {tip}-{middle}": _bar(forces, name, (tip, middle), is_arm=True) for tip in tips}
        elif isinstance(points, str):
            undefined[name] = points
        else:
            bars[name] = _bar(forces, name, points)
    return bars, undefined


def _stiffness(link: str, modulus: Any, section: BarSection | None) -> float:
    """Return the bending stiffness of a bar. Raises InvalidInput where it has no section."""
    where = f"elasticity[{link!r}]"
    if section is None:
        what = "a modulus of elasticity without a section"
        raise InvalidInput(Problem(where, what, f"give sections={{{link!r}: ...}} too"))
    return _positive(where, modulus) * section.second_moment


def _with_bar(link: str, bars: Mapping[str, BarForces], undefined: Mapping[str, str], where: str) -> str:
    """Return the name of a link that has a bar. Raises UnknownName for another."""
    if link not in bars:
        what = undefined.get(link, "there is no such bar")
        raise UnknownName(Problem(f"{where}[{link!r}]", what, suggestion(link, list(bars))))
    return link


def _buckling(bar: BarForces, stiffness: float) -> BucklingLoad:
    """Return the buckling load of a bar pinned at its ends. Raises InvalidInput for another bar."""
    if len(bar.letters) > 2 or bar.is_clamped:
        what = f"{bar.link!r} is not pinned at two ends alone: Euler's load is not its own"
        raise InvalidInput(Problem(f"elasticity[{bar.link!r}]", what, "leave it out"))
    designs = range(len(bar.length))
    pressed = np.array([max(-bar.extremes(NORMAL, k)[0].value, 0.0) for k in designs])
    return BucklingLoad(np.pi**2 * stiffness / bar.length**2, pressed)


def _pin_stress(forces: Forces, letter: str, given: Any) -> PinStress:
    """Return the stresses of a pin from its diameter, the width of its bearing and the number of sections."""
    where = f"pins[{letter!r}]"
    if not isinstance(given, Sequence) or isinstance(given, str) or len(given) not in (2, 3):
        raise InvalidInput(Problem(where, f"{given!r} is no pin", "(diameter, width) or (diameter, width, sections)"))
    words = ("diameter", "width", "sections")
    diameter, width, *more = (_positive(f"{where}: {word}", one) for word, one in zip(words, given, strict=False))
    pin, shape = forces.pins[letter], forces.motion.failed.shape
    found = np.array([np.abs(pin.on(link).force).reshape(shape) for link in pin.links])
    found = np.where(np.isfinite(found), found, -1.0).transpose(1, 0, 2)
    best = found.reshape(shape[0], -1).argmax(axis=-1)
    link, pose = np.divmod(best, shape[1])
    force = found.reshape(shape[0], -1).max(axis=-1)
    force = np.where(force < 0.0, np.nan, force)
    area = _circle(diameter).area * (more[0] if more else 1.0)
    return PinStress(force, force / area, force / (diameter * width), [pin.links[k] for k in link], pose)


def bar_points(forces: Forces, link: str) -> tuple[str, ...] | str:
    """Return the letters of a link's bar in their order along it, or the reason why it has none.

    They are all letters of the link where these are in line, else those at which something acts.
    """
    places = forces.mechanism.geometry.points[link]
    if len(places) < 2:
        return "a link of one point is no bar"
    if (found := _in_line(places)) is not None:
        return found
    loaded = {letter: places[letter] for letter in _loaded(forces, link)}
    if len(loaded) > 1 and (found := _in_line(loaded)) is not None:
        return found
    return f"no bar is defined: forces act at {', '.join(loaded) or 'no letter'}, which are not in line"


def _loaded(forces: Forces, link: str) -> list[str]:
    """Return the letters of a link at which something acts."""
    acting = {one.at for one in forces.on(link) if one.kind not in (WEIGHT, INERTIA)}
    return [letter for letter in forces.mechanism.geometry.points[link] if letter in acting]


def _middle(forces: Forces, link: str) -> str:
    """Return the point from which the arms of a bell crank go: its only pin on the frame, empty where there is none."""
    loaded = _loaded(forces, link)
    pivots = [letter for letter in loaded if FRAME in forces.mechanism.real_pins.get(letter, ())]
    return pivots[0] if len(pivots) == 1 and len(loaded) > 2 else ""


def _in_line(places: Mapping[str, Number]) -> tuple[str, ...] | None:
    """Return letters in their order along their line, by the first design; None where they have none."""
    letters = list(places)
    z = np.array(np.broadcast_arrays(*places.values()), dtype=complex).reshape(len(letters), -1)
    far = np.argmax(np.abs(z[:, None, 0] - z[None, :, 0]))
    first, last = sorted(divmod(int(far), len(letters)))
    whole = z[last] - z[first]
    if np.any(np.abs(whole) == 0.0):
        return None
    along = (z - z[first]) / whole
    if np.any(np.abs(along.imag) > IN_LINE):
        return None
    order = np.argsort(along[:, 0].real, kind="stable")
    return tuple(letters[k] for k in order)


class Acting(NamedTuple):
    """What acts on a bar at a distance from its first point: force in the bar's axes, moment about that place."""

    place: Number
    force: Number
    moment: Number


@np.errstate(invalid="ignore", over="ignore")  # of poses that are not assembled or singular
def _bar(forces: Forces, link: str, letters: Sequence[str], is_arm: bool = False) -> BarForces:
    """Return the forces along a bar through some letters of a link.

    All that does not act on an arm itself is what holds it at its last letter.
    """
    motion = forces.motion
    shape = motion.failed.shape
    own = forces.mechanism.geometry.points[link]
    first, last = (np.broadcast_to(extended_to(motion, own[letter]), shape) for letter in (letters[0], letters[-1]))
    length = np.abs(last - first)
    axis = (last - first) / length
    pose = motion.poses[link]
    assembled = motion.failed == 0
    direction = np.where(assembled, pose.u.c[0], 1.0) * axis
    start = np.where(assembled, pose.z.c[0] + pose.u.c[0] * first, 0.0)
    mass = forces.mechanism.masses.get(link)
    spread = mass is not None and mass.is_uniform_bar and len(letters) == len(own)
    taken = [one for one in forces.on(link) if not (spread and one.kind in (WEIGHT, INERTIA))]
    known = {letter: np.abs(np.broadcast_to(extended_to(motion, own[letter]), shape) - first) for letter in letters}
    acting = [_acting(one, start, direction, length, known, is_arm) for one in taken]
    constant, slope = _along(forces, link, first, axis) if spread else (np.zeros(shape), np.zeros(shape))
    constant, slope = constant / length / direction, slope / length / direction
    position, values = _section_forces(length, acting, constant, slope)
    values = np.where((motion.failed == 0)[..., None], values, np.nan)
    shown = (*motion.shape, position.shape[-1])
    normal, shear, bending = (value.reshape(shown) for value in values)
    assumed = "" if mass is None else mass.assumed if spread else POINT_MASS
    if is_arm:
        assumed = f"an arm held at {letters[-1]}; what acts beside the arms, as weight and inertia may, acts there"
    at = position.reshape(shown)
    return BarForces(motion, link, tuple(letters), length[:, 0], at, normal, shear, bending, assumed)


def _acting(
    one: LinkWrench, start: Number, direction: Number, length: Number, known: Mapping[str, Number], is_arm: bool
) -> Acting:
    """Return a wrench on the bar at the place nearest to its point of attack, beside an arm at its end."""
    attack = np.where(np.isfinite(one.attack), one.attack, start)
    if one.at in known:
        place = known[one.at]
    else:
        place = np.clip(((attack - start) / direction).real, 0.0, length)
        for other in known.values():
            place = np.where(np.abs(place - other) <= IN_LINE * length, other, place)
        aside = np.abs(start + direction * place - attack) > IN_LINE * length
        place = np.where(aside & is_arm, length, place)
    force, moment = one.determined.force, one.determined.about(start + direction * place)
    return Acting(place, np.broadcast_to(force / direction, length.shape), np.broadcast_to(moment, length.shape))


def _along(forces: Forces, link: str, first: Number, axis: Number) -> tuple[Number, Number]:
    """Return weight and inertia of a uniform bar in the world, of its whole mass: at its first point, and its rate."""
    motion, mass = forces.motion, forces.mechanism.masses[link]
    heavy = np.broadcast_to(extended_to(motion, mass.mass), motion.failed.shape) * forces.units.inertia
    constant, slope = heavy * forces.mechanism.free_fall, np.zeros(heavy.shape, dtype=complex)
    pose = motion.poses[link]
    if forces.inertia:
        z, u = (2.0 * part.c[2] if len(part.c) > 2 else 0j for part in (pose.z, pose.u))
        constant = constant - heavy * (z + u * first)
        slope = -heavy * u * axis
    return constant, slope


def _section_forces(length: Number, acting: Sequence[Acting], constant: Number, slope: Number) -> tuple[Number, Number]:
    """Return the stations, and normal force, shear and bending moment there, (3, designs, poses, stations)."""
    shape = length.shape
    places = np.stack([np.zeros(shape), *(one.place for one in acting), length], axis=-1)
    even = length[..., None] * np.linspace(0.0, 1.0, EVEN_STATIONS)
    edges = np.sort(places, axis=-1)
    zeros = _zeros_of_shear(edges, acting, constant, slope)
    position = np.concatenate([places, even, zeros, places], axis=-1)
    behind = np.arange(position.shape[-1]) >= position.shape[-1] - places.shape[-1]
    order = np.lexsort((np.broadcast_to(behind, position.shape), position), axis=-1)
    position, behind = np.take_along_axis(position, order, axis=-1), behind[order]
    return position, _sums_before(position, behind, acting, constant, slope)


def _sums_before(position: Number, behind: Number, acting: Sequence[Acting], constant: Number, slope: Number) -> Number:
    """Return normal force, shear and bending moment at stations, of all that acts before them."""
    s, c, k = position, constant[..., None], slope[..., None]
    force = s * c + s**2 / 2.0 * k
    bending = (s**2 / 2.0 * c + s**3 / 6.0 * k).imag
    for one in acting:
        place = one.place[..., None]
        counts = (place < s) | ((place == s) & behind)
        force = force + np.where(counts, one.force[..., None], 0.0)
        bending = bending + np.where(counts, (s - place) * one.force[..., None].imag - one.moment[..., None], 0.0)
    return np.array([-force.real, force.imag, bending])


def _zeros_of_shear(edges: Number, acting: Sequence[Acting], constant: Number, slope: Number) -> Number:
    """Return where the shear is zero between the places where something acts, elsewhere an end of the interval.

    It is a parabola there, so that the bending moment is greatest at its zeros, or where something acts.
    """
    low, high = edges[..., :-1], edges[..., 1:]
    shear = _sums_before(low, np.ones(low.shape, dtype=bool), acting, constant, slope)[1]
    a, c = 0.5 * slope.imag[..., None], shear
    b = (constant[..., None] + low * slope[..., None]).imag
    with np.errstate(all="ignore"):
        root = np.sqrt(b * b - 4.0 * a * c)
        q = -0.5 * (b + np.copysign(root, b))  # without cancellation
        found = [low + q / a, low + c / q]
        return np.concatenate([np.where((at > low) & (at < high), at, low) for at in found], axis=-1)
