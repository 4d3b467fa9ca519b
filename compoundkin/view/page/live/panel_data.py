"""What the panel of dimensions changes: rows of dimensions, and a mechanism file with holes for them.

Rows are lengths and angles of links as engineers name them, and numbers of pairs. The file is filled with changed
values in the configuration of the motion.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any, TypeAlias

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput
from compoundkin.files import toml_text
from compoundkin.files.document import DRAWN, GRAVITY, HEAD
from compoundkin.files.exact_numbers import plain
from compoundkin.files.writer import document
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import AXES, unit_of
from compoundkin.model.definition import CYLINDERS, DRIVES
from compoundkin.model.elements import Mode, mode
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import WRITTEN, pairs_among
from compoundkin.programs.dimensions import FreeDimension, StatedDimensions, mechanism_with
from compoundkin.programs.sources.fixed_configuration import changed_modes

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


# --- the mechanism file ---------------------------------------------------------------------------------------------


# Texts in TOML do not hold it: there a character of control is written as an escape.
_EDGE = "\x00"
_HOLE = re.compile(f"{_EDGE}(\\d+)(d?){_EDGE}")
LINKS, POINTS = "links", "points"
# What comes before the links: single entries, and tables of the whole.
_HEAD = ("format", *(key.name for key in HEAD), GRAVITY.name)
_IN_DEGREES = ("angle", "turn", "sweep")
_ENDS = ("from", "to")
# The table of assembly modes: a changed mechanism keeps the configuration of the page.
_MODES = "modes"
# A text in pieces: texts, indices of dimensions, and lists: of one index where degrees are written, of a letter and
# 0 or 1 where x or y of a point is.
Pieces: TypeAlias = list[str | int | list[Any]]
# Whether it is a link, and its name: pairs may have the names of links.
Owner: TypeAlias = tuple[bool, str]


@dataclass(frozen=True)
class Hole:
    """The place of a dimension's number, where a document has a number."""

    index: int
    in_degrees: bool = False

    def __repr__(self) -> str:
        return f"{_EDGE}{self.index}{'d' if self.in_degrees else ''}{_EDGE}"


def mechanism_template(
    stated: StatedDimensions, names: Sequence[str], modes: Sequence[Mode] = (), drawn: bool = False
) -> list[Any]:
    r"""Return a mechanism's file in pieces, for other values of these dimensions.

    A piece is text, or the text of one link or pair: `own` unless one of its dimensions `of` has changed, any of all
    where `of` is null; else `changed`, in which numbers are indices of dimensions, and lists of one number those in
    degrees. Together they describe what `mechanism_with` makes, in these `modes`; `drawn` as it stands on the page,
    where modes have no signs.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> bars = load("four-bar-meriam")
    >>> pieces = mechanism_template(StatedDimensions(bars, solve(bars).inputs.ends), ["AB.B.x"])
    >>> next(piece["changed"] for piece in pieces if isinstance(piece, dict))
    ['\n[links.AB]\npoints = { A = [0, 0], B = [', 0, ', 0] }\n']
    """
    found = [stated.known[name] for name in names]
    whole = mechanism_with(stated, {one: stated.own(one) for one in found}).replace(*modes)
    changed = _DocumentWithHoles(document(whole), whole, stated.items)
    for index, one in enumerate(found):
        (changed.hold_point if one.is_of_link else changed.hold_number)(one, index)
    owners, sketch = _owners(stated, found), _drawing(list(whole.carriers)) if drawn else None
    # what links read off the drawing is not to be read off another one
    owners |= {(True, link): None for link in whole.rigid_links if drawn}
    return _merged(_pieces(document(stated.mechanism), changed, owners, sketch))


def _drawing(letters: Sequence[str]) -> Pieces:
    """Return the table of the drawing, with places of points in it."""
    held = {letter: [Hole(2 * k), Hole(2 * k + 1)] for k, letter in enumerate(letters)}
    pieces = _split_at_holes(toml_text.dumps({DRAWN.name: held}))
    return [[letters[one // 2], one % 2] if isinstance(one, int) else one for one in pieces]


def _owners(stated: StatedDimensions, found: Sequence[FreeDimension]) -> dict[Owner, list[int] | None]:
    """Return the dimensions of each owner; None for numbers from the drawing, which any change replaces."""
    owners: dict[Owner, list[int] | None] = {}
    for index, one in enumerate(found):
        owners[_owner(one)] = [*(owners.get(_owner(one)) or ()), index]
    return owners | {(False, name): None for name, numbers in stated.read_off.items() if numbers}


def _owner(one: FreeDimension) -> Owner:
    return one.is_of_link, one.owner


@dataclass(frozen=True)
class _DocumentWithHoles:
    """A document of a mechanism in which numbers are replaced by holes."""

    document: dict[str, Any]
    mechanism: Mechanism
    items: Mapping[str, Any]

    @cached_property
    def places(self) -> dict[str, tuple[str, int]]:
        """The tables of pairs and cylinders and their places there, by name."""
        pairs = pairs_among(self.mechanism.items)
        tables = {table: [one.name for one in pairs if one.table == table] for table in WRITTEN}
        tables[CYLINDERS] = list(self.mechanism.cylinders)
        return {name: (table, k) for table, names in tables.items() for k, name in enumerate(names)}

    def hold_point(self, one: FreeDimension, index: int) -> None:
        """Put a hole in the place of a coordinate, in whatever form the point is written."""
        points = self.document[LINKS][one.owner][POINTS]
        at, held = complex(self.mechanism.geometry.points[one.owner][one.word]), points[one.word]
        x, y = held if isinstance(held, list) else (plain(at.real), plain(at.imag))
        points[one.word] = [Hole(index), y] if one.part == AXES[0] else [x, Hole(index)]

    def hold_number(self, one: FreeDimension, index: int) -> None:
        """Put a hole in the place of a pair's number, which is missing where it is the default."""
        table, place = self.places[one.owner]
        entry, item = self.document[table][place], self.items[one.owner]
        key = next(key for key in item.keys if key.name == one.word)
        hole = Hole(index, key.kind in _IN_DEGREES)
        if one.part:
            both = entry[one.word] if one.word in entry else [plain(value) for value in getattr(item, one.word)]
            # a guide that is open at one end has a table of the other
            place_in: Any = _ENDS[int(one.part)] if isinstance(both, dict) else int(one.part)
            both[place_in] = hole
        entry[one.word] = both if one.part else hole
        self.document[table][place] = {key.name: entry[key.name] for key in item.keys if key.name in entry}


def _pieces(
    own: Mapping[str, Any], changed: _DocumentWithHoles, owners: Mapping[Owner, list[int] | None], sketch: Pieces | None
) -> Iterator[Any]:
    """Yield a piece for the head, each link, pair and cylinder, and each other table."""
    yield toml_text.dumps({name: value for name, value in own.items() if name in _HEAD})
    names = {place: name for name, place in changed.places.items()}
    tables = list(changed.document)
    if sketch and DRAWN.name not in tables:
        tables.insert(tables.index(DRIVES) + 1, DRAWN.name)
    for table, value, other in ((one, own.get(one, {}), changed.document.get(one, {})) for one in tables):
        if table == LINKS:
            for link in value:
                yield _piece((True, link), owners, {LINKS: {link: value[link]}}, {LINKS: {link: other[link]}})
        elif (table, 0) in names:
            for k, entry in enumerate(value):
                yield _piece((False, names[table, k]), owners, {table: [entry]}, {table: [other[k]]})
        elif table == DRAWN.name and sketch:
            yield {"of": None, "own": _text(table, value), "changed": sketch}
        elif table == _MODES and value != other:
            yield {"of": None, "own": _text(table, value), "changed": [_text(table, other)]}
        elif table not in _HEAD:
            yield _text(table, value)


def _text(table: str, value: Any) -> str:
    """Return a table as text, "" for an empty one."""
    return toml_text.dumps({table: value}) if value else ""


def _piece(owner: Owner, owners: Mapping[Owner, list[int] | None], own: dict[str, Any], changed: dict[str, Any]) -> Any:
    text = toml_text.dumps(own)
    return (
        {"of": owners[owner], "own": text, "changed": _split_at_holes(toml_text.dumps(changed))}
        if owner in owners
        else text
    )


def _split_at_holes(text: str) -> Pieces:
    """Split a text at its holes."""
    parts = _HOLE.split(text)
    found: Pieces = [parts[0]]
    for index, degrees, after in zip(parts[1::3], parts[2::3], parts[3::3], strict=True):
        found += [[int(index)] if degrees else int(index), after]
    return found


def _merged(pieces: Iterator[Any]) -> list[Any]:
    """Join texts that follow each other."""
    found: list[Any] = []
    for piece in pieces:
        if found and isinstance(piece, str) and isinstance(found[-1], str):
            found[-1] += piece
        else:
            found.append(piece)
    return found


def configuration_modes(motion: Motion) -> tuple[list[Mode], bool]:
    """Return the modes of groups with signs, and whether other groups need a drawing; the motion has one design.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> configuration_modes(solve(load("crank-rocker")))
    ([Mode(links=('coupler',), sign=-1)], False)
    """
    mechanism, solvers = motion.mechanism, motion.solving_order.solvers
    found = []
    changed = changed_modes(motion)
    for solver in solvers:
        # a mode that is stated holds along the whole motion; where it changes, the drawing says which it is there
        if solver.modes == 2 and solver not in changed:
            own = next((one for one in mechanism.modes if set(one.links) & set(solver.group.links)), None)
            found.append(mode(motion.sign(solver.index, 0), *(own.links if own else solver.group.links[:1])))
    return found, any(solver.is_numbered for solver in solvers)
