"""A motion's primary centres as unit homogeneous vectors, in coordinates of the mechanism's own size and place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Diagram
from compoundkin.analysis.centres.homogeneous import norm
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.contract import Line


@dataclass(frozen=True)
class OwnCoordinates:
    """Own coordinates: a place p of the world is at ``(p - origin) / size``.

    Homogeneous vectors of order one then have errors of rounding size, wherever and however large the mechanism.
    """

    origin: complex
    size: float

    def own(self, x: Number, y: Number, w: Number) -> Number:
        """A point, or a twist, of the world in own coordinates, (3, ...)."""
        shape = np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(w))
        out = np.empty((3, *shape))
        out[0] = (x - self.origin.real * w) / self.size
        out[1] = (y - self.origin.imag * w) / self.size
        out[2] = w
        return out

    def own_line(self, line: Line) -> Number:
        """A line of the world in own coordinates, (3, ...)."""
        a, b, c = line
        shape = np.broadcast_shapes(np.shape(a), np.shape(b), np.shape(c))
        out = np.empty((3, *shape))
        out[0] = a * self.size
        out[1] = b * self.size
        out[2] = a * self.origin.real + b * self.origin.imag + c
        return out

    def world(self, point: Number) -> Number:
        """Own homogeneous coordinates in the world's, (3, ...)."""
        out = np.empty_like(point)
        out[0] = point[0] * self.size + self.origin.real * point[2]
        out[1] = point[1] * self.size + self.origin.imag * point[2]
        out[2] = point[2]
        return out


@dataclass(frozen=True)
class PrimaryCentres:
    """The primary centres of a motion: unit vectors (3, poses or 1), and the lengths they had before.

    A driver's rate times the length is the amplitude of its twist on the unit vector; `rates` holds these.
    """

    units: tuple[Number, ...]
    rates: tuple[Number, ...]


def scale_of(motion: Motion) -> OwnCoordinates:
    """Own coordinates around the middle of the frame's points."""
    points = list(motion.mechanism.geometry.points[FRAME].values())
    middle = np.mean([np.mean(p) for p in points]) if points else 0.0
    return OwnCoordinates(complex(middle), motion.size)


def places_of(motion: Motion, diagram: Diagram, scale: OwnCoordinates) -> PrimaryCentres:
    """The primary centres at every pose, poses and designs in one axis."""
    units, lengths = [], []
    for primary in diagram.primaries:
        pair = motion.tracker.plan.pairs[primary.pair]
        first, second = (_still(motion.poses[name]) for name in pair.members[:2])
        centre = pair.centre(motion.inputs.ends[primary.pair], (first, second))
        assert centre is not None
        vector = _flat(motion, scale.own_line(centre) if isinstance(centre, Line) else scale.own(*centre))
        length = norm(vector)
        units.append(vector / length)
        lengths.append(length)
    rates = tuple(
        _flat(motion, np.asarray(motion.inputs.drives[d.driver][1], dtype=float)[None])[0] * lengths[d.primary] * d.sign
        for d in diagram.drives
    )
    return PrimaryCentres(tuple(units), rates)


def _still(pose: Pose) -> Pose:
    """The pose without its derivatives."""
    return pose if pose is FIXED else Pose.of(pose.z.c[0], pose.u.c[0])


def _flat(motion: Motion, vector: Number) -> Number:
    """(3, 1 or designs, 1 or poses) with the last two axes as one; one column where it never changes."""
    if vector[0].size == 1:
        return vector.reshape(-1, 1)
    shape = (len(vector), motion.inputs.designs, motion.inputs.poses)
    return np.ascontiguousarray(np.broadcast_to(vector, shape)).reshape(len(vector), -1)
