"""Options of a picture, and the pose they select: at driver values, at an index, or nearest to the drawing."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arguments import check_design, is_finite_real
from compoundkin.base.arrays import Number, degrees, first_entry
from compoundkin.base.errors import (
    ChangePointWarning,
    InvalidInput,
    NotAssembled,
    NotDetermined,
    Problem,
    UnassembledPoses,
    UnknownName,
    suggestion,
)
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import first_number
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.one_design import alone, motion_of_design
from compoundkin.model.attributes import RATES, unit_suffix
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outline_shapes import outline_shapes
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure import Structure, decompose
from compoundkin.view.sketch.scene import Scene, scene_of_motion

# A driver value is that of a pose if it differs by no more than this part of the driver's range.
SAME = 1e-9
# Places nearer to each other than this part of the size are one.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class PictureOptions:
    """The options of a picture besides its kind, as `draw` explains them."""

    at: Any = None
    pose: int | None = None
    design: int = 0
    ghosts: int = 0
    paths: str | Sequence[str] | bool = ()
    centres: bool = False
    vectors: str | Sequence[str] = ()
    labels: bool | str | Sequence[str] = True
    size: float | None = None
    link: str | None = None
    dimensions: bool = False

    def others(self, known: Sequence[str]) -> tuple[str, ...]:
        """Return the names of those that are given and not among some.

        >>> PictureOptions(at=0.5, ghosts=3).others(("at", "pose"))
        ('ghosts',)
        """
        return tuple(one.name for one in fields(self) if one.name not in known and self._is_set(one.name))

    def _is_set(self, name: str) -> bool:
        value, usual = getattr(self, name), getattr(PictureOptions, name)
        # without a comparison of arrays, which gives an array
        return type(value) is not type(usual) or bool(usual is not None and value != usual)


def scene_of(what: Drawable, at: Any, pose: int | None, design: int) -> Scene:
    """Return the requested scene. Raises InvalidInput, UnknownName or NotAssembled for a pose that does not exist."""
    if at is not None and pose is not None:
        raise InvalidInput(Problem("pose", "driver values `at` are given too", "leave one of them out"))
    what, design = one_design(what, design)
    if isinstance(what, Motion):
        return scene_in(what, at, pose, design)
    motion = solved_over(what)
    if motion is not None:
        return scene_in(motion, at, pose, design)
    structure = what if isinstance(what, Structure) else decompose(what)
    if at is not None:
        return scene_in(solve(what, driver_values_by_name(structure, at)), None, None, design)
    return scene_as_drawn(structure)


def one_design(what: Drawable, design: int) -> tuple[Drawable, int]:
    """Return one of several designs by itself, and its index there. Raises InvalidInput for an unknown index."""
    if isinstance(what, Motion):
        check_design(design, what.inputs.designs)
        return motion_of_design(what, design), 0
    return alone(what, design)


def scene_as_drawn(structure: Structure) -> Scene:
    """Return the scene of a drawing. Raises InvalidInput where it does not show every link."""
    geometry, drawn = structure.mechanism.geometry, structure.mechanism.drawn_poses
    here: dict[str, Pose] = {}
    for name, placed in geometry.points.items():
        letter = next((k for k in placed if k in geometry.sketch), None)
        if name in drawn:
            here[name] = drawn[name].entry((0, 0))
        elif letter is not None and len(placed) == 1:
            here[name] = Pose.of(complex(first_entry(geometry.sketch[letter])) - first_entry(placed[letter]), 1 + 0j)
        else:
            what = f"{name!r} is not drawn, and the mechanism cannot be solved"
            raise InvalidInput(Problem(f"links.{name}", what, "draw its points with drawn(...)"))
    points = {link: {k: complex(first_entry(p)) for k, p in placed.items()} for link, placed in geometry.points.items()}
    outlines = outline_shapes(structure.mechanism, points)
    return Scene(structure, here, here, points, ends_of(structure), outlines=outlines)


def solved_over(what: Mechanism | Structure) -> Motion | None:
    """Return the motion over the drivers' own ranges. None where they have none, or it cannot be solved."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnassembledPoses)
            warnings.simplefilter("ignore", ChangePointWarning)
            return solve(what)
    except (InvalidInput, NotAssembled, NotDetermined):
        return None


def scene_in(motion: Motion, at: Any, pose: int | None, design: int) -> Scene:
    """Return the scene at driver values, at an index, or near the drawing."""
    check_design(design, motion.inputs.designs)
    failed = np.broadcast_to(motion.failed, (motion.inputs.designs, motion.inputs.poses))[design]
    if pose is not None:
        if isinstance(pose, bool) or not isinstance(pose, int) or not -len(failed) <= pose < len(failed):
            raise InvalidInput(Problem("pose", f"there is no pose {pose!r}", f"0 to {len(failed) - 1}"))
        shown, index = motion, pose % len(failed)
    elif at is None:
        shown, index = motion, _nearest_to_drawing(motion, design, failed)
    else:
        shown, index = _at_values(motion, driver_values_by_name(motion.structure, at), design)
    known = np.broadcast_to(shown.failed, (shown.inputs.designs, shown.inputs.poses)) == 0
    if not known[min(design, len(known) - 1)][index]:
        raise NotAssembled(Problem("pose", "the mechanism cannot be assembled there", "gaps() tells where and why"))
    return scene_of_motion(motion, shown, design, index)


def _nearest_to_drawing(motion: Motion, design: int, failed: Number) -> int:
    """The assembled pose nearest to the drawn points; without a drawing, some way into the motion."""
    known = np.flatnonzero(failed == 0)
    if not known.size:
        why = next((gap.reason for gap in gaps(motion)), "") if motion.inputs.designs == 1 else ""
        what = "the motion has no assembled pose" + (f": {why}" if why else "")
        raise NotAssembled(Problem("draw", what, "gaps() tells why" if not why else "change a length"))
    sketch = {k: v for k, v in motion.mechanism.sketch.items() if k in motion.mechanism.carriers}
    off = np.zeros(motion.inputs.poses)
    for letter, drawn in sketch.items():
        places = np.asarray(motion.points[letter].position).reshape(motion.inputs.designs, -1)[design]
        off = off + np.abs(places - first_entry(drawn)) ** 2
    # a crank at zero hides behind the frame: without a drawing, an eighth of the motion is a better view
    # the first of those that are equally near but for rounding, as the first and the last pose of a full turn are
    near = known[off[known] <= off[known].min() + (ROUNDING * motion.size) ** 2]
    return int(near[0]) if sketch else int(known[len(known) // 8])


def _at_values(motion: Motion, at: dict[str, float], design: int) -> tuple[Motion, int]:
    """The motion with its pose at driver values, or one that is solved there in the same assembly modes."""
    poses = motion.inputs.poses
    values = {}
    for name, numbers in motion.inputs.drives.items():
        rows = np.atleast_2d(numbers[0])
        values[name] = np.broadcast_to(rows[min(design, len(rows) - 1)], (poses,))
    off = np.zeros(poses)
    for name, value in at.items():
        span = float(np.ptp(values[name])) or 1.0
        off = np.maximum(off, np.abs(values[name] - value) / span)
    index = int(np.argmin(off))
    if off[index] <= SAME:
        return motion, index
    chosen = {name: at.get(name, float(row[index])) for name, row in values.items()}
    drives = motion.inputs.drives.items()
    rates: Any = {
        key: {name: _rate(numbers, k, design, index) for name, numbers in drives}
        for k, key in enumerate(RATES, start=1)
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        return solve(motion.structure, chosen, **rates, order=motion.order, hint=_hint(motion, design, index)), 0


def _rate(numbers: tuple[Number, ...], k: int, design: int, index: int) -> float:
    rows = np.atleast_2d(numbers[k]) if k < len(numbers) else np.zeros((1, 1))
    row = rows[min(design, len(rows) - 1)]
    return float(row[min(index, len(row) - 1)])


def _hint(motion: Motion, design: int, index: int) -> dict[str, complex]:
    """Where the points are at the pose, which tells the assembly modes; nothing where it is not assembled."""
    shape = (motion.inputs.designs, -1)
    places = {letter: np.asarray(motion.points[letter].position) for letter in motion.mechanism.carriers}
    found = {letter: complex(place.reshape(shape)[design, index]) for letter, place in places.items()}
    return found if all(map(np.isfinite, found.values())) else {}


def pose_notes(scene: Scene) -> list[str]:
    """Return the drivers' values at the pose shown."""
    if scene.shown is None:
        return []
    names = [step.drive.name for step in scene.driven]
    return [driver_value_text(scene.structure, name, scene.driver_value(name)) for name in names]


LABELS = ("points", "links")
Drawable: TypeAlias = Motion | Mechanism | Structure


def structure_of(what: Drawable) -> Structure:
    """Return the structure of what is drawn."""
    if isinstance(what, Motion):
        return what.structure
    return what if isinstance(what, Structure) else decompose(what)


def driver_values_by_name(structure: Structure, at: Any) -> dict[str, float]:
    """Return driver values by name, numbers. Raises InvalidInput or UnknownName for what does not fit."""
    names = [drive.name for drive in structure.mechanism.drives]
    if not isinstance(at, Mapping):
        if len(names) != 1:
            what = f"there are {len(names)} drivers" if names else "the mechanism has no driver"
            raise InvalidInput(Problem("at", what, "name them: at={'driver': value}"))
        at = {names[0]: at}
    for name, value in at.items():
        if name not in names:
            raise UnknownName(Problem(f"at.{name}", "there is no such driver", suggestion(str(name), names)))
        if not is_finite_real(value):
            raise InvalidInput(Problem(f"at.{name}", f"{value!r} is not a number", "give the value at one pose"))
    return {name: float(value) for name, value in at.items()}


def driver_value_text(structure: Structure, name: str, value: float) -> str:
    """Return which value a driver has."""
    is_angle = structure.driven_angles.get(name, False)
    shown = f"{round(float(degrees(value)), 9) + 0.0:.5g}" if is_angle else f"{value:.6g}"
    return f"{name} at {shown}{unit_suffix(is_angle, structure.mechanism.unit)}"


def ends_of(structure: Structure) -> dict[str, Ends]:
    """Return the ends of all pairs, of the first design."""
    geometry = structure.mechanism.geometry
    return {pair.name: tuple(End(*map(first_number, end)) for end in pair.ends(geometry)) for pair in structure.pairs}


def path_letters(mechanism: Mechanism, paths: Any) -> tuple[str, ...]:
    """Return the letters of points whose paths are requested; raises UnknownName."""
    carriers = mechanism.carriers
    if paths is True:
        return tuple(letter for letter, links in carriers.items() if len(links) == 1 and "frame" not in links)
    names = (paths,) if isinstance(paths, str) else () if paths is False else tuple(paths)
    for name in names:
        if name not in carriers:
            raise UnknownName(Problem(str(name), "there is no such point", suggestion(str(name), list(carriers))))
    return names


def label_kinds(labels: Any) -> tuple[str, ...]:
    """Return the kinds of labels that are requested; raises InvalidInput for others."""
    if isinstance(labels, bool):
        return LABELS if labels else ()
    names = (labels,) if isinstance(labels, str) else tuple(labels)
    for name in names:
        if name not in LABELS:
            raise InvalidInput(Problem("labels", f"{name!r} cannot be labelled", suggestion(str(name), list(LABELS))))
    return names
