"""Counterweights that balance the shaking force of a mechanism, fully or as far as possible, and their effect.

Moments of mass become masses at places. Where full balance does not exist, counterweights leave the least shaking
force, or a slider-crank has the classical one that takes a fraction of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, cross, first_entry
from compoundkin.base.display import ShortRepr, count_phrase
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.linear import one_thread
from compoundkin.dynamics.balance_conditions import BALANCED, BalanceConditions, PinDirections, pin_directions
from compoundkin.dynamics.driver_course import nodes, smooth_pieces
from compoundkin.dynamics.mass_motion import mass_centre_place, mass_motions, units_of_masses
from compoundkin.kinematics.extremes import Measure, between, closed_cycles, extremes
from compoundkin.kinematics.jacobian import moved_alone
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.geometry import FRAME, real, vector
from compoundkin.model.loads.mass import mass as mass_of
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import customary_unit


@dataclass(frozen=True, eq=False, repr=False)
class ForceBalance(ShortRepr):
    """A mechanism with counterweights, and figures before and after balancing.

    `is_full` says whether its shaking force is zero at every pose. Where that is impossible, `unreached` are the links
    with mass that no chain of pins joins to the frame. `before` and `after` are of inertia forces alone, without
    weights and loads; the shaking moment is about the place `about`.
    """

    mechanism: Mechanism
    counterweights: tuple[Counterweight, ...]
    is_full: bool
    unreached: tuple[str, ...]
    about: complex
    before: tuple[BalanceFigure, ...]
    after: tuple[BalanceFigure, ...]

    def text(self) -> str:
        """Return the counterweights and a table of figures before and after as text."""
        return "\n".join((self._headline, *(one.text(self.mechanism) for one in self.counterweights), *self._rows()))

    @property
    def _headline(self) -> str:
        if self.is_full:
            return f"Full force balance by {count_phrase(len(self.counterweights), 'counterweight')}."
        if not self.unreached:
            return f"Partial force balance by {count_phrase(len(self.counterweights), 'counterweight')}."
        links = ", ".join(self.unreached)
        why = f"no chain of pins alone joins {links} to the frame"
        best = "Partial balance:" if self.counterweights else "No link that turns is pinned to the frame."
        return f"Full force balance by counterweights does not exist: {why}. {best}"

    def _rows(self) -> tuple[str, ...]:
        about = f"({self.about.real:.6g}, {self.about.imag:.6g})"
        head = f"{'masses alone, moment about ' + about:<44}{'before':>14}{'after':>14}"
        rows = [head]
        for old, new in zip(self.before, self.after, strict=True):
            for word, a, b in (("greatest", old.greatest, new.greatest), ("rms", old.rms, new.rms)):
                rest = b if b > BALANCED * a else 0.0
                for unit, size in filter(None, ((old.unit, 1.0), customary_unit(old.unit))):
                    rows.append(f"{f'{old.name}, {word} [{unit}]':<44}{a * size:>14.6g}{rest * size:>14.6g}")
        return tuple(rows)

    def __repr__(self) -> str:
        kind = "full" if self.is_full else "partial"
        return f"ForceBalance({kind}, {count_phrase(len(self.counterweights), 'counterweight')}: {self.mechanism!r})"


@checked
@one_thread
def counterweights(
    what: Motion | Mechanism,
    links: str | Sequence[str] = (),
    *,
    mass: Any = None,
    radius: Any = None,
    most_mass: Any = None,
    most_radius: Any = None,
    disc: Any = 0.0,
    fraction: float | None = None,
    about: Any = None,
) -> ForceBalance:
    """Return the mechanism with counterweights that balance its shaking force.

    Full force balance by linearly independent vectors: the mass centre of all links rests. `links` take counterweights;
    by default those pinned to the frame and as many others as needed. Each has a `mass` or a `radius` from its link's
    pin (one number or a mapping by link); the default radius is the link's length. It is a point, or a disc with the
    radius `disc`. Where full balance does not exist, or other links are named, the squared shaking force over the
    motion is minimised; a slider-crank's crank may balance a `fraction` of the reciprocating mass instead.

    `most_mass` bounds masses at given radii, `most_radius` the distances of given masses from their pins, by one number
    or a mapping by link. Where full balance would exceed them, the squared shaking force is the least within them.

    A mechanism is solved over its own motion, which should be a closed cycle. Figures before and after are of masses
    alone, the shaking moment `about` a letter or a place of the frame: moment and drivers' torque usually rise. Raises
    InvalidInput for several designs, for masses that are arrays, and for bounds of what is given; UnknownName for an
    unknown link.

    Source: R. S. Berkof and G. G. Lowen, J. Engineering for Industry 91, 1969, 21-26; where it does not exist, F. R.
    Tepper and G. G. Lowen, J. Engineering for Industry 94, 1972, 789-796.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.mass import mass as of
    >>> parts = link("frame", A=0), link("arm", A=0, B=2), drive("arm"), of("arm", 3.0, at="B")
    >>> arm = Mechanism("Arm", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> found = counterweights(arm, mass=6.0)
    >>> found.is_full, found.counterweights[0].at, found.mechanism.masses["arm"].mass
    (True, (-1+0j), 9.0)
    """
    motion = solve(what) if isinstance(what, Mechanism) else what
    _check_balanceable(motion)
    place, ways = _place(motion, about), pin_directions(motion)
    conditions = BalanceConditions(ways, bool(closed_cycles(motion)[0]))
    sizes = CounterweightSizes(ways, mass, radius, disc, most_mass, most_radius)
    if fraction is None:
        moments = _moments(conditions, _balanced_links(ways, links), sizes)
    else:
        _check_without_bounds(sizes)
        crank, moment = fraction_moment(ways, fraction)
        moments = tuple(sizes.counterweights((crank,), [moment]))
    balanced = with_counterweights(motion, moments)
    after = replace(motion, structure=replace(motion.structure, mechanism=balanced))
    known = BalanceConditions(pin_directions(after), bool(closed_cycles(motion)[0]))
    is_full = not known.unreached and known.moments((), {})[1] <= BALANCED
    figures = [balance_figures(moved, place) for moved in (motion, after)]
    return ForceBalance(balanced, moments, is_full, conditions.unreached, place, *figures)


def _moments(
    conditions: BalanceConditions, links: tuple[str, ...], sizes: CounterweightSizes
) -> tuple[Counterweight, ...]:
    """Return the counterweights of full balance, or of the least shaking force where full balance does not exist."""
    if not conditions.unreached:
        chosen = links or conditions.chosen()
        found, rest = sizes.solve(conditions, chosen)
        if rest <= BALANCED and sizes.hold(found):
            return found
        if rest <= BALANCED:
            return sizes.solve(ShakingSamples(conditions.ways, sizes.longest), chosen)[0]
    chosen = links or conditions.pinned
    return sizes.solve(ShakingSamples(conditions.ways, sizes.longest), chosen)[0]


def _check_without_bounds(sizes: CounterweightSizes) -> None:
    """Raise InvalidInput where bounds are given with a fraction."""
    if sizes.most:
        raise InvalidInput(Problem("fraction", "the fraction alone sizes the counterweight", "leave out its bounds"))


def _check_balanceable(motion: Motion) -> None:
    """Raise InvalidInput for several designs, poses that are not assembled, and a motion without accelerations."""
    units_of_masses(motion)
    if motion.inputs.designs != 1 or not motion.inputs.is_rigid:
        raise InvalidInput(Problem("motion", "only one design is balanced at a time", "solve that design by itself"))
    for mass in motion.mechanism.masses.values():
        if any(np.size(value) != 1 for value in (mass.mass, mass.inertia) if value is not None):
            raise InvalidInput(Problem(f"masses.{mass.link}", "it is not a single number", "give each link one mass"))
    if motion.inputs.poses < 2 or np.any(motion.failed):
        remedy = "solve a range throughout which it closes, best a full turn"
        raise InvalidInput(Problem("motion", "it must be assembled throughout", remedy))
    if motion.order < 2:
        raise InvalidInput(Problem("motion", f"the motion was solved to order {motion.order}", "solve(..., order=2)"))


def _balanced_links(ways: PinDirections, links: str | Sequence[str]) -> tuple[str, ...]:
    names = (links,) if isinstance(links, str) else tuple(links)
    known = [name for name in ways.reached if name != FRAME]
    for name in names:
        if name not in ways.motion.links or name == FRAME:
            raise UnknownName(Problem("links", f"there is no moving link {name!r}", suggestion(str(name), known)))
        if name not in known:
            remedy = f"known: {', '.join(known)}"
            raise InvalidInput(Problem("links", f"no chain of pins joins {name} to the frame", remedy))
    return tuple(dict.fromkeys(names))


def _place(motion: Motion, about: Any) -> complex:
    """Return the reference point of moments; by default the first driver's on the frame."""
    fixed = motion.mechanism.geometry.points[FRAME]
    if about is None:
        first = next(iter(motion.structure.driven.values())).pair
        about = next((letter for letter in first.letters if letter in fixed), 0j)
    if isinstance(about, str):
        if about not in fixed:
            raise UnknownName(Problem("about", f"the frame has no point {about!r}", suggestion(about, list(fixed))))
        about = fixed[about]
    found = np.ravel(vector("about", about))
    if len(found) != 1:
        raise InvalidInput(Problem("about", "it is not a single place", "a letter of the frame, or (x, y)"))
    return complex(found[0])


# The moments of floating links change with their masses: iterations end when they change by less than this part.
CONVERGED, ROUNDS = 1e-13, 200
# A moment of mass below this part of mass times size is zero.
NO_MOMENT = 1e-12
# A moment beyond its bound by this part is on it: rounding of the equations that gave it.
WITHIN = 1e-12
# Sweeps over bounded moments end when none changes by more than this part of the longest, or after so many.
SETTLED, SWEEPS = 1e-14, 100_000


@dataclass(frozen=True)
class Counterweight:
    """A mass added to a link, at a place in the link's frame.

    `inertia` is about its own centre. `moment` is its mass times its position from the pin that joins the link to
    the frame.
    """

    link: str
    moment: complex
    mass: float
    at: complex
    inertia: float

    def text(self, mechanism: Mechanism) -> str:
        """Return it as a line of text."""
        units = mechanism.units
        mass, length = ("", "") if units is None else (f" {units.mass}", f" {units.length}")
        place = f"({self.at.real:.6g}, {self.at.imag:.6g}){length}"
        return f"  {self.link}: {self.mass:.6g}{mass} at {place}, moment of mass {abs(self.moment):.6g}{mass}{length}"


class MomentFinder(Protocol):
    """A solver of moments of mass for links whose counterweights have given masses."""

    def moments(self, links: Sequence[str], added: Mapping[str, float]) -> tuple[Number, float]:
        """Return the moments about the links' pivots, and the unbalanced rest."""


class CounterweightSizes:
    """The masses of counterweights, or their distances from the pivots."""

    def __init__(
        self, ways: PinDirections, mass: Any, radius: Any, disc: Any, most_mass: Any = None, most_radius: Any = None
    ) -> None:
        self.ways = ways
        if mass is not None and radius is not None:
            raise InvalidInput(Problem("mass", "mass and radius are both given", "give one of them"))
        self.masses, self.radii = _by_link(ways, "mass", mass), _by_link(ways, "radius", radius)
        self.discs = _by_link(ways, "disc", disc, least_is_zero=True)
        bounds = _by_link(ways, "most_mass", most_mass), _by_link(ways, "most_radius", most_radius)
        self.most = bounds[0] | bounds[1]
        if wrong := [name for name in bounds[0] if name in self.masses]:
            raise InvalidInput(
                Problem("most_mass", f"the mass on {wrong[0]} is given", "bound its radius: most_radius")
            )
        if wrong := [name for name in bounds[1] if name not in self.masses]:
            raise InvalidInput(
                Problem(
                    "most_radius",
                    f"{wrong[0]} has its counterweight at a given radius, by default the link's length",
                    "give its mass, or bound that: most_mass",
                )
            )

    def longest(self, link: str) -> float:
        """Return the greatest moment of mass that the bounds of a link's counterweight allow, perhaps infinite."""
        if link not in self.most:
            return np.inf
        return self.most[link] * (self.masses[link] if link in self.masses else self._radius(link))

    def hold(self, found: Sequence[Counterweight]) -> bool:
        """Return whether counterweights are within their bounds."""
        return all(abs(one.moment) <= self.longest(one.link) * (1.0 + WITHIN) for one in found)

    def solve(self, solver: MomentFinder, links: tuple[str, ...]) -> tuple[tuple[Counterweight, ...], float]:
        """Return the counterweights of links, and the unbalanced rest."""
        added = dict.fromkeys(links, 0.0)
        for _ in range(ROUNDS):
            moments, rest = solver.moments(links, added)
            new = {name: self.mass(name, abs(moment)) for name, moment in zip(links, moments, strict=True)}
            change = max((abs(new[name] - added[name]) for name in links), default=0.0)
            added = new
            if change <= CONVERGED * max(added.values(), default=0.0):
                return tuple(self.counterweights(links, moments)), rest
        remedy = "give their masses: mass=..."
        raise InvalidInput(Problem("radius", "no masses at these radii balance the mechanism", remedy))

    def mass(self, link: str, moment: float) -> float:
        """Return the mass of a counterweight with a moment of this length."""
        if moment <= NO_MOMENT * self._heaviest * self.ways.motion.size:
            return 0.0
        return self.masses[link] if link in self.masses else moment / self._radius(link)

    @property
    def _heaviest(self) -> float:
        return max(float(first_entry(mass.mass)) for mass in self.ways.motion.mechanism.masses.values())

    def _radius(self, link: str) -> float:
        """Return the distance of a counterweight from its pivot, by default that of the link's farthest point."""
        if link in self.radii:
            return self.radii[link]
        points = self.ways.motion.mechanism.geometry.points[link].values()
        pivot = self.ways.reached[link].pivot
        return max((abs(complex(np.ravel(p)[0]) - pivot) for p in points), default=0.0) or self.ways.motion.size

    def counterweights(self, links: Sequence[str], moments: Sequence[complex] | Number) -> Iterator[Counterweight]:
        """Yield the counterweights of moments, none where a moment is zero."""
        for name, moment in zip(links, moments, strict=True):
            mass = self.mass(name, abs(moment))
            if mass:
                at = self.ways.reached[name].pivot + complex(moment) / mass
                yield Counterweight(name, complex(moment), mass, at, 0.5 * mass * self.discs.get(name, 0.0) ** 2)


def _by_link(ways: PinDirections, where: str, given: Any, least_is_zero: bool = False) -> dict[str, float]:
    """Return numbers by link, from one for all or a mapping. Raises InvalidInput, UnknownName."""
    if given is None:
        return {}
    known = list(ways.reached)
    found = dict(given) if isinstance(given, Mapping) else dict.fromkeys(known, given)
    for name, value in found.items():
        if name not in ways.motion.links:
            raise UnknownName(Problem(where, f"there is no link {name!r}", suggestion(str(name), known)))
        number = np.empty(0) if value is None else np.ravel(real(where, value))
        if len(number) != 1 or number[0] < 0 or (number[0] == 0 and not least_is_zero):
            raise InvalidInput(Problem(where, f"{value!r} is no {where} of a counterweight", "a number above 0"))
        found[name] = float(number[0])
    return found


def with_counterweights(motion: Motion, counterweights: Sequence[Counterweight]) -> Mechanism:
    """Return the mechanism of a motion with counterweights on its links."""
    own, changed = motion.mechanism.masses, []
    for one in counterweights:
        mass, centre, inertia = 0.0, 0j, 0.0
        if one.link in own:
            known = own[one.link]
            mass, inertia = (float(first_entry(value)) for value in (known.mass, known.inertia))
            centre = complex(np.ravel(mass_centre_place(motion, known))[0])
        both = mass + one.mass
        at = (mass * centre + one.mass * one.at) / both
        # zero for one mass alone, without rounding
        spread = mass * one.mass / both * abs(centre - one.at) ** 2
        changed.append(mass_of(one.link, both, at=at, inertia=inertia + one.inertia + spread))
    return motion.mechanism.replace(*changed)


class ShakingSamples:
    """The accelerations of masses and of links along a motion."""

    def __init__(self, ways: PinDirections, longest: Callable[[str], float]) -> None:
        self.longest = longest
        designs, places, self.weights = nodes(smooth_pieces(ways.motion))
        self.ways, self.motion = ways, between(ways.motion, designs, places, 2)
        total = -sum((mass.force for mass in mass_motions(self.motion)), 0j)
        self.force = np.ravel(np.broadcast_to(total, self.motion.failed.shape))

    def moments(self, links: Sequence[str], added: Mapping[str, float]) -> tuple[Number, float]:
        """Return the moments about the links' pivots with the least squared shaking force.

        Return also its root mean square over that without counterweights.
        """
        poses = {name: self.motion.poses[name] for name in links}
        turned = [np.broadcast_to(np.ravel(poses[name].derivative(1.0, 2) - poses[name].derivative(0.0, 2)),
                                  self.weights.shape) for name in links]  # fmt: skip
        force = self.force
        for name in links:
            force = force - added[name] * np.ravel(poses[name].derivative(self.ways.reached[name].pivot, 2))
        root = np.sqrt(self.weights)
        columns = np.array(turned).reshape(len(links), len(self.weights)).T * root[:, None]
        found = np.linalg.lstsq(columns, force * root, rcond=None)[0] if len(links) else np.empty(0, dtype=complex)
        bounds = np.array([self.longest(name) for name in links])
        if np.any(np.abs(found) > bounds):
            found = bounded_moments(columns, force * root, bounds)
        whole = np.linalg.norm(self.force * root)
        return found, float(np.linalg.norm(columns @ found - force * root) / whole) if whole else 0.0


def bounded_moments(columns: Number, force: Number, bounds: Number) -> Number:
    """Return the complex moments no longer than their bounds with the least squared rest of ``columns @ moments``.

    One moment after another is the best for the others as they are: the squares rise alike in all directions from its
    unbounded best, so that it is cut to its length. Arrays (equations, moments), (equations,), (moments,).

    Source: D. P. Bertsekas, Nonlinear Programming, 2nd ed., Athena Scientific 1999, section 2.7.

    >>> bounded_moments(np.eye(2), np.array([3.0 + 4.0j, 1.0]), np.array([1.0, 2.0])).round(12).tolist()
    [(0.6+0.8j), (1+0j)]
    """
    products, aims = columns.conj().T @ columns, columns.conj().T @ force
    found = np.zeros(len(bounds), dtype=complex)
    for _ in range(SWEEPS):
        before = found.copy()
        for k, bound in enumerate(bounds):
            best = found[k] + (aims[k] - products[k] @ found) / products[k, k]
            found[k] = best * min(1.0, bound / abs(best)) if best else 0.0
        if np.max(np.abs(found - before)) <= SETTLED * np.max(np.abs(found)):
            return found
    raise InvalidInput(Problem("links", "their counterweights do much the same", "name fewer links"))


def fraction_moment(ways: PinDirections, fraction: float) -> tuple[str, complex]:
    """Return the crank of a slider-crank, with its classical counterweight's moment.

    All rotating mass is balanced, and a fraction of the reciprocating mass; the rod is replaced by two masses at its
    pins with its mass centre. Raises InvalidInput for other mechanisms.

    Source: e.g. R. L. Norton, Design of Machinery, 5th ed., McGraw-Hill 2012, section 13.7.
    """
    crank, rod, piston = _slider_crank(ways)
    mechanism, own = ways.motion.mechanism, dict.fromkeys((crank, rod, piston), (0.0, 0j))
    for name, one in mechanism.masses.items():
        own[name] = float(first_entry(one.mass)), complex(np.ravel(mass_centre_place(ways.motion, one))[0])
    (a, on_crank), (b, _) = (_pin_between(ways, rod, other) for other in (crank, piston))
    pivot = ways.reached[crank].pivot
    mass, centre = own[rod]
    part = (centre - a) / (b - a)
    at_pin = mass * (1.0 - part) + fraction * (mass * part + own[piston][0])
    return crank, -(own[crank][0] * (own[crank][1] - pivot) + (on_crank - pivot) * at_pin)


def _slider_crank(ways: PinDirections) -> tuple[str, str, str]:
    structure = ways.motion.structure
    slides = [pair for pair in structure.pairs if pair.is_simple and not pair.free_is_angle and FRAME in pair.members]
    pistons = [name for pair in slides for name in pair.members if name != FRAME]
    cranks = [name for name, one in ways.reached.items() if one.depth == 1]
    rods = [name for name in ways.motion.links if name not in (FRAME, *pistons, *cranks)]
    if not len(pistons) == len(cranks) == len(rods) == 1 or len(structure.pairs) != 4:
        remedy = "leave the fraction out: the shaking force over the motion is then minimised"
        raise InvalidInput(Problem("fraction", "only a slider-crank is balanced by a fraction", remedy))
    return cranks[0], rods[0], pistons[0]


def _pin_between(ways: PinDirections, link: str, other: str) -> tuple[complex, complex]:
    """Return where two links are pinned to each other, on each."""
    for pair in ways.motion.structure.pairs:
        if {link, other} == set(pair.members):
            ends = ways.motion.inputs.ends[pair.name]
            places = {name: complex(first_entry(end.point)) for name, end in zip(pair.members, ends, strict=True)}
            return places[link], places[other]
    raise InvalidInput(Problem("fraction", f"{link} and {other} are not joined", "leave the fraction out"))


@dataclass(frozen=True)
class BalanceFigure:
    """The greatest absolute value of a quantity, and its root mean square."""

    name: str
    unit: str
    greatest: float
    rms: float


@dataclass(frozen=True, eq=False, repr=False)
class InertiaForces(ShortRepr):
    """Inertia forces without weights and loads. The shaking moment is about the place `about`."""

    about: complex
    factor: float

    def force(self, motion: Motion) -> Number:
        """Return the shaking force."""
        return -self.factor * sum((mass.force for mass in mass_motions(motion)), 0j)

    def length(self, motion: Motion) -> Number:
        """Return the length of the shaking force."""
        return _shaped(motion, np.abs(self.force(motion)))

    def moment(self, motion: Motion) -> Number:
        """Return the shaking moment, drivers' reactions included."""
        total = -self.factor * sum(mass.moment for mass in mass_motions(motion))
        return _shaped(motion, total - cross(self.about, self.force(motion)))

    def effort(self, driver: str, motion: Motion) -> Number:
        """Return the effort of a driver, by virtual work."""
        rows = zip(mass_motions(motion), mass_motions(moved_alone(motion, driver)), strict=True)
        return _shaped(motion, self.factor * sum(mass.product(2, unit, 1) for mass, unit in rows))


def _shaped(motion: Motion, value: Number) -> Number:
    found: Number = np.broadcast_to(value, motion.failed.shape).reshape(motion.shape)
    return found


def balance_figures(motion: Motion, about: complex) -> tuple[BalanceFigure, ...]:
    """Return the figures of shaking force, shaking moment and each driver's effort, of a motion of one design."""
    measures = tuple(_measures(motion, about))
    designs, places, weights = nodes(smooth_pieces(motion))
    at = between(motion, designs, places, 2)
    found = []
    for one, ends in zip(measures, extremes(motion, *measures), strict=True):
        greatest = max(abs(float(ends.least.value[0])), abs(float(ends.greatest.value[0])))
        mean = float(np.sum(weights * one.of(at) ** 2) / np.sum(weights))
        found.append(BalanceFigure(one.name, one.unit, greatest, float(np.sqrt(mean))))
    return tuple(found)


def _measures(motion: Motion, about: complex) -> Iterator[Measure]:
    units = motion.mechanism.stated_units
    alone = InertiaForces(about, units.inertia)
    scale = float(np.nanmax(sum(np.abs(mass.force) for mass in mass_motions(motion)))) * units.inertia
    yield Measure("shaking force", units.force, 2, alone.length, squared=True, scale=scale)
    yield Measure("shaking moment", units.moment, 2, alone.moment, scale=scale * motion.size)
    for name, drive in motion.drives.items():
        size, unit = (motion.size, units.moment) if drive.is_angle else (1.0, units.force)
        yield Measure(f"effort {name}", unit, 2, partial(alone.effort, name), scale=scale * size)
