"""The arrows of forces that go with a moving sketch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.view.animation.overlays import Arrows, places_of
from compoundkin.view.sketch.acting_forces import ForceCourse
from compoundkin.view.sketch.moving_forces import force_scales, shown_courses
from compoundkin.view.sketch.moving_sketch import MovingSketch
from compoundkin.view.sketch.picture import MARGIN
from compoundkin.view.sketch.vectors import VectorScale


def with_forces(
    sketch: MovingSketch, forces: Forces, others: tuple[Arrows, ...] = ()
) -> tuple[MovingSketch, tuple[Arrows, ...]]:
    """Return the arrows of forces after others, and the sketch with room for all."""
    courses = shown_courses(sketch, forces)
    scales = force_scales(sketch, forces, courses)
    known = sketch.scene.known
    tips = [sketch.window.at(one.at[known]) + np.conjugate(_finite(one.force[known])) * scale.per_unit
            for scale in scales[:1] for one in courses]  # fmt: skip
    larger = sketch.holding(np.concatenate(tips), MARGIN / 2.0) if tips else sketch
    kept = (replace(one, places={k: places_of(larger, k) for k in one.places}) for one in others)
    return larger, (*kept, *(_arrows(larger, scale, courses) for scale in scales))


def _arrows(sketch: MovingSketch, scale: VectorScale, courses: tuple[ForceCourse, ...]) -> Arrows:
    """The arrows of one kind."""
    known = sketch.scene.known
    own = {f"{one.shown.link} {one.shown.name}": one for one in courses if one.shown.kind == scale.kind}
    places = {key: np.asarray(sketch.window.at(one.at[known])) for key, one in own.items()}
    return Arrows(scale, places, {key: one.force[known] for key, one in own.items()})


def _finite(values: Number) -> Number:
    return np.where(np.isfinite(values), values, 0.0)
