"""Coulomb friction coupled to the true reactions, in all pairs at once.

Reactions are linear in the loads, friction among them, at a given pose. So one reverse pass for each friction gives
everything that the iterations need, in either direction of motion. With m the sums of normal forces and s the senses of
motion, the frictions are -s m, and m = h(m) are the sums under them. Where the mechanism contracts (nearly always)
there is one solution, found by Newton's steps, or the image h(m) where that is better. Elsewhere the directions of all
normal forces are tried, and all solutions of the polynomials that Coulomb's law is are followed from no friction; no
solution and several solutions are reported.

Source: Coulomb friction on a reverse pass over Assur groups, e.g. J. J. Uicker, G. R. Pennock, J. E. Shigley, Theory of
Machines and Mechanisms, chapter on static forces; a pin's friction moment is coefficient times radius times force.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.continuation import Corrector, StepLengths, follow_paths, homotopy_of
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.linear import solve
from compoundkin.base.newton import largest_change
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.friction_contacts import LoadedContact, in_one_row, senses
from compoundkin.dynamics.loaded_block import LoadedBlock
from compoundkin.dynamics.reactions.reverse_pass import Reactions, all_reactions, own_wrenches, reverse_passes
from compoundkin.model.pairs.contract import as_transmitting_pair

# Steps for all poses; a friction that raises its own normal force by 0.9 of itself takes ten.
NEWTON_STEPS = 60
# Sums differ from their image by so many parts of the terms that cancel in them: rounding.
SUM_ROUNDING = 2e-15
# Two solutions are one where they differ by this part.
SAME_SOLUTION = 1e-7
# All directions of up to so many normal forces are tried; of more, so many patterns.
ALL_DIRECTIONS, PATTERNS = 6, 96
# So many turns of the forces in pins are tried as well. Of random systems of three and more pins that feed on each
# other strongly one of two solutions is then missed in one or two of a hundred.
TURNS = 16
# All solutions are found where up to so many normal forces act: two to that power are followed.
ALL_GROWN = 8
# So many poses are searched together.
TOGETHER = 64
# The path along which frictions grow bends so far into complex numbers; its steps and corrections.
BEND = 0.6j
GROWTH = StepLengths(first=0.02, longest=0.3, shortest=1e-7, easy=400, most=400)
CORRECTED = Corrector(near=0.05, accurate=1e-4, goal=0.01, size=lambda step, x: largest_change(step.T, x.T))
ONE, NONE, SEVERAL, UNKNOWN = range(4)


class NotUniqueMotion(InvalidInput):
    """A simulation comes where Coulomb's law has no motion, or several."""

    def __init__(self, time: float) -> None:
        what = f"friction has no or several solutions at {time:g} s: the mechanism wedges or jumps"
        super().__init__(Problem("frictions", what, "less friction, or another start"))


class Frictions(NamedTuple):
    """The sizes of frictions with their signs, (frictions, poses). `state` is the number of solutions at each pose."""

    sizes: Number
    state: Number


def solve_coulomb(influence: FrictionInfluence, signs: Number, grown: int = ALL_GROWN) -> Frictions:
    """Return the frictions that oppose motion of the given signs (frictions, poses): -1, 0 or 1.

    Where one solution is found a second one is sought among all of them if up to so many normal forces act, `grown`.
    """
    finite = np.isfinite(influence.own).all(axis=0) & np.isfinite(influence.by).all(axis=(0, 1))
    state = np.where(finite & np.isfinite(signs).all(axis=0), ONE, UNKNOWN)
    sums = np.full(signs.shape, np.nan)
    known = np.flatnonzero(state == ONE)
    sure = np.zeros(len(state), dtype=bool)
    if len(known):
        part, senses = (influence, signs) if len(known) == len(state) else (influence.of(known), signs[:, known])
        sums[:, known], rested = _iterated(part, senses)
        sure[known] = part.contracts(senses) & rested
    doubtful = np.flatnonzero((state == ONE) & ~sure)
    if len(doubtful):
        sums[:, doubtful], state[doubtful] = _solve_by_directions(influence.of(doubtful), signs[:, doubtful], grown)
    sums[:, state != ONE] = np.nan
    return Frictions(-signs * sums, state)


def _iterated(influence: FrictionInfluence, signs: Number) -> tuple[Number, Number]:
    """Return the sums of normal forces, iterated from the frictionless ones, and where they converged."""
    sums = influence.sums(np.abs(influence.own))
    going: Number = np.arange(sums.shape[1])
    rested = np.zeros(sums.shape[1], dtype=bool)
    part, senses = influence, signs
    at: Number = np.array(sums)
    for _ in range(NEWTON_STEPS):
        image, newton = _steps(part, senses, at)
        gaps = _distance_from_image(part, senses, newton), _distance_from_image(part, senses, image)
        # NaN is never the better one
        better = gaps[0] <= gaps[1]
        at = np.where(better[None], newton, image)
        sums[:, going] = at
        done: Number = np.where(better, *gaps) <= SUM_ROUNDING * part.rounding(at)
        rested[going] = done
        if done.all():
            break
        if done.any():
            going, part, senses, at = going[~done], part.of(~done), senses[:, ~done], at[:, ~done]
    return sums, rested


def _steps(influence: FrictionInfluence, signs: Number, sums: Number) -> tuple[Number, Number]:
    """Return the image of the sums, and their next Newton iterate."""
    normal_forces = influence.normal_forces(-signs * sums)
    sizes = np.abs(normal_forces)
    image = influence.sums(sizes)
    matrix = _matrix(influence, signs, _directions(normal_forces, sizes, 0.0))
    return image, sums - solve(matrix, (sums - image).T).T


def _directions(normal_forces: Number, sizes: Number, otherwise: Number) -> Number:
    """Return the directions of normal forces, `otherwise` where they vanish."""
    return np.where(sizes > 0.0, normal_forces / np.where(sizes > 0.0, sizes, 1.0), otherwise)


def _matrix(influence: FrictionInfluence, signs: Number, toward: Number) -> Number:
    """Return the derivatives of sums minus image, (poses, pairs, frictions), for fixed directions of normal forces."""
    along = influence.sums((np.conjugate(toward) * influence.by).real) * signs[:, None]
    return np.eye(len(signs)) + along.transpose(2, 1, 0)


def _distance_from_image(influence: FrictionInfluence, signs: Number, sums: Number) -> Number:
    """Return the largest residual: the distance of the sums from their image."""
    found: Number = np.abs(sums - influence.sums(np.abs(influence.normal_forces(-signs * sums)))).max(axis=0)
    return found


def _solve_by_directions(influence: FrictionInfluence, signs: Number, grown: int) -> tuple[Number, Number]:
    """Return the solution at each pose where it is unique, and the state: none, one or several."""
    parts = [_searched_there(influence.of(which), signs[:, which], grown)
             for which in np.array_split(np.arange(signs.shape[1]), -(-signs.shape[1] // TOGETHER))]  # fmt: skip
    sums, state = zip(*parts, strict=True)
    return np.concatenate(sums, axis=1), np.concatenate(state)


def _searched_there(influence: FrictionInfluence, signs: Number, grown: int) -> tuple[Number, Number]:
    """Return these of a few poses, from all starts at once."""
    sums, state = _from_starts(influence, signs, np.stack(list(_starts(influence, signs)), axis=1))
    acting = len(_acting(influence, signs))
    again = np.flatnonzero(state != SEVERAL if acting <= grown else state == NONE)
    if len(again) and acting <= ALL_GROWN:
        part, senses = influence.of(again), signs[:, again]
        whole, found = _from_starts(part, senses, _grown(part, senses))
        one, other = sums[:, again], state[again] != NONE
        apart = np.abs(whole - one).max(axis=0) > SAME_SOLUTION * np.abs(whole).max(axis=0)
        known = found != NONE
        state[again] = np.where(other & known & apart, SEVERAL, np.where(known, found, state[again]))
        sums[:, again] = np.where(known & ~other, whole, one)
    return sums, state


class Regular(NamedTuple):
    """The frictions with their signs of the solution on which a motion goes on, and the number of solutions."""

    sizes: Number | None
    solutions: int


def regular_solution(influence: FrictionInfluence, signs: Number, grown: int) -> Regular:
    """Return the frictions at a single pose on which a motion goes on: those of the only regular solution, else None.

    A solution is regular where the determinant of sums minus image is positive, as it is without friction. Another one
    comes in from infinite forces: with whatever elasticity the contacts have it is unstable, so that the motion passes
    it by, until both meet and none is left.

    Source: P. Painleve, Sur les lois du frottement de glissement, C. R. Acad. Sci. 121 (1895) 112; L. Prandtl,
    Bemerkungen zu den Aufsaetzen der Herren F. Klein, R. v. Mises und G. Hamel, Z. Math. Phys. 58 (1910) 196.
    """
    starts = np.concatenate([one.T for one in _starts(influence, signs)]).T
    if len(_acting(influence, signs)) <= grown:
        starts = np.concatenate([starts, _grown(influence, signs)[..., 0]], axis=1)
    every = np.zeros(starts.shape[1], dtype=int)
    sums, good = _from_directions(influence.of(every), signs[:, every], starts)
    found = list[Number]()
    for one in sums[:, good].T:
        if all(np.abs(one - other).max() > SAME_SOLUTION * np.abs(other).max() for other in found):
            found.append(one)
    kept = [one for one in found if is_regular(influence, signs, one)]
    return Regular(-signs[:, 0] * kept[0] if len(kept) == 1 else None, len(found))


def is_regular(influence: FrictionInfluence, signs: Number, sums: Number) -> bool:
    """Return whether a solution at a single pose is regular."""
    forces = influence.normal_forces(-signs * sums[:, None])
    matrix = _matrix(influence, signs, _directions(forces, np.abs(forces), 0.0))
    return bool(np.linalg.det(matrix[0]) > 0.0)


def _grown(influence: FrictionInfluence, signs: Number) -> Number:
    """Return the directions of normal forces (normal forces, solutions, poses) of all solutions of Coulomb's law."""
    acting, owners = _acting(influence, signs), _owners(influence)
    scale = np.abs(influence.own).max(axis=0)
    own = (influence.own / np.where(scale > 0.0, scale, 1.0)).T  # (poses, normal forces)
    by = (-signs[:, None] * influence.by)[owners[acting]].transpose(2, 1, 0)  # (..., normal forces, acting)
    sizes = _GrowingForces.of(own[:, acting], by[:, acting]).ends()
    forces = own[:, None] + np.einsum("pjk,psk->psj", by, np.where(np.isfinite(sizes), sizes.real, 0.0))
    return _directions(forces, np.abs(forces), 1.0).transpose(2, 1, 0)


class _GrowingForces(NamedTuple):
    """The sizes m of the normal forces that act, as a path of polynomial systems that begins without friction.

    Their squares are (a + C m)^2, quadratic equations that have two solutions each where C is zero. From there C grows
    to its own value along a path through complex numbers, on which solutions never meet; those that end at real m >= 0
    are the mechanism's. `own` is a (poses, acting), `by` is C (poses, acting, acting), `extra` what the squares have
    more at the beginning.
    Source: A. P. Morgan and A. J. Sommese, Coefficient-parameter polynomial continuation, Applied Mathematics and
    Computation 29 (1989) 123.
    """

    own: Number
    by: Number
    extra: Number
    patterns: Number

    @classmethod
    def of(cls, own: Number, by: Number) -> _GrowingForces:
        """Return the path with a generic beginning."""
        count, rng = own.shape[1], np.random.default_rng(3)
        extra = rng.uniform(0.5, 1.0, count) * np.exp(1j * rng.uniform(0.0, TURN, count))
        return cls(own, by, extra, np.array(list(product((1.0, -1.0), repeat=count))))

    def ends(self) -> Number:
        """Return all sizes at the end (poses, solutions, acting), complex ones too; NaN where a path was lost."""
        start = np.sqrt(np.abs(self.own) ** 2 + self.extra)[:, None] * self.patterns
        growing = homotopy_of(self._value, self._by_sizes, self._by_time)
        ends = follow_paths(growing, start.reshape(-1, start.shape[-1]).T, GROWTH, CORRECTED)
        return ends.T.reshape(start.shape)

    def _axes(self, i: Number, m: Number, t: Number) -> list[tuple[Number, Number, Number]]:
        """The components of normal forces, with what friction adds at the end and its slopes by the sizes."""
        pose, part = i // len(self.patterns), _grown_part(t)[:, None]
        sides = ((self.own.real[pose], self.by.real[pose]), (self.own.imag[pose], self.by.imag[pose]))
        added = ((a, np.einsum("pjk,pk->pj", c, m), c) for a, c in sides)
        return [(a + part * more, more, c) for a, more, c in added]

    def _value(self, i: Number, m: Number, t: Number) -> Number:
        squares = sum((x * x for x, _, _ in self._axes(i, m, t)), 0.0)
        return m * m - squares - (1.0 - t)[:, None] * self.extra

    def _by_sizes(self, i: Number, m: Number, t: Number) -> Number:
        slopes = sum((x[..., None] * c for x, _, c in self._axes(i, m, t)), 0.0)
        return 2.0 * (m[..., None] * np.eye(m.shape[-1]) - _grown_part(t)[:, None, None] * slopes)

    def _by_time(self, i: Number, m: Number, t: Number) -> Number:
        rate = (1.0 + BEND * (1.0 - 2.0 * t))[:, None]
        moved = sum((x * more for x, more, _ in self._axes(i, m, t)), 0.0)
        return self.extra - 2.0 * rate * moved


def _grown_part(t: Number) -> Number:
    """Return the part of its own value to which C has grown: from 0 to 1 through complex numbers."""
    found: Number = t + BEND * t * (1.0 - t)
    return found


def _owners(influence: FrictionInfluence) -> Number:
    """Return the friction of each normal force."""
    lengths = np.diff(influence.starts, append=len(influence.own))
    return np.repeat(np.arange(len(lengths)), lengths)


def _acting(influence: FrictionInfluence, signs: Number) -> Number:
    """Return the normal forces of pairs that slide."""
    return np.flatnonzero(np.any(signs != 0.0, axis=1)[_owners(influence)])


def _from_starts(influence: FrictionInfluence, signs: Number, starts: Number) -> tuple[Number, Number]:
    """Return the solution to which directions (normal forces, starts, poses) lead at each pose, and its state."""
    count, poses = starts.shape[1:]
    every = np.tile(np.arange(poses), count)
    sums, good = _from_directions(influence.of(every), signs[:, every], starts.reshape(len(starts), -1))
    sums, good = sums.reshape(-1, count, poses), good.reshape(count, poses)
    first = np.take_along_axis(sums, np.argmax(good, axis=0)[None, None], axis=1)
    others = np.abs(sums - first).max(axis=0) > SAME_SOLUTION * np.abs(sums).max(axis=0)
    several = np.any(good & others, axis=0)
    state = np.where(several, SEVERAL, np.where(good.any(axis=0), ONE, NONE))
    return np.where(state != NONE, first[:, 0], np.nan), state


def _from_directions(influence: FrictionInfluence, signs: Number, toward: Number) -> tuple[Number, Number]:
    """Return the solution nearest to given directions of normal forces, and where it is valid."""
    found = np.full(signs.shape, np.nan)
    going, part, senses = np.arange(signs.shape[1]), influence, signs
    for _ in range(NEWTON_STEPS):
        right = part.sums((np.conjugate(toward) * part.own).real)
        sums = solve(_matrix(part, senses, toward), right.T).T
        found[:, going] = sums
        normal_forces = part.normal_forces(-senses * sums)
        before, toward = toward, _directions(normal_forces, np.abs(normal_forces), toward)
        changes = np.any(np.abs(toward - before) > SUM_ROUNDING, axis=0)
        if not changes.any():
            break
        if not changes.all():
            going, part, senses, toward = going[changes], part.of(changes), senses[:, changes], toward[:, changes]
    closed = _distance_from_image(influence, signs, found) <= 10.0 * SUM_ROUNDING * influence.rounding(found)
    return found, closed & np.all(found >= 0.0, axis=0)


def _starts(influence: FrictionInfluence, signs: Number) -> Iterator[Number]:
    """Yield initial directions (normal forces, poses).

    They are the frictionless ones and their opposites in all combinations, and those of frictions that sustain
    themselves, which solutions with large forces have. Forces of pins may point anywhere: some are turned at random.
    """
    own = _directions(influence.own, np.abs(influence.own), 1.0)
    alone = influence.normal_forces(-signs * influence.feeding(signs).T) - influence.own
    fed = _directions(alone, np.abs(alone), 1.0)
    yield from (own * pattern[:, None] for pattern in _patterns(len(own)))
    yield from (fed, -fed)
    is_vector = np.any(own.imag != 0.0, axis=1) | np.any(influence.by.imag != 0.0, axis=(0, 2))
    if is_vector.any():
        turns = np.exp(1j * np.random.default_rng(2).uniform(0.0, TURN, (TURNS, len(own))) * is_vector)
        yield from (around * turn[:, None] for turn in turns for around in (own, fed))


def _patterns(normal_forces: int) -> Number:
    """Return patterns of signs, (patterns, normal forces)."""
    if normal_forces <= ALL_DIRECTIONS:
        return np.array(list(product((1.0, -1.0), repeat=normal_forces)))
    drawn = np.random.default_rng(1).choice([1.0, -1.0], (PATTERNS - 1, normal_forces))
    return np.concatenate([np.ones((1, normal_forces)), drawn])


# A step that leaves more than this part of the residual is replaced by the image, whose residual is smaller for sure.
SHRINKS = 0.5


class PoseFrictions(NamedTuple):
    """The sizes of frictions with their signs at a single pose, and the components of the normal forces under them."""

    sizes: Number
    components: Number
    is_regular: bool = True  # whether the determinant of sums minus image is positive


class NormalForceComponents:
    """The components of normal forces in a row: all in order, vectors by x, then the y of the vectors.

    `owners` are the frictions to which the normal forces belong, `vectors` the indices of those that are vectors.
    """

    def __init__(self, owners: Sequence[int], vectors: Sequence[int]) -> None:
        self.owners, self.vectors = np.array(owners, dtype=int), np.array(vectors, dtype=int)
        self.count = len(owners)
        whole = np.concatenate([self.owners, self.owners[self.vectors]])
        self.frictions = int(whole.max()) + 1
        self.of_frictions = (whole == np.arange(self.frictions)[:, None]).astype(float)
        # which squares make up the squared magnitude that belongs to a component
        self.together = np.eye(len(whole))
        ys = self.count + np.arange(len(self.vectors))
        self.together[self.vectors, ys] = self.together[ys, self.vectors] = 1.0
        self.unit = np.eye(self.frictions)

    def split(self, values: Number) -> Number:
        """Return the components of complex normal forces (..., normal forces)."""
        return np.concatenate([values.real, values[..., self.vectors].imag], axis=-1)

    def joined(self, components: Number) -> Number:
        """Return complex normal forces by their components (..., components)."""
        found = components[..., : self.count].astype(complex)
        found[..., self.vectors] += 1j * components[..., self.count :]
        return found

    def gains(self, by: Number) -> Number:
        """Return the greatest normal force in each pair by a unit of each friction (frictions, components)."""
        sizes = np.sqrt((by * by).dot(self.together))[:, : self.count]
        found: Number = self.of_frictions[:, : self.count].dot(sizes.T)
        return found


# What a vanishing normal force is divided by.
TINY = 1e-300


# not frozen: one is made at every state of a simulation, and frozen fields take five times as long
@dataclass(eq=False)
class PoseInfluence:
    """The influence of frictions at a single pose, with the signs of the motion.

    `own` (components) are the normal forces without friction, `by` (frictions, components) what a unit of each friction
    adds. Normal forces of which a sign is `held` (components), not zero, count by this sign instead of their magnitude,
    so that all is smooth where they change sign; None holds none.
    """

    layout: NormalForceComponents
    own: Number
    by: Number
    signs: Number
    held: Number | None = None

    @cached_property
    def weights(self) -> Number | None:
        """Weights of the sums in whose norm their image contracts, so that there is one solution; None without any.

        They are those of an M-matrix, as in `FrictionInfluence.contracts`.
        """
        gains = self.layout.gains(self.by) * np.abs(self.signs)
        # the plain norm suffices for most mechanisms
        if np.all(gains.sum(axis=1) < 1.0):
            return np.ones(len(self.signs))
        found, singular = _solved_once(self.layout.unit - gains, np.ones(len(self.signs)))
        return found if not singular and np.all(found > 0.0) else None

    def solution(self, weights: Number | None, near: Number | None = None) -> PoseFrictions | None:
        """Return the frictions and normal forces where the image contracts by these weights, all equal if None.

        Newton's steps, or the image where that is better, from no friction or from frictions `near`. None where
        rounding is too large.
        """
        layout, own = self.layout, self.own
        rows = -self.signs[:, None] * self.by
        toward = self._toward(own)
        newton, least, scale = False, np.inf, _largest(own)
        sums = best = layout.of_frictions.dot(toward * own) if near is None else np.abs(near)
        for _ in range(NEWTON_STEPS):
            components = own + sums.dot(rows)
            toward = self._toward(components)
            image = layout.of_frictions.dot(toward * components)
            off = sums - image
            largest = _largest(off)
            gap = largest if weights is None else _largest(off / weights)
            shrinks = not newton or gap <= SHRINKS * least
            if largest <= (1.0 if shrinks else 10.0) * SUM_ROUNDING * max(scale, _largest(sums)):
                if weights is not None:
                    return PoseFrictions(-self.signs * sums, components)
                matrix = layout.unit - (layout.of_frictions * toward).dot(rows.T)
                return PoseFrictions(-self.signs * sums, components, bool(np.linalg.det(matrix) > 0.0))
            newton = shrinks
            if shrinks:
                best, least = image, gap
                matrix = layout.unit - (layout.of_frictions * toward).dot(rows.T)
                sums = sums - _solved_once(matrix, off)[0]
            else:
                sums = best
        return None

    def _toward(self, components: Number) -> Number:
        """Return the directions of normal forces, in their components."""
        sizes = np.sqrt(self.layout.together.dot(components * components))
        found: Number = components / np.maximum(sizes, TINY)
        return found if self.held is None else np.where(self.held, self.held, found)


def _largest(values: Number) -> float:
    """Return the largest magnitude of a few numbers."""
    # of so few faster than an array's
    return float(max(map(abs, values.tolist())))


def _solved_once(matrix: Number, right: Number) -> tuple[Number, bool]:
    """Return the solution of one small system, and whether it is singular, by LAPACK without detours."""
    _, _, found, info = _lapack().dgesv(matrix, right)
    return found, info != 0


@cache
def _lapack() -> Any:
    from scipy.linalg import lapack

    return lapack


# Separating forces of gears are computed again at most so often; each change is a friction's part of the one before.
GEAR_ITERATIONS = 60


@dataclass(frozen=True, eq=False)
class BlockWithFriction:
    """A block of poses under known loads, whose frictions can be computed in any direction of motion."""

    at: LoadedBlock
    contacts: tuple[LoadedContact, ...]
    known: Mapping[str, Wrench]
    units: tuple[Wrench, ...]
    dry: Reactions
    alone: tuple[Reactions, ...]
    influence: FrictionInfluence

    def with_friction(self, sizes: Number) -> Reactions:
        """Return the reactions under frictions of these sizes (frictions, poses)."""
        loads = dict(self.known)
        for k, (contact, unit) in enumerate(zip(self.contacts, self.units, strict=True)):
            for link, wrench in contact.on_links(unit.times(sizes[k].reshape(self.at.block.shape))).items():
                loads[link] = loads.get(link, Wrench()) + wrench
        return all_reactions(self.at, loads)

    def frictions(self, signs: Number) -> Frictions:
        """Return the frictions that oppose motion of the given signs, (frictions, poses).

        The separating force of gears loads bearings as well and depends on what they transmit: with gears the solution
        is repeated until it converges.
        """
        found = solve_coulomb(self.influence, signs)
        gears = any(as_transmitting_pair(self.at.motion.solving_order.pairs[name]) for name in self.dry.pairs)
        for _ in range(GEAR_ITERATIONS if gears else 0):
            before, found = found, solve_coulomb(self._parted(found.sizes), signs)
            change = np.abs(found.sizes - before.sizes)
            if not np.any(change > SUM_ROUNDING * np.abs(found.sizes).max(axis=0)):
                break
        return found

    def _parted(self, sizes: Number) -> FrictionInfluence:
        """Return the influence of frictions, with the separating forces that frictions of these sizes cause."""
        known = np.nan_to_num(sizes)
        normal_forces = normal_forces_of(self.at, self.contacts, self.with_friction(known))
        by_frictions = self.influence.normal_forces(known) - self.influence.own
        return replace(self.influence, own=np.array(normal_forces, dtype=complex) - by_frictions)

    def effort(self, driver: str, sizes: Number) -> Number:
        """Return a driver's effort (poses) under frictions of these sizes."""
        own, *by = (in_one_row(self._effort(driver, found), self.at) for found in (self.dry, *self.alone))
        return own + sum(sizes[k] * one for k, one in enumerate(by))

    def _effort(self, driver: str, found: Reactions) -> Number:
        step = self.at.motion.structure.driven[driver]
        poses = tuple(self.at.block.world[name] for name in step.pair.members)
        along = step.pair.effort(self.at.block.ends[step.pair.name], poses, found.pairs[step.pair.name])
        return along * step.pair.driven_by(step.drive.link)

    def interval(self, driver: str, moved: LoadedBlock, which: Number) -> tuple[Number, Number]:
        """Return the least and the greatest effort that hold a driver at rest.

        `which` is a mask of poses. The efforts start motion in either direction; the limit is infinite where it is
        wedged in that direction.
        """
        signs = senses(self.contacts, moved)
        ends = []
        for way in (-1.0, 1.0):
            found = self.frictions(way * signs)
            effort = np.where(found.state == NONE, way * np.inf, self.effort(driver, found.sizes))
            ends.append(np.where(which, effort, np.nan))
        return np.minimum(*ends), np.maximum(*ends)


def block_with_friction(
    at: LoadedBlock, contacts: tuple[LoadedContact, ...], known: Mapping[str, Wrench]
) -> BlockWithFriction:
    """Return a block with the reactions to each friction alone."""
    order, block = at.motion.solving_order, at.block
    dry = all_reactions(at, known)
    units = tuple(contact.unit(at) for contact in contacts)
    each = [contact.on_links(unit) for contact, unit in zip(contacts, units, strict=True)]
    alone = tuple(reverse_passes(order, block, each))
    return BlockWithFriction(at, contacts, known, units, dry, alone, _influence(at, contacts, dry, alone))


def _influence(
    at: LoadedBlock, contacts: tuple[LoadedContact, ...], dry: Reactions, alone: tuple[Reactions, ...]
) -> FrictionInfluence:
    """Return the normal forces without friction, and those of a unit of each friction."""
    own = [normal_forces_of(at, (contact,), dry) for contact in contacts]
    by = [normal_forces_of(at, contacts, reactions) for reactions in alone]
    starts = np.cumsum([0, *(len(rows) for rows in own[:-1])])
    rows = [row for found in own for row in found]
    return FrictionInfluence(np.array(rows, dtype=complex), np.array(by, dtype=complex), starts)


def normal_forces_of(at: LoadedBlock, contacts: tuple[LoadedContact, ...], reactions: Reactions) -> list[Number]:
    """Return the normal forces of all contacts under some reactions, each in one row; those of pins are complex."""
    return normal_forces_by(at, contacts, _of_pairs(at, reactions))


def normal_forces_by(
    at: LoadedBlock, contacts: tuple[LoadedContact, ...], wrenches: Mapping[str, Wrench]
) -> list[Number]:
    """Return these by the wrenches in the mechanism's own pairs."""
    return [in_one_row(one, at) for contact in contacts for one in contact.normal_forces(at, wrenches[contact.name])]


def _of_pairs(at: LoadedBlock, reactions: Reactions) -> Mapping[str, Wrench]:
    """Return the wrenches of the mechanism's own pairs; some of them are partly free if it is overconstrained."""
    structure = at.motion.structure
    if structure.relaxation is None:
        return reactions.pairs
    return own_wrenches(structure, reactions.pairs, at.motion.failed[at.designs, at.poses].shape)


# Power iterations for Perron's vector, with a shift against alternating vectors.
POWER_STEPS, SHIFT = 50, 0.1


@dataclass(frozen=True)
class FrictionInfluence:
    """Normal forces in pairs with friction, which are affine in the sizes of the frictions.

    `own` (normal forces, poses) are those without friction, complex; `by` (frictions, normal forces, poses) what a unit
    of each friction adds; `starts` (frictions) are the indices of the first normal force of each friction.
    """

    own: Number
    by: Number
    starts: Number

    def of(self, which: Number) -> FrictionInfluence:
        """Return the influence at some poses."""
        return FrictionInfluence(self.own[:, which], self.by[..., which], self.starts)

    def normal_forces(self, sizes: Number) -> Number:
        """Return the normal forces (normal forces, poses) under frictions of these sizes (frictions, poses)."""
        total = self.own
        for one, size in zip(self.by, sizes, strict=True):
            total = total + one * size
        return total

    def sums(self, values: Number) -> Number:
        """Return sums over the normal forces of each friction, of values (..., normal forces, poses)."""
        if len(self.starts) == len(self.own):
            return values
        return np.add.reduceat(values, self.starts, axis=-2)

    def rounding(self, sizes: Number) -> Number:
        """Return the largest of the terms that cancel in the normal forces at each pose."""
        total = np.abs(self.own)
        for one, size in zip(self.by, sizes, strict=True):
            total = total + np.abs(one) * np.abs(size)
        return total.max(axis=0)

    def gains(self, signs: Number) -> Number:
        """Return the greatest normal force in each pair by a unit of each friction, (poses, pairs, frictions)."""
        return (self.sums(np.abs(self.by)) * np.abs(signs)[:, None]).transpose(2, 1, 0)

    def contracts(self, signs: Number) -> Number:
        """Return where frictions have one solution for any load: where identity minus gains is an M-matrix.

        The iteration then contracts in some weighted norm.
        Source: A. Berman and R. J. Plemmons, Nonnegative Matrices in the Mathematical Sciences, theorem 6.2.3.
        """
        gains = self.gains(signs)
        # the plain norm suffices for most mechanisms
        sure: Number = gains.sum(axis=-1).max(axis=-1) < 1.0
        asked = np.flatnonzero(~sure)
        if len(asked):
            weights = solve(np.eye(gains.shape[-1]) - gains[asked], np.ones((len(asked), gains.shape[-1])))
            sure[asked] = np.all(weights > 0.0, axis=-1)
        return sure

    def feeding(self, signs: Number) -> Number:
        """Return Perron's vector of the gains (poses, frictions), its maximum 1: how frictions amplify each other."""
        gains, vector = self.gains(signs), np.ones(signs.T.shape)
        for _ in range(POWER_STEPS):
            vector = np.einsum("pij,pj->pi", gains, vector) + SHIFT * vector
            vector = vector / vector.max(axis=-1, keepdims=True)
        return vector
