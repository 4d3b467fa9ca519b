"""Parts of a moving sketch as groups that are moved and turned."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.view.animation.keyframes import DEVIATION
from compoundkin.view.animation.svg_keyframes import Writer
from compoundkin.view.sketch.moving_sketch import MovingPart, MovingSketch
from compoundkin.view.sketch.shapes import Text, corners, leaves
from compoundkin.view.sketch.shifted_shapes import moved
from compoundkin.view.sketch.svg import elements

# A point stands still if it moves no farther, picture units.
STILL = 0.005
# A way of fewer letters than this is short enough.
SHORT = 400
# A link turns evenly if so few keyframes say how; only then is leading round it shorter.
FEW = 12


def part_lines(writer: Writer, sketch: MovingSketch, part: MovingPart) -> list[str]:
    """The elements of a part: moved with its point, and turned about it; the shortest of several ways to say so."""
    if part.link == FRAME:
        return list(elements(moved(part.shapes, complex(sketch.places(part)[0]))))
    if part.turns:
        part = _about_calm_point(sketch, part)
    inside, angles = list(elements(part.shapes)), _angles(sketch, part.link) if part.turns else None
    turned = inside if angles is None else writer.turned(angles, DEVIATION / _reach(part), inside)
    straight = writer.translated(sketch.places(part)[writer.timeline.poses], turned)
    if writer.one_by_one or sum(map(len, straight)) - sum(map(len, turned)) < SHORT:
        return straight
    return min([straight, *_led_round(writer, sketch, part, angles, inside)], key=lambda lines: sum(map(len, lines)))


def _led_round(
    writer: Writer, sketch: MovingSketch, part: MovingPart, angles: Number | None, inside: list[str]
) -> Iterator[list[str]]:
    """The same part led round fixed points by links that turn about these, as a coupler by a crank, and turned back."""
    scene, poses = sketch.scene, writer.timeline.poses
    for link, at in _carriers(sketch, part):
        pivot = _about_calm_point(sketch, MovingPart(link, at, ()))
        centres = sketch.places(pivot)
        if link == FRAME or np.max(np.abs(centres - centres[0])) > STILL:
            continue
        arm = complex(sketch.window.at(scene.at(link, at)) - sketch.window.at(scene.at(link, pivot.at)))
        led = _angles(sketch, link)
        # both turns are equally fine, so that what stays upright does so exactly
        fine = DEVIATION / (abs(arm) + _reach(part))
        if len(writer.turns(led, fine).times) > FEW:
            continue
        back = writer.turned(-led if angles is None else angles - led, fine, inside)
        arm_end = writer.translated(np.full(poses.shape, arm), back)
        yield writer.translated(centres[poses], writer.turned(led, fine, arm_end))


def _carriers(sketch: MovingSketch, part: MovingPart) -> list[tuple[str, complex]]:
    """The links that have the point of a part, and where it is on them."""
    own = sketch.scene.points
    letters = [letter for letter, p in own[part.link].items() if p == part.at]
    others = [(link, own[link][k]) for k in letters for link in sketch.scene.mechanism.carriers[k]]
    return list(dict.fromkeys([(part.link, part.at), *others]))


def _about_calm_point(sketch: MovingSketch, part: MovingPart) -> MovingPart:
    """The same part as seen from that point of its link which moves least, as a crank from its pivot."""
    points = [part.at, *sketch.scene.points[part.link].values()]
    ways = [float(np.sum(np.abs(np.diff(sketch.places(replace(part, at=p)))))) for p in points]
    at = points[int(np.argmin(np.round(ways, 3)))]
    off = sketch.window.at(sketch.scene.at(part.link, at)) - sketch.window.at(sketch.scene.at(part.link, part.at))
    return replace(part, at=at, shapes=tuple(moved(part.shapes, -complex(off))))


def _reach(part: MovingPart) -> float:
    """How far the farthest corner of a part is from its point, picture units."""
    texts = [shape.at for shape in leaves(part.shapes) if isinstance(shape, Text)]
    return max([1.0, *(abs(corner) for corner in (*corners(part.shapes), *texts))])


def _angles(sketch: MovingSketch, link: str) -> Number:
    """By how much a link is turned on the picture, clockwise there, radians counted over full turns, (poses,)."""
    whole, here = sketch.scene.whole[link].theta, sketch.scene.here[link].theta
    if whole is None or here is None:
        return np.unwrap(np.angle(sketch.turns(link)))
    return np.broadcast_to(here.c[0] - whole.c[0], (sketch.scene.count,)).astype(float)
