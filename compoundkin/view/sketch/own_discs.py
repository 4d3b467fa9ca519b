"""Discs that a link has: its wheels, and its profiles, in which its bars are but thin spokes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.pairs.symbols import Outline, Track, Wheel
from compoundkin.view.sketch.scene import Scene

# A point is on a wheel if it is not farther outside than this part of its radius.
ON_RIM = 0.02


def is_inside(scene: Scene, link: str) -> bool:
    """Tell whether all points of a link are within a disc of its own."""
    own = np.array([complex(p) for p in scene.points[link].values()])
    return any(bool(np.all(inside)) for inside in _inside(scene, link, own))


def _inside(scene: Scene, link: str, own: Number) -> Iterator[Number]:
    """For each disc of a link, which of its points are within it."""
    for seen in scene.seen:
        mark = seen.mark
        if isinstance(mark, Wheel) and seen.members[mark.member] == link and not mark.is_ring:
            yield np.abs(own - complex(mark.at)) <= float(mark.radius) * (1.0 + ON_RIM)
        elif isinstance(mark, Outline) and seen.members[mark.member] == link and mark.closed and not mark.is_hollow:
            # a closed line goes once around a point within it
            line = np.append(mark.line, mark.line[:1])[:, None] - own
            with np.errstate(divide="ignore", invalid="ignore"):
                turned = np.angle(line[1:] / line[:-1]).sum(axis=0)
            yield np.abs(turned) > np.pi


def racks(scene: Scene) -> frozenset[str]:
    """Return the names of the links that carry a rack."""
    tracks = ((seen.members, seen.mark) for seen in scene.seen if isinstance(seen.mark, Track))
    return frozenset(members[mark.member] for members, mark in tracks if mark.pitch)


def smallest_wheel(scene: Scene, letter: str) -> float:
    """Return the least radius of the wheels about a point. It is infinite where there is none."""
    links = scene.mechanism.carriers[letter]
    return min(
        (
            float(seen.mark.radius)
            for seen in scene.seen
            if isinstance(seen.mark, Wheel)
            and (link := seen.members[seen.mark.member]) in links
            and abs(complex(seen.mark.at) - complex(scene.points[link][letter])) <= ON_RIM * float(seen.mark.radius)
        ),
        default=np.inf,
    )
