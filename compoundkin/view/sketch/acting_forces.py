"""What acts on the links at the pose of a scene: reactions, efforts, loads, weights, inertia, with short names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.series import Number
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.named_forces.link_wrench import DRIVER, FRICTION, PAIR, WEIGHT, LinkWrench
from compoundkin.dynamics.named_forces.link_wrench import INERTIA as OF_INERTIA
from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.sketch_style import INERTIA, LOAD, REACTION

LOWERED = str.maketrans("0123456789-", "₀₁₂₃₄₅₆₇₈₉₋")
# What is below this part of the largest force is rounding.
NOTHING = 1e-9
# Arcs are not to scale: a moment below this part of the largest force by the size would look like any other.
FAINT = 1e-5


@dataclass(frozen=True)
class ShownForce:
    """A force and a moment on a link at one pose.

    `name` and `turning` are their short names, `told` says it in words.
    `kind` is the style they are drawn in, `at` a place of the mechanism's plane.
    """

    name: str
    turning: str
    told: str
    link: str
    by: str
    kind: str
    at: complex
    force: complex
    moment: float
    is_driver: bool = False
    is_open: bool = False


def forces_in(forces: Forces, scene: Scene) -> Forces:
    """Return forces at the pose of a scene. They are found anew where it is between the poses of the motion."""
    if scene.shown is None or scene.shown is forces.motion:
        return forces
    return force_analysis(scene.shown, **forces.motion.loading)


@dataclass(frozen=True, eq=False)
class ForceCourse:
    """A force and a moment on a link along a motion.

    `shown` says what it is; `at`, `force` and `moment` are its numbers at all poses of one design, (poses,).
    """

    shown: ShownForce
    at: Number
    force: Number
    moment: Number

    def at_pose(self, k: int) -> ShownForce:
        """Return it at a pose."""
        return replace(self.shown, at=complex(self.at[k]), force=complex(self.force[k]), moment=float(self.moment[k]))


Courses: TypeAlias = Mapping[str, tuple[ForceCourse, ...]]


def force_courses(forces: Forces, scene: Scene, design: int) -> Courses:
    """Return what acts on every link at all poses of a design."""
    return {link: tuple(_courses(forces, scene, link, design)) for link in scene.legend}


def acting_forces(forces: Forces, scene: Scene) -> Mapping[str, tuple[ShownForce, ...]]:
    """Return what acts on every link at a pose, the frame included."""
    design, pose = scene.pose
    courses = force_courses(forces_in(forces, scene), scene, design)
    found = {link: tuple(one.at_pose(pose) for one in own) for link, own in courses.items()}
    force = largest(found)
    turning = force * scene.mechanism.geometry.size * FAINT
    return {link: tuple(_cleaned(one, force * NOTHING, turning) for one in own) for link, own in found.items()}


def is_shown_once(one: ShownForce, legend: Mapping[str, int]) -> bool:
    """Tell whether a force stands for itself and its opposite.

    That in a pair does on its later link; none on the frame.
    """
    place = list(legend)
    later = one.by in legend and place.index(one.by) > place.index(one.link)
    return one.link != FRAME and not (one.kind == REACTION and later)


def largest(found: Mapping[str, tuple[ShownForce, ...]]) -> float:
    """Return the largest force that acts anywhere."""
    sizes = [abs(one.force) for own in found.values() for one in own]
    return max((size for size in sizes if np.isfinite(size)), default=0.0)


def _cleaned(one: ShownForce, force: float, moment: float) -> ShownForce:
    """Rounding as zero; what equilibrium leaves open is told, and not drawn."""
    if not np.isfinite(one.force) or not np.isfinite(one.moment):
        return replace(one, force=0j, moment=0.0, is_open=True)
    return replace(
        one, force=0j if abs(one.force) <= force else one.force, moment=0.0 if abs(one.moment) <= moment else one.moment
    )


def _courses(forces: Forces, scene: Scene, link: str, design: int) -> Iterator[ForceCourse]:
    """Yield what acts on a link: the forces of pins that join more than two links as one each, then all others."""
    acting = tuple(forces.on(link))
    pins = [letter for letter, pin in forces.pins.items() if len(pin.links) > 2 and link in pin.links]
    twice = Counter(one.by for one in acting if one.kind == PAIR)
    for letter in pins:
        pin = _course(forces.pins[letter].on(link), design, f"F{_lowered(scene, link)}({letter})", "M")
        # the torque of a driver at the pin is told by itself
        turned = [_course(one, design, "", "").moment for one in acting if one.kind == DRIVER and one.at == letter]
        yield replace(pin, moment=pin.moment - sum(turned)) if turned else pin
    for one in acting:
        if one.kind != PAIR or one.at not in pins:
            yield _course(one, design, *_names(scene, one, twice[one.by] > 1))


def _names(scene: Scene, one: LinkWrench, several: bool) -> tuple[str, str]:
    """The names of a force and of a moment, by the numbers of the links."""
    own = _lowered(scene, one.on)
    if one.kind == PAIR:
        both = _lowered(scene, one.by, one.on)
        return f"F{both}" + (f"({one.name})" if several else ""), f"M{both}"
    if one.kind == DRIVER:
        return f"P{own}", f"T{own}"
    if one.kind == WEIGHT:
        return f"m{own}g", f"m{own}g"
    if one.kind == OF_INERTIA:
        return f"−m{own}a{own}", f"−J{own}α{own}"
    called = one.kind if one.name.startswith(f"{one.kind} on ") else one.name
    return called, called


def _lowered(scene: Scene, *links: str) -> str:
    """The numbers of links as an index: with a dash where one has two digits."""
    numbers = [str(scene.numbers[link]) for link in links]
    return ("-" if any(len(number) > 1 for number in numbers) else "").join(numbers).translate(LOWERED)


def _course(one: LinkWrench, design: int, name: str, turning: str) -> ForceCourse:
    told = f"{one.kind} {one.name} on {one.on}" + (f" by {one.by}" if one.by else "")
    kind = REACTION if one.kind in (PAIR, DRIVER, FRICTION) else INERTIA if one.kind == OF_INERTIA else LOAD
    shown = ShownForce(name, turning, told, one.on, one.by, kind, 0j, 0j, 0.0, one.kind == DRIVER)

    def row(values: Any) -> Number:
        rows = np.broadcast_to(values, one.motion.shape).reshape(one.motion.inputs.designs, one.motion.inputs.poses)
        return rows[min(design, len(rows) - 1)]

    return ForceCourse(shown, row(one.place), row(one.force), row(one.moment))
