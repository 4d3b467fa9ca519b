"""Quantities of a motion by name, "G.velocity" or "bar.angle", what owns them, and tables of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import PLAIN, Number, degrees
from compoundkin.base.display import display_function
from compoundkin.base.errors import (
    OTHER_WORDS,
    InvalidInput,
    Problem,
    UnknownName,
    missing_extra,
    plain_word,
    suggestion,
)
from compoundkin.kinematics.derived import FIGURES
from compoundkin.kinematics.derived.contract import HasQuantities, Lack, OfMotion, motion_of
from compoundkin.model.attributes import (
    ALIASES,
    CATALOGUE,
    DEGREES,
    DERIVED,
    LENGTH,
    PARTS,
    RADIANS,
    TABULATED,
    TIME,
    VALUE,
    Attribute,
    Dimension,
    Kind,
    coordinate_dimension,
    motion_figure,
    typeset_unit,
    unit_of,
    vector_and_part,
)
from compoundkin.model.geometry import FRAME


@dataclass(frozen=True, eq=False, repr=False)
class Quantity:
    """One quantity: complex values for a planar vector, real ones otherwise. `unit` is that of `values`.

    `order` counts time derivatives of a length, an angle or another `dimension`; rounding is relative to `scale`.
    """

    name: str
    unit: str
    values: Any
    order: int = 0
    dimension: Dimension = "number"
    symbol: str = ""
    scale: float = 0.0

    @property
    def is_vector(self) -> bool:
        """Whether it is a planar vector."""
        return np.iscomplexobj(self.values)

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle, and not the rate of one."""
        return self.unit in (RADIANS, DEGREES)

    @property
    def label(self) -> str:
        """The name with its unit.

        >>> Quantity("G.acceleration", "mm/s^2", np.zeros((1, 1))).label
        'G.acceleration [mm/s²]'
        """
        return f"{self.name} [{typeset_unit(self.unit)}]".lstrip() if self.unit else self.name

    @property
    def shown(self) -> Self:
        """As it is shown to people: angles in degrees.

        >>> Quantity("bar.angle", "rad", np.array([np.pi])).shown.values.tolist()
        [180.0]
        """
        return replace(self, values=degrees(self.values), unit=DEGREES) if self.unit == RADIANS else self

    def part(self, name: str) -> Self:
        """Return a component or the length of a vector."""
        symbol = f"|{self.symbol}|" if name == LENGTH else f"{self.symbol}.{name}"
        return replace(self, name=f"{self.name}.{name}", values=PARTS[name](self.values), symbol=symbol)

    @property
    def components(self) -> tuple[Self, ...]:
        """Its real numbers: both components of a vector. What is no vector is as it is."""
        return (self.part("x"), self.part("y")) if self.is_vector else (self,)

    def __repr__(self) -> str:
        shape = "x".join(map(str, np.shape(self.values))) or "1"
        kind = "vectors" if self.is_vector else "values"
        symbol = f", {self.symbol}" if self.symbol else ""
        return f"Quantity({self.name!r}{symbol}, {shape} {kind}{' in ' + self.unit if self.unit else ''})"


@checked
def quantity(motion: HasQuantities | OfMotion, name: str) -> Quantity:
    """Return the quantity of a name such as "G.velocity".

    "G" alone is G.position, "bar" bar.angle, "slot" slot.value. Points have position, velocity, acceleration, jerk, x,
    y, speed; links angle, angular_velocity, angular_acceleration, angular_jerk; pairs and drivers value, rate, second,
    third (or angle, displacement). Links of dyads have transmission_angle, those of any group transmission_index;
    guides that turn coriolis, cams pressure_angle; what moves by one driver velocity_ratio and advantage. With loads
    pairs have force and moment, drivers effort and power, the frame shaking_force. A vector has .x, .y, .length. Over a
    motion numbers have .least, .greatest, .stroke, .time_ratio, .imbalance_angle. Raises UnknownName with the nearest.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
    >>> found = quantity(solve(crank, {"crank": [0.0]}, speed=3.0), "B.velocity")
    >>> found, found.values.tolist()
    (Quantity('B.velocity', v(B), 1 vectors in mm/s), [6j])
    """
    whole, part = whole_and_part(motion_of(motion), name)
    return whole.part(part) if part else whole


def whole_and_part(motion: HasQuantities, name: str) -> tuple[Quantity, str]:
    """Return the quantity of a name, or a vector and which part is meant. Raises UnknownName."""
    if not isinstance(name, str):
        raise InvalidInput(Problem("quantity", f"{name!r} is no name", 'write "G.velocity", one text for each'))
    of, figure = motion_figure(name)
    if figure:
        return display_function("course")(motion, of, figure), ""
    owner, word, part = owner_and_part(motion, name)
    found = replace(read_of(owner, word), name=name.removesuffix(f".{part}") if part else name)
    if part:
        check_part(name, part, found.is_vector)
    return found, part


def read_of(owner: Owner, word: str) -> Quantity:
    """Return the quantity of an attribute of a point, link, pair or driver."""
    if word not in owner.attributes:
        figure = FIGURES[owner.kind][word]
        found = _quantity(owner, DERIVED[owner.kind][word], figure.values(owner.whole, owner.name))
        return replace(found, **figure.own(owner.whole, owner.name))
    attribute, motion = owner.attributes[word], getattr(owner.whole, owner.kind)[owner.name]
    known = hasattr(type(motion), word)
    return _quantity(owner, attribute, getattr(motion, word) if known else motion.derivative(attribute.order))


def _quantity(owner: Owner, found: Attribute, values: Any) -> Quantity:
    dimension, symbol = found.dimension or owner.dimension, f"{found.symbol}({owner.name})"
    unit = unit_of(owner.whole.mechanism.unit, dimension, found.order)
    # what a recorded motion has stays as it is
    plain = np.asarray(values) if isinstance(values, (np.ndarray, *PLAIN, complex)) else values
    return Quantity(f"{owner.name}.{found.word}", unit, plain, found.order, dimension, symbol)


def known_owners(motion: HasQuantities) -> list[str]:
    """List what has quantities: points, links, pairs and drivers, each once."""
    return list(dict.fromkeys(name for kind in CATALOGUE for name in getattr(motion, kind)))


def owner_and_part(motion: HasQuantities, name: str) -> tuple[Owner, str, str]:
    """Return the owner that a name asks, its attribute, and the part.

    Raises UnknownName.
    """
    try:
        return (*_requested(motion, name), "")
    except UnknownName as error:
        vector, _, part = name.rpartition(".")
        if not vector_and_part(name)[1] and not _is_known(motion, vector):
            if meant := _meant(motion, name):
                raise UnknownName(replace(error.problems[0], remedy=meant)) from None
            raise
    return (*_requested(motion, vector), part)


def _meant(motion: HasQuantities, name: str) -> str:
    """Return the remedy for a name of which the attribute is known, but not of this owner."""
    found = names_meant(motion, name)
    return f"did you mean {' or '.join(map(repr, found))}?" if found else ""


def names_meant(motion: HasQuantities, name: str) -> list[str]:
    """Return the names of quantities that one means of which the attribute is known, but not of this owner.

    "transmission_angle" alone is asked of all that has one, "block.velocity" of the block's points.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
    >>> names_meant(solve(crank), "B.angular_velocity")
    ['crank.angular_velocity']
    """
    owner, dot, word = name.rpartition(".")
    known_owner = owner in known_owners(motion)
    # what says itself why it has none keeps its reason
    explained = any(word in DERIVED[kind] and owner in getattr(motion, kind) for kind in CATALOGUE)
    if dot and (explained or not known_owner):
        return []
    owners = _beside(motion, owner) if known_owner else known_owners(motion)
    known = list(dict.fromkeys(word for kind in CATALOGUE for word in (*CATALOGUE[kind], *DERIVED[kind])))
    words = [one for one in (*known, *ALIASED) if plain_word(one) == plain_word(word)]
    words += [one for one in OTHER_WORDS.get(plain_word(word), ()) if one in known]
    if dot and any(_has(motion, owner, one) for one in words):
        return []
    still = [letter for letter, own in motion.mechanism.carriers.items() if FRAME in own] + [FRAME]
    found = dict.fromkeys(f"{one}.{word}" for word in words for one in owners if _has(motion, one, word))
    asked = [one for one in found if dot or one.partition(".")[0] not in still]
    return sorted(asked, key=lambda one: bool(dot) and one.partition(".")[0] not in motion.mechanism.links)[:4]


def _has(motion: HasQuantities, owner: str, word: str) -> bool:
    return any(owner in getattr(motion, kind) and owner_of(motion, kind, owner).has(word) for kind in CATALOGUE)


def _beside(motion: HasQuantities, owner: str) -> list[str]:
    """Return what belongs to an owner: the moving points of a link, the links of a point, pairs and drivers of both."""
    mechanism = motion.mechanism
    links = {owner} if owner in mechanism.links else set(mechanism.carriers.get(owner, ()))
    joined = {pair.name: set(pair.members) for pair in mechanism.written_pairs} | {
        drive.name: {drive.link, drive.on} - {FRAME} for drive in mechanism.drives
    }
    links |= joined.get(owner, set())
    moving = [letter for letter, own in mechanism.carriers.items() if links & set(own) and FRAME not in own]
    near = {*links, *moving, *(name for name, own in joined.items() if own & links)} - {owner, FRAME}
    return [one for one in known_owners(motion) if one in near]


def check_part(name: str, part: str, is_vector: bool) -> None:
    """Raise UnknownName where what a name asks for has no such part."""
    vector = name.removesuffix(f".{part}")
    if not is_vector:
        raise UnknownName(Problem(name, f"{vector} is no vector", f"leave .{part} out"))
    if part not in PARTS:
        raise UnknownName(Problem(name, f"{vector} has no {part!r}", suggestion(part, list(PARTS))))


def _is_known(motion: HasQuantities, name: str) -> bool:
    """Tell whether a name is that of an owner with one of its attributes."""
    owner, _, word = name.rpartition(".")
    return any(owner in getattr(motion, k) and owner_of(motion, k, owner).has(word) for k in CATALOGUE)


def _requested(motion: HasQuantities, name: str) -> tuple[Owner, str]:
    """Return the owner and the attribute of a name that means no part."""
    owner, dot, word = name.rpartition(".") if "." in name else (name, "", "")
    found = [owner_of(motion, kind, owner) for kind in CATALOGUE if owner in getattr(motion, kind)]
    if not found:
        what = f"there is no point, link, pair or driver {owner!r}"
        raise UnknownName(Problem(name, what, suggestion(owner, known_owners(motion))))
    for one in found:
        if not dot or one.has(word):
            return one, word if dot else next(iter(one.attributes))
    for lack in filter(None, (one.lack(word) for one in found)):
        raise UnknownName(Problem(name, f"{owner!r} has no {word!r}: {lack.reason}", lack.remedy))
    words = list(dict.fromkeys(word for one in found for word in one.words))
    others = ", ".join(kind for kind in DERIVED if word in DERIVED[kind])
    what = f"{owner!r} has no {word!r}{f', which only {others} have' if others else ''}"
    raise UnknownName(Problem(name, what, _nearest(owner, word, words)))


class Owner(NamedTuple):
    """A point, link, pair or driver of a motion. Its name, the attributes it has, the unit of each order."""

    name: str
    kind: Kind
    whole: HasQuantities
    dimension: Dimension
    attributes: Mapping[str, Attribute]

    def has(self, word: str) -> bool:
        """Tell whether it has an attribute, or what is derived of such an owner."""
        return word in self.attributes or (word in DERIVED[self.kind] and self.lack(word) is None)

    def lack(self, word: str) -> Lack | None:
        """Return why it has not what is derived of others. None where there is no reason."""
        return FIGURES[self.kind][word].lack(self.whole, self.name) if word in DERIVED[self.kind] else None

    @property
    def words(self) -> list[str]:
        """All that it has."""
        return [word for word in (*self.attributes, *DERIVED[self.kind]) if self.has(word)]


def owner_of(motion: HasQuantities, kind: Kind, name: str) -> Owner:
    """Return a point, link, pair or driver as the owner of quantities."""
    if kind not in ("pairs", "drives"):
        return Owner(name, kind, motion, "length" if kind == "points" else "angle", CATALOGUE[kind])
    dimension = coordinate_dimension(getattr(motion, kind)[name].is_angle)
    return Owner(name, kind, motion, dimension, {**CATALOGUE[kind], **ALIASES[dimension]})


def _nearest(owner: str, word: str, known: list[str]) -> str:
    remedy = suggestion(word, known)
    return f"did you mean '{owner}.{remedy.split(chr(39))[1]}'?" if remedy.startswith("did") else remedy


# Other names of values of pairs.
ALIASED = tuple(dict.fromkeys(word for own in ALIASES.values() for word in own))

ASSEMBLED, DESIGN, PHASE = "assembled", "design", "phase"


# What files and data frames say of the angles in them.
ANGLES = "radians"


class AtPoses(HasQuantities, Protocol):
    """A motion: what has quantities, at poses."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of every array of the motion, the last axis its poses."""

    @property
    def order(self) -> int:
        """The highest derivative that is known."""

    @property
    def time(self) -> Number | None:
        """The times of the poses, where it is in time."""

    @property
    def assembled(self) -> Number:
        """Which poses are assembled."""


def data_frame(title: str, columns: Mapping[str, Any], units: Mapping[str, str]) -> Any:
    """Return columns as a pandas DataFrame.

    Its `attrs` hold the title, the units and how angles are counted. Raises InvalidInput where pandas is not installed.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        raise missing_extra("", "this needs pandas", "pandas") from None
    frame = pandas.DataFrame(columns)
    frame.attrs = {"title": title, "angles": ANGLES, "units": dict(units)}
    return frame


@dataclass(frozen=True, eq=False, repr=False)
class Table:
    """Columns of real quantities, a row for each pose. The last axis of the motion, its poses, runs fastest.

    Where the motion has designs, index columns come first: `design`, or `design0`, `design1` ... Then come the time,
    if it has any, drivers, points (.x, .y), links, pairs, and whether each pose is `assembled`. Angles are radians, in
    `shown` degrees; rates are always by radians and seconds.
    """

    title: str
    columns: tuple[Quantity, ...]

    @cached_property
    def _named(self) -> Mapping[str, Quantity]:
        return {column.name: column for column in self.columns}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(self._named)

    @property
    def units(self) -> Mapping[str, str]:
        """The unit of every column that has one."""
        return {column.name: column.unit for column in self.columns if column.unit}

    @property
    def shown(self) -> Table:
        """As it is shown to people: angles in degrees."""
        return replace(self, columns=tuple(column.shown for column in self.columns))

    def __getitem__(self, name: str) -> Quantity:
        """Return a column by its name; raises UnknownName with the nearest there is."""
        if name not in self._named:
            raise UnknownName(Problem(str(name), "the table has no such column", suggestion(str(name), self.names)))
        return self._named[name]

    def __len__(self) -> int:
        return len(self.columns[-1].values)

    def to_pandas(self) -> Any:
        """Return it as a pandas DataFrame, angles in radians.

        Its `attrs` hold the title, the units and how angles are counted. Raises InvalidInput where pandas is not
        installed.
        """
        return data_frame(self.title, {column.name: column.values for column in self.columns}, self.units)

    def __repr__(self) -> str:
        return f"Table({self.title!r}: {len(self)} rows of {len(self.columns)} columns)"


def table_of(motion: AtPoses, *names: str) -> Table:
    """Return the table of the quantities named, with designs, time and drivers.

    Everything where none is named. Raises UnknownName for a quantity that the motion does not have.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> found = table_of(solve(crank, {"crank": [0.0, 1.0]}), "B.velocity")
    >>> found, found.names
    (Table('m': 2 rows of 4 columns), ('crank.value', 'B.velocity.x', 'B.velocity.y', 'assembled'))
    >>> found.shown["crank.value"].values.round(3).tolist()
    [0.0, 57.296]
    """
    chosen = _chosen(motion, names) if names else _everything(motion)
    whole = (*_time(motion), *chosen, Quantity(ASSEMBLED, "", motion.assembled))
    columns = {column.name: column for column in _designs(motion.shape)}
    for column in (part for one in whole for part in one.components):
        flat = np.broadcast_to(column.values, motion.shape).reshape(-1)
        columns.setdefault(column.name, replace(column, values=flat))
    return Table(motion.mechanism.title, tuple(columns.values()))


def has_quantity(motion: HasQuantities, name: str) -> bool:
    """Return whether a motion has a quantity of a name."""
    try:
        quantity(motion, name)
    except UnknownName:
        return False
    return True


def tables_in_a_row(title: str, tables: Sequence[Table]) -> Table:
    """Return tables of several phases as one, with the number of each from 1.

    Where a phase has not a column of another one it is NaN.
    """
    phases = [np.full(len(table), k + 1) for k, table in enumerate(tables)]
    found = {PHASE: Quantity(PHASE, "", np.concatenate(phases))}
    for column in (column for table in tables for column in table.columns):
        if column.name not in found:
            parts = [table[column.name].values if column.name in table.names else np.full(len(table), np.nan)
                     for table in tables]  # fmt: skip
            found[column.name] = replace(column, values=np.concatenate(parts))
    return Table(title, tuple(found.values()))


def _chosen(motion: AtPoses, names: Sequence[str]) -> Iterator[Quantity]:
    """Return the drivers' values and what is named."""
    found = [quantity(motion, name) for name in names]
    yield from (read_of(owner_of(motion, "drives", name), VALUE) for name in motion.drives)
    yield from found


def _designs(shape: tuple[int, ...]) -> Iterator[Quantity]:
    """Return the index columns of the designs: one for each axis before the last."""
    axes = len(shape) - 1
    for axis in range(axes):
        yield Quantity(DESIGN if axes == 1 else f"{DESIGN}{axis}", "", np.indices(shape)[axis].reshape(-1))


def _time(motion: AtPoses) -> Iterator[Quantity]:
    if motion.time is not None:
        yield Quantity(TIME, unit_of("", "time"), motion.time, dimension="time", symbol="t")


def _everything(motion: AtPoses) -> Iterator[Quantity]:
    """Return all derivatives of all there is; where a pin and a driver have one name, the value is the driver's."""
    for kind, words in TABULATED.items():
        for name in getattr(motion, kind):
            first = int(kind == "pairs" and name in motion.drives)
            if (kind, name) != ("links", FRAME):
                owner = owner_of(motion, kind, name)
                yield from (read_of(owner, word) for word in words[first : motion.order + 1])
