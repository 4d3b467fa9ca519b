"""Which two lines give which centre, and in which order: from the circle diagram alone.

Source: the theorem of Aronhold (1872) and Kennedy (1886), that the three relative centres of three links lie on
a line; the circle diagram that organises it is in every textbook on kinematics.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple
from compoundkin.analysis.centres.derivation_steps import Crossing, Given, Move, Rule, Solved, Step, steps_of
from compoundkin.analysis.centres.known_centres import Knowledge
from compoundkin.analysis.centres.rate_sets import drivers_growth
from compoundkin.analysis.centres.trial_position import find_trial

# Diagrams kept; each holds a few kilobytes.
KEPT = 256


@dataclass(frozen=True)
class Derivation:
    """The order in which the centres of a circle diagram are found, each by one rule.

    `body[k]` is the first link of those that move as one with link k; rules speak of bodies. `moves` carry the
    drivers' rates to every body, once all centres are known.
    """

    diagram: Diagram
    body: tuple[int, ...]
    rules: tuple[Rule, ...]
    moves: tuple[Move, ...]

    @property
    def steps(self) -> tuple[Step, ...]:
        """The rules in words, in order."""
        return tuple(step for rule in self.rules for step in steps_of(self.diagram, rule))

    def own_lines(self, found: Couple) -> tuple[int, ...]:
        """The primaries that are a line for a centre."""
        return tuple(
            k for k, p in enumerate(self.diagram.primaries)
            if p.kind == "line" and couple(*(self.body[link] for link in p.links)) == found
        )  # fmt: skip


@lru_cache(KEPT)
def derive(diagram: Diagram) -> Derivation:
    """The derivation of a circle diagram; made once for each diagram.

    Rounds of repeated crossing until all is found; where that stalls, one centre by the drivers' rates or by
    trial, then on. Work grows with the fourth power of the number of links.

    Raises NotDetermined where the diagram's motion is not given by its drivers.
    """
    knowledge = Knowledge(diagram)
    rules: list[Rule] = list(_primary(knowledge))
    while knowledge.unknown:
        found = _round(knowledge) or _stalled(knowledge)
        rules += found
    return Derivation(diagram, knowledge.body, tuple(rules), drivers_growth(knowledge, bridges=False).moves)


def _primary(knowledge: Knowledge) -> list[Given]:
    found = []
    for k, primary in enumerate(knowledge.diagram.primaries):
        for link, other in combinations(primary.links, 2):
            i, j = couple(knowledge.body[link], knowledge.body[other])
            if i == j or knowledge.knows(i, j):
                continue
            if primary.kind == "line":
                knowledge.own_lines.setdefault((i, j), []).append(k)
            else:
                knowledge.rounds[i, j] = 0
                found.append(Given((i, j), k))
    return found


def _round(knowledge: Knowledge) -> list[Rule]:
    """Every centre on which two lines are known by now."""
    found: list[Rule] = []
    for i, j in knowledge.unknown:
        lines = knowledge.crossing(i, j)
        if lines is not None:
            found.append(Crossing((i, j), lines))
    _note(knowledge, [rule.found for rule in found if isinstance(rule, Crossing)])
    return found


def _stalled(knowledge: Knowledge) -> list[Rule]:
    """The next centres by rates or trial; what even that does not give comes from the solved velocities."""
    trial = find_trial(knowledge)
    if trial is not None:
        _note(knowledge, list(trial.found))
        return [trial]
    solved: list[Rule] = [Solved(c) for c in knowledge.unknown]
    _note(knowledge, knowledge.unknown)
    return solved


def _note(knowledge: Knowledge, found: list[Couple]) -> None:
    now = 1 + max(knowledge.rounds.values(), default=0)
    knowledge.rounds.update(dict.fromkeys(found, now))
