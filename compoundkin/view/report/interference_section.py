"""The section Interference: which links touch, from where to where, and how near the others come."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import degrees

from compoundkin.analysis.interference import Interference, LinkClearance, LinkTouch, interference
from compoundkin.base.errors import InvalidInput
from compoundkin.kinematics import Motion
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import with_unit
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, joined_links, listed, number_text, point_text, sentence

# At most so many clearances are listed, the least first.
MOST_CLEARANCES = 12
# At most so many designs are reported.
MOST_DESIGNS = 3
INTERFERENCE = "interference"


def interference_or_error(motion: Motion) -> Interference | InvalidInput | None:
    """Return the interference of outlines, the error where they cannot be compared, None without outlines."""
    if not motion.mechanism.outlines:
        return None
    try:
        return interference(motion)
    except InvalidInput as error:
        return error


def interference_sections(sample: Sample, found: Interference | InvalidInput | None) -> tuple[Section, ...]:
    """Return the section on outlines; none without outlines."""
    if found is None:
        return ()
    if isinstance(found, InvalidInput):
        blocks: tuple[Block, ...] = (Alert(f"Outlines were not compared: {found}."),)
    else:
        blocks = tuple(interference_blocks(sample, found))
    return (Section(INTERFERENCE, "Interference", blocks),)


def with_interference(outcome: Outcome, found: Interference | InvalidInput | None) -> Outcome:
    """Return an outcome with the number of touches."""
    if not isinstance(found, Interference):
        return outcome
    return replace(outcome, touching=len(found.touching), compared=found.verdict)


def interference_blocks(sample: Sample, found: Interference) -> Iterator[Block]:
    """Yield a design's touches and clearances."""
    touches = [one for one in found.touches if one.design == sample.design]
    clearances = [one for one in found.clearances if one.design == sample.design]
    text = (
        "Outlines that share a layer are compared, at the poses and between them. Of joined links, what reaches the"
        " points of their joint overlaps by nature and is left out."
    )
    yield Paragraph(f"{sentence(found.verdict)} {text}")
    if found.missing:
        yield Paragraph(f"{counted(found.missing, 'pose')} that cannot be assembled are left out.")
    yield from (Alert(f"{touch_sentence(sample, one)}.") for one in touches)
    if clearances:
        yield TableBlock(_columns(sample), tuple(_row(sample, one) for one in clearances[:MOST_CLEARANCES]))
    if len(clearances) > MOST_CLEARANCES:
        yield Paragraph(f"... and {counted(len(clearances) - MOST_CLEARANCES, 'pair')} of links farther apart.")
    if found.neighbours:
        names = ", ".join(joined_links(two) for two in found.neighbours[:MOST_CLEARANCES])
        more = f", {len(found.neighbours) - MOST_CLEARANCES} more" if len(found.neighbours) > MOST_CLEARANCES else ""
        yield Paragraph(f"Neighbours whose shapes about their joint are not compared: {names}{more}.")


def blocks_of_designs(found: Interference) -> Iterator[Block]:
    """Yield touches and clearances of the first designs."""
    for design in range(found.motion.inputs.designs)[:MOST_DESIGNS]:
        yield from interference_blocks(Sample(found.motion, design), found)


def touch_sentences(motion: Motion, found: Interference | InvalidInput | None) -> Iterator[str]:
    """Yield all touches in words; with several designs each names its design."""
    for one in found.touches if isinstance(found, Interference) else ():
        of = f", design {one.design}" if motion.inputs.designs > 1 else ""
        yield f"interference: {touch_sentence(Sample(motion, one.design), one)}{of}"


def touch_sentence(sample: Sample, touch: LinkTouch) -> str:
    """Return one touch in words. "crank and frame touch from crank 75.5225° to 104.478°, first at (0, 7)"."""
    layers = f"{'layer' if len(touch.layers) == 1 else 'layers'} {listed(map(str, touch.layers))}"
    two = f"{touch.one} and {touch.other} on {layers}"
    if sample.poses == 1:
        return f"{two} touch, at {point_text(touch.at)}"
    spans = [
        f"{one.name} {_driver_value(one, touch.begin)} to {_driver_value(one, touch.end)}" for one in sample.varying
    ]
    if touch.times is not None:
        spans = [f"{number_text(touch.times[0])} s to {number_text(touch.times[1])} s", *spans]
    if touch.open_begin and touch.open_end and touch.first <= touch.last:
        return f"{two} touch all the way from {'; '.join(spans)}"
    return f"{two} touch from {'; '.join(spans)}, first at {point_text(touch.at)}"


def _driver_value(driver: Quantity, values: Mapping[str, float]) -> str:
    """Return a driver's value with its unit."""
    value = degrees(values[driver.name]) if driver.is_angle else values[driver.name]
    return with_unit(f"{value + 0.0:.9g}", driver.unit)


def _columns(sample: Sample) -> tuple[Column, ...]:
    unit = sample.motion.mechanism.unit
    places = [Column(f"at {one.name}", one.unit, "fixed", 1e-9) for one in sample.varying]
    return (Column("link"), Column("and"), Column("layer"), Column("least clearance", unit, "each"), *places,
            Column("x", unit, "fixed"), Column("y", unit, "fixed"))  # fmt: skip


def _row(sample: Sample, one: LinkClearance) -> tuple[Cell, ...]:
    values = (degrees(one.drives[d.name]) if d.is_angle else one.drives[d.name] for d in sample.varying)
    layers = ", ".join(map(str, one.layers))
    return (one.one, one.other, layers, one.clearance, *values, one.at.real, one.at.imag)
