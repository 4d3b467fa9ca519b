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
from compoundkin.analysis.centres.known_centres import KnownCentres
from compoundkin.analysis.centres.rate_sets import RateSets, driver_rate_sets

# Each value adds one to the trial positions; the search grows by a factor of some ten with each.
MOST_VALUES = 3


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
