"""The steps of a derivation, as data: the origin of each centre."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple

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
