"""What can be taken hold of in a sketch: points with their links, and drivers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.optional_answers import guided_point
from compoundkin.view.sketch.scene import Scene


def handle_data(scene: Scene, numbers: Mapping[str, int]) -> dict[str, Any]:
    """Return the points and drivers that a pointer can drag. `numbers` are the indices of links on the page.

    Of a point its name and `links`, those that carry another point too: its coordinates change on these, the others
    follow it. `on` is the link along whose guide it stays. Of a driver its name, its two links, its point, whether it
    turns.
    """
    points = [found for letter in scene.letters if (found := _point(scene, numbers, letter)) is not None]
    drivers = [
        {
            "name": one.drive.name,
            "link": numbers[one.drive.link],
            "on": numbers[one.drive.on],
            "at": one.pair.letters[0],
            "turns": one.pair.free_is_angle,
        }
        for one in scene.driven
        if not one.is_passive and {one.drive.link, one.drive.on} <= numbers.keys()
    ]
    return {"points": points, "drivers": drivers}


def _point(scene: Scene, numbers: Mapping[str, int], letter: str) -> dict[str, Any] | None:
    """A point that can be dragged. None where everything holds it: a driver that shifts or leads it, two guides."""
    carriers = scene.mechanism.carriers[letter]
    guides = list(_guides(scene, letter))
    led = any(letter == lead.point for lead in scene.mechanism.leads.values())
    if led or len(guides) > 1 or any(link not in numbers for link in carriers):
        return None
    if any(on == link for on, link in guides):
        return None
    links = [numbers[link] for link in carriers if link == FRAME or len(scene.points[link]) > 1]
    return {"name": letter, "links": links, **({"on": numbers[guides[0][0]]} if guides else {})}


def _guides(scene: Scene, letter: str) -> Iterator[tuple[str, str]]:
    """The links along whose guides a point stays: guides that are there before the links that slide on them."""
    driven = {step.pair.name: step.link for step in scene.driven}
    for pair in scene.structure.pairs:
        on, link = pair.members[0], pair.members[1]
        point = guided_point(pair, scene.ends[pair.name])
        if point is None or letter not in scene.points[link] or not np.all(point == scene.points[link][letter]):
            continue
        if pair.name in driven:
            yield link, link
        elif scene.groups[on] < scene.groups[link]:
            yield on, link
