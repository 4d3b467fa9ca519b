"""Paths of points along a motion as lines of short chords within a stated error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined
from compoundkin.files.exchange.short_chords import short_chords
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.kinematics.solution import quietly_solved
from compoundkin.model.geometry import FRAME

# A path whose ends are nearer to each other than this part of the size is closed, one that is shorter is none.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class CouplerPath:
    """The path of a point, or a piece of it between gaps.

    `places` are complex; that of a closed one does not have its first place again. Chords are
    off by the `error` at most.
    """

    letter: str
    places: Number
    closed: bool
    error: float


def whole_motion(shown: ShownMechanism) -> Motion | None:
    """Return the motion over the drivers' own ranges; None where there is none."""
    if shown.motion is not None and shown.motion.inputs.poses > 1:
        return shown.motion
    try:
        motion = quietly_solved(shown.structure)
    except (InvalidInput, NotAssembled, NotDetermined):
        return None
    return motion if motion.inputs.poses > 1 else None


def drawn_letters(shown: ShownMechanism) -> tuple[str, ...]:
    """Return the points whose paths people expect.

    They are those among the outputs, and those of one moving link alone.
    """
    mechanism = shown.mechanism
    asked = {name.partition(".")[0] for name in mechanism.outputs}
    return tuple(
        letter
        for letter, links in mechanism.carriers.items()
        if FRAME not in links and (letter in asked or len(links) == 1) and links[0] not in mechanism.auxiliary_links
    )


def coupler_paths(motion: Motion, letters: Sequence[str], tolerance: float) -> tuple[CouplerPath, ...]:
    """Return the paths of points by chords within a tolerance.

    The motion is solved again between its poses until the middle of no step is.
    """
    if not letters:
        return ()
    s = np.arange(motion.inputs.poses, dtype=float)
    _, rows, error = short_chords(s, lambda s: _places(motion, letters, s), tolerance)
    size = motion.size
    return tuple(path for letter, row in zip(letters, rows, strict=True) for path in _pieces(letter, row, size, error))


def _places(motion: Motion, letters: Sequence[str], s: Number) -> Number:
    """Where points are at places along the motion, (letters, places); not a number where it is not assembled."""
    found = between(motion, 0, s, order=0)
    return np.array([np.broadcast_to(found.points[letter].position, s.shape) for letter in letters])


def _pieces(letter: str, row: Number, size: float, error: float) -> Iterator[CouplerPath]:
    """Yield the known pieces of a path."""
    known = np.isfinite(row)
    for part in np.split(np.arange(len(row)), np.flatnonzero(np.diff(known.astype(int))) + 1):
        places = row[part]
        if known[part[0]] and np.abs(places - places[0]).max() > SAME * size:
            closed = len(part) == len(row) and abs(places[-1] - places[0]) <= SAME * size
            yield CouplerPath(letter, places[:-1] if closed else places, closed, error)
