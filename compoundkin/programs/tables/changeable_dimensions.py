"""Dimensions that may be changed one by one: such a mechanism can be built, and no redundant pair opens."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.base.errors import InvalidMechanism
from compoundkin.base.series import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import residual
from compoundkin.programs.calls.seed_values import seed_values
from compoundkin.programs.dimensions.designed_mechanism import designed
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.graph.input_kinds import DRIVE
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism
from compoundkin.programs.sources.carried_states import CarriedState
from compoundkin.programs.tables.node_values import node_values

# By which part of the size, or of itself, a dimension is changed: what opens in the second order opens by 1e-4, and no
# number of teeth becomes another one.
CHANGE = 0.0217
# Redundant pairs that open by less (in parts of the size, or radians) stay closed.
OPEN = 1e-6
# Poses at which they are looked at, and Newton's steps of groups without a closed form.
POSES, STEPS = 5, 8


def buildable_dimensions(stated: StatedDimensions, dimensions: Sequence[FreeDimension]) -> tuple[FreeDimension, ...]:
    """Return the dimensions of which each may be changed alone.

    Numbers of teeth may not, nor the axes of wheels of a given module.
    """
    size = stated.mechanism.geometry.size
    return tuple(_buildable(stated, [(one, _changed(stated, one, size)) for one in dimensions]))


def _changed(stated: StatedDimensions, one: FreeDimension, size: float) -> tuple[float, float]:
    """Return the own value of a dimension, and by how much it is changed."""
    own = float(np.ravel(stated.own(one))[0])
    return own, CHANGE * (size if one.is_of_link else abs(own) or 1.0)


def _buildable(
    stated: StatedDimensions, changes: Sequence[tuple[FreeDimension, tuple[float, float]]]
) -> Iterator[FreeDimension]:
    """Yield those that can be changed; where all can together, by different parts, each can alone."""
    parts = ((one, own + change * (1.0 + k / len(changes))) for k, (one, (own, change)) in enumerate(changes))
    try:
        designed(stated, dict(parts))
    except InvalidMechanism:
        if len(changes) > 1:
            half = len(changes) // 2
            yield from _buildable(stated, changes[:half])
            yield from _buildable(stated, changes[half:])
    else:
        yield from (one for one, _ in changes)


def consistent_dimensions(
    motion: Motion,
    mechanism: RecordedMechanism,
    states: Sequence[CarriedState],
    stated: StatedDimensions,
    dimensions: Sequence[FreeDimension],
) -> tuple[FreeDimension, ...]:
    """Return those whose change opens no redundant pair at any pose.

    All are inputs of the recorded mechanism, whose groups without a closed form have `states`.
    """
    pairs = motion.structure.redundant
    if not pairs or not dimensions:
        return tuple(dimensions)
    opened = mechanism.number(residual(pairs, mechanism.block, mechanism.order.size)).x
    given = dict(_given(motion, mechanism, stated, dimensions))
    given |= _own_states(motion, states)
    for _ in range(STEPS if states else 0):
        now = node_values(mechanism.graph, [one.now.x for one in states], given)
        given |= {one.given: value for one, value in zip(states, now, strict=True)}
    (found,) = node_values(mechanism.graph, [opened], given)
    rows = np.broadcast_to(found, (len(dimensions), np.shape(found)[-1] if np.ndim(found) else 1))
    stays = np.any(rows <= OPEN**2, axis=1) & ~np.any(rows > OPEN**2, axis=1)
    return tuple(one for one, good in zip(dimensions, stays, strict=True) if good)


def _looked_at(motion: Motion) -> Number:
    """Return the indices of some poses that are assembled."""
    known = np.flatnonzero(motion.failed[0] == 0)
    return known[np.linspace(0, len(known) - 1, POSES).round().astype(int)]


def _own_states(motion: Motion, states: Sequence[CarriedState]) -> dict[InputNumber, Number]:
    own, at = seed_values([one.given for one in states], motion), _looked_at(motion)
    return {given: values[:, at] for given, values in own.items()}


def _given(
    motion: Motion, mechanism: RecordedMechanism, stated: StatedDimensions, dimensions: Sequence[FreeDimension]
) -> Iterator[tuple[InputNumber, Number]]:
    """Yield inputs over (designs, poses): each design has one dimension changed."""
    at, size = _looked_at(motion), motion.size
    for one in mechanism.recording.free:
        own, change = _changed(stated, one, size)
        yield one.inputs[0], np.array([[own + change * (one == other)] for other in dimensions])
    for name, values in motion.inputs.drives.items():
        for k, value in enumerate(values):
            yield InputNumber(DRIVE, name, str(k)), np.broadcast_to(value, motion.failed.shape)[:, at]
