"""The rows of the panel of dimensions: lengths and angles of links as engineers name them, and numbers of pairs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import AXES, unit_of
from compoundkin.model.geometry import FRAME
from compoundkin.programs.dimensions import FreeDimension, StatedDimensions
from compoundkin.view.page.live.mechanism_template import configuration_modes, mechanism_template

# Of so many pivots of the frame every distance is a row; of more those from the first.
FEW_PIVOTS = 3
# Numbers of pairs that are lengths, and their titles.
LENGTHS = {"radii": ("radius of {}", "radius of {}"), "stroke": ("least length", "greatest length")}
ENDS = {"reach": ("from", "to")}
# Positive numbers.
SIZES = ("radii", "stroke", "radius")


def panel_data(stated: StatedDimensions, names: Sequence[str]) -> dict[str, Any]:
    """Return the rows of a panel by links and pairs.

    A row of a link is its kind, its letters, and whether it appears only after a change: "length" from a point to
    another one, which moves; "angle" at the first from the second to the third; "turn" of the line through both in the
    link's own frame; "x" and "y". `fixed` are points that cannot change, by link.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> bars = load("crank-rocker")
    >>> stated = StatedDimensions(bars, solve(bars).inputs.ends)
    >>> panel_data(stated, ["crank.B.x", "crank.B.y"])["links"]
    [{'name': 'crank', 'rows': [['length', ['A', 'B'], False], ['turn', ['A', 'B'], True]]}]
    """
    return DimensionRows(stated, tuple(stated.known[name] for name in names)).data


def template_data(stated: StatedDimensions, names: Sequence[str], motion: Motion) -> list[Any] | dict[str, str]:
    """Return the mechanism's file in pieces, or why it cannot be written.

    It fixes the configuration of the motion, as changed dimensions alone might choose another.
    """
    try:
        return mechanism_template(stated, names, *configuration_modes(motion))
    except InvalidInput as error:
        return {"why": f"{error.problems[0].where}: {error.problems[0].what}."}


@dataclass(frozen=True)
class DimensionRows:
    """The dimensions that can be changed."""

    stated: StatedDimensions
    free: tuple[FreeDimension, ...]

    @property
    def data(self) -> dict[str, Any]:
        """All of it for a script."""
        links = [{"name": name, "rows": list(self._link(name))} for name in self.stated.mechanism.rigid_links]
        pairs = [self._pair(name) for name in self.stated.items]
        rows = {"links": [one for one in links if one["rows"]], "pairs": [one for one in pairs if one["rows"]]}
        return {**rows, "fixed": self._fixed}

    @cached_property
    def axes(self) -> Mapping[tuple[str, str], str]:
        """Which coordinates of the points of links can be changed: "xy", "x", "y"."""
        found: dict[tuple[str, str], str] = {}
        for one in self.free:
            if one.is_of_link:
                found[one.owner, one.word] = found.get((one.owner, one.word), "") + one.part
        return found

    @property
    def _fixed(self) -> dict[str, dict[str, list[float]]]:
        whole = "".join(AXES)
        fixed: dict[str, dict[str, list[float]]] = {}
        for name in self.stated.mechanism.rigid_links:
            known = {
                letter: [float(at.real), float(at.imag)]
                for letter, at in self._points(name).items()
                if self.axes.get((name, letter)) != whole
            }
            fixed |= {name: known} if known else {}
        return fixed

    def _points(self, link: str) -> Mapping[str, Number]:
        return self.stated.mechanism.geometry.points[link]

    def _link(self, name: str) -> Iterator[list[Any]]:
        letters = list(self._points(name))
        yield from self._pivots(name, letters) if name == FRAME else self._sides(name, letters)

    def _pivots(self, name: str, letters: Sequence[str]) -> Iterator[list[Any]]:
        for letter in letters:
            yield from self._coordinates(name, letter, False)
        pairs = (
            combinations(letters, 2) if len(letters) <= FEW_PIVOTS else ((letters[0], other) for other in letters[1:])
        )
        for one, two in pairs:
            if self._apart(name, one, two) and self._moves(name, two):
                yield ["length", [one, two], False]

    def _sides(self, name: str, letters: Sequence[str]) -> Iterator[list[Any]]:
        """Lengths from one point of a link to the others, and the angles between them there."""
        points = self._points(name)
        base = next((letter for letter in letters if points[letter] == 0), letters[0])
        others = [letter for letter in letters if letter != base]
        away = [letter for letter in others if self._apart(name, base, letter)]
        # the other points are seen from the line to this one: best the link's own x axis
        first = next((letter for letter in away if points[letter].imag == points[base].imag), (away or [base])[0])
        yield from self._coordinates(name, base, bool(points[base] == 0))
        for letter in sorted(others, key=lambda letter: letter != first):
            if letter not in away or not self._moves(name, letter):
                yield from self._coordinates(name, letter, False)
            elif letter == first:
                yield ["length", [base, letter], False]
                yield ["turn", [base, letter], True]
            else:
                yield ["length", [base, letter], False]
                yield ["angle", [base, first, letter], False]

    def _coordinates(self, name: str, letter: str, late: bool) -> Iterator[list[Any]]:
        for axis in self.axes.get((name, letter), ""):
            yield [axis, [letter], late]

    def _apart(self, name: str, one: str, two: str) -> bool:
        points = self._points(name)
        return bool(points[one] != points[two])

    def _moves(self, name: str, letter: str) -> bool:
        return self.axes.get((name, letter)) == "".join(AXES)

    def _pair(self, name: str) -> dict[str, Any]:
        item = self.stated.items[name]
        own = [one for one in self.free if not one.is_of_link and one.owner == name]
        docs = {key.name: key.doc for key in item.keys}
        rows = [
            {
                "name": one.name,
                "told": _number_title(one, item),
                "doc": docs[one.word],
                **_unit_and_size(one, self.stated),
            }
            for one in own
        ]
        return {"name": name, "links": list(item.members), "rows": rows}


def _number_title(one: FreeDimension, item: Any) -> str:
    """Return the title of a number."""
    words = {**LENGTHS, **ENDS}.get(one.word)
    if one.part and words:
        return words[int(one.part)].format(item.members[int(one.part)])
    return one.word.replace("_", " ") + (f" of {item.members[int(one.part)]}" if one.part else "")


def _unit_and_size(one: FreeDimension, stated: StatedDimensions) -> dict[str, Any]:
    """Return the unit of a number, and whether it must be positive."""
    unit = unit_of(stated.mechanism.unit, "length") if one.word in LENGTHS else stated.unit(one)
    return {"unit": unit, "size": one.word in SIZES and stated.own(one) > 0}
