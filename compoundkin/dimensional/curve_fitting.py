"""Designs refined to a curve: Levenberg's steps of many at once, with the slopes of their programs.

At each step every place of the target is held against the nearest place of the curve and every place of the curve
against the nearest of the target, along the normals there (Y. Chen and G. Medioni, Object modelling by registration of
multiple range images, Image Vision Comput. 10 (1992) 145-155); the first steps hold places at equal parts of the arcs
against each other, so that a curve comes near as a whole. Rotation, size and place are unknowns like the dimensions.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.dimensional.candidates import Candidates, Linkage
from compoundkin.dimensional.coupler_atlas import AtlasMatch, SoughtCurve, coupler_atlas
from compoundkin.dimensional.curve_chains import CurveChain, Laying, turn
from compoundkin.dimensional.curve_conditions import CurveConditions, LaidDesigns
from compoundkin.dimensional.curve_likeness import best_laid, mean_distance, on_target, part_laid, resampled
from compoundkin.dimensional.defects import Rejection, SolvedLinkage, judged
from compoundkin.dimensional.design_refinement import FIRST, MOVED, alike, refined, scattered
from compoundkin.dimensional.tasks import Conditions, CurveTask, CurveTiming

# Designs of the atlas, how many of them are refined, how many answers are given beside so many of each number of links,
# and how many of one kind of linkage while others are there.
DESIGNS, STARTED, GIVEN, SIMPLE, OF_A_KIND = 200_000, 200, 6, 2, 3
# Verdicts on linkages, at most.
MOST_JUDGED = 40
# Rounds, for each dyad that linkages may have, in which what remains farther than this sum of squares is moved and
# grown, and by which factor that is eased each round: what is nearly there ends soon, what is far is sought for long.
ROUNDS, NEAR, EASED = 9, 2e-4, 1.25
# How many of the best grow, not more of a chain than this; the dyads that are drawn for each pair of links and mode,
# and how many of the most promising are taken of each, and of all.
GROWN, OF_A_CHAIN, DRAWN, TAKEN, MOST_TAKEN = 5, 3, 256, 3, 10
# How many designs of a number of links are kept from a round; which are the same.
KEPT, SAME = 24, 1e-6
# Designs of a chain whose sums of squares differ by less than this factor came to the same place.
APART = 1.03
# By how much the sum of squares of a design counts as more each time that it was moved, or grew.
REPEATED = 1.15
# The weight of the ends of an open curve; the least part of the turn that traces it.
ENDS, LEAST_TURN = 2.0, 0.3
# The greatest sum of a linkage's lengths, in the target's RMS radius: steps lead to larger and larger ones where a
# point on a long arm comes nearer and nearer to a line.
LARGEST = 100.0
# Positions over a turn at which a refined linkage is handed on.
POSITIONS = 12
# Poses of a curve, and places of its target.
POSES, PLACES = 128, 128
# Steps with places by arc length, none in later rounds; steps of all designs to the nearest places, more steps of the
# best so many, and the last of what is given.
EARLY, FIRST_STEPS, STEPS, BEST, LAST = 12, 15, 40, 24, 40
# A step that gains less than this part counts as a failed one.
SETTLED = 1e-4
# Added to the diagonal of the normal equations: sizes of chains without a fixed length are free.
FLOOR = 1e-6
# The part of residuals along the curve: it keeps places from gliding without end.
ALONG = 0.1
# Added to lengths that are divided by, in the target's RMS radius.
NO_LENGTH = 1e-12
# Places of a target are whole multiples of this part of its RMS radius: how a curve lies changes their rounding, which
# hundreds of steps would make to other answers.
GRAIN = 2.0**-20
# The lesser part by which the first harmonic of one sense must surpass that of the other to be taken.
GREATER = 1e-6

# How often each design, by its chain and its unknowns, was moved or grew.
Tried = Counter[tuple[CurveChain, bytes]]


class FittedCurve(NamedTuple):
    """A design laid on a curve.

    `apart` is the mean nearest distance both ways, summed, in the target's RMS radius, `error` half of that in the
    target's units; with a `timing` they are of the distances at the times. An open curve, or one with timing, is traced
    while the crank turns from `window[0]` by `window[1]`.
    """

    chain: CurveChain
    design: Number
    laying: Laying
    apart: float
    error: float
    window: tuple[float, float] | None = None
    timing: CurveTiming | None = None

    @property
    def linkage(self) -> Linkage:
        """The linkage at positions over a whole turn, or over the part of it that traces an open curve."""
        angles = turn(POSITIONS)
        if self.window is not None:
            parts = np.linspace(0.0, 1.0, POSITIONS) if self.timing is None else self.timing.parts
            some = parts[np.unique(np.linspace(0, len(parts) - 1, 2 * POSITIONS).astype(int))]
            angles = self.window[0] + self.window[1] * some
        return self.chain.linkage(self.design, self.laying, angles, self.error)


class CurveTarget(NamedTuple):
    """A curve that designs are refined to: `places` (places,) along it, of RMS radius one about zero.

    It is ``size * places + middle``. Places are evenly along it, with a `timing` those at its times. Steps keep the
    `conditions` on what is seen at that size and place.
    """

    places: Number
    closed: bool
    size: complex
    middle: complex
    timing: CurveTiming | None = None
    conditions: CurveConditions = CurveConditions(Conditions(), LARGEST)

    @classmethod
    def of(
        cls, curve: Number, closed: bool, timing: CurveTiming | None = None, conditions: Conditions | None = None
    ) -> CurveTarget:
        """Return the target of a curve, turned by its greater first harmonic: nothing depends on how a curve lies."""
        places = resampled(curve[None], PLACES, closed)[0]
        middle, (first, other) = complex(places.mean()), np.fft.fft(places)[[1, -1]]
        turn = complex(other if abs(other) > (1.0 + GREATER) * abs(first) else first)
        radius = float(np.sqrt(np.mean(np.abs(places - middle) ** 2)))
        size = radius * (turn / abs(turn) if abs(turn) > GREATER * radius * PLACES else 1.0 + 0j)
        if timing is not None:
            kept = np.unique(np.linspace(0, len(curve) - 1, PLACES).astype(int))
            places, timing = curve[kept], timing._replace(parts=timing.parts[kept])
        places = (places - middle) / size
        places = GRAIN * (np.round(places.real / GRAIN) + 1j * np.round(places.imag / GRAIN))
        seen = CurveConditions(Conditions() if conditions is None else conditions.seen_from(size, middle), LARGEST)
        return cls(places, closed, size, middle, timing, seen)

    @property
    def sought(self) -> SoughtCurve:
        """The curve to look for in an atlas."""
        # designs of the atlas are seldom large: they need not all be laid
        return SoughtCurve(self.places, self.closed, self.timing, self.conditions._replace(size=None))

    @property
    def has_window(self) -> bool:
        """Whether two unknowns say which part of the turn traces it."""
        return not self.closed or self.timing is not None

    @property
    def parts(self) -> Number:
        """The parts of the window at which designs are computed: steps between them are small."""
        even = np.linspace(0.0, 1.0, POSES)
        return even if self.timing is None else np.union1d(even, self.timing.parts)

    @property
    def compared(self) -> Any:
        """Those of the poses at its `parts` that are compared with its places."""
        return slice(None) if self.timing is None else np.searchsorted(self.parts, self.timing.parts)

    def seen(self, mirrored: Number) -> Number:
        """Return its places for designs, mirrored or not, (designs, places)."""
        return np.where(mirrored[:, None], np.conj(self.places), self.places)


class _RefinedDesigns(NamedTuple):
    """Designs of one chain that are refined together to a target, some of them `mirrored` (designs,).

    `x` are their numbers, of a target with a window the crank's angle at its begin and the turn from there, then the
    logarithm of the scale, its angle and the place, (designs, unknowns). `cost` is the sum of squares (designs,).
    """

    chain: CurveChain
    target: CurveTarget
    mirrored: Number
    x: Number
    cost: Number

    @classmethod
    def fresh(cls, chain: CurveChain, target: CurveTarget, mirrored: Number, x: Number) -> _RefinedDesigns:
        """Return designs whose costs are not known."""
        return cls(chain, target, mirrored, x, np.full(len(x), np.inf))

    @property
    def designs(self) -> Number:
        """The numbers of the designs."""
        return self.x[:, : len(self.chain.numbers)]

    @property
    def held(self) -> Number:
        """Which designs hold the target's conditions (designs,)."""
        if not self.target.conditions or not len(self.x):
            return np.ones(len(self.x), bool)
        scale, place = _scale_and_place(self.x)
        return self.target.conditions.held(LaidDesigns(self.chain, self.designs, scale, place, self.mirrored))

    def refined(self, steps: int, early: bool = False) -> _RefinedDesigns:
        """Return them after so many steps; `early` ones are by the arc's length.

        No step is taken that comes to a limit, or from where conditions hold to where they do not.
        """

        def residuals(x: Number, rows: Number) -> tuple[Number, Number, Number]:
            return _residuals(self.some(rows)._replace(x=x), early)

        def holds(x: Number, rows: Number) -> Number:
            return self.some(rows)._replace(x=x).held

        x, cost = refined(self.x, residuals, steps, FLOOR, holds=holds, settled=SETTLED)
        return self._replace(x=x, cost=cost)

    def some(self, kept: Number) -> _RefinedDesigns:
        """Return some of them."""
        return self._replace(mirrored=self.mirrored[kept], x=self.x[kept], cost=self.cost[kept])


def traced(task: CurveTask) -> Candidates:
    """Return linkages of at most `task.links` links whose driver turns fully and whose point traces the task's curve.

    Designs of the atlas with the nearest curves are refined and grow; the best are given, none like another, and of
    each number of links the best.
    """
    atlas = coupler_atlas(min(task.links, 6), DESIGNS)
    target = CurveTarget.of(task.points, task.closed, task.timing, task.conditions)
    matches = atlas.nearest(target.sought, STARTED)
    if not matches:  # what comes near without conditions is told, with what it misses
        target = target._replace(conditions=CurveConditions(Conditions(), LARGEST))
        matches = atlas.nearest(target.sought, STARTED)
    found = _fitted(matches, target, task.links, _rounds(task.links))
    verdicts = list[SolvedLinkage | Rejection]()
    # of each number of links, though fewer are seldom the nearest
    for links in sorted({one.chain.links for one in found}):
        _judge([one for one in found if one.chain.links == links], SIMPLE, verdicts, task)
    _judge(found, GIVEN, verdicts, task)
    complete = f"the best {len(verdicts)} of {len(atlas)} designs of {len(atlas.chains)} chains, refined"
    if task.links > 4:
        complete += " and grown"
    return Candidates([one.candidate for one in verdicts], complete, is_family=True, verdicts=tuple(verdicts))


def _judge(
    found: Sequence[FittedCurve], count: int, verdicts: list[SolvedLinkage | Rejection], task: CurveTask
) -> None:
    """Append what is said of the best linkages, until so many more are without a defect.

    None is like another, few are of one kind before all kinds.
    """
    rest, wanted = list[Linkage](), count
    kinds = Counter(one.candidate.title for one in verdicts if isinstance(one, SolvedLinkage))
    for made, is_rest in _linkages(found, rest):
        if not wanted or len(verdicts) > MOST_JUDGED:
            break
        if any(alike(made, other.candidate, at_any_size=False) for other in verdicts):
            continue
        if kinds[made.title] >= OF_A_KIND and not is_rest:
            rest.append(made)
            continue
        verdict = judged(made, task.conditions, task.tolerance or np.inf)
        verdicts.append(verdict)
        if isinstance(verdict, SolvedLinkage):
            kinds[made.title] += 1
            wanted -= 1


def _linkages(found: Sequence[FittedCurve], rest: list[Linkage]) -> Iterator[tuple[Linkage, bool]]:
    """Yield linkages, then those that have been put to the rest meanwhile."""
    yield from ((one.linkage, False) for one in found)
    yield from ((made, True) for made in rest)


def fitted(
    matches: Sequence[AtlasMatch], curve: Number, closed: bool = True, links: int = 6, rounds: int | None = None
) -> list[FittedCurve]:
    """Return the best designs of some matches refined to a curve (places,), the nearest first.

    Where they remain far, those of fewer links than `links` grow by dyads, and the best are moved and refined again, in
    so many `rounds`; in zero for whoever waits for a first answer.
    """
    return _fitted(matches, CurveTarget.of(curve, closed), links, _rounds(links) if rounds is None else rounds)


def _rounds(links: int) -> int:
    return ROUNDS * (links // 2 - 1)


def _fitted(matches: Sequence[AtlasMatch], target: CurveTarget, links: int, rounds: int) -> list[FittedCurve]:
    found = _best(_refined(_begun(matches, target)))
    rng = np.random.default_rng(0)
    moved, grown = Tried(), Tried()
    for k in range(rounds):
        if not found or min(part.cost.min() for part in found) < NEAR * EASED**k:
            break
        found = _best([*found, *_refined([*_moved(found, moved, rng), *_grown(found, links, grown, rng)], 0)])
    return sorted((one for part in _given(found) for one in _laid(part.refined(LAST))), key=lambda one: one.apart)


def _refined(begun: Iterable[_RefinedDesigns], early: int = EARLY) -> list[_RefinedDesigns]:
    """Return designs refined, the best of all to the end."""
    parts = [part.some(held) for part in begun if (held := part.held).any()]
    parts = [part.refined(EARLY, early=True) if early and part.target.timing is None else part for part in parts]
    parts = [part.refined(FIRST_STEPS) for part in parts]
    costs = np.sort(np.concatenate([part.cost for part in parts])) if parts else np.zeros(0)
    refined = list[_RefinedDesigns]()
    for part in parts:
        to_end = part.cost <= costs[:BEST][-1]
        refined += [part.some(to_end).refined(STEPS)] if to_end.any() else []
        refined += [part.some(~to_end)] if not to_end.all() else []
    return refined


def _best(parts: Sequence[_RefinedDesigns]) -> list[_RefinedDesigns]:
    """Return the best designs of each number of links, and of each chain its best, none twice."""
    found = list[_RefinedDesigns]()
    for links in sorted({part.chain.links for part in parts}):
        own = [part for part in parts if part.chain.links == links]
        least = np.sort(np.concatenate([part.cost for part in own]))[:KEPT][-1]
        for chain in dict.fromkeys(part.chain for part in own):
            one = _joined([part for part in own if part.chain is chain])
            order = np.lexsort((one.mirrored, one.cost))
            x = np.column_stack([one.x, one.mirrored])[order]
            apart = np.append(True, np.abs(np.diff(x, axis=0)).max(axis=1) > SAME)
            cost = one.cost[order]
            order = order[apart & ((cost <= least) | (np.arange(len(order)) == 0)) & np.isfinite(cost)]
            if len(order):
                found.append(one.some(order))
    return found


def _given(found: Sequence[_RefinedDesigns]) -> list[_RefinedDesigns]:
    """Return the best designs of each number of links, not of each chain."""
    given = list[_RefinedDesigns]()
    for links in sorted({part.chain.links for part in found}):
        own = [part for part in found if part.chain.links == links]
        least = np.sort(np.concatenate([part.cost for part in own]))[:KEPT][-1]
        given += [part.some(part.cost <= least) for part in own if part.cost.min() <= least]
    return given


def _joined(parts: Sequence[_RefinedDesigns]) -> _RefinedDesigns:
    """Return designs of one chain as one."""
    x, cost = np.concatenate([part.x for part in parts]), np.concatenate([part.cost for part in parts])
    return parts[0]._replace(mirrored=np.concatenate([part.mirrored for part in parts]), x=x, cost=cost)


def _by_chain(parts: Iterable[_RefinedDesigns]) -> list[_RefinedDesigns]:
    """Return designs, those of each chain together: a program is called once for all of them."""
    same = dict[CurveChain, list[_RefinedDesigns]]()
    for part in parts:
        same.setdefault(part.chain, []).append(part)
    return [_joined(each) for each in same.values()]


def _nearest(parts: Sequence[_RefinedDesigns], count: int, tried: Tried) -> Iterator[_RefinedDesigns]:
    """Yield the best designs of all, one by one, not many of a chain, and none that came to where a better one is.

    Those that have been `tried` stand back for others that are not much worse.
    """
    order = [(part.cost[k] * REPEATED ** tried[part.chain, part.x[k].tobytes()], n, k)
             for n, part in enumerate(parts) for k in range(len(part.x))]  # fmt: skip
    taken = dict[int, list[float]]()
    for _, n, k in sorted(order):
        part, same = parts[n], taken.setdefault(n, [])
        cost = part.cost[k]
        if len(same) < OF_A_CHAIN and all(max(cost, other) > APART * min(cost, other) for other in same):
            same.append(cost)
            tried[part.chain, part.x[k].tobytes()] += 1
            yield part.some(np.array([k]))
            count -= 1
            if not count:
                return


def _moved(found: Sequence[_RefinedDesigns], tried: Tried, rng: np.random.Generator) -> list[_RefinedDesigns]:
    """Return the best designs, each moved to several places about."""
    moved = list[_RefinedDesigns]()
    for one in _nearest(found, MOVED, tried):
        around = scattered(one.x, rng)
        if one.target.timing is not None and one.target.timing.turn:
            around[:, -5] = one.x[:, -5]
        moved.append(one.fresh(one.chain, one.target, np.repeat(one.mirrored, len(around)), around))
    return [part.some(clear) for part in _by_chain(moved) if (clear := part.chain.curves(part.designs, POSES)[1]).any()]


def _grown(
    found: Sequence[_RefinedDesigns], links: int, tried: Tried, rng: np.random.Generator
) -> list[_RefinedDesigns]:
    """Return the best designs with a dyad more: of many dyads those that promise most by their first step."""
    grown = list[_RefinedDesigns]()
    for one in _nearest([part for part in found if part.chain.links + 2 <= links], GROWN, tried):
        promises = list[tuple[float, CurveChain, Number]]()
        for second in one.chain.carriers:
            for sign in (1, -1):
                larger = one.chain.grown(second, sign)
                gains, designs = _promised(one, larger, rng.random((DRAWN, len(larger.numbers))))
                promises += [(gains[k], larger, designs[k]) for k in np.argsort(-gains)[:TAKEN]]
        for _, larger, design in sorted(promises, key=lambda each: -each[0])[:MOST_TAKEN]:
            x = np.append(design, one.x[0, len(one.chain.numbers) :])[None]
            grown.append(one.fresh(larger, one.target, one.mirrored, x))
    return _by_chain(grown)


def _promised(one: _RefinedDesigns, larger: CurveChain, units: Number) -> tuple[Number, Number]:
    """Return by how much a first step of designs with a dyad more lowers the sum of squares, and those designs.

    Only P's two coordinates on the new rod are new to the curve, and by them it moves as the rod turns.
    """
    designs = one.chain.grown_designs(larger, np.repeat(one.designs, len(units), axis=0), units)
    ahead = designs.copy()
    ahead[:, -2] += 1.0  # P one along the rod
    own = _compared(one, False)
    _, turns = larger.curves(designs, POSES)
    designs, ahead = designs[turns], ahead[turns]
    if not len(designs) or not own.clear.all():
        return np.zeros(0), designs
    moved, clear = larger.places(ahead, _angles(one)[0])
    way = moved[:, one.target.compared] - own.z
    (r, old), (_, new) = own.pull.rows(own.slopes), own.pull.rows(np.array([way, 1j * way]))
    across = np.linalg.qr(old[0])[0]
    new = new - across @ (across.T @ new)
    normal = np.swapaxes(new, 1, 2) @ new
    normal[:, [0, 1], [0, 1]] = normal[:, [0, 1], [0, 1]] * (1.0 + FIRST) + FLOOR
    slope = np.swapaxes(new, 1, 2) @ r[0]
    gains = (slope * np.linalg.solve(normal, slope[:, :, None])[:, :, 0]).sum(axis=1)
    return gains[clear], designs[clear]


def _begun(matches: Sequence[AtlasMatch], target: CurveTarget) -> Iterator[_RefinedDesigns]:
    """Yield matches by their chains as they are laid on the target."""
    for chain in dict.fromkeys(match.chain for match in matches):
        own = [match for match in matches if match.chain is chain]
        designs = np.array([match.design for match in own], float)
        z, clear = chain.curves(designs, POSES)
        if not clear.any():  # more poses come nearer to limits than those of the atlas
            continue
        mirrored = np.array([match.laying.mirrored for match in own])
        columns, places = list[Number](), target.seen(mirrored)
        if target.has_window:
            window = np.array([match.window for match in own])
            columns.append(window)
            z = chain.places(designs, window[:, :1] + window[:, 1:] * target.parts)[0][:, target.compared]
            scale, place = (part_laid if target.timing is None else on_target)(z, places)
        else:
            scale, place, _ = best_laid(z, places)
        columns.append(np.stack([np.log(np.abs(scale)), np.angle(scale), place.real, place.imag], axis=-1))
        x = np.hstack([designs, *columns])
        yield _RefinedDesigns.fresh(chain, target, mirrored[clear], x[clear])


def _laid(part: _RefinedDesigns) -> Iterator[FittedCurve]:
    """Yield refined designs in the units and at the place of the curve."""
    n, target = len(part.chain.numbers), part.target
    _, clear = part.chain.curves(part.designs, 4 * POSES)
    for x, is_mirrored in zip(part.x[clear], part.mirrored[clear].tolist(), strict=True):
        angles, window = turn(4 * POSES), None
        if target.has_window:
            window = (float(x[n]), float(x[n + 1]))
            angles = window[0] + window[1] * (
                np.linspace(0.0, 1.0, 2 * POSES) if target.timing is None else target.parts
            )
        z = part.chain.places(x[None, :n], angles)[0][:, target.compared]
        scale, place = (complex(each[0]) for each in _scale_and_place(x[None]))
        w, places = scale * z[0] + place, np.conj(target.places) if is_mirrored else target.places
        if target.timing is None:
            apart = mean_distance(w, places, target.closed)
        else:
            apart = 2.0 * float(np.abs(w - places).mean())
        size, middle = (np.conj(each) if is_mirrored else each for each in (target.size, target.middle))
        laying = Laying(scale * size, place * size + middle, is_mirrored)
        yield FittedCurve(part.chain, x[:n], laying, apart, apart * abs(size) / 2.0, window, target.timing)


def _scale_and_place(x: Number) -> tuple[Number, Number]:
    """Return how unknowns lay designs: scales and places, (designs,)."""
    return np.exp(x[:, -4] + 1j * x[:, -3]), x[:, -2] + 1j * x[:, -1]


def _angles(one: _RefinedDesigns) -> Number:
    """Return the angles of the crank at which designs are compared with their target, (1 or designs, poses)."""
    if not one.target.has_window:
        return turn(POSES)[None]
    n = len(one.chain.numbers)
    return one.x[:, [n]] + one.x[:, [n + 1]] * one.target.parts


def _traced(one: _RefinedDesigns) -> tuple[Number, Number, Number, Number]:
    """Return curves, their slopes by all unknowns but the last four and by the crank, and which designs are clear."""
    target, angles = one.target, _angles(one)
    z, by, by_crank, clear = one.chain.slopes(one.designs, angles if target.has_window else angles[0])
    if not target.has_window:
        return z, by, by_crank, clear
    # all of the turn is there, of a closed curve at its own poses, and no more than that is traced
    turned = np.abs(one.x[:, len(one.chain.numbers) + 1])
    if not target.closed:
        clear = clear & one.chain.curves(one.designs, POSES // 2)[1]
    is_free = target.timing is None or not target.timing.turn
    if is_free:
        clear &= (turned > LEAST_TURN) & (turned < TURN)
    by_window = [by_crank, by_crank * target.parts if is_free else np.zeros_like(by_crank)]
    at = target.compared
    return z[:, at], np.concatenate([by, by_window])[:, :, at], by_crank[:, at], clear


class _Pull(NamedTuple):
    """What poses of curves are held to: a sum of squares of each design, by displacements of its poses.

    A displacement v of a pose counts ``even |v|^2 - Re(odd conj(v)^2)``, a square across and one along a direction: all
    places that hold a pose together. `even`, `odd` and `toward`, half of the slope of the sum, are (designs, poses),
    `cost` is the sum as it is (designs,).
    """

    even: Number
    odd: Number
    toward: Number
    cost: Number

    def seen_from(self, scale: Number) -> _Pull:
        """Return it for displacements of designs before these are laid by a scale (designs, 1)."""
        return _Pull(self.even * np.abs(scale) ** 2, self.odd * np.conj(scale) ** 2, self.toward * np.conj(scale),
                     self.cost)  # fmt: skip

    def rows(self, slopes: Number) -> tuple[Number, Number]:
        """Return residuals (designs, 2 poses + 1), two at each pose and one that no step changes, and their slopes.

        Slopes are (designs, 2 poses + 1, numbers), by those of poses (numbers, designs, poses): rows of the factor of
        Cholesky of the squares at each pose.
        """
        first, size = np.sqrt(self.even - self.odd.real), np.abs(self.odd)
        aside, second = -self.odd.imag / first, np.sqrt((self.even - size) * (self.even + size)) / first
        one = self.toward.real / first
        two = (self.toward.imag - aside * one) / second
        least = self.cost - (one**2).sum(axis=1) - (two**2).sum(axis=1)
        numbers, designs, poses = slopes.shape
        steep = np.zeros((designs, numbers, 2 * poses + 1))
        x, y = np.swapaxes(slopes.real, 0, 1), np.swapaxes(slopes.imag, 0, 1)
        np.multiply(x, first[:, None], out=steep[:, :, :poses])
        steep[:, :, :poses] += y * aside[:, None]
        np.multiply(y, second[:, None], out=steep[:, :, poses:-1])
        r = np.concatenate([one, two, np.sqrt(np.maximum(least, 0.0))[:, None]], axis=1)
        return r, np.swapaxes(steep, 1, 2)


class _Compared(NamedTuple):
    """Designs that are compared with their target before they are laid: poses `z`, slopes by all unknowns.

    `slopes` are (numbers, designs, poses); `clear` are those that are clear of limits, the others mean nothing.
    """

    z: Number
    slopes: Number
    pull: _Pull
    clear: Number


def _compared(one: _RefinedDesigns, early: bool) -> _Compared:
    """Return designs beside their target."""
    z, by, by_crank, clear = _traced(one)
    if not clear.all():  # what is not clear means nothing, and is not taken
        z, by, by_crank = (np.where(clear[:, None], each, 1.0) for each in (z, by, by_crank))
    scale, place = (each[:, None] for each in _scale_and_place(one.x))
    w, still = scale * z + place, np.zeros(z.shape)
    slopes = np.concatenate([by, np.array([z, 1j * z, still + 1.0 / scale, still + 1j / scale])])
    places = one.target.seen(one.mirrored)
    if early:
        pull = _held_at(w, places[np.arange(len(w))[:, None], _by_arc(w, places, one.target.closed)], 1.0)
    elif one.target.timing is not None:  # they count as much as poses and places without timing do
        pull = _held_at(w, places, 2.0 * POSES / places.shape[1])
    else:
        pull = _held_across(w, scale * by_crank, places, one.target.closed)
    return _Compared(z, slopes, pull.seen_from(scale), clear)


def _residuals(one: _RefinedDesigns, early: bool) -> tuple[Number, Number, Number]:
    """Return residuals (designs, n), slopes (designs, n, numbers) and which designs are clear."""
    found = _compared(one, early)
    return *found.pull.rows(found.slopes), found.clear


def _held_at(w: Number, places: Number, counted: float) -> _Pull:
    """Return how curves are held to places, (designs, poses), pose by pose."""
    gaps, still = w - places, np.zeros(w.shape)
    return _Pull(still + counted, still + 0j, counted * gaps, counted * (np.abs(gaps) ** 2).sum(axis=1))


def _held_across(w: Number, tangent: Number, places: Number, closed: bool) -> _Pull:
    """Return how curves with tangents are held to the nearest places, and these to the nearest poses.

    `places` are the target's for each design, (designs, places).
    """
    length = _lengths(w, closed)
    if closed:
        weight, ahead = length + np.roll(length, 1, 1), np.roll(places, -1, 1) - np.roll(places, 1, 1)
    else:
        weight, ahead = np.zeros(w.shape), np.gradient(places, axis=1)
        weight[:, 1:] += length
        weight[:, :-1] += length
    rows, at, nearest = np.arange(len(w))[:, None], _nearest_places(places, w), _nearest_places(w, places)
    # each pose counts by its part of the arc, as if they lay evenly along it
    share = weight * (POSES / (2.0 * length.sum(axis=1, keepdims=True)))
    across, own = _squared_direction(tangent), w - places[rows, nearest]
    beside = _squared_direction(ahead[rows, nearest])
    # places that are nearest to one pose: how many, and their gaps to it together
    gaps, many = w[rows, at] - places, w.size
    held = (at + w.shape[1] * rows).ravel()
    parts = (None, gaps.real.ravel(), gaps.imag.ravel())
    count, x, y = (np.bincount(held, each, many).reshape(w.shape) for each in parts)
    together = x + 1j * y
    along = ALONG**2
    even, odd = (1.0 + along) / 2.0, (1.0 - along) / 2.0
    pull = _Pull(
        even * (count + share),
        odd * (count * across + share * beside),
        even * (together + share * own) - odd * (across * np.conj(together) + share * beside * np.conj(own)),
        (even * np.abs(gaps) ** 2 - odd * (across[rows, at] * np.conj(gaps) ** 2).real).sum(axis=1)
        + (share * (even * np.abs(own) ** 2 - odd * (beside * np.conj(own) ** 2).real)).sum(axis=1),
    )
    return pull if closed else _with_ends_held(pull, w, places)


def _with_ends_held(pull: _Pull, w: Number, places: Number) -> _Pull:
    """Return what open curves are held to, with their ends at those of the target, whichever is nearer."""
    ends, both = w[:, [0, -1]], (places[:, [0, -1]], places[:, [-1, 0]])
    forth, back = (ends - each for each in both)
    own = ENDS**2 * np.where((np.abs(forth).sum(axis=1) <= np.abs(back).sum(axis=1))[:, None], forth, back)
    even, toward = pull.even.copy(), pull.toward.copy()
    even[:, [0, -1]] += ENDS**2
    toward[:, [0, -1]] += own
    return _Pull(even, pull.odd, toward, pull.cost + (np.abs(own) ** 2).sum(axis=1) / ENDS**2)


def _squared_direction(way: Number) -> Number:
    """Return squares of vectors of length one, or less where there is none."""
    return (way / (np.abs(way) + NO_LENGTH)) ** 2


def _nearest_places(w: Number, places: Number) -> Number:
    """Return which places (designs, n) are nearest to others, w (designs, m): (designs, m)."""
    plane = np.stack([w.real, w.imag, np.ones(w.shape)], axis=-1)
    theirs = np.stack([-2.0 * places.real, -2.0 * places.imag, places.real**2 + places.imag**2], axis=1)
    # one design at a time stays in the processor's cache
    square, found = np.empty((w.shape[1], places.shape[1])), np.empty(w.shape, int)
    for k in range(len(w)):
        np.matmul(plane[k], theirs[k], out=square).argmin(axis=1, out=found[k])
    return found


def _lengths(w: Number, closed: bool) -> Number:
    """Return the lengths between poses, of a closed curve also from the last to the first."""
    return np.abs(np.roll(w, -1, 1) - w if closed else np.diff(w, axis=1)) + NO_LENGTH


def _by_arc(w: Number, places: Number, closed: bool) -> Number:
    """Return which places of targets lie at equal parts of the arc with poses, from the best start."""
    n, length = places.shape[1], _lengths(w, closed)
    along = np.cumsum(length, axis=1) / length.sum(axis=1, keepdims=True)
    if closed:
        weight = length
        index = np.round((along - length / length.sum(axis=1, keepdims=True)) * n).astype(int)
        starts = np.arange(0, n, 4)[:, None, None]
        choices = np.concatenate([starts + index, starts - index]) % n
    else:
        index = np.round(np.pad(along, ((0, 0), (1, 0))) * (n - 1)).astype(int)
        choices, weight = np.stack([index, n - 1 - index]), np.ones(w.shape)
    gaps = (np.abs(w - places[np.arange(len(w))[:, None], choices]) ** 2 * weight).sum(axis=2)
    return choices[gaps.argmin(axis=0), np.arange(len(w))]
