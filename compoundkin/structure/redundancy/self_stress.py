"""What pairs hold that others hold already: how much, in which pairs, and what could be left out.

A state of self-stress, forces in the pairs that balance each other without any load, is a vector of the left null
space of the Jacobian; a pair with forces in it has reactions that no rigid-body analysis determines. To leave out a
coordinate of such a pair takes away one such state and changes no motion.
Source: S. Pellegrino and C. R. Calladine, Matrix analysis of statically and kinematically indeterminate
frameworks, Int. J. Solids Structures 22 (1986) 409.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.slot import pin_in_slot, releases
from compoundkin.structure.composites import GROUND, Composites
from compoundkin.structure.parts import Dropped
from compoundkin.structure.redundancy.constraint_equations import Array, ConstraintEquations

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
    left = np.eye(states)
    while left.shape[1]:
        taken = {one.place for one in found}
        open_to = [one for one in given if one.place not in taken and len(one.forces) <= left.shape[1]]
        shares = [float(np.linalg.svd(one.forces @ left, compute_uv=False)[-1]) for one in open_to]
        aligned = [share for one, share in zip(open_to, shares, strict=True) if one.is_aligned and share > WEAK]
        most = max(aligned or shares, default=0.0)
        if most <= WEAK:
            return []
        best = [
            one
            for one, share in zip(open_to, shares, strict=True)
            if share >= (1.0 - ALIKE) * most and (one.is_aligned or not aligned)
        ]
        one = best[-1]
        found.append(one)
        _, _, right = np.linalg.svd(one.forces @ left, full_matrices=True)
        left = left @ right[len(one.forces) :].T
    return found


def strength(given: Sequence[Candidate]) -> float:
    """Measure how well the candidates together carry all states. It is the least singular value of their forces."""
    if not given:
        return 0.0
    return float(np.linalg.svd(np.vstack([one.forces for one in given]), compute_uv=False)[-1])
