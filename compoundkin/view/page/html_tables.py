"""A table of a report as HTML, sorted and copied by full precision; which links a name in it is about."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from compoundkin.model.attributes import readable
from compoundkin.structure import Structure, roman
from compoundkin.view.page.html_cells import cell_html, of_kind, packed_cells
from compoundkin.view.page.markup import broken, element, hidden, lines, safe
from compoundkin.view.report.report_data import Cell, Column, TableBlock
from compoundkin.view.report.wording import listed, written
from compoundkin.view.sketch.scene import groups_of
from compoundkin.view.sketch.sketch_style import COLOURS
from compoundkin.view.sketch.svg import link_names

Links = tuple[str, ...]


@dataclass(frozen=True)
class Names:
    """The names in a mechanism. Links with the number of their group, members of pairs, links of points, groups.

    Without a structure there is nothing to tell, and every name is about no link.
    """

    groups: Mapping[str, int] = field(default_factory=dict)
    pairs: Mapping[str, Links] = field(default_factory=dict)
    points: Mapping[str, Links] = field(default_factory=dict)
    titles: tuple[str, ...] = ()

    @cached_property
    def members(self) -> tuple[Links, ...]:
        """The links of every group by its number, the frame and driven links first."""
        return tuple(tuple(link for link, own in self.groups.items() if own == k) for k in range(len(self.titles)))

    def about(self, text: str) -> Links:
        """Return the links that the words of a cell are about. None where it is about something else.

        >>> names = Names({"bar": 1, "frame": 0}, {"slot": ("bar", "frame")}, {"G": ("bar",)})
        >>> names.about("|G.velocity|"), names.about("slot"), names.about("none")
        (('bar',), ('bar', 'frame'), ())
        """
        for name in _readings(text):
            for known in (self.pairs, self.points):
                if name in known:
                    return known[name]
            if name in self.groups:
                return (name,)
        return self._joined(text)

    def _joined(self, text: str) -> Links:
        """Links in a row: "(crank frame)", "crank - rod", "frame -E- crank -D- frame"; all must be known."""
        for split in (re.split(r" -.*?- | - |, | and ", text), text.strip("()").split()):
            if len(split) > 1 and all(name in self.groups for name in split):
                return tuple(dict.fromkeys(split))
        return ()

    def colour(self, links: Links) -> int | None:
        """Return the colour number that some links have in common, if any."""
        numbers = {self.groups[link] for link in links if link in self.groups}
        if len(numbers) != 1:
            return None
        (number,) = numbers
        return number if number == 0 else (number - 1) % (len(COLOURS) - 1) + 1


def names_of(structure: Structure | None) -> Names:
    """Return the names in a structure."""
    if structure is None:
        return Names()
    mechanism = structure.mechanism
    written = [*((pair.name, pair.members) for pair in structure.pairs), *mechanism.pins.items()]
    pairs = {**{pair.name: tuple(pair.members) for pair in mechanism.written_pairs},
             **{name: tuple(members) for name, members in written}}  # fmt: skip
    points = {letter: tuple(links) for letter, links in mechanism.carriers.items()}
    titles = ("frame and driven links", *(_title(group.name, group.class_, group.links) for group in structure.groups))
    return Names(groups_of(structure), pairs, points, titles)


def _title(name: str, class_: int, links: Links) -> str:
    return f"{name}, class {roman(class_)}: {listed(links)}"


def _readings(text: str) -> Iterator[str]:
    """A name as it is; without the bars of a length; without what follows its last dots."""
    name = text.strip("|")
    yield name
    while "." in name:
        name = name.rpartition(".")[0]
        yield name


@dataclass(frozen=True)
class ShownTable:
    """A table with its name on the page and what it is called. It has the poses of its rows, if they are poses."""

    table: TableBlock
    key: str
    caption: str
    names: Names
    poses: Sequence[int] = ()


def table_html(shown: ShownTable) -> str:
    """Return the table in a box of its own that scrolls, with its buttons."""
    parts = [element("caption", safe(shown.caption), class_="unseen"), _head(shown), _body(shown)]
    grid = element("table", lines(parts), class_="sortable asc n-last", id=shown.key)
    box = element("div", grid, class_="scroll", role="region", aria_label=f"Table: {shown.caption}", tabindex="0")
    return element("div", f"{_tools(shown)}\n{box}", class_="grid")


def _tools(shown: ShownTable) -> str:
    """The buttons of a table; those that only scripts serve are shown by scripts."""
    more = f"Show all {len(shown.table.rows):,} rows"
    told = {"aria_expanded": "false", "data_more": more, "data_fewer": "Show fewer rows"}
    folded = [] if shown.table.shown is None else [_button("more", more, shown, **told)]
    return element("div", lines([*folded, _button("copy", "Copy", shown)]), class_="tools")


def _button(kind: str, text: str, shown: ShownTable, **more: str) -> str:
    inside = f"{safe(text)} {hidden(f'table {shown.caption}')}" if kind == "copy" else safe(text)
    return element("button", inside, type="button", class_=kind, aria_controls=shown.key, **more)


def _head(shown: ShownTable) -> str:
    return element("thead", element("tr", lines(_heading(column, shown) for column in shown.table.columns)))


def _heading(column: Column, shown: ShownTable) -> str:
    name = broken(column.name) if column.name else hidden("result")
    unit = f' <span class="unit">[{safe(readable(column.unit))}]</span>' if column.unit else ""
    button = element("button", f"{name}{unit}", type="button", class_="sort")
    kind = "number" if column.is_number else None
    quantity = f' data-quantity="{safe(column.name)}"' if shown.poses else ""
    return f'<th scope="col"{of_kind(kind)}{_links(shown.names.about(column.name))}{quantity}>{button}</th>'


def _body(shown: ShownTable) -> str:
    table = shown.table
    texts = [written(column, [row[k] for row in table.rows], "\n") for k, column in enumerate(table.columns)]
    needed = None if table.shown is None else set(table.shown)
    rows = (_row(shown, k, [column[k] for column in texts], needed) for k in range(len(table.rows)))
    return element("tbody", lines(rows))


def _row(shown: ShownTable, k: int, texts: Sequence[str], needed: set[int] | None) -> str:
    table, row = shown.table, shown.table.rows[k]
    links = _of_row(shown, row)
    kind = "more" if needed is not None and k not in needed else None
    pose = f' data-pose="{shown.poses[k]}"' if shown.poses else ""
    figure = f' data-figure="{safe(json.dumps(table.figures[k]))}"' if k < len(table.figures) else ""
    packed = packed_cells(table.columns, row, texts) if pose and not figure and not links else None
    if packed is not None:
        return f"<tr{of_kind(kind)}{pose}{packed[0]}>{packed[1]}</tr>"
    cells = [cell_html(column, cell, text) for column, cell, text in zip(table.columns, row, texts, strict=True)]
    cells[0] = _first(shown, row[0], texts[0], links) or cells[0]
    return f"<tr{of_kind(kind)}{_links(links)}{pose}{figure}>{''.join(cells)}</tr>"


def _of_row(shown: ShownTable, row: Sequence[Cell]) -> tuple[str, ...]:
    """The links that a row is about: what its first words name."""
    for cell in row:
        if isinstance(cell, str) and (links := shown.names.about(cell)):
            return links
        if isinstance(cell, str) and cell:
            break
    return ()


def _first(shown: ShownTable, cell: Cell, text: str, links: tuple[str, ...]) -> str:
    """The head of a row: the cell of its name, a button where it names links."""
    if not isinstance(cell, str) or not cell:
        return ""
    inside = broken(text)
    if links:
        number = shown.names.colour(links)
        swatch = f'<i class="swatch g{number}"></i>' if number is not None else ""
        inside = element("button", f"{swatch}<span>{inside}</span>", type="button", class_="who", aria_pressed="false")
    return f'<th scope="row">{inside}</th>'


def _links(names: tuple[str, ...]) -> str:
    return f' data-links="{link_names(names)}"' if names else ""
