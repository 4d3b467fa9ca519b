"""Differentiation of a graph: slopes as new nodes of the same graph, forward by tangents or reverse by adjoints.

Each operation has one rule, read by both. Adjoints run down from a node, through the poses of the motion, to what a
design fixes; there they are summed over the poses, and one adjoint of the design's part remains. Factors in front of
nodes collect signs, halves and doubles of derivatives at no cost. Source: A. Griewank, A. Walther, Evaluating
Derivatives, 2nd ed., SIAM 2008, section 3.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import isnan
from typing import NamedTuple, TypeAlias

from compoundkin.programs.graph.flat_program import BY_POSE, node_strata
from compoundkin.programs.graph.operation_graph import CONSTANT, TOTAL, InputNumber, OperationGraph


def reverse(
    graph: OperationGraph,
    root: int,
    inputs: Sequence[int],
    given: Mapping[InputNumber, int],
    where: int | None = None,
) -> list[int]:
    """Return the slopes of a total by some inputs. `given` tells the stratum of each input.

    The total may be any node that a design fixes. The slope by an input that varies from pose to pose does so too;
    by others it is summed over the poses, those that a truth `where` leaves out excepted.

    >>> from compoundkin.programs.graph.flat_program import BY_DESIGN
    >>> graph = OperationGraph()
    >>> x, a = InputNumber("drive", "crank", "0"), InputNumber("dimension", "crank.B", "x")
    >>> root = graph.apply("total", graph.apply("mul", graph.input(a), graph.apply("cos", graph.input(x))))
    >>> (slope,) = reverse(graph, root, [graph.input(a)], {x: BY_POSE, a: BY_DESIGN})
    >>> graph.nodes[slope] == graph.nodes[graph.apply("total", graph.apply("cos", graph.input(x)))]
    True
    """
    return _Adjoints(graph, root, inputs, given, where).of(inputs)


class _Adjoints:
    """What hangs on each node, while it is found."""

    def __init__(
        self,
        graph: OperationGraph,
        root: int,
        inputs: Sequence[int],
        given: Mapping[InputNumber, int],
        where: int | None,
    ) -> None:
        self.graph = graph
        self.where = graph.constant(1.0) if where is None else where
        order = graph.needed([root])
        self.moves = {k: bool(s & BY_POSE) for k, s in node_strata(graph, order, given).items()}
        assert not self.moves[root], "the root is fixed by the design"
        self.alive = set(inputs)
        for k in order:
            if not self.alive.isdisjoint(graph.nodes[k].operands):
                self.alive.add(k)
        self.terms: dict[int, list[ScaledNode]] = {root: [ScaledNode(graph.constant(1.0))]}
        self.crossing: dict[int, list[ScaledNode]] = {}
        for k in reversed(order):
            if k in self.alive:
                self._pass_on(k)

    def of(self, nodes: Sequence[int]) -> list[int]:
        """Return the adjoints of some nodes."""
        found = (self._adjoint(k) for k in nodes)
        kept = (
            a.where(self.graph, self.where) if a and self.moves.get(k) else a for k, a in zip(nodes, found, strict=True)
        )
        return [self.graph.constant(0.0) if each is None else each.written(self.graph) for each in kept]

    def _adjoint(self, k: int) -> ScaledNode | None:
        """Return the adjoint of a node, once all that depends on it has passed its own on."""
        over_poses = scaled_sum(self.graph, self.crossing.get(k, ()))
        totals = [] if over_poses is None else [self._total(over_poses)]
        return scaled_sum(self.graph, [*self.terms.get(k, ()), *totals])

    def _total(self, term: ScaledNode) -> ScaledNode:
        kept = term.where(self.graph, self.where)
        return ScaledNode(self.graph.apply(TOTAL, kept.node), kept.factor)

    def _pass_on(self, k: int) -> None:
        adjoint = self._adjoint(k)
        if adjoint is None:
            return
        node = self.graph.nodes[k]
        if node.operation == TOTAL:
            (inner,) = node.operands
            assert not any(self.graph.reduced(n) for n in self.graph.needed([adjoint.node])), "a total of totals"
            # what does not vary by pose is counted as often as there are poses
            to = self.terms if self.moves[inner] else self.crossing
            to.setdefault(inner, []).append(adjoint)
            return
        for n, slope in slopes(self.graph, k):
            if n in self.alive:
                to = self.crossing if self.moves[k] and not self.moves[n] else self.terms
                to.setdefault(n, []).append(slope(adjoint))


def forward(graph: OperationGraph, wanted: Sequence[int], changes: Mapping[int, float]) -> list[int]:
    """Return how fast some nodes change when inputs change at given rates.

    Other inputs do not change; what depends on none of them has the constant zero.

    >>> from compoundkin.programs.graph.operation_graph import InputNumber
    >>> graph = OperationGraph()
    >>> x, y = (graph.input(InputNumber("parameter", name)) for name in "xy")
    >>> forward(graph, [graph.apply("mul", x, y)], {x: 1.0}) == [y]
    True
    """
    found: dict[int, ScaledNode] = {
        k: ScaledNode(graph.constant(1.0), rate) for k, rate in changes.items() if rate != 0.0
    }
    for k in graph.needed(wanted):
        if any(n in found for n in graph.nodes[k].operands):
            rate = _tangent(graph, k, found)
            if rate is not None:
                found[k] = rate
    return [found[k].written(graph) if k in found else graph.constant(0.0) for k in wanted]


def _tangent(graph: OperationGraph, k: int, found: Mapping[int, ScaledNode]) -> ScaledNode | None:
    node = graph.nodes[k]
    if node.operation == TOTAL:
        inner = found[node.operands[0]]
        return ScaledNode(graph.apply(TOTAL, inner.node), inner.factor)
    return scaled_sum(graph, [slope(found[n]) for n, slope in slopes(graph, k) if n in found])


class ScaledNode(NamedTuple):
    """A number times a node."""

    node: int
    factor: float = 1.0

    def times(self, graph: OperationGraph, node: int, factor: float = 1.0) -> ScaledNode:
        """Return it times a node and a number. The numbers of both come to stand in front."""
        own, other = _scaled(graph, self.node), _scaled(graph, node)
        return ScaledNode(graph.apply("mul", own.node, other.node), self.factor * factor * own.factor * other.factor)

    def where(self, graph: OperationGraph, truth: int, kept: bool = True) -> ScaledNode:
        """Return it where a truth is, or where it is not, and zero elsewhere.

        What is not a number elsewhere is left out.
        """
        zero = graph.constant(0.0)
        operands = (self.node, zero) if kept else (zero, self.node)
        return ScaledNode(graph.apply("select", truth, *operands), self.factor)

    def written(self, graph: OperationGraph) -> int:
        """Return its node."""
        if self.factor < 0.0:
            return graph.apply("neg", ScaledNode(self.node, -self.factor).written(graph))
        return graph.apply("mul", graph.constant(self.factor), self.node)


# A change of a node times its slope by an operand, either way: of tangents upwards, of adjoints downwards.
Slope: TypeAlias = Callable[[ScaledNode], ScaledNode]


# The nodes that a node changes with, not always its own operands, and the slopes by them.
SlopeRule: TypeAlias = Callable[[OperationGraph, int], list[tuple[int, Slope]]]


def slopes(graph: OperationGraph, node: int) -> list[tuple[int, Slope]]:
    """Return the nodes that a node changes with, and how."""
    return SLOPE_RULES[graph.nodes[node].operation](graph, node) if graph.nodes[node].operands else []


def _scale(factor: float) -> Slope:
    return lambda change: ScaledNode(change.node, change.factor * factor)


def _factor(graph: OperationGraph, node: int, factor: float = 1.0) -> Slope:
    return lambda change: change.times(graph, node, factor)


def _operands(graph: OperationGraph, node: int) -> tuple[int, ...]:
    return graph.nodes[node].operands


def _linear(*factors: float) -> SlopeRule:
    return lambda graph, k: [(n, _scale(c)) for n, c in zip(_operands(graph, k), factors, strict=True)]


def _no_slopes(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    """Return the slopes of what is level between its jumps: none."""
    return []


def _mul(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    a, b = _operands(graph, k)
    return [(a, _factor(graph, a, 2.0))] if a == b else [(a, _factor(graph, b)), (b, _factor(graph, a))]


def _inv(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    return [(_operands(graph, k)[0], _factor(graph, graph.apply("mul", k, k), -1.0))]


def _sqrt(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    slope = graph.apply("inv", k)
    if _is_square(graph, a):
        # the length of a vector that is zero has no slope: as good as any is none
        zero = graph.constant(0.0)
        slope = graph.apply("select", graph.apply("gt", k, zero), slope, zero)
    return [(a, _factor(graph, slope, 0.5))]


def _is_square(graph: OperationGraph, node: int) -> bool:
    """Tell whether a node is the square of a vector's length."""
    parts = [graph.nodes[n] for n in _operands(graph, node)] if graph.nodes[node].operation == "add" else []
    return bool(parts) and all(each.operation == "mul" and each.operands[0] == each.operands[1] for each in parts)


def _abs(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    sign = graph.apply("select", graph.apply("ge", a, graph.constant(0.0)), graph.constant(1.0), graph.constant(-1.0))
    return [(a, _factor(graph, sign))]


def _sin(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    return [(a, _factor(graph, graph.apply("cos", a)))]


def _cos(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    return [(a, _factor(graph, graph.apply("sin", a), -1.0))]


def _atan2(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    y, x = _operands(graph, k)
    put = graph.apply
    inverse = put("inv", put("add", put("mul", x, x), put("mul", y, y)))
    return [(y, _factor(graph, put("mul", x, inverse))), (x, _factor(graph, put("mul", y, inverse), -1.0))]


def _exp(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    return [(_operands(graph, k)[0], _factor(graph, k))]


def _log(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    (a,) = _operands(graph, k)
    return [(a, _factor(graph, graph.apply("inv", a)))]


def _selected(graph: OperationGraph, truth: int, one: int, other: int) -> list[tuple[int, Slope]]:
    return [(one, lambda change: change.where(graph, truth)), (other, lambda change: change.where(graph, truth, False))]


def _extreme(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    """Return the slopes of a maximum or minimum: it changes with the operand that it is."""
    a, b = _operands(graph, k)
    return _selected(graph, graph.apply("eq", k, a), a, b)


def _select(graph: OperationGraph, k: int) -> list[tuple[int, Slope]]:
    truth, one, other = _operands(graph, k)
    for masked, kept in ((one, other), (other, one)):
        if graph.nodes[masked].operation == CONSTANT and isnan(graph.nodes[masked].value):
            return [(_unclipped(graph, kept), _scale(1.0))]
    return _selected(graph, truth, one, other)


def _unclipped(graph: OperationGraph, node: int) -> int:
    """Return what a guard clips at zero: a discriminant that rounding makes negative still has its slope."""
    found = graph.nodes[node]
    if found.operation == "max":
        for zero, other in (found.operands, found.operands[::-1]):
            if graph.is_constant(zero, 0.0):
                return other
    return node


SLOPE_RULES: dict[str, SlopeRule] = {
    "add": _linear(1.0, 1.0),
    "sub": _linear(1.0, -1.0),
    "mul": _mul,
    "neg": _linear(-1.0),
    "inv": _inv,
    "sqrt": _sqrt,
    "abs": _abs,
    "sin": _sin,
    "cos": _cos,
    "atan2": _atan2,
    "exp": _exp,
    "log": _log,
    "max": _extreme,
    "min": _extreme,
    "fmax": _extreme,
    "fmin": _extreme,
    "select": _select,
    **dict.fromkeys(("floor", "ceil", "rint", "ge", "gt", "eq", "and", "or", "not"), _no_slopes),
}


def scaled_sum(graph: OperationGraph, terms: Sequence[ScaledNode]) -> ScaledNode | None:
    """Return the sum of some terms, or None where all are zero.

    The factor of the first stands in front.

    >>> graph = OperationGraph()
    >>> x = graph.apply("sqrt", graph.constant(2.0))
    >>> scaled_sum(graph, [ScaledNode(x, 2.0), ScaledNode(graph.constant(0.0)), ScaledNode(x, -2.0)]).factor
    2.0
    """
    left = [term for term in terms if term.factor != 0.0 and not graph.is_constant(term.node, 0.0)]
    if not left:
        return None
    total, factor = left[0]
    for term in left[1:]:
        ratio = term.factor / factor
        size = graph.apply("mul", graph.constant(abs(ratio)), term.node)
        total = graph.apply("add", total, size) if ratio > 0.0 else _difference(graph, total, size)
    return ScaledNode(total, factor)


def _scaled(graph: OperationGraph, node: int) -> ScaledNode:
    """Return a node as a number times another."""
    known = graph.nodes[node]
    if known.operation == "neg":
        inner = _scaled(graph, known.operands[0])
        return ScaledNode(inner.node, -inner.factor)
    if known.operation == CONSTANT:
        return ScaledNode(graph.constant(1.0), known.value)
    if known.operation == "mul":
        for one, other in (known.operands, known.operands[::-1]):
            if graph.nodes[one].operation == CONSTANT:
                return ScaledNode(other, graph.nodes[one].value)
    return ScaledNode(node)


def _difference(graph: OperationGraph, one: int, other: int) -> int:
    """Return a difference; one less than something else, taken from it, is that."""
    known = graph.nodes[other]
    if known.operation == "sub" and known.operands[0] == one:
        return known.operands[1]
    return graph.apply("sub", one, other)
