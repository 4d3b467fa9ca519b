"""The viewer: a sketch that moves under a slider, its switches, and the plots that go with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.analysis.characteristics.outputs_of_motion import chosen_outputs
from compoundkin.base.errors import InvalidInput, NotAssembled
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import ACCELERATION, OF_LINKS, OF_POINTS, VELOCITY, course_figure
from compoundkin.model.elements import FRAME
from compoundkin.view.page.markup import element, hidden, lines, safe
from compoundkin.view.page.moving_data import MotionData
from compoundkin.view.page.plot_data import plot_data
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.sketch.moving_sketch import MovingPart, MovingSketch
from compoundkin.view.sketch.svg import FONT, elements, link_names, number

# So many names below the sketch are stops of the keyboard.
MOST_STOPS = 12
# How much faster or slower than that the motion may be played.
SPEEDS = ("0.1", "0.25", "0.5", "1", "2")
# Plots of a page go to accelerations.
MOST_ORDER = 2
# What can be shown in the sketch, as it is called: its key, the words, and what they say at length.
SWITCHES = (
    (VELOCITY, "velocities", "velocity vectors of all points"),
    (ACCELERATION, "accelerations", "acceleration vectors of all points"),
    ("forces", "forces", "forces in pairs, loads, weights and inertia"),
    ("centres", "instant centres", "instant centres with the lines that give them"),
    ("names", "names", "letters of points and numbers of links"),
)


@dataclass(frozen=True)
class Viewer:
    """The parts of a page that show a motion. `html` the moving sketch, `plots` the place of the plots, `data`."""

    html: str
    plots: str
    data: dict[str, Any]

    @property
    def section(self) -> str:
        """The plots as a section of the page."""
        heading = element("h2", "Motion", id="motion-title")
        return element("section", lines([heading, self.plots]), id="motion", aria_labelledby="motion-title")


def viewer_of(motion: Motion, design: int = 0, outputs: Sequence[str] = ()) -> Viewer | None:
    """Return `viewer` with the outputs that a report has where none are named. None where nothing can move."""
    try:
        chosen = chosen_outputs(motion, outputs)
        return viewer(motion, design, tuple(name for name in chosen if not course_figure(name)[1]))
    except (InvalidInput, NotAssembled):
        return None


def viewer(motion: Motion, design: int = 0, outputs: Sequence[str] = ()) -> Viewer:
    """Return the viewer of one design of a motion. It has plots of some of its quantities.

    Raises NotAssembled where no pose is assembled, InvalidInput where links change their dimensions along the motion.
    """
    moving = MotionData(Sample(motion, design), tuple(outputs))
    data = {**moving.data, "plots": plot_data(moving)}
    return Viewer(player_html(moving, data), _plots(moving) if len(moving.chosen) > 1 else "", data)


def player_html(moving: MotionData, data: dict[str, Any]) -> str:
    """Return the sketch with its slider and switches."""
    return element(
        "div",
        lines(
            [
                element("figure", lines([_sketch(moving), _legend(moving)]), class_="moving"),
                _transport(moving),
                element("p", "", class_="said", role="status"),
                element("p", "", class_="reason"),
                _switches(moving, data),
                element("table", _unseen_caption("Numbers at the pose shown") + "<tbody></tbody>", class_="reading"),
                *_notes(moving, data),
            ]
        ),
        class_="player",
    )


def _unseen_caption(text: str) -> str:
    return element("caption", safe(text), class_="unseen")


def _sketch(moving: MotionData) -> str:
    """The sketch at the pose shown first; every part is an element with its own place."""
    sketch = moving.sketch
    title = f"Moving kinematic sketch of {moving.motion.mechanism.title}"
    size = f"0 0 {number(sketch.window.width)} {number(sketch.window.height)}"
    parts = [*_parts(sketch)]
    inside = [
        *elements(sketch.still),
        *(element("g", "", class_=name) for name in ("traces", "rays")),
        element("g", lines(parts), class_="parts"),
        *(element("g", "", class_=name) for name in ("velocities", "accelerations", "forces", "dots")),
    ]
    return element("svg", lines(inside), viewBox=size, role="img", aria_label=title, style=FONT, class_="sketch")


def _parts(sketch: MovingSketch) -> Iterator[str]:
    k = int(np.searchsorted(sketch.scene.known, sketch.pose)) if sketch.scene.known is not None else 0
    for part in sketch.parts:
        at = complex(sketch.places(part)[k])
        place = f"translate({number(at.real)} {number(at.imag)})"
        shapes = "".join(elements(part.shapes))
        yield f'<g data-links="{link_names([part.link])}"{_kind(part)} transform="{place}">{shapes}</g>'


def _kind(part: MovingPart) -> str:
    """What else is to be known of a part: the letter of its point; that it is a name."""
    letter = f' data-letter="{safe(part.letter)}"' if part.letter else ""
    return letter + (' class="name"' if part.is_label else "")


def _legend(moving: MotionData) -> str:
    """The numbers of the links, each in a place of its own that lights up with its link."""
    scene = moving.sketch.scene
    # by keyboard many names would be a long way; tables have them too, as one stop
    stop = "0" if len(scene.legend) <= MOST_STOPS else None
    named = [
        element("span", f"<b>{number}</b> {safe(name)}", class_="link", data_links=name, tabindex=stop)
        for name, number in scene.legend.items()
    ]
    return element("figcaption", " ".join(named))


def _transport(moving: MotionData) -> str:
    """Play, slider, one pose back and forth, speed."""
    last = len(moving.chosen) - 1
    slider = (
        f'<input type="range" class="slider" min="0" max="{last}" step="1" value="{moving.start}" '
        f'aria-label="Pose" aria-valuetext="pose {moving.start + 1} of {last + 1}">'
    )
    options = "".join(f'<option value="{s}"{" selected" if s == "1" else ""}>{s}&times;</option>' for s in SPEEDS)
    speed = element("label", f'{hidden("Speed of playing")}<select class="speed">{options}</select>')
    play = element("button", "<span>Play</span>", type="button", class_="play", aria_pressed="false")
    back = element("button", "&lsaquo;", type="button", class_="back", aria_label="One pose back")
    forth = element("button", "&rsaquo;", type="button", class_="forth", aria_label="One pose forth")
    row = element(
        "div", lines([play, back, forth, element("output", "", class_="where", aria_live="off"), speed]), class_="row"
    )
    return element("div", lines([slider, row]), class_="transport", role="group", aria_label="Motion")


def _switches(moving: MotionData, data: dict[str, Any]) -> str:
    """What may be shown or not; only what the motion has."""
    has = {kind: kind in data["vectors"] for kind in (VELOCITY, ACCELERATION)}
    has |= {"forces": "forces" in data, "centres": bool(data["centres"]), "names": True}
    boxes = [_box(key, word, told, key == "names") for key, word, told in SWITCHES if has[key]]
    carriers = moving.motion.mechanism.carriers
    letters = [letter for letter in moving.sketch.scene.letters if FRAME not in carriers[letter]]
    paths = [_box(f"path {letter}", letter, f"path of {letter}", False) for letter in letters]
    more = (
        element("details", element("summary", "paths") + element("div", lines(paths), class_="boxes")) if paths else ""
    )
    legend = element("legend", "Show", class_="unseen")
    return element("fieldset", lines([legend, element("div", lines(boxes), class_="boxes"), more]), class_="switches")


def _box(key: str, word: str, told: str, on: bool) -> str:
    checked = " checked" if on else ""
    return f'<label title="{safe(told)}"><input type="checkbox" data-show="{safe(key)}"{checked}> {safe(word)}</label>'


def _notes(moving: MotionData, data: dict[str, Any]) -> Iterator[str]:
    """Where what is seen is not all there is, or not as quick; why dimensions cannot be changed."""
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


def _plots(moving: MotionData) -> str:
    """The place of the plots, and what else may be plotted."""
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
