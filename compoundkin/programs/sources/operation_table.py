"""Operations as a table of whole numbers, which a small machine in any language computes row by row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from compoundkin.base.display import PrintsShort
from compoundkin.programs.backends.tape.row_allocation import allocated
from compoundkin.programs.backends.tape.tape_instructions import Instruction
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, node_strata
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import CONSTANT, INPUT, OPERATIONS

# The number of an operation is its place here.
CODES = tuple(OPERATIONS)
# An entry of the table: the operation, where its result goes, and three operands.
WIDTH = 5


@dataclass(frozen=True, repr=False)
class OperationTable(PrintsShort):
    """A table of operations, in the order in which they are computed.

    `before` is computed once for all poses, `along` at every pose, the first `positions` of it for the results asked
    for first. A place that is not negative is a row over the poses, -1 - k is number k: `constants` are the first
    numbers, the dimensions of a call the next. `rows` and `numbers` are how many there are, `places` those of nodes.
    """

    constants: tuple[float, ...]
    numbers: int
    rows: int
    before: tuple[int, ...]
    along: tuple[int, ...]
    positions: int
    places: Mapping[int, int]


def operation_table(
    graph: OperationGraph,
    first: Sequence[int],
    then: Sequence[int],
    fixed: Sequence[InputNumber],
    along: Sequence[InputNumber],
) -> OperationTable:
    """Return the table that computes some nodes first, and others then.

    `fixed` are the inputs that are one number for all poses, `along` those that are rows, both in their order.

    >>> graph, x, a = OperationGraph(), InputNumber("drive", "crank", "0"), InputNumber("dimension", "crank.B", "x")
    >>> node = graph.apply("mul", graph.input(a), graph.apply("cos", graph.input(x)))
    >>> table = operation_table(graph, [node], [], [a], [x])
    >>> [CODES[table.along[k]] for k in (0, 5)], table.rows, table.numbers
    (['cos', 'mul'], 2, 1)
    """
    needed = graph.needed([*first, *then])
    strata = node_strata(graph, needed, {**dict.fromkeys(fixed, BY_DESIGN), **dict.fromkeys(along, BY_POSE)})
    early = set(graph.needed(first))
    work = [k for k in needed if graph.nodes[k].operation not in (CONSTANT, INPUT)]
    rows = sorted((k for k in work if strata[k] & BY_POSE), key=lambda k: k not in early)
    kept = [Instruction(graph.nodes[k].operation, graph.nodes[k].operands, k) for k in rows]
    allocation = allocated(kept, {*first, *then})
    constants = [k for k in needed if graph.nodes[k].operation == CONSTANT]
    given = [graph.input(one) for one in fixed]
    before = [k for k in work if not strata[k] & BY_POSE]
    places = {k: -1 - place for place, k in enumerate((*constants, *given, *before))}
    places |= {graph.input(one): place for place, one in enumerate(along)}
    places |= {k: len(along) + row for k, (_, row) in allocation.rows.items()}
    return OperationTable(
        tuple(graph.nodes[k].value for k in constants),
        len(constants) + len(given) + len(before),
        len(along) + allocation.counts[False],
        _entries(graph, before, places),
        _entries(graph, rows, places),
        sum(k in early for k in rows),
        places,
    )


def _entries(graph: OperationGraph, nodes: Sequence[int], places: Mapping[int, int]) -> tuple[int, ...]:
    found: list[int] = []
    for k in nodes:
        node = graph.nodes[k]
        operands = [places[operand] for operand in node.operands]
        found += [CODES.index(node.operation), places[k], *operands, *[0] * (WIDTH - 2 - len(operands))]
    return tuple(found)
