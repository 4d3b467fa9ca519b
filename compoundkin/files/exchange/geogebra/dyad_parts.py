"""What the construction of a dyad begins with: its sides in its bodies' axes, and what is known outside."""

from __future__ import annotations

from typing import NamedTuple

from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.pair_sides import NamedEnd, PairSides
from compoundkin.files.exchange.geogebra.placed_bodies import Held, PlacedBodies
from compoundkin.files.exchange.geogebra.polar_sums import Angle, Way, at, named
from compoundkin.kinematics.groups.dyad import DyadSolver
from compoundkin.kinematics.groups.pair_sides import Side


class KnownSide(NamedTuple):
    """The outside of an outer pair: its point, and its direction in the plane."""

    point: str
    angle: Angle


class DyadParts:
    """A dyad to be constructed. `index` is that of its helpers, `mode` the number that says which of two ways."""

    def __init__(self, placed: PlacedBodies, sides: PairSides, solver: DyadSolver, index: str, mode: str) -> None:
        self.build: Construction = placed.build
        self.placed, self.solver, self.index, self.mode = placed, solver, index, mode
        self._sides = sides
        self.outer = tuple(self._own(side) for side in solver.outer)
        self.inner = tuple(self._own(side) for side in solver.inner)

    def _own(self, side: Side) -> NamedEnd:
        """Return a side in the axes of its body."""
        end = self._sides.of(side.pair, side.own)
        way, angle = self.placed.in_body(side.link, end.way), self.placed.angle_in_body(side.link, end.angle)
        return end._replace(way=way, angle=angle)

    def known(self, k: int) -> KnownSide:
        """Return the outside of an outer pair."""
        side = self.solver.outer[k]
        end = self._sides.of(side.pair, 1 - side.own)
        spot = self.placed.spot(side.other, end, side.pair.name)
        return KnownSide(spot, self.placed.angle(side.other).plus(end.angle))

    def pin(self, expression: str) -> str:
        """Add the inner pin by an expression; return its name."""
        if not self.letter:
            return self.build.helping_point("Q", self.index, expression)
        return self._noted(self.letter, self.build.point(self.letter, expression))

    def pin_met(self, lines: tuple[str, str]) -> str:
        """Add the inner pin where two lines meet; return its name."""
        return self._met(self.letter, lines)

    def runner_met(self, lines: tuple[str, str]) -> str:
        """Add the second body's point where two lines meet; return its name."""
        return self._met(self.inner[1].letter, lines)

    def _met(self, letter: str, lines: tuple[str, str]) -> str:
        if not letter or letter in self.placed.points:
            return self.build.shape("point", ("Q", self.index), "helper", "Intersect", lines)
        return self._noted(letter, self.build.met(letter, "Intersect", lines))

    def _noted(self, letter: str, name: str) -> str:
        self.placed.points[letter] = name
        return name

    @property
    def letter(self) -> str:
        """The letter of the inner pin."""
        return self.inner[0].letter or self.inner[1].letter

    def angle(self, k: int, text: str) -> Angle:
        """Add the angle of a body; return it. Nothing is added for a body that only stands for a pair."""
        return named(self.build.helper("θ", self.solver.bodies[k].links[0], text))

    def hold(self, k: int, point: str, own: Way, angle: Angle) -> None:
        """Note where a body is, and add its points."""
        self.placed.hold(self.solver.bodies[k], Held(point, own, angle))

    def is_real(self, k: int) -> bool:
        """Return whether a body is one of the mechanism, not for a pair."""
        return self.solver.bodies[k] in self.solver.group.bodies

    def beside(self, point: str, way: Way, angle: Angle, stem: str) -> str:
        """Return the point a way off another one, that itself where there is none."""
        if not way.terms:
            return point
        return self.build.helping_point(stem, self.index, at(point).plus(way.turned(angle)).text)
