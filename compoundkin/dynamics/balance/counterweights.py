"""Counterweights that balance the shaking force of a mechanism, wholly or as well as can be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import ShortRepr, count_phrase
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.dynamics.balance.balance_figures import BalanceFigure, balance_figures
from compoundkin.dynamics.balance.counterweight_masses import Counterweight, CounterweightSizes, with_counterweights
from compoundkin.dynamics.balance.force_balance import BALANCED, BalanceConditions
from compoundkin.dynamics.balance.partial_balance import ShakingSamples, fraction_moment
from compoundkin.dynamics.balance.pin_ways import PinWays, pin_ways
from compoundkin.dynamics.work.mass_motion import units_of_masses
from compoundkin.kinematics.extremes import closed_cycles
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.geometry import FRAME, vector
from compoundkin.model.mechanism import Mechanism


@dataclass(frozen=True, eq=False, repr=False)
class ForceBalance(ShortRepr):
    """A mechanism with counterweights, and what they change.

    `is_full` tells whether its shaking force is zero at every pose. Where that cannot be, `unreached` are the links
    with mass that no way of pins joins to the frame. `before` and `after` are of masses alone, without weights and
    loads; the shaking moment is about the place `about`.
    """

    mechanism: Mechanism
    counterweights: tuple[Counterweight, ...]
    is_full: bool
    unreached: tuple[str, ...]
    about: complex
    before: tuple[BalanceFigure, ...]
    after: tuple[BalanceFigure, ...]

    def text(self) -> str:
        """Return it as text: the counterweights, and a table of before and after."""
        return "\n".join((self._headline, *(one.text(self.mechanism) for one in self.counterweights), *self._rows()))

    @property
    def _headline(self) -> str:
        if self.is_full:
            return f"Full force balance by {count_phrase(len(self.counterweights), 'counterweight')}."
        if not self.unreached:
            return f"Partial force balance by {count_phrase(len(self.counterweights), 'counterweight')}."
        links = ", ".join(self.unreached)
        why = f"no way of pins alone leads from {links} to the frame"
        best = "The best there is:" if self.counterweights else "No link that turns is pinned to the frame."
        return f"Full force balance by counterweights does not exist: {why}. {best}"

    def _rows(self) -> tuple[str, ...]:
        about = f"({self.about.real:.6g}, {self.about.imag:.6g})"
        head = f"{'masses alone, moment about ' + about:<44}{'before':>14}{'after':>14}"
        rows = [head]
        for old, new in zip(self.before, self.after, strict=True):
            for word, a, b in (("greatest", old.greatest, new.greatest), ("rms", old.rms, new.rms)):
                rest = b if b > BALANCED * a else 0.0
                rows.append(f"{f'{old.name}, {word} [{old.unit}]':<44}{a:>14.6g}{rest:>14.6g}")
        return tuple(rows)

    def __repr__(self) -> str:
        kind = "full" if self.is_full else "partial"
        return f"ForceBalance({kind}, {count_phrase(len(self.counterweights), 'counterweight')}: {self.mechanism!r})"


@checked
def counterweights(
    what: Motion | Mechanism,
    links: str | Sequence[str] = (),
    *,
    mass: Any = None,
    radius: Any = None,
    disc: Any = 0.0,
    fraction: float | None = None,
    about: Any = None,
) -> ForceBalance:
    """Return the mechanism with counterweights that balance its shaking force.

    Full force balance by linearly independent vectors: the mass centre of all links rests. `links` take counterweights;
    without, those pinned to the frame and as many others as it takes. Each has a `mass` or a `radius` from its link's
    pin (a number for all or a mapping by link), else it is as far away as the link is long; it is a point, or a disc
    with the radius `disc`. Where full balance does not exist, or other links are named, the squared shaking force over
    the motion is least; a slider-crank's crank may balance a `fraction` of what goes to and fro instead.

    A mechanism is solved over its own motion, which should be a closed cycle. Figures before and after are of masses
    alone, the shaking moment `about` a letter or a place of the frame: moment and drivers' torque usually rise. Raises
    InvalidInput for several designs and for masses that are no single numbers, UnknownName for what is no such link.

    Source: R. S. Berkof and G. G. Lowen, J. Engineering for Industry 91, 1969, 21-26; where it does not exist, F. R.
    Tepper and G. G. Lowen, J. Engineering for Industry 94, 1972, 789-796.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads import mass as of
    >>> parts = link("frame", A=0), link("arm", A=0, B=2), drive("arm"), of("arm", 3.0, at="B")
    >>> arm = Mechanism("Arm", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> found = counterweights(arm, mass=6.0)
    >>> found.is_full, found.counterweights[0].at, found.mechanism.masses["arm"].mass
    (True, (-1+0j), 9.0)
    """
    motion = solve(what) if isinstance(what, Mechanism) else what
    _hold(motion)
    place, ways = _place(motion, about), pin_ways(motion)
    conditions = BalanceConditions(ways, bool(closed_cycles(motion)[0]))
    if fraction is None:
        moments = _moments(conditions, _links(ways, links), CounterweightSizes(ways, mass, radius, disc))
    else:
        crank, moment = fraction_moment(ways, fraction)
        sizes = CounterweightSizes(ways, mass, radius, disc)
        moments = tuple(sizes.made((crank,), [moment]))
    balanced = with_counterweights(motion, moments)
    after = replace(motion, structure=replace(motion.structure, mechanism=balanced))
    known = BalanceConditions(pin_ways(after), bool(closed_cycles(motion)[0]))
    is_full = not known.unreached and known.moments((), {})[1] <= BALANCED
    figures = [balance_figures(moved, place) for moved in (motion, after)]
    return ForceBalance(balanced, moments, is_full, conditions.unreached, place, *figures)


def _moments(
    conditions: BalanceConditions, links: tuple[str, ...], sizes: CounterweightSizes
) -> tuple[Counterweight, ...]:
    """Return the counterweights of full balance, or of the least shaking force where these do not exist."""
    if not conditions.unreached:
        chosen = links or conditions.chosen()
        found, rest = sizes.settled(conditions, chosen)
        if rest <= BALANCED:
            return found
    chosen = links or conditions.pinned
    return sizes.settled(ShakingSamples(conditions.ways), chosen)[0]


def _hold(motion: Motion) -> None:
    """Raise InvalidInput for what has no single numbers, or no accelerations."""
    units_of_masses(motion)
    if motion.inputs.designs != 1 or not motion.inputs.is_rigid:
        raise InvalidInput(Problem("motion", "only one design is balanced at a time", "solve that design by itself"))
    for mass in motion.mechanism.masses.values():
        if any(np.size(value) != 1 for value in (mass.mass, mass.inertia) if value is not None):
            raise InvalidInput(Problem(f"masses.{mass.link}", "it is not a single number", "give each link one mass"))
    if motion.inputs.poses < 2 or np.any(motion.failed):
        remedy = "solve a range throughout which it closes, best a full turn"
        raise InvalidInput(Problem("motion", "a motion that is assembled throughout is wanted", remedy))
    if motion.order < 2:
        raise InvalidInput(Problem("motion", f"the motion was solved to order {motion.order}", "solve(..., order=2)"))


def _links(ways: PinWays, links: str | Sequence[str]) -> tuple[str, ...]:
    names = (links,) if isinstance(links, str) else tuple(links)
    known = [name for name in ways.reached if name != FRAME]
    for name in names:
        if name not in ways.motion.links or name == FRAME:
            raise UnknownName(Problem("links", f"there is no moving link {name!r}", suggestion(str(name), known)))
        if name not in known:
            remedy = f"known: {', '.join(known)}"
            raise InvalidInput(Problem("links", f"no way of pins leads from {name} to the frame", remedy))
    return tuple(dict.fromkeys(names))


def _place(motion: Motion, about: Any) -> complex:
    """Return the place of the world about which moments are taken: without one, the first driver's on the frame."""
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
