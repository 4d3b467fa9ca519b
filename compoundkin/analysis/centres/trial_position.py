"""Completing a stalled set of centres by trial.

Where repeated crossing stalls, an unknown centre still lies on a line. A position on that line, that is a ratio of
two rates, carried along known centres, moves other centres along straight loci; where a locus meets a line that
must hold its centre is the answer. All of it is linear in the trial value, so that two positions fix a locus.

Sources: D. E. Foster and G. R. Pennock, "A graphical method to find the secondary instantaneous centers of zero
velocity for the double butterfly linkage", J. Mech. Des. 125 (2003) 268-274, and "Graphical methods to locate the
secondary instant centers of single-degree-of-freedom indeterminate linkages", J. Mech. Des. 127 (2005) 249-256;
R. Di Gregorio, "An algorithm for analytically calculating the positions of the secondary instant centers of
indeterminate linkages", J. Mech. Des. 130 (2008) 042303.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation_steps import Trial, Turn
from compoundkin.analysis.centres.known_centres import Knowledge
from compoundkin.analysis.centres.rate_sets import Growth, drivers_growth

# Each value adds one to the trial positions; the search grows by a factor of some ten with each.
MOST_VALUES = 3


def find_trial(knowledge: Knowledge) -> Trial | None:
    """The next centres by the drivers' rates, or else one by as few trial values as will do; None if none will."""
    starts = list(_starts(knowledge))
    for start in [drivers_growth(knowledge, bridges=False), *starts]:
        inside = [c for c in start.together() if not knowledge.knows(*c)]
        if inside and start.parameters == 1:
            return Trial(tuple(inside), start.moves, ())
    for values in range(1, MOST_VALUES + 1):
        for start in starts:
            found = _search(start, values)
            if found is not None:
                return found
    return None


def _starts(knowledge: Knowledge) -> Iterator[Growth]:
    """The rates of several drivers; with one, a rate about any known centre, for all are in proportion."""
    if len(knowledge.diagram.drives) > 1:
        yield drivers_growth(knowledge)
        return
    for i, j in knowledge.rounds:
        growth = Growth.of(knowledge).turned(Turn(i, j, 0), np.array(knowledge.place(i, j)))
        growth.grow()
        yield growth


def _search(growth: Growth, values: int) -> Trial | None:
    for turn in _turns(growth):
        grown = growth.turned(turn, np.array(growth.knowledge.place(turn.i, turn.k)))
        grown.grow()
        if grown.solved:
            return Trial((_on_trial(grown),), grown.moves, grown.meetings)
        found = _search(grown, values - 1) if values > 1 else None
        if found is not None:
            return found
    return None


def _turns(growth: Growth) -> Iterator[Turn]:
    """The trial values that may come next: about a known centre between a moving set and what is outside."""
    sizes: dict[int, int] = {}
    for owner in growth.member.values():
        sizes[owner] = sizes.get(owner, 0) + 1
    for c in growth.knowledge.rounds:
        for i, k in (c, c[::-1]):
            if growth.member[i] != growth.member[k] and sizes[growth.member[i]] > 1:
                yield Turn(i, k, growth.parameters)


def _on_trial(growth: Growth) -> Couple:
    """The unknown centre whose place was tried: on the line of the first trial value's centre and one of its set."""
    unknown = [c for c in growth.together() if not growth.knowledge.knows(*c)]
    first = next(move for move in growth.moves if isinstance(move, Turn) and move.parameter == 1)
    tried = [couple(j, first.k) for j in growth.member if j != first.i and growth.knowledge.knows(first.i, j)]
    return next((c for c in tried if c in unknown), unknown[0])
