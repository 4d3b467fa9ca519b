"""The law of a driver found from a motion that was asked for the other way round, and the mechanism driven by it."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.inputs import fit, mapped
from compoundkin.kinematics.results import PairMotion
from compoundkin.model.definition import Pins, driven_pair
from compoundkin.model.elements import Drawn, Drive, Expectation, Item, Mode, drawn
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import MotionTable
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.synthesis.inversion import WITHIN

# What a law holds at each time: value, speed, acceleration.
ORDER = 2


@checked
def found_law(motion: Motion, link: str, on: str = FRAME, *, pair: str = "") -> MotionTable:
    """Return the law that a driver would have to follow for a motion.

    It drives `link` against `on`.

    It is a table of value, speed and acceleration at the times of the motion (radians or lengths), with quintic
    polynomials in between. Raises InvalidInput where the two links have no such pair, for a motion that is not in time
    or of several designs, and where it cannot be followed: from when to when, and why.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> led = solve(load_named("five-bar-led"))
    >>> found_law(led, "left").coordinate(0.0, order=0).c[0].__class__.__name__
    'float'
    """
    return _law(motion, _driver(motion.mechanism, link, on, pair))


@checked
def driven_forward(motion: Motion, *drivers: str | Drive) -> Mechanism:
    """Return the mechanism driven by the laws found for a motion.

    They take the place of all that drives it now.

    `drivers` are links driven against the frame, or drivers such as ``drive("stick", on="boom")``, of which the law is
    found. Dimensions and assembly are kept; it is drawn as in the motion, and solved at its times. Raises InvalidInput
    as `found_law` does.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> forward = driven_forward(solve(load_named("five-bar-led")), "left", "right")
    >>> [drive.name for drive in forward.drives]
    ['left', 'right']
    """
    mechanism = motion.mechanism
    asked = [_driver(mechanism, one) if isinstance(one, str) else one for one in drivers]
    if not asked:
        raise InvalidInput(Problem("drivers", "none is named", "name the links that are to be driven"))
    for one in asked:
        _driver(mechanism, one.link, one.on, one.pair)
    driven = [Drive(one.name, one.link, one.on, one.pair, law=_law(motion, one)) for one in asked]
    gone = (Drive, PrescribedMotion, Mode, Expectation)
    kept: list[Item] = [item for item in mechanism.items if not isinstance(item, gone)]
    if not any(item.is_drawn for item in mechanism.links.values()):
        kept = [item for item in kept if not isinstance(item, Drawn)]
        kept.append(drawn(**_places(motion, asked)))
    told = {key: getattr(mechanism, key) for key in ("source", "description")}
    title = f"{mechanism.title}, driven forward"
    return Mechanism(title, *kept, *driven, outputs=_outputs(mechanism, driven), time=motion.time, **told,
                     **mechanism.unit_words)  # fmt: skip


def _driver(mechanism: Mechanism, link: str, on: str = FRAME, pair: str = "") -> Drive:
    """Return the driver of a pair. Raises UnknownName or InvalidInput where there is none, or not one."""
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
    lost = ~np.all(np.isfinite(columns), axis=0)
    if np.any(lost):
        what = f"at {times[lost][0]:g} s the motion is at a limit position, where {drive.link!r} has no finite rates"
        raise InvalidInput(Problem(f"law of {drive.name}", what, "let it not reach that place, or leave the time out"))
    return MotionTable(times, *columns)


def _coordinate(motion: Motion, drive: Drive) -> PairMotion:
    """Return the motion of the pair that a driver would prescribe, in the driver's sense."""
    pair = driven_pair(Pins(motion.mechanism), drive)
    ends = tuple(mapped(end, fit(motion.shape)) for end in pair.ends(motion.mechanism.geometry))
    poses = tuple(motion.poses[name] for name in pair.members)
    counted = all(pose.theta is not None for pose in poses)
    coordinate = pair.coordinate(ends, poses) * pair.driven_by(drive.link)
    return PairMotion(motion.grid, coordinate, pair.free_is_angle, counted=counted)


def _times(motion: Motion) -> Number:
    """Return the times of a motion that can be followed. Raises InvalidInput for any other."""
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
    """Return where all points are at a pose of the motion that a drawing shows without doubt."""
    links = motion.mechanism.links
    members = [name for one in map(motion.mechanism.resolved, drives) for name in (one.link, one.on)]
    # a link of a single point shows no angle: that of the first pose is taken
    index = 0 if any(len(links[name].points) == 1 for name in members) else int(WITHIN * motion.shape[0])
    return {letter: complex(np.broadcast_to(found.position, motion.shape)[index])
            for letter, found in motion.points.items()}  # fmt: skip


def _outputs(mechanism: Mechanism, drives: list[Drive]) -> list[str]:
    """Return the outputs whose owners there still are."""
    thought = mechanism.auxiliary_links
    pairs = (pair.name for pair in mechanism.written_pairs if thought.isdisjoint(pair.members))
    links = (name for name in mechanism.links if name not in thought)
    known = {*mechanism.carriers, *links, *pairs, *(one.name for one in drives)}
    return [name for name in mechanism.outputs if name.split("(")[0].split(".")[0] in known]
