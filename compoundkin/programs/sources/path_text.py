"""A compiled path as a text: which numbers it is given and answers, what they mean, and what is told of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import OF_POINTS, RATES, coordinate_dimension, unit_of
from compoundkin.programs.calls.seed_values import seed_values
from compoundkin.programs.graph.input_kinds import DRIVE, SIDE
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.recorded_path import PathVariants, RecordedPath
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_motion import RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.sources.carried_states import CarriedState, carried_states, followed
from compoundkin.programs.sources.contract import Argument, Result, WrittenProgram
from compoundkin.programs.sources.identifiers import Identifiers, identifier
from compoundkin.programs.sources.told_configuration import changed_modes, notes


def written_program(path: PathVariants, name: str = "") -> WrittenProgram:
    """Return a path as a program that every language can write. Raises InvalidInput where none can."""
    motion = path.reference
    # groups without a closed form by single steps, of which a text takes as many as it needs
    recorded = RecordedPath.of(replace(path.variant(frozenset()).mechanism.recording, steps=0), path.outputs)
    title, mechanism = motion.mechanism.title, recorded.mechanism
    if motion.shape[:-1]:
        what = "its dimensions are arrays, and a text is of one mechanism"
        raise InvalidInput(Problem(title, what, "give one number for each"))
    _of_one_configuration(motion)
    wanted = {n for nodes in recorded.nodes for n in nodes} | {_assembled(mechanism, ())}
    states = carried_states(mechanism, wanted)
    assembled, called = _assembled(mechanism, states), _called(mechanism)
    after = followed(mechanism.graph, states, {*wanted, assembled, *called})
    results = (*_outputs(path, recorded), *(_next(one) for one in states))
    names = Identifiers()
    return WrittenProgram(
        identifier(name or title).lower(),
        title,
        mechanism.graph,
        tuple(_arguments(path, mechanism, states)),
        tuple(replace(one, node=after[one.node], name=names.take(one.name)) for one in results),
        after[assembled],
        tuple(notes(motion, mechanism.recording.order, bool(states))),
        {after[k]: word for k, word in called.items()},
    )


def _assembled(mechanism: RecordedMechanism, states: Sequence[CarriedState]) -> int:
    """The node of whether all groups close, and states are followed."""
    goods = (mechanism.number(good) for _, good in mechanism.block.goods)
    kept = (state.kept for state in states if state.kept is not None)
    return reduce(RecordedNumber.__and__, (*goods, *kept), mechanism.number(True)).x


def _of_one_configuration(motion: Motion) -> None:
    """Raise InvalidInput where a group changes its mode along the motion."""
    links = changed_modes(motion)
    if links:
        what = "it passes a change point and goes on in its other mode, and a text keeps one"
        raise InvalidInput(Problem(", ".join(links), what, "compile it with values that lie between two change points"))


def _arguments(path: PathVariants, mechanism: RecordedMechanism, states: Sequence[CarriedState]) -> Iterator[Argument]:
    """Yield drivers with their rates, free dimensions, and states; the motion's first assembled pose is their own."""
    names, motion = Identifiers(), path.reference
    first = int(np.argmax(motion.failed[0] == 0))
    for name in mechanism.drives:
        dimension = coordinate_dimension(motion.structure.driven_angles[name])
        for k in range(mechanism.recording.order + 1):
            given = InputNumber(DRIVE, name, str(k))
            called = f"{name}.{RATES[k - 1]}" if k else name
            meaning = f"driver {name}, its {RATES[k - 1]}" if k else f"driver {name}"
            values = np.broadcast_to(motion.inputs.drives[name][k], motion.failed.shape)
            unit, start = unit_of(motion.mechanism.unit, dimension, k), float(values[0, first])
            yield Argument(given, names.take(called), meaning, unit, start if k else None, start)
    for one in (each for each in path.dimensions if not each.is_of_law):
        for given, number in one.parts_of(path.stated.own(one)):
            word, value = given.full_name, float(number)
            yield Argument(given, names.take(word), f"dimension {word}", path.stated.unit(one), value, value)
    seeds = seed_values([state.given for state in states if state.given.part != SIDE], motion)
    for state in states:
        value = float(seeds[state.given][0, first]) if state.given in seeds else 0.0
        told = _next(state)
        yield Argument(state.given, names.take(told.name), f"{state.meaning}, before", told.unit, value, value)


def _next(state: CarriedState) -> Result:
    """A state as a result."""
    unit = unit_of("", "angle") if state.is_angle else ""
    return Result(state.now.x, f"state.{state.name}", state.meaning, unit)


def _outputs(path: PathVariants, recorded: RecordedPath) -> Iterator[Result]:
    motion = RecordedMotion(recorded.mechanism)
    for output, nodes in zip(path.outputs, recorded.nodes, strict=True):
        unit, turns = quantity(motion, output.name).unit, ", from -pi to pi" if output.is_wrapped else ""
        parts = ("x", "y") if len(nodes) > 1 else ("",)
        for node, part in zip(nodes, parts, strict=True):
            word = f"{output.name}.{part}" if part else output.name
            yield Result(node, word, f"{word}{turns}", unit)


def _called(mechanism: RecordedMechanism) -> Mapping[int, str]:
    """What points and links have, by nodes: names for values on the way."""
    found, nodes = dict[int, str](), mechanism.graph.nodes
    for name, number in _known(mechanism):
        k, word = number.x, name
        if nodes[k].operation == "neg":
            k, word = nodes[k].operands[0], f"minus_{name}"
        found.setdefault(k, word)
    return found


def _known(mechanism: RecordedMechanism) -> Iterator[tuple[str, RecordedNumber]]:
    """Yield the direction of each link, and what each point has, with names."""
    for link, pose in mechanism.block.world.items():
        u = mechanism.number(pose.u.c[0])
        yield from ((f"cos_{link}", u.real), (f"sin_{link}", u.imag))
    for point, found in RecordedMotion(mechanism).points.items():
        for k, word in enumerate(OF_POINTS[: mechanism.recording.order + 1]):
            name, place = f"{point}_{word}" if k else point, mechanism.number(found.derivative(k))
            yield from ((f"{name}_x", place.real), (f"{name}_y", place.imag))
