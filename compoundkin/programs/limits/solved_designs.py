"""Designs solved instead of computed: the same motion by `solve`, in the configuration that a program is in."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidMechanism, NotAssembled, NotDetermined
from compoundkin.base.series import Number
from compoundkin.kinematics.chosen_modes import Shown
from compoundkin.kinematics.driver_values import inputs
from compoundkin.kinematics.lost_digits import Told
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import first_configuration, solved, solving_order_of
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.calls.call_numbers import CallNumbers, picked
from compoundkin.programs.graph.input_kinds import DRIVE

# Solves the designs of some numbers.
Solving: TypeAlias = Callable[[CallNumbers], Told]


@dataclass(frozen=True)
class ProgramConfiguration(PrintsShort):
    """The configuration of a program: signs of groups, and where they are shown."""

    signs: dict[int, int]
    shown: Shown

    @classmethod
    def of(cls, reference: Motion) -> ProgramConfiguration:
        """Return the configuration of a motion of one design."""
        tracker = reference.tracker
        signs = {s.index: int(np.ravel(tracker.signs[s.index])[0]) for s in reference.solving_order.solvers
                 if not s.is_numbered}  # fmt: skip
        # configurations that are numbered are those nearest to the reference, whatever their number in a design
        near = first_configuration(reference, 0) if reference.solving_order.numbered else None
        if near is None or tracker.shown.points:
            return cls(signs, tracker.shown)
        return cls(signs, Shown("configuration", near.points, near.poses, near.points))


def solved_parts(by: Solving, numbers: CallNumbers, designs: Number) -> Iterator[tuple[Number, Told | None]]:
    """Solve some designs, and yield them in parts.

    It is None where nothing can be built or assembled. One design of which there is nothing must not take the others
    with it.
    """
    if not len(designs):
        return
    try:
        yield designs, by(picked(numbers, designs))
    except (NotAssembled, NotDetermined, InvalidMechanism):
        half = len(designs) // 2
        if not half:
            yield designs, None
            return
        yield from solved_parts(by, numbers, designs[:half])
        yield from solved_parts(by, numbers, designs[half:])


def solved_designs(designed: Mechanism, numbers: CallNumbers, configuration: ProgramConfiguration, order: int) -> Told:
    """Return the motion of all designs of some numbers; raises NotAssembled as `solve`."""
    solving_order = solving_order_of(designed)
    drives: dict[str, list[object]] = {}
    for one, value in numbers.given.items():
        if one.kind == DRIVE:
            drives.setdefault(one.name, []).append(np.broadcast_to(value, numbers.extent))
    columns = {name: (*values, *[0.0] * (4 - len(values))) for name, values in drives.items()}
    values, *rates = ({name: each[k] for name, each in columns.items()} for k in range(4))
    with np.errstate(all="ignore"):
        given = inputs(solving_order, values, rates[0], rates[1], rates[2])
        return solved(solving_order, given, configuration.signs, configuration.shown, order)
