"""Numbers given to a path under JAX: what is traced is taken as it is, other things are held to be numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.given_numbers import real_numbers
from compoundkin.model.geometry import vector
from compoundkin.programs.graph.operation_graph import InputNumber


def held(where: str, value: Any, is_vector: bool = False) -> Any:
    """Return a value as it is, if it can be one. Points may be pairs."""
    import jax

    if isinstance(value, jax.Array):
        if jax.numpy.iscomplexobj(value) and not is_vector:
            raise InvalidInput(Problem(where, "complex numbers are no real ones", "take their .real"))
        return value
    if type(value) in (int, float) or (is_vector and type(value) is complex):
        return value  # it takes the precision of others
    if not is_vector:
        return real_numbers(where, value)
    if isinstance(value, tuple | list) and len(value) == 2 and any(isinstance(part, jax.Array) for part in value):
        return value[0] + 1j * value[1]
    return vector(where, value)


def common_shape(given: Mapping[InputNumber, Any]) -> tuple[int, ...]:
    """Return the shape to which all broadcast; raises InvalidInput where there is none."""
    shapes = {one: np.shape(value) for one, value in given.items()}
    try:
        shape = np.broadcast_shapes(*shapes.values())
    except ValueError:
        told = ", ".join(dict.fromkeys(f"{one.name} {shape}" for one, shape in shapes.items() if shape))
        raise InvalidInput(Problem("shapes", f"{told} do not broadcast", "the last axis is the motion")) from None
    if 0 in shape:
        raise InvalidInput(Problem("shapes", "there are no poses, or no designs"))
    return shape
