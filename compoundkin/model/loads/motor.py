"""Motors: torque over speed of direct current and induction motors, tables and servos, behind a gear."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.model.fields import value_key
from compoundkin.model.geometry import real
from compoundkin.model.loads.amounts import Amount, as_amount, plain_amount, value_of
from compoundkin.model.loads.attachments import PairLoad, PlainEffort, rate_of
from compoundkin.model.loads.contract import COORDINATE, Load, LoadedPoses, NamedParts

# What says which motor it is, with what belongs to it.
SORTS = {
    "direct current": ("stall", "no_load"),
    "induction": ("breakdown", "synchronous", "slip"),
    "table": ("torque",),
    "servo": ("speed", "gain"),
}

TURNED = "give one above 0; a negative gear turns the motor round"


def _key(doc: str) -> dict[str, Any]:
    return value_key("length", doc)


class PlainRotor(NamedTuple):
    """A motor in plain numbers: its torque by coordinate, rate and time, its gear, and what its rotor takes.

    That is `inertia` for a unit of the coordinate's acceleration, before the gear.
    """

    torque: PlainEffort
    gear: float
    efficiency: float
    inertia: float

    def part(self, passed: float, rate: float) -> float:
        """Return the part of a torque that goes through the gear, at a rate of the coordinate."""
        return self.efficiency if passed * rate * self.gear >= 0.0 else 1.0 / self.efficiency


@dataclass(frozen=True, eq=False, repr=False)
class Motor(PairLoad):
    """A motor along the coordinate of a pair, on its second link from its first, behind a gear.

    Its shaft turns `gear` times as fast as the coordinate; what it gives is `gear` times its torque, times the
    `efficiency` of the gear while it drives, over it while it is driven. The `inertia` of its rotor moves with it,
    before the gear: what the rotor takes loses nothing there.
    """

    stall: Number | None = field(default=None, kw_only=True, metadata=_key("Direct current: the torque at rest."))
    no_load: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("rate", "Direct current: the speed at which its torque is zero, rad/s."),
    )
    breakdown: Number | None = field(
        default=None, kw_only=True, metadata=_key("Induction: the greatest torque that it gives.")
    )
    synchronous: Number | None = field(
        default=None, kw_only=True, metadata=value_key("rate", "Induction: the speed of its field, rad/s.")
    )
    slip: Number | None = field(
        default=None, kw_only=True, metadata=_key("Induction: the slip at its greatest torque, above 0 up to 1.")
    )
    torque: Amount | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("amount", "A table of its torque over its speed in rad/s, or a number."),
    )
    speed: Amount | None = field(
        default=None, kw_only=True, metadata=value_key("amount", "Servo: the speed that it keeps, rad/s.")
    )
    gain: Number | None = field(
        default=None, kw_only=True, metadata=_key("Servo: the torque for each rad/s that its speed is off.")
    )
    limit: Number | None = field(default=None, kw_only=True, metadata=_key("The greatest torque that it may give."))
    power: Number | None = field(
        default=None, kw_only=True, metadata=_key("The greatest power, force times length a second.")
    )
    gear: Number = field(
        default=1.0, kw_only=True, metadata=_key("Its speed over the rate of the coordinate; negative turns it round.")
    )
    efficiency: Number = field(default=1.0, kw_only=True, metadata=_key("The efficiency of the gear, up to 1."))
    inertia: Number = field(
        default=0.0, kw_only=True, metadata=_key("The inertia of its rotor, mass times length squared.")
    )

    title: ClassVar[str] = "motor"
    table: ClassVar[str] = "motors"
    amounts: ClassVar[tuple[str, ...]] = ("torque", "speed")
    own_variable: ClassVar[str] = "rate"
    turning: ClassVar[tuple[str, ...]] = ("no_load", "synchronous")  # speeds of a shaft, whatever the pair is

    @property
    def sort(self) -> str:
        """Which motor it is: direct current, induction, table or servo; empty where nothing says so."""
        return next((sort for sort, keys in SORTS.items() if getattr(self, keys[0]) is not None), "")

    @property
    def amounts_held(self) -> tuple[Any, ...]:
        """Its table or function, and the speed of a servo."""
        return tuple(one for one in (self.torque, self.speed) if one is not None)

    @property
    def needs_rates(self) -> bool:
        """Whether it depends on the rate of the coordinate: every motor does."""
        return True

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find an unknown pair, motors of no sort or of two, and numbers that no motor has."""
        yield from super().problems(written, where)
        given = [key for keys in SORTS.values() for key in keys if getattr(self, key) is not None]
        own = SORTS.get(self.sort, ())
        if not own:
            what = "nothing says which motor it is"
            yield Problem(
                where, what, "give stall and no_load; breakdown, synchronous and slip; torque; speed and gain"
            )
        for key in given if own else ():
            if key not in own:
                what = f"it belongs to another motor than {own[0]}"
                yield Problem(f"{where}.{key}", what, f"leave it out, or {own[0]}")
        for key in own:
            if getattr(self, key) is None:
                yield Problem(f"{where}.{key}", "it is missing", f"a motor with {own[0]} has {' and '.join(own)}")
        yield from self._impossible(where)
        pair = written.pair(self.pair)
        if pair is not None and not pair.free_is_angle and np.any(np.asarray(self.gear) == 1.0):
            what = f"{self.pair!r} slides, and a motor turns"
            remedy = (
                "give the angle of its shaft for a unit of travel: 2 pi / lead of a screw, 1 / radius of a pinion; "
                "a linear motor is an effort with a table over its rate"
            )
            yield Problem(f"{where}.gear", what, remedy)
        if pair is not None and np.any(np.asarray(self.inertia) > 0.0) and not self._is_on_frame(pair):
            what = "only a motor at a pin of the frame has an inertia of its own"
            yield Problem(f"{where}.inertia", what, "give the link that it turns a mass instead")

    def _impossible(self, where: str) -> Iterator[Problem]:
        positive = ("stall", "breakdown", "gain", "limit", "power")
        for key in positive:
            value = getattr(self, key)
            if value is not None and not np.all(np.asarray(value) > 0.0):
                remedy = (
                    "a negative gear turns the motor round" if key in ("stall", "breakdown") else "give one above 0"
                )
                yield Problem(f"{where}.{key}", f"{_shown(value)} is not above zero", remedy)
        for key in ("no_load", "synchronous"):
            value = getattr(self, key)
            if value is not None and not np.all(np.asarray(value) > 0.0):
                yield Problem(
                    f"{where}.{key}", f"{_shown(value)} is no speed above zero", "a negative gear turns it round"
                )
        if self.slip is not None and not np.all((np.asarray(self.slip) > 0.0) & (np.asarray(self.slip) <= 1.0)):
            what = f"{_shown(self.slip)} is no slip at the greatest torque"
            yield Problem(f"{where}.slip", what, "above 0, up to 1; commonly 0.1 to 0.3")
        if not np.all((np.asarray(self.efficiency) > 0.0) & (np.asarray(self.efficiency) <= 1.0)):
            yield Problem(f"{where}.efficiency", f"{_shown(self.efficiency)} is no efficiency", "above 0, up to 1")
        if np.any(np.asarray(self.gear) == 0.0):
            yield Problem(f"{where}.gear", "a motor that does not turn moves nothing", "give its speed over the pair's")
        if np.any(np.asarray(self.inertia) < 0.0):
            yield Problem(f"{where}.inertia", "an inertia is not below zero", "leave it out, or give that of the rotor")

    @staticmethod
    def _is_on_frame(pair: Any) -> bool:
        return bool(pair.free_is_angle and pair.is_simple and "frame" in pair.members)

    def rotor(self) -> tuple[str, Number] | None:
        """Return the link that its rotor moves with, and the inertia that the link feels; none without its links."""
        if not np.any(np.asarray(self.inertia) > 0.0):
            return None
        moved = [link for link in self.members if link != "frame"]
        return (moved[0] if moved else ""), np.square(self.gear) * self.inertia

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the speed of its shaft, and the coordinate."""
        own = super().variables(at)
        return {"rate": lambda: at.fitted(self.gear, self.where) * own["rate"](), COORDINATE: own[COORDINATE]}

    def shaft_torque(self, at: LoadedPoses, speed: Number, coordinate: Number = 0.0) -> Number:
        """Return its torque at a speed of its shaft, before the gear.

        Source: of an induction motor M / Mk = 2 / (s / sk + sk / s), M. Kloss, Archiv fuer Elektrotechnik 5 (1916) 59.
        """

        def number(key: str) -> Number:
            return at.fitted(getattr(self, key), f"{self.where}.{key}")

        own = {"rate": lambda: speed, "coordinate": lambda: coordinate}
        sort = self.sort
        if sort == "direct current":
            found = number("stall") * (1.0 - speed / number("no_load"))
        elif sort == "induction":
            s, peak = 1.0 - speed / number("synchronous"), number("slip")
            found = 2.0 * number("breakdown") * s * peak / (s * s + peak * peak)
        elif sort == "table":
            assert self.torque is not None
            found = value_of(self.where, self.torque, at, own)
        else:
            assert self.speed is not None
            found = number("gain") * (value_of(self.where, self.speed, at, own) - speed)
        most = np.inf if self.limit is None else number("limit")
        if self.power is not None:
            with np.errstate(divide="ignore"):
                most = np.minimum(most, number("power") / np.abs(speed))
        bounded: Number = np.clip(found, -most, most) if self.limit is not None or self.power is not None else found
        return bounded

    def effort(self, at: LoadedPoses) -> Number:
        """Return what it gives behind the gear."""
        series = at.coordinate(self.pair)
        second = 2.0 * series.c[2] if len(series.c) > 2 and self.loses_at_rotor else 0.0
        return self.effort_while(at, second)[0]

    def plain_effort(self) -> PlainEffort | None:
        """Return what a motor of numbers gives behind the gear, as a function of plain numbers."""
        rotor = None if self.loses_at_rotor else self.plain_rotor(1.0)
        if rotor is None:
            return None
        gear, torque = rotor.gear, rotor.torque

        def given(q: float, w: float, t: float) -> float:
            found = torque(q, w, t)
            return gear * found * rotor.part(found, w)

        return given

    def plain_rotor(self, factor: float) -> PlainRotor | None:
        """Return a motor of numbers before its gear, its inertia times a factor; None for one that is no such motor."""
        torque = self._plain_torque()
        if torque is None or any(np.size(one) != 1 for one in (self.gear, self.efficiency, self.inertia)):
            return None
        gear, efficiency, inertia = (float(np.ravel(one)[0]) for one in (self.gear, self.efficiency, self.inertia))
        limit, power = (None if one is None else float(np.ravel(one)[0]) for one in (self.limit, self.power))

        def given(q: float, w: float, t: float) -> float:
            speed = gear * w
            found = torque(speed, q, t)
            if power is not None and abs(found * speed) > power:
                found = power / abs(speed) * (1.0 if found > 0.0 else -1.0)
            if limit is not None and abs(found) > limit:
                found = limit if found > 0.0 else -limit
            return found

        return PlainRotor(given, gear, efficiency, factor * inertia * gear)

    def _plain_torque(self) -> Callable[[float, float, float], float] | None:
        """Return the torque at a speed of the shaft, a coordinate and a time, in plain numbers and without limits."""
        names, variables = SORTS.get(self.sort, ()), ("rate", "coordinate", "time")
        known = {name: plain_amount(self.where, getattr(self, name), variables) for name in names}
        if not names or any(one is None for one in known.values()):
            return None
        if self.sort == "table":
            return known["torque"]
        if self.sort == "servo":
            wanted, gain = known["speed"], float(np.ravel(np.asarray(self.gain))[0])
            assert wanted is not None
            return lambda speed, q, t: gain * (wanted(speed, q, t) - speed)
        numbers = [float(np.ravel(getattr(self, name))[0]) for name in names]
        if self.sort == "direct current":
            stall, no_load = numbers
            return lambda speed, q, t: stall * (1.0 - speed / no_load)
        breakdown, synchronous, peak = numbers

        def by_slip(speed: float, q: float, t: float) -> float:
            s = 1.0 - speed / synchronous
            return 2.0 * breakdown * s * peak / (s * s + peak * peak)

        return by_slip

    @cached_property
    def loses_at_rotor(self) -> bool:
        """Whether its effort depends on the acceleration: the gear passes on what its rotor leaves, with a loss."""
        return bool(np.any(np.asarray(self.inertia) > 0.0) and np.any(np.asarray(self.efficiency) < 1.0))

    def effort_while(self, at: LoadedPoses, second: Number) -> tuple[Number, Number]:
        """Return its effort at an acceleration of its coordinate, and its slope by that.

        Its rotor is among the masses of its link, as if the gear lost nothing of what the rotor takes.
        """
        series = at.coordinate(self.pair)
        gear, efficiency = at.fitted(self.gear, self.where), at.fitted(self.efficiency, self.where)
        speed = gear * rate_of(series)
        torque = self.shaft_torque(at, speed, series.c[0])
        # the rotor takes its part before the gear loses any; behind the gear it is given back to the mass of the link
        inertia = at.units.inertia * at.fitted(self.inertia, self.where) * gear if self.loses_at_rotor else 0.0
        passed = torque - inertia * second
        # where it is driven the gear takes its part on top
        factor = np.where(passed * speed >= 0.0, efficiency, 1.0 / efficiency)
        if not self.loses_at_rotor:
            return gear * torque * factor, 0.0
        return gear * (passed * factor + inertia * second), gear * inertia * (1.0 - factor)


def as_motor(load: Load) -> Motor | None:
    """Return a load as a motor, or None."""
    return load if isinstance(load, Motor) else None


def _shown(value: Any) -> str:
    return f"{float(np.ravel(value)[0]):g}"


@checked
def motor(
    pair: str,
    *,
    stall: Any = None,
    no_load: Any = None,
    breakdown: Any = None,
    synchronous: Any = None,
    slip: Any = None,
    torque: Any = None,
    speed: Any = None,
    gain: Any = None,
    limit: Any = None,
    power: Any = None,
    gear: Any = 1.0,
    efficiency: Any = 1.0,
    inertia: Any = 0.0,
    name: str = "",
) -> Motor:
    """Return a motor along the coordinate of a pair, meant as of `effort`: by its name, a pin's letter or a driver.

    It is one of these, its torques in units of force times length, its speeds in rad/s at its shaft:

    * direct current: the torque at rest `stall`, the speed without load `no_load`, a straight line between them;
    * induction: the greatest torque `breakdown`, the speed of the field `synchronous`, the `slip` at the greatest
      torque, by the formula of Kloss;
    * a `torque` over its speed: a table ``{"at": [...], "values": [...]}``, or a function of speed ``w``, coordinate
      ``q`` (of the pair), time ``t``;
    * a servo that keeps a `speed` (a number or a function of ``t``, ``q``) with the torque `gain` for each rad/s.

    Of all `limit` is the greatest torque and `power` the greatest power. The shaft turns `gear` times as fast as the
    coordinate, and `efficiency` is the gear's. The rotor's `inertia` counts `gear` squared at a pin of the frame.

    >>> wiper = motor("crank", stall=2.0, no_load=300.0, gear=50.0, inertia=1e-5)
    >>> wiper.sort, wiper.name
    ('direct current', 'motor along crank')
    """
    where = f"motors.{name or pair}"
    given = {"stall": stall, "no_load": no_load, "breakdown": breakdown, "synchronous": synchronous, "slip": slip,
             "gain": gain, "limit": limit, "power": power, "gear": gear, "efficiency": efficiency,
             "inertia": inertia}  # fmt: skip
    numbers: dict[str, Any] = {
        key: None if value is None else real(f"{where}.{key}", value) for key, value in given.items()
    }
    amounts: dict[str, Any] = {
        key: None if value is None else as_amount(f"{where}.{key}", value, "rate", "coordinate", "time")
        for key, value in (("torque", torque), ("speed", speed))
    }
    return Motor(pair, **numbers, **amounts, name=name)
