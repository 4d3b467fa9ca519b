"""Where the numbers of a program stand while LLVM's code runs: its sections, and values kept for later ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE, FIXED_NUMBER, FlatProgram
from compoundkin.programs.graph.operation_graph import TOTAL

# Sections, in the order in which they run, each with what its values are computed for.
FIXED, BEFORE, ROWS, LOOP, AFTER = "fixed", "before", "rows", "loop", "after"


SECTIONS = (FIXED, BEFORE, ROWS, LOOP, AFTER)


OF_STRATUM = {FIXED_NUMBER: FIXED, BY_DESIGN: BEFORE, BY_POSE: ROWS, BY_BOTH: LOOP}


# How an array stands along the lanes: with any stride, number by number, or as parts of complex numbers.
ANY_STRIDE, SIDE_BY_SIDE, COMPLEX = 0, 1, 2


# Words before the table of arrays: what an array must be, which poses the rows hold, whether an angle was too large;
# then designs, poses, poses of a segment and segments of a call that computes all.
HEADER = 8


ARRAY_KIND, NUMBER_KIND, ROWS_OF, TOO_LARGE, EXTENT = 0, 1, 2, 3, 4


DESIGNS_AT_ONCE, SEGMENTS = 64, 64


ROWS_IN_CACHE, POSES_AT_MOST = 32_768, 4_096  # numbers


# Poses: whole vectors of any machine, and fewer than make it worth while to add up once more.
POSES_TOGETHER, SHORTEST_SEGMENT = 64, 512


# Poses whose results are kept before they are written: some lines of cache of each design.
POSES_STAGED = 32


@dataclass(frozen=True)
class ArrayLayout:
    """How arrays stand along the lanes, and which two are one complex array."""

    kinds: tuple[int, ...]
    pairs: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True)
class Machine:
    """What of a processor decides on the text."""

    lanes: int
    has_fma: bool
    has_masks: bool


def home(program: FlatProgram, node: int) -> str:
    """Return the section after which a node's value is known."""
    late = program.graph.reduced(node) or node in program.after
    return AFTER if late else OF_STRATUM[program.strata[node]]


@dataclass(frozen=True)
class LanePlan:
    """A program with the axis of its lanes, and where each value is kept.

    `wide` programs ask the system's library for sines and cosines. `is_single` ones have one design, `is_long` ones
    many poses of it.
    """

    program: FlatProgram
    axis: int
    layout: ArrayLayout
    machine: Machine
    wide: bool = False
    is_single: bool = False
    is_long: bool = False

    @property
    def overlaps(self) -> bool:
        """Whether a last vector that is not full starts earlier, and computes some poses again, instead of masks.

        Sums would count those twice.
        """
        graph = self.program.graph
        counts = any(graph.nodes[k].operation == TOTAL for k in self.reductions)
        return self.is_long and self.is_single and self.axis == BY_POSE and not counts

    @cached_property
    def section_of(self) -> dict[int, str]:
        """The section that computes each node; reductions are complete after the loop."""
        program = self.program
        found = {k: self._home(k) for k in (*program.before, *program.by_pose, *program.loop)}
        return found | dict.fromkeys(program.after, AFTER) | dict.fromkeys(self.reductions, LOOP)

    def _home(self, node: int) -> str:
        """Return the section after which a value is known."""
        # rows of a single design are part of its loop
        found = home(self.program, node)
        return LOOP if self.is_single and found == ROWS else found

    @cached_property
    def sinks(self) -> dict[str, list[tuple[int, int]]]:
        """The arrays that each section writes, with their nodes."""
        found: dict[str, list[tuple[int, int]]] = {name: [] for name in SECTIONS}
        for i, k in enumerate(self.program.outputs):
            found[self._home(k)].append((len(self.inputs) + i, k))
        return found

    @cached_property
    def kept(self) -> dict[str, dict[int, int]]:
        """What sections hand to later ones, with the numbers of their places."""
        found: dict[str, dict[int, int]] = {FIXED: {}, BEFORE: {}, ROWS: {}}
        for name in SECTIONS:
            for k in self.needs(name):
                home = self.section_of.get(k)
                if home in found and home != name:
                    found[home].setdefault(k, len(found[home]))
        return found

    @property
    def inputs(self) -> tuple[int, ...]:
        """The inputs that a caller gives."""
        return self.program.given

    @cached_property
    def reductions(self) -> tuple[int, ...]:
        """The reductions, in the order of their accumulators."""
        return tuple(k for k in self.program.loop if self.program.graph.reduced(k))

    def stratum(self, array: int) -> int:
        """Return the stratum of an array of a call."""
        return self.program.strata[(*self.inputs, *self.program.outputs)[array]]

    @cached_property
    def nodes(self) -> dict[str, list[int]]:
        """What each section computes, in order; reductions are no operations."""
        found: dict[str, list[int]] = {name: [] for name in SECTIONS}
        for k, own in self.section_of.items():
            if not self.program.graph.reduced(k):
                found[own].append(k)
        return found

    def needs(self, name: str) -> Iterator[int]:
        """Yield the nodes that a section reads."""
        graph = self.program.graph
        for k in self.nodes[name]:
            yield from graph.nodes[k].operands
        yield from (k for _, k in self.sinks[name])
        if name == LOOP:
            for k in self.reductions:
                yield from graph.nodes[k].operands
            yield from (one.next for one in self.program.carried)
        if name == BEFORE:
            yield from (one.start for one in self.program.carried)

    @cached_property
    def staged(self) -> tuple[int, ...]:
        """The arrays that are written along the poses although lanes go along designs."""
        if self.axis != BY_DESIGN:
            return ()
        return tuple(array for array, _ in self.sinks[LOOP] if self.layout.kinds[array] == ANY_STRIDE)

    # --- the places, in words of eight bytes ---

    @cached_property
    def piece(self) -> int:
        """The number of poses whose rows are kept at a time."""
        if self.staged:
            return POSES_STAGED
        rows = max(len(self.kept[ROWS]), 1)
        return max(min(ROWS_IN_CACHE // rows, POSES_AT_MOST) // POSES_TOGETHER, 1) * POSES_TOGETHER

    @cached_property
    def arrays(self) -> int:
        """The number of arrays of a call."""
        return len(self.inputs) + len(self.program.outputs)

    @cached_property
    def at_fixed(self) -> int:
        """The word where what is fixed for all designs starts."""
        return (HEADER + 3 * self.arrays + 7) // 8 * 8

    @cached_property
    def at_rows(self) -> int:
        """The word where rows by pose start."""
        return self.at_fixed + (len(self.kept[FIXED]) + 7) // 8 * 8

    @cached_property
    def at_designs(self) -> int:
        """The word where what designs fix starts."""
        return self.at_rows + len(self.kept[ROWS]) * self.piece

    @cached_property
    def of_design(self) -> int:
        """The number of words for what a design, or a block of them, fixes."""
        return len(self.kept[BEFORE]) * self.width

    @cached_property
    def at_sums(self) -> int:
        """The word where accumulators start; carried numbers follow those of a block of designs."""
        return self.at_designs + (self.of_design * self.designs_at_once + 7) // 8 * 8

    @cached_property
    def of_sums(self) -> int:
        """The number of words of a row of accumulators. It belongs to a design and segment, or a block."""
        return (len(self.reductions) + len(self.program.carried)) * self.width

    @cached_property
    def at_staged(self) -> int:
        """The word where results are kept that are written along the poses."""
        segments = SEGMENTS if self.axis == BY_POSE else 1
        return self.at_sums + (self.of_sums * self.designs_at_once * segments + 7) // 8 * 8

    @cached_property
    def size(self) -> int:
        """The number of words of all."""
        return self.at_staged + len(self.staged) * self.piece * self.machine.lanes + 8

    @cached_property
    def width(self) -> int:
        """The number of designs that are computed side by side."""
        return self.machine.lanes if self.axis == BY_DESIGN else 1

    @cached_property
    def designs_at_once(self) -> int:
        """The number of designs, or blocks of them, kept at a time."""
        return DESIGNS_AT_ONCE if self.axis == BY_POSE else 1
