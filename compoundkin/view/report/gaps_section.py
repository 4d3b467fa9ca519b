"""The poses that cannot be assembled: from where to where, and why."""

from __future__ import annotations

from math import degrees

import numpy as np

from compoundkin.kinematics.gaps import Gap, gaps
from compoundkin.kinematics.quantities import Quantity
from compoundkin.view.report.report_data import Alert, Paragraph, Section
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import counted, listed

# A report lists this many gaps; a sweep may have thousands.
MOST_GAPS = 10


def gaps_section(sample: Sample, found: tuple[Gap, ...]) -> Section:
    """Return the poses that cannot be assembled. Between which driver values, which group, and why."""
    missing = int(np.count_nonzero(~sample.assembled))
    text = f"{missing:,} of {counted(sample.poses, 'pose')} cannot be assembled."
    alerts = [Alert(gap_sentence(sample, gap)) for gap in found[:MOST_GAPS]]
    more = [Paragraph(f"... and {counted(len(found) - MOST_GAPS, 'gap')} more.")] if len(found) > MOST_GAPS else []
    return Section("gaps", "Poses that cannot be assembled", (Paragraph(text), *alerts, *more))


def gap_sentence(sample: Sample, gap: Gap) -> str:
    """Return one gap in words. The drivers' interval, the group that does not close, and the reason."""
    in_time = gap.times is not None and bool(len(sample.varying) > 1 or sample.motion.mechanism.leads)
    spans = [_way(driver, gap) if in_time else _span(driver, gap) for driver in sample.varying]
    where = listed(spans) if spans else "At this pose"
    if in_time and gap.times is not None:
        where = f"{_in_time(*gap.times, gap)} ({'; '.join(spans)})"
    where = where[:1].upper() + where[1:]
    if gap.pair:
        return f"{where}, {gap.reason}."
    return f"{where}, the {gap.group} group of {listed(gap.links)} does not close: {gap.reason}."


def _in_time(begin: float, end: float, gap: Gap) -> str:
    """Return the times between which a motion cannot be followed."""
    if gap.open_begin and gap.open_end:
        return f"in the whole motion, {begin:.6g} s to {end:.6g} s"
    if gap.open_begin:
        return f"from the start, {begin:.6g} s, to {end:.6g} s"
    if gap.open_end:
        return f"from {begin:.6g} s to the end, {end:.6g} s"
    return f"between {begin:.6g} s and {end:.6g} s"


def _ends(driver: Quantity, gap: Gap) -> tuple[float, float, str]:
    """Return the driver's values at the ends of a gap, and their unit with a blank before it."""
    begin, end = (degrees(v[driver.name]) if driver.is_angle else v[driver.name] for v in (gap.begin, gap.end))
    return begin, end, f" {driver.unit}" if driver.unit != "length" else ""


def _way(driver: Quantity, gap: Gap) -> str:
    begin, end, unit = _ends(driver, gap)
    return f"{driver.name} {begin:.6g} to {end:.6g}{unit}"


def _span(driver: Quantity, gap: Gap) -> str:
    begin, end, unit = _ends(driver, gap)
    if gap.open_begin and gap.open_end:
        return f"in the whole motion, {driver.name} {begin:.9g} to {end:.9g}{unit}"
    if gap.open_begin:
        return f"from the start, {driver.name} {begin:.9g}{unit}, to {end:.9g}{unit}"
    if gap.open_end:
        return f"from {driver.name} {begin:.9g}{unit} to the end, {end:.9g}{unit}"
    return f"between {driver.name} {begin:.9g} and {end:.9g}{unit}"


def gaps_of(sample: Sample) -> tuple[Gap, ...]:
    """Return the gaps of one design."""
    if sample.assembled.all():
        return ()
    axes = sample.motion.shape[:-1]
    design = tuple(int(i) for i in np.unravel_index(sample.design, axes)) if axes else ()
    return tuple(gap for gap in gaps(sample.motion) if gap.design == design)
