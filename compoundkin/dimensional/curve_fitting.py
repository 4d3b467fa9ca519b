"""Designs refined to a curve: Levenberg's steps of many at once, with the slopes of their programs.

At each step every place of the target is held against the nearest place of the curve and every place of the curve
against the nearest of the target, along the normals there (Y. Chen and G. Medioni, Object modelling by registration of
multiple range images, Image Vision Comput. 10 (1992) 145-155); the first steps hold places at equal parts of the arcs
against each other, so that a curve comes near as a whole. Rotation, size and place are unknowns like the dimensions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.dimensional.candidates import Candidates, Linkage
from compoundkin.dimensional.coupler_atlas import AtlasMatch, best_laid, coupler_atlas, mean_distance, resampled
from compoundkin.dimensional.curve_chains import CurveChain, Laying, turn
from compoundkin.dimensional.defects import SolvedLinkage, judged
from compoundkin.dimensional.tasks import Conditions, CurveTask

# Designs of the atlas, how many of them are refined, how many answers are given beside so many of each number of links,
# and how many of one kind of linkage while others are there.
DESIGNS, STARTED, GIVEN, SIMPLE, OF_A_KIND = 200_000, 200, 6, 2, 3
# Lengths that differ by less than this part make no other linkage.
ALIKE = 0.1
# Rounds in which what remains farther than this sum of squares is moved and grown.
ROUNDS, NEAR = 3, 2e-4
# How many of the best are moved, to how many places each, and how far, from and to.
MOVED, MOVES, MOVED_BY = 8, 8, (0.02, 0.4)
# How many of the best grow, not more of a chain than this; the dyads that are drawn for each pair of links and mode,
# and how many of the most promising are taken of each, and of all.
GROWN, OF_A_CHAIN, DRAWN, TAKEN, MOST_TAKEN = 5, 2, 256, 3, 10
# How many designs of a number of links are kept from a round; which are the same.
KEPT, SAME = 24, 1e-6
# The weight of the ends of an open curve; the least part of the turn that traces it.
ENDS, LEAST_TURN = 2.0, 0.3
# Positions over a turn at which a refined linkage is handed on.
POSITIONS = 12
# Poses of a curve, and places of its target.
POSES, PLACES = 128, 128
# Steps with places by arc length, none in later rounds; steps of all designs to the nearest places, more steps of the
# best so many, and the last of what is given.
EARLY, FIRST_STEPS, STEPS, BEST, LAST = 12, 15, 40, 24, 40
# The first weight of Levenberg's term, how it shrinks and grows, its least, and where a design is given up.
FIRST, EASIER, HARDER, LEAST, HOPELESS = 1e-2, 0.3, 4.0, 1e-7, 1e5
# A step that gains less than this part counts as a failed one.
SETTLED, SLOWER = 1e-4, 30.0
# Added to the diagonal: sizes of chains without a fixed length are free. No number goes farther in a step.
FLOOR, FARTHEST = 1e-6, 0.5
# The part of residuals along the curve: it keeps places from gliding without end.
ALONG = 0.1
# Added to lengths that are divided by, in the target's RMS radius.
NO_LENGTH = 1e-12


class FittedCurve(NamedTuple):
    """A design laid on a curve.

    `apart` is the mean nearest distance both ways, summed, in the target's RMS radius, `error` half of that in the
    target's units. An open curve is traced while the crank turns from `window[0]` by `window[1]`.
    """

    chain: CurveChain
    design: Number
    laying: Laying
    apart: float
    error: float
    window: tuple[float, float] | None = None

    @property
    def linkage(self) -> Linkage:
        """The linkage at positions over a whole turn, or over the part of it that traces an open curve."""
        angles = turn(POSITIONS)
        if self.window is not None:
            angles = self.window[0] + self.window[1] * np.linspace(0.0, 1.0, POSITIONS)
        return self.chain.linkage(self.design, self.laying, angles, self.error)


class CurveTarget(NamedTuple):
    """A curve that designs are refined to: `places` (PLACES,) evenly along it, of RMS radius one about zero.

    It is ``size * places + middle``; an open one is traced by a part of the turn.
    """

    places: Number
    closed: bool
    size: complex
    middle: complex

    @classmethod
    def of(cls, curve: Number, closed: bool) -> CurveTarget:
        """Return the target of a curve, turned by its greater first harmonic: nothing depends on how a curve lies."""
        places = resampled(curve[None], PLACES, closed)[0]
        middle, first = complex(places.mean()), np.fft.fft(places)[[1, -1]]
        turn = complex(first[np.abs(first).argmax()])
        size = complex(np.sqrt(np.mean(np.abs(places - middle) ** 2)) * (turn / abs(turn) if turn else 1.0))
        return cls((places - middle) / size, closed, size, middle)

    @property
    def mirrored(self) -> CurveTarget:
        """Its mirror image."""
        return self._replace(places=np.conj(self.places))

    @property
    def laying(self) -> int:
        """How many unknowns lay a design on it: size, angle and place; of an open one also which part traces it."""
        return 4 if self.closed else 6


class _RefinedDesigns(NamedTuple):
    """Designs of one chain that are refined together to a target, perhaps mirrored.

    `x` are their numbers, of an open target the crank's angle at its begin and the turn from there, then the logarithm
    of the scale, its angle and the place, (designs, numbers + laying). `cost` is the sum of squares (designs,).
    """

    chain: CurveChain
    mirrored: bool
    target: CurveTarget
    x: Number
    cost: Number

    def refined(self, steps: int, early: bool = False) -> _RefinedDesigns:
        """Return them after so many steps; `early` ones are by the arc's length."""
        x = self.x.copy()
        r, j, clear = _residuals(self.chain, x, self.target, early)
        cost = np.where(clear, (r**2).sum(axis=1), np.inf)
        damping = np.full(len(x), FIRST)
        for _ in range(steps):
            alive = np.flatnonzero(damping < HOPELESS)
            if not len(alive):
                break
            step = _levenberg(r[alive], j[alive], damping[alive])
            ahead = x[alive] - np.clip(step, -FARTHEST, FARTHEST)
            tried, steep, clear = _residuals(self.chain, ahead, self.target, early)
            costs = (tried**2).sum(axis=1)
            better = clear & (costs < cost[alive])
            gain = 1.0 - costs[better] / cost[alive][better]
            to = alive[better]
            x[to], r[to], j[to], cost[to] = ahead[better], tried[better], steep[better], costs[better]
            damping[alive] = np.clip(damping[alive] * np.where(better, EASIER, HARDER), LEAST, 2.0 * HOPELESS)
            damping[to[gain < SETTLED]] *= SLOWER
        return self._replace(x=x, cost=cost)

    def best(self, kept: Number) -> _RefinedDesigns:
        """Return some of them."""
        return self._replace(x=self.x[kept], cost=self.cost[kept])


def traced(task: CurveTask) -> Candidates:
    """Return linkages of at most `task.links` links whose driver turns fully and whose point traces the task's curve.

    Designs of the atlas with the nearest curves are refined and grow; the best are given, none like another, and of
    each number of links the best.
    """
    atlas = coupler_atlas(min(task.links, 6), DESIGNS)
    wanted = task.conditions
    limits = {"region": wanted.region, "transmission": wanted.transmission}
    matches = atlas.near(task.points, STARTED, closed=task.closed, **limits)
    if not matches:  # what comes near without them is told, with what it misses
        matches = atlas.near(task.points, STARTED, closed=task.closed)
    found = fitted(matches, task.points, task.closed, task.links)
    different = list[Linkage]()
    # of each number of links, though fewer are seldom the nearest
    for links in sorted({one.chain.links for one in found}):
        different += _different([one for one in found if one.chain.links == links], SIMPLE, different)
    different += _different(found, GIVEN, different, wanted)
    complete = f"the best {len(different)} of {len(atlas)} designs of {len(atlas.chains)} chains, refined"
    if task.links > 6:
        complete += " and grown"
    return Candidates(different, complete, is_family=True)


def _different(
    found: Sequence[FittedCurve], count: int, others: Sequence[Linkage], wanted: Conditions | None = None
) -> list[Linkage]:
    """Return so many of the best as linkages, none like another or like others, few of one kind before all kinds.

    Where conditions are given, they fulfil them.
    """
    different, rest = list[Linkage](), list[Linkage]()
    for made in (one.linkage for one in found):
        if len(different) == count:
            break
        if any(not _unlike(made, other) for other in (*others, *different, *rest)):
            continue
        if wanted is None or isinstance(judged(made, wanted, np.inf), SolvedLinkage):
            kinds = [other.title for other in (*others, *different)]
            (different if kinds.count(made.title) < OF_A_KIND else rest).append(made)
    return different + rest[: count - len(different)]


def _unlike(one: Linkage, other: Linkage) -> bool:
    """Return whether two linkages are of different chains, or of other sizes."""
    if one.title != other.title or len(one.lengths) != len(other.lengths):
        return True
    return not np.allclose(one.lengths, other.lengths, rtol=ALIKE)


def fitted(
    matches: Sequence[AtlasMatch], curve: Number, closed: bool = True, links: int = 6, rounds: int | None = None
) -> list[FittedCurve]:
    """Return the best designs of some matches refined to a curve (places,), the nearest first.

    Where they remain far, those of fewer links than `links` grow by dyads, and the best are moved and refined again, in
    so many `rounds`; in zero for whoever waits for a first answer.
    """
    target = CurveTarget.of(curve, closed)
    found = _best(_refined(_begun(matches, target)))
    rng = np.random.default_rng(0)
    for _ in range(ROUNDS if rounds is None else rounds):
        if not found or min(part.cost.min() for part in found) < NEAR:
            break
        found = _best([*found, *_refined(_moved(found, rng), 0), *_refined(_grown(found, links, rng), 0)])
    return sorted((one for part in found for one in _laid(part.refined(LAST))), key=lambda one: one.apart)


def _refined(begun: Iterable[_RefinedDesigns], early: int = EARLY) -> list[_RefinedDesigns]:
    """Return designs refined, the best of all and the best of each chain and sense to the end."""
    parts = [part.refined(EARLY, early=True) if early else part for part in begun]
    parts = [part.refined(FIRST_STEPS) for part in parts]
    costs = np.sort(np.concatenate([part.cost for part in parts])) if parts else np.zeros(0)
    return [part.best((part.cost <= costs[:BEST][-1]) | (part.cost == part.cost.min())).refined(STEPS)
            for part in parts]  # fmt: skip


def _best(parts: Sequence[_RefinedDesigns]) -> list[_RefinedDesigns]:
    """Return the best designs of each number of links, and of each chain its best, none twice."""
    found = list[_RefinedDesigns]()
    for links in sorted({part.chain.links for part in parts}):
        own = [part for part in parts if part.chain.links == links]
        least = np.sort(np.concatenate([part.cost for part in own]))[:KEPT][-1]
        for chain, mirrored in dict.fromkeys((part.chain, part.mirrored) for part in own):
            same = [part for part in own if part.chain is chain and part.mirrored == mirrored]
            x, cost = np.concatenate([part.x for part in same]), np.concatenate([part.cost for part in same])
            order = np.argsort(cost, kind="stable")
            apart = np.append(True, np.abs(np.diff(x[order], axis=0)).max(axis=1) > SAME)
            order = order[apart & ((cost[order] <= least) | (np.arange(len(order)) == 0)) & np.isfinite(cost[order])]
            if len(order):
                found.append(same[0]._replace(x=x[order], cost=cost[order]))
    return found


def _nearest(parts: Sequence[_RefinedDesigns], count: int) -> Iterator[_RefinedDesigns]:
    """Yield the best designs of all, one by one, not many of a chain."""
    order = sorted((part.cost[k], n, k) for n, part in enumerate(parts) for k in range(min(len(part.x), OF_A_CHAIN)))
    for _, n, k in order[:count]:
        yield parts[n].best(np.array([k]))


def _moved(found: Sequence[_RefinedDesigns], rng: np.random.Generator) -> Iterator[_RefinedDesigns]:
    """Yield the best designs, each moved to several places about."""
    for one in _nearest(found, MOVED):
        low, high = np.log(MOVED_BY)
        far = np.exp(low + (high - low) * rng.random((MOVES, 1)))
        around = one.x + far * rng.standard_normal((MOVES, one.x.shape[1]))
        _, clear = one.chain.curves(around[:, : len(one.chain.numbers)], POSES)
        if clear.any():
            yield one._replace(x=around[clear], cost=np.full(clear.sum(), np.inf))


def _grown(found: Sequence[_RefinedDesigns], links: int, rng: np.random.Generator) -> Iterator[_RefinedDesigns]:
    """Yield the best designs with a dyad more: of many dyads those that promise most by their first step."""
    for one in _nearest([part for part in found if part.chain.links < links], GROWN):
        promises = list[tuple[float, CurveChain, Number]]()
        for second in one.chain.carriers:
            for sign in (1, -1):
                larger = one.chain.grown(second, sign)
                gains, designs = _promised(one, larger, rng.random((DRAWN, len(larger.numbers))))
                promises += [(gains[k], larger, designs[k]) for k in np.argsort(-gains)[:TAKEN]]
        taken = sorted(promises, key=lambda each: -each[0])[:MOST_TAKEN]
        for larger in dict.fromkeys(chain for _, chain, _ in taken):
            designs = np.array([design for _, chain, design in taken if chain is larger])
            x = np.hstack([designs, np.repeat(one.x[:, len(one.chain.numbers) :], len(designs), axis=0)])
            yield _RefinedDesigns(larger, one.mirrored, one.target, x, np.full(len(x), np.inf))


def _promised(one: _RefinedDesigns, larger: CurveChain, units: Number) -> tuple[Number, Number]:
    """Return by how much a first step of designs with a dyad more lowers the sum of squares, and those designs.

    Only P's two coordinates on the new rod are new to the curve, and by them it moves as the rod turns.
    """
    n = len(one.chain.numbers)
    designs = one.chain.grown_designs(larger, np.repeat(one.x[:, :n], len(units), axis=0), units)
    ahead = designs.copy()
    ahead[:, -2] += 1.0  # P one along the rod
    r, old, clear = _residuals(one.chain, one.x, one.target, False)
    angles = _angles(one.chain, one.x, one.target)[0]
    z, _ = one.chain.places(one.x[:, :n], angles)
    _, turns = larger.curves(designs, POSES)
    designs, ahead = designs[turns], ahead[turns]
    if not len(designs) or not clear.all():
        return np.zeros(0), designs
    moved, clear = larger.places(ahead, angles)
    scale, place = np.exp(complex(one.x[0, -4], one.x[0, -3])), complex(one.x[0, -2], one.x[0, -1])
    way = scale * (moved - z)
    w = np.repeat(scale * z + place, len(designs), axis=0)
    tangent = scale * np.repeat(_traced(one.chain, one.x, one.target)[2], len(designs), axis=0)
    _, new = _gaps(w, tangent, np.array([way, 1j * way]), one.target)
    across = np.linalg.qr(old[0])[0]
    new = new - across @ (across.T @ new)
    normal = np.swapaxes(new, 1, 2) @ new
    normal[:, [0, 1], [0, 1]] = normal[:, [0, 1], [0, 1]] * (1.0 + FIRST) + FLOOR
    slope = np.swapaxes(new, 1, 2) @ r[0]
    gains = (slope * np.linalg.solve(normal, slope[:, :, None])[:, :, 0]).sum(axis=1)
    return gains[clear], designs[clear]


def _begun(matches: Sequence[AtlasMatch], target: CurveTarget) -> Iterator[_RefinedDesigns]:
    """Yield matches by their chains, mirrored or not, as they are laid on the target."""
    for chain in dict.fromkeys(match.chain for match in matches):
        for mirrored in (False, True):
            own = [match for match in matches if match.chain is chain and match.laying.mirrored == mirrored]
            if not own:
                continue
            designs = np.array([match.design for match in own], float)
            curves, clear = chain.curves(designs, POSES)
            if not clear.any():  # more poses come nearer to limits than those of the atlas
                continue
            wanted = target.mirrored if mirrored else target
            x = [[*designs[k], *_unknowns(curves[k], wanted, own[k].part)] for k in np.flatnonzero(clear)]
            yield _RefinedDesigns(chain, mirrored, wanted, np.array(x), np.full(len(x), np.inf))


def _unknowns(z: Number, target: CurveTarget, part: tuple[float, float] | None) -> list[float]:
    """Return the unknowns that lay a curve, or a part of it, on the target."""
    scale, place, window = best_laid(z, target.places, part)
    return [*window, float(np.log(abs(scale))), float(np.angle(scale)), place.real, place.imag]


def _laid(part: _RefinedDesigns) -> Iterator[FittedCurve]:
    """Yield refined designs in the units and at the place of the curve."""
    n, target = len(part.chain.numbers), part.target
    _, clear = part.chain.curves(part.x[:, :n], 4 * POSES)
    angles = turn(4 * POSES)
    size, middle = (np.conj(each) if part.mirrored else each for each in (target.size, target.middle))
    for x in part.x[clear]:
        window = None if target.closed else (float(x[n]), float(x[n + 1]))
        if window is not None:
            angles = window[0] + window[1] * np.linspace(0.0, 1.0, 2 * POSES)
        z, _ = part.chain.places(x[None, :n], angles)
        scale, place = complex(np.exp(complex(x[-4], x[-3]))), complex(x[-2], x[-1])
        apart = mean_distance(scale * z[0] + place, target.places, target.closed)
        laying = Laying(scale * size, place * size + middle, part.mirrored)
        yield FittedCurve(part.chain, x[:n], laying, apart, apart * abs(size) / 2.0, window)


def _levenberg(r: Number, j: Number, damping: Number) -> Number:
    """Return the steps (designs, numbers) that residuals ask for."""
    across = np.swapaxes(j, 1, 2)
    normal, slope = across @ j, across @ r[:, :, None]
    diagonal, more = np.arange(normal.shape[1]), 1.0 + damping[:, None]
    normal[:, diagonal, diagonal] = (normal[:, diagonal, diagonal] + FLOOR) * more
    return np.linalg.solve(normal, slope)[:, :, 0]


def _angles(chain: CurveChain, x: Number, target: CurveTarget) -> Number:
    """Return the angles of the crank at which designs are compared with a target, (1 or designs, POSES)."""
    if target.closed:
        return turn(POSES)[None]
    n = len(chain.numbers)
    return x[:, [n]] + x[:, [n + 1]] * np.linspace(0.0, 1.0, POSES)


def _traced(chain: CurveChain, x: Number, target: CurveTarget) -> tuple[Number, Number, Number, Number]:
    """Return curves, their slopes by all unknowns but the last four and by the crank, and which designs are clear."""
    n = len(chain.numbers)
    angles = _angles(chain, x, target)
    z, by, by_crank, clear = chain.slopes(x[:, :n], angles[0] if target.closed else angles)
    if target.closed:
        return z, by, by_crank, clear
    # all of the turn is there, and no more than that is traced
    clear = clear & chain.curves(x[:, :n], POSES // 2)[1] & (x[:, n + 1] > LEAST_TURN) & (x[:, n + 1] < TURN)
    return z, np.concatenate([by, [by_crank, by_crank * np.linspace(0.0, 1.0, POSES)]]), by_crank, clear


def _residuals(chain: CurveChain, x: Number, target: CurveTarget, early: bool) -> tuple[Number, Number, Number]:
    """Return residuals (designs, n), slopes (designs, n, numbers) and which designs are clear."""
    z, by, by_crank, clear = _traced(chain, x, target)
    if not clear.all():  # what is not clear means nothing, and is not taken
        z, by, by_crank = (np.where(clear[:, None], each, 1.0) for each in (z, by, by_crank))
    scale, place = np.exp(x[:, [-4]] + 1j * x[:, [-3]]), x[:, [-2]] + 1j * x[:, [-1]]
    turned = scale * z
    w = turned + place
    slopes = np.concatenate([scale * by, np.array([turned, 1j * turned, np.ones_like(w), np.full_like(w, 1j)])])
    if not early:
        return *_gaps(w, scale * by_crank, slopes, target), clear
    own = w - target.places[_by_arc(w, target)]
    steep = np.concatenate([slopes.real, slopes.imag], axis=2)
    return np.concatenate([own.real, own.imag], axis=1), np.moveaxis(steep, 0, 2), clear


def _gaps(w: Number, tangent: Number, slopes: Number, target: CurveTarget) -> tuple[Number, Number]:
    """Return residuals (designs, n) of curves to the nearest places, and their slopes (designs, n, numbers)."""
    places = target.places
    length = _lengths(w, target.closed)
    if target.closed:
        weight, ahead = length + np.roll(length, 1, 1), np.roll(places, -1) - np.roll(places, 1)
    else:
        weight, ahead = np.zeros(w.shape), np.gradient(places)
        weight[:, 1:] += length
        weight[:, :-1] += length
    plane = np.stack([w.real, w.imag], axis=-1)
    square = (np.abs(w) ** 2)[:, :, None] + np.abs(places) ** 2 - 2.0 * (plane @ np.stack([places.real, places.imag]))
    rows, at, nearest = np.arange(len(w))[:, None], square.argmin(axis=1), square.argmin(axis=2)
    # each pose counts by its part of the arc, as if they lay evenly along it
    share = np.sqrt(weight / (2.0 * length.sum(axis=1, keepdims=True)) * POSES)
    parts, steeps = list[Number](), list[Number]()
    for own, t, slope, counted in (
        (w[rows, at] - places, tangent[rows, at], slopes[:, rows, at], 1.0),
        (w - places[nearest], ahead[nearest], slopes, share),
    ):
        across = counted * np.conj(t) / (np.abs(t) + NO_LENGTH)
        turned_r, turned_j = own * across, slope * across
        parts += [turned_r.imag, ALONG * turned_r.real]
        steeps += [turned_j.imag, ALONG * turned_j.real]
    if not target.closed:  # the ends of what is traced are held at those of the target
        ends = w[:, [0, -1]]
        gaps = ends - places[[0, -1]], ends - places[[-1, 0]]
        forth = np.abs(gaps[0]).sum(axis=1) <= np.abs(gaps[1]).sum(axis=1)
        own, slope = ENDS * np.where(forth[:, None], *gaps), ENDS * slopes[:, :, [0, -1]]
        parts += [own.real, own.imag]
        steeps += [slope.real, slope.imag]
    return np.concatenate(parts, axis=1), np.moveaxis(np.concatenate(steeps, axis=2), 0, 2)


def _lengths(w: Number, closed: bool) -> Number:
    """Return the lengths between poses, of a closed curve also from the last to the first."""
    return np.abs(np.roll(w, -1, 1) - w if closed else np.diff(w, axis=1)) + NO_LENGTH


def _by_arc(w: Number, target: CurveTarget) -> Number:
    """Return the places of the target that lie at equal parts of its arc with poses, from the best start."""
    n, length = len(target.places), _lengths(w, target.closed)
    along = np.cumsum(length, axis=1) / length.sum(axis=1, keepdims=True)
    if target.closed:
        weight = length
        index = np.round((along - length / length.sum(axis=1, keepdims=True)) * n).astype(int)
        starts = np.arange(0, n, 4)[:, None, None]
        choices = np.concatenate([starts + index, starts - index]) % n
    else:
        index = np.round(np.pad(along, ((0, 0), (1, 0))) * (n - 1)).astype(int)
        choices, weight = np.stack([index, n - 1 - index]), np.ones(w.shape)
    gaps = (np.abs(w - target.places[choices]) ** 2 * weight).sum(axis=2)
    return choices[gaps.argmin(axis=0), np.arange(len(w))]
