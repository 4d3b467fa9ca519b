"""A compiled path as a pure function of JAX: traced, mapped over designs and differentiated by its users."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from math import pi
from typing import Any

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.kinematics.approach import SPACING
from compoundkin.kinematics.driver_values import by_name
from compoundkin.kinematics.driver_ways import NEAR
from compoundkin.model.attributes import RATES
from compoundkin.programs.backends.jax_operations import evaluated
from compoundkin.programs.graph.input_kinds import DRIVE, SEED
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.jax_numbers import common_shape, held
from compoundkin.programs.recorded_path import PathVariants, RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits

ASSEMBLED, CERTAIN = "assembled", "certain"


@dataclass(frozen=True, eq=False, repr=False)
class JaxPath(PrintsShort):
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

        drives = self._drives(values, dict(zip(RATES, (speed, acceleration, jerk), strict=True)))
        given = {**drives, **self._dimensions(dimensions or {})}
        still = frozenset((one.name, int(one.part)) for one, value in drives.items() if one.part > "0" and _zero(value))
        path = self.path.variant(still)
        graph, wanted = path.mechanism.graph, _wanted(path)
        shape = common_shape(given)
        used = {k: graph.nodes[k].given for k in graph.inputs(wanted)}
        *found, failed, margin = evaluated(graph, wanted, {k: given[one] for k, one in used.items() if one is not None})
        assembled = jnp.broadcast_to(failed == 0.0, shape)
        parts = iter(jnp.where(assembled, value, jnp.nan) for value in found)
        whole = {}
        for output, nodes in zip(self.path.outputs, path.nodes, strict=True):
            value = _joined(tuple(next(parts) for _ in nodes))
            whole[output.name] = continuous(value) if output.is_wrapped else value
        return {**whole, ASSEMBLED: assembled, CERTAIN: self._certain(jnp.broadcast_to(margin, shape), drives)}

    def _drives(self, values: Any, rates: Mapping[str, Any]) -> dict[InputNumber, Any]:
        """Return the drivers' values and rates."""
        mechanism = self.path.reference.mechanism
        values = by_name(mechanism, values) or {}
        drives = {drive.name: drive for drive in mechanism.drives}
        _only_known("values", values, drives)
        found = {}
        for name, drive in drives.items():
            value = values.get(name, drive.values)
            if value is None:
                raise InvalidInput(Problem(f"values.{name}", "the driver is given no values", f"{{{name!r}: angles}}"))
            found[InputNumber(DRIVE, name, "0")] = held(f"values.{name}", value)
            for k, word in enumerate(RATES, 1):
                given = {} if rates[word] is None else by_name(mechanism, rates[word]) or {}
                _only_known(word, given, drives)
                found[InputNumber(DRIVE, name, str(k))] = given.get(name, getattr(drive, word))
        return found

    def _dimensions(self, dimensions: Mapping[str, Any]) -> dict[InputNumber, Any]:
        """Return the free dimensions, their own values where none are given."""
        import jax.numpy as jnp

        free = [one for one in self.path.dimensions if not one.is_of_law]
        _only_known("dimensions", dimensions, [one.name for one in free])
        found: dict[InputNumber, Any] = {}
        for one in free:
            own = one.name not in dimensions
            value = self.path.stated.own(one) if own else dimensions[one.name]
            value = value if own else held(f"dimensions.{one.name}", value, one.is_vector)
            found.update(zip(one.inputs, (jnp.real(value), jnp.imag(value)), strict=False))
        return found

    def _certain(self, margin: Any, drives: Mapping[InputNumber, Any]) -> Any:
        """Tell which designs need no closer look, as `limit_look.bound` has it."""
        import jax.numpy as jnp

        if not margin.ndim:
            return margin >= NEAR
        longest, order = jnp.ones(()), self.path.reference.solving_order
        for one, value in drives.items():
            if one.part == "0" and jnp.ndim(value) and jnp.shape(value)[-1] > 1:
                steps = jnp.max(jnp.abs(jnp.diff(jnp.asarray(value))), axis=-1)
                longest = jnp.maximum(longest, steps / (order.unit(one.name) * SPACING))
        return jnp.min(margin, axis=-1) >= NEAR * longest**2

    def __repr__(self) -> str:
        return f"JaxPath({', '.join(output.name for output in self.path.outputs)})"


def jax_path(path: PathVariants) -> JaxPath:
    """Return a path as a function of JAX.

    Raises InvalidInput where JAX is not installed, and for what is found by search: states of general groups, contacts
    of profiles, counted turns.
    """
    if not find_spec("jax"):
        raise InvalidInput(Problem("jax", "JAX is not installed", "pip install 'compoundkin[jax]'"))
    found = path.variant(frozenset())
    graph = found.mechanism.graph
    given = [graph.nodes[k].given for k in graph.inputs(_wanted(found))]
    what, remedy = "it is found by search, which is no pure function", "call the path itself, or its derivatives"
    searched = dict.fromkeys(one.name for one in given if one is not None and one.kind == SEED)
    if searched:
        raise InvalidInput([Problem(name, what, remedy) for name in searched])
    return JaxPath(path)


def _wanted(path: RecordedPath) -> list[int]:
    """Return the nodes of the outputs, then those of what failed and of what is certain."""
    limits = RecordedLimits(path.mechanism)
    return [*(node for nodes in path.nodes for node in nodes), limits.failed.x, limits.certain.x]


def _joined(parts: tuple[Any, ...]) -> Any:
    from jax.lax import complex as joined

    return parts[0] if len(parts) == 1 else joined(*parts)


def continuous(angle: Any) -> Any:
    """Return an angle continuous along the last axis, over poses not assembled too."""
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


def _zero(value: Any) -> bool:
    """Tell whether a rate is a number known to be zero; what JAX traces is not known."""
    return type(value) in (int, float) and value == 0


def _only_known(where: str, given: Mapping[str, Any], known: Any) -> None:
    wrong = [
        Problem(f"{where}.{name}", "there is no such name", nearest(name, known)) for name in given if name not in known
    ]
    if wrong:
        raise UnknownName(wrong)


__all__ = ["JaxPath", "continuous", "jax_path"]
