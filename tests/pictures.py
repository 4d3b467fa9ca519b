"""The gallery: every mechanism of the catalog, drawn side by side. Run `python -m tests.pictures` to write it."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

from compoundkin.files import load
from compoundkin.files.shipped_mechanisms import shipped
from compoundkin.view.sketch import Picture, draw
from compoundkin.view.sketch.svg import FONT, css

GALLERY = Path(__file__).parents[1] / "docs" / "gallery.svg"
ACROSS, CELL, CAPTION = 6, 240, 18


def gallery() -> str:
    """The source of the gallery: one picture inside another, with one style sheet for all."""
    pictures = {name: draw(load(name), labels=False, paths=True) for name in shipped()}
    shapes = [shape for picture in pictures.values() for shape in picture.shapes]
    rows = -(-len(pictures) // ACROSS)
    width, height = ACROSS * CELL, rows * (CELL + CAPTION)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" style="{FONT}">'
    return "\n".join([head, f"<style>\n{css(shapes)}\n</style>", *_cells(pictures), "</svg>", ""])


def _cells(pictures: dict[str, Picture]) -> Iterator[str]:
    for k, (name, picture) in enumerate(pictures.items()):
        x, y = k % ACROSS * CELL, k // ACROSS * (CELL + CAPTION)
        box = f'x="{x}" y="{y}" width="{CELL}" height="{CELL}"'
        source = picture.svg
        body = source[source.index("</style>") + len("</style>\n") : source.rindex("</svg>")]
        yield f'<svg id="{escape(name)}" {box} viewBox="0 0 {picture.width:g} {picture.height:g}">'
        yield f"<title>{escape(picture.title)}</title>\n{body}</svg>"
        place = f'x="{x + CELL / 2:g}" y="{y + CELL + 11}" text-anchor="middle"'
        yield f'<text class="ck-note" {place}>{escape(name)}</text>'


if __name__ == "__main__":
    GALLERY.write_text(gallery(), encoding="utf-8")
