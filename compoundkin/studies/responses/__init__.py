"""What studies find of each design: one file for each kind; of this registry the first that fits is taken."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import course_figure
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.compilation import compile
from compoundkin.studies.responses.contract import Response
from compoundkin.studies.responses.course_response import CourseResponse
from compoundkin.studies.responses.designs import Designs, StudiedPath
from compoundkin.studies.responses.figure_response import FigureResponse

__all__ = ["Designs", "Response", "StudiedPath", "response_of", "studied_path"]


def response_of(motion: Motion, name: str) -> Response:
    """Return what a name asks of every design. Raises UnknownName with the nearest there is."""
    found = quantity(motion, name)
    of, figure = course_figure(name)
    if figure:
        return FigureResponse(name, (of,), found.unit, found.dimension, of=of, figure=figure)
    return CourseResponse(name, (name,), found.unit, found.dimension, is_vector=found.is_vector)


def studied_path(
    mechanism: Mechanism,
    free: Sequence[str],
    outputs: Sequence[str],
    values: Any = None,
    *,
    modes: Mapping[str, int] | str | Configuration | None = None,
    **rates: Any,
) -> tuple[StudiedPath, tuple[Response, ...]]:
    """Return the compiled path over one motion for what is asked, and the responses.

    `values` and rates (`speed`, `acceleration`, `jerk`, `time`) are those of `solve`.
    """
    reference = solve(mechanism, values, modes=modes, **rates)
    responses = tuple(response_of(reference, name) for name in outputs)
    needs = tuple(dict.fromkeys(need for one in responses for need in one.needs))
    compiled = compile(mechanism, needs, free=free, values=values, modes=modes)
    return StudiedPath(compiled, reference), responses
