"""The blocks and sections of a report as HTML: for pages, and plain with styles inline for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from compoundkin.view.page.html_tables import HtmlTable, Names, table_html
from compoundkin.view.page.markup import element, lines, safe, screen_reader_text
from compoundkin.view.page.mathml import UnknownLatex, mathml, with_formulas
from compoundkin.view.report.report_data import (
    ABOUT,
    Alert,
    FormulaBlock,
    Paragraph,
    Section,
    StepBlock,
    TableBlock,
    not_a_block,
)
from compoundkin.view.report.wording import column_texts, counted, title_with_unit, typeset
from compoundkin.view.sketch.svg import link_names

# A notebook shows so many rows of a table; reports and the objects themselves have all.
MOST_ROWS = 40
# Inline, for notebooks give tables styles of their own: numbers would not line up, texts be aligned right. Colours are
# the page's, so that they fit light and dark ones.
CELL = "vertical-align:top;padding:.3em .6em"
LEFT, RIGHT = f"text-align:left;{CELL}", f"text-align:right;{CELL}"
CAPTION = "text-align:left;caption-side:top;font-weight:bold;padding:.5em 0"
FITTED = "max-width:100%;height:auto;"
# The section that stands in the head of the page, and the one whose steps are the groups.
GROUPS = "groups"
# Sections whose numbers depend on the dimensions: a page with changed dimensions marks them.
OF_DIMENSIONS = frozenset((
    "links", "circuits", "outputs", "performance", "checks", "published", "gaps", "forces", "force-checks", "centres",
    "secondary", "velocities", "figures", "limits", "toggles", "changes", "cams", "configurations", "branches",
    "equations", "newton", "constants", "states", "simulation", "unknowns", "interference", "motors",
    "singularities",
))  # fmt: skip


def plain_sections(sections: Iterable[Section]) -> Iterator[str]:
    """Write sections with their headings, block by block."""
    for section in sections:
        if section.title:
            yield element("h4", safe(section.title))
        for block in section.blocks:
            if section.key == ABOUT and isinstance(block, Paragraph):
                yield element("p", with_formulas(typeset(block.text)))
            else:
                yield plain_block(block)


def plain_table(table: TableBlock, caption: str = "") -> str:
    """Write a table whose first column names its rows, in a box that scrolls where it is wider than the page."""
    rows = table.selected_rows
    cells = [column_texts(column, [row[k] for row in rows[:MOST_ROWS]]) for k, column in enumerate(table.columns)]
    sides = [RIGHT if column.is_number else LEFT for column in table.columns]
    heads = (
        element("th", safe(title_with_unit(c)), scope="col", style=s) for c, s in zip(table.columns, sides, strict=True)
    )
    found = [element("tr", "".join(_cells(row, sides))) for row in zip(*cells, strict=True)]
    more = len(table.rows) - min(len(rows), MOST_ROWS)
    if more > 0:
        text = f"... and {counted(more, 'more row')}"
        found.append(element("tr", element("td", text, colspan=str(len(sides)), style=LEFT)))
    parts = [
        element("caption", safe(caption), style=CAPTION) if caption else "",
        element("thead", element("tr", "".join(heads))),
        element("tbody", f"\n{lines(found)}\n"),
    ]
    return element("div", element("table", f"\n{lines(parts)}\n"), style="overflow-x:auto")


def plain_figure(svg: str, caption: str) -> str:
    """Write a picture, not wider than the page, with a caption."""
    fitted = svg.replace('style="', f'style="{FITTED}', 1)
    return f'<figure style="margin:0 0 .5em">\n{fitted}<figcaption>{caption}</figcaption>\n</figure>'


def _cells(row: Iterable[str], sides: Iterable[str]) -> Iterator[str]:
    for k, (text, side) in enumerate(zip(row, sides, strict=True)):
        inside = safe(typeset(text)).replace("\n", "<br>")
        yield element("td", inside, style=side) if k else element("th", inside, scope="row", style=side)


def plain_block(block: object) -> str:
    """Return any block of a report for a notebook."""
    match block:
        case Paragraph():
            return element("p", safe(typeset(block.text)))
        case FormulaBlock():
            return _formula(block) if block.latex else element("pre", safe(typeset(block.text)))
        case Alert():
            remedy = f" Remedy: {safe(block.remedy)}." if block.remedy else ""
            return element("p", element("strong", safe(typeset(block.text))) + remedy, role="note")
        case StepBlock():
            facts = (element("dt", safe(term)) + element("dd", safe(typeset(text))) for term, text in block.facts)
            return element("h5", safe(block.title)) + element("dl", "".join(facts))
        case TableBlock():
            return plain_table(block)
    raise not_a_block(block)


@dataclass(frozen=True)
class Blocks:
    """Writes a report as HTML.

    `names` relate rows to links, `figures` are pictures at the head of sections by the section's key, and `poses` are
    the poses of the rows of a section's first table.
    """

    names: Names = field(default_factory=Names)
    figures: Mapping[str, str] = field(default_factory=dict)
    poses: Mapping[str, Sequence[int]] = field(default_factory=dict)

    def section(self, section: Section) -> str:
        """Return a section with its heading, its pictures and its blocks.

        >>> print(Blocks().section(Section("notes", "Notes", (Paragraph("a < b"),))))
        <section id="notes" aria-labelledby="notes-title">
        <h2 id="notes-title">Notes</h2>
        <p>a &lt; b</p>
        </section>
        """
        heading = element("h2", safe(section.title or "Report"), id=f"{section.key}-title")
        body = lines([heading, self.figures.get(section.key, ""), *self._blocks(section)])
        depends = "" if section.key in OF_DIMENSIONS else None
        named = f"{section.key}-title"
        return element("section", f"\n{body}\n", id=section.key, aria_labelledby=named, data_depends=depends)

    def about(self, sections: Sequence[Section]) -> str:
        """Write the introduction in the head of the page."""
        return lines(part for section in sections if section.key == ABOUT for part in self._blocks(section))

    def _blocks(self, section: Section) -> Iterator[str]:
        tables = steps = 0
        for k, block in enumerate(section.blocks):
            match block:
                case TableBlock():
                    tables += 1
                    yield self._table(section, block, k, tables)
                case StepBlock():
                    yield self._step(section, block, steps)
                    steps += 1
                case FormulaBlock():
                    yield _formula(block)
                case Paragraph():
                    # badges at the head of the page repeat the rest
                    text = typeset(block.text.removesuffix(block.badged).rstrip())
                    inside = with_formulas(text, self.names.groups) if section.key == ABOUT else safe(text)
                    yield element("p", inside)
                case Alert():
                    remedy = f"\n<p><b>Remedy:</b> {safe(block.remedy)}.</p>" if block.remedy else ""
                    text = f"<strong>{screen_reader_text('Warning:')} {safe(typeset(block.text))}</strong>"
                    yield element("div", f"<p>{text}</p>{remedy}", class_="alert")
                case _:
                    raise not_a_block(block)

    def _table(self, section: Section, table: TableBlock, k: int, number: int) -> str:
        """Return the table; its caption is the clause before it that ends with a colon, else the section's title."""
        before = section.blocks[k - 1] if k else None
        caption = f"{section.title or 'Report'}{f', {number}' if number > 1 else ''}"
        if isinstance(before, Paragraph) and before.text.endswith(":"):
            caption = before.text.rpartition(". ")[2].removesuffix(":")
        poses = self.poses.get(section.key, ()) if number == 1 else ()
        return table_html(HtmlTable(table, f"{section.key}-table-{number}", caption, self.names, poses))

    def _step(self, section: Section, step: StepBlock, k: int) -> str:
        """Return a step; those in solving order belong to the links of their groups."""
        links = self.names.members[k] if section.key == GROUPS and k < len(self.names.members) else ()
        title = safe(step.title)
        if links:
            swatch = f'<i class="swatch g{self.names.colour(links)}"></i>'
            title = element("button", swatch + title, type="button", class_="who", aria_pressed="false")
        facts = lines(f"<div><dt>{safe(term)}</dt><dd>{safe(typeset(fact))}</dd></div>" for term, fact in step.facts)
        tag = f' data-links="{link_names(links)}"' if links else ""
        return f'<div class="step"{tag}>\n<h3>{title}</h3>\n<dl>\n{facts}\n</dl>\n</div>'


def _formula(block: FormulaBlock) -> str:
    """Return a formula as mathematics with its text for screen readers; without LaTeX as text."""
    written = element("code", safe(typeset(block.text)))
    if block.latex:
        with suppress(UnknownLatex):
            shown = element("span", mathml(block.latex), aria_hidden="true", class_="maths")
            return element("p", f"{shown}{screen_reader_text(block.text)}", class_="formula")
    return element("p", written, class_="formula")
