"""A compiled path as a text: which numbers it is given and answers, what they mean, and what is told of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import reduce
from typing import Any, Protocol

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import OF_POINTS, RATES, coordinate_dimension, unit_of
from compoundkin.programs.call_numbers import CallNumbers
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.ready_program import RecordedPath
from compoundkin.programs.recording.input_kinds import DRIVE, SEED, TURNS
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.recording.recorded_motion import RecordedMotion
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.recording.recorded_outputs import ProgramOutput
from compoundkin.programs.sources.contract import Argument, Result, WrittenProgram
from compoundkin.programs.sources.identifiers import Identifiers, identifier
from compoundkin.programs.sources.told_configuration import notes


class PathToWrite(Protocol):
    """What is asked of a compiled path to write it."""

    reference: Motion
    outputs: tuple[ProgramOutput, ...]
    dimensions: tuple[FreeDimension, ...]

    @property
    def stated(self) -> StatedDimensions:
        """All dimensions of its mechanism."""

    def numbers(self, values: Any, dimensions: Any, speed: Any, acceleration: Any, jerk: Any) -> CallNumbers:
        """Return the numbers of a call."""

    def variant(self, still: frozenset[tuple[str, int]]) -> RecordedPath:
        """Return it recorded where some rates of drivers are zero."""


def written_program(path: PathToWrite, name: str = "") -> WrittenProgram:
    """Return a path as a program that every language can write. Raises InvalidInput where none can."""
    motion, recorded = path.reference, path.variant(frozenset())
    title, mechanism = motion.mechanism.title, recorded.mechanism
    if motion.shape[:-1]:
        what = "its dimensions are arrays, and a text is of one mechanism"
        raise InvalidInput(Problem(title, what, "give one number for each"))
    _of_one_configuration(motion)
    goods = (mechanism.number(good) for _, good in mechanism.block.goods)
    assembled = reduce(RecordedNumber.__and__, goods, mechanism.number(True)).x
    return WrittenProgram(
        identifier(name or title).lower(),
        title,
        mechanism.graph,
        tuple(_arguments(path, mechanism, (assembled, *(n for nodes in recorded.nodes for n in nodes)))),
        tuple(_results(path, recorded)),
        assembled,
        tuple(notes(motion, mechanism.recording.order)),
        _called(mechanism),
    )


def _of_one_configuration(motion: Motion) -> None:
    """Raise InvalidInput where a group changes its mode along the motion."""
    places = np.arange(motion.shape[-1], dtype=float)[None, :]
    for solver in motion.solving_order.solvers:
        if not solver.is_numbered and np.ptp(motion.tracker.sign(solver.index, np.array([[0]]), places)):
            where = ", ".join(solver.group.links)
            what = "it passes a change point and goes on in its other mode, and a text keeps one"
            raise InvalidInput(Problem(where, what, "compile it with values that lie between two change points"))


def _arguments(path: PathToWrite, mechanism: RecordedMechanism, wanted: tuple[int, ...]) -> Iterator[Argument]:
    """Yield drivers with their rates, free dimensions, and what is found outside."""
    names, own = Identifiers(), path.numbers(None, None, None, None, None).given
    drivers, graph = path.reference.structure.driven_angles, mechanism.graph
    unit = path.reference.mechanism.unit
    for name in mechanism.drives:
        for k in range(mechanism.recording.order + 1):
            given = InputNumber(DRIVE, name, str(k))
            called = f"{name}.{RATES[k - 1]}" if k else name
            meaning = f"driver {name}, its {RATES[k - 1]}" if k else f"driver {name}"
            value = float(own[given].flat[0]) if k else None
            told = unit_of(unit, coordinate_dimension(drivers[name]), k)
            yield Argument(given, names.take(called), meaning, told, value)
    for one in path.dimensions:
        for given in one.inputs:
            word = f"{given.name}.{given.part}" if given.part else given.name
            value = float(own[given].flat[0])
            yield Argument(given, names.take(word), f"dimension {word}", path.stated.unit(one), value)
    for k in graph.inputs(wanted):
        seed = graph.nodes[k].given
        if seed is not None and seed.kind == SEED:
            yield _outside(seed, names)


def _outside(one: InputNumber, names: Identifiers) -> Argument:
    """What is found outside: the angle about which a link has one that is counted over full turns."""
    if one.part != TURNS:
        what = "no text can find it: it is followed from pose to pose"
        raise InvalidInput(Problem(one.name, what, "solve the mechanism, or call the compiled path"))
    meaning = f"about which angle {one.name} has, within half a turn: that of the pose before"
    return Argument(one, names.take(f"{one.name}.before"), meaning, unit_of("", "angle"))


def _results(path: PathToWrite, recorded: RecordedPath) -> Iterator[Result]:
    names, motion = Identifiers(), RecordedMotion(recorded.mechanism)
    for output, nodes in zip(path.outputs, recorded.nodes, strict=True):
        unit, turns = quantity(motion, output.name).unit, ", from -pi to pi" if output.is_wrapped else ""
        parts = ("x", "y") if len(nodes) > 1 else ("",)
        for node, part in zip(nodes, parts, strict=True):
            word = f"{output.name}.{part}" if part else output.name
            yield Result(node, names.take(word), f"{word}{turns}", unit)


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
