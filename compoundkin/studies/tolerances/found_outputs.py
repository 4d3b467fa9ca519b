"""The outputs of a mechanism with tolerances: nominal values, slopes, and values of random designs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import FewDigits, NotAssembled, Problem, UnassembledPoses, suppress_pose_warnings, warn
from compoundkin.model.attributes import AXES, PARTS, RADIANS
from compoundkin.studies.responses import Response
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.sampled_output import SampledOutput
from compoundkin.studies.tolerances.toleranced_designs import TolerancedDesigns


def found_outputs(
    designs: TolerancedDesigns, responses: Sequence[Response], percents: tuple[float, ...]
) -> tuple[dict[str, OutputTolerance], int]:
    """Return the outputs by name, and how many random designs are left out.

    A vector is two outputs. Raises NotAssembled where the mechanism itself or too many random designs are not assembled
    over the whole motion; warns UnassembledPoses of some.
    """
    _hold_nominal(designs)
    values, assembled = designs.found(responses)
    _tell(assembled)
    outputs: dict[str, OutputTolerance] = {}
    for response in responses:
        for one in _outputs(designs, response, values[response.name][assembled], percents):
            outputs[one.name] = one
            _tell_slopes(one)
    return outputs, int(np.count_nonzero(~assembled))


def _outputs(
    designs: TolerancedDesigns, response: Response, sampled: Number, percents: tuple[float, ...]
) -> Iterator[OutputTolerance]:
    nominal = designs.nominal
    shape = (designs.path.reference.inputs.poses,) if response.is_course else ()
    values = np.broadcast_to(response.values(nominal), (1, *shape))[0]
    coordinates = designs.path.coordinates
    slopes = np.broadcast_to(response.slopes(nominal), (len(coordinates), 1, *shape))[:, 0]
    for axis in AXES if response.is_vector else ("",):
        part = PARTS.get(axis, np.real)
        name = f"{response.name}.{axis}" if axis else response.name
        by = dict(zip(coordinates, part(slopes), strict=True))
        near = SampledOutput(_near(name, part(sampled), part(values), response.unit), percents)
        yield OutputTolerance(name, response.unit, response.dimension, part(values), by, designs.sources, near)


def _near(name: str, values: Number, nominal: Number, unit: str) -> Number:
    """Return the values of designs that have one wherever the mechanism itself does.

    Angles are counted by the turn that is nearest to the nominal one.
    """
    has = ~(np.isnan(values) & ~np.isnan(nominal)).reshape(len(values), -1).any(axis=1)
    if np.count_nonzero(has) < 2:
        what = f"it has no value in {np.count_nonzero(~has)} of {len(has)} random designs"
        raise NotAssembled(Problem(f"outputs.{name}", what, "give closer tolerances, or leave it out"))
    values = values if has.all() else values[has]
    return values - whole_turns(values - nominal) if unit == RADIANS else values


def _tell_slopes(one: OutputTolerance) -> None:
    lacking = np.isnan(one.deviation) & ~np.isnan(one.nominal)
    if lacking.any():
        where = f" at {np.count_nonzero(lacking)} of {lacking.size} poses" if one.is_course else ""
        told = f"{one.name} has no slopes{where}, at a limit or a change point; only the random designs tell there"
        warn(told, FewDigits)


def _hold_nominal(designs: TolerancedDesigns) -> None:
    with suppress_pose_warnings():
        missing = int(np.count_nonzero(~designs.nominal.found.assembled))
    if missing:
        what = f"{count_phrase(missing, 'pose')} of the mechanism itself cannot be assembled"
        raise NotAssembled(Problem("values", what, "give values at which it can, gaps(solve(...)) tells where"))


def _tell(assembled: Number) -> None:
    missing, count = np.count_nonzero(~assembled), len(assembled)
    if count - missing < 2:
        what = f"{missing} of {count} random designs cannot be assembled over the whole motion"
        raise NotAssembled(
            Problem("tolerances", what, "give closer tolerances, or values that are farther from limits")
        )
    if missing:
        told = f"{missing} of {count} random designs cannot be assembled over the whole motion; "
        warn(told + "percentiles are those of the others", UnassembledPoses)
