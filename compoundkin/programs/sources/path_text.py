"""A compiled path as a function in other languages: its arguments and results, what they mean, and its notes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.suffixes import Kind
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import OF_POINTS, RATES, coordinate_dimension, unit_of
from compoundkin.programs.graph.operation_graph import DRIVE, SIDE, InputNumber
from compoundkin.programs.recorded_path import PathVariants, RecordedPath
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_motion import RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.solved_designs import seed_values
from compoundkin.programs.sources import LANGUAGES
from compoundkin.programs.sources.fixed_configuration import (
    CarriedState,
    carried_states,
    changed_modes,
    configuration_notes,
    follow_states,
)
from compoundkin.programs.sources.statements import Identifiers, identifier
from compoundkin.programs.sources.written_program import Argument, Result, WrittenProgram


class WritesSources:
    """A path of a mechanism that writes itself in other languages."""

    saved_as: ClassVar[Kind] = "program"
    programs: PathVariants

    @checked
    def source(self, language: str, name: str = "") -> str:
        """Return it as a function in another language: "c", "python", "javascript" or "matlab".

        It needs nothing else. `name` is what the function is called. Raises UnknownName for other languages, and
        InvalidInput for what no text can compute, such as a mechanism that passes change points.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.model.mechanism import Mechanism
        >>> from compoundkin.programs.compiled_path import compile
        >>> crank = Mechanism("A crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> "out->B_position_x = B_x;" in compile(crank, "B.position").source("c")
        True
        """
        if language not in LANGUAGES:
            raise UnknownName(
                Problem("language", f"{language!r} is none of them", suggestion(language, list(LANGUAGES)))
            )
        return LANGUAGES[language].text(self.written(name))

    def written(self, name: str = "") -> WrittenProgram:
        """Return what all languages write."""
        return program_of_path(self.programs, name)

    def content(self, form: str) -> bytes:
        """Return the file of a function in a language, for `save`."""
        return self.source(form).encode("utf-8")


def program_of_path(path: PathVariants, name: str = "") -> WrittenProgram:
    """Return a path as a program that every language can write. Raises InvalidInput where none can."""
    motion = path.reference
    # groups without a closed form by single steps, of which a text takes as many as it needs
    recorded = RecordedPath.of(replace(path.variant(frozenset()).mechanism.recording, steps=0), path.outputs)
    title, mechanism = motion.mechanism.title, recorded.mechanism
    if motion.shape[:-1]:
        what = "its dimensions are arrays, and a text is of one mechanism"
        raise InvalidInput(Problem(title, what, "give one number for each"))
    _check_one_configuration(motion)
    wanted = {n for nodes in recorded.nodes for n in nodes} | {_assembled_node(mechanism, ())}
    states = carried_states(mechanism, wanted)
    assembled, called = _assembled_node(mechanism, states), _node_names(mechanism)
    after = follow_states(mechanism.graph, states, {*wanted, assembled, *called})
    results = (*_outputs(path, recorded), *(_state_result(one) for one in states))
    names = Identifiers()
    return WrittenProgram(
        identifier(name or title).lower(),
        title,
        mechanism.graph,
        tuple(_arguments(path, mechanism, states)),
        tuple(replace(one, node=after[one.node], name=names.take(one.name)) for one in results),
        after[assembled],
        tuple(configuration_notes(motion, mechanism.recording.order, bool(states))),
        {after[k]: word for k, word in called.items()},
    )


def _assembled_node(mechanism: RecordedMechanism, states: Sequence[CarriedState]) -> int:
    """The node of whether all groups close, and states are followed."""
    goods = (mechanism.number(good) for _, good in mechanism.block.goods)
    kept = (state.kept for state in states if state.kept is not None)
    return reduce(RecordedNumber.__and__, (*goods, *kept), mechanism.number(True)).x


def _check_one_configuration(motion: Motion) -> None:
    """Raise InvalidInput where a group changes its mode along the motion."""
    if changed := changed_modes(motion):
        what = "it passes a change point and goes on in its other mode, and a text keeps one"
        links = ", ".join(changed[0].group.links)
        raise InvalidInput(Problem(links, what, "compile it with values that lie between two change points"))


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
    for one in (each for each in path.dimensions if each.is_read):
        for given, number in one.parts_of(path.stated.own(one)):
            word, value = given.full_name, float(number)
            yield Argument(given, names.take(word), f"dimension {word}", path.stated.unit(one), value, value)
    seeds = seed_values([state.given for state in states if state.given.part != SIDE], motion)
    for state in states:
        value = float(seeds[state.given][0, first]) if state.given in seeds else 0.0
        told = _state_result(state)
        yield Argument(state.given, names.take(told.name), f"{state.meaning}, before", told.unit, value, value)


def _state_result(state: CarriedState) -> Result:
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


def _node_names(mechanism: RecordedMechanism) -> Mapping[int, str]:
    """What points and links have, by nodes: names for values on the way."""
    found, nodes = dict[int, str](), mechanism.graph.nodes
    for name, number in _named_numbers(mechanism):
        k, word = number.x, name
        if nodes[k].operation == "neg":
            k, word = nodes[k].operands[0], f"minus_{name}"
        found.setdefault(k, word)
    return found


def _named_numbers(mechanism: RecordedMechanism) -> Iterator[tuple[str, RecordedNumber]]:
    """Yield the direction of each link, and what each point has, with names."""
    for link, pose in mechanism.block.world.items():
        u = mechanism.number(pose.u.c[0])
        yield from ((f"cos_{link}", u.real), (f"sin_{link}", u.imag))
    for point, found in RecordedMotion(mechanism).points.items():
        for k, word in enumerate(OF_POINTS[: mechanism.recording.order + 1]):
            name, place = f"{point}_{word}" if k else point, mechanism.number(found.derivative(k))
            yield from ((f"{name}_x", place.real), (f"{name}_y", place.imag))
