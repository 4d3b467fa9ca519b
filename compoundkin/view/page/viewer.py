"""The viewer: a moving sketch with slider, switches and plots, on a page with a panel of dimensions or alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.analysis.characteristics.outputs import chosen_outputs
from compoundkin.base.errors import InvalidInput, NotAssembled
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import ACCELERATION, OF_LINKS, OF_POINTS, VELOCITY, motion_figure
from compoundkin.model.geometry import FRAME
from compoundkin.view.page.html_document import POLICY, asset, page_palette
from compoundkin.view.page.live.compact_data import compact
from compoundkin.view.page.live.live_assets import is_live, scripts_of, styles_of, without_panel
from compoundkin.view.page.markup import data_script, element, lines, safe, screen_reader_text
from compoundkin.view.page.motion_data import MotionData, plot_data
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.sketch.kinematic_sketch import MovingPart, MovingSketch
from compoundkin.view.sketch.shapes import coordinate_text
from compoundkin.view.sketch.sketch_style import page_css
from compoundkin.view.sketch.svg import FONT, elements, link_names

# So many names below the sketch are stops of the keyboard.
MOST_STOPS = 12
# How much faster or slower than that the motion may be played.
SPEEDS = ("0.1", "0.25", "0.5", "1", "2")
# Plots of a page go to accelerations.
MOST_ORDER = 2
# Switches of the sketch: key, label, explanation.
SWITCHES = (
    (VELOCITY, "velocities", "velocity vectors of all points"),
    (ACCELERATION, "accelerations", "acceleration vectors of all points"),
    ("forces", "forces", "forces in pairs, loads, weights and inertia"),
    ("centres", "instant centres", "instant centres with the lines that give them"),
    ("names", "names", "letters of points and numbers of links"),
)
# A notebook keeps every output that it shows: a few dozen kilobytes each are enough.
MOST_POSES = 181
# Width and greatest height of the sketch in a notebook, heights of its controls and of those of changes, in pixels.
WIDTH, HIGHEST, CONTROLS, CHANGES = 640.0, 448.0, 190.0, 72.0
PLAYER_STYLE = "html,body{margin:0;background:var(--paper);font-size:15px}.player{padding:8px}.sketch{max-height:448px}"
PANEL_KEY, PANEL_TITLE = "dimensions", "Dimensions"
PANEL_HINT = (
    "Change a number, and the mechanism follows. Arrow keys step it, with Shift ten times as far; "
    "a field that is focused says in which range the mechanism assembles."
)
# Exports: key, label of the button, explanation.
SHARE_BUTTONS = (
    ("toml", "Copy as TOML", "Copy the mechanism with these dimensions as a mechanism file"),
    ("link", "Copy link", "Copy the address of this page with these dimensions"),
    ("csv", "CSV", "Save drivers, outputs and points at all poses"),
    ("svg", "SVG", "Save the sketch as it is shown"),
)


@dataclass(frozen=True)
class Viewer:
    """The parts of a page that show a motion: `html` of the moving sketch, `plots` the place of the plots, `data`."""

    html: str
    plots: str
    data: dict[str, Any]

    @property
    def section(self) -> str:
        """The plots as a section of the page."""
        heading = element("h2", "Motion", id="motion-title")
        return element("section", lines([heading, self.plots]), id="motion", aria_labelledby="motion-title")


def viewer_of(motion: Motion, design: int = 0, outputs: Sequence[str] = ()) -> Viewer | None:
    """Return `viewer` with the outputs of a report where none are named; None where nothing can move."""
    try:
        chosen = chosen_outputs(motion, outputs)
        return viewer(motion, design, tuple(name for name in chosen if not motion_figure(name)[1]))
    except (InvalidInput, NotAssembled):
        return None


def viewer(motion: Motion, design: int = 0, outputs: Sequence[str] = ()) -> Viewer:
    """Return the viewer of one design of a motion, with plots of some of its quantities.

    Raises NotAssembled where no pose is assembled, InvalidInput where links change their dimensions along the motion.
    """
    moving = MotionData(Sample(motion, design), tuple(outputs))
    data = {**moving.data, "plots": plot_data(moving)}
    return Viewer(player_html(moving, data), _plots_html(moving) if len(moving.chosen) > 1 else "", data)


def player_html(moving: MotionData, data: dict[str, Any]) -> str:
    """Return the sketch with its slider and switches."""
    caption = element("caption", "Numbers at the pose shown", class_="unseen")
    return element(
        "div",
        lines(
            [
                element("figure", lines([_sketch_html(moving), _legend(moving)]), class_="moving"),
                _transport(moving),
                element("p", "", class_="said", role="status"),
                element("p", "", class_="reason"),
                _switches(moving, data),
                element("table", f"{caption}<tbody></tbody>", class_="reading"),
                *_notes(moving, data),
            ]
        ),
        class_="player",
    )


def _sketch_html(moving: MotionData) -> str:
    """Return the sketch at the initial pose; every part is an element with its own place."""
    sketch = moving.sketch
    title = f"Moving kinematic sketch of {moving.motion.mechanism.title}"
    size = f"0 0 {coordinate_text(sketch.window.width)} {coordinate_text(sketch.window.height)}"
    parts = [*_parts_html(sketch)]
    inside = [
        *elements(sketch.still),
        *(element("g", "", class_=name) for name in ("traces", "rays")),
        element("g", lines(parts), class_="parts"),
        *(element("g", "", class_=name) for name in ("velocities", "accelerations", "forces", "dots")),
    ]
    return element("svg", lines(inside), viewBox=size, role="img", aria_label=title, style=FONT, class_="sketch")


def _parts_html(sketch: MovingSketch) -> Iterator[str]:
    k = int(np.searchsorted(sketch.scene.known, sketch.pose)) if sketch.scene.known is not None else 0
    for part in sketch.parts:
        at = complex(sketch.places(part)[k])
        place = f"translate({coordinate_text(at.real)} {coordinate_text(at.imag)})"
        shapes = "".join(elements(part.shapes))
        yield f'<g data-links="{link_names([part.link])}"{_part_attributes(part)} transform="{place}">{shapes}</g>'


def _part_attributes(part: MovingPart) -> str:
    """Return the letter of a part's point, and whether the part is a label."""
    letter = f' data-letter="{safe(part.letter)}"' if part.letter else ""
    return letter + (' class="name"' if part.is_label else "")


def _legend(moving: MotionData) -> str:
    """Return the numbers of the links, each an element that lights up with its link."""
    scene = moving.sketch.scene
    # by keyboard many names would be a long way; tables have them too, as one stop
    stop = "0" if len(scene.legend) <= MOST_STOPS else None
    named = [
        element("span", f"<b>{number}</b> {safe(name)}", class_="link", data_links=name, tabindex=stop)
        for name, number in scene.legend.items()
    ]
    # on a phone they are one row that scrolls
    reached = {"tabindex": "0", "role": "group", "aria_label": "Links"} if stop is None else {}
    return element("figcaption", " ".join(named), class_="legend", **reached)


def _transport(moving: MotionData) -> str:
    """Play, slider, one pose back and forth, speed."""
    last = len(moving.chosen) - 1
    slider = (
        f'<input type="range" class="slider" min="0" max="{last}" step="1" value="{moving.start}" '
        f'aria-label="Pose" aria-valuetext="pose {moving.start + 1} of {last + 1}">'
    )
    options = "".join(f'<option value="{s}"{" selected" if s == "1" else ""}>{s}&times;</option>' for s in SPEEDS)
    speed = element("label", f'{screen_reader_text("Speed of playing")}<select class="speed">{options}</select>')
    play = element("button", "<span>Play</span>", type="button", class_="play", aria_pressed="false")
    back = element("button", "&lsaquo;", type="button", class_="back", aria_label="One pose back")
    forth = element("button", "&rsaquo;", type="button", class_="forth", aria_label="One pose forth")
    row = element(
        "div", lines([play, back, forth, element("output", "", class_="where", aria_live="off"), speed]), class_="row"
    )
    return element("div", lines([slider, row]), class_="transport", role="group", aria_label="Motion")


def _switches(moving: MotionData, data: dict[str, Any]) -> str:
    """Return the switches of what the motion has."""
    has = {kind: kind in data["vectors"] for kind in (VELOCITY, ACCELERATION)}
    has |= {"forces": "forces" in data, "centres": bool(data["centres"]), "names": True}
    boxes = [_checkbox(key, word, title, key == "names") for key, word, title in SWITCHES if has[key]]
    carriers = moving.motion.mechanism.carriers
    letters = [letter for letter in moving.sketch.scene.letters if FRAME not in carriers[letter]]
    paths = [_checkbox(f"path {letter}", letter, f"path of {letter}", False) for letter in letters]
    more = (
        element("details", element("summary", "paths") + element("div", lines(paths), class_="boxes")) if paths else ""
    )
    legend = element("legend", "Show", class_="unseen")
    return element("fieldset", lines([legend, element("div", lines(boxes), class_="boxes"), more]), class_="switches")


def _checkbox(key: str, word: str, title: str, on: bool) -> str:
    checked = " checked" if on else ""
    return f'<label title="{safe(title)}"><input type="checkbox" data-show="{safe(key)}"{checked}> {safe(word)}</label>'


def _notes(moving: MotionData, data: dict[str, Any]) -> Iterator[str]:
    """Yield notes on missing poses, on the speed of playing, and on why dimensions cannot be changed."""
    why = (data["live"] or {}).get("why")
    if why:
        yield element("p", safe(why), class_="note")
    shown, poses, slowness = len(moving.chosen), moving.sample.poses, moving.slowness
    if shown < poses:
        text = f"The sketch moves through {shown:,} of the {poses:,} poses that were solved."
        yield element("p", text, class_="note")
    if slowness is not None and slowness != 1.0:
        text = f"{slowness:.3g} times slower" if slowness > 1 else f"{1 / slowness:.3g} times faster"
        yield element("p", f"At 1&times; it plays {text} than it runs.", class_="note")


def _plots_html(moving: MotionData) -> str:
    """Return the place of the plots, and the choice of other quantities."""
    mechanism, order = moving.motion.mechanism, moving.motion.order
    of_points = OF_POINTS[: min(order, MOST_ORDER) + 1]
    of_links = OF_LINKS[: min(order, MOST_ORDER) + 1]
    points = [letter for letter in moving.sketch.scene.letters if FRAME not in mechanism.carriers[letter]]
    names = [f"{letter}.{word}" for letter in points for word in of_points]
    names += [f"{link}.{word}" for link in moving.links if link != FRAME for word in of_links]
    options = "".join(element("option", safe(name), value=name) for name in names)
    choice = f'<label>Another quantity <select class="quantity">{options}</select></label>'
    add = element("button", "Plot it", type="button", class_="add")
    row = element("div", lines([choice, add]), class_="more") if names else ""
    return element("div", lines([element("div", "", class_="panels"), row]), class_="plots")


def player(motion: Motion, design: int = 0) -> str:
    """Return a document that shows one design of a motion under a slider and a button that plays it.

    It needs no other file. Raises NotAssembled where no pose is assembled, InvalidInput where links change their
    dimensions along the motion.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> player(solve(load("crank-rocker"))).splitlines()[0]
    '<!DOCTYPE html>'
    """
    moving = MotionData(Sample(motion, design), most=MOST_POSES, with_centres=False)
    return _document(moving, moving.data)


def _document(moving: MotionData, data: dict[str, Any]) -> str:
    styles = page_palette(), page_css(), asset("page.css"), *map(asset, styles_of(data)), PLAYER_STYLE
    head = [
        '<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        element("title", safe(data["title"])),
        *(element("style", text) for text in styles),
    ]
    scripted = "<script>document.documentElement.classList.add('scripted')</script>"
    body = [
        scripted,
        player_html(moving, data),
        data_script("ck-motion", compact(without_panel(data))),
        *(f"<script>{asset(name)}</script>" for name in scripts_of(data)),
    ]
    return f'<!DOCTYPE html>\n<html lang="en">\n<head>{lines(head)}</head>\n<body>{lines(body)}</body>\n</html>\n'


def framed_player(motion: Motion) -> str:
    """Return the player of a motion's first design in a frame, for notebooks. Raises what `player` does."""
    moving = MotionData(Sample(motion), most=MOST_POSES, with_centres=False)
    data, window = moving.data, moving.sketch.window
    document = _document(moving, data)
    below = CONTROLS + (CHANGES if is_live(data) else 0.0)
    height = min(HIGHEST, WIDTH * window.height / window.width, window.height * 1.1) + below
    style = f"width:100%;max-width:{WIDTH:.0f}px;height:{height:.0f}px;border:1px solid #8886;border-radius:8px"
    title = f"{motion.mechanism.title}, moving"
    return f'<iframe srcdoc="{safe(document)}" title="{safe(title)}" style="{style}" sandbox="allow-scripts"></iframe>'


def panel_section() -> str:
    """Return the section of dimensions, which scripts fill.

    >>> panel_section().splitlines()[0]
    '<section id="dimensions" aria-labelledby="dimensions-title">'
    """
    buttons = [
        element("button", safe(words), type="button", data_share=key, title=explanation)
        for key, words, explanation in SHARE_BUTTONS
    ]
    body = [
        element("h2", PANEL_TITLE, id=f"{PANEL_KEY}-title"),
        element("p", PANEL_HINT, class_="hint"),
        element("div", "", class_="dimensions"),
        element("div", lines(buttons), class_="share", role="group", aria_label="Take along"),
        element("p", "", class_="told"),
        '<textarea class="taken" readonly hidden aria-label="Text to copy"></textarea>',
    ]
    return element("section", f"\n{lines(body)}\n", id=PANEL_KEY, aria_labelledby=f"{PANEL_KEY}-title")
