"""The programs of a compiled path: recorded variants, flat programs for the forms of calls, and looks at limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.known_curves import KnownCurves
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import Description
from compoundkin.programs.backends import chosen_back_end
from compoundkin.programs.call_numbers import (
    Call,
    CallNumbers,
    ReadyProgram,
    call_numbers,
    check_threads,
    output_arrays,
)
from compoundkin.programs.call_plans import CallPlan, CallPlans, ReadCall
from compoundkin.programs.call_seeds import CallSeeds
from compoundkin.programs.derivatives.law_slopes import with_law_slopes
from compoundkin.programs.dimensions import (
    FreeDimension,
    StatedDimensions,
    check_laws,
    dimension_values,
    mechanism_with,
)
from compoundkin.programs.drawn_approach import DrawnApproach
from compoundkin.programs.limit_screening import (
    LimitScreening,
    ScreenedDesigns,
    driver_value,
    negated_step,
    only_design,
)
from compoundkin.programs.path_values import PathValues
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_march import STEPS
from compoundkin.programs.recording.recorded_mechanism import Recording
from compoundkin.programs.recording.recorded_motion import ProgramOutput
from compoundkin.programs.solved_designs import (
    ProgramConfiguration,
    inputs_of_numbers,
    solve_designs,
    values_near_limits,
)

# The name of the least margin among the results of a program; before a driver's, what its longest step and the copy of
# its values are called. No output is named so.
LEAST, COPY = " ", "="


@dataclass(frozen=True, eq=False, repr=False)
class PathPrograms(ShortRepr):
    """A mechanism in one configuration, and the programs that compute its outputs from its free dimensions.

    `reference` is its own motion, from which the configuration is taken.
    """

    reference: Motion
    outputs: tuple[ProgramOutput, ...]
    dimensions: tuple[FreeDimension, ...]
    chosen_backend: str | None = None
    _variants: dict[Any, RecordedPath] = field(default_factory=dict)
    _programs: dict[Any, ReadyProgram[str]] = field(default_factory=dict)
    _curves: KnownCurves = field(default_factory=KnownCurves)

    @property
    def backend(self) -> str:
        """What computes it: "llvm", or "numpy" where that is not installed."""
        return chosen_back_end(self.chosen_backend)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of its outputs."""
        return tuple(output.name for output in self.outputs)

    @property
    def free(self) -> tuple[str, ...]:
        """The names of its free dimensions."""
        return tuple(one.name for one in self.dimensions)

    @cached_property
    def law_numbers(self) -> tuple[FreeDimension, ...]:
        """Its free dimensions that are numbers of laws."""
        return tuple(one for one in self.dimensions if one.is_of_law)

    @property
    def order(self) -> int:
        """The highest derivative among its outputs."""
        return max(output.attribute.order for output in self.outputs)

    @cached_property
    def stated(self) -> StatedDimensions:
        """All dimensions of its mechanism."""
        return StatedDimensions(self.reference.mechanism, self.reference.inputs.ends)

    @cached_property
    def configuration(self) -> ProgramConfiguration:
        """The configuration in which it stays."""
        return ProgramConfiguration.of(self.reference)

    @property
    def signs(self) -> dict[int, int]:
        """The modes of the groups that have signs, by their indices."""
        return self.configuration.signs

    @cached_property
    def seeds(self) -> CallSeeds:
        """The solver of the seeds of its calls."""
        own = {one: value for free in self.dimensions for one, value in free.parts_of(self.stated.own(free))}
        return CallSeeds(partial(self.solve, order=0), own, self.approach, self.chosen_backend)

    @cached_property
    def approach(self) -> DrawnApproach:
        """The approach from the drawing to the motions of its calls."""
        return DrawnApproach(self.reference, self.configuration.shown)

    @cached_property
    def limits(self) -> LimitScreening:
        """The programs of near-limit screening."""
        return LimitScreening(self._recording(), self.approach, self.chosen_backend)

    def variant(self, still: frozenset[tuple[str, int]], is_seeded: bool = False) -> RecordedPath:
        """Return it recorded where some rates of drivers are zero; the signs of its groups may be seeds."""
        if (still, is_seeded) not in self._variants:
            own = self._recording(still)
            # one step before that whose matrix all rates share: they then have the slopes of where it leads
            recording = replace(own, signs={}, steps=1) if is_seeded else own
            self._variants[still, is_seeded] = RecordedPath.of(recording, self.outputs, marches=not is_seeded)
        return self._variants[still, is_seeded]

    def _recording(self, still: frozenset[tuple[str, int]] = frozenset()) -> Recording:
        own = self.reference
        steps = STEPS if own.solving_order.numbered else 0
        read = tuple(one for one in self.dimensions if one.is_read)
        return Recording(own.solving_order, self.signs, read, self.order, still, own.inputs.ends, steps)

    def program(
        self, numbers: CallNumbers, moving: tuple[str, ...] = (), held: tuple[str, ...] = ()
    ) -> ReadyProgram[str]:
        """Return the program for numbers of this form; it computes all outputs, and then the least margin.

        Last are the longest steps of the drivers `moving`, negated, and copies of the values of those `held`.
        """
        key = numbers.form, moving, held
        if key not in self._programs:
            path = self.variant(numbers.still)
            graph, carried = path.mechanism.graph, path.carried(numbers)
            nodes = {**dict(zip(self.names, path.nodes, strict=True)), LEAST: (path.least,)}
            nodes |= {f"{LEAST}{name}": (negated_step(graph, name),) for name in moving}
            nodes |= {f"{COPY}{name}": (graph.input(driver_value(name)),) for name in held}
            self._programs[key] = ReadyProgram.of(graph, nodes, numbers, self.chosen_backend, carried)
        return self._programs[key]

    @cached_property
    def plans(self) -> CallPlans:
        """The plans of its calls."""
        return CallPlans(self)

    def values(self, call: Call, out: Any, threads: Any) -> PathValues:
        """Return the values of a call; raises InvalidInput for what does not fit."""
        read = self.plans.read(call)
        if read is not None and type(threads) is int and threads > 0:
            plan = read.plan
            program = plan.program(None, read, LEAST, self._program_of_inputs)
            if program is not None:
                given = None
                if out is not None:
                    given = self._arrays_of(out, program.vectors, plan.shape)
                    read.keep_apart(given.values())
                arrays, count = program.run(read, threads, given), len(self.names)
                # the least margin, the longest steps, and last the copies of what results keep
                rest = arrays[count:]
                del arrays[count:]
                for k in reversed(plan.held.values()):
                    read.given[k] = rest.pop()
                least, steps = rest[0], {name: rest[k] for k, name in enumerate(plan.moving, 1)}
                if self.limits.is_clear(read.driver_values, least, read.numbers, steps):
                    return self.path_values(read.numbers, arrays, None, plan.shape)
                # a full reading reports values that are not finite
                return self.checked_values(read.numbers() if read.is_finite() else self.numbers(call), arrays, least)
        check_threads(threads)
        numbers = self.numbers(call) if read is None else self._seeded_numbers(call, read)
        given = {} if out is None else self._arrays_of(out, self._are_vectors(self.program(numbers)), numbers.shape)
        return self.computed(numbers, threads, given)

    @staticmethod
    def _arrays_of(out: Any, vectors: Mapping[str, bool], shape: tuple[int, ...]) -> dict[str, Number]:
        """Return the caller's arrays as `output_arrays` does; those of an earlier call are often such already."""
        earlier = out.arrays_for(vectors, shape) if type(out) is PathValues else None
        return output_arrays(out, vectors, shape) if earlier is None else earlier

    def _program_of_inputs(self, plan: CallPlan, numbers: CallNumbers) -> ReadyProgram[str] | None:
        """Return the program of numbers without seeds; None where it needs some."""
        return None if self.variant(numbers.still).seeds else self.program(numbers, plan.moving, tuple(plan.held))

    def numbers(self, call: Call, with_slopes: bool = False) -> CallNumbers:
        """Return the numbers of a call, perhaps with the slopes of laws; raises InvalidInput for what does not fit."""
        read = self.plans.read(call)
        return self._read_in_full(call, with_slopes) if read is None else self._seeded_numbers(call, read, with_slopes)

    def _seeded_numbers(self, call: Call, read: ReadCall, with_slopes: bool = False) -> CallNumbers:
        """Return the numbers of a call that was read by its plan; a full reading reports what is not finite."""
        if not read.is_finite():
            return self._read_in_full(call, with_slopes)
        read.hold()
        numbers = read.numbers()
        return self.seeds.added(self.variant(numbers.still), numbers)

    def _read_in_full(self, call: Call, with_slopes: bool) -> CallNumbers:
        values = dimension_values(self.stated, self.dimensions, call.dimensions)
        order = self.reference.solving_order
        if self.law_numbers:
            check_laws(self.law_numbers, call.dimensions, call.times(order))
        numbers = call_numbers(order, call, values, self.order)
        self.plans.keep(call, numbers)
        numbers = self.seeds.added(self.variant(numbers.still), numbers)
        return (
            with_law_slopes(numbers, order, call, values, self.order) if with_slopes and self.law_numbers else numbers
        )

    def _are_vectors(self, program: ReadyProgram[str]) -> dict[str, bool]:
        """Return the names of its outputs, and which are vectors."""
        return {name: len(program.nodes[name]) > 1 for name in self.names}

    def computed(self, numbers: CallNumbers, threads: int, given: Mapping[str, Number]) -> PathValues:
        """Compute all outputs; those in arrays that are given are written there."""
        outputs = self.program(numbers).run(numbers, threads, given)
        least = outputs.pop(LEAST)
        return self.checked_values(numbers, list(outputs.values()), least)

    def unscreened(self, call: Call) -> tuple[dict[str, Number], Number]:
        """Return all outputs as they are computed, and which designs (designs,) are clear of limits.

        The others are not solved: their outputs mean nothing.
        """
        numbers = self.numbers(call)
        outputs = self.program(numbers).run(numbers, 1, {})
        return outputs, self.limits.clear(numbers, outputs.pop(LEAST))

    def solve(self, numbers: CallNumbers, order: int | None = None) -> Description:
        """Solve the designs of some numbers instead of computing them, in its configuration."""
        order = self.order if order is None else order
        is_one = numbers.extent[0] == 1 and len(numbers.driver_values) == 1
        design = only_design(numbers) if is_one else None
        if design is not None:
            with np.errstate(all="ignore"):
                known = self._curves.solved(design, partial(inputs_of_numbers, numbers), order)
            if known is not None:
                return known
        values = {one: one.value_in(numbers.given) for one in self.dimensions}
        # the drivers' values are among the numbers, and a law cannot have designs
        one_law = {one: value for one, value in values.items() if not (one.is_of_law and np.ndim(value))}
        mechanism = mechanism_with(self.stated, one_law, must_fit=False)
        found = solve_designs(mechanism, numbers, self.configuration, order)
        if design is not None:
            with np.errstate(all="ignore"):
                self._curves.keep(design, found.motion)
        return found

    def checked_values(self, numbers: CallNumbers, arrays: list[Number], least: Number) -> PathValues:
        """Return computed outputs, corrected near limits."""
        screened = self.limits.screen(numbers, least)
        failed = values_near_limits(numbers, self.names, arrays, screened, self.solve)
        return self.path_values(numbers, arrays, failed, screened=screened)

    def path_values(
        self,
        numbers: CallNumbers | Callable[[], CallNumbers],
        arrays: list[Number],
        failed: Number | None,
        shape: tuple[int, ...] | None = None,
        screened: ScreenedDesigns | None = None,
    ) -> PathValues:
        """Return outputs by name; angles are unwrapped along the motion in place."""
        for k in self._wrapped:
            found = self.outputs[k].continuous(arrays[k])
            if found is not arrays[k]:
                arrays[k][...] = found
        return PathValues(numbers, dict(zip(self.names, arrays, strict=True)), failed, self.solve, shape, screened)

    def __reduce__(self) -> tuple[Any, ...]:
        # results solve designs by it; its programs are made again where they are asked for
        return PathPrograms, (self.reference, self.outputs, self.dimensions, self.chosen_backend)

    @cached_property
    def _wrapped(self) -> tuple[int, ...]:
        return tuple(k for k, output in enumerate(self.outputs) if output.is_wrapped)
