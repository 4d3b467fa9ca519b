"""Ratios of a file as gears and belts: their axes are the first connectors of the links, held by a common carrier."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.files.exchange.drawings.drawn_elements import DrawnGear
from compoundkin.files.exchange.linkage.connector_points import ConnectorPoints
from compoundkin.files.exchange.linkage.joined_links import JoinedLinks
from compoundkin.files.exchange.linkage.linkage_records import LinkageLink, LinkageRatio
from compoundkin.model.geometry import FRAME

_KINDS = ("gears", "chain")


def gears_of(points: ConnectorPoints) -> Iterator[DrawnGear]:
    """Yield the pairs of wheels. What is wrong with them is noted."""
    joined = points.joined
    for k, ratio in enumerate(joined.file.ratios):
        wheels = _wheels(ratio, joined)
        if wheels is None:
            continue
        first, second = (joined.body(link.key) for link in wheels)
        axes = [link.connectors[0] for link in wheels]
        both = [body for body in joined.at(axes[0]) if body in joined.at(axes[1])]
        carriers = sorted((body for body in both if body not in (first, second)), key=lambda body: body != FRAME)
        if first == second:
            joined.problems.add(ratio.where, "both its wheels are one link", "name two links that turn")
        elif not carriers:
            what = f"links {wheels[0].id} and {wheels[1].id} have no common carrier of their axes"
            joined.problems.add(ratio.where, what, "hold both axes by one link, or anchor both")
        else:
            yield _gear(f"ratio {k}", ratio, (first, second), carriers[0], axes, points)


def _wheels(ratio: LinkageRatio, joined: JoinedLinks) -> list[LinkageLink] | None:
    """Return the two links of a ratio, or nothing where they are not that."""
    problems = joined.problems
    if ratio.kind not in _KINDS:
        problems.add(ratio.where, f"there is no ratio of type {ratio.kind[:40]!r}", "gears or chain")
    if len(ratio.wheels) != 2 or not all(size > 0 for _, size in ratio.wheels):
        problems.add(ratio.where, "it is not of two links with positive sizes", "name two links, each with a size")
        return None
    found = []
    for id_, _ in ratio.wheels:
        links = [link for link in joined.links if link.id == id_]
        gears = [link for link in links if link.gear] or links
        if len(gears) == 1 and not gears[0].actuator:
            found += gears
        else:
            said = f"{len(gears)} links have the id {id_}" if gears else f"link {id_} is not there"
            problems.add(ratio.where, said, "name two gears, each by an id of its own")
    return found if len(found) == 2 and ratio.kind in _KINDS else None


def _gear(
    key: str, ratio: LinkageRatio, wheels: tuple[str, str], carrier: str, axes: list[int], points: ConnectorPoints
) -> DrawnGear:
    """Return the pair. Gears by teeth or shares of the distance; a chain may be of radii as large as its sizes."""
    one, two = (size for _, size in ratio.wheels)
    is_chain = ratio.kind == "chain"
    in_teeth = one == round(one) and two == round(two) and not (is_chain and ratio.by_size)
    if is_chain and ratio.by_size:
        one, two = one * points.joined.file.scale, two * points.joined.file.scale
    elif not in_teeth:
        places = [points.joined.file.connectors[axis].at for axis in axes]
        share = abs(places[1] - places[0]) / (one + two)
        one, two = one * share, two * share
    kind = "belt" if is_chain else "gears"
    return DrawnGear(
        key,
        "belt" if kind == "belt" else "gears",
        *wheels,
        carrier,
        points.key(axes[0]),
        points.key(axes[1]),
        (one, two),
        in_teeth,
        where=ratio.where,
    )
