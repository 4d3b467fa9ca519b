"""Outputs of a program by name: whatever a motion has at each pose, read off a recorded mechanism."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import unwrapped
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import read_of
from compoundkin.kinematics.quantity_owners import check_part, owner_and_part, owner_of
from compoundkin.model.attributes import (
    CORIOLIS,
    DERIVED,
    FORCES,
    OF_POINTS,
    PARTS,
    TRANSMISSION_INDEX,
    Attribute,
    Kind,
    course_figure,
)
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_motion import RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber

# What is said of names that a motion knows and a program does not.
ASK_SOLVE = "ask the motion: quantity(solve(...), name)"


class ProgramOutput(NamedTuple):
    """An owner's attribute that a name asks for, perhaps a part of a vector.

    An angle whose full turns nobody counts `is_wrapped`: made continuous along the motion afterwards.
    """

    name: str
    kind: Kind
    owner: str
    attribute: Attribute
    part: str = ""
    is_wrapped: bool = False

    @property
    def is_derived(self) -> bool:
        """Whether it is a figure that only some owners have."""
        return self.attribute.word in DERIVED[self.kind]

    def continuous(self, values: Number) -> Number:
        """Return its values along the motion, full turns of angles counted."""
        if not self.is_wrapped:
            return values
        # the sign of a zero, which no formula keeps, tells half a turn back from half a turn on
        return unwrapped(np.where(values == -np.pi, np.pi, values))


def output_of(motion: Motion, name: str) -> ProgramOutput:
    """Return what a name asks for. Raises UnknownName, and InvalidInput for what no program tells."""
    if isinstance(name, str) and course_figure(name)[1]:
        whole, figure = course_figure(name)
        what = f"{figure!r} is a figure of a whole motion, a program tells {whole!r} at each pose"
        raise InvalidInput(Problem(name, what, ASK_SOLVE))
    if not isinstance(name, str):
        raise InvalidInput(Problem("outputs", f"{name!r} is no name", 'write "G.velocity", one text for each'))
    owner, word, part = owner_and_part(motion, name)
    _check_recorded(motion, name, owner.kind, word)
    if part:
        check_part(name, part, word in (*OF_POINTS, CORIOLIS))
    known = DERIVED[owner.kind] if word in DERIVED[owner.kind] else owner.attributes
    is_wrapped = not part and _is_wrapped(motion, owner.kind, owner.name, known[word])
    return ProgramOutput(name, owner.kind, owner.name, known[word], part, is_wrapped)


def _check_recorded(motion: Motion, name: str, kind: Kind, word: str) -> None:
    """Raise InvalidInput for figures that are no straight-line arithmetic of one pose."""
    if word in FORCES[kind]:
        raise InvalidInput(Problem(name, "forces are no outputs of a program", "ask force_analysis(solve(...))"))
    owner = name.partition(".")[0]
    numbered = [solver.group.links for solver in motion.solving_order.solvers if solver.is_numbered]
    if word == TRANSMISSION_INDEX and any(owner in links for links in numbered):
        what = "the index of a group without a closed form is no output of a program"
        raise InvalidInput(Problem(name, what, ASK_SOLVE))


def _is_wrapped(motion: Motion, kind: Kind, owner: str, attribute: Attribute) -> bool:
    """Tell whether an output is an angle without full turns."""
    if attribute.order or attribute.word in DERIVED[kind]:
        return False
    if kind == "links":
        return motion.poses[owner].theta is None
    if kind != "pairs":
        return False
    pair = motion.solving_order.pairs[owner]
    return pair.free_is_angle and any(motion.poses[member].theta is None for member in pair.members)


def recorded_outputs(mechanism: RecordedMechanism, outputs: Iterable[ProgramOutput]) -> tuple[RecordedNumber, ...]:
    """Return outputs as recorded numbers: complex for planar vectors.

    Raises InvalidInput for a figure that is no straight-line arithmetic of one pose.
    """
    motion = RecordedMotion(mechanism)
    return tuple(mechanism.number(_recorded(motion, output)) for output in outputs)


def _recorded(motion: RecordedMotion, output: ProgramOutput) -> Number:
    owner = owner_of(motion, output.kind, output.owner)
    try:
        found = read_of(owner, output.attribute.word)
    except (TypeError, AttributeError) as error:
        if not output.is_derived:
            raise
        raise InvalidInput(Problem(output.name, f"no program can tell it: {error}", ASK_SOLVE)) from None
    return PARTS[output.part](found.values) if output.part else found.values
