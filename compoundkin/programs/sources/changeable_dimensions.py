"""Dimensions that may be changed one by one: such a mechanism can be built, and no redundant pair opens."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from compoundkin.base.errors import InvalidMechanism
from compoundkin.base.series import Number
from compoundkin.kinematics.solving_order import residual
from compoundkin.programs.calls.seed_values import seed_values
from compoundkin.programs.dimensions.designed_mechanism import designed
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import CONSTANT, INPUT, OPERATIONS
from compoundkin.programs.sources.page_program import PageProgram

# By which part of the size, or of itself, a dimension is changed: what opens in the second order opens by 1e-4, and no
# number of teeth becomes another one.
CHANGE = 0.0217
# Redundant pairs that open by less (in parts of the size, or radians) stay closed.
OPEN = 1e-6
# Poses at which they are looked at, and Newton's steps of groups without a closed form.
POSES, STEPS = 5, 8


def changeable_dimensions(
    program: PageProgram, stated: StatedDimensions, dimensions: Sequence[FreeDimension]
) -> tuple[FreeDimension, ...]:
    """Return the dimensions of a program of which each may be changed alone.

    Numbers of teeth may not, nor the axes of wheels of a given module, nor what an overconstrained mechanism hangs on.
    """
    found = tuple(_buildable(stated, dimensions))
    return tuple(_consistent(program, stated, found)) if program.motion.structure.redundant and found else found


def _changed(stated: StatedDimensions, one: FreeDimension, part: float) -> float:
    own = float(np.ravel(stated.own(one))[0])
    return own + CHANGE * part * (stated.mechanism.geometry.size if one.is_of_link else abs(own) or 1.0)


def _buildable(stated: StatedDimensions, dimensions: Sequence[FreeDimension]) -> Iterator[FreeDimension]:
    """Yield those that can be changed; where all can together, by different parts, each can alone."""
    if not dimensions or _can_be_built(stated, dimensions):
        yield from dimensions
    elif len(dimensions) > 1:
        half = len(dimensions) // 2
        yield from _buildable(stated, dimensions[:half])
        yield from _buildable(stated, dimensions[half:])


def _can_be_built(stated: StatedDimensions, dimensions: Sequence[FreeDimension]) -> bool:
    parts = {one: 1.0 + k / len(dimensions) for k, one in enumerate(dimensions)}
    try:
        designed(stated, {one: _changed(stated, one, part) for one, part in parts.items()})
    except InvalidMechanism:
        return False
    return True


def _consistent(
    program: PageProgram, stated: StatedDimensions, dimensions: Sequence[FreeDimension]
) -> Iterator[FreeDimension]:
    """Yield those whose change opens no redundant pair, whether it is assembled elsewhere or not."""
    mechanism = program.mechanism
    pairs = program.motion.structure.redundant
    opened = mechanism.number(residual(pairs, mechanism.block, mechanism.order.size)).x
    given = dict(_given(program, stated, dimensions))
    states = program.carried[0]
    for _ in range(STEPS if states else 0):
        now = _values(mechanism.graph, [one.now.x for one in states], given)
        given |= {one.given: value for one, value in zip(states, now, strict=True)}
    (found,) = _values(mechanism.graph, [opened], given)
    rows = np.broadcast_to(found, (len(dimensions), np.shape(found)[-1] if np.ndim(found) else 1))
    for one, row in zip(dimensions, rows, strict=True):
        if np.any(row <= OPEN**2) and not np.any(row > OPEN**2):
            yield one


def _given(
    program: PageProgram, stated: StatedDimensions, dimensions: Sequence[FreeDimension]
) -> Iterator[tuple[InputNumber, Number]]:
    """Yield inputs over (designs, poses): each design has one dimension changed."""
    motion = program.motion
    known = np.flatnonzero(motion.failed[0] == 0)
    at = known[np.linspace(0, len(known) - 1, POSES).round().astype(int)]
    for one in program.dimensions:
        own, changed = np.ravel(stated.own(one))[0], _changed(stated, one, 1.0)
        yield one.inputs[0], np.array([[changed if one == other else own] for other in dimensions])
    for given in program.drives:
        values = motion.inputs.drives[given.name][int(given.part)]
        yield given, np.broadcast_to(values, motion.failed.shape)[:, at]
    for given, values in seed_values(program.seeds, motion).items():
        yield given, values[:, at]


def _values(graph: OperationGraph, wanted: Sequence[int], given: Mapping[InputNumber, Number]) -> list[Number]:
    """Return the values of some nodes, which broadcast with those given."""
    found: dict[int, Number] = {}
    with np.errstate(all="ignore"):
        for k in graph.needed(wanted):
            node = graph.nodes[k]
            if node.operation == INPUT:
                assert node.given is not None
                found[k] = given[node.given]
            elif node.operation == CONSTANT:
                found[k] = np.float64(node.value)
            else:
                found[k] = OPERATIONS[node.operation].compute(*(found[n] for n in node.operands))
    return [found[k] for k in wanted]
