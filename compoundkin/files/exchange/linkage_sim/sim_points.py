"""The letters of points: one for all points that revolute and fixed joints hold together."""

from __future__ import annotations

from collections import Counter

from compoundkin.files.exchange.foreign_names import NamesGiven
from compoundkin.files.exchange.linkage_sim.fixed_bodies import ROUNDING, Placed, size_of
from compoundkin.files.exchange.linkage_sim.sim_records import GROUND, SimFile
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.geometry import FRAME

# A point by its body and its name.
Spot = tuple[str, str]


class SimPoints:
    """The links' names, and their points by letters.

    Each is in the axes of its link.
    """

    def __init__(self, file: SimFile, placed: dict[str, Placed], problems: Problems) -> None:
        self._file, self._placed = file, placed
        self._near = ROUNDING * size_of(file)
        self.names = NamesGiven()
        hosts = dict.fromkeys(one.host for one in placed.values())
        self.link = {h: FRAME if h == GROUND else self.names.give(file.bodies[h].name, h) for h in hosts}
        self.of: dict[str, dict[str, complex]] = {h: {} for h in hosts}
        self.letter: dict[Spot, str] = {}
        self._called = Counter(name for body in file.bodies.values() for name in body.points)
        for spots in self._joined().values():
            self._place(spots, problems)

    def named(self, key: str) -> str:
        """Return the name of the link that a body is in."""
        return self.link[self._placed[key].host]

    def pin(self, first: str, second: str) -> str | None:
        """Return the letter of a pin of two links alone, or nothing."""
        shared = [letter for letter in self.of[first] if letter in self.of[second]]
        alone = [letter for letter in shared if sum(letter in own for own in self.of.values()) == 2]
        return alone[0] if len(shared) == 1 and alone else None

    def added(self, body: str, place: complex, name: str) -> str:
        """Return the letter of a place of a body, perhaps a new one."""
        placed = self._placed[body]
        own, at = self.of[placed.host], placed.at(place)
        found = next((letter for letter, here in own.items() if abs(here - at) <= self._near), None)
        if found is None:
            found = self.names.give(name, name)
            own[found] = at
        return found

    def _joined(self) -> dict[Spot, list[Spot]]:
        """Return the points in the order of the file, those that are one together."""
        root: dict[Spot, Spot] = {(key, n): (key, n) for key, body in self._file.bodies.items() for n in body.points}

        def first(spot: Spot) -> Spot:
            while root[spot] != spot:
                root[spot] = spot = root[root[spot]]
            return spot

        for joint in self._file.joints:
            if joint.kind != "prismatic":
                one, other = (first(spot) for spot in zip(joint.bodies, joint.points, strict=True))
                root[other] = one
        together: dict[Spot, list[Spot]] = {}
        for spot in root:
            together.setdefault(first(spot), []).append(spot)
        return together

    def _place(self, spots: list[Spot], problems: Problems) -> None:
        """Give points that are one a letter, on each of their links."""
        names = dict.fromkeys(name for _, name in spots)
        body, name = spots[0]
        if len(spots) > 1:
            joint = next(j for j in self._file.joints if any(s in spots for s in zip(j.bodies, j.points, strict=True)))
            wanted = name if len(names) == 1 else joint.key
        else:
            wanted = name if self._called[name] == 1 else f"{body}-{name}"
        letter = self.names.give(wanted, wanted)
        for key, point in spots:
            self.letter[key, point] = letter
            placed = self._placed[key]
            here = placed.at(self._file.bodies[key].points[point])
            if abs(self.of[placed.host].setdefault(letter, here) - here) > self._near:
                what = f"joints hold two of its points at one place, among them {point!r}"
                problems.add(f"body {key}", what, "look for a joint too many")
