"""From the text of a `.linkage2` file to a drawing."""

from __future__ import annotations

from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnGear, DrawnGuideway
from compoundkin.files.exchange.drawings.drawn_letters import size_around
from compoundkin.files.exchange.drawings.drawn_mechanism import MOST
from compoundkin.files.exchange.linkage.attribute_values import unknown_attributes
from compoundkin.files.exchange.linkage.connector_points import ConnectorPoints
from compoundkin.files.exchange.linkage.input_drivers import actuators_of, inputs_of
from compoundkin.files.exchange.linkage.joined_links import JoinedLinks
from compoundkin.files.exchange.linkage.joining_hints import hint, unjoined
from compoundkin.files.exchange.linkage.linkage_records import linkage_file
from compoundkin.files.exchange.linkage.ratio_gears import gears_of
from compoundkin.files.exchange.linkage.slider_guides import Slider, arcs_of, guides_of, limit_notes, sliders_of
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.xml_tree import xml_tree
from compoundkin.model.geometry import FRAME

# More notes of one kind are counted.
_MOST_NOTES = 8


def drawing_in(content: Content) -> tuple[Drawing, str]:
    """Return the drawing in a file, and a hint.

    The hint names connectors that may be meant to be joined. Raises InvalidInput with all that is wrong.
    """
    problems = Problems(content.where)
    joined = _joined(content, problems)
    file = joined.file
    size = size_around([one.at for one in file.connectors.values()])
    points = ConnectorPoints(joined)
    sliders, gears = sliders_of(joined), tuple(gears_of(points))
    actuators = list(actuators_of(points))
    guides = (*guides_of(sliders, points, size), *(one.guide for one in actuators))
    drivers = (*inputs_of(points), *(one.driver for one in actuators))
    hints = hint(list(unjoined(joined, size)))
    _find_floating(joined, sliders, guides, gears, hints)
    problems.raise_if_any()
    drawing = Drawing(
        content.name or "Linkage",
        tuple(joined.drawn),
        (*points.drawn, *(one.mouth for one in actuators)),
        guides,
        tuple(arcs_of(sliders, points)),
        gears,
        drivers=drivers,
        outputs=points.outputs,
        unit=file.unit,
        source="a file of the Linkage program",
        notes=(*_few(file.notes), *_few(joined.notes), *limit_notes(sliders, file.unit, size)),
        dropped=tuple(file.dropped.items()),
    )
    return drawing, hints


def _joined(content: Content, problems: Problems) -> JoinedLinks:
    """Return the links in a file. Raises InvalidInput where they are more than can be looked at."""
    text, told = _text(content)
    root = xml_tree(text, content.where)
    file = linkage_file(root, problems)
    file.notes += [*told, *unknown_attributes(root)]
    if len(file.connectors) + len(file.links) > MOST:
        problems.add("", f"it has more than {MOST} connectors and links", "look whether it is the right file")
        problems.raise_if_any()
    return JoinedLinks(file, problems)


def _text(content: Content) -> tuple[str, list[str]]:
    """Return the text, of old files by the code page of their time, and what is told of that."""
    try:
        return content.text, []
    except InvalidInput:
        if not content.is_text:
            raise
    return content.raw.decode("cp1252", "replace"), ["it is not UTF-8: its names are read as Windows-1252"]


def _few(notes: list[str]) -> list[str]:
    """Return some notes, and how many more there are."""
    return (
        notes if len(notes) <= _MOST_NOTES else [*notes[:_MOST_NOTES], f"and {len(notes) - _MOST_NOTES} more like this"]
    )


def _find_floating(
    joined: JoinedLinks,
    sliders: list[Slider],
    guides: tuple[DrawnGuideway, ...],
    gears: tuple[DrawnGear, ...],
    hints: str,
) -> None:
    """Note links that nothing joins to the frame, even by others."""
    met = [set(joined.at(id_)) for id_ in joined.file.connectors]
    met += [{*slider.bodies, slider.on} for slider in sliders]
    met += [{guide.link, guide.on} for guide in guides] + [{gear.first, gear.second, gear.carrier} for gear in gears]
    reached = _reached(met)
    if not any(one.anchor for one in joined.file.connectors.values()):
        joined.problems.add("", "no connector is an anchor: nothing is fixed", "make the fixed connectors anchors")
        return
    for link in joined.drawn:
        if link.key not in reached:
            what = f"{link.called} floats: nothing joins it to the anchors"
            joined.problems.add(link.where, what, hints or "pin it to a link")


def _reached(met: list[set[str]]) -> set[str]:
    """Return the bodies that hang together with the frame."""
    meets: dict[str, list[int]] = {}
    for k, bodies in enumerate(met):
        for body in bodies:
            meets.setdefault(body, []).append(k)
    reached, waiting = {FRAME}, [FRAME]
    while waiting:
        for k in meets.pop(waiting.pop(), ()):
            waiting += met[k] - reached
            reached |= met[k]
    return reached
