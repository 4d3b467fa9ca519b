"""Mechanical advantage of a force or torque at one place over another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from compoundkin.analysis.coupler.relative_motion import check_moving, relative_link, relative_point
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, dot
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion
from compoundkin.kinematics.derived.velocity_ratio import (
    Advantage,
    PortRate,
    balance,
    fastest,
    no_turning,
    rate_of,
    rate_of_link,
    sizes_of,
)
from compoundkin.model.geometry import FRAME


@dataclass(frozen=True)
class TorquePort:
    """A torque on `link` that acts against `on`; its rate is their relative angular velocity, rad/s."""

    link: str
    on: str = FRAME


@dataclass(frozen=True, eq=False, repr=False)
class ForcePort(ShortRepr):
    """A force at a point of `link` in a direction (radians), against `on`.

    The direction is in the frame of `on`, a number or an array.
    `point` is a letter, or coordinates in the link's frame; the rate is the component of its velocity, length/s.
    """

    link: str
    point: Any
    angle: Any
    on: str = FRAME


Port: TypeAlias = str | TorquePort | ForcePort


@checked
@np.errstate(all="ignore")
def mechanical_advantage(motion: Motion, output: Port, input: Port) -> Advantage:
    """Return the ratio of the force or torque at `output` to that at `input`, at every pose, without friction.

    Each of the two is a link (its torque against the frame), a pair or a driver by name (the force or torque along its
    free coordinate), `TorquePort(link, on)` for a torque between any two links, or `ForcePort(link, point, angle)`
    for a force at a point. Positive where both rates have one sign. It does not depend on the driver's speed.

    Raises UnknownName for an unknown name; InvalidInput below order 1, for a driver at rest, for a link that
    moves without turning (name its slide, or a `ForcePort`), and where several drivers move at one pose: the
    balance then depends on all of them.
    Source: power is conserved; Uicker, Pennock and Shigley, Theory of Machines and Mechanisms; for
    four-bars ``omega4 / omega2`` by the centres, Freudenstein's theorem.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load("four-bar-norton"), {"crank": [np.deg2rad(40)]})
    >>> mechanical_advantage(motion, "rocker", "crank").velocity_ratio.round(3).tolist()     # Norton: 6.998 / 25
    [0.28]
    """
    check_moving(motion, "the mechanical advantage")
    _one_driver(motion)
    out, lag = (_rate(motion, port, where) for port, where in ((output, "output"), (input, "input")))
    return balance(out, lag, motion.regular.reshape(motion.shape))


def _rate(motion: Motion, port: Port, where: str) -> PortRate:
    """Return the rate at a port, and its scale."""
    if isinstance(port, str):
        return _named(motion, port, where)
    scale = fastest(motion)
    if isinstance(port, TorquePort):
        return PortRate(np.asarray(relative_link(motion, port.link, port.on).angular_velocity), scale)
    velocity = np.asarray(relative_point(motion, port.link, port.point, port.on).velocity)
    return PortRate(dot(np.exp(1j * _angle(motion, port.angle, where)), velocity), scale * sizes_of(motion))


def _named(motion: Motion, name: str, where: str) -> PortRate:
    """Return the rate of a turning link, else of a pair, else of a driver."""
    tables = [table for table in (motion.pairs, motion.drives) if name in table]
    is_link = name in motion.links and name != FRAME
    if is_link and not (tables and no_turning(motion, name)):
        return rate_of_link(motion, name, where)
    if tables:
        return rate_of(motion, tables[0], name)
    known = [known for known in dict.fromkeys((*motion.links, *motion.pairs, *motion.drives)) if known != FRAME]
    raise UnknownName(Problem(where, f"there is no moving link, pair or driver {name!r}", suggestion(name, known)))


def _angle(motion: Motion, angle: Any, where: str) -> Number:
    try:
        value = np.asarray(angle, dtype=float)
        np.broadcast_to(value, motion.shape)
    except (TypeError, ValueError):
        text, remedy = f"{angle!r} is not an angle for every pose", f"a number, or an array of shape {motion.shape}"
        raise InvalidInput(Problem(f"{where}.angle", text, f"radians; {remedy}")) from None
    return value


def _one_driver(motion: Motion) -> None:
    at_once = np.sum([np.broadcast_to(drive.rate != 0, motion.shape) for drive in motion.drives.values()], axis=0)
    if np.any(at_once > 1):
        names = ", ".join(motion.drives)
        text = f"several drivers move at once ({names}): what balances a force depends on all of them"
        raise InvalidInput(Problem("the mechanical advantage", text, "solve(..., speed={one: 1, the others: 0})"))
