"""Sliders of a file as guides: slots, slides where two sliders of a link are in one line, circular slots."""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

from compoundkin.base.display import abbreviated_list
from compoundkin.files.exchange.drawings.drawn_elements import DrawnArc, DrawnGuideway
from compoundkin.files.exchange.drawings.drawn_letters import SAME
from compoundkin.files.exchange.linkage.connector_points import ConnectorPoints
from compoundkin.files.exchange.linkage.joined_links import JoinedLinks
from compoundkin.files.exchange.linkage.linkage_records import LinkageConnector
from compoundkin.model.geometry import FRAME

# Lines are one, and pins are on them, that differ by less than this part of the size: the program keeps six decimals
# of 1/96 inch, and what is moved by hand snaps.
ONE_LINE = 1e-5
# Two pins hold a direction that are not one above the other, seen along their line.
_ALONG = 0.05


@dataclass(frozen=True)
class Slider:
    """A connector that runs between two others, on a body that they share."""

    connector: LinkageConnector
    bodies: tuple[str, ...]
    on: str
    limits: tuple[LinkageConnector, LinkageConnector]

    @property
    def along(self) -> complex:
        """The way from limit to limit."""
        return self.limits[1].at - self.limits[0].at

    @property
    def direction(self) -> complex:
        """The direction of the line."""
        return self.along / abs(self.along)

    def off(self, at: complex) -> float:
        """Return how far a place is from the line."""
        return abs(((at - self.limits[0].at) / self.direction).imag)

    @property
    def centre(self) -> complex:
        """The centre of a circular slot. It is left of the way between the limits, if its radius is positive."""
        half = abs(self.along) / 2.0
        height = sqrt(max(self.radius**2 - half**2, 0.0))
        side = 1.0 if self.connector.radius > 0 else -1.0
        return self.limits[0].at + self.along / 2.0 + side * 1j * self.direction * height

    @property
    def radius(self) -> float:
        """The radius of a circular slot, at least half the way between the limits."""
        return max(abs(self.connector.radius), abs(self.along) / 2.0)


def sliders_of(joined: JoinedLinks) -> list[Slider]:
    """Return the sliders that hold something. What is wrong with them is noted."""
    found = (_slider(one, joined) for one in joined.file.connectors.values() if one.slider)
    return [slider for slider in found if slider is not None]


def _slider(one: LinkageConnector, joined: JoinedLinks) -> Slider | None:
    problems, known = joined.problems, joined.file.connectors
    for id_ in one.limits:
        if id_ not in known and id_ is not None:
            problems.add(one.where, f"slidelimit {id_} is not there", "name two connectors of one link")
    if len(one.limits) != 2:
        what = f"it is a slider with {len(one.limits)} slide limits"
        problems.add(one.where, what, "name the two connectors that it slides between")
    limits = [known[id_] for id_ in one.limits if id_ in known]
    if len(limits) != 2 or len(one.limits) != 2:
        return None
    if limits[0].at == limits[1].at or one.id in (limits[0].id, limits[1].id):
        problems.add(one.where, "its slide limits are no two places beside it", "name two other connectors")
        return None
    bodies = joined.at(one.id)
    shared = [body for body in joined.at(limits[0].id) if body in joined.at(limits[1].id)]
    carriers = [body for body in shared if body not in bodies]
    if FRAME in bodies and FRAME in shared:
        joined.file.drop("slider of a fixed pin")
    elif bodies and not carriers:
        said = f"{limits[0].id} and {limits[1].id}"
        what = f"it is of the link that holds its slide limits {said}" if shared else f"no link holds both {said}"
        problems.add(one.where, f"it is a slider, but {what}", "let it slide on one other link")
    usable = bodies and carriers and not (FRAME in bodies and FRAME in shared)
    return Slider(one, bodies, carriers[0], (limits[0], limits[1])) if usable else None


def guides_of(sliders: list[Slider], points: ConnectorPoints, size: float) -> Iterator[DrawnGuideway]:
    """Yield slots and slides. Two sliders of one link in one line of another are a slide."""
    straight = [slider for slider in sliders if not slider.connector.radius]
    sliding: list[Slider] = []
    held: set[int] = set()
    for one in straight:
        if one.connector.id in held or any(_is_held(one, other, size) for other in sliding):
            continue
        second = next((two for two in straight if two is not one and _is_slide(one, two, size)), None)
        if second is None:
            yield _guide(one, one.bodies[0], "slot", points, size)
            continue
        sliding.append(one)
        held.add(second.connector.id)
        yield _guide(one, _common(one, second)[0], "slide", points, size)


def arcs_of(sliders: list[Slider], points: ConnectorPoints) -> Iterator[DrawnArc]:
    """Yield circular slots."""
    for one in sliders:
        if one.connector.radius:
            key, at = f"slider {one.connector.id}", points.key(one.connector.id)
            yield DrawnArc(key, one.bodies[0], one.on, at, one.centre, one.radius, where=one.connector.where)


def limit_notes(sliders: list[Slider], unit: str, size: float) -> Iterator[str]:
    """Yield what is told of limits and of connectors beside their lines."""
    said = [f"{one.connector.id} runs {abs(one.along):.6g} {unit} from {one.limits[0].id}" for one in sliders]
    if said:
        yield f"slide limits are not kept, the guides are open: {abbreviated_list(said)}"
    for one in sliders:
        round_ = one.connector.radius and abs(abs(one.connector.at - one.centre) - one.radius)
        off = round_ if one.connector.radius else one.off(one.connector.at)
        if off > ONE_LINE * size:
            yield f"{one.connector.called} is drawn {off:.4g} {unit} beside its slot"


def _guide(one: Slider, link: str, kind: str, points: ConnectorPoints, size: float) -> DrawnGuideway:
    """Return a guide. A pin that rounding has put beside the line is on it, so that line has an angle and no ends."""
    first, second = one.limits
    exact = kind == "slide" or one.off(one.connector.at) <= SAME * size
    return DrawnGuideway(
        f"slider {one.connector.id}",
        "slide" if kind == "slide" else "slot",
        link,
        one.on,
        points.key(one.connector.id),
        first.at,
        phase(one.direction),
        (points.key(first.id), points.key(second.id)) if exact else None,
        where=one.connector.where,
    )


def _common(one: Slider, two: Slider) -> list[str]:
    return [body for body in one.bodies if body in two.bodies]


def _is_slide(one: Slider, two: Slider, size: float) -> bool:
    """Return whether two sliders of one link are in one line of another."""
    apart = (two.connector.at - one.connector.at) / one.direction
    return (
        one.on == two.on
        and bool(_common(one, two))
        and all(one.off(limit.at) <= ONE_LINE * size for limit in two.limits)
        and abs(apart.real) > _ALONG * abs(apart)
        and abs(apart) > ONE_LINE * size
    )


def _is_held(one: Slider, other: Slider, size: float) -> bool:
    """Return whether a slide holds a slider already."""
    return _is_slide(other, one, size)
