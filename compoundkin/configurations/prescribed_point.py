"""The mechanism driven by one of its points: its drivers are released, the point's motion is prescribed instead.

Driven so, serial and parallel robots come apart into dyads: their inverse kinematics in closed form.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import InvalidInput, InvalidMechanism, NotDetermined, Problem
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.driver_values import Inputs, inputs
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solution import solving_order_of
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.elements import Drive, Expectation, Mode, drive
from compoundkin.model.fields import Item
from compoundkin.model.laws import constant_speed
from compoundkin.model.laws.path_coordinate import PARTS
from compoundkin.model.loads import LoadElement
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outlines import LinkOutline
from compoundkin.model.prescribed_motion import PrescribedMotion

# The prescribed motion of the point and its drivers: the coordinates, and the angle of the first link that carries the
# point. No link or point has such a name.
LEADER, TURN_OF = "(led)", "(angle)"
ALONG, ACROSS = (f"{LEADER}.{part}" for part in PARTS)


@dataclass(frozen=True)
class PrescribedPoint:
    """A point, the drivers released for it, and the mechanism whose input is the point.

    With three released drivers the angle of the first link that carries the point is prescribed as well. `driven` is
    the mechanism with its own drivers and `inputs`, `inverse` that driven by the point, with `inverse_inputs`, both of
    one design.
    """

    point: str
    free: tuple[str, ...]
    driven: SolvingOrder
    inverse: SolvingOrder
    inputs: Inputs
    inverse_inputs: Inputs

    @classmethod
    def of(cls, mechanism: Mechanism, point: str, free: tuple[str, ...], still: dict[str, float]) -> PrescribedPoint:
        """Return the mechanism driven by a point. Raises InvalidInput where that leaves it undetermined."""
        driven = solving_order_of(mechanism)
        try:
            inverse = solving_order_of(_driven_by_point(mechanism, point, free))
        except (NotDetermined, InvalidMechanism) as error:
            what = f"the drivers {', '.join(free)} do not follow from where {point} is: {error}"
            raise InvalidInput(Problem("workspace", what, "take another point, or fewer drivers")) from None
        if inverse.numbered and inverse.structure.relaxation:
            what = f"driven by {point}, its redundant pairs have no closed form, and no search finds all configurations"
            raise InvalidInput(Problem("workspace", what, "leave the redundant links out"))
        rest = {name: 0.0 for name in (ALONG, ACROSS, TURN_OF) if name in inverse.structure.driven}
        whole = inputs(driven, {**dict.fromkeys(free, 0.0), **still}, None, None, None)
        inverse_whole = inputs(inverse, {**rest, **still}, None, None, None)
        first = slice(0, 1)
        return cls(point, free, driven, inverse, whole.cut(first, first), inverse_whole.cut(first, first))

    @property
    def turns(self) -> bool:
        """Whether an angle is prescribed beside the place."""
        return TURN_OF in self.inverse.structure.driven

    @property
    def carrier(self) -> str:
        """The first link that carries the point, whose angle may be prescribed."""
        return self.driven.structure.mechanism.carriers[self.point][0]

    def block(self, z: Number, angle: Number, order: int = 0, moved: str = "") -> tuple[Block, Inputs]:
        """Return an unsolved block of the inverse mechanism at places and angles (n,). One coordinate may move."""
        values = {ALONG: z.real, ACROSS: z.imag, TURN_OF: angle}
        drives = {
            name: (values[name][None], float(name == moved)) if name in values else (v[0], 0.0)
            for name, v in self.inverse_inputs.drives.items()
        }
        given = self.inverse_inputs.of_poses(len(z)).driven(drives)
        return self.inverse.start(given.ends, given.series(order), order, (1, len(z))), given

    def coordinates(self, block: Block) -> dict[str, Number]:
        """Return the coordinates of the released drivers, with derivatives, of a solved block."""
        found = {}
        for name in self.free:
            step = self.driven.structure.driven[name]
            poses = tuple(block.world[member] for member in step.pair.members)
            value = step.pair.coordinate(self.inputs.ends[step.pair.name], poses)
            found[name] = value if step.pair.driven_by(step.drive.link) > 0 else -value
        return found

    def placed(self, block: Block) -> tuple[Number, Number]:
        """Return the place of the point in a solved driven block, and the angle of its link."""
        pose = block.world[self.carrier]
        local = first_entry(self.driven.structure.mechanism.geometry.points[self.carrier][self.point])
        return pose.at(local).c[0], np.angle(pose.u.c[0])


def _driven_by_point(mechanism: Mechanism, point: str, free: tuple[str, ...]) -> Mechanism:
    """Return the mechanism with the prescribed motion of a point in place of some drivers."""
    parts = [item for item in mechanism.parts if not isinstance(item, Mode | Expectation | LoadElement | LinkOutline)]
    kept = [item for item in parts if not (isinstance(item, Drive) and item.name in free)]
    leader = PrescribedMotion(LEADER, point, x=constant_speed(0.0), y=constant_speed(0.0))
    turned: tuple[Item, ...] = ()
    if len(free) == 3:
        turned = (drive(mechanism.carriers[point][0], on=leader.links[-1], pair=point, name=TURN_OF),)
    return Mechanism(mechanism.title, *kept, leader, *turned, unit=mechanism.unit)


@dataclass(frozen=True)
class ModeSigns:
    """The choice of some configurations of the inverse mechanism, an axis before all others."""

    signs: Mapping[int, Number]

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return the signs of a group."""
        return self.signs.get(solver.index, 1.0)

    def angle(self, solver: GroupSolver, link: str) -> Number | None:
        """Return nothing: full turns are not counted."""
        return None
