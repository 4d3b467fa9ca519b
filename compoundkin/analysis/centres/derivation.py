"""Which two lines give which centre, and in which order. From the circle diagram alone.

Where repeated crossing stalls, an unknown centre still lies on a line. A position on that line, that is a ratio of
two rates, carried along known centres, moves other centres along straight loci; where a locus meets a line that
must hold its centre is the answer. All of it is linear in the trial value, so that two positions fix a locus.

Sources: the theorem of Aronhold (1872) and Kennedy (1886), that the three relative centres of three links lie on
a line; the circle diagram that organises it is in every textbook on kinematics. Trial positions:
D. E. Foster and G. R. Pennock, "A graphical method to find the secondary instantaneous centers of zero
velocity for the double butterfly linkage", J. Mech. Des. 125 (2003) 268-274, and "Graphical methods to locate the
secondary instant centers of single-degree-of-freedom indeterminate linkages", J. Mech. Des. 127 (2005) 249-256;
R. Di Gregorio, "An algorithm for analytically calculating the positions of the secondary instant centers of
indeterminate linkages", J. Mech. Des. 130 (2008) 042303.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple
from compoundkin.analysis.centres.derivation_steps import (
    DerivationStep,
    Given,
    LineCrossing,
    Move,
    Rule,
    SolvedCentre,
    Trial,
    Turn,
    steps_of,
)
from compoundkin.analysis.centres.known_centres import KnownCentres
from compoundkin.analysis.centres.rate_sets import RateSets, driver_rate_sets
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem

# Diagrams kept; each holds a few kilobytes.
KEPT = 256
# The derivation of more takes more than ten seconds, for its work grows with the fourth power.
MOST_LINKS = 50
# Each value adds one to the trial positions; the search grows by a factor of some ten with each.
MOST_VALUES = 3


@dataclass(frozen=True, repr=False)
class Derivation(ShortRepr):
    """The order in which the centres of a circle diagram are found.

    `body[k]` is the first link of those that move as one with link k; rules speak of bodies. `moves` carry the
    drivers' rates to every body, once all centres are known.
    """

    diagram: Diagram
    body: tuple[int, ...]
    rules: tuple[Rule, ...]
    moves: tuple[Move, ...]

    @property
    def steps(self) -> tuple[DerivationStep, ...]:
        """The rules in words, in order."""
        return tuple(step for rule in self.rules for step in steps_of(self.diagram, rule))

    def own_lines(self, found: Couple) -> tuple[int, ...]:
        """Return the primaries that are a line for a centre."""
        return tuple(
            k for k, p in enumerate(self.diagram.primaries)
            if p.kind == "line" and couple(*(self.body[link] for link in p.links)) == found
        )  # fmt: skip


@lru_cache(KEPT)
def derive(diagram: Diagram) -> Derivation:
    """Return the derivation of a circle diagram; made once for each diagram.

    Rounds of repeated crossing until all is found; where that stalls, one centre by the drivers' rates or by
    trial, then on. Work grows with the fourth power of the number of links.

    Raises NotDetermined where the diagram's motion is not given by its drivers, InvalidInput above MOST_LINKS links.
    """
    if (links := len(diagram.links)) > MOST_LINKS:
        what = f"{links} links have {links * (links - 1) // 2:,} instant centres, too many to derive"
        raise InvalidInput(Problem("links", what, f"take a part of the mechanism, of {MOST_LINKS} links at most"))
    centres = KnownCentres(diagram)
    rules: list[Rule] = list(_primary(centres))
    while centres.unknown:
        found = _round(centres) or _stalled(centres)
        rules += found
    return Derivation(diagram, centres.body, tuple(rules), driver_rate_sets(centres, bridges=False).moves)


def _primary(centres: KnownCentres) -> list[Given]:
    found = []
    for k, primary in enumerate(centres.diagram.primaries):
        for link, other in combinations(primary.links, 2):
            i, j = couple(centres.body[link], centres.body[other])
            if i == j or centres.knows(i, j):
                continue
            if primary.kind == "line":
                centres.own_lines.setdefault((i, j), []).append(k)
            else:
                centres.rounds[i, j] = 0
                found.append(Given((i, j), k))
    return found


def _round(centres: KnownCentres) -> list[Rule]:
    """Return every centre on which two lines are known by now."""
    found: list[Rule] = []
    for i, j in centres.unknown:
        lines = centres.crossing(i, j)
        if lines is not None:
            found.append(LineCrossing((i, j), lines))
    _note(centres, [rule.found for rule in found if isinstance(rule, LineCrossing)])
    return found


def _stalled(centres: KnownCentres) -> list[Rule]:
    """Return the next centres by rates or trial. What even that does not give comes from the solved velocities."""
    trial = trial_position(centres)
    if trial is not None:
        _note(centres, list(trial.found))
        return [trial]
    solved: list[Rule] = [SolvedCentre(c) for c in centres.unknown]
    _note(centres, centres.unknown)
    return solved


def _note(centres: KnownCentres, found: list[Couple]) -> None:
    now = 1 + max(centres.rounds.values(), default=0)
    centres.rounds.update(dict.fromkeys(found, now))


def trial_position(centres: KnownCentres) -> Trial | None:
    """Return the next centres by rates, or by as few trial values as possible. None if none will."""
    starts = list(_starts(centres))
    for start in [driver_rate_sets(centres, bridges=False), *starts]:
        inside = [c for c in start.together() if not centres.knows(*c)]
        if inside and start.parameters == 1:
            return Trial(tuple(inside), start.moves, ())
    for values in range(1, MOST_VALUES + 1):
        for start in starts:
            found = _search(start, values)
            if found is not None:
                return found
    return None


def _starts(centres: KnownCentres) -> Iterator[RateSets]:
    """Yield the rates of several drivers. With one, a rate about any known centre, for all are in proportion."""
    if len(centres.diagram.drives) > 1:
        yield driver_rate_sets(centres)
        return
    for i, j in centres.rounds:
        sets = RateSets.of(centres).turned(Turn(i, j, 0), np.array(centres.place(i, j)))
        sets.grow()
        yield sets


def _search(sets: RateSets, values: int) -> Trial | None:
    for turn in _turns(sets):
        grown = sets.turned(turn, np.array(sets.centres.place(turn.i, turn.k)))
        grown.grow()
        if grown.solved:
            return Trial((_on_trial(grown),), grown.moves, grown.meetings)
        found = _search(grown, values - 1) if values > 1 else None
        if found is not None:
            return found
    return None


def _turns(sets: RateSets) -> Iterator[Turn]:
    """Yield the trial values that may come next. About a known centre between a moving set and what is outside."""
    sizes: dict[int, int] = {}
    for owner in sets.member.values():
        sizes[owner] = sizes.get(owner, 0) + 1
    for c in sets.centres.rounds:
        for i, k in (c, c[::-1]):
            if sets.member[i] != sets.member[k] and sizes[sets.member[i]] > 1:
                yield Turn(i, k, sets.parameters)


def _on_trial(sets: RateSets) -> Couple:
    """Return the unknown centre whose place was tried.

    On the line of the first trial value's centre and one of its set.
    """
    unknown = [c for c in sets.together() if not sets.centres.knows(*c)]
    first = next(move for move in sets.moves if isinstance(move, Turn) and move.parameter == 1)
    tried = [couple(j, first.k) for j in sets.member if j != first.i and sets.centres.knows(first.i, j)]
    return next((c for c in tried if c in unknown), unknown[0])
