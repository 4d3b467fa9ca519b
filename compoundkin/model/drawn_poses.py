"""Poses that a drawing shows: by two points of a link, or by one point and a pair that tells its angle."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, constant
from compoundkin.model.geometry import fitted_pose
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.optional_answers import DrawnPair, as_orienting, as_turn_counting

Points = Mapping[str, Mapping[str, Number]]


def told_poses(
    points: Points, pairs: Iterable[tuple[Pair, Ends]], sketch: Mapping[str, Number], known: Mapping[str, Pose]
) -> dict[str, Pose]:
    """Find poses of links from where letters are drawn and poses that are known.

    `points` are those of the links in their own frames. A link of two drawn letters has its pose from them; one of a
    single letter has its angle from a slide, a gear or a wheel that rolls, where the other members' poses are known.
    Both go on from link to link; a link that nothing tells is left out.
    """
    telling = _Telling(points, sketch, known)
    # angles that count turns last: a slide tells an angle whatever the turn
    for pair, ends in sorted(pairs, key=lambda told: as_turn_counting(told[0]) is not None):
        for link in pair.members:
            telling.pairs[link].append((pair, ends))
    return telling.poses_of_all()


class _Telling:
    """What is told so far, and what may still tell more."""

    def __init__(self, points: Points, sketch: Mapping[str, Number], known: Mapping[str, Pose]) -> None:
        self.points, self.seen, self.poses = points, dict(sketch), dict(known)
        self.pairs: dict[str, list[tuple[Pair, Ends]]] = {link: [] for link in points}
        self.carriers: dict[str, list[str]] = {}
        for link, letters in points.items():
            for letter in letters:
                self.carriers.setdefault(letter, []).append(link)
        for link in known:
            self._see(link)

    def poses_of_all(self) -> dict[str, Pose]:
        """Return the poses of all links that are told, in one way or another."""
        waiting = deque(link for link in self.points if link not in self.poses)
        while waiting:
            link = waiting.popleft()
            pose = None if link in self.poses else self._pose(link)
            if pose is not None:
                self.poses[link] = pose
                waiting.extend(other for other in self._concerned(link) if other not in self.poses)
        return self.poses

    def _see(self, link: str) -> None:
        for letter, point in self.points[link].items():
            if letter not in self.seen:
                self.seen[letter] = self.poses[link].at(point).c[0]

    def _concerned(self, link: str) -> Iterator[str]:
        """Note where a link's letters are; the links of which more may be known now."""
        new = [letter for letter in self.points[link] if letter not in self.seen]
        self._see(link)
        for letter in new:
            yield from self.carriers[letter]
        for pair, _ in self.pairs[link]:
            yield from pair.members

    def _pose(self, link: str) -> Pose | None:
        points = self.points[link]
        drawn = next((letter for letter in points if letter in self.seen), None)
        if drawn is None:
            return None
        shown = fitted_pose(points, self.seen)
        if shown is not None:
            return shown
        for pair, ends in self.pairs[link]:
            orienting = as_orienting(pair)
            seen = DrawnPair(ends, tuple(self.poses.get(name) for name in pair.members), self.seen)
            angle = orienting.drawn_angle(seen, pair.members.index(link)) if orienting else None
            if angle is not None:
                u = np.cos(angle) + 1j * np.sin(angle)
                counted = constant(angle) if as_turn_counting(pair) else None
                return Pose(constant(self.seen[drawn] - u * points[drawn]), constant(u), counted)
        return None
