"""Compiled paths: chosen outputs of a mechanism as a function of its drivers and free dimensions."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, UnknownName
from compoundkin.base.linear import one_thread
from compoundkin.kinematics.configuration import SIGNS, Configuration, named
from compoundkin.kinematics.solution import first_configuration, solve
from compoundkin.model.attributes import POSITION
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.backends import chosen_back_end
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.derivatives.path_objective import ObjectivePose, PathObjective
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities, SensitivityPrograms
from compoundkin.programs.dimensions import (
    StatedDimensions,
    check_redundant_pairs,
    check_single_values,
    dimension_values,
    free_dimensions,
    mechanism_with,
)
from compoundkin.programs.jax_path import JaxPath, jax_path
from compoundkin.programs.path_programs import PathPrograms
from compoundkin.programs.path_values import PathValues
from compoundkin.programs.recording.recorded_motion import output_of
from compoundkin.programs.sources.path_text import WritesSources
from compoundkin.structure.kinematic_structure import Structure


@checked
@one_thread
def compile(
    mechanism: Mechanism | Structure,
    outputs: str | Sequence[str],
    *,
    free: str | Sequence[str] = (),
    values: Any = None,
    modes: Mapping[str, int] | str | Configuration | None = None,
    hint: Mapping[str, Any] | None = None,
    backend: str | None = None,
) -> CompiledPath:
    """Return a fast function of drivers and free dimensions of a mechanism.

    `outputs` are quantities by name ("G.position", "bar.angle"), `free` the dimensions that every call may change
    ("crank.D" a point of a link). The assembly modes are those that `solve` takes for the mechanism as it stands, at
    its own driver values or `values`, or with `modes` and `hint`; all designs have them. Raises UnknownName for
    names that the mechanism does not have, and what `solve` raises.

    >>> import numpy as np
    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> path = compile(crank, "B.velocity.length", free="crank.B")
    >>> path([0.0, 1.0], {"crank.B": np.array([[1.0], [2.0]])}, speed=3.0)["B.velocity.length"][:, 0].tolist()
    [3.0, 6.0]
    """
    names = (outputs,) if isinstance(outputs, str) else tuple(dict.fromkeys(outputs))
    if not names:
        raise InvalidInput(Problem("outputs", "no output is named", 'compile(mechanism, ["G.position", ...])'))
    freed = (free,) if isinstance(free, str) else tuple(free)
    chosen_back_end(backend)
    with warnings.catch_warnings():
        # each call warns of unassembled poses and of rates with few digits
        warnings.simplefilter("ignore")
        motion = solve(mechanism, values, order=0, modes=modes, hint=hint)
    stated = StatedDimensions(motion.mechanism, motion.inputs.ends)
    dimensions = free_dimensions(stated, freed)
    check_single_values(stated, dimensions)
    check_redundant_pairs(motion, stated, dimensions)
    request = {"mechanism": mechanism, "outputs": names, "free": freed, "values": values, "modes": modes, "hint": hint}
    return CompiledPath(
        PathPrograms(motion, tuple(output_of(motion, name) for name in names), dimensions, backend),
        {**request, "backend": backend},
    )


def recorded_outputs(structure: Structure) -> tuple[list[str], list[str]]:
    """Return the outputs that a mechanism names and a program can compute, else the positions of all points.

    Return also why others cannot.
    """
    found, left_out = list[str](), list[str]()
    motion = solve(structure, order=0)
    for name in structure.mechanism.outputs:
        try:
            found.append(output_of(motion, name).name)
        except (UnknownName, InvalidInput) as error:
            left_out.append(str(error))
    return found or [f"{point}.{POSITION}" for point in structure.mechanism.carriers], left_out


def compile_request(request: Mapping[str, Any]) -> CompiledPath:
    """Return the path of a request, as after pickling."""
    return compile(**request)


@dataclass(frozen=True, eq=False, repr=False)
class CompiledPath(WritesSources):
    """A mechanism compiled for some outputs, in one configuration.

    It is called with driver values and free dimensions. `names` are its outputs, `free` its dimensions, `modes` the
    name of its configuration, `backend` what computes it. It is pickled as the arguments of `compile`.
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
        >>> from compoundkin.programs.compiled_path import compile
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> compile(crank, "B")([0.0])["B"].tolist()
        [(2+0j)]
        """
        return self.programs.values(Call(values, dimensions, speed, acceleration, jerk, time), out, threads)

    @property
    def modes(self) -> str | Configuration:
        """The configuration that it stays in, for `solve`.

        It is the name, or where a group has no signs the configuration itself.
        """
        reference, signs = self.programs.reference, self.programs.signs
        # numbers of configurations are those at one pose: where a group has them, the configuration itself is given
        numbered = first_configuration(reference, 0) if reference.solving_order.numbered else None
        if numbered is not None:
            return numbered
        two = {solver.index for solver in reference.solving_order.solvers if solver.modes == 2}
        return named(reference.structure, {k: SIGNS[sign] for k, sign in signs.items() if k in two})

    @checked
    def mechanism(self, dimensions: Mapping[str, Any] | None = None) -> Mechanism:
        """Return the mechanism with other values of free dimensions, perhaps arrays.

        What its pairs read off the drawing stays as it was. Raises InvalidInput for dimensions that are not free, and
        InvalidMechanism for those that no such mechanism can have, such as wheels that do not fit their axes.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.programs.compiled_path import compile
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> compile(crank, "B", free="crank.B.x").mechanism({"crank.B.x": 3.0}).links["crank"].points["B"]
        (3+0j)
        """
        stated = self.programs.stated
        values = dimension_values(stated, self.programs.dimensions, dimensions)
        return mechanism_with(stated, {one: value for one, value in values.items() if one.name in (dimensions or {})})

    @checked
    def objective(self, function: Callable[[ObjectivePose], Any]) -> PathObjective:
        """Return a function of each pose, summed over the poses of each design.

        `function` is given one pose: `at["G.position"]` is an output, any other name is given with each call.
        It is written in arithmetic and NumPy's functions of numbers.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.programs.compiled_path import compile
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
        >>> from compoundkin.programs.compiled_path import compile
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> found = compile(crank, "B", free="crank.B").derivatives([0.0])
        >>> found["B", "crank.B.x"].real.tolist(), found["B", "crank"].imag.tolist()
        ([1.0], [2.0])
        """
        numbers = self.programs.numbers(Call(values, dimensions, speed, acceleration, jerk, time), with_slopes=True)
        return self.sensitivities.computed(numbers, by, threads)

    @cached_property
    def sensitivities(self) -> SensitivityPrograms:
        """The programs that compute slopes at every pose."""
        return SensitivityPrograms(self.programs)

    def jax(self) -> JaxPath:
        """Return it as a pure function of JAX; raises InvalidInput where there is none."""
        return jax_path(self.programs)

    def __reduce__(self) -> tuple[Any, ...]:
        return compile_request, (dict(self.request),)

    def __copy__(self) -> CompiledPath:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> CompiledPath:
        return self

    def __repr__(self) -> str:
        of = f" of {', '.join(self.free)}" if self.free else ""
        return f"CompiledPath({self.programs.reference.mechanism.title!r}: {', '.join(self.names)}{of})"
