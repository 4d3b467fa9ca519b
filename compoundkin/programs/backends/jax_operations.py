"""Graphs evaluated by jax.numpy: pure functions, whose gradients are numbers wherever their results are.

A number goes with a truth: whether it is one. Where it is none (a root of a negative number, a quotient by zero, a
group that does not close) another number stands in for it, so that no derivative meets infinity; results are masked
last. JAX is asked for nothing that changes its settings: numbers have the precision that it gives them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from math import isnan
from typing import Any, NamedTuple

from compoundkin.programs.graph.operation_graph import OperationGraph
from compoundkin.programs.graph.operations import CONSTANT, INPUT, OPERATIONS, REDUCTIONS, TOTAL


class GuardedNumber(NamedTuple):
    """A number or a truth, and whether it is one at all."""

    value: Any
    is_there: Any = True


def evaluated(graph: OperationGraph, wanted: Sequence[int], given: Mapping[int, Any]) -> list[Any]:
    """Return some nodes as JAX arrays. The inputs' arrays broadcast; their last axis is the motion."""
    import jax.numpy as jnp

    arrays = {k: _real(jnp, array) for k, array in given.items()}
    shape = jnp.broadcast_shapes(*(array.shape for array in arrays.values()))
    found: dict[int, GuardedNumber] = {}
    for k in graph.needed(wanted):
        node = graph.nodes[k]
        operands = [found[n] for n in node.operands]
        if node.operation == INPUT:
            found[k] = GuardedNumber(arrays[k])
        elif node.operation == CONSTANT:
            found[k] = GuardedNumber(0.0, False) if isnan(node.value) else GuardedNumber(node.value)
        elif node.operation in REDUCTIONS:
            found[k] = _reduced(jnp, node.operation, operands[0], shape)
        else:
            found[k] = RULES[node.operation](jnp, *operands)
    return [_masked(jnp, found[k]) for k in wanted]


def _real(jnp: Any, array: Any) -> Any:
    """Return an array of floating-point numbers, at the precision that JAX gives them."""
    found = jnp.asarray(array)
    return found if jnp.issubdtype(found.dtype, jnp.floating) else found.astype(float)


def _masked(jnp: Any, one: GuardedNumber) -> Any:
    value = jnp.asarray(_number(jnp, one.value))
    return value if one.is_there is True else jnp.where(one.is_there, value, jnp.nan)


def _number(jnp: Any, value: Any) -> Any:
    """Return a truth as 0.0 or 1.0, of the precision of what it meets."""
    return jnp.where(value, 1.0, 0.0) if jnp.asarray(value).dtype == bool else value


def _both(jnp: Any, one: Any, other: Any) -> Any:
    if one is True or other is False:
        return other
    return one if other is True or one is False else jnp.logical_and(one, other)


def _plain(name: str, jnp: Any, *operands: GuardedNumber) -> GuardedNumber:
    """Apply a function that is smooth wherever it is defined, or has one slope at each side."""
    value = getattr(jnp, name)(*(_number(jnp, one.value) for one in operands))
    return GuardedNumber(value, reduce(partial(_both, jnp), (one.is_there for one in operands)))


def _told(name: str, jnp: Any, one: GuardedNumber, other: GuardedNumber) -> GuardedNumber:
    """Compare two numbers; nothing is told of what is no number."""
    told = getattr(jnp, name)(_number(jnp, one.value), _number(jnp, other.value))
    return GuardedNumber(_both(jnp, told, _both(jnp, one.is_there, other.is_there)))


def _logical(name: str, jnp: Any, *operands: GuardedNumber) -> GuardedNumber:
    return GuardedNumber(getattr(jnp, name)(*(one.value for one in operands)))


def _inv(jnp: Any, x: GuardedNumber) -> GuardedNumber:
    value = _number(jnp, x.value)
    there = _both(jnp, value != 0.0, x.is_there)
    return GuardedNumber(1.0 / jnp.where(there, value, 1.0), there)


def _sqrt(jnp: Any, x: GuardedNumber) -> GuardedNumber:
    value = _number(jnp, x.value)
    smooth = value > 0.0
    root = jnp.where(smooth, jnp.sqrt(jnp.where(smooth, value, 1.0)), 0.0)
    return GuardedNumber(root, _both(jnp, value >= 0.0, x.is_there))


def _log(jnp: Any, x: GuardedNumber) -> GuardedNumber:
    value = _number(jnp, x.value)
    there = _both(jnp, value > 0.0, x.is_there)
    return GuardedNumber(jnp.log(jnp.where(there, value, 1.0)), there)


def _atan2(jnp: Any, y: GuardedNumber, x: GuardedNumber) -> GuardedNumber:
    away = jnp.logical_or(y.value != 0.0, x.value != 0.0)
    angle = jnp.arctan2(jnp.where(away, y.value, 0.0), jnp.where(away, x.value, 1.0))
    return GuardedNumber(angle, _both(jnp, y.is_there, x.is_there))


def _extreme(name: str, jnp: Any, one: GuardedNumber, other: GuardedNumber) -> GuardedNumber:
    """Return the greater or the lesser of two, of which one may be no number."""
    a = jnp.where(one.is_there, _number(jnp, one.value), _number(jnp, other.value))
    b = jnp.where(other.is_there, _number(jnp, other.value), a)
    always = one.is_there is True or other.is_there is True
    return GuardedNumber(getattr(jnp, name)(a, b), True if always else jnp.logical_or(one.is_there, other.is_there))


def _select(jnp: Any, truth: GuardedNumber, one: GuardedNumber, other: GuardedNumber) -> GuardedNumber:
    value = jnp.where(truth.value, _number(jnp, one.value), _number(jnp, other.value))
    always = one.is_there is True and other.is_there is True
    return GuardedNumber(value, True if always else jnp.where(truth.value, one.is_there, other.is_there))


def _reduced(jnp: Any, operation: str, one: GuardedNumber, shape: tuple[int, ...]) -> GuardedNumber:
    """Reduce over the last axis; one pose that is no number makes the whole none."""
    whole, there = jnp.broadcast_to(_number(jnp, one.value), shape), jnp.broadcast_to(one.is_there, shape)
    whole = jnp.where(there, whole, 0.0)
    if not shape:
        return GuardedNumber(whole, there)
    value = (jnp.sum if operation == TOTAL else jnp.min)(whole, axis=-1, keepdims=True)
    return GuardedNumber(value, jnp.all(there, axis=-1, keepdims=True))


RULES: dict[str, Callable[..., GuardedNumber]] = {
    **{name: partial(_plain, one.compute.__name__) for name, one in OPERATIONS.items() if not one.is_truth},
    "abs": partial(_plain, "abs"),
    **{name: partial(_told, OPERATIONS[name].compute.__name__) for name in ("ge", "gt", "eq")},
    **{name: partial(_logical, OPERATIONS[name].compute.__name__) for name in ("and", "or", "not")},
    "fmax": partial(_extreme, "maximum"),
    "fmin": partial(_extreme, "minimum"),
    "inv": _inv,
    "sqrt": _sqrt,
    "log": _log,
    "atan2": _atan2,
    "select": _select,
}
