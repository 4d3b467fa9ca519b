"""The report on the figures of a motion alone: what `compoundkin characteristics` prints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.analysis.characteristics.characteristics_of_motion import DWELL, STRAIGHT, characteristics
from compoundkin.analysis.characteristics.outputs_of_motion import chosen_outputs
from compoundkin.base.given_numbers import hold_design
from compoundkin.kinematics import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.view.report.gaps_section import gaps_of, gaps_section
from compoundkin.view.report.performance_section import performance_section
from compoundkin.view.report.report_data import Outcome
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample


def characteristics_report(
    motion: Motion,
    outputs: Sequence[str] = (),
    design: int = 0,
    dwell: float | None = None,
    straight: float | None = None,
) -> Report:
    """Report the figures of a motion, and where it is not assembled."""
    outputs = tuple(outputs)
    hold_design(design, motion.inputs.designs)
    motion = motion_of_design(motion, design)
    sample, chosen = Sample(motion), chosen_outputs(motion, outputs)
    named = bool(outputs or motion.mechanism.outputs)
    figures = characteristics(
        motion, chosen, 0, DWELL if dwell is None else dwell, STRAIGHT if straight is None else straight
    )
    section = performance_section(sample, figures, (), named)
    found = gaps_of(sample)
    missing = (gaps_section(sample, found),) if found else ()
    closed = int(np.count_nonzero(motion.failed == 0))
    outcome = Outcome(True, int(motion.failed.size), closed, 0, 0, 0, 0)
    return Report(motion.mechanism.title, (*missing, section), outcome, motion, outputs)
