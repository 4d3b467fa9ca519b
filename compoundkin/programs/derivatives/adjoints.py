"""Reverse differentiation: how one node changes with every input at once, as new nodes of the same graph.

Adjoints run down from the node, through the poses of the motion, to what a design fixes; there they are summed over
the poses, and one adjoint of the design's part remains.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compoundkin.programs.derivatives.scaled_nodes import ScaledNode, scaled_sum
from compoundkin.programs.derivatives.slope_rules import slopes
from compoundkin.programs.graph.flat_program import BY_POSE, node_strata
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import TOTAL


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
