"""A compiled path: chosen outputs of a mechanism as a function of its drivers and free dimensions."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort
from compoundkin.kinematics.lost_digits import Told
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.call_numbers import CallNumbers, call_numbers
from compoundkin.programs.call_seeds import with_seeds
from compoundkin.programs.derivatives.path_objective import PathObjective
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.derivatives.recorded_objective import ObjectivePose
from compoundkin.programs.derivatives.result_arrays import results
from compoundkin.programs.derivatives.sensitivity_program import SensitivityPrograms
from compoundkin.programs.dimensions.designed_mechanism import designed
from compoundkin.programs.dimensions.dimension_values import dimension_values
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.named_dimensions import free_dimensions
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.jax_path import JaxPath, jax_path
from compoundkin.programs.limit_look import LimitPrograms
from compoundkin.programs.path_values import PathValues
from compoundkin.programs.ready_program import ReadyProgram, RecordedPath
from compoundkin.programs.recording.recorded_march import STEPS
from compoundkin.programs.recording.recorded_mechanism import Recording
from compoundkin.programs.recording.recorded_outputs import ProgramOutput, output_of
from compoundkin.programs.settled_values import settled_values
from compoundkin.programs.solved_designs import ProgramConfiguration, solved_designs
from compoundkin.programs.sources.source_writer import WritesSources
from compoundkin.structure.kinematic_structure import Structure


@checked
def compile(
    mechanism: Mechanism | Structure,
    outputs: str | Sequence[str],
    *,
    free: str | Sequence[str] = (),
    values: Any = None,
    modes: Any = None,
    hint: Mapping[str, Any] | None = None,
    backend: str | None = None,
) -> CompiledPath:
    """Return a fast function of drivers and free dimensions of a mechanism.

    `outputs` are quantities by name ("G.position", "bar.angle"), `free` the dimensions that every call may change
    ("crank.D" a point of a link). The assembly modes are those that `solve` takes for the mechanism as it stands, at
    its own driver values or `values`, or with `modes` and `hint`; they are kept for all designs. Raises UnknownName for
    what there is not, and what `solve` raises.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> two, path = [[1.0], [2.0]], compile(crank, "B.velocity.length", free="crank.B")
    >>> path([0.0, 1.0], {"crank.B": two}, speed=3.0)["B.velocity.length"][:, 0].tolist()
    [3.0, 6.0]
    """
    names = (outputs,) if isinstance(outputs, str) else tuple(dict.fromkeys(outputs))
    freed = (free,) if isinstance(free, str) else tuple(free)
    with warnings.catch_warnings():
        # what is not assembled or has few digits is told at each call
        warnings.simplefilter("ignore")
        motion = solve(mechanism, values, order=0, modes=modes, hint=hint)
    found = tuple(output_of(motion, name) for name in names)
    dimensions = free_dimensions(StatedDimensions(motion.mechanism, motion.inputs.ends), freed)
    return CompiledPath(motion, found, dimensions, backend)


@dataclass(frozen=True, eq=False, repr=False)
class CompiledPath(WritesSources, PrintsShort):
    """A mechanism compiled for some outputs.

    `reference` is its own motion, from which the configuration is taken.
    """

    reference: Motion
    outputs: tuple[ProgramOutput, ...]
    dimensions: tuple[FreeDimension, ...]
    chosen_backend: str | None = None
    _variants: dict[Any, RecordedPath] = field(default_factory=dict)
    _programs: dict[Any, ReadyProgram] = field(default_factory=dict)

    @property
    def free(self) -> tuple[str, ...]:
        """The names of its free dimensions."""
        return tuple(one.name for one in self.dimensions)

    @cached_property
    def stated(self) -> StatedDimensions:
        """All dimensions of its mechanism."""
        return StatedDimensions(self.reference.mechanism, self.reference.inputs.ends)

    def mechanism(self, dimensions: Mapping[str, Any] | None = None) -> Mechanism:
        """Return its mechanism with other values of free dimensions, arrays of designs."""
        values = dimension_values(self.stated, self.dimensions, dimensions or {})
        return designed(self.stated, {one: value for one, value in values.items() if one.name in (dimensions or {})})

    @property
    def order(self) -> int:
        """The highest derivative that its outputs ask for."""
        return max(output.attribute.order for output in self.outputs)

    @property
    def signs(self) -> dict[int, int]:
        """The modes of the groups that have signs, by their indices."""
        return self.configuration.signs

    def __call__(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        threads: int = 1,
    ) -> PathValues:
        """Compute the outputs at driver values and free dimensions.

        Values are radians or lengths; all broadcast, the last axis the motion.

        >>> from compoundkin.model.elements import drive, link
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> compile(crank, "B")([0.0])["B"].tolist()
        [(2+0j)]
        """
        return self._computed(self.numbers(values, dimensions, speed, acceleration, jerk), threads)

    def numbers(
        self, values: Any, dimensions: Mapping[str, Any] | None, speed: Any, acceleration: Any, jerk: Any
    ) -> CallNumbers:
        """Return the numbers of a call; raises InvalidInput for what does not fit."""
        rates = {"speed": speed, "acceleration": acceleration, "jerk": jerk}
        order = self.reference.solving_order
        numbers = call_numbers(order, self.stated, self.dimensions, values, dimensions, rates)
        return with_seeds(self.variant(numbers.still), numbers, partial(self.solved, order=0), self.chosen_backend)

    @checked
    def objective(self, function: Callable[[ObjectivePose], Any]) -> PathObjective:
        """Return a function of each pose, summed over the poses of each design.

        `function` is given one pose: `at["G.position"]` is an output, any other name is given with each call.
        It is written in arithmetic and NumPy's functions of numbers.

        >>> from compoundkin.model.elements import drive, link
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> float(compile(crank, "B").objective(lambda at: abs(at["B"]) ** 2 * at["weight"])([0.0], weight=0.5))
        2.0
        """
        return PathObjective(self, function)

    @checked
    def derivatives(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        by: Sequence[str] | None = None,
        threads: int = 1,
    ) -> PathSensitivities:
        """Compute the outputs and their slopes at every pose.

        They are by all free dimensions and the drivers' values, or by those of the names `by`: "crank.B.x", "crank".
        Raises UnknownName for others, and what a call does.

        >>> from compoundkin.model.elements import drive, link
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> found = compile(crank, "B", free="crank.B").derivatives([0.0])
        >>> found["B", "crank.B.x"].real.tolist(), found["B", "crank"].imag.tolist()
        ([1.0], [2.0])
        """
        numbers = self.numbers(values, dimensions, speed, acceleration, jerk)
        return self.sensitivities.found(numbers, by, threads)

    @cached_property
    def sensitivities(self) -> SensitivityPrograms:
        """The programs that compute slopes at every pose."""
        return SensitivityPrograms(self)

    def jax(self) -> JaxPath:
        """Return it as a pure function of JAX; raises InvalidInput where there is none."""
        return jax_path(self)

    def _computed(self, numbers: CallNumbers, threads: int) -> PathValues:
        program = self.program(numbers)
        names = [output.name for output in self.outputs]
        nodes = dict(zip((*names, ""), (*program.nodes, program.flat.outputs[-1:]), strict=True))
        found = results(program.flat, program.runner, numbers, nodes, threads)
        least, arrays = found.pop(""), list(found.values())
        failed = settled_values(numbers, names, arrays, self.limits.doubtful(numbers, least), self.solved)
        whole = (output.continuous(array) for output, array in zip(self.outputs, arrays, strict=True))
        return PathValues(numbers, dict(zip(names, whole, strict=True)), failed, self.solved)

    @cached_property
    def limits(self) -> LimitPrograms:
        """The programs that look at designs near limits."""
        return LimitPrograms(self._recording(), self.reference, self.configuration.shown, self.chosen_backend)

    @cached_property
    def configuration(self) -> ProgramConfiguration:
        """The configuration in which it stays."""
        return ProgramConfiguration.of(self.reference)

    def solved(self, numbers: CallNumbers, order: int | None = None) -> Told:
        """Solve the designs of some numbers instead, in its configuration."""
        mechanism = designed(self.stated, {one: one.value_in(numbers.given) for one in self.dimensions})
        return solved_designs(mechanism, numbers, self.configuration, self.order if order is None else order)

    def variant(self, still: frozenset[tuple[str, int]], is_seeded: bool = False) -> RecordedPath:
        """Return it recorded where some rates of drivers are zero, the signs of its groups perhaps as seeds."""
        if (still, is_seeded) not in self._variants:
            recording = replace(self._recording(still), signs={}, steps=0) if is_seeded else self._recording(still)
            self._variants[still, is_seeded] = RecordedPath.of(recording, self.outputs)
        return self._variants[still, is_seeded]

    def _recording(self, still: frozenset[tuple[str, int]] = frozenset()) -> Recording:
        own = self.reference
        steps = STEPS if own.solving_order.numbered else 0
        return Recording(own.solving_order, self.signs, self.dimensions, self.order, still, own.inputs.ends, steps)

    def program(self, numbers: CallNumbers) -> ReadyProgram:
        """Return the program for numbers of these forms."""
        if numbers.form not in self._programs:
            self._programs[numbers.form] = ReadyProgram.of(self.variant(numbers.still), numbers, self.chosen_backend)
        return self._programs[numbers.form]

    def __repr__(self) -> str:
        return f"CompiledPath({self.reference.mechanism.title!r}: {', '.join(o.name for o in self.outputs)})"


__all__ = ["CompiledPath", "compile"]
