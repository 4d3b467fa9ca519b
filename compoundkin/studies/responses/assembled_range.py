"""The part of a motion over which designs are assembled, between the poses too, and which part fails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.configuration import label
from compoundkin.kinematics.curve.driver_path import MOST, SPACING
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.responses.designs import Designs, design_blocks

# Margins are sampled so many times as densely as change points in `solve`.
FINER = 5
# Where the least margin may be below that of a sample, between its neighbours, so many samples follow, so often: to
# 1e-6 of a sample's spacing.
PARTS, ROUNDS = 33, 5
# Margins (squared sines) below this are rounding.
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class AssembledRange(ShortRepr):
    """Where designs are not assembled.

    `failed` (designs, poses) is the index of the first group that does not close plus one, else 0. `between` (designs,)
    is the same for designs that fail between two poses only, after the pose `after`. `handed` are the designs, by
    index, that were solved.
    """

    failed: Number
    between: Number
    after: Number
    to_solve: Number

    @cached_property
    def assembled(self) -> Number:
        """Which designs are assembled over the whole motion, (designs,)."""
        # of designs that are all clear one row stands for all
        at_poses = self.failed[:1] if self.failed.strides[0] == 0 else self.failed
        return ~at_poses.any(axis=1) & (self.between == 0)


def assembled_range(designs: Designs) -> AssembledRange:
    """Return where designs are not assembled, computed once."""
    return designs.computed_once(AssembledRange, lambda: _search_failures(designs))


def _search_failures(designs: Designs) -> AssembledRange:
    shape = designs.number, designs.poses
    none: Number = np.empty(0, dtype=int)
    if designs.is_clear and not designs.path.has_ends:
        good = np.zeros(shape[0], dtype=np.int32)
        return AssembledRange(np.broadcast_to(good[:1], shape), good, np.zeros(shape[0], dtype=int), none)
    values = designs.outputs
    failed = np.zeros(shape, dtype=np.int32) if values.failed is None else np.broadcast_to(values.failed, shape)
    between, after = np.zeros(shape[0], dtype=np.int32), np.zeros(shape[0], dtype=int)
    if values.screened is None and not designs.path.has_ends:
        return AssembledRange(failed, between, after, none)
    programs = designs.path.compiled.programs
    screened = values.screened
    near, handed = (np.arange(shape[0]), none) if screened is None else (screened.designs, screened.to_solve)
    near = np.arange(shape[0]) if designs.path.has_ends else near
    near = np.union1d(near, handed)
    near = near[~failed[near].any(axis=1)]
    if len(near) and shape[1] > 1 and not programs.variant(frozenset()).seeds:
        between[near], after[near] = _between(designs.picked(near))
    return AssembledRange(failed, between, after, handed)


def _between(designs: Designs) -> tuple[Number, Number]:
    """Return which group of each design fails between its poses plus one, else 0, and after which pose."""
    parts = _parts(designs)
    places = np.linspace(0.0, designs.poses - 1.0, (designs.poses - 1) * parts + 1)
    found = [_sampled(designs.picked(np.array(rows)), places) for rows in design_blocks(designs.number, len(places))]
    failed, place = (np.concatenate(each) for each in zip(*found, strict=True))
    return failed, np.minimum(place.astype(int), designs.poses - 2)


def _parts(designs: Designs) -> int:
    """Return into how many parts the way between two poses is divided."""
    order, longest = designs.path.reference.solving_order, 0.0
    for name, (value, *_) in designs.inputs.drives.items():
        if np.ndim(value) and value.shape[1] > 1:
            longest = max(longest, float(np.abs(np.diff(value, axis=1)).max()) / order.unit(name))
    return max(1, int(np.ceil(FINER * min(longest / SPACING, MOST))))


def _sampled(designs: Designs, places: Number) -> tuple[Number, Number]:
    """Return which group fails at samples or between them, and where."""
    every = np.arange(designs.number)
    failed, margin = _margins(designs, every, np.broadcast_to(places, (len(every), len(places))))
    group, place = _first(failed, np.broadcast_to(places, failed.shape))
    with np.errstate(invalid="ignore"):
        bend = np.abs(np.diff(margin, 2, axis=1)).max(axis=1) if margin.shape[1] > 2 else np.full(len(every), np.inf)
        inner = margin[:, 1:-1]
        dips = (inner <= margin[:, :-2]) & (inner <= margin[:, 2:]) & (inner < bend[:, None]) & (group == 0)[:, None]
    rows, k = np.nonzero(dips)
    low, high = places[k], places[k + 2]
    for _ in range(ROUNDS if len(rows) else 0):
        parts = np.linspace(low, high, PARTS, axis=1)
        failed, margin = _margins(designs, rows, parts)
        lost, at = _first(failed, parts)
        group[rows[lost > 0]], place[rows[lost > 0]] = lost[lost > 0], at[lost > 0]
        index = np.arange(len(rows))
        least = np.clip(np.argmin(margin, axis=1), 1, PARTS - 2)
        low, high = parts[index, least - 1], parts[index, least + 1]
    return group, place


def _margins(designs: Designs, rows: Number, places: Number) -> tuple[Number, Number]:
    """Return which group fails at places plus one, else 0, and the least margins, (rows, places)."""
    numbers = designs.between(rows, places).numbers
    failed, margin = designs.path.compiled.programs.limits.at_poses(numbers)
    # a motion continues through a change point
    return np.where(np.abs(margin) < ROUNDING, 0, failed), margin


def _first(failed: Number, places: Number) -> tuple[Number, Number]:
    """Return the first failure of each row, 0 for none, and its place."""
    index, k = np.arange(len(failed)), np.argmax(failed != 0, axis=1)
    return failed[index, k].copy(), places[index, k].copy()


def failure(motion: Motion, number: int) -> str:
    """Return a failure in words: of a group, of a guide beyond its travel limit, of wheels that do not fit."""
    is_group = number <= len(motion.structure.groups)
    why = "cannot be assembled" if is_group else "does not fit" if is_misfit(motion, number) else "is beyond an end"
    return f"{failed_name(motion, number)} {why}"


def is_misfit(motion: Motion, number: int) -> bool:
    """Tell whether a failure is of wheels that do not fit; these are numbered after groups and guides."""
    return number > motion.solving_order.fits.first


def failed_name(motion: Motion, number: int) -> str:
    """Return the name of the group that does not close, of the guide, or of the pair that does not fit."""
    if number > len(motion.structure.groups):
        return motion.solving_order.named(number)
    return label(motion.structure, number - 1)
