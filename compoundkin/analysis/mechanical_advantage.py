"""Mechanical advantage of a force or torque at one place over another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from compoundkin.analysis.coupler.relative_motion import SMALL, moving, relative_link, relative_point
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, dot
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.kinematics import Motion
from compoundkin.model.elements import FRAME


@dataclass(frozen=True)
class TorquePort:
    """A torque on `link` that acts against `on`. Its rate is their relative angular velocity, rad/s."""

    link: str
    on: str = FRAME


@dataclass(frozen=True, eq=False, repr=False)
class ForcePort(PrintsShort):
    """A force at a point of `link` in a direction (radians), against `on`.

    The direction is in the frame of `on`, a number or an array.
    `point` is a letter, or coordinates in the link's frame; the rate is the component of its velocity, length/s.
    """

    link: str
    point: Any
    angle: Any
    on: str = FRAME


Port: TypeAlias = str | TorquePort | ForcePort


@dataclass(frozen=True, eq=False, repr=False)
class Advantage(PrintsShort):
    """Velocity ratio and mechanical advantage at every pose; real arrays of the motion's shape.

    `velocity_ratio` is output rate / input rate, `advantage` its reciprocal: the output force or torque that balances a
    unit one at the input, without friction. A force against a torque gives lengths: the units are those of the rates.
    Each is inf where its denominator is zero (`output_rests`: a toggle position; `input_rests`), without a sign. Where
    `defined` is False both are NaN: both rest, or the pose is not assembled or has no rates.
    """

    velocity_ratio: Number
    advantage: Number
    output_rests: Number
    input_rests: Number
    defined: Number


@checked
@np.errstate(all="ignore")
def mechanical_advantage(motion: Motion, output: Port, input: Port) -> Advantage:
    """Return how many times the force or torque at `input` is available at `output`.

    At every pose, without friction.
    Each of the two is a link (its torque against the frame), a pair or a driver by name (the force or torque along its
    free coordinate), `TorquePort(link, on)` for a torque between any two links, or `ForcePort(link, point, angle)`
    for a force at a point. Positive where both rates have one sign. It does not depend on the driver's speed.

    Raises UnknownName for a name that is not there; InvalidInput below order 1, for a driver at rest, and where several
    drivers move at one pose, for the balance then depends on what the others do.
    Source: power is conserved; Uicker, Pennock and Shigley, Theory of Machines and Mechanisms; for
    four-bars ``omega4 / omega2`` by the centres, Freudenstein's theorem.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("four-bar-norton"), {"crank": [np.deg2rad(40)]})
    >>> mechanical_advantage(motion, "rocker", "crank").velocity_ratio.round(3).tolist()     # Norton: 6.998 / 25
    [0.28]
    """
    moving(motion, "the mechanical advantage")
    _one_driver(motion)
    out, lag = (_rate(motion, port, where) for port, where in ((output, "output"), (input, "input")))
    regular = motion.regular.reshape(motion.shape)
    output_rests, input_rests = (regular & (np.abs(v) <= SMALL * s) for v, s in (out, lag))
    defined = regular & ~(output_rests & input_rests)
    ratio, advantage = _quotient(out[0], lag[0], input_rests), _quotient(lag[0], out[0], output_rests)
    return Advantage(
        np.where(defined, np.where(output_rests, 0.0, ratio), np.nan),
        np.where(defined, np.where(input_rests, 0.0, advantage), np.nan),
        output_rests,
        input_rests,
        defined,
    )


def _quotient(a: Number, b: Number, infinite: Number) -> Number:
    return np.where(infinite, np.inf, a / b)


def _rate(motion: Motion, port: Port, where: str) -> tuple[Number, Number]:
    """Return the rate at a port, and its scale."""
    scale, size = _scale(motion), motion.size
    if isinstance(port, str):
        return _named(motion, port, where, scale)
    if isinstance(port, TorquePort):
        return np.asarray(relative_link(motion, port.link, port.on).angular_velocity), scale
    velocity = np.asarray(relative_point(motion, port.link, port.point, port.on).velocity)
    return dot(np.exp(1j * _angle(motion, port.angle, where)), velocity), scale * size


def _named(motion: Motion, name: str, where: str, scale: Number) -> tuple[Number, Number]:
    if name in motion.links and name != FRAME:
        return motion.links[name].angular_velocity, scale
    for table in (motion.pairs, motion.drives):
        if name in table:
            return table[name].rate, scale * (1.0 if table[name].is_angle else motion.size)
    known = [known for known in dict.fromkeys((*motion.links, *motion.pairs, *motion.drives)) if known != FRAME]
    raise UnknownName(Problem(where, f"there is no moving link, pair or driver {name!r}", nearest(name, known)))


def _angle(motion: Motion, angle: Any, where: str) -> Number:
    try:
        value = np.asarray(angle, dtype=float)
        np.broadcast_to(value, motion.shape)
    except (TypeError, ValueError):
        text, remedy = f"{angle!r} is not an angle for every pose", f"a number, or an array of shape {motion.shape}"
        raise InvalidInput(Problem(f"{where}.angle", text, f"radians; {remedy}")) from None
    return value


def _scale(motion: Motion) -> Number:
    """Return the rate of the fastest link or driver at each pose, in rad/s. What rounding is relative to."""
    rates = [np.abs(d.rate) / (1.0 if d.is_angle else motion.size) for d in motion.drives.values()]
    rates += [np.abs(link.angular_velocity) for link in motion.links.values()]
    return np.maximum.reduce(np.broadcast_arrays(*rates, np.zeros(motion.shape)))


def _one_driver(motion: Motion) -> None:
    at_once = np.sum([np.broadcast_to(drive.rate != 0, motion.shape) for drive in motion.drives.values()], axis=0)
    if np.any(at_once > 1):
        names = ", ".join(motion.drives)
        text = f"several drivers move at once ({names}): what balances a force depends on all of them"
        raise InvalidInput(Problem("the mechanical advantage", text, "solve(..., speed={one: 1, the others: 0})"))
