"""Which two lines give which centre, and in which order. From the circle diagram alone.

Source: the theorem of Aronhold (1872) and Kennedy (1886), that the three relative centres of three links lie on
a line; the circle diagram that organises it is in every textbook on kinematics.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple
from compoundkin.analysis.centres.derivation_steps import (
    DerivationStep,
    Given,
    LineCrossing,
    Move,
    Rule,
    SolvedCentre,
    steps_of,
)
from compoundkin.analysis.centres.known_centres import KnownCentres
from compoundkin.analysis.centres.rate_sets import driver_rate_sets
from compoundkin.analysis.centres.trial_position import trial_position
from compoundkin.base.display import PrintsShort

# Diagrams kept; each holds a few kilobytes.
KEPT = 256


@dataclass(frozen=True, repr=False)
class Derivation(PrintsShort):
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

    Raises NotDetermined where the diagram's motion is not given by its drivers.
    """
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
