"""What objects show of themselves in notebooks: pictures and tables as HTML, on light and on dark pages alike."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from functools import singledispatch
from html import escape

from compoundkin.branches import AllConfigurations, Circuits
from compoundkin.cams import CamAnalysis
from compoundkin.centres import Centres
from compoundkin.checks import Check
from compoundkin.drawing import draw, draw_structure
from compoundkin.errors import CompoundkinError
from compoundkin.freedom import MobilityAnalysis
from compoundkin.mechanism import Mechanism
from compoundkin.motion import solve
from compoundkin.motion.configuration import Configuration
from compoundkin.quantities import degrees
from compoundkin.reports.cams import cam_blocks
from compoundkin.reports.configurations import circuits_report, configurations_section
from compoundkin.reports.freedom import analysis_blocks
from compoundkin.reports.instant_centres import centre_blocks
from compoundkin.reports.model import Alert, Block, Cell, Column, Formula, Paragraph, Report, Section, Step, Table
from compoundkin.reports.numbers import written
from compoundkin.reports.parts import links_section
from compoundkin.reports.sampling import Sample
from compoundkin.reports.wording import counted, listed
from compoundkin.structure import Structure, decompose, roman

# Pictures of more links than these take more than a second: they are drawn where they are asked for.
MOST_LINKS = 30
# A notebook shows so many rows of a table; reports and the objects themselves have all.
MOST_ROWS = 40
# Inline, for notebooks give tables styles of their own: numbers would not line up, texts be aligned right. Colours are
# the page's, so that they fit light and dark ones.
CELL = "vertical-align:top;padding:.3em .6em"
LEFT, RIGHT = f"text-align:left;{CELL}", f"text-align:right;{CELL}"
FITTED = "max-width:100%;height:auto;"
CAPTION = "text-align:left;caption-side:top;font-weight:bold;padding:.5em 0"


def html_of(what: object) -> str | None:
    """What a notebook shows of an object; None where there is nothing to show, so that it shows the text instead.

    It never raises: an object that was made without an error is not to end in one because a cell ends with it.

    >>> from compoundkin.words import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> html_of(crank)[:7]
    '<figure'
    """
    try:
        return unguarded(what)
    except Exception:
        return None


def svg_of(what: Mechanism | Structure) -> str | None:
    """The picture of a mechanism, or of one taken apart; None where there is none, or where it would take long."""
    mechanism = what.mechanism if isinstance(what, Structure) else what
    if len(mechanism.links) > MOST_LINKS:
        return None
    try:
        return _apart(what) if isinstance(what, Structure) else _drawn(what)
    except CompoundkinError:
        return None


def _drawn(mechanism: Mechanism) -> str | None:
    """The sketch; none where a pose would have to be searched that is not likely to exist, which takes seconds."""
    return None if decompose(mechanism).faults and not mechanism.sketch else draw(mechanism).svg


def _apart(structure: Structure) -> str:
    """The groups; the graph of what cannot be taken apart."""
    return draw_structure(structure, "graph" if structure.faults else "groups").svg


def unguarded(what: object) -> str:
    """What `html_of` gives, errors and all; numbers that are not defined everywhere are no reason for a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return "\n".join(_parts(what))


@singledispatch
def _parts(what: object) -> Iterator[str]:
    raise TypeError(f"{type(what).__name__} shows nothing of its own")


@_parts.register
def _(what: Mechanism) -> Iterator[str]:
    structure = decompose(what)
    pairs = " + ".join(f"{count.number} {count.code}" for count in structure.mobility.pairs)
    facts = [counted(len(what.links), "link"), f"pairs {pairs}" if pairs else "no pairs"]
    facts.append(f"driven: {listed(drive.name for drive in what.drives)}" if what.drives else "no driver")
    facts += [f"lengths in {what.unit}"] if what.unit else []
    caption = f"<strong>{escape(what.title)}</strong>: {escape('; '.join(facts))}"
    if picture := what._repr_svg_():
        yield _figure(picture, caption)
    else:
        yield f"<p>{caption}</p>"
        yield from map(_block, links_section(structure).blocks)


@_parts.register
def _(what: Structure) -> Iterator[str]:
    said = f"{what.mobility.formula}; {what.mobility.verdict}"
    caption = f"<strong>{escape(what.mechanism.title)}</strong>: {escape(said)}"
    picture = what._repr_svg_()
    yield _figure(picture, caption) if picture else f"<p>{caption}</p>"
    yield from (_block(Alert(f"{fault.text[:1].upper()}{fault.text[1:]}.", fault.remedy)) for fault in what.faults)
    yield from (_block(Paragraph(f"Passive: {one}.")) for one in what.passive)
    yield from (_block(Paragraph(f"Left out: {one}.")) for one in (what.relaxation.dropped if what.relaxation else ()))
    yield _table(_groups(what), "Groups in solving order")


def _groups(structure: Structure) -> Table:
    """The frame with its driven links, then each group: what it is, its links, what it is attached to."""
    columns = (Column("no.", style="each"), Column("group"), Column("class"), Column("order", style="each"),
               Column("links"), Column("uses"))  # fmt: skip
    name = "frame and driver" if len(structure.ground.driven) == 1 else "frame and drivers"
    first = (0, name if structure.ground.driven else "frame", None, None, ", ".join(structure.ground.links), None)
    rows: list[tuple[Cell, ...]] = [first]
    for k, group in enumerate(structure.groups, start=1):
        rows.append((k, group.name, roman(group.class_), group.order, ", ".join(group.links), ", ".join(group.uses)))
    return Table(columns, tuple(rows))


@_parts.register
def _(what: Report) -> Iterator[str]:
    yield f"<h3>{escape(what.title)}</h3>"
    yield from _sections(what.sections)


@_parts.register
def _(what: Check) -> Iterator[str]:
    columns = (Column("check"), Column("worst", style="brief"), Column("limit", style="brief"), Column("at"),
               Column("", style="passed"))  # fmt: skip
    rows = tuple((f.name, f.value, f.limit, _where(f.pair, f.pose), f.passed) for f in what.findings)
    failed = [finding.name for finding in what.findings if not finding.passed]
    verdict = f"failed: {listed(failed)}" if failed else "all passed" if what.passed else "nothing to check"
    singular = f", {what.singular} of them without rates" if what.singular else ""
    yield _table(Table(columns, rows), f"Checks of {counted(what.poses, 'pose')}{singular}: {verdict}")


def _where(name: str, pose: tuple[int, ...]) -> str:
    return f"{name}, pose {', '.join(map(str, pose))}" if name and pose else name


@_parts.register
def _(what: Circuits) -> Iterator[str]:
    yield from _sections(circuits_report(what).sections)


@_parts.register
def _(what: AllConfigurations) -> Iterator[str]:
    yield from _sections([configurations_section(what)])


@_parts.register
def _(what: Configuration) -> Iterator[str]:
    mechanism = what.structure.mechanism
    caption = f"<strong>{escape(what.name)}</strong>: {escape(mechanism.title)}"
    if len(mechanism.links) <= MOST_LINKS:
        yield _figure(draw(solve(what.structure, what.values, modes=what, order=0)).svg, caption)
    else:
        yield f"<p>{caption}</p>"
    columns = Column("link"), Column("angle", "deg", "fixed", floor=1e-9)
    rows = tuple((name, float(degrees(angle))) for name, angle in what.angles.items())
    yield _table(Table(columns, rows), "Angles of the links")


@_parts.register
def _(what: Centres) -> Iterator[str]:
    yield from map(_block, centre_blocks(what))


@_parts.register
def _(what: MobilityAnalysis) -> Iterator[str]:
    yield from map(_block, analysis_blocks(what))


@_parts.register
def _(what: CamAnalysis) -> Iterator[str]:
    yield from map(_block, cam_blocks(Sample(what.motion), what))


def _sections(sections: Iterable[Section]) -> Iterator[str]:
    for section in sections:
        if section.title:
            yield f"<h4>{escape(section.title)}</h4>"
        yield from map(_block, section.blocks)


def _figure(svg: str, caption: str) -> str:
    """A picture, not wider than the page, with what stands below it."""
    fitted = svg.replace('style="', f'style="{FITTED}', 1)
    return f'<figure style="margin:0 0 .5em">\n{fitted}<figcaption>{caption}</figcaption>\n</figure>'


def _table(table: Table, caption: str = "") -> str:
    """A table whose first column names its rows; in a box of its own that scrolls where it is wider than the page."""
    rows = table.shown_rows
    cells = [written(column, [row[k] for row in rows[:MOST_ROWS]]) for k, column in enumerate(table.columns)]
    sides = [RIGHT if column.is_number else LEFT for column in table.columns]
    heads = [f'<th scope="col" style="{side}">{_heading(c)}</th>' for c, side in zip(table.columns, sides, strict=True)]
    lines = [f"<tr>{''.join(_cells(row, sides))}</tr>" for row in zip(*cells, strict=True)]
    more = len(table.rows) - min(len(rows), MOST_ROWS)
    if more > 0:
        lines.append(f'<tr><td colspan="{len(heads)}" style="{LEFT}">... and {counted(more, "more row")}</td></tr>')
    named = f'<caption style="{CAPTION}">{escape(caption)}</caption>\n' if caption else ""
    head = f"<thead><tr>{''.join(heads)}</tr></thead>"
    body = "\n".join(["<tbody>", *lines, "</tbody>"])
    return f'<div style="overflow-x:auto"><table>\n{named}{head}\n{body}\n</table></div>'


def _heading(column: Column) -> str:
    return escape(f"{column.name} [{column.unit}]" if column.unit else column.name)


def _cells(row: Iterable[str], sides: Iterable[str]) -> Iterator[str]:
    for k, (text, side) in enumerate(zip(row, sides, strict=True)):
        tag, scope = ("td", "") if k else ("th", ' scope="row"')
        yield f'<{tag}{scope} style="{side}">{_lines(text)}</{tag}>'


def _lines(text: str) -> str:
    return escape(text).replace("\n", "<br>")


@singledispatch
def _block(block: Block) -> str:
    raise TypeError(f"{type(block).__name__} is not a part of a report")


@_block.register
def _(block: Paragraph) -> str:
    return f"<p>{escape(block.text)}</p>"


@_block.register
def _(block: Formula) -> str:
    return f"<pre>{escape(block.text)}</pre>"


@_block.register
def _(block: Alert) -> str:
    remedy = f" Remedy: {escape(block.remedy)}." if block.remedy else ""
    return f'<p role="note"><strong>{escape(block.text)}</strong>{remedy}</p>'


@_block.register
def _(block: Step) -> str:
    facts = "".join(f"<dt>{escape(term)}</dt><dd>{escape(text)}</dd>" for term, text in block.facts)
    return f"<h5>{escape(block.title)}</h5><dl>{facts}</dl>"


@_block.register
def _(block: Table) -> str:
    return _table(block)
