"""What moves: outputs over the cycle and their extremes, cams, and what stands for higher pairs at one pose."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.analysis.cam_analysis import CamAnalysis, cam_analysis, cam_pairs
from compoundkin.analysis.equivalents import replaced
from compoundkin.base.errors import CompoundkinError
from compoundkin.kinematics import Motion
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import (
    ANGLE,
    DISPLACEMENT,
    POSITION,
    order_of,
    unit_of,
)
from compoundkin.model.elements import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose, roman
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import ROUNDING, Sample
from compoundkin.view.report.wording import counted, listed, number, ordinal

# A mechanical advantage at a toggle position.
INFINITE = "inf"
# How many outputs a report chooses where the mechanism names none.
MOST_OUTPUTS = 6
WAYS = {True: "oscillates about a pin", False: "translates on a slide", None: "has no guide of its own"}


def default_outputs(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the outputs of a mechanism that names none. Tracer points and links without a driver, a few.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = link("crank", A=0, B=1), link("rod", B=0, P=2), link("frame", A=0)
    >>> default_outputs(Mechanism("m", *crank, drive("crank")))
    ('P.position', 'rod.angle')
    """
    if mechanism.outputs:
        return mechanism.outputs
    used = {letter for pair in mechanism.written_pairs for letter in pair.letters}
    free = {k: links for k, links in mechanism.carriers.items() if k not in used and len(links) == 1}
    driven = {drive.link for drive in mechanism.drives}
    tracers = [letter for letter, links in free.items() if links != (FRAME,)]
    tracers = [letter for letter in tracers if free[letter][0] not in driven] or tracers
    sliding = {pair.members[1]: pair.name for pair in mechanism.written_pairs
               if pair.is_simple and not pair.free_is_angle and pair.members[0] == FRAME}  # fmt: skip
    moving = [name for name in mechanism.links if name != FRAME and name not in driven]
    lines = [f"{sliding[name]}.{DISPLACEMENT}" if name in sliding else f"{name}.{ANGLE}" for name in moving]
    return tuple([*(f"{name}.{POSITION}" for name in tracers), *lines][:MOST_OUTPUTS])


def chosen_outputs(motion: Motion, outputs: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the outputs asked for, else the mechanism's by default.

    The motion must have been solved for the latter.
    """
    return tuple(outputs) or tuple(n for n in default_outputs(motion.mechanism) if order_of(n) <= motion.order)


def outputs_section(sample: Sample, outputs: Sequence[str]) -> Section:
    """Return the outputs over the cycle, and where each is least and greatest."""
    found = [sample.quantity(name) for name in outputs]
    drivers = [(sample.driver_column(driver), driver.values) for driver in sample.varying]
    # several drivers are columns like any other, and the poses are numbered or have their times
    first = drivers if len(drivers) == 1 and sample.times is None else [sample.places, *drivers]
    columns = [*first, *(column for one in found for column in _columns(sample, one))]
    rows = tuple(tuple(_cell(values[pose]) for _, values in columns) for pose in sample.rows)
    table = TableBlock(tuple(column for column, _ in columns), rows, keys=1)
    blocks = (Paragraph(_introduction(sample)), table) if found else (Paragraph("No outputs are named."),)
    return Section("outputs", "Outputs over the cycle", (*blocks, *_extremes(sample, found)))


def _introduction(sample: Sample) -> str:
    every = "all" if sample.every == 1 else f"every {ordinal(sample.every)} of"
    text = f"{every} {counted(sample.poses, 'pose')}" if sample.poses > 1 else "a single pose"
    constant = [driver for driver in sample.drivers if driver not in sample.varying]
    held = [f"{driver.name} = {driver.values[0]:g} {driver.unit}" for driver in constant]
    missing = " A dash: not assembled." if not sample.assembled.all() else ""
    return f"{text[:1].upper() + text[1:]}{'; ' + listed(held) if held else ''}.{missing}"


def _columns(sample: Sample, found: Quantity) -> Iterator[tuple[Column, Any]]:
    """One column for a number, two for a vector."""
    floor = sample.floor(found)
    for k, part in enumerate(found.components):
        yield Column(part.name, part.unit, "fixed", floor, follows=k > 0), part.values


def _extremes(sample: Sample, found: Sequence[Quantity]) -> Iterator[Block]:
    """The least and the greatest value of each output over all poses, and at which driver value."""
    if sample.poses < 2 or not sample.assembled.any() or not found:
        return
    at = replace(sample.places[0], name=f"at {sample.places[0].name}", style="each")
    ends = Column("least", style="each"), at, Column("greatest", style="each"), at
    columns = (Column("output"), Column("unit"), *ends)
    yield Paragraph(f"Extremes over the {counted(sample.poses, 'pose')} (not interpolated):")
    yield TableBlock(columns, tuple(row for one in found for row in _extreme_rows(sample, one)))


def _extreme_rows(sample: Sample, found: Quantity) -> Iterator[tuple[Cell, ...]]:
    parts = list(_columns(sample, found))
    if found.is_vector and found.order:
        parts.append((Column(f"|{found.name}|", found.unit, floor=sample.floor(found)), np.abs(found.values)))
    for column, values in parts:
        if np.isfinite(values).any():
            yield column.name, column.unit, *_extreme(sample, values, column.floor)


def _extreme(sample: Sample, values: Any, floor: float) -> tuple[Cell, ...]:
    """The least value and where it is first taken, the greatest and where; differences by rounding are none."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    # an advantage is infinite at toggle positions
    slack = max(floor, ROUNDING * float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0)))
    shown = [0.0 if abs(value) <= floor else _cell(value) for value in (low, high)]
    if high - low <= slack:
        return shown[0], "always", shown[1], "always"
    places = sample.places[1]
    first, second = places[np.argmax(values <= low + slack)], places[np.argmax(values >= high - slack)]
    return shown[0], float(first), shown[1], float(second)


def _cell(value: Any) -> float | str | None:
    if np.isposinf(value):
        return INFINITE
    return float(value) if np.isfinite(value) else None


def cams_sections(sample: Sample) -> tuple[Section, ...]:
    """Return one section for all cams, where there are any."""
    names = cam_pairs(sample.motion) if sample.motion.order and sample.assembled.any() else ()
    blocks = [block for name in names for block in cam_blocks(sample, cam_analysis(sample.motion, name))]
    return (Section("cams", "Cams", tuple(blocks)),) if blocks else ()


def cam_blocks(sample: Sample, found: CamAnalysis) -> Iterator[Block]:
    """Report one cam: pressure angle, curvature, sliding, warnings."""
    pair = found.pair
    said = f"{pair.name}: {found.follower} {WAYS[found.oscillates]}. The pressure angle is customarily not greater than"
    yield Paragraph(f"{said} {number(float(np.rad2deg(found.allowed_pressure_angle)))} degrees.")
    place = sample.places[0]
    at = Column(f"at {place.name}", place.unit, "each", follows=True)
    columns = (
        Column("quantity"),
        Column("unit"),
        Column("least", style="each"),
        at,
        Column("greatest", style="each"),
        at,
    )
    yield TableBlock(columns, tuple(_cam_rows(sample, found)), keys=1)
    yield from (Alert(warning) for warning in found.warnings)


def _cam_rows(sample: Sample, found: CamAnalysis) -> Iterator[tuple[Cell, ...]]:
    unit = unit_of(sample.motion.mechanism.unit, "length")
    yield _cam_extremes(sample, "pressure angle", "deg", np.rad2deg(found.pressure_angle))
    yield _cam_extremes(sample, "radius of curvature of the profile", unit, found.radius_of_curvature)
    if found.pitch_radius is not None and found.roller_rate is not None:
        yield _cam_extremes(sample, "radius of curvature of the pitch curve", unit, found.pitch_radius)
    yield _cam_extremes(sample, "sliding at the contact", f"{unit}/s", found.sliding)
    if found.roller_rate is not None:
        yield _cam_extremes(sample, "spin of a roller that rolls", "rad/s", found.roller_rate)


def _cam_extremes(sample: Sample, what: str, unit: str, values: Any) -> tuple[Cell, ...]:
    """The least and the greatest value and where they are; what is infinite or not known is left out."""
    column, places = sample.places
    of = sample.of(values)
    known = np.flatnonzero(np.isfinite(of))
    if not known.size:
        return what, unit, None, None, None, None
    least, greatest = known[np.argmin(of[known])], known[np.argmax(of[known])]
    floor = max(column.floor, 0.0)
    cells = (float(of[least]), float(places[least]), float(of[greatest]), float(places[greatest]))
    low, low_at, high, high_at = (0.0 if k % 2 and abs(v) <= floor else v for k, v in enumerate(cells))
    return what, unit, low, low_at, high, high_at


def equivalent_section(sample: Sample) -> Section | None:
    """Report what stands for each higher pair at the first pose with rates. None without any."""
    motion = sample.motion
    regular = np.flatnonzero(sample.of(np.broadcast_to(motion.regular, motion.failed.shape).reshape(motion.shape)))
    if not len(regular):
        return None
    at = sample.design * sample.poses + int(regular[0])
    try:
        linkage, found = replaced(motion, at)
    except CompoundkinError:
        return None
    if not found:
        return None
    rows = tuple((one.pair.name, one.pair.title, *_link(one.length), *map(_place, one.centres)) for one in found)
    columns = (
        Column("pair"), Column("kind"), Column("stands for it"), Column("length", style="each"),
        Column("centre on the first"), Column("centre on the second"),
    )  # fmt: skip
    groups = [f"{g.name} ({listed(g.links)}; class {roman(g.class_)})" for g in decompose(linkage).groups]
    text = (
        f"Pins and slides that give the same velocities and accelerations at pose {int(regular[0])}, and there only: a"
        " bar between the centres of curvature, or a block on a straight profile. "
        f"Its groups: {listed(groups) if groups else 'none'}."
    )
    return Section("equivalent", "Equivalent linkage", (Paragraph(text), TableBlock(columns, rows)))


def _link(length: float | None) -> tuple[Cell, Cell]:
    return ("a block", None) if length is None else ("a bar", length)


def _place(centre: complex | None) -> str:
    return "straight" if centre is None else f"({centre.real:.6g}, {centre.imag:.6g})"
