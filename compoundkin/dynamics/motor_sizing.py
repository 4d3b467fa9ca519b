"""Which motor drives a machine, behind which gear: what it must give over a motion, against a list of motors."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from importlib import resources
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, dot, trapezoid
from compoundkin.base.display import ShortRepr, aligned_text, short_repr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.dynamics.driver_course import driver_course, driver_named
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.mass_motion import equivalent_inertia
from compoundkin.model.loads.motor import as_motor
from compoundkin.model.units import FORCES, LENGTHS

# rad/s in a turn a minute.
RPM = 2.0 * pi / 60.0
# An effort below this part of what it is the sum of is rounding.
ROUNDING = 1e-12
# No gear is taken below this part of the greatest.
LEAST_GEAR = 1e-3


@dataclass(frozen=True)
class ListedMotor:
    """A motor of a list: torques in N m, speeds in rad/s, the inertia of its rotor in kg m^2.

    `rated` is what it gives for ever, up to `rated_speed`; `curve` the greatest torque over the speed.
    """

    name: str
    rated: float
    peak: float
    rated_speed: float
    top_speed: float
    inertia: float
    curve: tuple[tuple[float, ...], tuple[float, ...]]

    def greatest(self, speeds: Number) -> Number:
        """Return the greatest torque at speeds, zero beyond the top speed."""
        places, torques = self.curve
        return np.where(np.abs(speeds) > self.top_speed, 0.0, np.interp(np.abs(speeds), places, torques))


@dataclass(frozen=True)
class SizedMotor:
    """A motor behind its best gear on a machine: torques at its shaft, N m, speeds in rad/s, powers in W.

    `use` is the effective torque over the rated one, `reserve` the least of greatest torque over what is needed.
    `beyond_rated` and `beyond_curve` are the parts of the time in which more is asked than it gives for ever, and than
    it gives at all.
    `reflected` is the inertia of the load over that of the rotor. `reasons` say why it does not do.
    """

    motor: ListedMotor
    gear: float
    rms: float
    peak: float
    speed: float
    power: float
    reflected: float
    use: float
    reserve: float
    beyond_rated: float
    beyond_curve: float
    reasons: tuple[str, ...]

    @property
    def does(self) -> bool:
        """Whether it drives the machine."""
        return not self.reasons


@dataclass(frozen=True, eq=False, repr=False)
class Sizing(ShortRepr):
    """What a driver needs over a motion, and which motors give it.

    `times` in s (of each sample, one motion), `speeds` and `accelerations` of the driver, `torques` in N m (of a slide
    `torques` are thrusts in N, speeds in m/s). `inertia` is what the driver feels on the average, kg m^2 (kg).
    `motors` are in the order of the list, each behind its best gear.
    """

    driver: str
    is_angle: bool
    times: Number
    speeds: Number
    accelerations: Number
    torques: Number
    inertia: float
    efficiency: float
    motors: tuple[SizedMotor, ...]

    @property
    def peak(self) -> float:
        """The greatest torque, without its sign."""
        return float(np.max(np.abs(self.torques)))

    @property
    def rms(self) -> float:
        """The effective torque over the motion, with its dwells."""
        return _rms(self.torques, self.times)

    @property
    def power(self) -> float:
        """The greatest power that is given."""
        return float(np.max(self.torques * self.speeds))

    @property
    def speed(self) -> float:
        """The greatest speed, without its sign."""
        return float(np.max(np.abs(self.speeds)))

    @property
    def duty(self) -> float:
        """The part of the time in which it moves."""
        moves = np.abs(self.speeds) > 1e-9 * self.speed
        return float(trapezoid(moves.astype(float), self.times) / (self.times[-1] - self.times[0]))

    @cached_property
    def chosen(self) -> SizedMotor | None:
        """The smallest motor that does, by its rated power; None where none does."""
        known = [one for one in self.motors if one.does]
        return min(known, key=lambda one: one.motor.rated * one.motor.rated_speed, default=None)

    def at_shaft(self, motor: ListedMotor, gear: float) -> tuple[Number, Number]:
        """Return torques and speeds at the shaft of a motor behind a gear: its rotor is moved too."""
        return _at_shaft(self, motor.inertia, gear)

    @property
    def needs(self) -> tuple[tuple[str, float, str], ...]:
        """What is needed: quantity, value, unit."""
        turn, push = ("rpm", "N m") if self.is_angle else ("m/s", "N")
        return (
            ("greatest torque" if self.is_angle else "greatest thrust", self.peak, push),
            ("effective", self.rms, push),
            ("greatest power", self.power, "W"),
            ("greatest speed", self.speed / RPM if self.is_angle else self.speed, turn),
            ("inertia that it feels", self.inertia, "kg m^2" if self.is_angle else "kg"),
            ("part of the time in motion", 100.0 * self.duty, "%"),
        )

    @property
    def verdict(self) -> str:
        """The smallest motor that does, in words."""
        if not self.peak:
            what = "torque" if self.is_angle else "thrust"
            return f"It needs no {what} in this motion, so that every motor does: give its loads, friction or a run-up."
        best = self.chosen
        mean = trapezoid(self.torques * self.speeds, self.times) / (self.times[-1] - self.times[0])
        if mean < -ROUNDING * self.peak * self.speed:
            return f"It gives {-mean:.3g} W on the average: it drives its shaft, and a motor there only brakes."
        if best is None:
            return "No motor of the list does."
        return f"The smallest that does: {best.motor.name}, gear {best.gear:.3g}."

    def text(self) -> str:
        """Return what is needed, and the motors with what is against them."""
        rows: list[tuple[str, ...]] = [
            ("motor", "gear", "rms N m", "peak N m", "rpm", "use", "reserve", "inertias", "")
        ]
        for one in self.motors:
            numbers = one.gear, one.rms, one.peak, one.speed / RPM, one.use, one.reserve, one.reflected
            rows.append((one.motor.name, *(f"{number:.3g}" for number in numbers), "; ".join(one.reasons) or "does"))
        wide = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
        table = "\n".join("  ".join(cell.ljust(wide[k]) for k, cell in enumerate(row)).rstrip() for row in rows)
        return f"{aligned_text([(f'driver {self.driver}',), *self.needs])}\n\n{table}\n\n{self.verdict}"


def listed_motors(source: str | Path | None = None) -> tuple[ListedMotor, ...]:
    """Return the motors of a TOML file, by default the generic ones that are shipped.

    Torques are in N m, speeds in rpm, inertias in kg m^2. Raises InvalidInput for a file that is none, with the place.

    >>> len(listed_motors())
    12
    """
    text = (
        resources.files("compoundkin.dynamics").joinpath("motors.toml").read_text("utf-8")
        if source is None
        else _read(Path(source))
    )
    try:
        tables = tomllib.loads(text).get("motors")
    except tomllib.TOMLDecodeError as error:
        raise InvalidInput(
            Problem(str(source), f"it is no TOML: {error}", "see the shipped list: docs/machine.md")
        ) from None
    if not isinstance(tables, list) or not tables:
        raise InvalidInput(Problem(str(source), "it has no motors", "write [[motors]] with name, rated, peak ..."))
    return tuple(_listed(one, f"motors[{k}]") for k, one in enumerate(tables))


def _read(path: Path) -> str:
    try:
        return path.read_text("utf-8")
    except (OSError, ValueError) as error:
        raise InvalidInput(
            Problem(str(path), f"it cannot be read: {error}", "give a TOML file with [[motors]]")
        ) from None


def _listed(table: Any, where: str) -> ListedMotor:
    keys = [one.name for one in fields(ListedMotor)]
    given = table if isinstance(table, Mapping) else {}
    problems = [
        Problem(f"{where}.{key}", "no motor has such a key", suggestion(key, keys)) for key in given if key not in keys
    ]
    for key in keys:
        value = given.get(key)
        if key in ("name", "curve"):
            if key == "name" and not isinstance(value, str):
                problems.append(Problem(f"{where}.name", "it is missing", 'write name = "..."'))
        elif isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < np.inf:
            problems.append(Problem(f"{where}.{key}", f"{value!r} is no number above zero", "N m, rpm, kg m^2"))
    if problems:
        raise InvalidInput(problems)
    curve = given.get("curve", {"speeds": [0, given["top_speed"]], "torques": [given["peak"]] * 2})
    ends = [curve.get(key) if isinstance(curve, Mapping) else None for key in ("speeds", "torques")]
    try:
        speeds, torques = (np.array(one, dtype=float) for one in ends)
        is_curve = speeds.shape == torques.shape and len(speeds) > 1 and bool(np.all(np.diff(speeds) > 0.0))
    except (TypeError, ValueError):
        is_curve = False
    if not is_curve:
        remedy = "curve = { speeds = [0, 3000], torques = [2, 1] }, speeds increasing"
        raise InvalidInput(Problem(f"{where}.curve", "it is no curve of torque over speed", remedy))
    numbers = {key: float(given[key]) for key in ("rated", "peak", "inertia")}
    turned = {key: float(given[key]) * RPM for key in ("rated_speed", "top_speed")}
    return ListedMotor(given["name"], **numbers, **turned, curve=(tuple(speeds * RPM), tuple(torques)))


@checked
def sizing(
    forces: Forces,
    motors: Any = None,
    *,
    driver: str | None = None,
    gear: float | None = None,
    efficiency: float = 1.0,
    design: int = 0,
) -> Sizing:
    """Return which motors drive a machine over a motion, each behind the gear that is best for it.

    The motion is in time, or its driver has speeds. What a motor along the driver gives already is added to the effort.
    `motors` are a TOML file of your own, else generic ones; `gear` is the shaft's speed over the driver's (rad for a
    length of a slide), by default the one of the least effective torque up to the rated speed, the rotor moved too;
    `efficiency` is the gear's. A motor does where the effective torque is not above the rated one, every torque not
    above the curve, and no speed above the top speed.

    Raises InvalidInput for a motion without speeds or forces of inertia, a list that is none, an impossible efficiency.

    Source: the best gear of an inertia is sqrt(J / Jm), e.g. H. Gross, J. Hamann and G. Wiegaertner, Electrical Feed
    Drives in Automation, Publicis 2001, section 4.

    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.mass import mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> parts = link("frame", A=0), link("arm", A=0, B=1), drive("arm", law=lambda t: t * t)
    >>> heavy = mass("arm", 2, at="A", inertia=0.5)
    >>> arm = Mechanism("Arm", *parts, heavy, units={"length": "m", "mass": "kg", "force": "N"})
    >>> found = sizing(force_analysis(solve(arm, time=[0.0, 0.5, 1.0, 1.5, 2.0])))
    >>> round(found.peak, 9), round(found.inertia, 9)
    (1.0, 0.5)
    """
    if not 0.0 < efficiency <= 1.0:
        raise InvalidInput(Problem("efficiency", f"{efficiency:g} is no efficiency", "above 0, up to 1"))
    if gear is not None and (not np.isfinite(gear) or gear == 0.0):
        raise InvalidInput(Problem("gear", f"{gear:g} is no gear", "the speed of the shaft over that of the driver"))
    designs = forces.motion.failed.shape[0]
    if not 0 <= design < designs:
        raise InvalidInput(Problem("design", f"there is no design {design}", f"0 to {designs - 1}"))
    name = driver_named(forces.motion, driver)
    needed = _needed(forces, name, efficiency, design)
    if isinstance(motors, str | Path) or motors is None:
        known = listed_motors(motors)
    elif isinstance(motors, tuple | list) and motors and all(isinstance(one, ListedMotor) for one in motors):
        known = tuple(motors)
    else:
        remedy = "give the path of a TOML file with [[motors]], or leave it out"
        raise InvalidInput(Problem("motors", f"{short_repr(motors)} is no list of motors", remedy))
    sized = tuple(_sized(needed, one, gear) for one in known)
    return Sizing(
        **{one.name: getattr(needed, one.name) for one in fields(Sizing) if one.name != "motors"}, motors=sized
    )


def _needed(forces: Forces, driver: str, efficiency: float, design: int) -> Sizing:
    """Return what a driver needs over a motion, in SI units."""
    motion = forces.motion
    if motion.order < 2:
        raise InvalidInput(Problem("motion", "it has no accelerations", "solve(..., order=2)"))
    driver_course(forces, driver)
    shape = motion.failed.shape

    def row(values: Any) -> Number:
        return np.array(
            np.broadcast_to(np.reshape(values, (-1, shape[1])) if np.ndim(values) else values, shape)[design]
        )

    own, units = motion.drives[driver], motion.mechanism.stated_units
    newton, length = FORCES[units.force], LENGTHS[units.length]
    metre, factor = (1.0, newton * length) if own.is_angle else (length, newton)
    value, speeds, accelerations = row(own.value), metre * row(own.rate), metre * row(own.second)
    given, rotor = _given(forces, driver)
    rotor_inertia = units.inertia * factor / metre * row(rotor)
    # the rotor of a motor that is there goes with that motor: those of the list bring their own
    parts = (factor * row(np.asarray(forces.drives[driver].effort).reshape(shape)), factor * row(given),
             -rotor_inertia * accelerations)  # fmt: skip
    inertia = _felt(forces, driver, design) * units.inertia * factor / metre - float(np.mean(rotor_inertia))
    times = row(motion.time) if motion.time is not None else _times(value, row(own.rate))
    torques = _without_rounding(parts, inertia * float(np.max(np.abs(speeds))) ** 2)
    return Sizing(driver, own.is_angle, times, speeds, accelerations, torques, inertia, efficiency, ())


def _without_rounding(parts: Sequence[Number], most: float) -> Number:
    """Return the sum of torques, zero where it is the rounding of its parts or of `most`.

    That is twice the kinetic energy, the torque that turns the driver within a radian. Raises InvalidInput where some
    are not known.
    """
    total = sum(parts, np.zeros(len(parts[0])))
    if not np.isfinite(total).all():
        what = "its efforts are not known at all poses"
        raise InvalidInput(Problem("motion", what, "size it over poses that are assembled"))
    least = ROUNDING * max(most, *(float(np.max(np.abs(part))) for part in parts))
    found: Number = np.where(np.abs(total) <= least, 0.0, total)
    return found


def _felt(forces: Forces, driver: str, design: int) -> float:
    """Return the mean inertia that a driver feels, zero without masses."""
    if not forces.motion.mechanism.masses:
        return 0.0
    found = equivalent_inertia(forces.motion)
    k = found.drivers.index(driver)
    shape = forces.motion.failed.shape
    return float(np.nanmean(found.matrix[..., k, k].reshape(shape)[design]))


def _given(forces: Forces, driver: str) -> tuple[Number, Number]:
    """Return what motors along a driver give already, along its coordinate, and the inertia of their rotors there."""
    motion = forces.motion
    total, felt = np.zeros(motion.failed.shape), np.zeros(motion.failed.shape)
    for motor in filter(None, map(as_motor, motion.mechanism.loads.values())):
        for at in loaded_blocks(motion):
            own, other = dict(at.unit_effort(driver)), dict(at.unit_effort(motor.pair))
            if own.keys() == other.keys():
                link = next(iter(own))
                alike = dot(own[link].force, other[link].force) + own[link].moment * other[link].moment
                total[at.designs, at.poses] += np.sign(alike) * motor.effort(at)
                if rotor := motor.rotor():
                    felt[at.designs, at.poses] += at.fitted(rotor[1], motor.where)
    return total, felt


def _times(values: Number, speeds: Number) -> Number:
    """Return the times at values of a driver that moves at given speeds."""
    if not np.all(np.isfinite(speeds)) or np.any(speeds == 0.0) or np.ptp(np.sign(speeds)):
        raise InvalidInput(
            Problem("motion", "it tells no time: its driver rests or turns back", "solve(..., time=...)")
        )
    steps = 2.0 * np.diff(values) / (speeds[1:] + speeds[:-1])
    if not np.all(steps > 0.0):
        raise InvalidInput(Problem("motion", "its poses are not in the order of its speed", "solve it along its speed"))
    return np.concatenate([[0.0], np.cumsum(steps)])


def _rms(values: Number, times: Number) -> float:
    return float(np.sqrt(trapezoid(np.square(values), times) / (times[-1] - times[0])))


def _part_of_time(above: Number, times: Number) -> float:
    """Return the part of the time in which a function, straight between its samples, is above zero."""
    first, last = above[:-1], above[1:]
    size = np.maximum(np.abs(first) + np.abs(last), np.finfo(float).tiny)
    part = (np.maximum(first, 0.0) + np.maximum(last, 0.0)) / size
    return float(np.sum(part * np.diff(times)) / (times[-1] - times[0]))


def _at_shaft(needed: Sizing, inertia: float, gear: float) -> tuple[Number, Number]:
    speeds = gear * needed.speeds
    load = needed.torques / gear
    lost = np.where(load * speeds >= 0.0, 1.0 / needed.efficiency, needed.efficiency)
    return load * lost + gear * inertia * needed.accelerations, speeds


def best_gear(needed: Sizing, motor: ListedMotor) -> float:
    """Return the gear of the least effective torque at the shaft of a motor that keeps within its rated speed.

    The load's part of the torque falls with the gear, that of the rotor grows with it, so that the mean square is a sum
    of its square, of the square of its reciprocal, and of a constant: it is least where both parts are equal.
    """
    most = motor.rated_speed / needed.speed
    load = _rms(_at_shaft(needed, 0.0, 1.0)[0], needed.times)
    rotor = motor.inertia * _rms(needed.accelerations, needed.times)
    if rotor == 0.0:
        return float(most)
    return float(np.clip(np.sqrt(load / rotor), LEAST_GEAR * most, most))


def _sized(needed: Sizing, motor: ListedMotor, gear: float | None) -> SizedMotor:
    own = best_gear(needed, motor) if gear is None else gear
    torques, speeds = _at_shaft(needed, motor.inertia, own)
    rms, peak, speed = _rms(torques, needed.times), float(np.max(np.abs(torques))), float(np.max(np.abs(speeds)))
    greatest = motor.greatest(speeds)
    with np.errstate(divide="ignore", invalid="ignore"):
        reserve = float(np.nanmin(np.where(torques == 0.0, np.inf, greatest / np.abs(torques))))
    warm, low = (_part_of_time(np.abs(torques) - most, needed.times) for most in (motor.rated, greatest))
    reasons = tuple(_against(motor, rms, speed, reserve, low))
    reflected = needed.inertia / (own * own * motor.inertia)
    power = float(np.max(torques * speeds))
    return SizedMotor(motor, own, rms, peak, speed, power, reflected, rms / motor.rated, reserve, warm, low, reasons)


def _against(motor: ListedMotor, rms: float, speed: float, reserve: float, low: float) -> Iterator[str]:
    # the top speed by a gear that was chosen for it is not above it but for rounding
    if speed > motor.top_speed * (1.0 + 1e-9):
        yield f"{speed / RPM:.4g} rpm is above {motor.top_speed / RPM:.4g}"
    if rms > motor.rated:
        yield f"too warm: {rms:.3g} N m for ever, {motor.rated:.3g} rated"
    if reserve < 1.0:
        yield f"its curve is too low for {100.0 * low:.3g} % of the time"
