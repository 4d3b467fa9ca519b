"""Forces as data for the scripts of a page: arrows and arcs with their places, kinds, names and texts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.force_analysis import loaded_forces
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics import Motion
from compoundkin.view.page.markup import packed_floats
from compoundkin.view.sketch import force_arrows
from compoundkin.view.sketch.force_arrows import (
    KINDS,
    ForceCourse,
    drawn_force_courses,
    drawn_moment_courses,
    force_scales,
)
from compoundkin.view.sketch.kinematic_sketch import MovingSketch

# A place that moves on its link by less than this part of the size is fixed there.
FIXED_PLACE = 1e-9


class DrawnForces(NamedTuple):
    """Forces with the courses that are drawn: as arrows, and as arcs."""

    forces: Forces
    arrows: tuple[ForceCourse, ...]
    arcs: tuple[ForceCourse, ...]


def drawn_forces(motion: Motion, sketch: MovingSketch) -> DrawnForces | None:
    """Return the forces of a motion that are drawn, None where nothing acts."""
    forces = loaded_forces(motion)
    if forces is None:
        return None
    arrows, arcs = (drawn(forces, sketch.scene, sketch.design) for drawn in (drawn_force_courses, drawn_moment_courses))
    return DrawnForces(forces, arrows, arcs) if arrows or arcs else None


def force_data(sketch: MovingSketch, drawn: DrawnForces, links: Mapping[str, int], chosen: Number) -> dict[str, Any]:
    """Return the arrows of forces and the arcs of moments at some poses, each with place, kind, name and text.

    Arrows are to one scale, arcs to none.
    """
    forces, courses, turning = drawn
    scales = force_scales(forces, sketch.window.diagonal, courses)
    kinds = dict.fromkeys((*(scale.kind for scale in scales), *(one.shown.kind for one in turning)))
    arrows, arcs = ([_placed_course(forces, one, links, chosen, sketch.design) for one in found]
                    for found in (courses, turning))  # fmt: skip
    for one, data in zip(courses, arrows, strict=True):
        force = one.force[chosen]
        data |= {"name": one.shown.name, "force": [packed_floats(force.real), packed_floats(force.imag)]}
    for one, data in zip(turning, arcs, strict=True):
        data |= {"name": one.shown.turning, "moment": packed_floats(one.moment[chosen])}
        ends = [[at.real, at.imag] for at in sketch.scene.points[one.shown.link].values()]
        data |= {"body": links[one.shown.link], "ends": ends, "driver": one.shown.is_driver}
    per_unit, amount, text = (scales[0].per_unit, scales[0].amount, scales[0].text) if scales else (0.0, 0.0, "")
    return {
        "scale": per_unit,
        "text": text,
        "length": amount * per_unit,
        "shortest": force_arrows.SHORTEST,
        "unit": forces.units.force,
        "turning": forces.units.moment,
        "kinds": {kind: KINDS[kind] for kind in kinds},
        "arrows": arrows,
        "moments": arcs,
    }


def _placed_course(
    forces: Forces, course: ForceCourse, links: Mapping[str, int], chosen: Number, design: int
) -> dict[str, Any]:
    """Return what acts somewhere: at a point of its link where it is fixed there, else at a place for every pose."""
    link, shown = forces.links[course.shown.link], course.shown

    def row(values: Any) -> Number:
        rows = np.broadcast_to(values, forces.shape).reshape(forces.inputs.designs, -1)
        return np.asarray(rows[design])

    own = (course.at - row(link.origin.position)) * np.exp(-1j * row(link.angle))
    known = own[np.isfinite(own)]
    found = {"told": shown.description, "kind": shown.kind}
    if len(known) and np.max(np.abs(known - known[0])) <= FIXED_PLACE * forces.motion.size:
        return {**found, "link": links[shown.link], "x": float(known[0].real), "y": float(known[0].imag)}
    at = course.at[chosen]
    return {**found, "at": [packed_floats(at.real), packed_floats(at.imag)]}
