"""The mobility by the count of links and pairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import LINK_FREEDOMS, Passive


@dataclass(frozen=True)
class PairCount:
    """How many pairs of one kind there are. Its letter, what one of them holds, and their number."""

    code: str
    held: int
    number: int


@dataclass(frozen=True)
class Mobility:
    """The mobility by the count of Chebyshev and Gruebler. F = 3 (n - 1) - the sum of what the pairs hold.

    A multiple pin of k links counts as k - 1 pairs. Passive freedoms, such as a roller's spin, are no mobility:
    `passive` of them are subtracted.

    >>> count = Mobility(6, (PairCount("R", 2, 6), PairCount("P", 2, 1)), 1)
    >>> count.freedoms, count.is_determinate
    (1, True)
    >>> count.formula
    'F = 3 (n - 1) - 2 p = 3 (6 - 1) - 2 * 7 = 1, p = 6 R + 1 P'
    """

    links: int
    pairs: tuple[PairCount, ...]
    drivers: int
    passive: int = 0

    @property
    def freedoms(self) -> int:
        """The mobility F."""
        return 3 * (self.links - 1) - sum(count.held * count.number for count in self.pairs) - self.passive

    @property
    def is_determinate(self) -> bool:
        """Whether there are as many drivers as freedoms."""
        return self.drivers == self.freedoms

    @property
    def formula(self) -> str:
        """The count with its numbers substituted."""
        held = sorted({count.held for count in self.pairs}, reverse=True)
        total = {h: sum(c.number for c in self.pairs if c.held == h) for h in held}
        # a pair's index is the number of freedoms that it leaves
        letter = {h: "p" if len(held) == 1 else f"p{LINK_FREEDOMS - h}" for h in held}
        symbols = "".join(f" - {_times(h)}{letter[h]}" for h in held)
        numbers = "".join(f" - {h} * {total[h]}" if h > 1 else f" - {total[h]}" for h in held)
        kinds = [f", {letter[h]} = {self._kinds(h)}" for h in held]
        if self.passive:
            symbols, numbers = f"{symbols} - f0", f"{numbers} - {self.passive}"
            kinds.append(f", f0 = {_counted(self.passive, 'passive freedom')}")
        return f"F = 3 (n - 1){symbols} = 3 ({self.links} - 1){numbers} = {self.freedoms}{''.join(kinds)}"

    @property
    def verdict(self) -> str:
        """How the drivers compare with the freedoms, in a sentence.

        >>> Mobility(4, (PairCount("R", 2, 4),), 0).verdict
        'mobility 1 and no driver: 1 driver is missing'
        >>> Mobility(3, (PairCount("R", 2, 3),), 0).verdict
        'mobility 0 and no driver: a structure that does not move'
        """
        drivers = _counted(self.drivers, "driver") if self.drivers else "no driver"
        missing = self.freedoms - self.drivers
        outcome = "the motion is determined" if self.drivers else "a structure that does not move"
        if self.freedoms < 0 and not self.drivers:
            outcome = f"{_counted(-self.freedoms, 'constraint')} too many for a structure that just holds"
        elif missing:
            outcome = f"{_counted(abs(missing), 'driver')} {'is' if abs(missing) == 1 else 'are'} "
            outcome += "missing" if missing > 0 else "too many"
        return f"mobility {self.freedoms} and {drivers}: {outcome}"

    def _kinds(self, held: int) -> str:
        return " + ".join(f"{count.number} {count.code}" for count in self.pairs if count.held == held)


def mobility_of(mechanism: Mechanism, pairs: Sequence[Pair], passive: Sequence[Passive]) -> Mobility:
    """Return the mobility of a mechanism with all its pairs and passive freedoms. Multiple pins count one by one.

    What leads points and turns links adds nothing to it and is not counted.
    """
    numbers: dict[tuple[str, int], int] = {}
    for pair in pairs:
        numbers[pair.code, pair.held] = numbers.get((pair.code, pair.held), 0) + 1
    for letter, names in mechanism.pins.items():
        led = sum(name in mechanism.auxiliary_links for name in names)
        if led:
            kind = next((pair.code, pair.held) for pair in pairs if pair.letters == (letter,) and pair.free_is_angle)
            numbers[kind] -= led
    for pair in mechanism.written_pairs:
        if not mechanism.auxiliary_links.isdisjoint(pair.members):
            numbers[pair.code, pair.held] -= 1
    counts = tuple(PairCount(code, held, number) for (code, held), number in numbers.items() if number)
    return Mobility(len(mechanism.links) - len(mechanism.auxiliary_links), counts, len(mechanism.drives), len(passive))


def _times(held: int) -> str:
    return f"{held} " if held > 1 else ""


def _counted(number: int, word: str) -> str:
    return f"{number} {word}{'' if number == 1 else 's'}"
