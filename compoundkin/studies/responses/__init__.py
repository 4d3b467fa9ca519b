"""Responses: what studies compute for each design; the first kind of the registry that fits is used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem, UnknownName
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.extremes.stretches import measure_of
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import STROKE, VALUE, motion_figure
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.compiled_path import compile
from compoundkin.programs.recording.recorded_motion import output_of
from compoundkin.studies.responses.designs import Designs, StudiedPath
from compoundkin.studies.responses.figure_response import PARTS_OF, FigureResponse, SolvedResponse, StrokeRatioResponse
from compoundkin.studies.responses.response import CourseResponse, Response, SummedResponse, summed_response

__all__ = ["Designs", "Response", "StudiedPath", "response_of", "studied_path"]


def response_of(motion: Motion, name: str) -> Response:
    """Return the response of a name. Raises UnknownName with the nearest name."""
    found = quantity(motion, name)
    of, figure = motion_figure(name)
    if not _is_computed(motion, of):
        return _solved(found, not figure)
    if not figure:
        return CourseResponse(name, (name,), found.unit, found.dimension, is_vector=found.is_vector)
    measure = measure_of(motion, of)
    told = measure.unit, measure.dimension
    if figure in PARTS_OF:
        return FigureResponse(name, (of,), *told, of=of, figure=figure, squared=measure.squared)
    stroke = FigureResponse(f"{of}.{STROKE}", (of,), *told, of=of, figure=STROKE, squared=measure.squared)
    return StrokeRatioResponse(name, (of,), found.unit, found.dimension, stroke=stroke, figure=figure)


def _solved(found: Quantity, is_course: bool) -> Response:
    return SolvedResponse(found.name, (), found.unit, found.dimension, is_course, found.is_vector)


def _is_computed(motion: Motion, name: str) -> bool:
    """Return whether programs can compute an output."""
    try:
        output = output_of(motion, name)
        if output.is_derived:
            # whether a figure is arithmetic of one pose is seen when it is recorded
            _ = compile(motion.mechanism, name).programs.variant(frozenset())
    except InvalidInput:
        return False
    return True


def studied_path(
    mechanism: Mechanism,
    free: Sequence[str],
    outputs: Sequence[str] | Mapping[str, Any],
    values: Any = None,
    *,
    given: Mapping[str, Any] | None = None,
    modes: Mapping[str, int] | str | Configuration | None = None,
    **rates: Any,
) -> tuple[StudiedPath, tuple[Response, ...]]:
    """Return the compiled path over one motion, and the responses of the outputs.

    `outputs` are names, or functions of a pose by names of their own, summed over the motion; these read what is
    `given` besides. `values` and rates (`speed`, `acceleration`, `jerk`, `time`) are those of `solve`. Raises
    UnknownName for unknown outputs, and for given data that no function reads.
    """
    reference = solve(mechanism, values, modes=modes, **rates)
    responses = _responses(reference, outputs, given or {})
    needs = tuple(dict.fromkeys(need for one in responses for need in one.needs))
    driver = f"{next(iter(reference.drives))}.{VALUE}"
    compiled = compile(mechanism, needs or driver, free=free, values=values, modes=modes)
    if compiled.programs.variant(frozenset()).seeds:
        # between its poses a motion of which something is found by search is solved
        responses = tuple(_between_solved(reference, one) for one in responses)
    return StudiedPath(compiled, reference, (values, rates)), responses


def _responses(
    motion: Motion, outputs: Sequence[str] | Mapping[str, Any], given: Mapping[str, Any]
) -> tuple[Response, ...]:
    functions = outputs if isinstance(outputs, Mapping) else dict.fromkeys(outputs)
    found = tuple(
        response_of(motion, name) if function is None else summed_response(motion, name, function, given)
        for name, function in functions.items()
    )
    read = {one for response in found if isinstance(response, SummedResponse) for one in response.given}
    unread = [name for name in given if name not in read]
    if unread:
        what, remedy = "no function of a pose reads it", "leave it out"
        raise UnknownName([Problem(f"given.{name}", what, remedy) for name in unread])
    return found


def _between_solved(reference: Motion, one: Response) -> Response:
    return (
        _solved(quantity(reference, one.name), False) if isinstance(one, FigureResponse | StrokeRatioResponse) else one
    )
