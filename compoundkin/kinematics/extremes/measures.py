"""What is searched along a motion: real quantities by name, or any function of a motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity, whole_and_part
from compoundkin.model.attributes import LENGTH, PARTS, SPEED, Dimension, derivative_order

# Values nearer than this part of what is natural for them differ by rounding.
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class Measure(ShortRepr):
    """A real quantity of any motion: its name and its function.

    `order` is how many time derivatives the motion must have. A length of a vector is `squared` to be smooth where it
    passes zero. Values below the part 1e-12 of `scale` are rounding.
    """

    name: str
    unit: str
    order: int
    of: Callable[[Motion], Number]
    squared: bool = False
    scale: float = 0.0
    dimension: Dimension = "number"

    def at_poses(self, motion: Motion) -> Number:
        """Return its values at all poses of a motion, (designs, poses)."""
        shape = motion.inputs.designs, motion.inputs.poses
        return np.broadcast_to(np.asarray(self.of(motion), dtype=float), motion.shape).reshape(shape)


def measure_of(motion: Motion, name: str) -> Measure:
    """Return the real quantity of a name. It may take derivatives beyond the motion's order.

    Raises UnknownName with the nearest known name, InvalidInput for a vector, which has extremes by its parts only.
    """
    known = motion if derivative_order(name) <= motion.order else between(motion, 0, 0.0, derivative_order(name))
    whole, part = whole_and_part(known, name)
    if whole.is_vector and not part:
        parts = " or ".join(f"{name}.{word}" for word in PARTS)
        raise InvalidInput(Problem(name, "a vector has no least and no greatest value", f"take {parts}"))
    owner, _, word = whole.name.rpartition(".")
    is_length = part == LENGTH or (word == SPEED and owner in motion.points)
    size = motion.size if whole.dimension == "length" else 1.0
    scale = whole.scale or size * driver_pace(motion) ** whole.order

    def of(at: Motion) -> Number:
        values = quantity(at, whole.name).values
        return PARTS[part](values) if part else values

    return Measure(name, whole.unit, max(derivative_order(name), whole.order), of, is_length, scale, whole.dimension)


def measures_of(motion: Motion, asked: Sequence[str | Measure]) -> tuple[Measure, ...]:
    """Return names as the quantities that they name, quantities as they are."""
    return tuple(measure_of(motion, one) if isinstance(one, str) else one for one in asked)


def driver_pace(motion: Motion) -> float:
    """Return the rate of the fastest driver. Slides count by the mechanism's size."""
    rates = (np.abs(v[1]) / motion.solving_order.unit(k) for k, v in motion.inputs.drives.items() if len(v) > 1)
    return max((float(np.max(rate)) for rate in rates), default=0.0)


def values_at_poses(motion: Motion, measures: Sequence[Measure]) -> Number:
    """Return the values of quantities at all poses, (quantities, designs, poses).

    Those beyond the motion's order are solved for.
    """
    order = max((one.order for one in measures), default=0)
    whole = motion
    if order > motion.order:
        designs, poses = np.indices((motion.inputs.designs, motion.inputs.poses)).reshape(2, -1)
        whole = between(motion, designs, poses, order)
    with np.errstate(all="ignore"):
        rows = [one.at_poses(motion if one.order <= motion.order else whole) for one in measures]
    shape = motion.inputs.designs, motion.inputs.poses
    return np.array([row.reshape(shape) for row in rows]).reshape(len(measures), *shape)
