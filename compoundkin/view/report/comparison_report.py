"""The report of a comparison: two mechanisms side by side, and where they come farthest apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees

from compoundkin.analysis.comparison.common_pose import scale_of_units
from compoundkin.analysis.comparison.comparison_findings import ROUNDING, MechanismComparison
from compoundkin.model.elements import FRAME
from compoundkin.view.report.report_data import Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import brief, counted, listed, number

# Speeds that differ by no more than this part are the same: some programs have rpm of three decimals.
_SAME_SPEED = 1e-3


def comparison_report(found: MechanismComparison) -> Report:
    """Report two mechanisms side by side."""
    one, other = (structure.mechanism for structure in found.structures)
    sections = (
        Section("about", "", tuple(_about(found))),
        Section("structure", "Structure", (_structure(found),)),
        *([Section("points", "Motion", tuple(_motion(found)))] if found.places else []),
        *([Section("drivers", "Drivers", tuple(_drivers(found)))] if found.drivers else []),
        *([Section("dimensions", "Dimensions", tuple(_dimensions(found)))] if found.lengths else []),
    )
    outcome = Outcome(not any(s.faults for s in found.structures), found.poses + found.apart, found.poses, 0, 0, 0, 0)
    # of the structure a page has the sketch alone, not the dimensions to be changed, which belong to the first only
    return Report(f"{one.title} / {other.title}", sections, outcome, found.structures[0], studied=found)


def _about(found: MechanismComparison) -> Iterator[Block]:
    """Yield what is compared, how the two fit onto each other, and what it comes to."""
    one, other = (structure.mechanism for structure in found.structures)
    yield Paragraph(f"First: {one.title}, {one.in_numbers}. Second: {other.title}, {other.in_numbers}.")
    if found.matched_by:
        how = "places at a pose that both have" if found.matched_by == "place" else "names"
        scaled = "" if found.scale == 1.0 else f" Lengths of the second count {number(found.scale)} times."
        yield Paragraph(f"Points stand for each other by their {how}.{scaled}")
        units = scale_of_units(one, other)
        if units is not None and abs(found.scale / units - 1.0) > ROUNDING:
            yield Paragraph(f"By their units the second is {number(units / found.scale)} times as large as the first.")
    alone = (("the first", found.only_one), ("the second", found.only_other))
    for which, letters in alone if found.points else ():
        if letters:
            yield Paragraph(f"Only {which} has {counted(len(letters), 'point')}: {listed(letters)}.")
    yield Paragraph(f"In short: {_verdict(found)}.")


def _verdict(found: MechanismComparison) -> str:
    """Return what it comes to, with where that is."""
    largest = found.largest
    if largest is None or largest.distance <= ROUNDING * found.size:
        return found.verdict
    angles = found.structures[0].driven_angles
    told = (f"{k} {number(degrees(v))} deg" if angles[k] else f"{k} {number(v)}" for k, v in largest.drives.items())
    return f"{found.verdict} with {listed(told)}, {brief(largest.distance / found.size)} of the size"


def _structure(found: MechanismComparison) -> Block:
    rows = tuple((fact.what, fact.one, fact.other, "differs" if fact.differs else "") for fact in found.facts)
    return TableBlock((Column(""), Column("first"), Column("second"), Column("")), rows)


def _motion(found: MechanismComparison) -> Iterator[Block]:
    """Yield how far apart points and links come, and where."""
    unit, floor = found.structures[0].mechanism.unit, ROUNDING * found.size
    yield Paragraph(
        f"Driven alike from the common pose, {counted(found.poses, 'pose')} of both; the greatest distance of each "
        "point, and the first's drivers there:"
    )
    where = _columns(found)
    points = Column("point"), Column("second's"), Column("distance", unit, "each", floor)
    rows = tuple((one.point, one.other, one.distance, *_at(found, one.drives)) for one in found.places)
    yield TableBlock((*points, *where), rows, keys=1)
    if found.turns:
        yield Paragraph("Links without two points that tell how they turn, counted from the first pose:")
        links = Column("link"), Column("second's"), Column("angle", "deg", "each", degrees(ROUNDING))
        turned = tuple((one.link, one.other, degrees(one.angle), *_at(found, one.drives)) for one in found.turns)
        yield TableBlock((*links, *where), turned, keys=1)


def _columns(found: MechanismComparison) -> tuple[Column, ...]:
    unit, angles = found.structures[0].mechanism.unit, found.structures[0].driven_angles
    return tuple(Column(f"at {one.name}", "deg" if angles[one.name] else unit, "fixed") for one in found.drivers)


def _at(found: MechanismComparison, drives: Mapping[str, float]) -> Iterator[Cell]:
    for one in found.drivers:
        yield degrees(drives[one.name]) if one.is_angle else drives[one.name]


def _drivers(found: MechanismComparison) -> Iterator[Block]:
    """Yield the drivers, their values at the common pose, and the range of displacements from there."""
    differing = [one for one in found.drivers if abs(one.speed - one.other_speed) > _SAME_SPEED * abs(one.speed)]
    if differing:
        unit = found.structures[0].mechanism.unit or "1"
        told = (
            f"{one.name} has {number(one.speed)}, in the second {number(one.other_speed)} "
            f"{'rad' if one.is_angle else unit}/s"
            for one in differing
        )
        yield Paragraph(f"Speeds differ, and are not compared: {listed(told)}.")
    rows: list[tuple[Cell, ...]] = []
    for one in found.drivers:
        unit = "deg" if one.is_angle else found.structures[0].mechanism.unit
        values = one.start, one.other_start, *one.reach
        shown = [degrees(value) if one.is_angle else value for value in values]
        way = "the same" if one.sign > 0 else "the other"
        rows.append((one.name, one.other, way, *shown, unit))
    words = ("first at the common pose", "second there", "moved from", "to")
    numbers = (Column(word, style="each", floor=ROUNDING * max(found.size, 360.0)) for word in words)
    yield TableBlock((Column("driver"), Column("second's"), Column("way"), *numbers, Column("unit")), tuple(rows))


def _dimensions(found: MechanismComparison) -> Iterator[Block]:
    """Yield the distances of points on links, and by how much they differ."""
    unit, floor = found.structures[0].mechanism.unit, ROUNDING * found.size
    rows = tuple(
        (one.link, "-".join(one.points), one.other_link, "-".join(one.other_points), one.one, one.other, one.difference)
        for one in found.lengths
    )
    alone = [name for name in found.structures[0].mechanism.links if name not in found.links and name != FRAME]
    if alone:
        yield Paragraph(f"No link of the second stands for {listed(alone)}.")
    yield Paragraph("Distances of points on the links:")
    heads = Column("link"), Column("points"), Column("second's"), Column("its points")
    numbers = Column("first", unit, "each"), Column("second", unit, "each"), Column("difference", unit, "each", floor)
    yield TableBlock((*heads, *numbers), rows)
