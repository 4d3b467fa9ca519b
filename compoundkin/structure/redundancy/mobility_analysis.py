"""How many freedoms a mechanism has: by count, at general dimensions, at its own, and how many of these are motions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import DisplaysHtml, count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.linear import one_thread
from compoundkin.base.poses import Pose
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.decomposition import decompose
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.redundancy.constraint_equations import ROUNDED, ConstraintEquations
from compoundkin.structure.redundancy.diagnosis import WIDEST, Diagnosis, chosen, diagnose, stressed_pairs
from compoundkin.structure.redundancy.finite_motion import PassiveFreedom, passive_freedoms, rank_of

# Singular values at random geometry are zero below this part of the largest. They get small in long mechanisms.
GENERIC = 1e-12


@dataclass(frozen=True)
class MobilityGap:
    """The pair that is open most where nothing is assembled. Its residual is in its own unit."""

    pair: str
    amount: float


@dataclass(frozen=True)
class MobilityAnalysis(DisplaysHtml):
    """The freedoms of a mechanism with its drivers free. Passive freedoms of rollers are not counted.

    `gruebler` is the count, `generic` what pairs of these kinds between these links leave free at general dimensions,
    `at_pose` what they leave free at the assembled pose (None where none was found), and `finite` how many of these
    are motions and not infinitesimal ones. `determined` of them the drivers determine.

    `redundant` coordinates hold what others hold already (`redundant_generic` of them at general dimensions): `freed`
    is a smallest set whose release changes no motion, `undetermined` are the pairs whose reactions a rigid-body
    analysis cannot determine. `passive` are freedoms of single links beyond those of rollers.
    """

    gruebler: int
    generic: int
    redundant_generic: int
    drivers: int
    at_pose: int | None = None
    finite: int | None = None
    determined: int | None = None
    redundant: int | None = None
    freed: tuple[str, ...] = ()
    undetermined: tuple[str, ...] = ()
    passive: tuple[PassiveFreedom, ...] = ()
    gap: MobilityGap | None = None
    rounded: bool = False

    @property
    def agrees(self) -> bool:
        """Whether count, general dimensions and the assembled pose say the same. Nothing may be passive then."""
        return self.gruebler == self.generic == self.at_pose == self.finite and not self.passive

    @property
    def useful(self) -> int | None:
        """How many motions are left without passive freedoms."""
        return None if self.finite is None else self.finite - len(self.passive)

    @property
    def is_overconstrained(self) -> bool:
        """Whether some coordinates hold what others hold already."""
        return bool(self.redundant or self.redundant_generic)

    @property
    def moves(self) -> bool:
        """Whether it moves, its drivers free."""
        return bool(self.finite)

    @property
    def kind(self) -> str:
        """What it is, in a word or two.

        >>> MobilityAnalysis(0, 0, 0, 1, at_pose=1, finite=1, determined=1, redundant=1).kind
        'overconstrained but mobile'
        """
        if self.finite is None or self.at_pose is None:
            return "not assembled" if self.gap else "not known"
        if not self.finite:
            return "shaky (infinitesimally movable only)" if self.at_pose else "rigid"
        if self.determined is not None and self.determined < self.drivers:
            return "locked by its drivers"
        return "overconstrained but mobile" if self.is_overconstrained else "mobile"

    @property
    def is_determinate(self) -> bool:
        """Whether it moves and its drivers, none of them idle, determine the motion."""
        return bool(self.useful) and self.useful == self.determined == self.drivers

    @property
    def verdict(self) -> str:
        """What it is and why, in a sentence.

        >>> MobilityAnalysis(1, 1, 0, 1, at_pose=1, finite=1, determined=1, redundant=0).verdict
        'mobile with 1 freedom, determined by its driver'
        """
        if self.finite is None:
            if self.gap is None:
                return "its dimensions were not examined"
            return f"no assembled pose was found: {self.gap.pair} is open by {self.gap.amount:.6g}"
        parts = [self.kind, *self._redundancy()] if not self.finite else [self._motion(), *self._redundancy()]
        return "; ".join(parts)

    def _motion(self) -> str:
        assert self.finite is not None
        free = f"{self.kind} with {count_phrase(self.finite, 'freedom')}"
        found = self.determined or 0
        own = "its driver" if self.drivers == 1 else f"its {self.drivers} drivers"
        if found < self.drivers:
            spare = count_phrase(self.drivers - found, "driver")
            return f"{free}: {spare} too many, or where nothing is free"
        missing = self.finite - len(self.passive) - found
        if missing > 0:
            return f"{free}, {count_phrase(missing, 'driver')} missing"
        return f"{free}, determined by {own}"

    def _redundancy(self) -> list[str]:
        if not self.redundant:
            return []
        what = f"{count_phrase(self.redundant, 'coordinate')} held twice"
        return [f"{what}: {', '.join(self.freed)} could be freed" if self.freed else what]


@checked
@one_thread
def mobility_analysis(mechanism: Mechanism | Structure, poses: Mapping[str, Pose] | None = None) -> MobilityAnalysis:
    """Find the mobility by count, for general dimensions and at the assembled pose.

    It tells as well what is redundant or passive. The pose is that of `poses`, of order 0, by the links' names; else
    the drawn one, made exact; without a drawing, one at the drivers' first values. Lengths of several designs are those
    of the first. Of a mechanism without dimensions the first two are told.

    Source: the count is that of Chebyshev and Gruebler; the others are the nullity of the constraint Jacobian.

    >>> from compoundkin.model.elements import drawn, drive, link
    >>> cranks = [link(name, *letters) for name, letters in {"a": "AB", "b": "CD", "c": "EF"}.items()]
    >>> lift = Mechanism("Three cranks", link("frame", *"ACE"), *cranks, link("table", *"BDF"), drive("a"),
    ...                  drawn(A=0, C=3, E=6, B=1 + 2j, D=4 + 2j, F=7 + 2j))
    >>> found = mobility_analysis(lift)
    >>> found.gruebler, found.generic, found.at_pose, found.finite
    (0, 0, 1, 1)
    >>> found.kind
    'overconstrained but mobile'
    """
    structure = mechanism if isinstance(mechanism, Structure) else decompose(mechanism)
    missing = [] if poses is None else [name for name in structure.mechanism.links if name not in (FRAME, *poses)]
    if missing:
        raise InvalidInput(Problem("poses", f"there is no pose of {missing[0]!r}", "give one for every moving link"))
    with np.errstate(all="ignore"):
        return _analysed(structure, poses)


def _analysed(structure: Structure, poses: Mapping[str, Pose] | None) -> MobilityAnalysis:
    equations, passive = ConstraintEquations(structure.mechanism), len(structure.passive)
    counts = structure.mobility.freedoms, structure.mobility.drivers
    if equations.width > WIDEST:
        return MobilityAnalysis(counts[0], counts[0], 0, counts[1])
    rank = rank_of(equations.generic, GENERIC)
    generic = equations.width - rank - passive, equations.held - rank
    if structure.mechanism.unplaced:
        return MobilityAnalysis(counts[0], *generic, counts[1])
    found = diagnose(structure.mechanism, poses)
    equations = found.equations
    if not found.pose.is_closed:
        return MobilityAnalysis(counts[0], *generic, counts[1], gap=_gap(found))
    state, free = found.motion.state, found.motion.along.shape[1] - passive
    stress = found.stress
    return MobilityAnalysis(
        counts[0],
        *generic,
        counts[1],
        at_pose=equations.width - found.rank - passive,
        finite=free,
        determined=found.determined,
        redundant=stress.shape[1],
        freed=_freed(structure, found),
        undetermined=stressed_pairs(equations, stress),
        passive=tuple(one for one in passive_freedoms(equations, state) if not _is_roller(structure, one)),
        rounded=equations.tolerance is ROUNDED,
    )


def _freed(structure: Structure, found: Diagnosis) -> tuple[str, ...]:
    """List what a structure leaves out already; else what it could leave out."""
    if structure.relaxation:
        return tuple(map(str, structure.relaxation.dropped))
    return tuple(str(one.dropped) for one in chosen(found.candidates, found.stress.shape[1]))


def _is_roller(structure: Structure, one: PassiveFreedom) -> bool:
    return any(one == PassiveFreedom(spin.link, f"turn about {spin.at}") for spin in structure.passive)


def _gap(found: Diagnosis) -> MobilityGap:
    equations = found.equations
    open_by = np.abs(equations.closures(found.pose.state))
    worst = max(equations.rows, key=lambda rows: float(np.max(open_by[rows.first : rows.last])))
    return MobilityGap(worst.pair.name, float(np.linalg.norm(open_by[worst.first : worst.last])))
