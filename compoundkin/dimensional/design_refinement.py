"""Many designs of a chain refined at once: Levenberg's steps, the best of all, moves from there, different answers.

Whoever follows a curve, a function or a motion has residuals of his own; how they are lowered is the same for all. The
steps are those of K. Levenberg, A method for the solution of certain non-linear problems in least squares, Q. Appl.
Math. 2 (1944) 164-168, with the diagonal in place of the unit matrix (D. W. Marquardt, J. SIAM 11 (1963) 431-441), and
with a weight that follows how well a step was foreseen (H. B. Nielsen, Damping parameter in Marquardt's method,
IMM-REP-1999-05).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import NamedTuple, Self, TypeAlias, TypeVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dimensional.candidates import Linkage
from compoundkin.dimensional.curve_chains import CurveChain
from compoundkin.dimensional.defects import Rejection, SolvedLinkage, judged
from compoundkin.dimensional.tasks import Task

# The weight of Levenberg's term at first, its least, and where a design is given up; by which factor it shrinks at
# most, and grows at first, twice as much after each failure more.
FIRST, LEAST, HOPELESS = 1e-2, 1e-7, 1e5
EASIER, HARDER = 1.0 / 3.0, 2.0
# No number goes farther in a step; a step that gains less than is asked for makes the next so much harder.
FARTHEST, SLOWER = 0.5, 30.0
# Added to the diagonal of the normal equations, in parts of its greatest entry: sizes, and begins, may be free.
FLOOR = 1e-9
# The best are moved to so many places each, so far: from and to.
MOVED, MOVES, MOVED_BY = 8, 8, (0.02, 0.4)
# So many answers are given, of one kind of linkage so many, and so many linkages are looked at for them; lengths that
# differ by less than a part make no other linkage.
GIVEN, OF_A_KIND, LOOKED_AT, ALIKE = 8, 3, 60, 0.1

# Of unknowns (designs, numbers) of some rows: residuals (designs, n), their slopes (designs, n, numbers), and which
# designs are clear of limits.
Residuals: TypeAlias = Callable[[Number, Number], tuple[Number, Number, Number]]


def levenberg_steps(
    r: Number, j: Number, damping: Number, floor: float, *, of_greatest: bool = False
) -> tuple[Number, Number]:
    """Return steps (designs, numbers), and by how much they lower sums of squares (designs,) as far as slopes tell.

    Residuals `r` are (designs, n), their slopes `j` (designs, n, numbers), weights `damping` of Levenberg's term
    (designs,).

    A `floor` is added to the diagonal, for what residuals do not depend on: as it is, or as a part `of_greatest` of its
    entries, where residuals have units.
    """
    across = np.swapaxes(j, 1, 2)
    normal, slope = across @ j, across @ r[:, :, None]
    at = np.arange(normal.shape[1])
    diagonal = normal[:, at, at]
    least = floor * diagonal.max(axis=1, keepdims=True) + 1e-300 if of_greatest else floor
    normal[:, at, at] = (diagonal + least) * (1.0 + damping[:, None])
    step = np.linalg.solve(normal, slope)[:, :, 0]
    foreseen = ((slope[:, :, 0] + damping[:, None] * (diagonal + least) * step) * step).sum(axis=1)
    return step, foreseen


def refined(
    x: Number,
    residuals: Residuals,
    steps: int,
    floor: float,
    *,
    of_greatest: bool = False,
    holds: Callable[[Number, Number], Number] | None = None,
    settled: float = 0.0,
) -> tuple[Number, Number]:
    """Return unknowns of many designs, (designs, numbers), after so many of Levenberg's steps, and sums of squares.

    No step is taken to what is not clear, nor from where a condition `holds` (of unknowns of some rows) to where it
    does not. A step that gains less than the part `settled` counts as a failed one, and a design that foresees no more
    has ended. For `floor` see `levenberg_steps`.
    """
    x, rows = x.copy(), np.arange(len(x))
    r, j, clear = residuals(x, rows)
    cost = np.where(clear, (r**2).sum(axis=1), np.inf)
    held = np.ones(len(x), bool) if holds is None else holds(x, rows)
    damping, growth = np.where(clear, FIRST, 2.0 * HOPELESS), np.full(len(x), HARDER)
    for _ in range(steps):
        alive = np.flatnonzero(damping < HOPELESS)
        if not len(alive):
            break
        step, foreseen = levenberg_steps(r[alive], j[alive], damping[alive], floor, of_greatest=of_greatest)
        if settled:
            goes_on = foreseen > settled * cost[alive]
            damping[alive[~goes_on]] = 2.0 * HOPELESS
            alive, step, foreseen = alive[goes_on], step[goes_on], foreseen[goes_on]
            if not len(alive):
                continue
        ahead = x[alive] - np.clip(step, -FARTHEST, FARTHEST)
        tried, steep, clear = residuals(ahead, alive)
        costs = (tried**2).sum(axis=1)
        better = np.flatnonzero(clear & (costs < cost[alive]))
        if holds is not None:
            now = holds(ahead[better], alive[better])
            kept = now | ~held[alive[better]]
            better = better[kept]
            held[alive[better]] = now[kept]
        to = alive[better]
        gain = 1.0 - costs[better] / cost[to]
        part = (cost[to] - costs[better]) / np.maximum(foreseen[better], np.finfo(float).tiny)
        x[to], r[to], j[to], cost[to] = ahead[better], tried[better], steep[better], costs[better]
        factor = growth[alive]
        factor[better] = np.maximum(EASIER, 1.0 - (2.0 * np.minimum(part, 1.5) - 1.0) ** 3)
        growth[alive] *= 2.0
        growth[to] = HARDER
        damping[alive] = np.clip(damping[alive] * factor, LEAST, 2.0 * HOPELESS)
        damping[to[gain < settled]] *= SLOWER
    return x, cost


@dataclass(frozen=True, eq=False)
class FittedDesigns(ABC):
    """Designs of one chain that are refined together, `mirrored` or not: unknowns `x` (designs, numbers).

    After the designs' numbers stand others, such as how they are laid. `cost` are sums of squares, infinite where they
    are not known.
    """

    chain: CurveChain
    mirrored: bool
    x: Number
    cost: Number

    @abstractmethod
    def residuals(self, x: Number) -> tuple[Number, Number, Number]:
        """Return residuals (designs, n), their slopes (designs, n, numbers), and which designs are clear."""

    def refined(self, steps: int) -> Self:
        """Return them after so many steps."""
        x, cost = refined(self.x, lambda x, rows: self.residuals(x), steps, FLOOR, of_greatest=True)
        return replace(self, x=x, cost=cost)

    def some(self, kept: Number) -> Self:
        """Return some of them."""
        return replace(self, x=self.x[kept], cost=self.cost[kept])

    def moved(self, x: Number) -> Self:
        """Return designs at other unknowns."""
        return replace(self, x=x, cost=np.full(len(x), np.inf))


Designs = TypeVar("Designs", bound=FittedDesigns)


class RefinementPlan(NamedTuple):
    """How many `steps` all designs take, how many of the `best` of all go on, and how many steps `more` these take.

    In so many `rounds` the best are then moved and refined again.
    """

    steps: int
    best: int
    more: int
    rounds: int


def best_designs(begun: Iterable[Designs], plan: RefinementPlan) -> list[Designs]:
    """Return the best designs of all, and the best of each chain, refined."""
    found = best_refined([one.refined(plan.steps) for one in begun], plan.best, plan.more)
    rng = np.random.default_rng(0)
    for _ in range(plan.rounds):
        moved = [one.refined(plan.steps) for one in best_moved(found, rng)]
        found = best_refined([*found, *moved], plan.best, plan.more)
    return found


def best_refined(parts: Sequence[Designs], count: int, steps: int) -> list[Designs]:
    """Return so many best designs of all, and the best of each chain, after so many steps more."""
    if not parts:
        return []
    least = np.sort(np.concatenate([part.cost for part in parts]))[:count][-1]
    kept = [part.some((part.cost <= least) | (part.cost == part.cost.min())) for part in parts]
    return [part.refined(steps) for part in kept if np.isfinite(part.cost).any()]


def ranked(parts: Sequence[Designs]) -> Iterator[tuple[Designs, int]]:
    """Yield the designs of all parts whose costs are known, the best first: the part, and the place in it."""
    order = sorted((float(cost), n, k) for n, part in enumerate(parts) for k, cost in enumerate(part.cost))
    yield from ((parts[n], k) for cost, n, k in order if np.isfinite(cost))


def best_moved(parts: Sequence[Designs], rng: np.random.Generator) -> Iterator[Designs]:
    """Yield the best designs of all, each moved to several places about."""
    for part, k in islice(ranked(parts), MOVED):
        one = part.some(np.array([k]))
        yield one.moved(scattered(one.x, rng))


def scattered(x: Number, rng: np.random.Generator) -> Number:
    """Return several places about the unknowns of a design, (1, numbers), nearer and farther."""
    low, high = np.log(MOVED_BY)
    far = np.exp(low + (high - low) * rng.random((MOVES, 1)))
    return np.asarray(x + far * rng.standard_normal((MOVES, x.shape[1])))


def different_verdicts(linkages: Iterable[Linkage], task: Task, count: int) -> list[SolvedLinkage | Rejection]:
    """Return what is said of linkages, until so many are without a defect: none of these like another, few of a kind.

    Where a task has no tolerance, how far they are off is no defect.
    """
    verdicts, good, kinds = list[SolvedLinkage | Rejection](), list[Linkage](), Counter[str]()
    for made in islice(linkages, LOOKED_AT):
        if len(good) == count:
            break
        if kinds[made.title] >= OF_A_KIND or any(alike(made, other) for other in good):
            continue
        verdicts.append(judged(made, task.conditions, task.tolerance or np.inf))
        if isinstance(verdicts[-1], SolvedLinkage):
            kinds[made.title] += 1
            good.append(made)
    return verdicts


def alike(one: Linkage, other: Linkage, *, at_any_size: bool = True) -> bool:
    """Return whether two linkages are of one chain and of nearly the same lengths, up to their size."""
    if one.title != other.title or len(one.lengths) != len(other.lengths):
        return False
    own, its = (np.array(each.lengths) / (max(each.lengths) if at_any_size else 1.0) for each in (one, other))
    return np.allclose(own, its, rtol=ALIKE)
