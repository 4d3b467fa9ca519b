"""Segments cut at the ends of guides."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.configurations.closed_form_segments import CELLS, Margins, cuts_between, events_of, glued
from compoundkin.configurations.segment_poses import Sweep
from compoundkin.configurations.segments import END, Segments
from compoundkin.kinematics.block import Block


def cut_at_ends(sweep: Sweep, segments: Segments, fineness: int = 1) -> Segments:
    """Return the parts of segments on which no guide is left. All groups are lifted."""
    guide_ends = sweep.solving_order.guide_ends
    if not guide_ends.pairs or not segments.rows:
        return segments
    margins = _EndMargins(sweep, segments, None, CELLS * fineness)
    # what only touches an end goes on
    events = [[event for event in found if not event.touching] for found in events_of(margins)]
    found = glued(segments, None, list(cuts_between(margins, events, (1,))), margins.at_ends())
    rows, sides = np.nonzero(found.kind == END)
    if len(rows):
        values = np.where(sides == 1, found.high[rows], found.low[rows])
        found.group[rows, sides] = guide_ends.nearest(sweep.run(found, rows, values[:, None]))[:, 0]
    return found


class _EndMargins(Margins):
    """How far all pairs are from the ends of their guides."""

    def of(self, block: Block) -> Number:
        return self.sweep.solving_order.guide_ends.margin(block)
