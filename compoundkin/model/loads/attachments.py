"""Where loads attach: along the coordinate of a pair, between points of two links, or to a pair."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, dot
from compoundkin.base.errors import InvalidMechanism, LikelySlip, Problem, suggestion, warn
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import link_key, spot_key, value_key
from compoundkin.model.geometry import FRAME, vector
from compoundkin.model.loads.amounts import Amount, as_amount, needs_rates, plain_amount, value_of
from compoundkin.model.loads.contract import COORDINATE, NO_RENAMING, ListedLoad, Load, LoadedPoses, NamedParts
from compoundkin.model.pairs.revolute import SEPARATORS

# The variables of functions of a load along a pair.
VARIABLES = (COORDINATE, "rate", "time")
FORWARD, BACK = "forward", "back"
# An effort as a function of a coordinate, its rate and the time.
PlainEffort = Callable[[float, float, float], float]


def rate_of(series: Series) -> Number:
    """Return the rate of a coordinate, zero for a motion without velocities."""
    return series.c[1] if len(series.c) > 1 else 0.0


def name_between(name: str, links: Mapping[str, str]) -> str:
    """Return the name of a pair at a multiple pin with its links renamed.

    >>> name_between("J(crank-rod)", {"crank": "frame"}), name_between("stroke", {})
    ('J(frame-rod)', 'stroke')
    """
    letter, _, inside = name.removesuffix(")").partition("(")
    for separator in SEPARATORS if inside else ():
        first, found, second = inside.partition(separator)
        if found and not links.keys().isdisjoint((first, second)):
            return f"{letter}({links.get(first, first)}{separator}{links.get(second, second)})"
    return name


def renamed_pair(name: str, links: Mapping[str, str], coordinates: Mapping[str, str]) -> str:
    """Return the name of a pair where links and coordinates have other names."""
    return name_between(coordinates.get(name, name), links)


@dataclass(frozen=True, eq=False, repr=False)
class PairLoad(Load):
    """A load along the free coordinate of a pair: on its second link, the opposite on the first."""

    pair: str = field(metadata=value_key("name", "The pair, by its name, a pin's letter or a driver of it."))
    members: tuple[str, ...] = field(default=(), kw_only=True)
    turns: bool = field(default=False, kw_only=True)  # whether the coordinate is an angle, known as the members are

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return f"{self.title} along {self.pair}"

    @property
    def links(self) -> tuple[str, ...]:
        """The two links of its pair, once the mechanism has completed it."""
        return self.members

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return the load along a pair of another name."""
        return replace(super().renamed(links, coordinates), pair=renamed_pair(self.pair, links, coordinates))

    def completed(self, written: NamedParts) -> Load:
        """Return the load with the links of its pair, and whether it turns."""
        pair = written.pair(self.pair)
        return self if pair is None else replace(self, members=pair.members[:2], turns=pair.free_is_angle)

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the coordinate and its rate."""
        series = at.coordinate(self.pair)
        return {COORDINATE: lambda: series.c[0], "rate": lambda: rate_of(series)}

    @abstractmethod
    def effort(self, at: LoadedPoses) -> Number:
        """Return the effort: positive where it drives the coordinate up."""

    def plain_effort(self) -> PlainEffort | None:
        """Return the effort as a function of plain numbers: coordinate, rate and time; None where it is asked of poses.

        It serves simulations, which ask at every state.
        """
        return None

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find an unknown pair, or one that takes no effort."""
        pair = written.pair(self.pair)
        if pair is None and (several := written.at_pin(self.pair)):
            what = f"the pin {self.pair!r} joins more than two links"
            yield Problem(f"{where}.pair", what, f"name two of them: {', '.join(several[:6])}")
        elif pair is None:
            what = f"there is no pair, pin or driver {self.pair!r}"
            yield Problem(f"{where}.pair", what, suggestion(self.pair, written.pairs))
        elif Effort.title not in pair.takes:
            what = f"{self.pair!r} is a {pair.title}: nothing acts along its coordinate"
            yield Problem(f"{where}.pair", what, "name a pin, a slide or a slot")

    def place_text(self, coordinate: float) -> str:
        """Return a value of its coordinate as text, angles in degrees."""
        return f"{np.rad2deg(coordinate):.6g}°" if self.turns else f"{coordinate:.6g}"

    def speed_at(self, at: LoadedPoses) -> Number:
        """Return the rate of its coordinate."""
        return rate_of(at.coordinate(self.pair))

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the effort on the second link, and its opposite on the first."""
        effort = self.effort(at)
        for link, unit in at.unit_effort(self.pair):
            yield link, unit.times(effort)


@dataclass(frozen=True, eq=False, repr=False)
class Effort(PairLoad):
    """An effort along the free coordinate of a pair: a thrust on a slide or along a slot, a torque at a pin.

    It acts on the pair's second link, the opposite on the
    first; ``"forward"`` and ``"back"`` are while the coordinate grows and while it shrinks.
    """

    amount: Amount = field(
        metadata=value_key("amount", "The thrust or torque, positive where it drives the coordinate up.")
    )
    only: str | None = field(
        default=None, metadata=value_key("name", 'Whether it acts only while the coordinate goes "forward" or "back".')
    )

    title: ClassVar[str] = "effort"
    table: ClassVar[str] = "efforts"
    amounts: ClassVar[tuple[str, ...]] = ("amount",)
    own_variable: ClassVar[str] = COORDINATE
    has_rate: ClassVar[bool] = True

    @property
    def needs_rates(self) -> bool:
        """Whether it depends on the rate of the coordinate."""
        return self.only is not None or needs_rates(self.amount)

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find an unknown pair or direction."""
        yield from super().problems(written, where)
        if self.only not in (None, FORWARD, BACK):
            yield Problem(f"{where}.only", f"{self.only!r} is no direction", suggestion(self.only, [FORWARD, BACK]))

    def effort(self, at: LoadedPoses) -> Number:
        """Return the thrust or torque."""
        own = self.variables(at)
        amount = value_of(self.where, self.amount, at, own)
        if self.only is None:
            return amount
        rate = own["rate"]() * (1.0 if self.only == FORWARD else -1.0)
        return np.where(rate > 0.0, amount, np.where(np.isnan(rate), np.nan, 0.0))

    def plain_effort(self) -> PlainEffort | None:
        """Return the thrust or torque as a function of plain numbers."""
        amount, way = plain_amount(self.where, self.amount, VARIABLES), 1.0 if self.only == FORWARD else -1.0
        if amount is None or self.only is None:
            return amount
        return lambda q, w, t: amount(q, w, t) if w * way > 0.0 else 0.0 * w


@checked
def effort(pair: str, amount: Any, *, only: str | None = None, name: str = "") -> Effort:
    """Return an effort along the free coordinate of a pair.

    It is a thrust on a slide or along a slot, such as that of gas, or a torque at a pin.

    The pair is meant by its name, by a pin's letter (``J(crank-rod)`` for two links of a multiple pin), or by a driver.
    It acts on the pair's second link, its opposite on the first, and is positive where it drives the coordinate up:
    that of ``motion.pairs[pair]``, or of the driver. `amount` is a number, an array whose last axis is the motion, a
    function of coordinate ``q``, rate ``w``, time ``t``, as its arguments name them, or a table as of `force`, over the
    coordinate where it does not say what it is over, or over its ``"rate"`` in rad/s or lengths a second. It acts
    ``only="forward"`` while the coordinate grows, ``"back"`` while it shrinks.

    >>> effort("stroke", lambda s: -400.0 / (0.1 + s)).name
    'effort along stroke'
    """
    return Effort(pair, as_amount(f"efforts.{name or pair}.amount", amount, *VARIABLES), only, name=name)


class EndSeparation(NamedTuple):
    """The vector from the first end to the second, its length, and the relative velocity of the second end."""

    vector: Number
    length: Number
    velocity: Number

    @property
    def rate(self) -> Number:
        """The rate of its length; ends that coincide move apart with their whole speed."""
        with np.errstate(all="ignore"):
            along = dot(self.vector, self.velocity) / self.length
        return np.where(self.length == 0.0, np.abs(self.velocity), along)

    def along(self, pull: Number, where: str) -> Number:
        """Return a pull as a vector. Warns, naming `where`, if ends coincide, where it has no direction."""
        length, vector = self.length, self.vector
        meeting = (length == 0.0) & (pull != 0.0)
        # what is recorded is of no pose yet
        if isinstance(meeting, np.ndarray | np.bool_ | bool) and np.any(meeting):
            warn(f"{where}: its ends coincide, where its force has no direction", LikelySlip)
        with np.errstate(all="ignore"):
            return np.where(length == 0.0, np.where(meeting, np.nan, 0.0), pull * vector / length)


@dataclass(frozen=True, eq=False, repr=False)
class PointToPointLoad(Load):
    """A load along the line from the point `point` of `link` to the point `at` of the link `to`."""

    link: str = field(metadata=link_key("The link that one end is fixed to."))
    point: Any = field(metadata=spot_key("link", "Its end there: a point, or a place in the link's frame."))
    to: str = field(default=FRAME, kw_only=True, metadata=link_key("The link that the other end is fixed to."))
    at: Any = field(
        default="", kw_only=True, metadata=spot_key("to", "Its end there: a point, or a place in the link's frame.")
    )

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return f"{self.title} on {self.link}"

    def gap(self, at: LoadedPoses) -> EndSeparation:
        """Return the separation of its ends."""
        between = at.place(self.to, self.at) - at.place(self.link, self.point)
        return EndSeparation(between.c[0], abs(between.c[0]), velocity_of(between))

    def speed_at(self, at: LoadedPoses) -> Number:
        """Return the speed at which its ends move apart."""
        return self.gap(at).rate

    def attack(self, link: str) -> str | Number:
        """Return its end on a link."""
        return self.point if link == self.link else self.at

    @abstractmethod
    def pull(self, gap: EndSeparation, at: LoadedPoses) -> Number:
        """Return the force on its first end, a vector."""

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the force on both links."""
        gap = self.gap(at)
        pull = self.pull(gap, at)
        pulled = Wrench.at(at.place(self.link, self.point).c[0], pull)
        yield self.link, pulled
        yield self.to, -pulled


def velocity_of(series: Series) -> Number:
    """Return the velocity of a place, zero for a motion without velocities."""
    return series.c[1] if len(series.c) > 1 else 0j


def attachment_point(where: str, given: Any) -> Number | str:
    """Return a letter as it is, a place as a vector. Raises InvalidMechanism naming `where`.

    >>> attachment_point("springs.arm.at", "S"), attachment_point("springs.arm.at", (1, 2))
    ('S', (1+2j))
    """
    return given if isinstance(given, str) else vector(where, given)


def check_ends(where: str, pair: str, link: str, beside: Mapping[str, Any]) -> None:
    """Raise InvalidMechanism for missing ends, and for arguments `beside` that belong to the other sort of ends.

    >>> check_ends("springs.arm", "C", "", {"point": "A"})
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidMechanism: springs.arm.point: it is along the pair 'C'; leave point out
    """
    superfluous = [
        key for key, value in beside.items() if not (isinstance(value, str | int | float) and value in ("", 0))
    ]
    if not pair and not link:
        raise InvalidMechanism(Problem(where, "it has no ends", 'name a link and a point, or write pair="C"'))
    if superfluous:
        what = f"it is along the pair {pair!r}" if pair else "it is between points, which have no coordinate"
        raise InvalidMechanism(Problem(f"{where}.{superfluous[0]}", what, f"leave {', '.join(superfluous)} out"))


@dataclass(frozen=True, eq=False, repr=False)
class PairProperty(ListedLoad):
    """A property of a pair beside its dimensions, under the pair's name."""

    pair: str

    @property
    def name(self) -> str:
        """The name of its pair."""
        return self.pair

    @property
    def property_of(self) -> str:
        """Its pair."""
        return self.pair

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return the property of a pair of another name."""
        return replace(self, pair=renamed_pair(self.pair, links, coordinates))

    def unknown(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Report that there is no such pair."""
        yield Problem(f"{where}.pair", f"there is no pair {self.pair!r}", suggestion(self.pair, written.pairs))
