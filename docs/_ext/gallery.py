"""The gallery: for each mechanism of the catalog a card, a page to read and one to play with, written with the site."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from html import escape, unescape
from math import tau
from pathlib import Path
from typing import Any

import numpy as np
from sphinx.application import Sphinx

import compoundkin as ck
from compoundkin.files import load, shipped_mechanisms
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.symbols import Outline, Strap, Track, Wheel
from compoundkin.structure import roman
from compoundkin.synthesis.chains import structure_name
from compoundkin.view.animation import animate
from compoundkin.view.page.mathml import with_formulas
from compoundkin.view.sketch.picture_options import scene_in, solved_over

FOLDER = "gallery"
# The page whose table is shown as cards.
CATALOG = "catalog"
# So many turns of a driver, in so many poses each, are tried for a path to close.
TURNS, POSES = 12, 121
# Ends of a path nearer to each other than this part of the mechanism's size are one.
NEAR = 1e-6
# The longer side of the small pictures, in pixels: pivots are seen on them.
SMALL = 300

INDEX = """\
# Gallery

All mechanisms of the [catalog](../catalog.md), drawn by the program; the pictures move under the pointer. Each has a
page with its picture at full size, where it comes from, what it is made of, its file, and the command to try it; and a
live page, where its points can be dragged and its dimensions changed.
{parts}
"""

PART = """
## {title}

:::{{container}} gallery
{cells}
:::
"""

# No entry in the table of contents, which would be far longer than all others together on every page.
PAGE = """\
---
orphan: true
---

# {title}

{live}![{alt}]({name}.svg)

{description}

* **Structure:** {structure}
* **Source:** {source}
* **File:** [{name}.toml](../../catalog/{name}.toml)

[All mechanisms](index.md)

## Try it

```sh
compoundkin report {name}{forces}
```

```python
import compoundkin as ck

motion = ck.solve(ck.load("{name}"))
```

## The file

```{{literalinclude}} ../../catalog/{name}.toml
:language: toml
```
"""

LIVE = '<a href="{name}-live.html">Live page: drag its points, change its dimensions</a>\n\n'

APART = """
## Taken apart

![{title}, taken apart into frame, drivers and Assur groups]({name}-apart.svg)
"""

# Kinds, in the order of the gallery.
CAMS, GEARS, CYLINDERS, HIGHER, SPECIAL, SEVERAL = (
    "Cams",
    "Gears, racks, belts and rolling wheels",
    "Cylinders",
    "Groups of class III and higher",
    "Mobile by special dimensions",
    "Several drivers",
)
FOUR, SLIDES, PINS, MORE = (
    "Four-bars",
    "Up to four links, with slides and slots",
    "Six links and more, with pins alone",
    "Six links and more, with slides",
)
KINDS = (FOUR, SLIDES, PINS, MORE, HIGHER, GEARS, CAMS, CYLINDERS, SPECIAL, SEVERAL)


def kind_of(mechanism: ck.Mechanism, structure: ck.results.Structure) -> str:
    """Where a mechanism stands in the gallery: by what is particular about it."""
    marks = marks_of(mechanism)
    if Outline in marks:
        return CAMS
    if marks & {Wheel, Track, Strap}:
        return GEARS
    driven = structure.driven.items() if not mechanism.auxiliary_links else ()
    lines = (step.pair.members for name, step in driven if not structure.driven_angles[name])
    if mechanism.cylinders or any(FRAME not in members for members in lines):
        return CYLINDERS
    if any(group.class_ > 2 for group in structure.groups):
        return HIGHER
    if structure.relaxation:
        return SPECIAL
    if len(mechanism.drives) > 1:
        return SEVERAL
    pins = len(mechanism.written_pairs) == 0
    if len(mechanism.links) <= 4:
        return FOUR if pins else SLIDES
    return PINS if pins else MORE


def marks_of(mechanism: ck.Mechanism) -> set[type]:
    """The kinds of marks that a mechanism's pairs are drawn with."""
    shown = solved_over(mechanism)
    if shown is None:
        return set()
    return {type(seen.mark) for seen in scene_in(shown, None, None, 0).pair_marks}


def chosen(names: str) -> dict[str, ck.Mechanism]:
    """The mechanisms of the gallery by name: those that are named, or all."""
    wanted = names.split(",") if names else shipped_mechanisms.shipped()
    return {name: load(name) for name in wanted}


def files(mechanisms: Mapping[str, ck.Mechanism]) -> dict[str, str]:
    """All files of the gallery by name."""
    found: dict[str, str] = {}
    parts: dict[str, list[str]] = {kind: [] for kind in KINDS}
    for name, mechanism in mechanisms.items():
        structure = ck.decompose(mechanism)
        found |= files_of(name, mechanism, structure)
        parts[kind_of(mechanism, structure)].append(cell(name, mechanism.title))
    return {**found, "index.md": INDEX.format(parts="".join(parts_of(parts)))}


def parts_of(parts: Mapping[str, Iterable[str]]) -> Iterator[str]:
    """The kinds that have mechanisms, with their small pictures."""
    for title, cells in parts.items():
        if cells:
            yield PART.format(title=title, cells="\n".join(cells))


def described(mechanism: ck.Mechanism) -> str:
    """The description of a mechanism, its formulas as mathematics."""
    parts = re.split(r"(<math>.*?</math>)", with_formulas(mechanism.description, mechanism.links))
    return "".join(one if one.startswith("<math>") else plain(unescape(one)) for one in parts)


def files_of(name: str, mechanism: ck.Mechanism, structure: ck.results.Structure) -> dict[str, str]:
    """A mechanism's page and its pictures; one that cannot be solved is shown as drawn."""
    shown = whole_motion(mechanism) or mechanism
    picture, apart = drawn(shown, True), taken_apart(shown)
    page = PAGE.format(
        name=name,
        title=plain(mechanism.title),
        alt=plain(picture.description),
        description=described(mechanism),
        structure=plain(structure_of(structure)),
        source=plain(mechanism.source),
        live=LIVE.format(name=name) if isinstance(shown, ck.results.Motion) else "",
        forces=f"\ncompoundkin forces {name}" if mechanism.units else "",
    )
    small = drawn(shown, False, SMALL)
    found = {f"{name}.md": page, f"{name}.svg": picture.svg, f"{name}-small.svg": small.svg}
    if apart is not None:
        found[f"{name}.md"] += APART.format(name=name, title=plain(mechanism.title))
        found[f"{name}-apart.svg"] = apart.svg
    return found


def whole_motion(mechanism: ck.Mechanism) -> ck.results.Motion | None:
    """The motion over the drivers' own ranges; over so many turns that paths close, where one turn is not enough."""
    shown = solved_over(mechanism)
    if shown is None or len(mechanism.drives) != 1 or not turns(shown) or closes(shown):
        return shown
    first = float(np.ravel(next(iter(shown.drives.values())).value)[0])
    for count in range(2, TURNS + 1):
        longer = ck.solve(mechanism, np.linspace(first, first + tau * count, count * (POSES - 1) + 1))
        if longer.assembled.all() and closes(longer):
            return longer
    return shown


def closes(motion: ck.results.Motion) -> bool:
    """Tell whether all paths close. Points of links on a pivot of the frame go round it, however far they turn."""
    scene, mechanism = scene_in(motion, None, None, 0), motion.mechanism
    pivots = set(mechanism.links[FRAME].points)
    turned = {name for name, link in mechanism.links.items() if pivots & set(link.points)}
    ends = [scene.places(k)[[0, -1]] for k in scene.letters if turned.isdisjoint(mechanism.carriers[k])]
    return all(abs(last - first) < NEAR * motion.size for first, last in ends)


def turns(motion: ck.results.Motion) -> bool:
    """Tell whether the only driver makes whole turns, and all of them are assembled."""
    name, drive = next(iter(motion.drives.items()))
    way = np.ptp(np.ravel(drive.value)) / tau
    is_whole = bool(way > 0.5 and np.isclose(way, round(way)))
    return motion.structure.driven_angles[name] and bool(motion.assembled.all()) and is_whole


def drawn(shown: ck.results.Motion | ck.Mechanism, labels: bool, size: float | None = None) -> ck.results.Picture:
    """The sketch with its paths; of a mechanism with masses and loads with its forces."""
    if isinstance(shown, ck.results.Motion) and shown.mechanism.units and size is None:
        return ck.draw(shown.forces, labels=labels)
    return ck.draw(shown, paths=True, labels=labels, size=size)


def taken_apart(shown: ck.results.Motion | ck.Mechanism) -> ck.results.Picture | None:
    """The picture of its groups; none for what is not determined."""
    try:
        return ck.draw(shown, kind="groups")
    except ck.errors.NotDetermined:
        return None


def cell(name: str, title: str) -> str:
    """A small picture with its name, linked to its page."""
    return f"* [![{plain(title)}]({name}-small.svg) {plain(title)}]({name}.md)"


def structure_of(structure: ck.results.Structure) -> str:
    """What a mechanism is made of, in one line: links, mobility, groups in solving order, the name of its chain."""
    groups = [f"{group.name} (class {roman(group.class_)})" for group in structure.groups]
    name = structure_name(structure).title
    many = "Assur group" if len(groups) == 1 else "Assur groups"
    return f"{len(structure.mechanism.links)} links; {mobility_of(structure)}; {many} {', '.join(groups)}; {name}"


def mobility_of(structure: ck.results.Structure) -> str:
    """The count, and where that is not true the mobility of the mechanism's own dimensions."""
    count = structure.mobility.freedoms
    if not structure.relaxation:
        return f"mobility {count}"
    return f"counted mobility {count}, true mobility {ck.mobility_analysis(structure.mechanism).finite}"


def plain(text: str) -> str:
    """Text that means nothing else to Markdown."""
    return re.sub(r"([\\`*_\[\]{}|#$~])", r"\\\1", escape(text, quote=False))


def write(app: Sphinx) -> None:
    """Write what differs from what is there, and remove what belongs to mechanisms that are no more."""
    folder, wanted = Path(app.srcdir) / FOLDER, files(chosen(app.config.gallery_mechanisms))
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():
        if old.name not in wanted:
            old.unlink()
    for name, text in wanted.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def write_live_pages(app: Sphinx, exception: Exception | None) -> None:
    """Write the live page of each mechanism, and its small picture that moves, beside the page that links to it."""
    for name, mechanism in chosen(app.config.gallery_mechanisms).items() if exception is None else ():
        shown = solved_over(mechanism)
        if shown is not None:
            folder = Path(app.outdir) / FOLDER
            ck.page(shown).save(folder / f"{name}-live.html")
            animate(shown, labels=False, size=SMALL).save(folder / f"{name}-moving.svg")


def lead_here(app: Sphinx, docname: str, source: list[str]) -> None:
    """Lead links to the gallery there, and show the table of the catalog as cards.

    Where no site is built the links lead to one large picture, and the table is read as it is.
    """
    source[0] = source[0].replace("](gallery.svg)", f"]({FOLDER}/index.md)")
    if docname == CATALOG:
        source[0] = as_cards(source[0], chosen(app.config.gallery_mechanisms))


def as_cards(text: str, mechanisms: Mapping[str, ck.Mechanism]) -> str:
    """The catalog with a card for each row of its table, by kinds; the cards lead to the pages of the gallery."""
    rows = {found[1]: [part.strip() for part in line.strip("| \n").split(" | ")]
            for line in text.splitlines() if (found := re.match(r"\| \[`([^`]+)`\]", line))}  # fmt: skip
    parts: dict[str, list[str]] = {kind: [] for kind in KINDS}
    for name, mechanism in mechanisms.items():
        if name in rows:
            parts[kind_of(mechanism, ck.decompose(mechanism))].append(catalog_card(name, rows[name]))
    before, _, rest = text.partition("\n| name |")
    after = rest.partition("\n\n")[2]
    return f"{before}\n{''.join(parts_of(parts))}\n{after}"


def catalog_card(name: str, row: list[str]) -> str:
    """A row of the catalog as a card: picture and title, its name, groups and numbers, what to look at."""
    title, look = row[1], row[-1]
    groups, numbers = row[2], row[3] if len(row) > 4 else ""
    facts = [f"`{name}`", groups, f"{numbers} numbers" if numbers.isdigit() else ""]
    link = f"[![{title}]({FOLDER}/{name}-small.svg) {title}]({FOLDER}/{name}.md)"
    return "\n\n".join([f"* {link}", f"  {' · '.join(filter(None, facts))}", f"  {look}"])


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages before any is read, and the live ones when all others are there."""
    app.add_config_value("gallery_mechanisms", "", "env", str)
    app.connect("builder-inited", write)
    app.connect("build-finished", write_live_pages)
    app.connect("source-read", lead_here)
    app.add_js_file("gallery.js", loading_method="defer")
    return {"parallel_read_safe": True}
