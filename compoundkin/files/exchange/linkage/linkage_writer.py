"""From a mechanism at one pose to the text of a `.linkage2` file."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, log10

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawing_of_mechanism import drawing_of
from compoundkin.files.exchange.drawings.drawn_elements import Drawing
from compoundkin.files.exchange.linkage.linkage_elements import plain
from compoundkin.files.exchange.linkage.linkage_layout import linkage_layout
from compoundkin.files.exchange.linkage.linkage_records import MM_PER_INCH, PER_INCH
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.units import LENGTHS

# A drawing between these sizes, in millimetres, is at true size; others have a scale of a power of ten.
_SMALLEST, _LARGEST = 20.0, 2000.0
# Tables of pairs that a drawing has and the program has not, with what they are there.
_UNKNOWN = {"racks": "rack"}


def linkage_text(shown: ShownMechanism) -> tuple[str, list[str]]:
    """Return the text and what is told of it. Raises InvalidInput with all that cannot be said."""
    unsaid = list(_unsaid(shown))
    try:
        drawing = drawing_of(shown)
    except InvalidInput as error:
        unsaid += error.problems
    if unsaid:
        raise InvalidInput(unsaid, heading=f"{shown.mechanism.title!r} cannot be said in Linkage")
    problems = Problems(shown.mechanism.title)
    plan = linkage_layout(shown, drawing, problems)
    problems.raise_if_any()
    unit, scale, factor, notes = _scale(drawing, plan.size)
    lines = ["<linkage2>"]
    view = f'zoom="1" xoffset="0" yoffset="0" scalefactor="{plain(factor)}" units="{unit}"'
    lines.append(f"\t<program {view}/>")
    lines += [line for one in plan.connectors for line in one.lines(scale)]
    lines += [line for link in (*plan.links.values(), *plan.extra) for line in link.lines(scale)]
    lines += ["\t<selected>", "\t</selected>"]
    if plan.ratios:
        inside = [f"\t{line}" for ratio in plan.ratios for line in ratio.lines(scale)]
        lines += ["\t<ratios>", *inside, "\t</ratios>"]
    return "\n".join([*lines, "</linkage2>", ""]), [*notes, *plan.notes, *_dropped(drawing)]


def _unsaid(shown: ShownMechanism) -> Iterator[Problem]:
    """Find rings, crossed belts and racks."""
    for where, pair in shown.mechanism.placed_pairs:
        ring = pair.table == "gears" and getattr(pair, "internal", False)
        crossed = pair.table == "belts" and getattr(pair, "crossed", False)
        what = "ring" if ring else "crossed belt" if crossed else _UNKNOWN.get(pair.table)
        if what:
            yield Problem(where, f"{pair.name!r} is a {what}, which Linkage does not have")


def _scale(drawing: Drawing, size: float) -> tuple[str, float, float, list[str]]:
    """Return the unit, how many of the file's lengths are one of the drawing, the scale factor, and what is told."""
    metres = LENGTHS.get(drawing.unit, LENGTHS["mm"])
    inches = drawing.unit in ("in", "ft")
    shown = metres / LENGTHS["in" if inches else "mm"]
    notes = []
    if drawing.unit not in ("mm", "in"):
        there = "in" if inches else "mm"
        said = f"1 {drawing.unit}" if drawing.unit else "lengths have no unit: 1"
        notes.append(f"{said} is {shown:g} {there} there")
    mm = size * shown * (MM_PER_INCH if inches else 1.0)
    factor = 1.0 if _SMALLEST <= mm <= _LARGEST else 10.0 ** floor(log10(mm / 2.0 / _SMALLEST))
    return (
        ("Inches" if inches else "Millimeters"),
        shown * PER_INCH / (1.0 if inches else MM_PER_INCH) / factor,
        factor,
        notes,
    )


def _dropped(drawing: Drawing) -> Iterator[str]:
    """Yield the note that counts what has no place in the file."""
    many = (*drawing.dropped, ("mass", len(drawing.masses)), ("force", len(drawing.forces)))
    said = [count_phrase(number, what, "masses" if what == "mass" else "") for what, number in many if number]
    if said:
        yield f"left out, for Linkage has no place for it: {', '.join(said)}"
