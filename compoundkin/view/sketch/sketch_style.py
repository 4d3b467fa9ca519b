"""The one visual language: what every class of shapes looks like, on light and on dark paper.

Widths and sizes are in picture units; a picture of many links has more of them (`window`), so that its lines are finer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from operator import itemgetter
from typing import TypeAlias

from compoundkin.model.attributes import ACCELERATION, VELOCITY

# From the middle of a line of text to its baseline, in parts of the size of the letters.
BASELINE = 0.35
# Lowered and raised signs as texts have them; pictures set them as small ones of the font, or as formulas.
LOWERED_SIGNS, RAISED_SIGNS = "₀₁₂₃₄₅₆₇₈₉₋", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"
# A colour on light and on dark paper.
Colours: TypeAlias = tuple[str, str]
# Sizes that shapes are made with, in picture units.
PIN = 4.5
STUD = 4.0
BAR = 5.0
BLOCK = (26.0, 15.0)
LETTER = 14.0
SMALL = 11.0
LINE = 16.0  # from line to line of a text
NUMBER = 8.5  # radius of the circle around a link's number
# Colours on light and on dark paper. Those of groups keep a contrast of at least 3 : 1 with their paper and differ in
# lightness too, for readers who do not see all colours (after M. Okabe and K. Ito, Color Universal Design).
PAPER = "#ffffff", "#14171c"
INK = "#1b1f24", "#e6e9ee"
FRAME = "#5b6470", "#a3adba"
FAINT = "#8d96a2", "#78828f"
COLOURS: tuple[Colours, ...] = (
    ("#343a43", "#d5dae1"),  # frame and driven links
    ("#0067b1", "#5db1f2"),
    ("#c04a00", "#ff9450"),
    ("#007a5a", "#3fc79d"),
    ("#a8327f", "#ee83c6"),
    ("#8a6500", "#e0b53c"),
    ("#5b4bc4", "#a79bff"),
    ("#b3261e", "#ff8a80"),
)
OF_VELOCITIES = "#b3261e", "#ff8a80"
OF_ACCELERATIONS = "#5b4bc4", "#a79bff"
# What acts on links: forces in pairs and of drivers, loads and weights, what inertia does.
REACTION, LOAD, INERTIA = "reaction", "load", "inertia"
OF_FORCES: Mapping[str, Colours] = {
    REACTION: ("#c2001a", "#ff7b7b"),
    LOAD: ("#0047ab", "#82b4ff"),
    INERTIA: ("#7a4fa3", "#c9a6ee"),
}
_ROUND = "stroke-linecap:round;stroke-linejoin:round"
_LINE = f"fill:none;{_ROUND}"
# What each class looks like: its rules, `{}` standing for its colour.
CLASSES: Mapping[str, tuple[str, Colours]] = {
    "paper": ("fill:{}", PAPER),
    "pin": ("fill:{};stroke-width:2", PAPER),
    "knock": (f"{_LINE};stroke:{{}};stroke-width:7", PAPER),
    "ink": (f"{_LINE};stroke:{{}};stroke-width:2", INK),
    "dot": ("fill:{}", INK),
    "frame": (f"{_LINE};stroke:{{}};stroke-width:2", FRAME),
    "frame-face": ("fill:{};fill-opacity:.14", FRAME),
    "frame-track": (f"{_LINE};stroke:{{}};stroke-width:12", FRAME),
    "outer": (f"{_LINE};stroke:{{}};stroke-width:1.2;stroke-dasharray:3 3", INK),
    "bold": (f"{_LINE};stroke:{{}};stroke-width:3.6", INK),
    "strap": (f"{_LINE};stroke:{{}};stroke-width:2.2", INK),
    "hatch": (f"{_LINE};stroke:{{}};stroke-width:1", FRAME),
    "path": (f"{_LINE};stroke:{{}};stroke-width:1.6", ("#b0004e", "#ff6fa5")),
    "drive": (f"{_LINE};stroke:{{}};stroke-width:2.2", INK),
    "drive-head": ("fill:{}", INK),
    VELOCITY: (f"{_LINE};stroke:{{}};stroke-width:2", OF_VELOCITIES),
    f"{VELOCITY}-head": ("fill:{}", OF_VELOCITIES),
    ACCELERATION: (f"{_LINE};stroke:{{}};stroke-width:2", OF_ACCELERATIONS),
    f"{ACCELERATION}-head": ("fill:{}", OF_ACCELERATIONS),
    **{kind: (f"{_LINE};stroke:{{}};stroke-width:2", colours) for kind, colours in OF_FORCES.items()},
    **{f"{kind}-head": ("fill:{}", colours) for kind, colours in OF_FORCES.items()},
    **{f"{kind}-name": (f"fill:{{}};font-size:{SMALL:g}px", colours) for kind, colours in OF_FORCES.items()},
    "centre": ("fill:{}", ("#b3261e", "#ff8a80")),
    "ray": (f"{_LINE};stroke:{{}};stroke-width:.9;stroke-dasharray:5 4", FAINT),
    "edge": (f"{_LINE};stroke:{{}};stroke-width:1.6", FAINT),
    "dimension": (f"{_LINE};stroke:{{}};stroke-width:.9", FRAME),
    "dimension-head": ("fill:{}", FRAME),
    "dimension-text": (f"fill:{{}};font-size:{SMALL:g}px", INK),
    "extension": (f"{_LINE};stroke:{{}};stroke-width:.6", FRAME),
    "letter": (f"fill:{{}};font-size:{LETTER:g}px;font-style:italic", INK),
    "number": (f"fill:{{}};font-size:{SMALL:g}px", INK),
    "note": (f"fill:{{}};font-size:{SMALL:g}px", FRAME),
    "heading": (f"fill:{{}};font-size:{LETTER:g}px;font-weight:bold", INK),
    "code": (f"fill:{{}};font-size:{SMALL:g}px;font-style:italic", FRAME),
    "halo": ("stroke:{};stroke-width:3.5;stroke-linejoin:round", PAPER),
    "centre-name": (f"fill:{{}};font-size:{SMALL:g}px", ("#b3261e", "#ff8a80")),
}
# The same for every group of links, by the number of the group.
GROUPED: Mapping[str, str] = {
    "bar": f"{_LINE};stroke:{{}};stroke-width:{BAR:g}",
    "plate": "fill:{};fill-opacity:.22;stroke:{};stroke-width:2.5;stroke-linejoin:round",
    "line": f"{_LINE};stroke:{{}};stroke-width:2",
    "thin": f"{_LINE};stroke:{{}};stroke-width:1.2",
    "pitch": f"{_LINE};stroke:{{}};stroke-width:.9;stroke-dasharray:9 2.5 2 2.5",
    "dashed": f"{_LINE};stroke:{{}};stroke-width:1.2;stroke-dasharray:5 4",
    "track": f"{_LINE};stroke:{{}};stroke-width:12",
    "ring": "stroke:{}",
    # outlines: what is wide has its width as an attribute, which rules of a class would take away
    "contour": f"fill:{{edge}};stroke:{{edge}};{_ROUND}",
    "contour-bar": f"fill:none;stroke:{{edge}};{_ROUND}",
    "area": f"fill:{{pale}};stroke:{{pale}};{_ROUND}",
    "area-bar": f"fill:none;stroke:{{pale}};{_ROUND}",
}
# How much of its group's colour an outline has, within and along its edge; the rest is paper.
MIXED: Mapping[str, float] = {"pale": 0.16, "edge": 0.6}


def style_of(kind: str, group: int | None = None) -> str:
    """Return the classes of a shape; a number of a group adds its colour.

    >>> style_of("bar", 9)
    'bar2'
    """
    return kind if group is None else f"{kind}{group if group == 0 else (group - 1) % (len(COLOURS) - 1) + 1}"


def page_css() -> str:
    """Return the style sheet of all pictures of a page. Its root may say `data-theme="light"` or "dark".

    Rules name their colours, so that they are written once and not for each paper.
    """
    found: dict[Colours, str] = {}
    grouped = [f"{kind}{k}" for kind in GROUPED for k in range(len(COLOURS))]
    names = sorted(["ghost", *CLASSES, *grouped])
    rules = [_rule(name, lambda pair: f"var({found.setdefault(pair, f'--k{len(found)}')})") for name in names]
    light, dark = ("".join(f"{name}:{pair[paper]};" for pair, name in found.items()) for paper in (0, 1))
    screen = f"@media screen{{:root[data-theme=dark]{{{dark}}}}}"
    system = f"@media screen and (prefers-color-scheme:dark){{:root:not([data-theme=light]){{{dark}}}}}"
    return "\n".join((f":root{{{light}}}", screen, system, *rules))


def declarations(name: str) -> dict[str, str]:
    """Return the rules of a class on light paper, by their names.

    >>> declarations("hatch")["stroke-width"]
    '1'
    """
    inside = _rule(name, itemgetter(0)).partition("{")[2].removesuffix("}")
    return dict(rule.split(":") for rule in inside.split(";"))


def sheets_of_papers(names: Iterable[str]) -> tuple[str, str]:
    """Return the rules of classes on light paper, and those that differ on dark."""
    both = [(_rule(name, itemgetter(0)), _rule(name, itemgetter(1))) for name in sorted(names)]
    return "\n".join(light for light, _ in both), "\n".join(dark for light, dark in both if light != dark)


def _rule(name: str, painted: Callable[[Colours], str]) -> str:
    """The rule of a class; `painted` is how a colour is written."""
    if name == "ghost":
        return ".ck-ghost{opacity:.22}"
    if name in CLASSES:
        rules, colours = CLASSES[name]
        return f".ck-{name}{{{rules.replace('{}', painted(colours))}}}"
    kind, number = name.rstrip("0123456789"), int(name[len(name.rstrip("0123456789")) :])
    own = COLOURS[number]
    rules = GROUPED[kind].replace("{}", painted(own)) if "{}" in GROUPED[kind] else GROUPED[kind]
    for word, part in MIXED.items():
        if f"{{{word}}}" in rules:
            light, dark = (mixed(one, paper, part) for one, paper in zip(own, PAPER, strict=True))
            rules = rules.replace(f"{{{word}}}", painted((light, dark)))
    return f".ck-{name}{{{rules}}}"


def mixed(colour: str, other: str, part: float) -> str:
    """Return a part of a colour mixed with another one.

    >>> mixed("#000000", "#ffffff", 0.25)
    '#bfbfbf'
    """
    two = zip(bytes.fromhex(colour[1:]), bytes.fromhex(other[1:]), strict=True)
    return "#" + "".join(f"{round(part * one + (1.0 - part) * rest):02x}" for one, rest in two)
