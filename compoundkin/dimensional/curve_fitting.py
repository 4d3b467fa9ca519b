"""Designs refined to a curve: Levenberg's steps of many at once, with the slopes of their programs.

At each step every place of the target is held against the nearest place of the curve and every place of the curve
against the nearest of the target, along the normals there (Y. Chen and G. Medioni, Object modelling by registration of
multiple range images, Image Vision Comput. 10 (1992) 145-155); the first steps hold places at equal parts of the arcs
against each other, so that a curve comes near as a whole. Rotation, size and place are unknowns like the dimensions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number, unwrapped
from compoundkin.dimensional.candidates import POINT, Candidates, Linkage
from compoundkin.dimensional.coupler_atlas import AtlasMatch, coupler_atlas, mean_distance, resampled
from compoundkin.dimensional.curve_chains import CRANK, GUIDE_OFFSET, CurveChain, guide
from compoundkin.dimensional.tasks import CurveTask
from compoundkin.kinematics import solve
from compoundkin.model.attributes import POSITION
from compoundkin.model.elements import Item, link
from compoundkin.model.geometry import FRAME

# Designs of the atlas, how many of them are refined, how many answers are given, and more of four links.
DESIGNS, STARTED, GIVEN, SIMPLE = 200_000, 200, 8, 2
# Lengths that differ by less than this part make no other linkage.
ALIKE = 0.02
# Positions over a turn at which a refined linkage is handed on.
POSITIONS = 12
# Poses of a curve, and places of its target.
POSES, PLACES = 128, 128
# Steps with places by arc length, steps of all designs to the nearest places, and more steps of the best so many.
EARLY, FIRST_STEPS, STEPS, BEST = 12, 15, 60, 32
# The first weight of Levenberg's term, how it shrinks and grows, its least, and where a design is given up.
FIRST, EASIER, HARDER, LEAST, HOPELESS = 1e-2, 0.3, 4.0, 1e-7, 1e5
# Added to the diagonal: sizes of chains without a fixed length are free. No number goes farther in a step.
FLOOR, FARTHEST = 1e-6, 0.5
# The part of residuals along the curve: it keeps places from gliding without end.
ALONG = 0.1
# Added to lengths that are divided by, in the target's RMS radius.
NO_LENGTH = 1e-12


class FittedCurve(NamedTuple):
    """A design laid on a curve by ``scale * z + place``, then mirrored at the x axis if `mirrored`.

    `apart` is the mean nearest distance both ways, summed, in the target's RMS radius.
    """

    chain: CurveChain
    design: Number
    scale: complex
    place: complex
    mirrored: bool
    apart: float

    def as_seen(self, z: Any) -> Any:
        """Return vectors as they are, or mirrored."""
        return np.conj(z) if self.mirrored else z

    def laid(self, z: Any) -> Any:
        """Return places of the chain where they lie on the curve."""
        return self.as_seen(self.scale * z + self.place)

    def turned(self, u: Any) -> Any:
        """Return orientations of links of the chain as they are on the curve."""
        return self.as_seen(self.scale / abs(self.scale) * u)


class _Designs(NamedTuple):
    """Designs of one chain that are refined together to a target, of RMS radius one about zero, perhaps mirrored.

    `x` are their numbers, then the logarithm of the scale, its angle and the place, (designs, numbers + 4).
    """

    chain: CurveChain
    mirrored: bool
    target: Number
    x: Number

    def refined(self, steps: int, early: bool = False) -> tuple[_Designs, Number]:
        """Return them after so many steps, and the sum of squares of each; `early` ones are by the arc's length."""
        x = self.x.copy()
        r, j, _ = _residuals(self.chain, x, self.target, early)
        damping = np.full(len(x), FIRST)
        for _ in range(steps):
            alive = np.flatnonzero(damping < HOPELESS)
            if not len(alive):
                break
            step = _levenberg(r[alive], j[alive], damping[alive])
            ahead = x[alive] - np.clip(step, -FARTHEST, FARTHEST)
            tried, steep, clear = _residuals(self.chain, ahead, self.target, early)
            better = clear & ((tried**2).sum(axis=1) < (r[alive] ** 2).sum(axis=1))
            to = alive[better]
            x[to], r[to], j[to] = ahead[better], tried[better], steep[better]
            damping[alive] = np.clip(damping[alive] * np.where(better, EASIER, HARDER), LEAST, 2.0 * HOPELESS)
        return self._replace(x=x), (r**2).sum(axis=1)


def traced(task: CurveTask) -> Candidates:
    """Return linkages of at most `task.links` links whose driver turns fully and whose point traces the task's curve.

    Designs of the atlas with the nearest curves are refined; the best are given, none like another.
    """
    atlas = coupler_atlas(task.links, DESIGNS)
    found = fitted(atlas.near(task.closed_curve, STARTED), task.closed_curve)
    different = list[Linkage]()
    # those of four links too, which are seldom among the best
    for among, count in ((found, GIVEN), ([one for one in found if one.chain.links == 4], GIVEN + SIMPLE)):
        for one in among:
            if len(different) == count:
                break
            made = linkage_of(one, task)
            if all(_unlike(made, other) for other in different):
                different.append(made)
    complete = f"the best {len(different)} of {len(atlas)} designs of {len(atlas.chains)} chains, refined"
    return Candidates(different, complete, is_family=True)


def linkage_of(one: FittedCurve, task: CurveTask) -> Linkage:
    """Return a refined design as a linkage in the place and units of its curve, at positions over a whole turn."""
    dimensions = {name: value[0, 0] for name, value in one.chain.dimensions(one.design[None]).items()}
    own = one.chain.program.mechanism(dimensions)
    angles = np.arange(POSITIONS) * (TURN / POSITIONS)
    motion = solve(own, {CRANK: angles}, modes=one.chain.program.modes, order=0)
    size = abs(one.scale)
    z = {name: one.laid(np.ravel(pose.z.c[0]) + np.zeros(POSITIONS)) for name, pose in motion.poses.items()}
    u = {name: one.turned(np.ravel(pose.u.c[0]) + np.zeros(POSITIONS)) for name, pose in motion.poses.items()}
    z[FRAME], u[FRAME] = np.zeros(POSITIONS, complex), np.ones(POSITIONS, complex)
    points = {
        name: {letter: complex(one.laid(p) if name == FRAME else one.as_seen(size * p)) for letter, p in each.items()}
        for name, each in own.geometry.points.items()
    }
    pairs = list[Item]()
    if GUIDE_OFFSET in dimensions:
        offset = size * float(dimensions[GUIDE_OFFSET])
        pairs.append(guide(float(np.angle(one.turned(1.0))), -offset if one.mirrored else offset))
    joints = [[p for letter, p in each.items() if letter != POINT] for name, each in points.items() if name != FRAME]
    return Linkage(
        title=own.title,
        links=tuple(link(name, **each) for name, each in points.items()),
        pairs=tuple(pairs),
        places={letter: complex(one.laid(np.ravel(point.position)[0])) for letter, point in motion.points.items()},
        z=z,
        u=u,
        drivers={CRANK: unwrapped(np.angle(u[CRANK]))},
        pivots=tuple(points[FRAME].values()),
        lengths=tuple(abs(b - a) for each in joints for a, b in combinations(each, 2)),
        error=one.apart * task.radius / 2.0,
        outputs=(f"{POINT}.{POSITION}",),
        source="an atlas of coupler curves, refined",
    )


def _unlike(one: Linkage, other: Linkage) -> bool:
    """Return whether two linkages are of different chains, or of other sizes."""
    if one.title != other.title or len(one.lengths) != len(other.lengths):
        return True
    return not np.allclose(one.lengths, other.lengths, rtol=ALIKE)


def fitted(matches: Sequence[AtlasMatch], curve: Number) -> list[FittedCurve]:
    """Return the best designs of some matches refined to a closed curve (places,), the nearest first."""
    target = resampled(curve[None], PLACES)[0]
    middle, first = complex(target.mean()), np.fft.fft(target)[[1, -1]]
    # turned by its greater first harmonic: what is found does not depend on how a curve lies
    turn = complex(first[np.abs(first).argmax()])
    size = complex(np.sqrt(np.mean(np.abs(target - middle) ** 2)) * (turn / abs(turn) if turn else 1.0))
    target = (target - middle) / size
    parts = [part.refined(EARLY, early=True)[0].refined(FIRST_STEPS) for part in _begun(matches, target)]
    costs = np.sort(np.concatenate([cost for _, cost in parts])) if parts else np.zeros(0)
    found = list[FittedCurve]()
    for part, cost in parts:
        # the best of all, and the best of its chain
        best = (cost <= costs[:BEST][-1]) | (cost == cost.min())
        found += _laid(part._replace(x=part.x[best]).refined(STEPS)[0], size, middle)
    return sorted(found, key=lambda one: one.apart)


def _begun(matches: Sequence[AtlasMatch], target: Number) -> Iterator[_Designs]:
    """Yield matches by their chains, mirrored or not, as they are laid on the target."""
    for chain in dict.fromkeys(match.chain for match in matches):
        for mirrored in (False, True):
            own = [match.design for match in matches if match.chain is chain and match.mirrored == mirrored]
            if not own:
                continue
            designs, wanted = np.array(own, float), np.conj(target) if mirrored else target
            curves, clear = chain.curves(designs, POSES)
            if not clear.any():  # more poses come nearer to limits than those of the atlas
                continue
            laid = [_best_laid(z, wanted) for z in resampled(curves[clear], PLACES)]
            unknown = [[np.log(abs(scale)), np.angle(scale), place.real, place.imag] for scale, place in laid]
            x = np.hstack([designs[clear], np.array(unknown)])
            yield _Designs(chain, mirrored, wanted, x)


def _best_laid(z: Number, target: Number) -> tuple[complex, complex]:
    """Return scale and place that lay a curve on the target, from the best of all starts and in the better sense."""
    middle = z.mean()
    own, best = np.fft.fft(z - middle), 0j
    for sense in (own, own[(-np.arange(len(z))) % len(z)]):
        found = np.fft.ifft(np.fft.fft(target) * np.conj(sense))
        best = max(best, found[np.abs(found).argmax()], key=abs)
    scale = complex(best) / float(np.sum(np.abs(z - middle) ** 2))
    return scale, complex(target.mean() - scale * middle)


def _laid(part: _Designs, size: complex, middle: complex) -> Iterator[FittedCurve]:
    """Yield refined designs in the units and at the place of the curve."""
    curves, clear = part.chain.curves(part.x[:, :-4], 4 * POSES)
    size, middle = (np.conj(each) if part.mirrored else each for each in (size, middle))
    for x, z in zip(part.x[clear], curves[clear], strict=True):
        scale, place = complex(np.exp(complex(x[-4], x[-3]))), complex(x[-2], x[-1])
        apart = mean_distance(scale * z + place, part.target)
        yield FittedCurve(part.chain, x[:-4], scale * size, place * size + middle, part.mirrored, apart)


def _levenberg(r: Number, j: Number, damping: Number) -> Number:
    """Return the steps (designs, numbers) that residuals ask for."""
    across = np.swapaxes(j, 1, 2)
    normal, slope = across @ j, across @ r[:, :, None]
    diagonal, more = np.arange(normal.shape[1]), 1.0 + damping[:, None]
    normal[:, diagonal, diagonal] = (normal[:, diagonal, diagonal] + FLOOR) * more
    return np.linalg.solve(normal, slope)[:, :, 0]


def _residuals(chain: CurveChain, x: Number, target: Number, early: bool) -> tuple[Number, Number, Number]:
    """Return residuals (designs, n), slopes (designs, n, numbers) and which designs are clear."""
    z, by, by_crank, clear = chain.slopes(x[:, :-4], POSES)
    if not clear.all():  # what is not clear means nothing, and is not taken
        z, by, by_crank = (np.where(clear[:, None], each, 1.0) for each in (z, by, by_crank))
    scale, place = np.exp(x[:, [-4]] + 1j * x[:, [-3]]), x[:, [-2]] + 1j * x[:, [-1]]
    turned = scale * z
    w = turned + place
    slopes = np.concatenate([scale * by, np.array([turned, 1j * turned, np.ones_like(w), np.full_like(w, 1j)])])
    length = np.abs(np.roll(w, -1, 1) - w) + NO_LENGTH
    if early:
        own = w - target[_by_arc(w, length, target)]
        steep = np.concatenate([slopes.real, slopes.imag], axis=2)
        return np.concatenate([own.real, own.imag], axis=1), np.moveaxis(steep, 0, 2), clear
    apart = w[:, :, None] - target
    square = apart.real**2 + apart.imag**2
    rows, at, nearest = np.arange(len(w))[:, None], square.argmin(axis=1), square.argmin(axis=2)
    tangent, ahead = scale * by_crank, np.roll(target, -1) - np.roll(target, 1)
    # each pose counts by its part of the arc, as if they lay evenly along it
    share = np.sqrt((length + np.roll(length, 1, 1)) / (2.0 * length.sum(axis=1, keepdims=True)) * POSES)
    parts, steeps = list[Number](), list[Number]()
    for own, t, slope, weight in (
        (w[rows, at] - target, tangent[rows, at], slopes[:, rows, at], 1.0),
        (w - target[nearest], ahead[nearest], slopes, share),
    ):
        across = weight * np.conj(t) / (np.abs(t) + NO_LENGTH)
        turned_r, turned_j = own * across, slope * across
        parts += [turned_r.imag, ALONG * turned_r.real]
        steeps += [turned_j.imag, ALONG * turned_j.real]
    return np.concatenate(parts, axis=1), np.moveaxis(np.concatenate(steeps, axis=2), 0, 2), clear


def _by_arc(w: Number, length: Number, target: Number) -> Number:
    """Return the places of the target that lie at equal parts of its arc with poses, from the best start."""
    n = len(target)
    along = (np.cumsum(length, axis=1) - length) / length.sum(axis=1, keepdims=True)
    index, starts = np.round(along * n).astype(int), np.arange(0, n, 4)[:, None, None]
    choices = np.concatenate([starts + index, starts - index]) % n
    gaps = (np.abs(w - target[choices]) ** 2 * length).sum(axis=2)
    return choices[gaps.argmin(axis=0), np.arange(len(w))]
