"""What is to be seen of a model: a bar between the points of each link, blocks, pins of the frame, guides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.series import Series
from compoundkin.files.exchange.mjcf.elementary_joints import JointChain
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan
from compoundkin.files.exchange.shortest_numbers import shortest
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.symbols import Wheel

# Half the width of a bar, by the mechanism's size; links lie on each other, so much from one to the next.
_HALF_WIDTH, _LAYER = 0.012, 0.03
# Points nearer to each other than this part of the size are no bar.
_NO_BAR = 1e-6
_DISC, _RING = "0.3 0.5 0.7 0.35", "0.3 0.3 0.3 0.12"
_FRAME_COLOUR = "0.45 0.45 0.45 1"
_COLOURS = ("0.12 0.47 0.71 1", "0.89 0.47 0.12 1", "0.17 0.63 0.17 1", "0.84 0.15 0.16 1", "0.58 0.40 0.74 1",
            "0.55 0.34 0.29 1", "0.09 0.75 0.81 1", "0.74 0.74 0.13 1")  # fmt: skip


def add_shapes(plan: ModelPlan, bodies: Mapping[str, Element]) -> None:
    """Add to each link's body what is to be seen of it."""
    for k, (link, body) in enumerate(bodies.items()):
        colour = _COLOURS[(k - 1) % len(_COLOURS)] if k else _FRAME_COLOUR
        for words in _frame_shapes(plan) if link == FRAME else _link_shapes(plan, link):
            SubElement(body, "geom", {**words, "rgba": colour})
    for chain in (*(own.chain for own, _ in plan.bodies.values()), *plan.connected):
        guide = _guide(plan, chain)
        if guide is not None:
            SubElement(bodies[chain.members[0]], "geom", guide)
    for pair in plan.shown.pairs:
        for link, words in _wheels(plan, pair):
            SubElement(bodies[link], "geom", words)


def _wheels(plan: ModelPlan, pair: Pair) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield a pair's wheels as thin discs that one can see through."""
    poses = tuple(plan.shown.poses[name].mapped(_along_a_motion) for name in pair.members)
    marks = pair.glyph(plan.shown.ends[pair.name], poses)
    for mark in (mark for mark in marks if isinstance(mark, Wheel)):
        radius, link = float(first_entry(mark.radius)), pair.members[mark.member]
        if not radius:
            continue
        height = plan.layer(link) * _LAYER * plan.size
        size = f"{shortest(radius * plan.units.length)} {shortest(0.3 * _HALF_WIDTH * plan.size)}"
        at = _at(complex(first_entry(mark.at)) * plan.units.length, height)
        yield link, {"type": "cylinder", "pos": at, "size": size, "rgba": _RING if mark.is_ring else _DISC}


def _along_a_motion(series: Series) -> Series:
    """Return a series at one pose as one over a motion of it."""
    return Series(tuple(np.atleast_1d(part) for part in series.c[:1]))


def _link_shapes(plan: ModelPlan, link: str) -> Iterator[dict[str, str]]:
    """Yield bars around a link's points, or a block at its only one."""
    points = [own * plan.units.length for own in plan.shown.points[link].values()]
    height = plan.layer(link) * _LAYER * plan.size
    around = list(zip(points, [*points[1:], points[0]], strict=True)) if len(points) > 2 else [tuple(points)]
    bars = [two for two in around if len(two) == 2 and abs(two[1] - two[0]) > _NO_BAR * plan.size]
    for one, other in bars:
        yield _bar(one, other, height, _HALF_WIDTH * plan.size)
    if not bars:
        at = points[0] if points else 0j
        along = next((joint.axis for joint in plan.tree.carried[link].joints if not joint.is_hinge), 1 + 0j)
        turn = along * complex(plan.pose(link).u.c[0]).conjugate()
        size = " ".join(shortest(part * _HALF_WIDTH * plan.size) for part in (3.0, 2.0, 1.0))
        yield {"type": "box", "pos": _at(at, height), "size": size, "euler": f"0 0 {shortest(float(np.angle(turn)))}"}


def _frame_shapes(plan: ModelPlan) -> Iterator[dict[str, str]]:
    for own in plan.shown.points[FRAME].values():
        radius = shortest(1.6 * _HALF_WIDTH * plan.size)
        yield {"type": "sphere", "pos": _at(own * plan.units.length, 0.0), "size": radius}


def _guide(plan: ModelPlan, chain: JointChain) -> dict[str, str] | None:
    """Return the line on which a slide's block runs, as far as the motion uses it."""
    first, second = chain.members
    slide = chain.joints[0]
    if slide.is_hinge:
        return None
    pair, motion = chain.pair, plan.shown.motion
    ends = plan.shown.ends[pair.name]
    if motion is None:
        return None
    ways = np.ravel(pair.coordinate(ends, tuple(motion.poses[name] for name in (first, second))).c[0])
    now = float(pair.coordinate(ends, tuple(plan.shown.poses[name] for name in (first, second))).c[0])
    back = complex(plan.pose(first).u.c[0]).conjugate() * slide.axis
    middle = plan.pose(first).inverse().at(plan.shown.place(second, complex(ends[1].point))).c[0]
    low, high = (complex(middle + back * (way - now)) * plan.units.length for way in (np.nanmin(ways), np.nanmax(ways)))
    if abs(high - low) <= _NO_BAR * plan.size:
        return None
    height = plan.layer(first) * _LAYER * plan.size
    return {**_bar(low, high, height, 0.4 * _HALF_WIDTH * plan.size), "rgba": _FRAME_COLOUR}


def _bar(one: complex, other: complex, height: float, radius: float) -> dict[str, str]:
    return {"type": "capsule", "fromto": f"{_at(one, height)} {_at(other, height)}", "size": shortest(radius)}


def _at(place: complex, height: float) -> str:
    return f"{shortest(place.real)} {shortest(place.imag)} {shortest(height)}"
