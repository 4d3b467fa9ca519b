"""A sheet of forces: for each link its free body, what acts, and the equations of equilibrium with the numbers put in.

One pose, one page for a link: to be handed in, or to check what was handed in. A sum is written twice: of the numbers
as they stand there, so that it is off by their rounding, and of all digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.reactions.link_wrench import INERTIA, WEIGHT
from compoundkin.model.geometry import FRAME
from compoundkin.view.report.report_data import (
    Alert,
    Block,
    Cell,
    Column,
    FormulaBlock,
    Paragraph,
    TableBlock,
)
from compoundkin.view.report.wording import brief, column_texts, listed, number_text, point_text
from compoundkin.view.sketch.force_arrows import NOTHING, ActingForce, acting_forces, forces_in, largest_force
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.scene import Scene

# Places nearer to each other than this part of the mechanism's size are one point.
SAME_POINT = 1e-9
# The letters of a mass centre, and of points of contact and attack that have none.
MASS_CENTRE, NAMELESS = "S", "K"
# The prefix of the keys of the sections of links.
SHEET = "sheet"
# What the symbols mean.
SYMBOLS = (
    "Links have numbers: F₂₃ is the force of link 2 on link 3, M₂₃ its moment, T₂ the torque and P₂ the thrust of a"
    " driver on link 2, m₂g a weight, −m₂a₂ and −J₂α₂ inertia. F₂₃,x is a component, xB a place. Axes are those of the"
    " frame; moments, torques and directions are positive counterclockwise."
)


@dataclass(frozen=True, eq=False)
class ForceSheet:
    """The forces at one pose, with what acts on every link by the names of pictures."""

    forces: Forces
    scene: Scene
    acting: dict[str, tuple[ActingForce, ...]]

    @staticmethod
    def at_pose(forces: Forces, at: Any, pose: int | None, design: int) -> ForceSheet:
        """Return the forces at a pose."""
        scene = scene_of(forces.motion, at, pose, design)
        there = forces_in(forces, scene)
        return ForceSheet(there, scene, dict(acting_forces(there, scene)))

    @property
    def links(self) -> dict[str, str]:
        """The keys of the sections of links, with their links."""
        return {f"{SHEET}-{number}": name for name, number in self.scene.legend.items() if self.acting[name]}

    @cached_property
    def floor(self) -> float:
        """The force below which a component is rounding."""
        return NOTHING * largest_force(self.acting)

    @property
    def size(self) -> float:
        """The size of the mechanism."""
        found: float = self.scene.mechanism.geometry.size
        return found

    def page(self, link: str) -> Iterator[Block]:
        """Yield what acts on a link, and its equations."""
        body = FreeBody(self, link)
        yield Paragraph("What acts, each at its point, with its components, size and direction:")
        yield body.table()
        yield Paragraph(body.points_text)
        unknown = [one.name for one in body.acting if one.is_open]
        if unknown:
            yield Alert(f"Equilibrium does not determine {listed(dict.fromkeys(unknown))}: no sum is written.")
            return
        if link == FRAME:
            yield Paragraph(f"What the ground must hold, its moment about {body.reference}:")
        else:
            yield Paragraph(f"Equilibrium, moments about {body.reference}, in symbols and with the numbers:")
        for equation in body.equations:
            yield from equation.blocks(link != FRAME)
        if link != FRAME:
            sums = (f"{one.name} = {brief(one.exact)} {one.unit}" for one in body.equations)
            yield Paragraph(f"Sums are off by the rounding of the numbers written. With all digits {', '.join(sums)}.")


@dataclass(frozen=True)
class EquationTerm:
    """A term of an equation: symbols and numbers of its factors."""

    symbols: tuple[str, ...]
    factors: tuple[float, ...]
    is_negative: bool = False

    @property
    def value(self) -> float:
        """The term, with its sign."""
        return float(np.prod(self.factors)) * (-1.0 if self.is_negative else 1.0)


@dataclass(frozen=True)
class BalanceEquation:
    """An equation of equilibrium: its name, its terms, its unit, and what is rounding in it."""

    name: str
    terms: tuple[EquationTerm, ...]
    unit: str

    def blocks(self, is_zero: bool) -> Iterator[FormulaBlock]:
        """Yield it in symbols, and with the numbers put in; `is_zero` in equilibrium."""
        if not self.terms:
            yield FormulaBlock(f"{self.name} = 0, for nothing that acts has a part in it")
            return
        yield FormulaBlock(f"{self.name} = {self.symbols}{' = 0' if is_zero else ''}")
        yield FormulaBlock(f"{self.name} = {self.numbers} = {number_text(self.written)}")

    @property
    def symbols(self) -> str:
        """The terms in symbols."""
        return _joined(["·".join(one.symbols) for one in self.terms], [one.is_negative for one in self.terms])

    @cached_property
    def _texts(self) -> list[list[str]]:
        """The numbers of each term as written: six digits of the largest lever, the largest force, the largest moment.

        Numbers of a kind have the same decimals, so that they can be added as they stand.
        """
        kinds: dict[tuple[int, int], list[Cell]] = {}
        for one in self.terms:
            for k, factor in enumerate(one.factors):
                kinds.setdefault((len(one.factors), k), []).append(factor)
        texts = {kind: iter(column_texts(Column("", style="fixed"), values)) for kind, values in kinds.items()}
        return [[next(texts[len(one.factors), k]) for k in range(len(one.factors))] for one in self.terms]

    @property
    def numbers(self) -> str:
        """The terms with numbers put in, those below zero in parentheses behind a sign or a factor."""
        texts, minus = list[str](), list[bool]()
        for one, (*arm, text) in zip(self.terms, self._texts, strict=True):
            below = text.startswith("-")
            is_first_factor = not arm
            # a plain number gives its sign to the term
            minus.append(one.is_negative != (below and is_first_factor))
            inner = text.lstrip("-") if is_first_factor else f"({text})" if below else text
            outer = [f"({lever})" if lever.startswith("-") and texts else lever for lever in arm]
            texts.append("·".join((*outer, inner)))
        return _joined(texts, minus)

    @property
    def written(self) -> float:
        """The sum of the numbers as they are written."""
        values = (np.prod([float(text) for text in texts]) * (-1.0 if one.is_negative else 1.0)
                  for one, texts in zip(self.terms, self._texts, strict=True))  # fmt: skip
        total = float(sum(values))
        # what is left of sums of short decimals in binary
        largest = max((abs(one.value) for one in self.terms), default=0.0)
        return 0.0 if abs(total) <= BINARY * largest else total

    @property
    def exact(self) -> float:
        """The sum of all digits."""
        return float(sum(one.value for one in self.terms))


# Sums of decimals with six digits that are zero are off by this part of the largest term at most, in binary.
BINARY = 1e-13


def _joined(texts: Sequence[str], minus: Sequence[bool]) -> str:
    """Return terms with the signs between them.

    >>> _joined(["a", "b", "c"], [True, False, True])
    '-a + b - c'
    """
    if not texts:
        return "0"
    signs = ["-" if minus[0] else "", *(" - " if one else " + " for one in minus[1:])]
    return "".join(f"{sign}{text}" for sign, text in zip(signs, texts, strict=True))


@dataclass(frozen=True, eq=False)
class FreeBody:
    """A link alone, with the letters of the points at which forces act."""

    known: ForceSheet
    link: str

    @property
    def acting(self) -> tuple[ActingForce, ...]:
        """All that acts on it."""
        return tuple(one for one in self.known.acting[self.link] if one.force or one.moment or one.is_open)

    @cached_property
    def points(self) -> dict[str, complex]:
        """The letters of all points at which something acts, with their places; those without a letter get one."""
        scene, number = self.known.scene, self.known.scene.numbers[self.link]
        own = {letter: scene.at(self.link, place) for letter, place in scene.points[self.link].items()}
        found: dict[str, complex] = {}
        for one in self.acting:
            if self._letter(found, one.at):
                continue
            letter = self._letter(own, one.at)
            if not letter and one.description.startswith((WEIGHT, INERTIA)):
                letter = f"{MASS_CENTRE}{number}"
            if not letter:
                letter = f"{NAMELESS}{1 + sum(key.startswith(NAMELESS) and key not in own for key in found)}"
            found[letter] = one.at
        return found

    def _letter(self, among: dict[str, complex], place: complex) -> str:
        least = SAME_POINT * self.known.size
        return next((letter for letter, other in among.items() if abs(other - place) <= least), "")

    @property
    def reference(self) -> str:
        """The letter of the point of moments: that at which the first force acts."""
        return next(iter(self.points), "")

    def table(self) -> TableBlock:
        """Return the forces and moments."""
        units, floor = self.known.forces.units, self.known.floor
        rows: list[tuple[Cell, ...]] = []
        for one in self.acting:
            letter = self._letter(self.points, one.at)
            if one.is_open:
                rows.append((one.name, one.description, letter, None, None, None, None, None))
                continue
            x, y = one.force.real, one.force.imag
            way = float(degrees(np.angle(_without_rounding(one.force, floor)))) if one.force else None
            name = one.name if one.force else one.turning
            moment = one.moment if one.moment else None
            name = f"{one.name}, {one.turning}" if one.force and one.moment and one.turning != one.name else name
            forces = (x, y, abs(one.force), way) if one.force else (None, None, None, None)
            rows.append((name, one.description, letter, *forces, moment))
        numbers = (
            Column("x", units.force, "each", floor), Column("y", units.force, "each", floor),
            Column("size", units.force, "each", floor), Column("direction", "deg", "each", ROUND_ANGLE),
            Column("moment", units.moment, "each"),
        )  # fmt: skip
        return TableBlock((Column("symbol"), Column("what"), Column("at"), *numbers), tuple(rows), keys=1)

    @property
    def points_text(self) -> str:
        """The points with their places, as a sentence."""
        least = SAME_POINT * self.known.size
        places = (f"{letter} {point_text(_without_rounding(at, least))}" for letter, at in self.points.items())
        unit = self.known.scene.mechanism.unit
        return f"Points{f' [{unit}]' if unit else ''}: {', '.join(places)}."

    @cached_property
    def equations(self) -> tuple[BalanceEquation, BalanceEquation, BalanceEquation]:
        """The sums of forces along x and y, and of moments about the point of reference."""
        units = self.known.forces.units
        along = (
            tuple(EquationTerm((f"{_symbol(one.name)},{axis}",), (value,)) for one in self.acting
                  if abs(value := getattr(one.force, part)) > self.known.floor)
            for axis, part in (("x", "real"), ("y", "imag"))
        )  # fmt: skip
        x, y = (BalanceEquation(f"ΣF{axis}", terms, units.force) for axis, terms in zip("xy", along, strict=True))
        return x, y, BalanceEquation(f"ΣM({self.reference})", tuple(self._moments()), units.moment)

    def _moments(self) -> Iterator[EquationTerm]:
        """Yield the terms of the sum of moments."""
        base, floor = self.points.get(self.reference, 0j), self.known.floor
        for one in self.acting:
            if one.moment:
                yield EquationTerm((_symbol(one.turning),), (one.moment,))
            letter = self._letter(self.points, one.at)
            arm = one.at - base
            for axis, lever, across, value in (
                ("x", arm.real, "y", one.force.imag),
                ("y", arm.imag, "x", one.force.real),
            ):
                if abs(lever) > SAME_POINT * self.known.size and abs(value) > floor:
                    symbols = f"({axis}{letter} - {axis}{self.reference})", f"{_symbol(one.name)},{across}"
                    yield EquationTerm(symbols, (lever, value), axis == "y")


def _symbol(name: str) -> str:
    """Return the name of a force as a symbol: one with a sign in parentheses.

    >>> _symbol("−m₃a₃"), _symbol("pull")
    ('(−m₃a₃)', 'pull')
    """
    return f"({name})" if name.startswith("−") else name


# Directions nearer to zero are along the axis (degrees).
ROUND_ANGLE = 1e-6


def _without_rounding(force: complex, floor: float) -> complex:
    """Return a force whose components below the floor are zero."""
    x, y = (value if abs(value) > floor else 0.0 for value in (force.real, force.imag))
    return complex(x, y)
