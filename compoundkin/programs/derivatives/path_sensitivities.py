"""Sensitivities of a compiled path: how its outputs change with dimensions and drivers at every pose, by tangents."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.programs.call_numbers import Call, CallNumbers, ReadyProgram, check_threads
from compoundkin.programs.derivatives.differentiation import forward
from compoundkin.programs.derivatives.law_slopes import law_slope_parts, slope_inputs
from compoundkin.programs.derivatives.solved_inputs import solved_inputs
from compoundkin.programs.graph.operation_graph import DIMENSION, DRIVE, InputNumber
from compoundkin.programs.path_values import PathValues
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.solved_designs import values_near_limits

if TYPE_CHECKING:
    from compoundkin.programs.path_programs import PathPrograms


@dataclass(frozen=True, eq=False, repr=False)
class PathSensitivities(ShortRepr):
    """Outputs over designs and poses, and their slopes there.

    `found["G.position"]` is an output, `found["G.position", "plate.C.x"]` its slope by a coordinate of a free point,
    `found["bar.angle", "slot.offset"]` that by a free number, and `found["bar.angle", "crank"]` that by a driver's
    value, its rates kept. They are arrays of the call's shape, complex for planar vectors, NaN where the output is.
    """

    values: PathValues
    slopes: Mapping[tuple[str, str], Number]

    @property
    def by(self) -> tuple[str, ...]:
        """The names of what slopes are by."""
        return tuple(dict.fromkeys(by for _, by in self.slopes))

    @property
    def assembled(self) -> Any:
        """Which poses are assembled, a bool array of the call's shape."""
        return self.values.assembled

    def __getitem__(self, name: str | tuple[str, str]) -> Any:
        """Return an output, or its slope; raises UnknownName.

        >>> import compoundkin as ck
        >>> crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
        >>> found = ck.compile(crank, "B", free="crank.B").derivatives([0.0])
        >>> found["B"].tolist(), found["B", "crank.B.y"].imag.tolist(), found["B", "crank"].imag.tolist()
        ([(2+0j)], [1.0], [2.0])
        """
        if not isinstance(name, tuple):
            return self.values[str(name)]
        output, by = map(str, name if len(name) == 2 else ("", name))
        if (output, by) not in self.slopes:
            wrong, known = (output, list(self.values.found)) if by in self.by else (by, list(self.by))
            raise UnknownName(Problem(str(wrong), "there is no such slope", suggestion(wrong, known)))
        numbers = self.values.numbers
        return np.broadcast_to(self.slopes[output, by], numbers.extent).reshape(numbers.shape)

    def __iter__(self) -> Iterator[str | tuple[str, str]]:
        """Return the names of the outputs, then those of the slopes."""
        return iter((*self.values, *self.slopes))

    def __repr__(self) -> str:
        return f"PathSensitivities({', '.join(self.values.found)} by {', '.join(self.by)})"


# An output and the name that its slope is by, which is empty for the output itself; both are for the least margin.
SlopeName: TypeAlias = tuple[str, str]
_MARGIN = ("", "")


def sensitivity_program(
    path: RecordedPath, names: Sequence[str], by: Mapping[str, InputNumber], numbers: CallNumbers, backend: str | None
) -> ReadyProgram[SlopeName]:
    """Make the program of a path's outputs and slopes for numbers of some form."""
    graph = path.mechanism.graph
    outputs = dict(zip(names, path.nodes, strict=True))
    wanted = [k for parts in path.nodes for k in parts]
    nodes: dict[SlopeName, tuple[int, ...]] = {(name, ""): parts for name, parts in outputs.items()}
    for word, given in by.items():
        tangents = dict(zip(wanted, forward(graph, wanted, {graph.input(given): 1.0}), strict=True))
        nodes |= {(name, word): tuple(tangents[k] for k in parts) for name, parts in outputs.items()}
    nodes[_MARGIN] = (path.least,)
    return ReadyProgram.of(graph, nodes, numbers, backend, path.carried(numbers))


@dataclass(frozen=True, eq=False, repr=False)
class SensitivityPrograms(ShortRepr):
    """The programs that compute outputs of a path and their slopes."""

    path: PathPrograms
    _programs: dict[Any, ReadyProgram[SlopeName]] = field(default_factory=dict)

    def computed(self, numbers: CallNumbers, by: str | Sequence[str] | None, threads: int) -> PathSensitivities:
        """Compute outputs and slopes by the names given, or by all free dimensions and drivers."""
        check_threads(threads)
        known = _directions(numbers)
        chosen = _chosen(known, by)
        path, names = self.path, self.path.names
        laws = [one for one in path.law_numbers if one.name in chosen]
        read = {name: known[name] for name in chosen if name not in {one.name for one in laws}}
        wanted = read | {label: drive for label, (drive,) in slope_inputs(laws, path.order).items()}
        slopes = self._run(numbers, wanted, False, threads)
        screened = path.limits.screen(numbers, slopes.pop(_MARGIN))
        outputs = [slopes.pop((name, "")) for name in names]
        failed = values_near_limits(numbers, names, outputs, screened, path.solve)
        if screened is not None:
            slopes = {key: np.array(np.broadcast_to(slope, numbers.extent)) for key, slope in slopes.items()}
            for designs, own in solved_inputs(path, numbers, screened.to_solve):
                solved = self._run(own, wanted, True, threads)
                for key, slope in slopes.items():
                    slope[designs] = solved[key]
        for one in laws:
            for name in names:
                parts = {label: slopes.pop((name, label)) for label in slope_inputs([one], path.order)}
                slopes[name, one.name] = sum(law_slope_parts(one, numbers, parts, path.order))
        values = path.path_values(numbers, outputs, failed)
        for key, slope in slopes.items():
            missing = np.isnan(values.found[key[0]])
            slopes[key] = np.where(missing, np.nan, slope) if missing.any() else slope
        return PathSensitivities(values, slopes)

    def unscreened(self, call: Call) -> tuple[dict[SlopeName, Number], Number]:
        """Return outputs and slopes as they are computed, and which designs (designs,) are clear of limits."""
        numbers = self.path.numbers(call, with_slopes=True)
        slopes = self._run(numbers, _directions(numbers), False, 1)
        return slopes, self.path.limits.clear(numbers, slopes.pop(_MARGIN))

    def _run(
        self, numbers: CallNumbers, by: Mapping[str, InputNumber], is_seeded: bool, threads: int
    ) -> dict[SlopeName, Number]:
        key = numbers.form, tuple(by), is_seeded
        if key not in self._programs:
            path, backend = self.path.variant(numbers.still, is_seeded), self.path.chosen_backend
            self._programs[key] = sensitivity_program(path, self.path.names, by, numbers, backend)
        return self._programs[key].run(numbers, threads)


def _chosen(known: Mapping[str, InputNumber], by: str | Sequence[str] | None) -> list[str]:
    """Return the inputs of the names given, or all. Raises UnknownName for what is none."""
    named = list(known) if by is None else [by] if isinstance(by, str) else [str(name) for name in by]
    # the name of a free point stands for both coordinates
    chosen = [
        each
        for name in named
        for each in ([] if name in known else [k for k, one in known.items() if one.name == name]) or [name]
    ]
    unknown = [name for name in chosen if name not in known]
    if unknown:
        what = "it is not an input"
        raise UnknownName([Problem(f"by.{name}", what, suggestion(name, list(known))) for name in unknown])
    return chosen


def _directions(numbers: CallNumbers) -> dict[str, InputNumber]:
    """Return the inputs that slopes can be by: free numbers, coordinates of free points, values of drivers."""
    found = {}
    for given in numbers.given:
        if given.kind == DIMENSION:
            found[given.full_name] = given
        elif (given.kind, given.part) == (DRIVE, "0"):
            found[given.name] = given
    return found
