"""The records of a share string: joints, links, forces and settings, as they stand in it."""

from __future__ import annotations

from dataclasses import dataclass, field

# By the digit of the length unit: the units of length, mass and force that the program counts in.
UNITS = (("in", "lb", "lbf"), ("cm", "g", "N"), ("m", "kg", "N"))
# How many units of mass times length squared its unit of inertia is: lb in^2, kg cm^2, kg m^2.
INERTIA_UNITS = (1.0, 1000.0, 1.0)
# In m/s^2, what the program takes gravity for.
GRAVITY = 9.81


@dataclass(frozen=True)
class SharedJoint:
    """A pin, or the sliding joint of a block. `slot` is its carrier and the two joints of its line."""

    id: str
    name: str
    at: complex
    angle: float = 0.0
    slides: bool = False
    is_input: bool = False
    is_grounded: bool = False
    is_welded: bool = False
    has_curve: bool = False
    is_sealed: bool = False
    slot: tuple[str, str, str] | None = None
    speed: float = 0.0

    @property
    def where(self) -> str:
        """What to call it where something is wrong."""
        return f"joint {self.id}"


@dataclass(frozen=True)
class SharedLink:
    """A link: its joints by their ids. A block has a pin and a sliding joint; parts of welded links are no roots."""

    id: str
    name: str
    joints: tuple[str, ...]
    is_block: bool = False
    is_root: bool = True
    mass: float = 0.0
    inertia: float = 0.0
    centre: complex = 0j
    parts: tuple[str, ...] = ()
    has_colour: bool = True
    flag: str = "Y"

    @property
    def where(self) -> str:
        """What to call it where something is wrong."""
        return f"link {self.id}"


@dataclass(frozen=True)
class SharedForce:
    """A force of a size at its start, toward its end. Where it points in, away from there."""

    id: str
    link: str
    name: str
    start: complex
    end: complex
    size: float
    turns: bool
    points_out: bool = True

    @property
    def where(self) -> str:
        """What to call it where something is wrong."""
        return f"force {self.id}"


@dataclass(frozen=True)
class SharedSettings:
    """What holds for the whole: speeds, units, gravity. Linear speeds are in units of length a second."""

    clockwise: bool = False
    has_gravity: bool = False
    mark_size: float = 1.0
    linear_speed: float | None = None
    rpm: float = 0.0
    length: int = 1

    @property
    def unit(self) -> str:
        """The unit of length."""
        return UNITS[self.length][0]


@dataclass(frozen=True)
class SharedMechanism:
    """All records of a share string. `dropped` counts what of it is not read."""

    settings: SharedSettings
    joints: tuple[SharedJoint, ...]
    links: tuple[SharedLink, ...]
    forces: tuple[SharedForce, ...] = ()
    dropped: dict[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
