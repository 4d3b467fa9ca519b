"""GeoGebra's files: a construction as a .ggb file, read and written, or as commands, with notes on what is left out.

The construction has sliders for the drivers, then goes group by group. Its file is XML: objects, styles and shapes, and
the window.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import BytesIO
from math import atan2
from typing import Any, ClassVar, NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined, Problem
from compoundkin.files.exchange.content import MOST_BYTES, Content
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable
from compoundkin.files.exchange.geogebra.constructed_sides import (
    ChosenSides,
    InsideBody,
    PairSides,
    PlacedBodies,
    link_points,
    steps_of,
)
from compoundkin.files.exchange.geogebra.dragged_construction import (
    Angle,
    Construction,
    ConstructionStep,
    Look,
    PolarSum,
    SliderRange,
    in_degrees,
    number,
)
from compoundkin.files.exchange.geogebra.group_constructions import (
    CONSTRUCTIONS,
    DyadConstruction,
    add_mounted,
    add_train,
    inside_body,
    is_constructed,
    is_driven_constructed,
    is_train,
)
from compoundkin.files.exchange.geogebra.read_construction import AUTHOR, is_construction
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from compoundkin.kinematics import Motion
from compoundkin.kinematics.groups import GroupSolver, as_dyad
from compoundkin.kinematics.nearest_pose import turned_within
from compoundkin.kinematics.solution import quietly_solved
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair

_TABLE = "write a table of its positions instead: `compoundkin solve NAME -o positions.csv`"


def construction_of(shown: PosedMechanism) -> Construction:
    """Return the construction. Raises InvalidInput listing all that cannot be constructed."""
    motion = ranged_motion(shown)
    build = Construction()
    sliders = build.driven
    begun, build.beyond = slider_values(shown, motion)
    for name in motion.drives:
        sliders[name] = _slider(build, motion, name, begun[name])
    chosen = ChosenSides(build, motion, sliders)
    problems = [*_problems(motion, chosen)]
    if problems:
        raise InvalidInput(problems, heading=f"{shown.mechanism.title!r} cannot be constructed as a whole")
    placed = _constructed(build, motion, shown, sliders, chosen)
    add_shapes(build, shown, placed.points, sliders)
    return build


def ranged_motion(shown: PosedMechanism) -> Motion:
    """Return the motion over the drivers' own ranges."""
    motion = shown.motion
    if motion is not None and motion.inputs.poses > 1:
        return motion
    try:
        found = quietly_solved(shown.structure)
    except (InvalidInput, NotAssembled, NotDetermined) as error:
        what = f"it cannot be solved: {error.problems[0].what}"
        raise InvalidInput(Problem(shown.mechanism.title, what, "drive it where it can be assembled")) from None
    # of drivers without a range the pose asked for is all there is
    return found if found.inputs.poses > 1 or motion is None else motion


def _slider(build: Construction, motion: Motion, name: str, value: float) -> str:
    """Add the slider of a driver; a number where its range is a single value. Return its name."""
    values, is_angle = np.ravel(motion.drives[name].value), motion.structure.driven_angles[name]
    if is_angle:
        values, value = np.round(np.rad2deg(values), 9), in_degrees(value)
    stem, caption = ("φ", f"{name}, degrees") if is_angle else ("s", name)
    low, high = float(values.min()), float(values.max())
    if low == high:
        return build.dimension(stem, name, low, caption)
    return build.slide(stem, name, SliderRange(min(max(value, low), high), low, high, steps_of(values)), caption)


def _problems(motion: Motion, chosen: ChosenSides) -> Iterator[Problem]:
    """Yield all that no construction of circles, lines and ratios says."""
    for body in motion.structure.bodies:
        for driven in body.driven:
            if not is_driven_constructed(driven):
                yield Problem(driven.pair.name, f"a driven {driven.pair.title} has no construction", _TABLE)
    free: set[str] = set()  # links whose turns no driver tells
    for solver in motion.solving_order.solvers:
        if as_dyad(solver):
            free.update(solver.group.links)
            if not chosen.is_told(solver.index):
                what = "it passes to its other mode, and several drivers say when"
                yield Problem(_called(solver), what, _TABLE)
        elif not is_constructed(solver) and not is_train(solver):
            yield Problem(_called(solver), _why_not(solver), _TABLE)
        else:
            for link in sorted({name for pair in solver.group.outer for name in pair.members} & free):
                if not chosen.can_count(link):
                    yield Problem(link, "its full turns cannot be counted by the driver's", _TABLE)


def _called(solver: GroupSolver) -> str:
    return f"the group of {', '.join(solver.group.links)}"


def _why_not(solver: GroupSolver) -> str:
    """Say why a group has no construction here."""
    group = solver.group
    pairs = (*group.inner, *group.outer)
    kinds = sorted({pair.title for pair in pairs if pair.held == 1 and not as_dyad(solver)})
    if len(group.bodies) > 1 and not kinds:
        return f"it is of class {group.class_}: no circles and lines give it one after the other"
    return f"there is no construction for {', '.join(kinds) or 'its pairs'} of this kind"


def _constructed(
    build: Construction, motion: Motion, shown: PosedMechanism, sliders: Mapping[str, str], chosen: ChosenSides
) -> PlacedBodies:
    """Add all links, the driven ones of the frame first."""
    order, size = motion.solving_order, motion.size
    links = {name: link_points(build, name, own) for name, own in shown.points.items()}
    pairs = (*shown.mechanism.written_pairs, *order.pairs.values())
    sides = PairSides(build, links, motion.followed.given.ends, pairs, size)
    placed = PlacedBodies(build, links)
    for body in motion.structure.bodies:
        placed.join(body, inside_body(build, body, sides, sliders))
    placed.hold(motion.structure.ground, None)
    for solver in order.solvers:
        _add_group(placed, sides, solver, chosen)
    return placed


def _add_group(placed: PlacedBodies, sides: PairSides, solver: GroupSolver, chosen: ChosenSides) -> None:
    dyad = as_dyad(solver)
    if dyad is None:
        add = add_train if is_train(solver) else add_mounted
        add(placed, sides, solver, lambda link: chosen.counted(link, placed.angle(link)))
        for link in solver.group.links:
            chosen.note_counted(placed.angle(link))
        return
    for body in dyad.bodies:
        if body not in solver.group.bodies:
            placed.join(body, {body.links[0]: InsideBody(PolarSum(), Angle())})
    index = dyad.letters[1]
    mode = chosen.mode(solver.index, index) if dyad.modes == 2 else ""
    CONSTRUCTIONS[dyad.name](DyadConstruction(placed, sides, dyad, index, mode))


# What rounding leaves of values, as a part of their range: one at its end seems beyond it by so much.
_ROUNDING = 1e-9
# Points nearer to each other than this part of the size are one.
_SAME = 1e-9


def slider_values(shown: PosedMechanism, motion: Motion) -> tuple[Mapping[str, float], tuple[str, ...]]:
    """Return where sliders begin, and the drivers whose ranges end before that.

    Values are by driver, radians or lengths. An angle beyond its range is told by another one that differs by whole
    turns and is the same pose, which it is not where wheels turn with it. Any other value beyond becomes that end of
    the range which is nearest.
    """
    rows = {name: np.ravel(drive.value) for name, drive in motion.drives.items()}
    wanted = {name: shown.values.get(name, float(row[0])) for name, row in rows.items()}
    lifted = {name: turned_within(value, rows[name]) if motion.structure.driven_angles[name] else value
              for name, value in wanted.items()}  # fmt: skip
    if lifted != wanted and not _is_visible(shown, lifted):
        lifted = wanted
    found = {name: float(np.clip(value, rows[name].min(), rows[name].max())) for name, value in lifted.items()}
    return found, tuple(
        name for name, value in found.items() if abs(value - lifted[name]) > _ROUNDING * np.ptp(rows[name])
    )


def _is_visible(shown: PosedMechanism, values: Mapping[str, float]) -> bool:
    """Return whether the pose at values is the one that is shown."""
    try:
        other = posed_mechanism(shown.mechanism, values)
    except (InvalidInput, NotAssembled):
        return False
    size = shown.mechanism.geometry.size
    return all(
        abs(shown.place(link, letter) - other.place(link, letter)) <= _SAME * size
        for link, own in shown.points.items()
        for letter in own
    )


# The day that every file in the archive bears, so that the same mechanism makes the same bytes: the earliest there is.
_DAY = (1980, 1, 1, 0, 0, 0)


class GeogebraFile(Readable, Writable):
    """An archive with the construction in it; read also as the text that is in the archive."""

    name: ClassVar[str] = "geogebra"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra file"
    suffix: ClassVar[str] = ".ggb"
    most: ClassVar[int] = MOST_BYTES

    def recognises(self, content: Content) -> bool:
        """Return whether there is a construction in it."""
        return is_construction(content)

    def read(self, content: Content) -> Imported:
        """Return the mechanism that a construction moves as."""
        from compoundkin.files.exchange.geogebra.construction_drawing import read_construction

        return read_construction(content, self.name)

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput listing all groups that have no construction."""
        build = construction_of(shown)
        text = xml_of(build, shown.mechanism.title, window_of(ranged_motion(shown)))
        content = BytesIO()
        with ZipFile(content, "w") as archive:
            entry = ZipInfo("geogebra.xml", _DAY)
            entry.compress_type = ZIP_DEFLATED
            archive.writestr(entry, text)
        return Exported(content.getvalue(), self.name, notes_of(shown, build))


FORMAT = GeogebraFile()


class GeogebraCommands(Writable):
    """The list of commands."""

    name: ClassVar[str] = "geogebra-commands"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra commands"

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the commands. Raises InvalidInput listing all groups that have no construction."""
        build = construction_of(shown)
        text = "\n".join(build.lines) + "\n"
        return Exported(text.encode(), self.name, notes_of(shown, build))


COMMANDS = GeogebraCommands()


def notes_of(shown: PosedMechanism, build: Construction) -> tuple[str, ...]:
    """Return what does not come across."""
    return tuple(_notes(shown, build))


def _notes(shown: PosedMechanism, build: Construction) -> Iterator[str]:
    mechanism = shown.mechanism
    loads = len(mechanism.loads) + len(mechanism.frictions) + len(mechanism.pretensions)
    kinds = ((len(mechanism.masses), "mass", "masses"), (loads, "load", ""), (len(mechanism.outlines), "outline", ""))
    if left := ", ".join(count_phrase(count, one, many) for count, one, many in kinds if count):
        yield f"left out: {left}"
    for lead in mechanism.prescribed_motions.values():
        yield f"what leads {lead.name} is not in the construction: its coordinates have sliders of their own"
    changing = [step.name for step in build.steps if step.look == "helper" and step.caption and "mode" in step.caption]
    for name in changing:
        yield f"{name} changes where the links are in line, as the motion does: with other lengths set it to 1 or -1"
    for name in build.beyond:
        yield f"{name} begins at the end of its range: the pose that is asked for, or drawn, lies beyond"
    for name, slider in build.driven.items():
        if not build.is_slider(slider):
            yield f"{name} has a single value: it is a number to be changed"


# --- XML ------------------------------------------------------------------------------------------------------------


# The window in pixels, and how much of it is kept free on each side.
_WIDTH, _HEIGHT, _MARGIN = 900, 600, 80
# The desktop program has its list of objects beside it, its menus above and below.
_LIST, _MENUS = 280, 200
# Sliders are put one below the other, in pixels.
_SLIDER_WIDTH, _SLIDER_LEFT, _SLIDER_TOP, _SLIDER_EVERY = 300, 30, 40, 45
_TURN = 360.0


class Style(NamedTuple):
    """How objects look: colour, whether seen and named, size, line, filling."""

    colour: tuple[int, int, int]
    is_seen: bool = True
    is_named: bool = False
    size: int = 0
    dash: int = 0
    filled: float = 0.0


_STYLES: Mapping[Look, Style] = {
    "slider": Style((176, 58, 46), is_named=True, size=8, filled=0.1),
    "dimension": Style((97, 97, 97), is_seen=False),
    "helper": Style((97, 97, 97), is_seen=False),
    "fixed": Style((33, 33, 33), is_named=True, size=6),
    "pin": Style((21, 101, 192), is_named=True, size=4),
    "guide": Style((158, 158, 158), size=2, dash=15),
    "link": Style((21, 101, 192), size=6, filled=0.15),
    "wheel": Style((158, 158, 158), size=2, dash=10),
    "curve": Style((176, 58, 46), size=3),
}


class ViewWindow(NamedTuple):
    """The corners of what is to be seen."""

    low: complex
    high: complex


def xml_of(build: Construction, title: str, window: ViewWindow) -> bytes:
    """Return the text of the file."""
    root = Element("geogebra", {"format": "5.0", "version": "5.0.609.0", "app": "classic", "platform": "w"})
    around = {"width": str(_WIDTH + _LIST), "height": str(_HEIGHT + _MENUS)}
    SubElement(SubElement(root, "gui"), "window", around)
    _add_view(root, window)
    kernel = SubElement(root, "kernel")
    for name, value in (("continuous", "false"), ("decimals", "2"), ("angleUnit", "degree"), ("coordStyle", "0")):
        SubElement(kernel, name, {"val": value})
    inside = SubElement(root, "construction", {"title": title, "author": AUTHOR, "date": ""})
    sliders = 0
    for step in build.steps:
        _add_step(inside, step, sliders)
        sliders += step.slider is not None
    indent(root)
    text: str = tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode()


def _add_view(root: Element, window: ViewWindow) -> None:
    """Add the window, as large as the motion lets it be."""
    wide, high = (window.high - window.low).real, (window.high - window.low).imag
    scale = min((_WIDTH - 2 * _MARGIN) / (wide or high or 1.0), (_HEIGHT - 2 * _MARGIN) / (high or wide or 1.0))
    middle = (window.low + window.high) / 2.0
    view = SubElement(root, "euclidianView")
    SubElement(view, "viewNumber", {"viewNo": "1"})
    SubElement(view, "size", {"width": str(_WIDTH), "height": str(_HEIGHT)})
    zero = {"xZero": _WIDTH / 2 - middle.real * scale, "yZero": _HEIGHT / 2 + middle.imag * scale}
    places = {name: number(value) for name, value in (*zero.items(), ("scale", scale), ("yscale", scale))}
    SubElement(view, "coordSystem", places)
    SubElement(view, "evSettings", {"axes": "false", "grid": "false", "pointCapturing": "0"})
    for axis in ("0", "1"):
        SubElement(
            view,
            "axis",
            {"id": axis, "show": "false", "showNumbers": "false", "tickStyle": "1", "label": "", "unitLabel": ""},
        )


def _add_step(inside: Element, step: ConstructionStep, sliders: int) -> None:
    """Add a step: what it is made of, where it is not free, and how it looks."""
    if step.command:
        command = SubElement(inside, "command", {"name": step.command})
        SubElement(command, "input", {f"a{k}": text for k, text in enumerate(step.arguments)})
        SubElement(command, "output", {"a0": step.name})
    elif not step.is_free:
        kind = {"type": step.kind} if step.kind != "numeric" else {}
        SubElement(inside, "expression", {"label": step.name, "exp": step.text, **kind})
    element = SubElement(inside, "element", {"type": step.kind, "label": step.name})
    _add_value(element, step)
    _add_style(element, _STYLES[step.look])
    if step.slider:
        _add_slider(element, step, sliders)
    if step.caption:
        SubElement(element, "caption", {"val": step.caption})


def _add_value(element: Element, step: ConstructionStep) -> None:
    if step.kind == "numeric" and step.is_free:
        SubElement(element, "value", {"val": number(step.slider.value if step.slider else step.numbers[0])})
    elif step.numbers:
        x, y = step.numbers
        SubElement(element, "coords", {"x": number(x), "y": number(y), "z": "1"})


def _add_style(element: Element, style: Style) -> None:
    SubElement(element, "show", {"object": _word(style.is_seen), "label": _word(style.is_named)})
    red, green, blue = map(str, style.colour)
    SubElement(element, "objColor", {"r": red, "g": green, "b": blue, "alpha": number(style.filled)})
    SubElement(element, "labelMode", {"val": "1" if element.get("type") == "numeric" else "0"})
    if element.get("type") == "point":
        SubElement(element, "pointSize", {"val": str(style.size or 3)})
    elif style.size:
        SubElement(element, "lineStyle", {"thickness": str(style.size), "type": str(style.dash)})


def _add_slider(element: Element, step: ConstructionStep, sliders: int) -> None:
    assert step.slider is not None
    low, high, every = step.slider.low, step.slider.high, step.slider.step
    place = {"x": str(_SLIDER_LEFT), "y": str(_SLIDER_TOP + _SLIDER_EVERY * sliders)}
    kind = "1" if high - low == _TURN else "0"  # round and round, or there and back
    fixed = {"absoluteScreenLocation": "true", "width": str(_SLIDER_WIDTH), "fixed": "true", "horizontal": "true"}
    SubElement(element, "slider", {"min": number(low), "max": number(high), **fixed, **place})
    SubElement(element, "animation", {"step": number(every), "speed": "1", "type": kind, "playing": "false"})


def _word(value: bool) -> str:
    return "true" if value else "false"


def add_shapes(
    build: Construction, shown: PosedMechanism, points: Mapping[str, str], sliders: Mapping[str, str]
) -> None:
    """Add segments and polygons for links, circles for wheels, loci of traced points."""
    for name, own in shown.points.items():
        if name != FRAME:
            _add_link(build, name, own, points)
    for pair in shown.pairs:
        _add_pair(build, shown, pair, points)
    for letter in traced(shown):
        for name, slider in sliders.items():
            if build.is_slider(slider) and slider in build.needs(points[letter]):
                index = letter if len(sliders) == 1 else f"{letter}-{name}"
                build.shape("locus", ("c", index), "curve", "Locus", (points[letter], slider))


def _add_link(build: Construction, name: str, own: Mapping[str, complex], points: Mapping[str, str]) -> None:
    """Add a link of two points as a segment, one of more as a polygon, its points in a round."""
    places: dict[complex, str] = {}
    for letter, place in own.items():
        places.setdefault(place, points[letter])
    if len(places) == 2:
        build.shape("segment", ("f", name), "link", "Segment", tuple(places.values()))
    elif len(places) > 2:
        middle = sum(places) / len(places)
        order = sorted(places, key=lambda p: (round(atan2((p - middle).imag, (p - middle).real), 9), abs(p - middle)))
        build.shape("polygon", ("f", name), "link", "Polygon", tuple(places[p] for p in order))


def _add_pair(build: Construction, shown: PosedMechanism, pair: Pair, points: Mapping[str, str]) -> None:
    """Add the way along a slide or slot, the pitch circles of gears, the circle of a wheel on a line."""
    one, two = (*(points[letter] for letter in pair.letters[:2] if letter in points), "", "")[:2]
    sizes = build.sizes.get(pair.name, ())
    if pair.table in ("slides", "slots") and one and two and one != two:
        build.shape("segment", ("g", f"{pair.name}-0"), "guide", "Segment", (two, one))
    elif pair.table == "gears" and len(sizes) == 2:
        ring = shown.ends[pair.name][0].measure * shown.ends[pair.name][1].measure < 0
        whole = f"abs({sizes[1]} - {sizes[0]})" if ring else f"({sizes[0]} + {sizes[1]})"
        for k, own in enumerate((one, two)):
            radius = f"Distance({one}, {two}) * {sizes[k]} / {whole}"
            build.shape("conic", ("w", f"{pair.name}-{k + 1}"), "wheel", "Circle", (own, radius))
    elif len(sizes) == 1:
        build.shape("conic", ("w", pair.name), "wheel", "Circle", (one, f"abs({sizes[0]})"))


def window_of(motion: Motion) -> ViewWindow:
    """Return the box of all points over the motion."""
    known = np.ravel(motion.failed) == 0
    rows = [np.ravel(motion.points[letter].position) for letter in motion.mechanism.carriers]
    places = np.concatenate([row[known] if row.size > 1 else row for row in rows])
    low, high = (complex(pick(places.real), pick(places.imag)) for pick in (np.min, np.max))
    return ViewWindow(low, high)


def traced(shown: PosedMechanism) -> list[str]:
    """Return the points that the mechanism's outputs are about, those of moving links alone."""
    mechanism = shown.mechanism
    asked = dict.fromkeys(name.split(".")[0] for name in mechanism.outputs)
    fixed = shown.points.get(FRAME, {})
    return [letter for letter in asked if letter in mechanism.carriers and letter not in fixed]
