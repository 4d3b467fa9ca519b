"""Compilation: from a mechanism, names of outputs and free dimensions to a compiled path."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.solution import solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.backends import chosen_back_end
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.programs.dimensions.named_dimensions import free_dimensions, hold_one_design
from compoundkin.programs.dimensions.redundant_dimensions import hold_consistent
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions
from compoundkin.programs.path_programs import PathPrograms
from compoundkin.programs.recording.recorded_outputs import output_of
from compoundkin.structure.kinematic_structure import Structure


@checked
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
    its own driver values or `values`, or with `modes` and `hint`; they are kept for all designs. Raises UnknownName for
    what there is not, and what `solve` raises.

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
        # what is not assembled or has few digits is told at each call
        warnings.simplefilter("ignore")
        motion = solve(mechanism, values, order=0, modes=modes, hint=hint)
    found = tuple(output_of(motion, name) for name in names)
    stated = StatedDimensions(motion.mechanism, motion.inputs.ends)
    dimensions = free_dimensions(stated, freed)
    hold_one_design(stated, dimensions)
    hold_consistent(motion, stated, dimensions)
    request = {"mechanism": mechanism, "outputs": names, "free": freed, "values": values, "modes": modes, "hint": hint}
    return CompiledPath(PathPrograms(motion, found, dimensions, backend), {**request, "backend": backend})


def compiled_again(request: Mapping[str, Any]) -> CompiledPath:
    """Return the path of a request, as after pickling."""
    return compile(**request)
