"""A flat program: the operations that some outputs need, cut by what fixes them: the design, the pose, or both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import or_

from compoundkin.base.display import ShortRepr
from compoundkin.programs.graph.operation_graph import BEFORE, CONSTANT, INPUT, InputNumber, OperationGraph

# Strata: by which axes of (designs, poses) a value varies. What is given as one number counts as fixed by the design.
FIXED_NUMBER, BY_DESIGN, BY_POSE, BY_BOTH = 0, 1, 2, 3


@dataclass(frozen=True, repr=False)
class Carried(ShortRepr):
    """A number carried from pose to pose along the motion.

    Designs go side by side, a march.

    At a design's first pose the input node `given` has its value `start` (an input by design); at any other pose the
    value that the node `next` had at the pose before.
    """

    given: int
    start: int
    next: int


@dataclass(frozen=True, repr=False)
class FlatProgram(ShortRepr):
    """What a back end computes. All sequences hold node indices of `graph`, in an order that can be computed.

    `before` is computed once a design, `by_pose` once a pose for all designs, `loop` at every design and pose (with the
    reductions, whose values are complete after a design's last pose), `after` once a design from reductions.
    `inputs` and `outputs` are the nodes read and asked for; `strata[node]` tells the shape (1 or designs, 1 or poses)
    of their arrays. An output may be an input or a constant. With `carried` numbers poses come one after another.
    """

    graph: OperationGraph
    strata: Mapping[int, int]
    inputs: tuple[int, ...]
    before: tuple[int, ...]
    by_pose: tuple[int, ...]
    loop: tuple[int, ...]
    after: tuple[int, ...]
    outputs: tuple[int, ...]
    carried: tuple[Carried, ...] = ()

    @cached_property
    def delayed(self) -> Mapping[int, int]:
        """The inputs that are others a pose before, with those; at the first pose they are the same."""
        nodes = self.graph.nodes
        places = {nodes[k].given: k for k in self.inputs}
        found = ((k, nodes[k].given) for k in self.inputs)
        return {k: places[one._replace(part="0")] for k, one in found if one is not None and one.part == BEFORE}

    @cached_property
    def given(self) -> tuple[int, ...]:
        """The inputs that a caller gives: carried numbers are none, nor are others a pose before."""
        found = {one.given for one in self.carried} | self.delayed.keys()
        return tuple(k for k in self.inputs if k not in found)

    def shape(self, node: int, designs: int, poses: int) -> tuple[int, int]:
        """Return the shape of a node's array."""
        stratum = self.strata[node]
        return designs if stratum & BY_DESIGN else 1, poses if stratum & BY_POSE else 1


def flat_program(
    graph: OperationGraph,
    outputs: Sequence[int],
    given: Mapping[InputNumber, int],
    carried: Sequence[Carried] = (),
) -> FlatProgram:
    """Cut what some outputs need into its parts. `given` tells each input's stratum.

    >>> graph = OperationGraph()
    >>> x, a = InputNumber("drive", "crank", "0"), InputNumber("dimension", "crank.B", "x")
    >>> place = graph.apply("mul", graph.input(a), graph.apply("cos", graph.input(x)))
    >>> flat = flat_program(graph, [place], {x: BY_POSE, a: BY_DESIGN})
    >>> [len(part) for part in (flat.before, flat.by_pose, flat.loop, flat.after)]
    [0, 1, 1, 0]
    """
    wanted = (*outputs, *(k for one in carried for k in (one.start, one.next)))
    needed = graph.needed(wanted)
    strata, late = node_strata(graph, needed, given), _late(graph, needed)
    work = [k for k in needed if graph.nodes[k].operation not in (CONSTANT, INPUT)]
    reductions = {k for k in work if graph.reduced(k)}
    fixed = [k for k in work if not strata[k] & BY_POSE and k not in reductions]
    return FlatProgram(
        graph,
        strata,
        tuple(k for k in needed if graph.nodes[k].operation == INPUT),
        tuple(k for k in fixed if k not in late),
        tuple(k for k in work if strata[k] == BY_POSE),
        tuple(k for k in work if strata[k] == BY_BOTH or k in reductions),
        tuple(k for k in fixed if k in late),
        tuple(outputs),
        tuple(carried),
    )


def node_strata(graph: OperationGraph, nodes: Sequence[int], given: Mapping[InputNumber, int]) -> dict[int, int]:
    """Return the strata of some nodes. All that they are computed from is among them, and comes first."""
    strata: dict[int, int] = {}
    for k in nodes:
        node = graph.nodes[k]
        if node.operation == INPUT:
            assert node.given is not None
            strata[k] = given[node.given]
        elif graph.reduced(k):
            strata[k] = BY_DESIGN
        else:
            strata[k] = reduce(or_, (strata[n] for n in node.operands), FIXED_NUMBER)
    return strata


def _late(graph: OperationGraph, needed: Sequence[int]) -> set[int]:
    """Return the nodes that depend on a reduction."""
    late: set[int] = set()
    for k in needed:
        if any(n in late or graph.reduced(n) for n in graph.nodes[k].operands):
            late.add(k)
    return late
