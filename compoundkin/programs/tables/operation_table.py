"""Operations as a table of whole numbers, which a small machine in any language computes row by row."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

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

    `before` is computed once for all poses, `along` at every pose: section by section, of which `ends` tells after how
    many operations each ends. A place that is not negative is a row over the poses, -1 - k is number k: `constants` are
    the first numbers, the dimensions of a call the next. `rows` and `numbers` are how many there are, `places` those of
    nodes.
    """

    constants: tuple[float, ...]
    numbers: int
    rows: int
    before: tuple[int, ...]
    along: tuple[int, ...]
    ends: tuple[int, ...]
    places: Mapping[int, int]


def operation_table(
    graph: OperationGraph,
    sections: Sequence[Sequence[int]],
    fixed: Sequence[InputNumber],
    along: Sequence[InputNumber],
    known: Mapping[InputNumber, float] = MappingProxyType({}),
) -> OperationTable:
    """Return the table that computes some nodes, section by section.

    `fixed` are the inputs that are one number for all poses, `along` those that are rows, both in their order; others
    are `known` numbers.

    >>> graph, x, a = OperationGraph(), InputNumber("drive", "crank", "0"), InputNumber("dimension", "crank.B", "x")
    >>> node = graph.apply("mul", graph.input(a), graph.apply("cos", graph.input(x)))
    >>> table = operation_table(graph, [[node]], [a], [x])
    >>> [CODES[table.along[k]] for k in (0, 5)], table.rows, table.numbers
    (['cos', 'mul'], 2, 1)
    """
    wanted = [k for section in sections for k in section]
    needed = graph.needed(wanted)
    given = {**dict.fromkeys((*fixed, *known), BY_DESIGN), **dict.fromkeys(along, BY_POSE)}
    strata = node_strata(graph, needed, given)
    work = [k for k in needed if graph.nodes[k].operation not in (CONSTANT, INPUT)]
    rows, ends = _in_sections(graph, sections, {k for k in work if strata[k] & BY_POSE})
    before = [k for k in work if not strata[k] & BY_POSE]
    constants = {k: graph.nodes[k].value for k in needed if graph.nodes[k].operation == CONSTANT}
    constants |= {graph.input(one): value for one, value in known.items()}
    numbers = (*constants, *map(graph.input, fixed), *before)
    held = _held(graph, rows, wanted, along)
    places = {k: -1 - place for place, k in enumerate(numbers)} | held
    rows_held = 1 + max(held.values(), default=-1)
    first, along_poses = _entries(graph, before, places), _entries(graph, rows, places)
    return OperationTable(tuple(constants.values()), len(numbers), rows_held, first, along_poses, ends, places)


def _held(
    graph: OperationGraph, nodes: Sequence[int], wanted: Sequence[int], along: Sequence[InputNumber]
) -> dict[int, int]:
    """Return the rows that hold inputs and nodes; rows of what is not wanted are taken again."""
    steps = [Instruction(graph.nodes[k].operation, graph.nodes[k].operands, k) for k in nodes]
    held = {graph.input(one): row for row, one in enumerate(along)}
    return held | {k: len(along) + row for k, (_, row) in allocated(steps, {*wanted}).rows.items()}


def _in_sections(
    graph: OperationGraph, sections: Sequence[Sequence[int]], among: Collection[int]
) -> tuple[list[int], tuple[int, ...]]:
    """Return the nodes in the order in which sections need them, and after how many each section ends."""
    found, ends = dict[int, None](), list[int]()
    for section in sections:
        found.update(dict.fromkeys(k for k in graph.needed(section) if k in among))
        ends.append(len(found))
    return list(found), tuple(ends)


def _entries(graph: OperationGraph, nodes: Sequence[int], places: Mapping[int, int]) -> tuple[int, ...]:
    found: list[int] = []
    for k in nodes:
        node = graph.nodes[k]
        operands = [places[operand] for operand in node.operands]
        found += [CODES.index(node.operation), places[k], *operands, *[0] * (WIDTH - 2 - len(operands))]
    return tuple(found)
