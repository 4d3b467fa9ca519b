"""What every load answers: on which links which wrenches act; each kind of load lives in one file of this folder."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
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
from compoundkin.model.fields import DeclaredKeys, NameWording, implied_points, link_fields, name_problems, value_key
from compoundkin.model.pairs.contract import Pair
from compoundkin.model.units import Units

NO_RENAMING: Mapping[str, str] = MappingProxyType({})


class LoadedPoses(Protocol):
    """What loads are asked at: some designs x some poses with their velocities. All arrays are (designs, poses)."""

    @property
    def units(self) -> Units:
        """The mechanism's units: what loads return is in them."""

    @property
    def time(self) -> Number | None:
        """The times in seconds, None for a motion that is not in time."""

    def pose(self, link: str) -> Pose:
        """Return the pose of a link, with its first derivative at least."""

    def place(self, link: str, point: str | complex) -> Series:
        """Return where a point of a link is. By its letter or its place in the link."""

    def coordinate(self, name: str) -> Series:
        """Return the free coordinate of a pair or a driver. Angles are counted along the motion."""

    def unit_effort(self, name: str) -> Iterator[tuple[str, Wrench]]:
        """Yield the links of a pair with the wrenches of a unit effort.

        It is along the coordinate, on the second link; its opposite is on the first.
        """

    def fitted(self, value: Any, where: str = ...) -> Number:
        """Return what of a value belongs to these poses. `where` names it in errors."""


class NamedParts(Protocol):
    """What is written of links and pairs, for loads that name them."""

    @property
    def letters(self) -> Mapping[str, tuple[str, ...]]:
        """The points of each link."""

    @property
    def carriers(self) -> Mapping[str, tuple[str, ...]]:
        """The links that carry each point."""

    @property
    def pairs(self) -> list[str]:
        """The names by which pairs may be meant."""

    def at_pin(self, letter: str) -> list[str]:
        """Return the names of the pairs at a multiple pin."""

    def pair(self, name: str) -> Pair | None:
        """Return the pair that a name means, or None."""

    def coordinate(self, name: str) -> Pair | None:
        """Return the pair of which a name means the coordinate, or None."""


def with_names(amount: Any, coordinates: Mapping[str, str]) -> Any:
    """Return an amount whose tables are over coordinates of other names."""
    if isinstance(amount, tuple):
        return tuple(with_names(part, coordinates) for part in amount)
    over = str(getattr(amount, "over", ""))
    return replace(amount, over=coordinates[over]) if over in coordinates else amount


@dataclass(frozen=True, eq=False, repr=False)
class Load(ShortRepr, ABC):
    """What acts on links from outside: forces, torques, efforts, springs, dampers. Kinds are frozen dataclasses."""

    name: str = field(
        default="",
        kw_only=True,
        metadata=value_key("name", "What the load is called in reports; its kind and what it acts on if left out."),
    )

    title: ClassVar[str]  # "spring"
    table: ClassVar[str]  # its table in a mechanism file
    wording: ClassVar[NameWording] = NameWording(verb="act")
    keys = DeclaredKeys()  # the keys of its table in a mechanism file, by its fields
    amounts: ClassVar[tuple[str, ...]] = ()  # the fields that hold amounts
    own_variable: ClassVar[str] = TIME  # what their tables are over that do not say it

    def __post_init__(self) -> None:
        """A load that is given no name is called after what it acts on."""
        if not self.name:
            object.__setattr__(self, "name", self.called)

    @property
    @abstractmethod
    def called(self) -> str:
        """Its name where none is given."""

    @property
    def where(self) -> str:
        """Its place in errors."""
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
    def needs_rates(self) -> bool:
        """Whether it asks for velocities."""
        return False

    @property
    def pin(self) -> str:
        """The letter of the pin that it acts on itself. It is empty where it acts on a link."""
        return ""

    def attack(self, link: str) -> str | Number | None:
        """Return the point of a link at which it acts. It is a letter or a place in the link, None for a couple."""
        return None

    def completed(self, written: NamedParts) -> Load:
        """Return the load with what its words leave open; itself without any."""
        found = implied_points(self, written.letters)
        return replace(self, **found) if found else self

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return it on links and over coordinates of other names. Its own name stays."""
        told = {key: links.get(getattr(self, key), getattr(self, key)) for key in self.link_keys}
        held = {key: with_names(getattr(self, key), coordinates) for key in self.amounts if coordinates}
        return replace(self, **told, **held)

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find what is wrong with it as written."""
        yield from name_problems(self, written.letters, where, self.wording)

    @abstractmethod
    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the links it acts on with their wrenches, in the mechanism's units."""

    def energy(self, at: LoadedPoses) -> Number | None:
        """Return its potential energy, None for a load that has none."""
        return None
