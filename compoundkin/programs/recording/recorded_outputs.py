"""Outputs of a program by name: positions, angles and their rates, read off a recorded mechanism."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.errors import Problem, UnknownName, nearest
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import (
    ALSO,
    CATALOGUE,
    LENGTH,
    OF_POINTS,
    PARTS,
    SPEED,
    Attribute,
    Kind,
    coordinate_dimension,
)
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_number import RecordedNumber


class ProgramOutput(NamedTuple):
    """An owner's attribute that a name asks for, perhaps a part of a vector."""

    name: str
    kind: Kind
    owner: str
    attribute: Attribute
    part: str = ""


def output_of(order: SolvingOrder, name: str) -> ProgramOutput:
    """Return what a name asks for; raises UnknownName."""
    found = _found(order, name)
    if found is None:
        vector, _, part = name.rpartition(".")
        found = _found(order, vector) if part in PARTS else None
        if found is None:
            known = [one for kind in _owners(order).values() for one in kind]
            raise UnknownName(Problem(name, "no program can have this output", nearest(name.partition(".")[0], known)))
        return found._replace(name=name, part=part)
    return found


def _owners(order: SolvingOrder) -> Mapping[Kind, tuple[str, ...]]:
    mechanism = order.structure.mechanism
    return {
        "points": tuple(mechanism.carriers),
        "links": tuple(mechanism.links),
        "pairs": tuple(order.pairs),
        "drives": tuple(drive.name for drive in mechanism.drives),
    }


def _found(order: SolvingOrder, name: str) -> ProgramOutput | None:
    owner, dot, word = name.rpartition(".") if "." in name else (name, "", "")
    for kind, names in _owners(order).items():
        if owner in names:
            words = dict(CATALOGUE[kind])
            if kind in ("pairs", "drives"):
                is_angle = order.pairs[owner].free_is_angle if kind == "pairs" else order.structure.driven_angles[owner]
                words.update(ALSO[coordinate_dimension(is_angle)])
            word = word if dot else next(iter(words))
            if word in words:
                return ProgramOutput(name, kind, owner, words[word])
    return None


def recorded_output(mechanism: RecordedMechanism, output: ProgramOutput) -> RecordedNumber:
    """Return an output as a recorded number: complex for a planar vector."""
    found = _READERS[output.kind](mechanism, output)
    if output.part:
        found = np.abs(found) if output.part == LENGTH else getattr(found, "real" if output.part == "x" else "imag")
    return RecordedNumber(mechanism.graph, mechanism.graph.constant(0.0)).like(found)


def _point(mechanism: RecordedMechanism, output: ProgramOutput) -> Any:
    carriers = mechanism.recording.solving_order.structure.mechanism.carriers
    link, word = carriers[output.owner][0], output.attribute.word
    found = mechanism.block.world[link].derivative(
        mechanism.geometry.points[link][output.owner], output.attribute.order
    )
    if word in OF_POINTS:
        return found
    return np.abs(found) if word == SPEED else getattr(found, "real" if word == "x" else "imag")


def _link(mechanism: RecordedMechanism, output: ProgramOutput) -> Any:
    pose, k = mechanism.block.world[output.owner], output.attribute.order
    return pose.u.turning().derivative(k - 1) if k else pose.angle.c[0]


def _pair(mechanism: RecordedMechanism, output: ProgramOutput) -> Any:
    pair, block = mechanism.order.pairs[output.owner], mechanism.block
    poses = tuple(block.world[member] for member in pair.members)
    return pair.coordinate(block.ends[output.owner], poses).derivative(output.attribute.order)


def _drive(mechanism: RecordedMechanism, output: ProgramOutput) -> Any:
    return mechanism.drives[output.owner].derivative(output.attribute.order)


_READERS = {"points": _point, "links": _link, "pairs": _pair, "drives": _drive}
