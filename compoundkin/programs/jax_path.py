"""A compiled path as a pure function of JAX: traced, mapped over designs and differentiated by its users.

A graph is evaluated on pairs of a number and a truth: whether the number is valid. Where it is not (the root of a
negative number, a quotient by zero, a group that does not close) another number stands in for it, so that no derivative
meets infinity; results are masked last. No setting of JAX is changed: numbers have the precision that JAX gives them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from importlib.util import find_spec
from math import isnan, pi
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, missing_extra, suggestion
from compoundkin.kinematics.driver_values import by_name
from compoundkin.model.attributes import RATES
from compoundkin.model.geometry import vector
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.drawn_approach import driver_spacings
from compoundkin.programs.graph.operation_graph import (
    CONSTANT,
    DRIVE,
    INPUT,
    OPERATIONS,
    REDUCTIONS,
    SEED,
    TOTAL,
    InputNumber,
    OperationGraph,
)
from compoundkin.programs.limit_screening import safe_margin
from compoundkin.programs.recorded_path import PathVariants, RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits

__all__ = ["JaxPath", "continuous_angle", "jax_path"]

ASSEMBLED, CERTAIN = "assembled", "certain"


@dataclass(frozen=True, eq=False, repr=False)
class JaxPath(ShortRepr):
    """The outputs of a compiled path as a pure function. `CompiledPath.jax` makes it.

    It takes the names of the path, `f({"crank": angles}, {"plate.C": places}, speed=10)`, and runs on any device. Its
    numbers have the precision that JAX gives them: seven digits, or sixteen where its user enables 64 bits (`with
    jax.enable_x64():`). The configuration is that of the path everywhere, with fixed signs. Where a group comes near a
    limit or a change point the path looks closer and solves anew; no pure function can, and `"certain"` is False there.
    """

    path: PathVariants

    def __call__(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
    ) -> dict[str, Any]:
        """Return the outputs by their names, "assembled" for each pose, and "certain" for each design.

        Everything broadcasts, the last axis the motion. What is left out has the value of the mechanism.
        """
        import jax.numpy as jnp

        call = Call(values, dimensions, speed, acceleration, jerk)
        drives = self._drives(call)
        given = {**drives, **self._dimensions(call)}
        still = frozenset(
            (one.name, int(one.part)) for one, value in drives.items() if one.part > "0" and _is_known_zero(value)
        )
        path = self.path.variant(still)
        graph, wanted = path.mechanism.graph, _output_nodes(path)
        shape = common_shape(given)
        used = {k: graph.nodes[k].given for k in graph.inputs(wanted)}
        arrays = {k: given[one] for k, one in used.items() if one is not None}
        *values_of_nodes, failed, margin = evaluate_graph(graph, wanted, arrays)
        assembled = jnp.broadcast_to(failed == 0.0, shape)
        parts = iter(jnp.where(assembled, value, jnp.nan) for value in values_of_nodes)
        outputs = {}
        for output, nodes in zip(self.path.outputs, path.nodes, strict=True):
            value = _as_output(tuple(next(parts) for _ in nodes))
            outputs[output.name] = continuous_angle(value) if output.is_wrapped else value
        return {**outputs, ASSEMBLED: assembled, CERTAIN: self._certain(jnp.broadcast_to(margin, shape), drives)}

    def _drives(self, call: Call) -> dict[InputNumber, Any]:
        """Return the drivers' values and rates."""
        mechanism = self.path.reference.mechanism
        drives = {drive.name: drive for drive in mechanism.drives}
        values, *rates = (by_name(mechanism, getattr(call, word)) or {} for word in ("values", *RATES))
        for word, given in zip(("values", *RATES), (values, *rates), strict=True):
            _check_names(word, given, drives)
        inputs = {}
        for name, drive in drives.items():
            value = values.get(name, drive.values)
            if value is None:
                raise InvalidInput(Problem(f"values.{name}", "the driver has no values", f"{{{name!r}: angles}}"))
            inputs[InputNumber(DRIVE, name, "0")] = jax_number(f"values.{name}", value)
            for k, word in enumerate(RATES, 1):
                inputs[InputNumber(DRIVE, name, str(k))] = rates[k - 1].get(name, getattr(drive, word))
        return inputs

    def _dimensions(self, call: Call) -> dict[InputNumber, Any]:
        """Return the free dimensions; those left out have the mechanism's own values."""
        import jax.numpy as jnp

        given, free = call.dimensions or {}, [one for one in self.path.dimensions if one.is_read]
        _check_names("dimensions", given, [one.name for one in free])
        inputs: dict[InputNumber, Any] = {}
        for one in free:
            if one.name in given:
                value = jax_number(f"dimensions.{one.name}", given[one.name], one.is_vector)
            else:
                value = self.path.stated.own(one)
            inputs.update(zip(one.inputs, (jnp.real(value), jnp.imag(value)), strict=False))
        return inputs

    def _certain(self, margin: Any, drives: Mapping[InputNumber, Any]) -> Any:
        """Tell which designs need no near-limit screening, by the bound of `safe_margin`."""
        import jax.numpy as jnp

        if not margin.ndim:
            return margin >= safe_margin(1.0)
        longest, spacing = jnp.ones(()), driver_spacings(self.path.reference.solving_order)
        for one, value in drives.items():
            if one.part == "0" and jnp.ndim(value) and jnp.shape(value)[-1] > 1:
                steps = jnp.max(jnp.abs(jnp.diff(jnp.asarray(value))), axis=-1)
                longest = jnp.maximum(longest, steps / spacing[one.name])
        return jnp.min(margin, axis=-1) >= safe_margin(longest)

    def __repr__(self) -> str:
        return f"JaxPath({', '.join(output.name for output in self.path.outputs)})"


def jax_path(path: PathVariants) -> JaxPath:
    """Return a path as a function of JAX.

    Raises InvalidInput where JAX is not installed, and for inputs that only a search can determine: states of general
    groups, contacts of profiles, counted turns.
    """
    if not find_spec("jax"):
        raise missing_extra("jax", "JAX is not installed", "jax")
    recorded = path.variant(frozenset())
    graph = recorded.mechanism.graph
    given = [graph.nodes[k].given for k in graph.inputs(_output_nodes(recorded))]
    what, remedy = "it needs a search, which is not a pure function", "call the path itself, or its derivatives"
    searched = dict.fromkeys(one.name for one in given if one is not None and one.kind == SEED)
    if searched:
        raise InvalidInput([Problem(name, what, remedy) for name in searched])
    return JaxPath(path)


def _output_nodes(path: RecordedPath) -> list[int]:
    """Return the nodes of the outputs, then those of the group that failed and of the certain margin."""
    limits = RecordedLimits(path.mechanism)
    return [*(node for nodes in path.nodes for node in nodes), limits.failed.x, limits.certain.x]


def _as_output(parts: tuple[Any, ...]) -> Any:
    from jax import lax

    return parts[0] if len(parts) == 1 else lax.complex(*parts)


def continuous_angle(angle: Any) -> Any:
    """Return an angle without jumps along the last axis, across unassembled poses too."""
    import jax.numpy as jnp
    from jax import lax

    if angle.ndim == 0 or angle.shape[-1] < 2:
        return angle
    known = ~jnp.isnan(angle)
    first = jnp.argmax(known, axis=-1, keepdims=True)
    last = lax.cummax(jnp.where(known, jnp.arange(angle.shape[-1]), first), axis=angle.ndim - 1)
    filled = jnp.take_along_axis(lax.stop_gradient(angle), last, axis=-1)
    turns = jnp.cumsum(jnp.rint(jnp.diff(filled) / (2.0 * pi)), axis=-1)
    return angle - 2.0 * pi * jnp.concatenate([jnp.zeros_like(turns[..., :1]), turns], axis=-1)


def _is_known_zero(value: Any) -> bool:
    """Tell whether a rate is the number zero; a traced one may have any value."""
    return type(value) in (int, float) and value == 0


def _check_names(where: str, given: Mapping[str, Any], known: Any) -> None:
    wrong = [
        Problem(f"{where}.{name}", "there is no such name", suggestion(name, known))
        for name in given
        if name not in known
    ]
    if wrong:
        raise UnknownName(wrong)


def jax_number(where: str, value: Any, is_vector: bool = False) -> Any:
    """Return a number or an array as JAX takes it; points may be pairs. Raises InvalidInput for anything else."""
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
        named = ", ".join(dict.fromkeys(f"{one.name} {shape}" for one, shape in shapes.items() if shape))
        raise InvalidInput(Problem("shapes", f"{named} do not broadcast", "the last axis is the motion")) from None
    if 0 in shape:
        raise InvalidInput(Problem("shapes", "there are no poses, or no designs"))
    return shape


class GuardedNumber(NamedTuple):
    """A number or a truth, and whether it is one at all."""

    value: Any
    is_valid: Any = True


def evaluate_graph(graph: OperationGraph, wanted: Sequence[int], given: Mapping[int, Any]) -> list[Any]:
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
            found[k] = _reduction(jnp, node.operation, operands[0], shape)
        else:
            found[k] = RULES[node.operation](jnp, *operands)
    return [_masked_value(jnp, found[k]) for k in wanted]


def _real(jnp: Any, array: Any) -> Any:
    """Return an array of floating-point numbers, at the precision that JAX gives them."""
    found = jnp.asarray(array)
    return found if jnp.issubdtype(found.dtype, jnp.floating) else found.astype(float)


def _masked_value(jnp: Any, one: GuardedNumber) -> Any:
    value = jnp.asarray(_as_number(jnp, one.value))
    return value if one.is_valid is True else jnp.where(one.is_valid, value, jnp.nan)


def _as_number(jnp: Any, value: Any) -> Any:
    """Return a truth as 0.0 or 1.0, of the precision of what it meets."""
    return jnp.where(value, 1.0, 0.0) if jnp.asarray(value).dtype == bool else value


def _both(jnp: Any, one: Any, other: Any) -> Any:
    if one is True or other is False:
        return other
    return one if other is True or one is False else jnp.logical_and(one, other)


def _elementwise(name: str, jnp: Any, *operands: GuardedNumber) -> GuardedNumber:
    """Apply a function that is smooth wherever it is defined, or has one slope at each side."""
    value = getattr(jnp, name)(*(_as_number(jnp, one.value) for one in operands))
    return GuardedNumber(value, reduce(partial(_both, jnp), (one.is_valid for one in operands)))


def _comparison(name: str, jnp: Any, one: GuardedNumber, other: GuardedNumber) -> GuardedNumber:
    """Compare two numbers; nothing is told of what is no number."""
    told = getattr(jnp, name)(_as_number(jnp, one.value), _as_number(jnp, other.value))
    return GuardedNumber(_both(jnp, told, _both(jnp, one.is_valid, other.is_valid)))


def _logical(name: str, jnp: Any, *operands: GuardedNumber) -> GuardedNumber:
    return GuardedNumber(getattr(jnp, name)(*(one.value for one in operands)))


def _inv(jnp: Any, x: GuardedNumber) -> GuardedNumber:
    value = _as_number(jnp, x.value)
    there = _both(jnp, value != 0.0, x.is_valid)
    return GuardedNumber(1.0 / jnp.where(there, value, 1.0), there)


def _sqrt(jnp: Any, x: GuardedNumber) -> GuardedNumber:
    value = _as_number(jnp, x.value)
    smooth = value > 0.0
    root = jnp.where(smooth, jnp.sqrt(jnp.where(smooth, value, 1.0)), 0.0)
    return GuardedNumber(root, _both(jnp, value >= 0.0, x.is_valid))


def _log(jnp: Any, x: GuardedNumber) -> GuardedNumber:
    value = _as_number(jnp, x.value)
    there = _both(jnp, value > 0.0, x.is_valid)
    return GuardedNumber(jnp.log(jnp.where(there, value, 1.0)), there)


def _atan2(jnp: Any, y: GuardedNumber, x: GuardedNumber) -> GuardedNumber:
    away = jnp.logical_or(y.value != 0.0, x.value != 0.0)
    angle = jnp.arctan2(jnp.where(away, y.value, 0.0), jnp.where(away, x.value, 1.0))
    return GuardedNumber(angle, _both(jnp, y.is_valid, x.is_valid))


def _extreme(name: str, jnp: Any, one: GuardedNumber, other: GuardedNumber) -> GuardedNumber:
    """Return the greater or the lesser of two, of which one may be no number."""
    a = jnp.where(one.is_valid, _as_number(jnp, one.value), _as_number(jnp, other.value))
    b = jnp.where(other.is_valid, _as_number(jnp, other.value), a)
    always = one.is_valid is True or other.is_valid is True
    return GuardedNumber(getattr(jnp, name)(a, b), True if always else jnp.logical_or(one.is_valid, other.is_valid))


def _select(jnp: Any, truth: GuardedNumber, one: GuardedNumber, other: GuardedNumber) -> GuardedNumber:
    value = jnp.where(truth.value, _as_number(jnp, one.value), _as_number(jnp, other.value))
    always = one.is_valid is True and other.is_valid is True
    return GuardedNumber(value, True if always else jnp.where(truth.value, one.is_valid, other.is_valid))


def _reduction(jnp: Any, operation: str, one: GuardedNumber, shape: tuple[int, ...]) -> GuardedNumber:
    """Reduce over the last axis; one pose that is no number makes the whole none."""
    whole, there = jnp.broadcast_to(_as_number(jnp, one.value), shape), jnp.broadcast_to(one.is_valid, shape)
    whole = jnp.where(there, whole, 0.0)
    if not shape:
        return GuardedNumber(whole, there)
    value = (jnp.sum if operation == TOTAL else jnp.min)(whole, axis=-1, keepdims=True)
    return GuardedNumber(value, jnp.all(there, axis=-1, keepdims=True))


RULES: dict[str, Callable[..., GuardedNumber]] = {
    **{name: partial(_elementwise, one.compute.__name__) for name, one in OPERATIONS.items() if not one.is_truth},
    "abs": partial(_elementwise, "abs"),
    **{name: partial(_comparison, OPERATIONS[name].compute.__name__) for name in ("ge", "gt", "eq")},
    **{name: partial(_logical, OPERATIONS[name].compute.__name__) for name in ("and", "or", "not")},
    "fmax": partial(_extreme, "maximum"),
    "fmin": partial(_extreme, "minimum"),
    "inv": _inv,
    "sqrt": _sqrt,
    "log": _log,
    "atan2": _atan2,
    "select": _select,
}
