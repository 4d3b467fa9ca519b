"""The forces of a motion as data for a page: arrows that follow the slider."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.view.page.markup import brief
from compoundkin.view.sketch.acting_forces import ForceCourse
from compoundkin.view.sketch.force_arrows import SHORTEST
from compoundkin.view.sketch.force_sketch import KINDS
from compoundkin.view.sketch.moving_forces import force_scales, shown_courses
from compoundkin.view.sketch.moving_sketch import MovingSketch

# A place that moves on its link by less than this part of the size is fixed there.
FIXED = 1e-9


def force_data(sketch: MovingSketch, forces: Forces, links: Mapping[str, int], chosen: Number) -> dict[str, Any]:
    """Return the arrows of forces at some poses.

    They have one scale, and each its place, force, kind and words.
    """
    courses = shown_courses(sketch, forces)
    scales = force_scales(sketch, forces, courses)
    if not scales:
        return {}
    one = scales[0]
    return {
        "scale": one.per_unit,
        "text": one.text,
        "length": one.amount * one.per_unit,
        "shortest": SHORTEST,
        "unit": forces.units.force,
        "kinds": {scale.kind: KINDS[scale.kind] for scale in scales},
        "arrows": [_arrow(forces, course, links, chosen, sketch.design) for course in courses],
    }


def _arrow(
    forces: Forces, course: ForceCourse, links: Mapping[str, int], chosen: Number, design: int
) -> dict[str, Any]:
    """One arrow. Its place is a point of its link where it is fixed there, else a place at every pose."""
    link, shown = forces.links[course.shown.link], course.shown

    def row(values: Any) -> Number:
        rows = np.broadcast_to(values, forces.shape).reshape(forces.inputs.designs, -1)
        return np.asarray(rows[design])

    own = (course.at - row(link.origin.position)) * np.exp(-1j * row(link.angle))
    known = own[np.isfinite(own)]
    force = course.force[chosen]
    packed = [brief(force.real), brief(force.imag)]
    found = {"name": shown.name, "told": shown.told, "kind": shown.kind, "force": packed}
    if len(known) and np.max(np.abs(known - known[0])) <= FIXED * forces.motion.size:
        return {**found, "link": links[shown.link], "x": float(known[0].real), "y": float(known[0].imag)}
    at = course.at[chosen]
    return {**found, "at": [brief(at.real), brief(at.imag)]}
