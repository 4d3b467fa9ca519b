"""What every load answers: on which links which wrenches act; each kind of load lives in one file of this folder."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, ClassVar, Protocol, Self

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import TIME
from compoundkin.model.fields import (
    DeclaredKeys,
    Item,
    NameWording,
    implied_points,
    link_fields,
    name_problems,
    value_key,
)
from compoundkin.model.pairs.contract import Pair
from compoundkin.model.units import Units

# The variable of loads along a pair.
COORDINATE = "coordinate"
# What tables of loads that know a rate of their own are over: that of an effort's coordinate, of a torque's link.
RATE = "rate"
NO_RENAMING: Mapping[str, str] = MappingProxyType({})


class LoadedPoses(Protocol):
    """The poses at which loads are evaluated, with their velocities. All arrays are (designs, poses)."""

    @property
    def units(self) -> Units:
        """The mechanism's units, in which loads return wrenches."""

    @property
    def time(self) -> Number | None:
        """The times in seconds, None for a motion that is not in time."""

    def pose(self, link: str) -> Pose:
        """Return the pose of a link, with its first derivative at least."""

    def place(self, link: str, point: str | complex) -> Series:
        """Return the place of a link's point, given by its letter or its place in the link."""

    def coordinate(self, name: str) -> Series:
        """Return the free coordinate of a pair or a driver. Angles are counted along the motion."""

    def unit_effort(self, name: str) -> Iterator[tuple[str, Wrench]]:
        """Yield the two links of a pair with the wrenches of a unit effort on the second and its opposite."""

    def fitted(self, value: Any, where: str = ...) -> Number:
        """Return the entries of a value at these poses. `where` names it in errors."""


class NamedParts(Protocol):
    """The names of links, points and pairs, for loads that refer to them."""

    @property
    def letters(self) -> Mapping[str, tuple[str, ...]]:
        """The points of each link."""

    @property
    def carriers(self) -> Mapping[str, tuple[str, ...]]:
        """The links that carry each point."""

    @property
    def pairs(self) -> list[str]:
        """The names of pairs."""

    def at_pin(self, letter: str) -> list[str]:
        """Return the names of the pairs at a multiple pin."""

    def pair(self, name: str) -> Pair | None:
        """Return the pair of a name, or None."""

    def coordinate(self, name: str) -> Pair | None:
        """Return the pair whose coordinate a name refers to, or None."""


def with_names(amount: Any, coordinates: Mapping[str, str]) -> Any:
    """Return an amount whose tables are over coordinates of other names."""
    if isinstance(amount, tuple):
        return tuple(with_names(part, coordinates) for part in amount)
    over = str(getattr(amount, "over", ""))
    return replace(amount, over=coordinates[over]) if over in coordinates else amount


class LoadElement(ShortRepr, Item):
    """What is written of masses and forces, gravity among them."""

    __slots__ = ()


class ListedLoad(LoadElement, ABC):
    """A mass, a load or a property of a pair that forces need: one of a table of such in a mechanism file."""

    __slots__ = ()

    title: ClassVar[str]  # "spring"
    table: ClassVar[str]  # its table in a mechanism file
    keys = DeclaredKeys()  # the keys of its table in a mechanism file, by its fields
    amounts: ClassVar[tuple[str, ...]] = ()  # the fields that hold amounts
    is_steady: ClassVar[bool] = False  # whether its numbers cannot change along a motion

    @property
    @abstractmethod
    def name(self) -> str:
        """Its name: one of its own, or that of its link or pair."""

    @property
    def property_of(self) -> str:
        """The pair of which it is a property, and which has one such; empty for what has a name of its own."""
        return ""

    @abstractmethod
    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find problems of its definition."""

    @abstractmethod
    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return it with other names of links and coordinates. Its own name stays."""


@dataclass(frozen=True, eq=False, repr=False)
class Load(ListedLoad):
    """A load on links: a force, torque, effort, spring or damper. Kinds are frozen dataclasses."""

    name: str = field(
        default="",
        kw_only=True,
        metadata=value_key("name", "What the load is called in reports; its kind and what it acts on if left out."),
    )

    wording: ClassVar[NameWording] = NameWording(verb="act")
    own_variable: ClassVar[str] = TIME  # the default variable of their tables
    has_rate: ClassVar[bool] = False  # whether their tables may be over a rate of its own

    def __post_init__(self) -> None:
        """A load without a name is named after what it acts on."""
        if not self.name:
            object.__setattr__(self, "name", self.called)

    @property
    @abstractmethod
    def called(self) -> str:
        """Its default name."""

    @property
    def where(self) -> str:
        """The name of its place in errors."""
        return f"{self.table}.{self.name}"

    @property
    def link_keys(self) -> tuple[str, ...]:
        """The fields that name links."""
        return link_fields(type(self))

    @property
    def links(self) -> tuple[str, ...]:
        """The links it acts on."""
        return tuple(getattr(self, key) for key in link_fields(type(self)))

    @property
    def amounts_held(self) -> tuple[Any, ...]:
        """Its amounts: numbers, functions, tables."""
        return tuple(getattr(self, key) for key in self.amounts)

    @property
    def needs_rates(self) -> bool:
        """Whether it depends on velocities."""
        return False

    @property
    def pin(self) -> str:
        """The letter of the pin that it acts on; empty where it acts on a link."""
        return ""

    def attack(self, link: str) -> str | Number | None:
        """Return its point on a link, a letter or a place; None for a couple."""
        return None

    def completed(self, written: NamedParts) -> Load:
        """Return the load with omitted points filled in; itself where there are none."""
        found = implied_points(self, written.letters)
        return replace(self, **found) if found else self

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return the load with other names of links and coordinates. Its own name stays."""
        fields = {key: links.get(getattr(self, key), getattr(self, key)) for key in self.link_keys}
        amounts = {key: with_names(getattr(self, key), coordinates) for key in self.amounts if coordinates}
        return replace(self, **fields, **amounts)

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find problems of its definition."""
        yield from name_problems(self, written.letters, where, self.wording)

    @abstractmethod
    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the links it acts on, with the wrenches in the mechanism's units."""

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the variables of its amounts but the time, by their names; tables are over the first."""
        return {}

    def rotor(self) -> tuple[str, Number] | None:
        """Return the link that its rotor moves with, and the inertia that the link feels; None without an inertia."""
        return None

    def speed_at(self, at: LoadedPoses) -> Number | None:
        """Return the speed on which it may depend, None where it depends on none."""
        return None

    def energy(self, at: LoadedPoses) -> Number | None:
        """Return its potential energy, None for a load that has none."""
        return None
