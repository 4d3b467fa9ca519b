"""Which two lines give which centre, and in which order, as steps: from the circle diagram alone.

Where repeated crossing stalls, an unknown centre still lies on a line. A position on that line, that is a ratio of two
rates, carried along known centres, moves other centres along straight loci; where a locus meets a line that must hold
its centre is the answer. All of it is linear in the trial value, so that two positions fix a locus. Bodies of known
relative motion form sets that grow along known centres.

Sources: the theorem of Aronhold (1872) and Kennedy (1886), that the three relative centres of three links lie on a
line; the circle diagram that organises it is in every textbook on kinematics. Trial positions: D. E. Foster and
G. R. Pennock, "A graphical method to find the secondary instantaneous centers of zero velocity for the double butterfly
linkage", J. Mech. Des. 125 (2003) 268-274, and "Graphical methods to locate the secondary instant centers of
single-degree-of-freedom indeterminate linkages", J. Mech. Des. 127 (2005) 249-256; R. Di Gregorio, "An algorithm for
analytically calculating the positions of the secondary instant centers of indeterminate linkages", J. Mech. Des. 130
(2008) 042303.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import combinations, product
from typing import TypeAlias

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple
from compoundkin.analysis.centres.homogeneous import cross, dot
from compoundkin.analysis.centres.known_centres import GENERIC, KnownCentres, sine
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem

# In the place of a line: no two lines, but the drivers' rates carried by other centres.
BY_RATES = 2**30


@dataclass(frozen=True)
class PairCentre:
    """A primary centre: the pair itself."""

    found: Couple
    primary: int


@dataclass(frozen=True)
class LineCrossing:
    """Aronhold-Kennedy twice: the centre is where two lines cross.

    Each line is given by the third link k, the line (i k)(k j); or by -1 - p where it is primary p's own line.
    """

    found: Couple
    lines: tuple[int, int]


@dataclass(frozen=True)
class Turn:
    """Link `k` moves relative to link `i` about their centre at a rate. That of a driver, or a trial value.

    `parameter` is 0 for what is given (a driver's rate, or one that may be chosen freely as all motion is
    proportional to it) and counts the trial values from 1.
    """

    i: int
    k: int
    parameter: int
    driver: int = -1


@dataclass(frozen=True)
class Join:
    """Two sets of links of known relative motion, joined by two centres. (i k) and (j m), i and j in one set."""

    i: int
    k: int
    j: int
    m: int


@dataclass(frozen=True)
class Bridge:
    """Three sets in a ring joined by (i k), (l m) and (n j).

    Of one set are i and j, k and l, m and n.
    """

    i: int
    k: int
    l: int  # noqa: E741
    m: int
    n: int
    j: int


@dataclass(frozen=True)
class Meeting:
    """The condition on trial values. The centre (i j), which moves along its locus, is on the line (i k)(k j)."""

    i: int
    j: int
    k: int


Move: TypeAlias = Turn | Join | Bridge


@dataclass(frozen=True)
class Trial:
    """Centres found from the ratios of rates, where repeated crossing stalls.

    The moves carry the motion of one link to others, linearly in the trial values; each meeting is one
    linear equation for them. Without trial values the drivers' given rates suffice.
    """

    found: tuple[Couple, ...]
    moves: tuple[Move, ...]
    meetings: tuple[Meeting, ...]

    @property
    def values(self) -> int:
        """How many trial values there are."""
        return sum(1 for move in self.moves if isinstance(move, Turn) and move.parameter > 0)


@dataclass(frozen=True)
class SolvedCentre:
    """A centre from the solved velocities, where geometry does not determine it."""

    found: Couple


Rule: TypeAlias = PairCentre | LineCrossing | Trial | SolvedCentre


@dataclass(frozen=True)
class DerivationStep:
    """One line of a derivation: the centre, its origin, and the lines that determine it.

    `kind` is "primary", "crossing", "rates", "trial", "velocities". Each of `lines` names the centres it runs
    through, or the pair whose normal it is. `text` says the same in words.
    """

    centre: tuple[str, str]
    kind: str
    lines: tuple[tuple[str, ...], ...]
    text: str

    def __str__(self) -> str:
        return f"({self.centre[0]} {self.centre[1]}): {self.text}"


def steps_of(diagram: Diagram, rule: Rule) -> tuple[DerivationStep, ...]:
    """Return a rule in words, one step for each centre it gives."""
    if isinstance(rule, Trial):
        return tuple(_trial_step(diagram, rule, found) for found in rule.found)
    names = (diagram.links[rule.found[0]], diagram.links[rule.found[1]])
    if isinstance(rule, PairCentre):
        return (DerivationStep(names, "primary", (), diagram.primaries[rule.primary].text),)
    if isinstance(rule, LineCrossing):
        lines = tuple(line_names(diagram, rule.found, via) for via in rule.lines)
        return (DerivationStep(names, "crossing", lines, crossing_text(diagram, rule.found, rule.lines)),)
    return (DerivationStep(names, "velocities", (), "solved velocities"),)


def crossing_text(diagram: Diagram, found: Couple, lines: tuple[int, int]) -> str:
    """Return the two lines in words."""
    if BY_RATES in lines:
        return "rates carried by the other centres"
    return " x ".join("line " + "".join(line_names(diagram, found, via)) for via in lines)


def line_names(diagram: Diagram, found: Couple, via: int) -> tuple[str, ...]:
    """Return the two centres a line runs through, or the pair it belongs to."""
    if via < 0:
        return (f"({diagram.primaries[-1 - via].text})",)
    return centre_name(diagram, found[0], via), centre_name(diagram, via, found[1])


def centre_name(diagram: Diagram, i: int, j: int) -> str:
    """Return a centre in words, its links in the order given."""
    return f"({diagram.links[i]} {diagram.links[j]})"


def _trial_step(diagram: Diagram, trial: Trial, found: Couple) -> DerivationStep:
    names = (diagram.links[found[0]], diagram.links[found[1]])
    carried = ", ".join(_move_text(diagram, move) for move in trial.moves)
    if not trial.values:
        turns = [move for move in trial.moves if isinstance(move, Turn) and move.driver >= 0]
        drivers = ", ".join(diagram.drives[turn.driver].driver for turn in turns)
        origin = f"rates of the drivers {drivers}" if drivers else "ratios of rates"
        return DerivationStep(names, "rates", (), f"{origin}; {carried}")
    lines = tuple(line_names(diagram, (m.i, m.j), m.k) for m in trial.meetings)
    ends = " and ".join(
        f"the locus of {centre_name(diagram, *couple(m.i, m.j))} meets line {''.join(line)}"
        for m, line in zip(trial.meetings, lines, strict=True)
    )
    return DerivationStep(names, "trial", lines, f"{trial.values + 1} trial positions; {carried}; {ends}")


def _move_text(diagram: Diagram, move: Move) -> str:
    if isinstance(move, Join):
        return f"carried through {centre_name(diagram, move.i, move.k)} and {centre_name(diagram, move.j, move.m)}"
    if isinstance(move, Bridge):
        ends = ((move.i, move.k), (move.l, move.m), (move.n, move.j))
        return "carried round {}, {} and {}".format(*(centre_name(diagram, *c) for c in ends))
    about = centre_name(diagram, move.i, move.k)
    return f"trial rate about {about}" if move.parameter else f"rate about {about}"


# Number of cached derivations, a few kilobytes each.
CACHED = 256
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


@lru_cache(CACHED)
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


def _primary(centres: KnownCentres) -> list[PairCentre]:
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
                found.append(PairCentre((i, j), k))
    return found


def _round(centres: KnownCentres) -> list[Rule]:
    """Return every centre on which two lines are known by now."""
    found: list[Rule] = []
    for i, j in centres.unknown:
        lines = centres.crossing(i, j)
        if lines is not None:
            found.append(LineCrossing((i, j), lines))
    _record(centres, [rule.found for rule in found if isinstance(rule, LineCrossing)])
    return found


def _stalled(centres: KnownCentres) -> list[Rule]:
    """Return the next centres by rates or trial. What even that does not give comes from the solved velocities."""
    trial = trial_position(centres)
    if trial is not None:
        _record(centres, list(trial.found))
        return [trial]
    solved: list[Rule] = [SolvedCentre(c) for c in centres.unknown]
    _record(centres, centres.unknown)
    return solved


def _record(centres: KnownCentres, found: list[Couple]) -> None:
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


@dataclass
class RateSets:
    """The set of each body, and its twist in that set, (3, parameters), while the sets grow.

    `rows` are the independent conditions on the parameters, `meetings` what they mean.
    """

    centres: KnownCentres
    member: dict[int, int]
    twists: dict[int, Number]
    moves: tuple[Move, ...] = ()
    meetings: tuple[Meeting, ...] = ()
    rows: list[Number] = field(default_factory=list)

    @classmethod
    def of(cls, centres: KnownCentres) -> RateSets:
        """Return every body by itself; parameter 0 only."""
        return cls(centres, {b: b for b in centres.bodies}, {b: np.zeros((3, 1)) for b in centres.bodies})

    @property
    def parameters(self) -> int:
        """How many parameters the twists are linear in."""
        return int(next(iter(self.twists.values())).shape[1])

    @property
    def solved(self) -> bool:
        """Whether the conditions determine the parameters but for a common factor."""
        return len(self.rows) == self.parameters - 1

    def together(self) -> Iterator[Couple]:
        """Return every two bodies of one set."""
        return ((i, j) for i, j in combinations(self.member, 2) if self.member[i] == self.member[j])

    def turned(self, turn: Turn, amplitude: Number) -> RateSets:
        """Return a copy in which one set moves relative to another.

        These are the sets of `turn.k` and `turn.i`. A new parameter if it is one.
        """
        wide = max(self.parameters, turn.parameter + 1)
        twists = {b: np.pad(t, ((0, 0), (0, wide - t.shape[1]))) for b, t in self.twists.items()}
        grown = RateSets(self.centres, dict(self.member), twists, (*self.moves, turn), self.meetings)
        grown.rows = [np.pad(row, (0, wide - len(row))) for row in self.rows]
        relative = np.zeros((3, wide))
        relative[:, turn.parameter] = amplitude
        attach(grown.twists, grown.member, turn.i, turn.k, relative)
        return grown

    def grow(self, bridges: bool = True) -> None:
        """Join all sets that known centres join, then collect the conditions that follow."""
        while (move := self._next_join() or (self._next_bridge() if bridges else None)) is not None:
            if isinstance(move, Join):
                self._join(move)
            else:
                self._bridge(move)
            self.moves = (*self.moves, move)
        for i, j in self.together():
            for k in self.centres.bodies:
                if self.solved:
                    return
                if k not in (i, j) and self.centres.knows(i, k) and self.centres.knows(k, j):
                    self._collect(Meeting(i, j, k))

    def _between(self) -> dict[Couple, list[Couple]]:
        """Return the known centres between every two sets. Each is (body of the first set, body of the second)."""
        found: dict[Couple, list[Couple]] = {}
        for i, j in self.centres.rounds:
            a, b = self.member[i], self.member[j]
            if a != b:
                found.setdefault((a, b), []).append((i, j))
                found.setdefault((b, a), []).append((j, i))
        return found

    def _next_join(self) -> Join | None:
        place = self.centres.place
        for known in self._between().values():
            for (i, k), (j, m) in combinations(known, 2):
                if sine(place(i, k), place(j, m)) > GENERIC:
                    return Join(i, k, j, m)
        return None

    def _next_bridge(self) -> Bridge | None:
        place, between = self.centres.place, self._between()
        for a, b, c in combinations(dict.fromkeys(self.member.values()), 3):
            rings = product(between.get((a, b), ()), between.get((b, c), ()), between.get((c, a), ()))
            for (i, k), (l, m), (n, j) in rings:  # noqa: E741
                if abs(np.linalg.det([place(i, k), place(l, m), place(n, j)])) > GENERIC:
                    return Bridge(i, k, l, m, n, j)
        return None

    def _join(self, join: Join) -> None:
        i, k, j, m = join.i, join.k, join.j, join.m
        p, q = (self._place(*c) for c in ((i, k), (j, m)))
        gap = (self.twists[j] - self.twists[i]) - (self.twists[m] - self.twists[k])
        attach(self.twists, self.member, i, k, p * pair_amplitudes(p, q, gap)[0])

    def _bridge(self, bridge: Bridge) -> None:
        i, k, l, m, n, j = (getattr(bridge, name) for name in "iklmnj")  # noqa: E741
        p, r, q = (self._place(*c) for c in ((i, k), (l, m), (n, j)))
        t = self.twists
        a, _, b = ring_amplitudes(p, r, q, (t[j] - t[i]) - (t[l] - t[k]) - (t[n] - t[m]))
        attach(self.twists, self.member, i, k, p * a)
        attach(self.twists, self.member, j, n, -q * b)

    def _place(self, i: int, j: int) -> Number:
        return np.array(self.centres.place(i, j))[:, None]

    def _collect(self, meeting: Meeting) -> None:
        line = self.centres.line(meeting.i, meeting.j, meeting.k)
        relative = self.twists[meeting.j] - self.twists[meeting.i]
        scale = float(np.linalg.norm(relative))
        if line is None or scale < GENERIC:
            return
        row = np.array(line) @ relative / scale
        rank = np.linalg.matrix_rank(np.array([*self.rows, row]), tol=GENERIC)
        if rank > len(self.rows):
            self.rows.append(row)
            self.meetings = (*self.meetings, meeting)


def pair_amplitudes(p: Number, q: Number, gap: Number) -> tuple[Number, Number]:
    """Return a, b in ``gap = a p - b q``.

    p and q are two different places on one line with the gap.

    >>> p, q = np.array([1.0, 0.0, 1.0]), np.array([3.0, 0.0, 1.0])
    >>> a, b = pair_amplitudes(p, q, 2.0 * p - 0.5 * q)
    >>> float(a), float(b)
    (2.0, 0.5)
    """
    n = cross(p, q)
    square = dot(n, n)
    return dot(cross(gap, q), n) / square, dot(cross(gap, p), n) / square


def ring_amplitudes(p: Number, r: Number, q: Number, gap: Number) -> tuple[Number, Number, Number]:
    """Return the amplitudes of ``gap = a p + c r + b q``. They are a, c, b.

    The three places are not on one line.

    >>> [float(x) for x in ring_amplitudes(*np.eye(3), np.array([5.0, 6.0, 7.0]))]
    [5.0, 6.0, 7.0]
    """
    rq, qp, pr = cross(r, q), cross(q, p), cross(p, r)
    volume = dot(p, rq)
    return dot(gap, rq) / volume, dot(gap, qp) / volume, dot(gap, pr) / volume


def driver_rate_sets(centres: KnownCentres, bridges: bool = True) -> RateSets:
    """Return the drivers' rates, carried as far as the known centres allow. `bridges` take three links at a time."""
    sets = RateSets.of(centres)
    for k, drive in enumerate(centres.diagram.drives):
        i, j = centres.body[drive.first], centres.body[drive.second]
        if sets.member[i] != sets.member[j]:
            place = np.array(centres.generic[drive.primary])
            sets = sets.turned(Turn(i, j, 0, k), centres.rates[k] * place)
    sets.grow(bridges)
    return sets


def attach(twists: dict[int, Number], member: dict[int, int], i: int, k: int, relative: Number) -> None:
    """Join body `k` and its set to body `i`, at a given relative twist."""
    shift = twists[i] + relative - twists[k]
    old, new = member[k], member[i]
    for body, owner in member.items():
        if owner == old:
            twists[body] = twists[body] + shift
            member[body] = new
