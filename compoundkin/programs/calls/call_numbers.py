"""The numbers of one call: drivers' values and rates, free dimensions, as inputs of a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.driver_values import RATES, by_name, inputs, times_of
from compoundkin.kinematics.inputs import Inputs, fit
from compoundkin.kinematics.likely_slips import warn_of_degrees
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.elements import Drive
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.moved_drives import moved_by_call
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, FlatProgram
from compoundkin.programs.graph.input_kinds import DRIVE, SEED, STEP
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import INPUT


@dataclass(frozen=True)
class CallNumbers:
    """The inputs of a call by what they are.

    Each is a float array (1 or designs, 1 or poses); `shape` is that of the call's arrays.
    """

    given: Mapping[InputNumber, Number]
    shape: tuple[int, ...]
    still: frozenset[tuple[str, int]]

    @property
    def extent(self) -> tuple[int, int]:
        """Designs x poses."""
        return prod(self.shape[:-1]), self.shape[-1] if self.shape else 1

    @property
    def form(self) -> Any:
        """What a program depends on: which rates are zero, and how each input varies."""
        return self.still, self.marches, tuple(_stratum(array) for array in self.given.values())

    @property
    def marches(self) -> bool:
        """Whether states are carried along the motion: the drivers' steps are told."""
        return any(one.part == STEP for one in self.given)

    @property
    def is_seeded(self) -> bool:
        """Whether something of it was found by solving."""
        return any(one.kind == SEED for one in self.given)

    @property
    def driver_values(self) -> dict[str, Number]:
        """The drivers' values, without rates, by name."""
        return {one.name: value for one, value in self.given.items() if (one.kind, one.part) == (DRIVE, "0")}

    def strata(self, graph: OperationGraph) -> dict[InputNumber, int]:
        """Return how each input varies; what is found outside varies by both."""
        known = {given: _stratum(array) for given, array in self.given.items()}
        every = (node.given for node in graph.nodes if node.operation == INPUT and node.given)
        return {given: known.get(given, BY_DESIGN | BY_POSE) for given in every}

    def reshaped(self, shape: tuple[int, ...]) -> CallNumbers:
        """Return the same numbers in a shape with which theirs broadcasts."""
        if shape == self.shape:
            return self
        fitted = fit(shape)

        def formed(array: Number) -> Number:
            own = self.shape[:-1] if array.shape[0] > 1 else (1,) * len(self.shape[:-1])
            return np.atleast_2d(fitted(array.reshape(*own, array.shape[1])))

        return replace(self, given={given: formed(array) for given, array in self.given.items()}, shape=shape)

    def arrays(self, flat: FlatProgram) -> list[Any]:
        """Return the arrays that a program reads."""
        begun = {one.given for one in flat.carried}
        return [None if k in begun else self.given[flat.graph.nodes[k].given] for k in flat.inputs]  # type: ignore[index]


def _stratum(array: Number) -> int:
    return (BY_DESIGN if array.shape[0] > 1 else 0) | (BY_POSE if array.shape[1] > 1 else 0)


class DriverNumbers(NamedTuple):
    """What a call says of the drivers; the highest rate asked for."""

    values: Any
    speed: Any = None
    acceleration: Any = None
    jerk: Any = None
    time: Any = None
    order: int = RATES - 1

    def times(self, order: SolvingOrder, drives: Sequence[Drive] | None = None) -> Number | None:
        """Return the times of the motion; None where values are given."""
        mechanism = order.structure.mechanism
        return times_of(mechanism, by_name(mechanism, self.values), self.time, drives)

    def inputs(self, order: SolvingOrder, drives: Sequence[Drive] | None = None) -> Inputs:
        """Return them as `solve` does; raises InvalidInput for what does not fit.

        `drives` are others in the place of the mechanism's own.
        """
        values = by_name(order.structure.mechanism, self.values)
        times = self.times(order, drives)
        # laws that jump tell their corners at rates that are asked for only
        found = inputs(order, values, self.speed, self.acceleration, self.jerk, times, self.order, drives)
        if times is None:
            warn_of_degrees(order.structure, found)
        return found


def call_numbers(order: SolvingOrder, motion: DriverNumbers, dimensions: Mapping[FreeDimension, Number]) -> CallNumbers:
    """Return the numbers of a call; raises InvalidInput for what does not fit."""
    moving = {one.owner for one in dimensions if one.is_of_law}
    driven = motion.inputs(order, moved_by_call(order.structure.mechanism.drives, dimensions) if moving else None)
    shape = driven.shape
    for one, value in dimensions.items():
        shape = _broadcast(shape, np.shape(value), f"dimensions.{one.name}")
    # a rate that a law's number may change is none that is zero
    steady = {name: vs for name, vs in driven.drives.items() if name not in moving}
    still = frozenset((name, k) for name, vs in steady.items() for k, v in enumerate(vs) if k and np.all(v == 0))
    fitted = fit(shape)
    given: dict[InputNumber, Number] = {}
    for one, place in dimensions.items():
        given.update((each, np.array(part, float)) for each, part in one.parts_of(np.atleast_2d(fitted(place))))
    for name, numbers in driven.drives.items():
        for k, value in enumerate(numbers):
            whole = fitted(_unfolded(value, driven.shape))
            given[InputNumber(DRIVE, name, str(k))] = np.atleast_2d(np.array(whole, float))
    return CallNumbers(given, shape, still)


def _unfolded(value: Number, shape: tuple[int, ...]) -> Number:
    """Return a driver's numbers (1 or designs, 1 or poses) in the shape that was given."""
    return value.reshape(*shape[:-1], value.shape[1]) if np.ndim(value) > 1 and value.shape[0] > 1 else value


def _broadcast(shape: tuple[int, ...], other: tuple[int, ...], where: str) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(shape, other)
    except ValueError:
        remedy = "give a new axis to designs: the last axis is the motion"
        raise InvalidInput(Problem(where, f"shape {other} does not broadcast with {shape}", remedy)) from None


def picked(numbers: CallNumbers, designs: Number) -> CallNumbers:
    """Return the numbers of some designs, by index."""
    given = {one: value[designs] if value.shape[0] > 1 else value for one, value in numbers.given.items()}
    return replace(numbers, given=given, shape=(len(designs), numbers.extent[1]))
