"""What the comment of a text says of its configuration: assembly modes, and where it was found to be assembled."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import coordinate_dimension, unit_of

# So many stretches of a motion are told.
MOST = 6


def changed_modes(motion: Motion) -> tuple[str, ...]:
    """Return the links of the first group that changes its mode along a motion.

    There are none where no group does. The motion is of one design.
    """
    places = np.arange(motion.shape[-1], dtype=float)[None, :]
    for solver in motion.solving_order.solvers:
        if not solver.is_numbered and np.ptp(motion.tracker.sign(solver.index, np.array([[0]]), places)):
            return solver.group.links
    return ()


def notes(motion: Motion, order: int, has_states: bool = False) -> Iterator[str]:
    """Yield paragraphs on a motion whose configuration a program keeps."""
    signed = [(mode.links, mode.sign) for mode in motion.modes.values() if mode.sign is not None]
    told = "; ".join(f"{', '.join(links)}: {sign:+d}" for links, sign in signed)
    yield f"Assembly modes, which it keeps: {told}." if told else "It has one assembly mode."
    yield f"With the dimensions of the mechanism it can be assembled {_where(motion)}."
    if has_states:
        first = np.arange(motion.failed.size) == np.argmax(np.ravel(motion.assembled))
        begin = ", ".join(_stretch(motion, name, first) for name in motion.drives)
        yield (
            "It goes from pose to pose: what is called state is given as it was at the pose before, and answered as "
            f"it is. Begin with the numbers told above, which are those at {begin}; take steps of a few degrees."
        )
    if order:
        yield "At a limit position, where it can just be assembled, rates are no finite numbers or have no digits."


def _where(motion: Motion) -> str:
    good = np.ravel(motion.assembled)
    ranges = ", ".join(_stretch(motion, name, np.ones_like(good)) for name in motion.drives)
    if good.all():
        return f"at all {len(good)} poses that were tried: {ranges}"
    few = f"at {np.count_nonzero(good)} of {len(good)} poses that were tried"
    if len(motion.drives) > 1:
        return f"{few}, {ranges}"
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]])))
    parts = edges.reshape(-1, 2).tolist()
    name = next(iter(motion.drives))
    told = [_stretch(motion, name, _between(len(good), start, stop)) for start, stop in parts[:MOST]]
    return f"{few}: {', '.join(told)}{' and elsewhere' if len(parts) > MOST else ''}"


def _between(count: int, start: int, stop: int) -> Number:
    return (np.arange(count) >= start) & (np.arange(count) < stop)


def _stretch(motion: Motion, name: str, wanted: Number) -> str:
    """The range of a driver at some poses."""
    values = np.broadcast_to(np.ravel(motion.drives[name].value), wanted.shape)[wanted.astype(bool)]
    unit = unit_of(motion.mechanism.unit, coordinate_dimension(motion.structure.driven_angles[name]))
    low, high = values.min(), values.max()
    return f"{name} {low:.6g} {unit}" if low == high else f"{name} from {low:.6g} to {high:.6g} {unit}"
