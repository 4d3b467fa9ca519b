"""The forces of pins: on each of the links that a pin joins, however many they are."""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.base.errors import Problem, UnknownName
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.named_forces.link_forces import known_on
from compoundkin.dynamics.named_forces.link_wrench import PAIR, LinkWrench, place_in_world
from compoundkin.dynamics.named_forces.pair_forces import PairForce
from compoundkin.kinematics.results import told
from compoundkin.model.pairs import Pair


@dataclass(frozen=True, eq=False, repr=False)
class PinForces:
    """The forces of a pin on its links.

    That on each link is unique, while the force between two of more links depends on how their pairs are counted.
    """

    forces: FoundForces
    letter: str

    @property
    def links(self) -> tuple[str, ...]:
        """The links that it joins."""
        return self.forces.mechanism.real_pins[self.letter]

    @property
    def all_links(self) -> tuple[str, ...]:
        """The links that it joins, and what leads it."""
        return self.forces.mechanism.pins[self.letter]

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """The pairs that stand for it, one less than its links."""
        written = {pair.name for pair in self.forces.mechanism.written_pairs}
        found = (self.forces.solving_order.pairs[name] for name in self.forces.wrenches if name not in written)
        return tuple(pair for pair in found if pair.letters[0] == self.letter)

    def on(self, link: str) -> LinkWrench:
        """Return the force of the pin on a link.

        Raises UnknownName for a link that is not at it. It has `force`, `moment` about the pin, which is that of
        drivers, and `wrench`. A load on the pin itself is passed on by the pin to the link that carries it. What leads
        the pin is one of `all_links`.
        """
        if link not in self.all_links:
            what = f"the pin {self.letter} does not join it"
            raise UnknownName(Problem(str(link), what, f"known: {', '.join(self.links)}"))
        whole, parts = Wrench(), list[tuple[str, float]]()
        for pair in self.pairs:
            if link in pair.members[:2]:
                whole = whole + PairForce(self.forces, pair).on(link).acting.whole
                parts.append((pair.name, 1.0 if link == pair.members[1] else -1.0))
        loads = self.forces.mechanism.loads
        for one in known_on(self.forces, link):
            if one.name in loads and loads[one.name].pin == self.letter:
                whole = whole + one.whole
        place = place_in_world(self.forces.motion, self.links[0], self.letter)
        left = self.forces.left_open(parts, place)
        return LinkWrench(self.forces.motion, PAIR, self.letter, link, self.letter, self.letter, whole, place, left)

    def __repr__(self) -> str:
        return told(self, self.forces.grid, f"{self.letter} on {', '.join(self.links)}")
