"""Velocities from centres alone, and what they prove about a solved motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation import Derivation
from compoundkin.analysis.centres.driver_rates import DriverRates
from compoundkin.analysis.centres.homogeneous import OwnCoordinates, PrimaryCentres, cross, dot
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME

# Below this conditioning (rounding becomes 1e-10) a centre is given, but proves nothing to 1e-9.
POOR = 1e-6
# A pose slower than this part of the motion's fastest is judged by that: a mechanism at rest has no own scale.
SLOWEST = 1e-6


@dataclass(frozen=True, eq=False)
class CentreVectors:
    """The centres of a motion as unit vectors in own coordinates, by couples.

    `spread` is their magnification of errors, `lines` the two lines where other ones than the derivation's were taken.
    """

    motion: Motion
    plan: Derivation
    scale: OwnCoordinates
    places: PrimaryCentres
    units: dict[Couple, Number]
    spread: dict[Couple, Number]
    lines: dict[Couple, tuple[Number, Number, Number]]

    def trusted(self, c: Couple) -> Number:
        """Return a centre's unit vectors, NaN where it is not known well."""
        return np.where(self.spread[c] * POOR <= 1.0, self.units[c], np.nan)


@dataclass(frozen=True, repr=False)
class Velocities(ShortRepr):
    """What the centres and the drivers' rates say. Arrays of the motion's shape, NaN where they say nothing.

    `twists[link]` (3, poses) in own coordinates relative to the frame; `conditioning[link]` is near 0 where rounding
    is magnified, relative to the fastest link.
    """

    centres: CentreVectors
    twists: Mapping[str, Number]
    conditioning: Mapping[str, Number]
    fastest: Number

    def angular_velocity(self, link: str) -> Number:
        """Return a link's angular velocity, rad/s."""
        return self.twists[link][2].reshape(self.centres.motion.shape)

    def at(self, link: str, position: Number) -> Number:
        """Return the velocity of a link's point at a place, complex, length/s."""
        x, y, w = self.twists[link]
        scale = self.centres.scale
        own = (np.broadcast_to(position, self.centres.motion.shape).reshape(-1) - scale.origin) / scale.size
        return (1j * (w * own - (x + 1j * y)) * scale.size).reshape(self.centres.motion.shape)


@dataclass(frozen=True, repr=False)
class VelocityCheck(ShortRepr):
    """Solved velocities against those from centres, relative to the fastest link.

    By link and by point.
    A link's is the larger of those of its angular velocity and of the velocity of its frame's origin. NaN where the
    comparison is not made: at poses without rates, and where conditioning is below POOR.
    """

    links: Mapping[str, Number]
    points: Mapping[str, Number]

    @property
    def worst(self) -> float:
        """The largest disagreement; NaN if nothing was compared."""
        values = np.array([np.fmax.reduce(v, axis=None) for v in (*self.links.values(), *self.points.values())])
        return float(np.fmax.reduce(values)) if values.size else float("nan")

    @property
    def compared(self) -> float:
        """The part of all links and poses that was compared."""
        return float(np.mean([np.mean(~np.isnan(v)) for v in self.links.values()]))


def velocities_of(centres: CentreVectors) -> Velocities:
    """Return the velocities that follow from the drivers' rates by centres alone."""
    with np.errstate(all="ignore"):
        rates = DriverRates(centres.plan, centres.units, centres.spread)
        rates.run(centres.places.units, centres.places.rates)
        factor = centres.places.rates[0] if len(centres.places.rates) == 1 else np.ones(1)
        body = centres.plan.body
        numbers = {name: k for k, name in enumerate(centres.plan.diagram.links)}
        scale = rates.fastest()
        twists, conditioning = {}, {}
        for name, k in numbers.items():
            twist, error = rates.relative(body[numbers[FRAME]], body[k])
            twists[name] = twist * factor
            conditioning[name] = np.where(np.isfinite(error), scale / np.maximum(error, scale), 0.0)
    # a mechanism of one body has constants where others have a value a pose
    count = centres.motion.inputs.designs * centres.motion.inputs.poses
    return Velocities(
        centres,
        {name: np.broadcast_to(twist, (3, count)) for name, twist in twists.items()},
        {name: np.broadcast_to(value, (count,)) for name, value in conditioning.items()},
        np.broadcast_to(scale * np.abs(factor), (count,)),
    )


def velocity_check(found: Velocities, motion: Motion) -> VelocityCheck:
    """Compare a motion's velocities with those from centres, where conditioning is not below POOR."""
    shape = motion.shape
    regular = np.broadcast_to(motion.regular, (motion.inputs.designs, motion.inputs.poses)).reshape(shape)
    links, points = {}, {}
    usable = {n: regular & (c.reshape(shape) >= POOR) for n, c in found.conditioning.items()}
    slowest = SLOWEST * float(np.max(found.fastest, where=np.all(list(usable.values()), axis=0).ravel(), initial=0.0))
    scale = np.maximum(found.fastest, slowest if slowest > 0.0 else 1.0).reshape(shape)
    with np.errstate(all="ignore"):
        for name in motion.mechanism.links:
            link = motion.links[name]
            turning = np.abs(found.angular_velocity(name) - link.angular_velocity)
            going = np.abs(found.at(name, np.asarray(link.origin.position)) - np.asarray(link.origin.velocity))
            gap = np.maximum(turning, going / motion.size)
            links[name] = np.where(usable[name], _certain(gap / scale), np.nan)
        for letter, carriers in motion.mechanism.carriers.items():
            point = motion.points[letter]
            gap = np.abs(found.at(carriers[0], np.asarray(point.position)) - np.asarray(point.velocity))
            points[letter] = np.where(usable[carriers[0]], _certain(gap / (scale * motion.size)), np.nan)
    return VelocityCheck(links, points)


def collinearity_of(centres: CentreVectors) -> dict[tuple[str, str, str], Number]:
    """Return how far the three centres of three links are from one line. The volume of their unit vectors.

    NaN where one of them is not known.
    """
    body, names = centres.plan.body, centres.plan.diagram.links
    shape = centres.motion.shape
    found = {}
    for i, j, k in combinations(range(len(names)), 3):
        if len({body[i], body[j], body[k]}) < 3:
            continue
        sides = [couple(body[a], body[b]) for a, b in ((i, j), (j, k), (i, k))]
        p, q, r = (centres.trusted(c) for c in sides)
        volume = np.abs(dot(p, cross(q, r)))
        count = centres.motion.inputs.designs * centres.motion.inputs.poses
        found[names[i], names[j], names[k]] = np.broadcast_to(volume, (count,)).reshape(shape)
    return found


def _certain(value: Number) -> Number:
    """Return what is not a number where it is compared is not agreement."""
    return np.where(np.isnan(value), np.inf, value)
