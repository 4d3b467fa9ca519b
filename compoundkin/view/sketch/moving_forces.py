"""The forces that go with a moving sketch, and their one scale."""

from __future__ import annotations

import numpy as np

from compoundkin.dynamics.forces import Forces
from compoundkin.view.sketch.acting_forces import ForceCourse, force_courses, is_shown_once
from compoundkin.view.sketch.force_sketch import LONGEST, SMALL_PART
from compoundkin.view.sketch.moving_sketch import MovingSketch
from compoundkin.view.sketch.vectors import VectorScale, round_below


def shown_courses(sketch: MovingSketch, forces: Forces) -> tuple[ForceCourse, ...]:
    """Return the forces that are drawn along a motion.

    That in each pair is drawn on its later link; forces that are always small beside the largest are left out.
    """
    found = force_courses(forces, sketch.scene, sketch.design)
    kept = [one for own in found.values() for one in own if is_shown_once(one.shown, sketch.scene.legend)]
    largest = max(map(_longest, kept), default=0.0)
    return tuple(one for one in kept if largest and _longest(one) >= SMALL_PART * largest)


def force_scales(sketch: MovingSketch, forces: Forces, courses: tuple[ForceCourse, ...]) -> tuple[VectorScale, ...]:
    """Return the scale of each kind of forces, one for all."""
    longest = max(map(_longest, courses), default=0.0)
    if not longest:
        return ()
    per_unit, amount = LONGEST * sketch.window.diagonal / longest, round_below(longest)
    kinds = dict.fromkeys(one.shown.kind for one in courses)
    return tuple(VectorScale(kind, per_unit, amount, f"{amount:g} {forces.units.force}") for kind in kinds)


def _longest(one: ForceCourse) -> float:
    """The greatest length of a force along the motion."""
    sizes = np.abs(one.force)
    return float(np.max(sizes, initial=0.0, where=np.isfinite(sizes)))
