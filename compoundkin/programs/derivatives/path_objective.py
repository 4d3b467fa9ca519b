"""An objective of a compiled path: a function of each pose, summed over the poses, and its gradient."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import UnassembledPoses, warn
from compoundkin.programs.calls.call_numbers import CallNumbers, picked
from compoundkin.programs.calls.written_arrays import hold_threads
from compoundkin.programs.derivatives.law_chain import slope_inputs, summed_slopes
from compoundkin.programs.derivatives.objective_program import ObjectiveForm, ObjectiveValues, objective_program
from compoundkin.programs.derivatives.parameters import with_parameters
from compoundkin.programs.derivatives.recorded_objective import ObjectivePose
from compoundkin.programs.derivatives.told_designs import ASSEMBLED, EVERYWHERE, SOLVED, told_designs
from compoundkin.programs.ready_program import ReadyProgram

if TYPE_CHECKING:
    from compoundkin.programs.path_programs import PathPrograms


@dataclass(frozen=True, eq=False, repr=False)
class PathObjective(PrintsShort):
    """A function of the poses of a compiled path, summed over them.

    It is called like the path, and with what the function reads besides outputs (`target=...`): numbers or arrays, real
    or complex, that broadcast with the others. The sum is NaN where some pose is not assembled, unless the function
    leaves such poses out: `np.where(at.assembled, ..., 0.0)`.
    """

    path: PathPrograms
    function: Callable[[ObjectivePose], Any]
    _programs: dict[Any, ReadyProgram[str]] = field(default_factory=dict)

    @checked
    def __call__(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        time: Any = None,
        threads: int = 1,
        **given: Any,
    ) -> Any:
        """Return the sum over the poses of each design.

        Its shape is that of the call without the last axis. Raises UnknownName for what is given and not read, or read
        and not given; InvalidInput for what cannot be recorded or does not broadcast.

        >>> import compoundkin as ck
        >>> crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
        >>> cost = ck.compile(crank, "B", free="crank.B").objective(lambda at: abs(at["B"] - at["target"]) ** 2)
        >>> float(cost([0.0, 0.0], {"crank.B": 3.0}, target=1.0))
        8.0
        """
        numbers = self.path.numbers(values, dimensions, speed, acceleration, jerk, time)
        return self._found(numbers, given, False, threads)[0]

    @checked
    def gradient(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        time: Any = None,
        threads: int = 1,
        **given: Any,
    ) -> tuple[Any, dict[str, Any]]:
        """Return the sum and its slopes by all free dimensions.

        The slope by a point is complex: by x, and i times that by y. The slope by a dimension that varies along the
        motion does so too, others have the shape of the sum. Raises what a call does. Source: reverse accumulation; A.
        Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008.

        >>> import compoundkin as ck
        >>> crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
        >>> cost = ck.compile(crank, "B", free="crank.B").objective(lambda at: abs(at["B"] - at["target"]) ** 2)
        >>> value, slope = cost.gradient([0.0, 0.0], target=1.0)
        >>> float(value), complex(slope["crank.B"])
        (2.0, (4+0j))
        """
        numbers = self.path.numbers(values, dimensions, speed, acceleration, jerk, time, is_sloped=True)
        return self._found(numbers, given, True, threads)

    def _found(
        self, numbers: CallNumbers, given: Mapping[str, Any], is_sloped: bool, threads: int
    ) -> tuple[Any, dict[str, Any]]:
        """Return value and slopes; designs that come near a limit are computed again with masks."""
        hold_threads(threads)
        whole, complex_names = with_parameters(numbers, given)
        run, path = partial(self._run, complex_names, is_sloped, threads), self.path
        every = np.arange(whole.extent[0])
        found = run(whole, EVERYWHERE)
        look = path.limits.doubtful(whole, found.least)
        if look is None:
            return found.shaped(whole.shape)
        parts = [(every, found)]
        if len(look.lost):
            parts.append((look.lost, run(picked(whole, look.lost), ASSEMBLED)))
        parts += [(part, run(told, SOLVED)) for part, told in told_designs(path, whole, look.handed)]
        joined = ObjectiveValues.joined(len(every), parts)
        missing = int(np.count_nonzero(np.isnan(joined.value)))
        if missing:
            of_all = f"{missing} of {len(every)} designs have poses that cannot be assembled"
            warn(f"{of_all}: numpy.where(at.assembled, ..., 0.0) leaves them out", UnassembledPoses)
        return joined.shaped(whole.shape)

    def _run(
        self, given: Mapping[str, bool], is_sloped: bool, threads: int, numbers: CallNumbers, known: str
    ) -> ObjectiveValues:
        key = numbers.form, tuple(given.items()), is_sloped, known
        if key not in self._programs:
            path = self.path
            by = slope_inputs(path.dimensions, path.order) if is_sloped else {}
            form = ObjectiveForm(self.function, given, by, known)
            variant = path.variant(numbers.still, known == SOLVED)
            self._programs[key] = objective_program(variant, path.names, numbers, form, path.chosen_backend)
        found = ObjectiveValues.of(self._programs[key].run(numbers, threads))
        if not (is_sloped and self.path.law_numbers):
            return found
        return replace(found, slopes=summed_slopes(self.path.dimensions, numbers, found.slopes, self.path.order))

    def __repr__(self) -> str:
        return f"PathObjective(of {self.path!r})"
