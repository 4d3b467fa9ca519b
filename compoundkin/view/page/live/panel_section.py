"""The section of a page where its dimensions are changed and taken along; scripts fill it."""

from __future__ import annotations

from compoundkin.view.page.markup import element, lines, safe

KEY, TITLE = "dimensions", "Dimensions"
HINT = (
    "Change a number, and the mechanism follows. Arrow keys step it, with Shift ten times as far; "
    "a field that is focused says in which range the mechanism assembles."
)
# What can be taken along: its key, the words of its button, what they say at length.
SHARED = (
    ("toml", "Copy as TOML", "Copy the mechanism with these dimensions as a mechanism file"),
    ("link", "Copy link", "Copy the address of this page with these dimensions"),
    ("csv", "CSV", "Save drivers, outputs and points at all poses"),
    ("svg", "SVG", "Save the sketch as it is shown"),
)


def panel_section() -> str:
    """Return the section of dimensions, without any yet.

    >>> panel_section().splitlines()[0]
    '<section id="dimensions" aria-labelledby="dimensions-title">'
    """
    buttons = [element("button", safe(words), type="button", data_share=key, title=told) for key, words, told in SHARED]
    body = [
        element("h2", TITLE, id=f"{KEY}-title"),
        element("p", HINT, class_="hint"),
        element("div", "", class_="dimensions"),
        element("div", lines(buttons), class_="share", role="group", aria_label="Take along"),
        element("p", "", class_="told"),
        '<textarea class="taken" readonly hidden aria-label="Text to copy"></textarea>',
    ]
    return element("section", f"\n{lines(body)}\n", id=KEY, aria_labelledby=f"{KEY}-title")
