"""Tables of a report as HTML: sorted and copied with all digits, rows linked to the links that they are about."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite

import numpy as np

from compoundkin.model.attributes import typeset_unit
from compoundkin.structure import Structure, roman
from compoundkin.view.page.markup import breakable, element, lines, safe, screen_reader_text
from compoundkin.view.report.report_data import Cell, Column, TableBlock
from compoundkin.view.report.wording import UNIT_HEADS, column_texts, listed, typeset
from compoundkin.view.sketch.scene import link_groups
from compoundkin.view.sketch.sketch_style import COLOURS
from compoundkin.view.sketch.svg import link_names

Links = tuple[str, ...]
RESULTS = {True: ("good", "✓", "pass"), False: ("bad", "✗", "FAIL")}
# Cells with more letters than this are broken into lines, and get room for them.
LONG = 24


@dataclass(frozen=True)
class Names:
    """The names in a mechanism: links with the number of their group, members of pairs, links of points, groups.

    Without a structure no name refers to a link.
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
        """Return the links that the words of a cell name, none for other words.

        >>> names = Names({"bar": 1, "frame": 0}, {"slot": ("bar", "frame")}, {"G": ("bar",)})
        >>> names.about("|G.velocity|"), names.about("slot"), names.about("none")
        (('bar',), ('bar', 'frame'), ())
        """
        for name in _name_readings(text):
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
    return Names(link_groups(structure), pairs, points, titles)


def _title(name: str, class_: int, links: Links) -> str:
    return f"{name}, class {roman(class_)}: {listed(links)}"


def _name_readings(text: str) -> Iterator[str]:
    """A name as it is; without the bars of a length; without what follows its last dots."""
    name = text.strip("|")
    yield name
    while "." in name:
        name = name.rpartition(".")[0]
        yield name


@dataclass(frozen=True)
class HtmlTable:
    """A table with its id, caption, names, and the poses of its rows, if they are poses."""

    table: TableBlock
    key: str
    caption: str
    names: Names
    poses: Sequence[int] = ()


def table_html(shown: HtmlTable) -> str:
    """Return the table in a box of its own that scrolls, with its buttons."""
    parts = [element("caption", safe(shown.caption), class_="unseen"), _head(shown), _body(shown)]
    grid = element("table", lines(parts), class_="sortable asc n-last", id=shown.key)
    box = element("div", grid, class_="scroll", role="region", aria_label=f"Table: {shown.caption}", tabindex="0")
    return element("div", f"{_tools(shown)}\n{box}", class_="grid")


def _tools(shown: HtmlTable) -> str:
    """Return the buttons of a table, which scripts reveal."""
    more = f"Show all {len(shown.table.rows):,} rows"
    labels = {"aria_expanded": "false", "data_more": more, "data_fewer": "Show fewer rows"}
    unfold = [] if shown.table.shown is None else [_button("more", more, shown, **labels)]
    return element("div", lines([*unfold, _button("copy", "Copy", shown)]), class_="tools")


def _button(kind: str, text: str, shown: HtmlTable, **more: str) -> str:
    inside = f"{safe(text)} {screen_reader_text(f'table {shown.caption}')}" if kind == "copy" else safe(text)
    return element("button", inside, type="button", class_=kind, aria_controls=shown.key, **more)


def _head(shown: HtmlTable) -> str:
    return element("thead", element("tr", lines(_heading(column, shown) for column in shown.table.columns)))


def _heading(column: Column, shown: HtmlTable) -> str:
    name = breakable(column.name) if column.name else screen_reader_text("result")
    unit = f' <span class="unit">[{safe(typeset_unit(column.unit))}]</span>' if column.unit else ""
    button = element("button", f"{name}{unit}", type="button", class_="sort")
    kind = "number" if column.is_number else None
    quantity = f' data-quantity="{safe(column.name)}"' if shown.poses else ""
    links = _links_attribute(shown.names.about(column.name))
    return f'<th scope="col"{class_attribute(kind)}{links}{quantity}>{button}</th>'


def _body(shown: HtmlTable) -> str:
    table = shown.table
    plain = (column_texts(column, [row[k] for row in table.rows], "\n") for k, column in enumerate(table.columns))
    texts = [[*map(typeset, column)] for column in plain]
    needed = None if table.shown is None else set(table.shown)
    rows = (_row(shown, k, [column[k] for column in texts], needed) for k in range(len(table.rows)))
    return element("tbody", lines(rows))


def _row(shown: HtmlTable, k: int, texts: Sequence[str], needed: set[int] | None) -> str:
    table, row = shown.table, shown.table.rows[k]
    links = _links_of_row(shown, row)
    kind = "more" if needed is not None and k not in needed else None
    pose = f' data-pose="{shown.poses[k]}"' if shown.poses else ""
    figure = f' data-figure="{safe(json.dumps(table.figures[k]))}"' if k < len(table.figures) else ""
    packed = packed_cells(table.columns, row, texts) if pose and not figure and not links else None
    if packed is not None:
        return f"<tr{class_attribute(kind)}{pose}{packed[0]}>{packed[1]}</tr>"
    cells = [cell_html(column, cell, text) for column, cell, text in zip(table.columns, row, texts, strict=True)]
    cells[0] = _row_head(shown, row[0], texts[0], links) or cells[0]
    return f"<tr{class_attribute(kind)}{_links_attribute(links)}{pose}{figure}>{''.join(cells)}</tr>"


def _links_of_row(shown: HtmlTable, row: Sequence[Cell]) -> tuple[str, ...]:
    """Return the links that the first words of a row name."""
    for cell in row:
        if isinstance(cell, str) and (links := shown.names.about(cell)):
            return links
        if isinstance(cell, str) and cell:
            break
    return ()


def _row_head(shown: HtmlTable, cell: Cell, text: str, links: tuple[str, ...]) -> str:
    """Return the head of a row, a button where it names links."""
    if not isinstance(cell, str) or not cell:
        return ""
    inside = breakable(text)
    if links:
        number = shown.names.colour(links)
        swatch = f'<i class="swatch g{number}"></i>' if number is not None else ""
        inside = element("button", f"{swatch}<span>{inside}</span>", type="button", class_="who", aria_pressed="false")
    return f'<th scope="row">{inside}</th>'


def _links_attribute(names: tuple[str, ...]) -> str:
    return f' data-links="{link_names(names)}"' if names else ""


def cell_html(column: Column, cell: Cell, text: str) -> str:
    """Return a cell of a table with its text."""
    if isinstance(cell, bool):
        result, mark, word = RESULTS[cell]
        inside = f'<span class="{result}"><span aria-hidden="true">{mark}</span> {word}</span>'
        return f'<td data-sort="{int(cell)}" data-copy="{word}">{inside}</td>'
    kind = "number" if column.is_number else "long" if len(text) > LONG else None
    inside = "<br>".join(map(safe, (typeset_unit(text) if column.name in UNIT_HEADS else text).split("\n")))
    return f"<td{class_attribute(kind)}{''.join(_exact_attributes(column, cell, text))}>{inside}</td>"


def _exact_attributes(column: Column, cell: Cell, text: str) -> Iterator[str]:
    """Yield every digit of a number for sorting and copying, where the text is rounded."""
    if not column.is_number and not isinstance(cell, tuple):
        return
    digits = [_digits(column, value) for value in (cell if isinstance(cell, tuple) else (cell,))]
    if digits[0] != text:
        yield f' data-sort="{digits[0]}"'
    if len(digits) > 1:
        yield f' data-copy="{", ".join(digits)}"'


def packed_cells(columns: Sequence[Column], row: Sequence[Cell], texts: Sequence[str]) -> tuple[str, str] | None:
    """Return the attribute of a row of numbers with all digits, and its cells; None for a row of anything else.

    A script writes each cell as `cell_html` does.
    """
    numbers = [_cell_number(column, cell) for column, cell in zip(columns, row, strict=True)]
    known = [number for number in numbers if number is not None]
    if len(known) < len(numbers):
        return None
    packed = b64encode(np.array(known, "<f8").tobytes()).decode("ascii")
    return f' data-n="{packed}"', "".join(f"<td>{safe(text)}</td>" for text in texts)


def _cell_number(column: Column, cell: Cell) -> float | None:
    """Return a cell as a number, NaN where it is unknown; None for anything else."""
    if not column.is_number or isinstance(cell, bool | str | tuple):
        return None
    if cell is None or not isfinite(cell):
        return float("nan")
    return float(cell) if abs(cell) > column.floor else 0.0


def _digits(column: Column, value: Cell) -> str:
    if isinstance(value, str):
        return safe(value)
    if value is None or isinstance(value, tuple) or not isfinite(value):
        return ""
    return repr(value) if abs(value) > column.floor else "0"


def class_attribute(kind: str | None) -> str:
    """Return the class of an element as it is written, if it has one."""
    return f' class="{kind}"' if kind else ""
