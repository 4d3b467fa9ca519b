"""What is redundant at a mechanism's own dimensions: states of self-stress, and the structure without it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.slot import pin_in_slot, releases
from compoundkin.structure.composites import GROUND, Composites, composites
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import Dropped, Group, Relaxation
from compoundkin.structure.redundancy.constraint_equations import (
    ROUNDED,
    STRICT,
    Array,
    AssembledPose,
    ConstraintEquations,
    Tolerance,
    assemble,
    corrected,
)
from compoundkin.structure.redundancy.finite_motion import FiniteMotion, finite_motion, null_space, rank_of

# Wider equations than those of some hundred links take a dense decomposition many seconds.
WIDEST = 1500


# What opens by so many times the rounding of printed dimensions is not closed by taking them to be rounded.
FAR = 100.0


# At a pose that is found by iteration where the equations are singular, residuals of 1e-15 leave the pose, and so what
# ought to be zero, uncertain by their root.
ITERATED = 1e-6


# The bodies of a dyad, and the letters of its pairs where it has a closed form.
DYAD, SIMPLE = 2, frozenset("RP")


# How many structures are compared, and by how much weaker than the first choice others may be.
COMPARED = 400


WEAKER = 0.1


# A group without a closed form takes so many times as long as a dyad, and more with the number of its bodies.
GENERAL = 10


# Takes a mechanism apart, part of some pairs left out.
Decomposed: TypeAlias = Callable[[Mechanism, Relaxation], Structure]


@dataclass(frozen=True)
class Diagnosis:
    """The diagnosis of a mechanism at its own dimensions.

    An assembled pose, how it moves, and its states of self-stress.
    """

    equations: ConstraintEquations
    pose: AssembledPose

    @cached_property
    def rows(self) -> Array:
        """The rows of the pairs at the assembled pose."""
        return self.equations.jacobian(self.pose.state)[0]

    @property
    def dependent(self) -> float:
        """The part of the largest below which a singular value is zero. It is at the assembled pose."""
        return max(self.equations.tolerance.rank, 0.0 if self.pose.is_given else ITERATED)

    @cached_property
    def rank(self) -> int:
        """The rank of the rows."""
        return rank_of(self.rows, self.dependent)

    @cached_property
    def motion(self) -> FiniteMotion:
        """How it moves. Where no row is redundant, all that is left free is motion."""
        state = self.pose.state
        if self.rank == len(self.rows):
            free = null_space(self.rows, self.dependent)
            return FiniteMotion(state, free, free.shape[1])
        return finite_motion(self.equations, state, self.dependent)

    @cached_property
    def stress(self) -> Array:
        """The states of self-stress, at a pose that is not special."""
        if self.rank == len(self.rows):
            # independent rows have none
            return np.zeros((self.rank, 0))
        return stresses(self.equations, self.motion.state)

    @cached_property
    def candidates(self) -> list[Candidate]:
        """What may be left out."""
        bodies = composites(self.equations.mechanism)
        return candidates(self.equations, self.motion.state, self.stress, bodies) if self.stress.shape[1] else []

    @property
    def determined(self) -> int:
        """How many of its motions the drivers determine."""
        return rank_of(self.equations.driving(self.motion.state) @ self.motion.along, self.equations.tolerance.rank)


def diagnose(mechanism: Mechanism, poses: Mapping[str, Pose] | None = None, everywhere: bool = True) -> Diagnosis:
    """Diagnose a mechanism at its own dimensions. They are taken to be rounded where exact ones leave no motion.

    Without poses one is looked for: near the drawing, and `everywhere` from random starts too.
    """
    exact = _diagnosed(mechanism, STRICT, poses, everywhere)
    if exact.pose.is_closed and (exact.rank == len(exact.rows) or exact.motion.along.shape[1]):
        return exact
    if not exact.pose.is_closed and exact.pose.residual > FAR * ROUNDED.closed:
        # so far open is nothing by rounding
        return exact
    rounded = _diagnosed(mechanism, ROUNDED, poses, everywhere)
    return rounded if rounded.pose.is_closed and rounded.motion.along.shape[1] else exact


def _diagnosed(
    mechanism: Mechanism, tolerance: Tolerance, poses: Mapping[str, Pose] | None, everywhere: bool
) -> Diagnosis:
    equations = ConstraintEquations(mechanism, tolerance)
    if poses is None:
        return Diagnosis(equations, assemble(equations, everywhere))
    return Diagnosis(equations, corrected(equations, equations.state(poses)))


def without_redundancy(structure: Structure, decomposed: Decomposed, everywhere: bool = True) -> Structure:
    """Return the structure without what is redundant. This is where its mechanism moves although it is overconstrained.

    The structure itself where nothing moves, or where its equations are too many to tell. `decomposed` takes the
    mechanism apart without some parts of pairs; what remains falls into dyads, which have closed forms, where it can.
    """
    mechanism = structure.mechanism
    if 3 * len(mechanism.links) > WIDEST:
        return structure
    with np.errstate(all="ignore"):
        found = diagnose(mechanism, None, everywhere)
        if not found.pose.is_closed or found.motion.along.shape[1] <= len(structure.passive):
            return structure
        return _chosen(structure, found, decomposed)


def _chosen(structure: Structure, found: Diagnosis, decomposed: Decomposed) -> Structure:
    states = found.stress.shape[1]
    picked = chosen(found.candidates, states)
    if not picked:
        return structure
    pose = _relaxation(found)

    def made(parts: Sequence[Candidate]) -> Structure:
        return decomposed(structure.mechanism, replace(pose, dropped=tuple(one.dropped for one in parts)))

    limit, order = WEAKER * strength(picked), found.candidates
    best = made(picked)
    least, left = _cost(best, picked, order), COMPARED
    improved = True
    while improved and left > 0:
        improved = False
        for other in _neighbours(picked, order):
            if left <= 0:
                break
            if sum(len(one.forces) for one in other) != states or strength(other) < limit:
                continue
            left -= 1
            trial = made(other)
            cost = _cost(trial, other, order)
            if cost < least:
                best, least, picked, improved = trial, cost, other, True
                break
    return best if _excess(best) < _excess(structure) else structure


def _neighbours(picked: Sequence[Candidate], order: Sequence[Candidate]) -> list[list[Candidate]]:
    """List the choices in which one part is exchanged, the last written first."""
    found = []
    for k in range(len(picked)):
        rest = [*picked[:k], *picked[k + 1 :]]
        taken = {one.place for one in rest}
        found += [[*rest, other] for other in reversed(order) if other.place not in taken and other is not picked[k]]
    return found


def _cost(made: Structure, picked: Sequence[Candidate], order: Sequence[Candidate]) -> tuple[int, ...]:
    """Weigh what is left undecomposed or may fail, how hard the groups are, and what is left out."""
    places = list(dict.fromkeys(one.place for one in order))
    early = sum(len(places) - places.index(one.place) for one in picked)
    oblique = sum(not one.is_aligned for one in picked)
    return _excess(made), oblique, sum(_effort(group) for group in made.groups), early


def _excess(structure: Structure) -> int:
    return sum(fault.amount for fault in structure.faults)


def _effort(group: Group) -> int:
    count = len(group.bodies)
    is_closed = (count == DYAD and set(group.name) <= SIMPLE) or (count == 1 and len(group.outer) == 2)
    return count if is_closed else GENERAL * count * count


def _relaxation(found: Diagnosis) -> Relaxation:
    """Return the assembled pose; where nothing is drawn, one that is not special."""
    equations = found.equations
    drawn = bool(equations.mechanism.sketch)
    poses = equations.poses(found.pose.state if drawn else found.motion.state)
    carriers = equations.mechanism.carriers
    places = {letter: equations.place(poses, names[0], letter) for letter, names in carriers.items()}
    return Relaxation((), places, poses)


# A pair takes part in a state of self-stress if its share is above this.
PART = 1e-6


# To leave out what carries less than this of the stress would leave the rest nearly dependent.
WEAK = 1e-3


# Stresses that differ by less are the same: the later part is left out, as the one more likely to have been added.
ALIKE = 0.02


@dataclass(frozen=True)
class Candidate:
    """The part of a pair that may be left out, and its forces. It has a row for each coordinate, of every state.

    It is aligned where it carries all the force there is in every pose, as a slot along a bar does.
    """

    dropped: Dropped
    forces: Array
    is_aligned: bool = True

    @property
    def place(self) -> tuple[str, tuple[str, ...]]:
        """The pair or the part of a pin. Nothing is left out of one of them twice."""
        return self.dropped.name, self.dropped.off


def stresses(equations: ConstraintEquations, state: Array) -> Array:
    """Return an orthonormal basis of the states of self-stress, in columns. It goes by the rows of the pairs."""
    rows, _ = equations.jacobian(state)
    if not len(rows):
        return np.zeros((0, 0))
    left, values, _ = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(values > equations.tolerance.rank * max(values, default=1.0)))
    return np.asarray(left[:, rank:])


def stressed_pairs(equations: ConstraintEquations, stress: Array) -> tuple[str, ...]:
    """Name the pairs that take part in a state of self-stress."""
    shares = ((rows.pair.name, stress[rows.first : rows.last]) for rows in equations.rows)
    return tuple(name for name, share in shares if np.max(np.abs(share), initial=0.0) > PART)


def candidates(equations: ConstraintEquations, state: Array, stress: Array, bodies: Composites) -> list[Candidate]:
    """List all that may be left out, in the order of the mechanism."""
    _, lengths = equations.jacobian(state)
    found = list(_of_pins(equations, state, stress * (equations.size / lengths)[:, None], bodies))
    joined = {step.pair.name for body in (bodies.ground, *bodies.moving) for step in body.driven}
    for rows in equations.rows[len(equations.pins) :]:
        for way in releases(rows.pair) if rows.pair.name not in joined else ():
            dropped = Dropped(rows.pair.name, (), way.kept, way.freed)
            found.append(Candidate(dropped, stress[[rows.first + k for k in way.coordinates]]))
    return [one for one in found if _carries(one.forces)]


def _of_pins(equations: ConstraintEquations, state: Array, stress: Array, bodies: Composites) -> Iterator[Candidate]:
    """Take a body off a pin, or leave it in a slot there."""
    poses = equations.poses(state)
    forces = _forces(equations, stress)
    for letter, names in equations.mechanism.pins.items():
        by_body: dict[int, list[str]] = {}
        for name in names:
            by_body.setdefault(bodies.body_of[name], []).append(name)
        for body, links in by_body.items():
            others = [name for name in names if name not in links]
            if body == GROUND or not others or (len(by_body) == 2 and GROUND not in by_body and body != max(by_body)):
                continue
            force = np.sum([forces[letter, name] for name in links], axis=0)
            yield from _slots(equations, poses, letter, (tuple(links), others[0]), force)
            yield Candidate(Dropped(letter, tuple(links), None, f"as a whole on {links[0]}"), force)


def _slots(
    equations: ConstraintEquations,
    poses: dict[str, Pose],
    letter: str,
    sides: tuple[tuple[str, ...], str],
    force: Array,
) -> Iterator[Candidate]:
    """Hold a body on a pin in a slot, in the direction of another point of either link."""
    off, other = sides
    for slotted, pinned in ((off[0], other), (other, off[0])):
        points = equations.mechanism.links[slotted].points
        for through in (name for name in points if name != letter):
            line = equations.place(poses, slotted, letter) - equations.place(poses, slotted, through)
            if abs(line) > 0.0:
                along = np.array([line.real, line.imag]) / abs(line)
                kept = pin_in_slot(letter, pinned, slotted, through)
                freed = f"along {through}{letter} of {slotted}"
                is_bar = off == (slotted,) and _is_bar(equations.mechanism, slotted, letter, through)
                yield Candidate(Dropped(letter, off, kept, freed), (along @ force)[None], is_bar)


def _is_bar(mechanism: Mechanism, link: str, one: str, two: str) -> bool:
    """Tell whether a link has no pairs but two pins, neither of them driven: the force in it is along it."""
    on_it = [pair for pair in mechanism.written_pairs if link in pair.members]
    driven = [drive for drive in mechanism.drives if link in (drive.link, drive.on)]
    pinned = [letter for letter, names in mechanism.pins.items() if link in names]
    return not on_it and not driven and sorted(pinned) == sorted((one, two))


def _forces(equations: ConstraintEquations, stress: Array) -> dict[tuple[str, str], Array]:
    """Return the forces of every pin on every link at it, (2, states)."""
    found: dict[tuple[str, str], Array] = {}
    for rows in equations.rows[: len(equations.pins)]:
        letter, (first, second) = rows.pair.letters[0], rows.pair.members
        force = stress[rows.first : rows.last]
        found[letter, second] = force
        found[letter, first] = found.get((letter, first), 0.0) - force
    return found


def _carries(forces: Array) -> bool:
    """Tell whether every coordinate carries a force of its own."""
    values = np.linalg.svd(forces, compute_uv=False)
    return len(forces) <= forces.shape[1] and bool(values[-1] > PART)


def chosen(given: Sequence[Candidate], states: int) -> list[Candidate]:
    """Choose candidates that take away all states of self-stress and no more.

    Each time it is the one that carries most.

    Aligned ones go before others.
    """
    found: list[Candidate] = []
    # what each candidate carries of the states that are left
    carried, places = [one.forces for one in given], [one.place for one in given]
    taken, count = set[object](), states
    while count:
        index = [k for k, place in enumerate(places) if place not in taken and len(carried[k]) <= count]
        shares = _shares([carried[k] for k in index])
        aligned = [share for k, share in zip(index, shares, strict=True) if given[k].is_aligned and share > WEAK]
        most = max(aligned or shares, default=0.0)
        if most <= WEAK:
            return []
        best = [
            k
            for k, share in zip(index, shares, strict=True)
            if share >= (1.0 - ALIKE) * most and (given[k].is_aligned or not aligned)
        ][-1]
        found.append(given[best])
        taken.add(places[best])
        rest = np.linalg.qr(carried[best].T, mode="complete")[0][:, len(carried[best]) :]
        count -= len(carried[best])
        joined = np.concatenate(carried) @ rest
        carried = np.split(joined, np.cumsum([len(forces) for forces in carried])[:-1])
    return found


def _shares(forces: Sequence[Array]) -> list[float]:
    """Return the least singular value of each matrix, those of one size together."""
    found = np.zeros(len(forces))
    for rows in {len(one) for one in forces}:
        some = [k for k, one in enumerate(forces) if len(one) == rows]
        found[some] = np.linalg.svd(np.stack([forces[k] for k in some]), compute_uv=False)[:, -1]
    return [float(share) for share in found]


def strength(given: Sequence[Candidate]) -> float:
    """Measure how well the candidates together carry all states. It is the least singular value of their forces."""
    if not given:
        return 0.0
    return float(np.linalg.svd(np.vstack([one.forces for one in given]), compute_uv=False)[-1])
