"""Outputs with tolerances as plots show them: by name, at a pose, in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.model.attributes import readable
from compoundkin.model.component_names import component_names
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.plot.plotted_rows import along
from compoundkin.view.plot.point_labels import number
from compoundkin.view.plot.study_columns import shown_of


def outputs_of(found: ToleranceAnalysis, name: str) -> list[OutputTolerance]:
    """Return the outputs of a name: both components of a vector. Raises UnknownName."""
    both = component_names(name)
    return [found[one] for one in (both if name not in found.outputs and both[0] in found.outputs else [name])]


def output_of(found: ToleranceAnalysis, name: str) -> OutputTolerance:
    """Return the output of a name. Raises InvalidInput for a vector."""
    one, *others = outputs_of(found, name)
    if others:
        raise InvalidInput(Problem(name, "it is a vector", f"take {one.name} or {others[0].name}"))
    return one


def courses_of(found: ToleranceAnalysis, names: Sequence[str]) -> list[OutputTolerance]:
    """Return the outputs of names with values at every pose.

    Of no names they are all that there are. Raises UnknownName, InvalidInput where there is none.
    """
    among = [one for name in names for one in outputs_of(found, name)] if names else list(found.values())
    wrong = next((one for one in among if names and not one.is_course), None)
    if wrong is not None:
        what, remedy = "it is one number of the whole motion", "contributions() and histogram() draw it"
        raise InvalidInput(Problem(wrong.name, what, remedy))
    courses = [one for one in among if one.is_course]
    if not courses:
        what = "no output of the analysis has values at every pose"
        raise InvalidInput(Problem("quantities", what, "contributions() and histogram() draw figures"))
    return courses


def pose_of(one: OutputTolerance, pose: int | None) -> int | None:
    """Return the pose that is meant.

    Without one it is that of the greatest deviation; None of a figure. Raises InvalidInput where there is no such pose.
    """
    if not one.is_course:
        if pose is not None:
            raise InvalidInput(Problem("pose", f"{one.name} is one number of the whole motion", "leave it out"))
        return None
    poses = len(one.nominal)
    if pose is None:
        known = np.isfinite(one.deviation)
        return int(np.argmax(np.where(known, one.deviation, -1.0)))
    if not 0 <= pose < poses:
        raise InvalidInput(Problem("pose", f"there is no pose {pose}", f"0 to {poses - 1}"))
    return pose


def value_at(values: Number, pose: int | None) -> float:
    """Return the value of a figure, or of a course at a pose."""
    return float(values if pose is None else np.asarray(values)[pose])


def place_words(found: ToleranceAnalysis, one: OutputTolerance, pose: int | None) -> str:
    """Say which output it is, and at which pose: "rocker.angle at crank 20 deg"."""
    if pose is None:
        return one.name
    x, _ = along(found.motion, None)
    return f"{one.name} at {x.name} {number(float(x.values[0, pose]), x.scale)} {readable(x.unit)}".rstrip()


def shown_words(one: OutputTolerance, value: float) -> str:
    """Write a value of an output with its unit, angles in degrees."""
    shown = shown_of(one.name, one.unit, np.array([value]))
    return f"{number(float(shown.values[0]))} {readable(shown.unit)}".rstrip()
