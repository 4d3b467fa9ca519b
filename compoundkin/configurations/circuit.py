"""Circuits, their branches and limit positions: what `circuits` finds."""

from __future__ import annotations

from dataclasses import dataclass, field

from compoundkin.configurations.segments import Visit
from compoundkin.kinematics.configuration import Configuration


@dataclass(frozen=True, eq=False)
class Limit:
    """A limit position (driver dead point). There the driver turns back, for a group comes to the end of its reach.

    `value` is the driver's (radians between -pi and pi, or a length), `greatest` whether the driver comes from lesser
    values. `group` is the index of the group responsible, `links` are its links. Of `branches` that meet there the
    numbers are told.
    """

    value: float
    greatest: bool
    group: int
    links: tuple[str, ...]
    configuration: Configuration
    circuit: int
    branches: tuple[int, int]


@dataclass(frozen=True, eq=False)
class ChangePoint:
    """A place where two modes of a group meet. The motion goes on, from there in either of them."""

    value: float
    group: int
    links: tuple[str, ...]
    configuration: Configuration
    circuit: int
    branch: int


@dataclass(frozen=True, eq=False)
class Branch:
    """A part of a circuit between turning points of the driver. It has one configuration for each driver value.

    `low` and `high` bound the driver's value; of a branch that turns fully they are one or more full turns apart.
    `ends` are the limit positions at both, None where the branch ends otherwise, which `open_ends` tell: at the end of
    the range, of a guide, at infinity; or, for a full turn, not at all. `configuration` is that in the middle.
    """

    number: int
    circuit: int
    low: float
    high: float
    ends: tuple[Limit | None, Limit | None]
    open_ends: tuple[str, ...]
    configuration: Configuration
    visits: tuple[Visit, ...] = field(repr=False)
    shift: float = field(repr=False)

    @property
    def name(self) -> str:
        """The name of its configuration in the middle."""
        return self.configuration.name


@dataclass(frozen=True, eq=False)
class Circuit:
    """Configurations that the mechanism reaches from one another without disassembly, moved by one driver.

    `low` and `high` bound the driver's value over all branches. `winding` is by how many full turns the driver advances
    around the circuit, 0 where it turns back or is a slide; `closed` whether the circuit leads back to its start, which
    it does not at an end of a range.
    """

    number: int
    branches: tuple[Branch, ...]
    limits: tuple[Limit, ...]
    changes: tuple[ChangePoint, ...]
    low: float
    high: float
    winding: int
    closed: bool

    @property
    def turns_fully(self) -> bool:
        """Whether the driver may turn on and on."""
        return self.winding != 0


@dataclass(frozen=True)
class CircuitPlace:
    """The place of a configuration. It has the numbers of its circuit and branch, and the driver's value."""

    circuit: int
    branch: int
    value: float
    visit: Visit = field(repr=False)
    inside: float = field(repr=False)


@dataclass(frozen=True, eq=False)
class Toggle:
    """A toggle position. There a link on the frame stands still and turns back while the driver goes on."""

    value: float
    link: str
    pair: str
    configuration: Configuration
    circuit: int
    branch: int
