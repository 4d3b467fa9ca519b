"""Programs of sensitivities: outputs of a path and their slopes at every pose, by tangents."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import Problem, UnknownName, nearest
from compoundkin.base.series import Number
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.calls.written_arrays import hold_threads
from compoundkin.programs.derivatives.law_chain import chained, slope_inputs
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.derivatives.tangents import forward
from compoundkin.programs.derivatives.told_designs import told_designs
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.graph.input_kinds import DIMENSION, DRIVE
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.limits.settled_values import settled_values
from compoundkin.programs.ready_program import ReadyProgram
from compoundkin.programs.recorded_path import RecordedPath

if TYPE_CHECKING:
    from compoundkin.programs.path_programs import PathPrograms

# An output and what its slope is by; the output itself is by nothing, and the least margin of no output.
Wanted: TypeAlias = tuple[str, str]
_MARGIN = ("", "")


def sensitivity_program(
    path: RecordedPath, names: Sequence[str], by: Mapping[str, InputNumber], numbers: CallNumbers, backend: str | None
) -> ReadyProgram[Wanted]:
    """Make the program of a path's outputs and slopes for numbers of some form."""
    graph = path.mechanism.graph
    outputs = dict(zip(names, path.nodes, strict=True))
    wanted = [k for parts in path.nodes for k in parts]
    nodes: dict[Wanted, tuple[int, ...]] = {(name, ""): parts for name, parts in outputs.items()}
    for word, given in by.items():
        found = dict(zip(wanted, forward(graph, wanted, {graph.input(given): 1.0}), strict=True))
        nodes |= {(name, word): tuple(found[k] for k in parts) for name, parts in outputs.items()}
    nodes[_MARGIN] = (path.least,)
    return ReadyProgram.of(graph, nodes, numbers, backend, path.carried(numbers))


@dataclass(frozen=True, eq=False, repr=False)
class SensitivityPrograms(PrintsShort):
    """The programs that compute outputs of a path and their slopes."""

    path: PathPrograms
    _programs: dict[Any, ReadyProgram[Wanted]] = field(default_factory=dict)

    def found(self, numbers: CallNumbers, by: str | Sequence[str] | None, threads: int) -> PathSensitivities:
        """Compute outputs and slopes.

        They are by what is named, or by all free dimensions and drivers.
        """
        hold_threads(threads)
        known = _directions(numbers)
        named = list(known) if by is None else [by] if isinstance(by, str) else [str(name) for name in by]
        asked = [each for name in named for each in ([name] if name in known else _coordinates(name, known))]
        unknown = [name for name in asked if name not in known]
        if unknown:
            raise UnknownName([Problem(f"by.{name}", "it is no input", nearest(name, list(known))) for name in unknown])
        path, names = self.path, self.path.names
        laws = [one for one in path.law_numbers if one.name in asked]
        read = {name: known[name] for name in asked if name not in {one.name for one in laws}}
        wanted = read | {label: drive for label, (drive,) in slope_inputs(laws, path.order).items()}
        found = self._run(numbers, wanted, False, threads)
        look = path.limits.doubtful(numbers, found.pop(_MARGIN))
        outputs = [found.pop((name, "")) for name in names]
        failed = settled_values(numbers, names, outputs, look, path.solved)
        slopes = found
        if look is not None:
            slopes = {key: np.array(np.broadcast_to(slope, numbers.extent)) for key, slope in found.items()}
            for designs, told in told_designs(path, numbers, look.handed):
                solved = self._run(told, wanted, True, threads)
                for key, slope in slopes.items():
                    slope[designs] = solved[key]
        slopes = _chained(laws, numbers, slopes, names, path.order)
        values = path.shown(numbers, outputs, failed)
        return PathSensitivities(values, {key: _masked(values.found[key[0]], slope) for key, slope in slopes.items()})

    def _run(
        self, numbers: CallNumbers, by: Mapping[str, InputNumber], is_seeded: bool, threads: int
    ) -> dict[Wanted, Number]:
        key = numbers.form, tuple(by), is_seeded
        if key not in self._programs:
            path, backend = self.path.variant(numbers.still, is_seeded), self.path.chosen_backend
            self._programs[key] = sensitivity_program(path, self.path.names, by, numbers, backend)
        return self._programs[key].run(numbers, threads)


def _directions(numbers: CallNumbers) -> dict[str, InputNumber]:
    """Return the inputs that slopes can be by: free numbers, coordinates of free points, values of drivers."""
    found = {}
    for given in numbers.given:
        if given.kind == DIMENSION:
            found[given.full_name] = given
        elif (given.kind, given.part) == (DRIVE, "0"):
            found[given.name] = given
    return found


def _chained(
    laws: Sequence[FreeDimension],
    numbers: CallNumbers,
    slopes: Mapping[Wanted, Number],
    names: Sequence[str],
    order: int,
) -> dict[Wanted, Number]:
    """Return slopes with those by numbers of laws in the place of those by what the laws move."""
    found = dict(slopes)
    for one in laws:
        for name in names:
            own = {label: found.pop((name, label)) for label in slope_inputs([one], order)}
            found[name, one.name] = sum(chained(one, numbers, own, order))
    return found


def _coordinates(name: str, known: Mapping[str, InputNumber]) -> list[str]:
    """Return the coordinates of a free point, or the name itself."""
    return [each for each, given in known.items() if given.name == name] or [name]


def _masked(value: Number, slope: Number) -> Number:
    """Return a slope that is none where the value is none."""
    lost = np.isnan(value)
    return np.where(lost, np.nan, slope) if lost.any() else slope
