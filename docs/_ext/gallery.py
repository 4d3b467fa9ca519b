"""The gallery: a page for each mechanism of the catalog, written when the site is built."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

import compoundkin as ck
from compoundkin.files import shipped_mechanisms
from compoundkin.structure import roman
from compoundkin.synthesis.chains import structure_name
from compoundkin.view.sketch.shown_pose import solved_over

FOLDER = "gallery"

INDEX = """\
# Gallery

All mechanisms of the [catalog](../catalog.md), drawn by the program. Each has a page with its picture at full size,
where it comes from, what it is made of, and the command to try it.

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

![{alt}]({name}.svg)

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

motion = ck.solve(ck.catalog.load_named("{name}"))
```
"""

APART = """
## Taken apart

![{title}, taken apart into frame, drivers and Assur groups]({name}-apart.svg)
"""


def files() -> dict[str, str]:
    """All files of the gallery by name."""
    mechanisms = {name: shipped_mechanisms.load_named(name) for name in shipped_mechanisms.names()}
    found: dict[str, str] = {}
    for name, mechanism in mechanisms.items():
        found |= files_of(name, mechanism)
    cells = "\n".join(cell(name, mechanism.title) for name, mechanism in mechanisms.items())
    return {**found, "index.md": INDEX.format(cells=cells)}


def files_of(name: str, mechanism: ck.Mechanism) -> dict[str, str]:
    """A mechanism's page and its pictures; one that cannot be solved is shown as drawn."""
    shown = solved_over(mechanism) or mechanism
    picture, apart = drawn(shown, True), taken_apart(shown)
    page = PAGE.format(
        name=name,
        title=plain(mechanism.title),
        alt=plain(picture.description),
        description=plain(mechanism.description),
        structure=plain(structure_of(mechanism)),
        source=plain(mechanism.source),
        forces=f"\ncompoundkin forces {name}" if mechanism.units else "",
    )
    small = drawn(shown, False)
    found = {f"{name}.md": page, f"{name}.svg": picture.svg, f"{name}-small.svg": small.svg}
    if apart is not None:
        found[f"{name}.md"] += APART.format(name=name, title=plain(mechanism.title))
        found[f"{name}-apart.svg"] = apart.svg
    return found


def drawn(shown: ck.results.Motion | ck.Mechanism, labels: bool) -> ck.results.Picture:
    """The sketch with its paths; of a mechanism with masses and loads with its forces."""
    if isinstance(shown, ck.results.Motion) and shown.mechanism.units:
        return ck.draw(shown.forces, labels=labels)
    return ck.draw(shown, paths=True, labels=labels)


def taken_apart(shown: ck.results.Motion | ck.Mechanism) -> ck.results.Picture | None:
    """The picture of its groups; none for what is not determined."""
    try:
        return ck.draw(shown, kind="groups")
    except ck.errors.NotDetermined:
        return None


def cell(name: str, title: str) -> str:
    """A small picture with its name, linked to its page."""
    return f"* [![{plain(title)}]({name}-small.svg) {plain(title)}]({name}.md)"


def structure_of(mechanism: ck.Mechanism) -> str:
    """What a mechanism is made of, in one line: links, mobility, groups in solving order, the name of its chain."""
    structure = ck.decompose(mechanism)
    groups = [f"{group.name} (class {roman(group.class_)})" for group in structure.groups]
    name = structure_name(structure).title
    many = "Assur group" if len(groups) == 1 else "Assur groups"
    return f"{len(mechanism.links)} links; {mobility_of(structure)}; {many} {', '.join(groups)}; {name}"


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
    folder, wanted = Path(app.srcdir) / FOLDER, files()
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():
        if old.name not in wanted:
            old.unlink()
    for name, text in wanted.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def lead_here(app: Sphinx, docname: str, source: list[str]) -> None:
    """Where no site is built, links to the gallery lead to one large picture."""
    source[0] = source[0].replace("](gallery.svg)", f"]({FOLDER}/index.md)")


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages before any is read."""
    app.connect("builder-inited", write)
    app.connect("source-read", lead_here)
    return {"parallel_read_safe": True}
