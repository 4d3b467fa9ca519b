"""A compiled path: chosen outputs of a mechanism as a function of its drivers and free dimensions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.calls.quick_calls import QuickCalls
from compoundkin.programs.calls.written_arrays import held_arrays, hold_threads
from compoundkin.programs.derivatives.path_objective import PathObjective
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.derivatives.recorded_objective import ObjectivePose
from compoundkin.programs.derivatives.sensitivity_program import SensitivityPrograms
from compoundkin.programs.dimensions.designed_mechanism import designed
from compoundkin.programs.dimensions.dimension_values import dimension_values
from compoundkin.programs.jax_path import JaxPath, jax_path
from compoundkin.programs.path_programs import PathPrograms
from compoundkin.programs.path_values import PathValues
from compoundkin.programs.program_modes import program_modes
from compoundkin.programs.sources.source_writer import WritesSources


@dataclass(frozen=True, eq=False, repr=False)
class CompiledPath(WritesSources):
    """A mechanism compiled for some outputs, in one configuration.

    It is called with driver values and free dimensions. `names` are its outputs, `free` its dimensions, `modes` the
    name of its configuration, `backend` what computes it. It is pickled as what it was made of, and compiled anew.
    """

    programs: PathPrograms
    request: Mapping[str, Any]  # the arguments of `compile`

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its outputs."""
        return self.programs.names

    @property
    def free(self) -> tuple[str, ...]:
        """The names of its free dimensions."""
        return self.programs.free

    @property
    def backend(self) -> str:
        """What computes it: "llvm", or "numpy" where that is not installed."""
        return self.programs.backend

    def __call__(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        time: Any = None,
        out: Mapping[str, Any] | None = None,
        threads: int = 1,
    ) -> PathValues:
        """Compute the outputs at driver values and free dimensions.

        Values, rates and `time` are those of `solve`, and so are their defaults: radians or lengths, by the names of
        drivers, or bare for the only one. `dimensions` are numbers, points as complex numbers or (x, y), or arrays;
        the mechanism's own where they are not given. All broadcast, the last axis the motion. Arrays in `out`, by the
        names of outputs, are written: complex for points, of the call's shape. Results do not depend on the number of
        `threads`. Raises InvalidInput for what does not fit; warns UnassembledPoses and FewDigits as `solve`.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.programs.compilation import compile
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> compile(crank, "B")([0.0])["B"].tolist()
        [(2+0j)]
        """
        rates = speed, acceleration, jerk
        if out is None and time is None and self._quick is not None:
            found = self._quick.found(values, dimensions, rates, threads)
            if found is not None:
                return found
        hold_threads(threads)
        programs, numbers = self.programs, self.programs.numbers(values, dimensions, *rates, time=time)
        return programs.computed(numbers, threads, held_arrays(out, programs.outputs_of(numbers), numbers.shape))

    @cached_property
    def _quick(self) -> QuickCalls | None:
        return QuickCalls.of(self.programs)

    @property
    def modes(self) -> str | Configuration:
        """The configuration that it stays in, for `solve`.

        It is the name, or where a group has no signs the configuration itself.
        """
        return program_modes(self.programs.reference, self.programs.configuration)

    @checked
    def mechanism(self, dimensions: Mapping[str, Any] | None = None) -> Mechanism:
        """Return the mechanism with other values of free dimensions, perhaps arrays.

        What its pairs read off the drawing stays as it was. Raises InvalidInput for dimensions that are not free, and
        InvalidMechanism for those that no such mechanism can have, such as wheels that do not fit their axes.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.programs.compilation import compile
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> compile(crank, "B", free="crank.B.x").mechanism({"crank.B.x": 3.0}).links["crank"].points["B"]
        (3+0j)
        """
        stated = self.programs.stated
        values = dimension_values(stated, self.programs.dimensions, dimensions)
        return designed(stated, {one: value for one, value in values.items() if one.name in (dimensions or {})})

    @checked
    def objective(self, function: Callable[[ObjectivePose], Any]) -> PathObjective:
        """Return a function of each pose, summed over the poses of each design.

        `function` is given one pose: `at["G.position"]` is an output, any other name is given with each call.
        It is written in arithmetic and NumPy's functions of numbers.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.programs.compilation import compile
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> float(compile(crank, "B").objective(lambda at: abs(at["B"]) ** 2 * at["weight"])([0.0], weight=0.5))
        2.0
        """
        return PathObjective(self.programs, function)

    @checked
    def derivatives(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        time: Any = None,
        by: str | Sequence[str] | None = None,
        threads: int = 1,
    ) -> PathSensitivities:
        """Compute the outputs and their slopes at every pose.

        They are by all free dimensions and the drivers' values, or by those of the names `by`: "crank.B.x", "crank";
        "crank.B" is both coordinates. Raises UnknownName for others, and what a call does.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.programs.compilation import compile
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> found = compile(crank, "B", free="crank.B").derivatives([0.0])
        >>> found["B", "crank.B.x"].real.tolist(), found["B", "crank"].imag.tolist()
        ([1.0], [2.0])
        """
        numbers = self.programs.numbers(values, dimensions, speed, acceleration, jerk, time, is_sloped=True)
        return self.sensitivities.found(numbers, by, threads)

    @cached_property
    def sensitivities(self) -> SensitivityPrograms:
        """The programs that compute slopes at every pose."""
        return SensitivityPrograms(self.programs)

    def jax(self) -> JaxPath:
        """Return it as a pure function of JAX; raises InvalidInput where there is none."""
        return jax_path(self.programs)

    def __reduce__(self) -> tuple[Any, ...]:
        from compoundkin.programs.compilation import compiled_again

        return compiled_again, (dict(self.request),)

    def __copy__(self) -> CompiledPath:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> CompiledPath:
        return self

    def __repr__(self) -> str:
        of = f" of {', '.join(self.free)}" if self.free else ""
        return f"CompiledPath({self.programs.reference.mechanism.title!r}: {', '.join(self.names)}{of})"
