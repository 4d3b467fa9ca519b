"""What every load answers: on which links which wrenches act; each kind of load lives in one file of this folder."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

from compoundkin.base.errors import Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import DeclaredKeys, NameWording, link_fields, name_problems, value_key
from compoundkin.model.pairs.contract import Ends, Pair
from compoundkin.model.units import Units


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

    def pair(self, name: str) -> tuple[Pair, Ends]:
        """Return a pair by its name, and its sides on its links."""

    def coordinate(self, pair: str) -> Series:
        """Return the free coordinate of a pair, angles counted along the motion."""

    def fitted(self, value: Any) -> Number:
        """Return what of a number or an array belongs to these poses."""


@dataclass(frozen=True, eq=False)
class Load(ABC):
    """What acts on links from outside: forces, torques, efforts, springs, dampers. Kinds are frozen dataclasses."""

    name: str = field(
        default="",
        kw_only=True,
        metadata=value_key("name", "What the load is called in reports; the kind and its link where it is left out."),
    )

    title: ClassVar[str]  # "spring"
    table: ClassVar[str]  # its table in a mechanism file
    wording: ClassVar[NameWording] = NameWording(verb="act")
    keys = DeclaredKeys()  # the keys of its table in a mechanism file, by its fields

    def __post_init__(self) -> None:
        """A load that is given no name has that of its kind and its first link."""
        if not self.name:
            object.__setattr__(self, "name", self.called)

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return f"{self.title} on {next(getattr(self, name) for name in link_fields(type(self)))}"

    @property
    def link_keys(self) -> tuple[str, ...]:
        """The fields that name links."""
        return link_fields(type(self))

    @property
    @abstractmethod
    def links(self) -> tuple[str, ...]:
        """The links it acts on."""

    def attack(self, link: str) -> str | Number | None:
        """Return the point of a link at which it acts. It is a letter or a place in the link, None for a couple."""
        return None

    def problems(
        self, links: Mapping[str, tuple[str, ...]], pairs: Mapping[str, Pair], where: str
    ) -> Iterator[Problem]:
        """Find what is wrong with it as written. `links` maps each link to its points, `pairs` are by name."""
        yield from name_problems(self, links, where, self.wording)

    @abstractmethod
    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the links it acts on with their wrenches, in the mechanism's units."""
