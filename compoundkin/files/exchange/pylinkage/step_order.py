"""The order in which pylinkage finds joints one after another, and entries of links that let it do so.

Its `step` finds a joint at its distances from the first two others that the links list with it, whether these have
moved already or not. So joints are listed in the order in which they are found. Where that does not suffice, a link is
written as bars: two joints and a bar between them, every further joint by bars to both, which is as rigid.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from compoundkin.files.exchange.pylinkage.pylinkage_layout import PylinkageLayout
from compoundkin.model.geometry import FRAME


@dataclass(frozen=True)
class LinkEntry:
    """A link of the file: its body, and the joints it lists. `is_crank` of the one that turns."""

    body: str
    joints: tuple[str, ...]
    is_crank: bool = False


def found_order(layout: PylinkageLayout) -> dict[str, int]:
    """Return the joints that are found from others, each with its turn.

    What is missing pylinkage cannot find.
    """
    known = {point: 0 for point in layout.of if layout.on_frame(point)}
    for _, tip in layout.cranks.values():
        known.setdefault(tip, len(known))
    waiting = [key for key in dict.fromkeys(j for own in layout.joints.values() for j in own) if key not in known]
    while ready := next(
        (key for key in waiting if _anchors(layout, key, known) >= (1 if key in layout.lines else 2)), ""
    ):
        known[ready] = len(known)
        waiting.remove(ready)
    return known


def link_entries(layout: PylinkageLayout, order: Mapping[str, int]) -> list[LinkEntry]:
    """Return the links to write, in an order that lets every joint be found."""
    last = len(order)
    ranked = {body: sorted(own, key=lambda key: order.get(key, last)) for body, own in layout.joints.items()}
    bars = {body for body in layout.cranks if len(ranked[body]) > 2}
    entries = _sorted(ranked, bars, layout, order)
    if layout.lines or layout.trackers or any(driver.travel for driver in layout.drawing.drivers):
        # else its solver looks for groups, and takes the links in any order
        while missed := {body for key in order for body in _missed(key, entries, layout, order)} - bars:
            bars |= missed
            entries = _sorted(ranked, bars, layout, order)
    return entries


def _anchors(layout: PylinkageLayout, key: str, known: Mapping[str, int]) -> int:
    """Count the joints known that a joint is at a distance from."""
    own = {other for joints in layout.joints.values() if key in joints for other in joints if other in known}
    return len(own - {key})


def _sorted(
    ranked: Mapping[str, list[str]], bars: set[str], layout: PylinkageLayout, order: Mapping[str, int]
) -> list[LinkEntry]:
    found = [entry for body, own in ranked.items() for entry in _entries(body, own, body in bars, layout)]
    last = len(order)
    return sorted(found, key=lambda entry: max(order.get(key, last) for key in entry.joints))


def _entries(body: str, own: list[str], as_bars: bool, layout: PylinkageLayout) -> Iterator[LinkEntry]:
    crank = layout.cranks.get(body)
    if not as_bars:
        if body not in layout.sliding or len(own) > 1:
            yield LinkEntry(body, crank or tuple(own), crank is not None)
        return
    first, second = crank or (own[0], next((key for key in own if layout.apart(key, own[0])), own[1]))
    yield LinkEntry(body, (first, second), crank is not None)
    for key in own:
        if key not in (first, second):
            yield LinkEntry(body, (first, key))
            yield LinkEntry(body, (second, key))


def _missed(key: str, entries: list[LinkEntry], layout: PylinkageLayout, order: Mapping[str, int]) -> Iterator[str]:
    """Yield the bodies that have to be written as bars, for a joint to be found from such as were found before."""
    if FRAME in layout.of[key] or any(key == tip for _, tip in layout.cranks.values()):
        return
    own = [entry for entry in entries if key in entry.joints]
    others = [other for entry in own for other in entry.joints if other != key]
    if any(order.get(other, len(order)) > order[key] for other in others[: 1 if key in layout.lines else 2]):
        yield from (entry.body for entry in own if len(entry.joints) > 2)
