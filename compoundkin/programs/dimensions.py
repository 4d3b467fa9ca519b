"""Dimensions of a mechanism by name: free ones, their values in a call, and the mechanism with other values.

What pairs read off the drawing is stated as a number, and stays when points move. In an overconstrained mechanism few
dimensions can be changed alone: the others open redundant pairs. A program reads the values and rates of drivers, not
the numbers of their laws.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import as_python_number, checked, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import CompoundkinError, InvalidInput, InvalidMechanism, Problem, UnknownName, suggestion
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import AXES, PARTS, Dimension, component_names, unit_of
from compoundkin.model.elements import Drive, Expectation, Link
from compoundkin.model.fields import changed_fields, stated_numbers
from compoundkin.model.geometry import vector
from compoundkin.model.laws.law_numbers import law_numbers, law_of_designs, law_with
from compoundkin.model.loads.mass import Mass
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import pairs_among
from compoundkin.model.pairs.contract import Ends, drawn_fields
from compoundkin.programs.graph.operation_graph import DIMENSION, InputNumber

# The word of a law's numbers.
LAW = "law"


@dataclass(frozen=True)
class FreeDimension:
    """A dimension by its name.

    It is of a link (`word` is the letter of a point, `part` empty for both coordinates), of a pair or cylinder
    (`word` is a field, `part` which of two numbers), of the law of a driver (`part` is the number), whose values
    and rates programs then have as inputs, and not the number itself, or of a mass or load (`word` is a field), which
    no motion depends on: figures of forces are then found by solving.
    """

    name: str
    owner: str
    word: str
    part: str = ""
    is_of_link: bool = False
    is_of_law: bool = False
    is_of_load: bool = False

    @property
    def is_read(self) -> bool:
        """Whether programs read it."""
        return not (self.is_of_law or self.is_of_load)

    @property
    def is_vector(self) -> bool:
        """Whether it is a point, not a number."""
        return self.is_of_link and not self.part

    @property
    def base(self) -> str:
        """The name without its part."""
        return f"{self.owner}.{self.word}"

    @property
    def number(self) -> str:
        """The name of a pair's number: its word, with its part where it has several."""
        return f"{self.word}.{self.part}" if self.part else self.word

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of its numbers: both coordinates of a point."""
        return component_names(self.name) if self.is_vector else (self.name,)

    @property
    def inputs(self) -> tuple[InputNumber, ...]:
        """The inputs of a program that it is: two of a point."""
        if self.is_vector:
            return tuple(InputNumber(DIMENSION, self.name, part) for part in AXES)
        if self.is_of_link:
            return (InputNumber(DIMENSION, self.base, self.part),)
        return (InputNumber(DIMENSION, self.name),)

    def parts_of(self, value: Number) -> Iterator[tuple[InputNumber, Number]]:
        """Yield the inputs that it is with their parts of a value."""
        yield from zip(self.inputs, (np.real(value), np.imag(value)), strict=False)

    def part_of(self, value: Number) -> Number:
        """Return its part of a point."""
        return PARTS[self.part](value) if self.part else value

    def value_in(self, given: Mapping[InputNumber, Number]) -> Number:
        """Return its value among the inputs of a call, perhaps a single number."""
        parts = [given[one] for one in self.inputs]
        whole = parts[0] + 1j * parts[1] if self.is_vector else parts[0]
        return whole.item() if np.size(whole) == 1 else whole


# Of the kinds of keys that are numbers.
_DIMENSIONS: Mapping[str, Dimension] = {
    **dict.fromkeys(("length", "reach"), "length"),
    **dict.fromkeys(("angle", "turn", "sweep"), "angle"),
}


@dataclass(frozen=True, repr=False)
class StatedDimensions(ShortRepr):
    """The dimensions of a mechanism.

    `ends` are the sides of pairs in its motion: phases that are drawn are those for the turns that it has made.
    """

    mechanism: Mechanism
    ends: Mapping[str, Ends]

    @cached_property
    def read_off(self) -> dict[str, Mapping[str, Number]]:
        """What pairs read off the drawing, by their names and fields."""
        geometry, pairs = self.mechanism.geometry, self.mechanism.written_pairs
        return {pair.name: drawn_fields(pair, self.ends[pair.name], geometry) for pair in pairs}

    @cached_property
    def items(self) -> Mapping[str, Any]:
        """What is written with numbers besides points, by name: pairs and cylinders."""
        return {**{pair.name: pair for pair in pairs_among(self.mechanism.items)}, **self.mechanism.cylinders}

    @cached_property
    def known(self) -> dict[str, FreeDimension]:
        """All dimensions by name."""
        found = {one.name: one for one in self._load_numbers()}
        return found | {one.name: one for one in (*self._numbers(), *self._law_numbers(), *self._points())}

    @cached_property
    def loaded(self) -> dict[str, list[Any]]:
        """The masses, loads and frictions by the words under which their numbers stand: "rod", "return spring", "C"."""
        mechanism, found = self.mechanism, dict[str, list[Any]]()
        points = mechanism.geometry.points
        # without the rotors of motors, which are not written with the masses
        masses = {one.link: one.completed(points[one.link]) for one in mechanism.items if isinstance(one, Mass)}
        named = masses, mechanism.loads, mechanism.frictions, mechanism.pretensions
        for items in named:
            for name, item in items.items():
                found.setdefault(name, []).append(item)
        return found

    def loads_of(self, one: FreeDimension) -> Any:
        """Return the mass, load or friction that has a number."""
        return next(item for item in self.loaded[one.owner] if one.number in load_numbers(item))

    def own(self, one: FreeDimension) -> Number:
        """Return the mechanism's own value of a dimension."""
        if one.is_of_link:
            return one.part_of(self.mechanism.geometry.points[one.owner][one.word])
        if one.is_of_law:
            return self._laws[one.owner][one.part]
        if one.is_of_load:
            return load_numbers(self.loads_of(one))[one.number]
        return self._stated(one.owner)[one.number]

    def unit(self, one: FreeDimension) -> str:
        """Return the unit of a dimension. Ratios and numbers of laws have none."""
        if not one.is_read:
            return ""
        keys = () if one.is_of_link else self.items[one.owner].keys
        kind = next((key.kind for key in keys if key.name == one.word), "length")
        dimension = _DIMENSIONS.get(kind)
        return unit_of(self.mechanism.unit, dimension) if dimension else ""

    def _numbers(self) -> Iterator[FreeDimension]:
        for owner in self.items:
            for number in self._stated(owner):
                yield FreeDimension(f"{owner}.{number}", owner, *number.partition(".")[::2])

    @cached_property
    def _laws(self) -> dict[str, Mapping[str, Number]]:
        return {drive.name: law_numbers(drive.law) for drive in self.mechanism.drives if drive.law is not None}

    def _law_numbers(self) -> Iterator[FreeDimension]:
        for owner, numbers in self._laws.items():
            for number in numbers:
                yield FreeDimension(f"{owner}.{LAW}.{number}", owner, LAW, number, is_of_law=True)

    def _load_numbers(self) -> Iterator[FreeDimension]:
        for owner, items in self.loaded.items():
            for number in dict.fromkeys(number for item in items for number in load_numbers(item)):
                yield FreeDimension(f"{owner}.{number}", owner, *number.partition(".")[::2], is_of_load=True)

    def _points(self) -> Iterator[FreeDimension]:
        for owner, link in self.mechanism.rigid_links.items():
            for letter in link.points:
                for part in ("", *AXES):
                    yield FreeDimension(".".join((owner, letter, *part)), owner, letter, part, True)

    def _stated(self, owner: str) -> Mapping[str, Number]:
        return {**stated_numbers(self.items[owner]), **self.read_off.get(owner, {})}


@checked
def with_dimensions(mechanism: Mechanism, dimensions: Mapping[str, Any]) -> Mechanism:
    """Return a mechanism with other dimensions, by the names that studies and programs have for them.

    "crank.B.x" is a coordinate of a point in its link's frame, "crank.B" both, "way.angle" a number of a pair
    (radians), "rod.mass" one of a mass or load. What pairs read off the drawing stays as it was; published numbers,
    which are those of the old dimensions, are left out. Raises UnknownName for names that are no dimensions,
    InvalidInput for values that are no finite numbers or points, InvalidMechanism for dimensions that no such mechanism
    can have.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> with_dimensions(crank, {"crank.B.x": 22}).links["crank"].points["B"]
    (22+0j)
    >>> with_dimensions(crank, {"crank.C": 22})
    Traceback (most recent call last):
    compoundkin.base.errors.UnknownName: dimensions.crank.C: it has no such dimension, or it is not stated; \
did you mean 'crank.B'?
    """
    geometry = mechanism.geometry
    stated = StatedDimensions(mechanism, {pair.name: pair.ends(geometry) for pair in mechanism.written_pairs})
    if not isinstance(dimensions, Mapping):
        raise InvalidInput(Problem("dimensions", f"{short_repr(dimensions)} is no table", 'write {"crank.B.x": 22}'))
    unknown = [_unknown_dimension(stated, str(name)) for name in dimensions if name not in stated.known]
    if unknown:
        raise UnknownName([replace(one, where=one.where.replace("free.", "dimensions.", 1)) for one in unknown])
    free = free_dimensions(stated, list(dimensions))
    changed = mechanism_with(stated, dimension_values(stated, free, dimensions))
    published = [item for item in changed.items if isinstance(item, Expectation)] if dimensions else []
    if not published:
        return changed
    words: dict[str, Any] = {name: getattr(changed, name) for name in ("source", "description", "outputs", "time")}
    kept = (item for item in changed.items if not isinstance(item, Expectation))
    return Mechanism(changed.title, *kept, **words, **changed.unit_words)


def free_dimensions(stated: StatedDimensions, names: Sequence[str]) -> tuple[FreeDimension, ...]:
    """Return the dimensions of some names; raises UnknownName, InvalidInput where one is named twice.

    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> free_dimensions(StatedDimensions(crank, solve(crank).inputs.ends), ["crank.B.x"])[0].word
    'B'
    """
    unknown = [_unknown_dimension(stated, name) for name in names if name not in stated.known]
    if unknown:
        raise UnknownName(unknown)
    found = [stated.known[name] for name in names]
    for k, one in enumerate(found):
        for other in found[:k]:
            if set(one.inputs) & set(other.inputs):
                raise InvalidInput(
                    Problem(f"free.{one.name}", f"it is named twice, as {other.name!r} before", "name it once")
                )
    return tuple(found)


def _unknown_dimension(stated: StatedDimensions, name: str) -> Problem:
    owner = name.partition(".")[0]
    own = [known for known in stated.known if known.partition(".")[0] == owner]
    what = "it has no such dimension, or it is not stated" if own else "there is no such dimension"
    links = stated.mechanism.links
    side = [link for link, one in links.items() if {*name} <= {*one.points} and len(name) == 2]
    bar = side[0] if side else owner if name in (owner, f"{owner}.length") and owner in links else ""
    ends = [one for one in stated.known if bar and one.startswith(f"{bar}.") and one.rpartition(".")[2] == "x"]
    numbers = {one: stated.own(stated.known[one]) for one in ends}
    moved = [one for one, number in numbers.items() if np.any(number)]
    remedy = f"did you mean {moved[0]!r}?" if len(moved) == 1 else suggestion(name, own or list(stated.known))
    return Problem(f"free.{name}", what, remedy)


def check_single_values(stated: StatedDimensions, free: Sequence[FreeDimension]) -> None:
    """Raise InvalidInput where a dimension has several values and is not free."""
    freed = {given for one in free for given in one.inputs}
    several = [
        one.name
        for one in stated.known.values()
        if one.is_read and not freed.issuperset(one.inputs) and np.ndim(stated.own(one))
    ]
    if several:
        remedy = f"compile(..., free={[*(one.name for one in free), several[0]]!r})"
        raise InvalidInput(Problem(several[0], "it has several values: a program has one of what is not free", remedy))


def dimension_values(
    stated: StatedDimensions, free: Sequence[FreeDimension], given: Mapping[str, Any] | None
) -> dict[FreeDimension, Number]:
    """Return the values of all free dimensions.

    They are those that are given, else the mechanism's own. Raises InvalidInput for dimensions that are not free, and
    for what is no finite number or point.
    """
    given = {} if given is None else given
    if not isinstance(given, Mapping):
        raise InvalidInput(Problem("dimensions", f"{short_repr(given)} is no table by name", 'write {"crank.B": ...}'))
    names = [one.name for one in free]
    wrong = [Problem(f"dimensions.{name}", *_not_free(stated, name, names)) for name in given if name not in names]
    if wrong:
        raise InvalidInput(wrong)
    return {one: _checked_value(one, given[one.name]) if one.name in given else stated.own(one) for one in free}


def check_laws(free: Sequence[FreeDimension], given: Mapping[str, Any] | None, times: Number | None) -> None:
    """Raise InvalidInput where numbers of laws are given and no law moves."""
    asked = [one.name for one in free if one.is_of_law and one.name in (given or {})]
    if asked and times is None:
        what, remedy = "the drivers' values are given, and no law moves them", "leave the values out, and give time=..."
        raise InvalidInput([Problem(f"dimensions.{name}", what, remedy) for name in asked])


def _not_free(stated: StatedDimensions, name: object, names: Sequence[str]) -> tuple[str, str]:
    if name in stated.known:
        return "this dimension is not free", f"compile(..., free={[*names, name]!r})"
    return "there is no such free dimension", suggestion(name, names)


def _checked_value(one: FreeDimension, value: Any) -> Number:
    where = f"dimensions.{one.name}"
    try:
        found = vector(where, value) if one.is_vector else real_numbers(where, value)
    except InvalidMechanism as error:
        raise InvalidInput(error.problems) from None
    if not np.size(found) or not np.isfinite(found).all():
        raise InvalidInput(Problem(where, "the value is empty or not finite"))
    if one.is_of_law and np.shape(found)[-1:] > (1,):
        what = f"it holds {np.shape(found)[-1]} numbers along the motion, in which a law cannot change"
        raise InvalidInput(Problem(where, what, "give one number, or one for each design: [[1.0], [2.0]]"))
    return found


def mechanism_with(
    stated: StatedDimensions, values: Mapping[FreeDimension, Number], must_fit: bool = True
) -> Mechanism:
    """Return the mechanism with these dimensions, several designs where they are arrays.

    What its pairs read off the drawing stays as it was. Raises InvalidMechanism for dimensions that
    no such mechanism can have; if wheels need not fit, designs in which they do not are not assembled.
    """
    links: dict[str, dict[str, Number]] = {}
    numbers: dict[str, dict[str, Number]] = {}
    for one, value in values.items():
        if one.is_of_link:
            points = links.setdefault(one.owner, dict(stated.mechanism.geometry.points[one.owner]))
            points[one.word] = as_python_number(
                value if one.is_vector else _with_part(points[one.word], one.part, value)
            )
        elif one.is_read:
            numbers.setdefault(one.owner, {})[one.number] = as_python_number(value)
    items: list[Any] = [Link(name, points) for name, points in links.items()]
    items += loads_with(stated, values)
    for name, item in stated.items.items():
        changes = {**stated.read_off.get(name, {}), **changed_fields(item, numbers.get(name, {}))}
        if changes:
            items.append(replace(item, **changes))
    own = [item for item in stated.mechanism.items if isinstance(item, Drive)]
    drives = drives_with(own, values, law_with)
    if any(np.shape(value)[-1:] > (1,) for value in values.values()):
        # a motion of its own, which is perhaps not as long as that along which dimensions vary
        drives = [replace(one, values=None) if isinstance(one.values, np.ndarray) else one for one in drives]
    items += [one for one, before in zip(drives, own, strict=True) if one is not before]
    return (stated.mechanism.replace if must_fit else stated.mechanism.as_design)(*items) if items else stated.mechanism


def loads_with(stated: StatedDimensions, values: Mapping[FreeDimension, Number]) -> list[Any]:
    """Return masses, loads and frictions with other numbers; what is left out of a mass follows the new ones."""
    changed: dict[int, tuple[Any, dict[str, Any]]] = {}
    for one, value in values.items():
        if one.is_of_load:
            item = stated.loads_of(one)
            _, fields = changed.setdefault(id(item), (item, {}))
            whole = fields.get(one.word, getattr(item, one.word))
            fields[one.word] = as_python_number(_with_part(whole, one.part, value) if one.part else value)
    written = {(type(item), item.name): item for item in stated.mechanism.items if hasattr(item, "name")}
    return [replace(written.get((type(item), item.name), item), **fields) for item, fields in changed.values()]


# Kinds of keys of masses and loads that are a number, or a number or a law, and that are a vector.
_NUMBERS, _VECTORS = ("length", "angle", "number", "coordinate", "rate", "amount"), ("spot", "planar", "point")


def load_numbers(item: Any) -> dict[str, Number]:
    """Return the numbers of a mass, a load or a friction by name: "stiffness", "at.x".

    >>> from compoundkin.model.loads.spring import spring
    >>> sorted(load_numbers(spring("arm", 2 + 1j, at="S", stiffness=900)))
    ['free_length', 'point.x', 'point.y', 'preload', 'stiffness']
    """
    found: dict[str, Number] = {}
    for key in item.keys:
        value = getattr(item, key.name)
        if isinstance(value, bool) or not isinstance(value, int | float | complex | np.ndarray):
            continue
        if key.kind in _NUMBERS and not np.iscomplexobj(value):
            found[key.name] = value
        elif key.kind in _VECTORS:
            found |= {f"{key.name}.{part}": PARTS[part](value) for part in AXES}
    return found


def _with_part(point: Number, part: str, value: Number) -> Number:
    return value + 1j * np.imag(point) if part == "x" else np.real(point) + 1j * value


def drives_with(
    drives: Sequence[Drive],
    values: Mapping[FreeDimension, Number],
    how: Callable[[Any, Mapping[str, Number]], Any] = law_of_designs,
) -> list[Drive]:
    """Return drivers with other numbers of their laws. Raises InvalidMechanism for those that no law can have.

    What is no number of a law is passed over. Arrays are those of designs, `how` makes a law with them.
    """
    numbers: dict[str, dict[str, Number]] = {}
    for one, value in values.items():
        if one.is_of_law:
            numbers.setdefault(one.owner, {})[one.part] = as_python_number(value)
    return [replace(one, law=how(one.law, numbers[one.name])) if one.name in numbers else one for one in drives]


def drives_of_call(drives: Sequence[Drive], values: Mapping[FreeDimension, Number]) -> list[Drive]:
    """Return drivers as `drives_with` does; raises InvalidInput for numbers that no law can have."""
    try:
        return drives_with(drives, values)
    except InvalidMechanism as error:
        raise InvalidInput([replace(one, where=f"dimensions: {one.where}") for one in error.problems]) from None


# By which part of the size, or of itself, a dimension is changed: redundant pairs open by far more than by rounding.
CHANGE = 1e-3


ASIDE = 0.6 + 0.8j


def check_redundant_pairs(motion: Motion, stated: StatedDimensions, free: Sequence[FreeDimension]) -> None:
    """Raise InvalidInput for a dimension that opens redundant pairs where it changes alone.

    Nothing is asked of a mechanism that is not overconstrained.
    """
    redundant = motion.structure.redundant
    for one in (each for each in free if redundant and each.is_read):
        value = stated.own(one)
        step = CHANGE * (
            motion.size * ASIDE if one.is_vector else motion.size if one.is_of_link else _size_of_value(value)
        )
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                solve(
                    mechanism_with(stated, {one: value + step}),
                    {name: v[0] for name, v in motion.inputs.drives.items()},
                )
        except CompoundkinError:
            pairs = ", ".join(pair.name for pair in redundant)
            what = f"the mechanism is overconstrained, it moves by its special dimensions only: {pairs} would open"
            raise InvalidInput(
                Problem(f"free.{one.name}", what, "leave it fixed, or take out what is redundant")
            ) from None


def _size_of_value(value: Number) -> float:
    return float(np.max(np.abs(value))) or 1.0
