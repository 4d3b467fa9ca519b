"""The words to write a mechanism with, and what they make. Link, drive, drawn, mode, expect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort, short
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Number
from compoundkin.model.drives import Drive as Drive
from compoundkin.model.drives import drive as drive
from compoundkin.model.geometry import FRAME as FRAME
from compoundkin.model.geometry import real, vector
from compoundkin.model.leads import Lead as Lead
from compoundkin.model.loads import Friction as Friction
from compoundkin.model.loads import Gravity as Gravity
from compoundkin.model.loads import Load as Load
from compoundkin.model.loads import LoadWord as LoadWord
from compoundkin.model.loads import Mass as Mass
from compoundkin.model.loads import Pretension as Pretension
from compoundkin.model.outlines import LinkOutline as LinkOutline
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.cylinder import Cylinder


@dataclass(frozen=True, eq=False, repr=False)
class Link(PrintsShort):
    """A rigid link: its name and its points.

    `points` maps each letter to its place in the link's own frame (complex, a number or an array), or to
    None for a link given as drawn.
    """

    name: str
    points: Mapping[str, Number | None]

    @property
    def letters(self) -> tuple[str, ...]:
        """The names of its points, as written."""
        return tuple(self.points)

    @property
    def is_drawn(self) -> bool:
        """Whether its dimensions are to be read off the drawing."""
        return any(p is None for p in self.points.values())


@dataclass(frozen=True)
class Mode:
    """The assembly mode of the group that holds `links`. It is +1 or -1, as the group's kind defines it."""

    links: tuple[str, ...]
    sign: int


@dataclass(frozen=True, eq=False, repr=False)
class Drawn(PrintsShort):
    """Points of one pose in global coordinates, drawn exactly or roughly. They choose the assembly mode."""

    points: Mapping[str, Number]


@dataclass(frozen=True)
class Expectation:
    """A published number that a quantity has at given driver values, to a tolerance.

    `at` holds driver values (radians or lengths) and, for "speed", "acceleration", keys such as "crank.speed".
    Angles in `value` are radians.
    """

    quantity: str
    value: complex
    tolerance: float
    at: tuple[tuple[str, float], ...] = ()


Item: TypeAlias = Link | Pair | Cylinder | Drive | Lead | Mode | Drawn | Expectation | LoadWord | LinkOutline


@checked
def link(name: str, *letters: str, **points: Any) -> Link:
    """Return a link with its points. ``A=(x, y)`` or complex numbers in the link's frame, or letters alone.

    The places of letters alone are read off the drawing; without any, the mechanism has a structure, but no dimensions.
    Raises InvalidMechanism for a point that is not a planar vector.

    >>> link("crank", E=(0, 0), D=(14, 0)).points["D"]
    (14+0j)
    >>> link("crank", "E", "D").is_drawn
    True
    """
    both = [letter for letter in letters if letter in points]
    if both or (letters and points) or len(set(letters)) < len(letters):
        raise InvalidMechanism(
            Problem(
                f"links.{name}",
                "points are given twice, or partly as drawn",
                "give all by letters or all by coordinates",
            )
        )
    placed = _points(f"links.{name}.points", points)
    return Link(name, placed if placed else dict.fromkeys(letters))


@checked
def drawn(**points: Any) -> Drawn:
    """Return points as drawn, in global coordinates. The dimensions of links given by letters, and the assembly mode.

    >>> drawn(A=(3, 4)).points["A"]
    (3+4j)
    """
    return Drawn(_points("drawn", points))


@checked
def mode(sign: int, *links: str) -> Mode:
    """Return the choice of an assembly mode, +1 or -1, for the links' group.

    >>> mode(-1, "coupler", "rocker").sign
    -1
    """
    if sign not in (1, -1):
        raise InvalidMechanism(Problem("modes", f"an assembly mode is +1 or -1, not {sign!r}"))
    return Mode(links, sign)


@checked
def expect(quantity: str, value: Any, tolerance: float, **at: float) -> Expectation:
    """Return a published number to hold the solved motion against.

    At the given driver values.

    >>> expect("block.angle", 0.5, 1e-3, crank=1.0).at
    (('crank', 1.0),)
    """
    published = vector("expected", value)
    if np.ndim(published):
        raise InvalidMechanism(Problem("expected", f"{short(value)} is not one number", "give a number or (x, y)"))
    return Expectation(quantity, complex(published), float(real("expected.tolerance", tolerance)), tuple(at.items()))


def _points(where: str, points: Mapping[str, Any]) -> dict[str, Number]:
    problems: list[Problem] = []
    placed: dict[str, Number] = {}
    for letter, value in points.items():
        try:
            placed[letter] = vector(f"{where}.{letter}", value)
        except InvalidMechanism as error:
            problems += error.problems
    if problems:
        raise InvalidMechanism(problems)
    return placed
