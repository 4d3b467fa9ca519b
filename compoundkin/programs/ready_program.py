"""A program ready to run, and arrays for what it finds: complex ones of two nodes, which may vary by fewer axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Generic, TypeVar

import numpy as np

from compoundkin.base.buffers import empty_arrays
from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.programs.backends import runner_of
from compoundkin.programs.backends.contract import Runner
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.graph.flat_program import Carried, FlatProgram, flat_program
from compoundkin.programs.graph.operation_graph import OperationGraph

Name = TypeVar("Name")


@dataclass(frozen=True, eq=False, repr=False)
class ReadyProgram(PrintsShort, Generic[Name]):
    """A flat program made ready, and the nodes of what it finds by name.

    Two nodes are the parts of a planar vector.
    """

    flat: FlatProgram
    runner: Runner
    nodes: Mapping[Name, tuple[int, ...]]

    @classmethod
    def of(
        cls,
        graph: OperationGraph,
        nodes: Mapping[Name, tuple[int, ...]],
        numbers: CallNumbers,
        backend: str | None,
        carried: Sequence[Carried] = (),
    ) -> ReadyProgram[Name]:
        """Make the program of some nodes for numbers of some form."""
        wanted = [k for parts in nodes.values() for k in parts]
        flat = flat_program(graph, wanted, numbers.strata(graph), carried)
        return cls(flat, runner_of(flat, backend), nodes)

    def run(
        self, numbers: CallNumbers, threads: int = 1, given: Mapping[Name, Number] = MappingProxyType({})
    ) -> dict[Name, Number]:
        """Compute everything, (1 or designs, 1 or poses) each.

        Arrays that are `given`, designs x poses, are written.
        """
        rows: list[Number] = []
        narrow: list[tuple[Number, Number]] = []
        shapes = {name: [self.flat.shape(k, *numbers.extent) for k in parts] for name, parts in self.nodes.items()}
        wanted = [name for name in self.nodes if name not in given]
        kinds = [np.dtype(complex if len(self.nodes[name]) > 1 else float) for name in wanted]
        made = empty_arrays([(np.broadcast_shapes(*shapes[n]), kind) for n, kind in zip(wanted, kinds, strict=True)])
        found = {**dict.fromkeys(self.nodes), **dict(zip(wanted, made, strict=True)), **given}
        for name, whole in found.items():
            for shape, part in zip(shapes[name], (whole.real, whole.imag), strict=False):
                rows.append(part if shape == whole.shape else np.empty(shape))
                if shape != whole.shape:
                    narrow.append((part, rows[-1]))
        self.runner(numbers.arrays(self.flat), rows, numbers.extent, threads)
        for part, row in narrow:
            part[...] = row
        return found
