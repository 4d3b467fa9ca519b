"""The same mechanism with another frame or another driver, or driven by the law that a given motion requires.

All dimensions stay. Source: F. Reuleaux, The Kinematics of Machinery, 1876, section 3: inversion changes no relative
motion.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from inspect import signature
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem, UnassembledPoses, UnknownName, suggestion
from compoundkin.base.poses import Pose
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.curve.driver_path import as_column
from compoundkin.kinematics.driver_values import fit, mapped
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.motion import PairMotion
from compoundkin.model.definition import Pins, driven_pair
from compoundkin.model.elements import Drawn, Drive, Expectation, Link, Mode, drawn, drive
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import MotionTable
from compoundkin.model.mechanism import Mechanism, available_outputs
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.structure import decompose
from compoundkin.synthesis.driver_places import is_driver, renamed, stays, without_driver

OLD_FRAME = "old frame"
# The place of the drawn pose, a part of all poses: at the ends and half way links are often in line, and modes meet.
WITHIN = 0.382
# Points that define the axes of a drawn old frame: its origin, and one on its x axis.
_AXES = {"old origin": 0j, "old x": 1 + 0j}


@checked
def with_frame(mechanism: Mechanism, link: str) -> Mechanism:
    """Return the inversion of a mechanism with `link` as the frame. The old frame moves as the link "old frame".

    Dimensions, drivers and thus all relative motions stay, and the assembly: a drawing replaces modes. Published
    numbers and the mass of the new frame are dropped. The world's axes, also for gravity, are those of the new frame.

    Raises UnknownName for an unknown link.

    >>> from compoundkin.files import load
    >>> from compoundkin.synthesis.chains import structure_name
    >>> inverted = with_frame(load("slider-crank"), "crank")
    >>> list(inverted.links), structure_name(decompose(inverted)).title
    (['frame', 'old frame', 'rod', 'piston'], 'inverted slider-crank with turning or oscillating guide')
    """
    mechanism.link(link)
    if link == FRAME:
        return mechanism
    names = _renamed(mechanism, link)
    points = _points_relative_to(mechanism, link)
    words = mechanism.items if link in mechanism.rigid_links else mechanism.parts
    items = [item if isinstance(item, Drive) and item.link in mechanism.cylinders else renamed(item, names)
             for item in words if stays(item, link)]  # fmt: skip
    items = [_with_axes(mechanism, item) if isinstance(item, Link) and item.name == names[FRAME] else item
             for item in items]  # fmt: skip
    if points:
        carried = {letter for item in items if isinstance(item, Link) for letter in item.points}
        items.append(drawn(**{k: p for k, p in points.items() if k in carried}))
    # the frame comes first
    items.sort(key=lambda item: not (isinstance(item, Link) and item.name == FRAME))
    outputs = [".".join([names.get(name.partition(".")[0], name.partition(".")[0]), *name.split(".")[1:]])
               for name in mechanism.outputs]  # fmt: skip
    return _written(mechanism, f"{mechanism.title}, {link} fixed", items, outputs)


@checked
def with_driver(
    mechanism: Mechanism, link: str, on: str = FRAME, *, pair: str = "", instead: str = "", **words: Any
) -> Mechanism:
    """Return a mechanism with a driver of `link` on the link `on` in place of its own, or of the one named `instead`.

    `words` are those of `drive`, such as `values`; without values a pin makes a full turn, a slide stays. Dimensions
    and assembly stay, published numbers are dropped.

    Raises UnknownName for an unknown link or driver, InvalidInput if the driver to replace is ambiguous,
    InvalidMechanism if the two links have no pair to drive.

    >>> from compoundkin.files import load
    >>> driven = with_driver(load("four-bar-norton"), "rocker")
    >>> [drive.name for drive in driven.drives]
    ['rocker']
    """
    for word in words.keys() - signature(drive).parameters:
        raise TypeError(f"with_driver() got an unexpected keyword argument {word!r}")
    old = _replaced(mechanism, instead)
    new = drive(link, on=on, pair=pair, **words)
    for name in [name for name in (link, on) if name not in mechanism.cylinders and isinstance(new, Drive)]:
        mechanism.link(name)
    items = [without_driver(item, mechanism, old) for item in mechanism.items if not is_driver(item, old)]
    items = [item for item in items if not isinstance(item, Mode | Expectation)]
    if not any(item.is_drawn for item in mechanism.links.values()):
        items = [item for item in items if not isinstance(item, Drawn)]
        if points := _assembled(mechanism):
            items.append(drawn(**points))
    drives = [item.name for item in (*items, new) if isinstance(item, Drive)]
    outputs = available_outputs(mechanism, drives)
    made = _written(mechanism, f"{mechanism.title}, {link} driven", [*items, new], outputs)
    return _standing(made, new) if isinstance(new, Drive) and new.values is None and new.law is None else made


def _replaced(mechanism: Mechanism, instead: str) -> Drive | None:
    """Return the driver to replace, None for a mechanism without drivers."""
    names = [item.name for item in mechanism.drives]
    if instead:
        if instead not in names:
            raise UnknownName(Problem(instead, "there is no such driver", suggestion(instead, names)))
        return mechanism.drives[names.index(instead)]
    if len(names) > 1:
        what = "there are several drivers, and none is named to be replaced"
        raise InvalidInput(Problem("instead", what, f"name one: {', '.join(names)}"))
    return mechanism.drives[0] if names else None


def _standing(mechanism: Mechanism, new: Drive) -> Mechanism:
    """Return the mechanism with the drawn value for a driven slide."""
    driven = decompose(mechanism).driven.get(new.name)
    if driven is None or driven.pair.free_is_angle or mechanism.unplaced:
        return mechanism
    pair = driven.pair
    drawn = mechanism.drawn_poses
    if all(name in drawn for name in pair.members):
        poses = tuple(as_column(drawn[name]) for name in pair.members)
        value = pair.drawn_coordinate(pair.ends(mechanism.geometry), poses) * pair.driven_by(new.link)
    else:
        value = pair.drawn_length(mechanism.sketch)
    if value is None:
        return mechanism
    return mechanism.replace(replace(new, values=float(value) if np.ndim(value) == 0 else value))


def _written(mechanism: Mechanism, title: str, items: list[Item], outputs: list[str]) -> Mechanism:
    header = {key: getattr(mechanism, key) for key in ("source", "description", "time")} | mechanism.unit_words
    return Mechanism(title, *items, outputs=outputs, **header)


def _renamed(mechanism: Mechanism, link: str) -> dict[str, str]:
    """Return unused names of the two links that change places."""
    taken = (*mechanism.links, *mechanism.carriers)
    number = next(k for k in range(1, len(taken) + 2) if f"{OLD_FRAME}{k if k > 1 else ''}" not in taken)
    return {link: FRAME, FRAME: f"{OLD_FRAME}{number if number > 1 else ''}"}


def _with_axes(mechanism: Mechanism, link: Link) -> Link:
    """Return the old frame with two points for its axes if needed."""
    counted = [name for pair in mechanism.written_pairs for name in pair.members]
    counted += [name for item in mechanism.drives for name in (item.link, item.on)]
    if not link.is_drawn or not mechanism.sketch or FRAME not in counted:
        return link
    return replace(link, points={**dict.fromkeys(_AXES), **link.points})


def _points_relative_to(mechanism: Mechanism, link: str) -> dict[str, Number]:
    """Return the places of all points in one pose in the frame of a link, empty without any pose."""
    if not mechanism.sketch or not any(item.is_drawn for item in mechanism.links.values()):
        points = _assembled(mechanism)
        pose = _pose_of(mechanism, link) if points else None
    else:
        points = {**_AXES, **mechanism.geometry.sketch}
        pose = mechanism.geometry.drawn.get(link)
        pose = Pose.of(points[mechanism.links[link].letters[0]], 1 + 0j) if pose is None else pose
    if pose is None:
        return {}
    back = pose.inverse()
    return {letter: back.at(p).c[0] for letter, p in points.items()}


def _assembled(mechanism: Mechanism) -> dict[str, Number]:
    """Return the places of all points in an assembled pose, empty without any."""
    found = _some_pose(mechanism)
    return (
        {} if found is None else {letter: _at(motion.position, found[1]) for letter, motion in found[0].points.items()}
    )


def _pose_of(mechanism: Mechanism, link: str) -> Pose | None:
    """Return the pose of a link in the pose of `_assembled`."""
    found = _some_pose(mechanism)
    if found is None:
        return None
    angle = _at(found[0].links[link].angle, found[1])
    return Pose.of(_at(found[0].links[link].origin.position, found[1]), np.exp(1j * angle))


def _some_pose(mechanism: Mechanism) -> Any:
    """Return the motion and the index of an assembled pose, or None."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnassembledPoses)
            motion = solve(mechanism, order=0)
    except CompoundkinError:
        return None
    assembled = np.asarray(motion.assembled)
    whole = np.all(assembled.reshape(-1, assembled.shape[-1]), axis=0) if assembled.ndim else assembled[None]
    found = np.flatnonzero(whole)
    return (motion, _clear(motion, found)) if len(found) else None


def _clear(motion: Motion, found: Number) -> int:
    """Return the index of a pose whose drawing is unambiguous."""
    for item in motion.mechanism.drives:
        if any(len(motion.mechanism.links[name].points) == 1 for name in (item.link, item.on)):
            pair = motion.structure.driven[item.name].pair
            if pair.free_is_angle:
                return int(found[0])  # read as the first pose
            # read as forward along the guide
            value = np.broadcast_to(motion.pairs[pair.name].value, motion.assembled.shape)
            return int(found[np.argmax(value.reshape(-1, value.shape[-1])[0][found])])
    return int(found[int(WITHIN * len(found))])


def _at(values: Number, k: int) -> Number:
    """Return values at one pose: a number, or an array (designs, 1)."""
    array = np.asarray(values)
    if array.ndim == 0:
        return array.item()
    return array[k].item() if array.ndim == 1 else array[..., k : k + 1]


# A law has value, speed and acceleration at each time.
ORDER = 2


@checked
def found_law(motion: Motion, link: str, on: str = FRAME, *, pair: str = "") -> MotionTable:
    """Return the driving law of `link` against `on` that a motion requires.

    It is a table of value, speed and acceleration at the times of the motion (radians or lengths), with quintic
    polynomials in between. Raises InvalidInput if the two links have no such pair, for a motion that is not in time or
    of several designs, and for one with gaps, with their times and reasons.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> led = solve(load("five-bar-led"))
    >>> found_law(led, "left").coordinate(0.0, order=0).c[0].__class__.__name__
    'float'
    """
    return _law(motion, _driver(motion.mechanism, link, on, pair))


@checked
def driven_forward(motion: Motion, *drivers: str | Drive) -> Mechanism:
    """Return the mechanism with the driving laws that a motion requires in place of its drivers.

    `drivers` are links driven against the frame, or drivers such as ``drive("stick", on="boom")``. Dimensions and
    assembly stay; it is drawn in a pose of the motion, and solved at its times. Raises InvalidInput as `found_law`.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> forward = driven_forward(solve(load("five-bar-led")), "left", "right")
    >>> [drive.name for drive in forward.drives]
    ['left', 'right']
    """
    mechanism = motion.mechanism
    chosen = [_driver(mechanism, one) if isinstance(one, str) else one for one in drivers]
    if not chosen:
        raise InvalidInput(Problem("drivers", "none is named", "name the links that are to be driven"))
    for one in chosen:
        _driver(mechanism, one.link, one.on, one.pair)
    driven = [Drive(one.name, one.link, one.on, one.pair, law=_law(motion, one)) for one in chosen]
    gone = (Drive, PrescribedMotion, Mode, Expectation)
    items: list[Item] = [item for item in mechanism.items if not isinstance(item, gone)]
    if not any(item.is_drawn for item in mechanism.links.values()):
        items = [item for item in items if not isinstance(item, Drawn)]
        items.append(drawn(**_places(motion, chosen)))
    header = {key: getattr(mechanism, key) for key in ("source", "description")}
    title = f"{mechanism.title}, driven forward"
    return Mechanism(title, *items, *driven, outputs=_outputs(mechanism, driven), time=motion.time, **header,
                     **mechanism.unit_words)  # fmt: skip


def _driver(mechanism: Mechanism, link: str, on: str = FRAME, pair: str = "") -> Drive:
    """Return the driver of a pair. Raises UnknownName or InvalidInput unless there is exactly one."""
    for name in [name for name in (link, on) if name not in mechanism.cylinders]:
        mechanism.link(name)
    drive = Drive(link, link, on, pair)
    choices = mechanism.drivable(drive)
    if len(choices) != 1:
        what = f"{link!r} and {on!r} share {'several pairs' if choices else 'no pair'} that could be driven"
        remedy = f"name one: {', '.join(choices)}" if choices else "name a link and the one it is paired with"
        raise InvalidInput(Problem("pair" if choices else "link", what, remedy))
    return drive


def _law(motion: Motion, drive: Drive) -> MotionTable:
    times = _times(motion)
    found = _coordinate(motion, motion.mechanism.resolved(drive))
    columns = [np.broadcast_to(found.derivative(k), motion.shape) for k in range(ORDER + 1)]
    infinite = ~np.all(np.isfinite(columns), axis=0)
    if np.any(infinite):
        what = (
            f"at {times[infinite][0]:g} s the motion is at a limit position, where {drive.link!r} has no finite rates"
        )
        raise InvalidInput(Problem(f"law of {drive.name}", what, "stop before that place, or leave the time out"))
    return MotionTable(times, *columns)


def _coordinate(motion: Motion, drive: Drive) -> PairMotion:
    """Return the motion of the driver's pair, in the driver's sense."""
    pair = driven_pair(Pins(motion.mechanism), drive)
    ends = tuple(mapped(end, fit(motion.shape)) for end in pair.ends(motion.mechanism.geometry))
    poses = tuple(motion.poses[name] for name in pair.members)
    counted = all(pose.theta is not None for pose in poses)
    coordinate = pair.coordinate(ends, poses) * pair.driven_by(drive.link)
    return PairMotion(motion.grid, coordinate, pair.free_is_angle, counted=counted)


def _times(motion: Motion) -> Number:
    """Return the times of a motion without gaps. Raises InvalidInput for any other."""
    motion.grid.require(ORDER)
    if motion.time is None:
        raise InvalidInput(Problem("motion", "it is not in time", "give times: solve(mechanism, time=...)"))
    if len(motion.shape) > 1:
        raise InvalidInput(Problem("motion", "it has several designs", "solve one design at a time"))
    if motion.shape in ((), (1,)):
        raise InvalidInput(Problem("motion", "a single pose is no motion", "give two times or more"))
    if not motion.assembled.all():
        problems = [
            Problem("motion", f"it cannot be followed {_when(gap.times)}: {gap.reason}") for gap in gaps(motion)
        ]
        raise InvalidInput(problems)
    return np.broadcast_to(motion.time, motion.shape)


def _when(times: tuple[float, float] | None) -> str:
    return f"from {times[0]:.6g} s to {times[1]:.6g} s" if times else "at some times"


def _places(motion: Motion, drives: list[Drive]) -> dict[str, Any]:
    """Return the places of all points in a pose of the motion whose drawing is unambiguous."""
    links = motion.mechanism.links
    members = [name for one in map(motion.mechanism.resolved, drives) for name in (one.link, one.on)]
    # the drawing of a link with a single point has no angle: the first pose is read
    index = 0 if any(len(links[name].points) == 1 for name in members) else int(WITHIN * motion.shape[0])
    return {letter: complex(np.broadcast_to(found.position, motion.shape)[index])
            for letter, found in motion.points.items()}  # fmt: skip


def _outputs(mechanism: Mechanism, drives: list[Drive]) -> list[str]:
    """Return the outputs whose owners remain."""
    auxiliary = mechanism.auxiliary_links
    pairs = (pair.name for pair in mechanism.written_pairs if auxiliary.isdisjoint(pair.members))
    links = (name for name in mechanism.links if name not in auxiliary)
    known = {*mechanism.carriers, *links, *pairs, *(one.name for one in drives)}
    return [name for name in mechanism.outputs if name.split("(")[0].split(".")[0] in known]
