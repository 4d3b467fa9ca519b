"""`StudyResult`: the rows of a study, one for each design, and the Pareto-optimal ones of two objectives."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase, display_function
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import ASSEMBLED, Quantity, Table, data_frame
from compoundkin.model.attributes import AXES
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.study_folder import open_folder
from compoundkin.studies.study_plan import StudyPlan
from compoundkin.studies.study_program import StudyColumn
from compoundkin.studies.study_rows import StudyRows

_X, _Y = (f".{axis}" for axis in AXES)


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult(DisplaysHtml, ShortRepr):
    """The result of a study: `study` is its definition, `rows` are those computed.

    Angles are radians, vectors complex; a design that does not assemble is NaN, False in "assembled", and has a
    "reason".

    >>> import compoundkin as ck
    >>> crank_rocker = ck.load("crank-rocker")
    >>> result = ck.study(crank_rocker, {"crank.B.x": (1.8, 2.2)}, "rocker.angle.stroke", count=64).run()
    >>> result.names[:4], len(result)
    (('row', 'crank.B.x', 'rocker.angle.stroke', 'assembled'), 64)
    >>> (best,) = result.best("rocker.angle.stroke", greatest=True)
    >>> bool(best["rocker.angle.stroke"] == result["rocker.angle.stroke"].max())
    True
    """

    study: StudyPlan
    rows: StudyRows

    @classmethod
    @checked
    def open(cls, folder: str | os.PathLike[str]) -> StudyResult:
        """Return the result in a folder, at the end of a run or before.

        Raises InvalidInput for a folder without a study, or a study with Python functions.
        """
        return cls(*open_folder(folder))

    @property
    def columns(self) -> tuple[StudyColumn, ...]:
        """Its columns: name, unit, kind, and width of a course."""
        return self.rows.columns

    @property
    def reference(self) -> Motion:
        """The motion of the mechanism as it stands, over the same poses."""
        return self.study.program.path.reference

    @cached_property
    def _named(self) -> Mapping[str, StudyColumn]:
        return {column.name: column for column in self.rows.columns}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns: the row's number, dimensions, outputs, states."""
        return tuple(self._named)

    @cached_property
    def _vectors(self) -> tuple[str, ...]:
        return tuple(
            name.removesuffix(_X)
            for name in self.names
            if name.endswith(_X) and name.removesuffix(_X) + _Y in self._named
        )

    def __len__(self) -> int:
        return self.rows.count

    @property
    def is_complete(self) -> bool:
        """Whether all rows of the study are computed."""
        return len(self) == len(self.study)

    @checked
    def __getitem__(self, name: str) -> Number:
        """Return a column by its name, (rows,), a course (rows, poses). The name of a vector gives both parts, complex.

        Raises UnknownName with the nearest name.
        """
        if name in self._named:
            return self.rows.column(name)
        if name in self._vectors:
            return self.rows.column(name + _X) + 1j * self.rows.column(name + _Y)
        known = [*self.names, *self._vectors]
        raise UnknownName(Problem(name, "the study has no such column", suggestion(name, known)))

    def __contains__(self, name: object) -> bool:
        return name in self._named or name in self._vectors

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    @property
    def assembled(self) -> Number:
        """Which rows assemble over the whole range of the drivers."""
        return self.rows.column(ASSEMBLED)

    @checked
    def best(self, name: str, count: int = 1, *, greatest: bool = False) -> tuple[dict[str, Any], ...]:
        """Return the rows with the least values of a figure, or the greatest.

        The best is first. They are those that assemble, each with all columns by name.
        Raises InvalidInput for a column that is no number.
        """
        self._check_number(name)
        if count < 1:
            raise InvalidInput(Problem("count", f"there are no {count} best rows", "at least 1"))
        best, places, start = np.empty(0), np.empty(0, dtype=int), 0
        for piece in self.rows.pieces(name, ASSEMBLED):
            values = -piece[name] if greatest else piece[name]
            valid = piece[ASSEMBLED] & np.isfinite(values)
            if len(places) == count:
                # of equal rows the first ones stay
                valid &= values < best[-1]
            found = np.flatnonzero(valid)
            if len(found):
                best, places = np.append(best, values[found]), np.append(places, start + found)
                order = np.argsort(best, kind="stable")[:count]
                best, places = best[order], places[order]
            start += len(values)
        return self._rows(places)

    def _check_number(self, name: str) -> None:
        """Raise InvalidInput for a column that is not one number for each row, UnknownName for none."""
        column = self._named.get(name)
        piece = {} if column is None else next(self.rows.pieces(name), {})
        values = piece[name] if piece else self[name]
        if values.ndim != 1 or values.dtype.kind not in "fiu":
            remedy = "take a figure, such as its least value" if values.ndim == 2 else ""
            raise InvalidInput(Problem(name, "it is not one number for each row", remedy))

    @checked
    def percentiles(self, name: str, shares: Sequence[float], *, factor: float = 1.0) -> list[float]:
        """Return percentiles of a column, times a factor, among the rows that assemble; nothing where none is known.

        Shares are from 0 to 100. Raises InvalidInput for others, and for a column that is no number.

        They are those of `numpy.percentile`, in memory that does not grow with the rows.

        >>> import compoundkin as ck
        >>> result = ck.study(ck.load("crank-rocker"), {"crank.B.x": (1.8, 2.2)}, "rocker.angle.stroke", count=64).run()
        >>> least, middle = result.percentiles("rocker.angle.stroke", [0.0, 50.0])
        >>> strokes = result["rocker.angle.stroke"]
        >>> least == float(strokes.min()), middle == float(np.median(strokes))
        (True, True)
        """
        self._check_number(name)
        wrong = next((share for share in shares if not 0.0 <= share <= 100.0), None)
        if wrong is not None:
            raise InvalidInput(Problem("shares", f"{wrong:g} is no percentile", "give numbers from 0 to 100"))

        def known() -> Iterator[Number]:
            for piece in self.rows.pieces(name, ASSEMBLED):
                yield piece[name][piece[ASSEMBLED] & np.isfinite(piece[name])] * factor

        return percentiles_of(known, shares)

    def counts(self, name: str, *, assembled: bool = False) -> Counter[Any]:
        """Return how many rows have each value of a state, perhaps only of those that assemble."""
        found: Counter[Any] = Counter()
        for piece in self.rows.pieces(*dict.fromkeys([name, ASSEMBLED])):
            values = piece[name][piece[ASSEMBLED]] if assembled else piece[name]
            if values.dtype == bool:
                many = int(np.count_nonzero(values))
                found.update({key: count for key, count in ((True, many), (False, len(values) - many)) if count})
            else:
                found.update(values.tolist())
        return found

    def _rows(self, places: Number) -> tuple[dict[str, Any], ...]:
        found = self.rows.picked(places)
        # a vector stands where its first part does
        row = {name.removesuffix(_X) if name.removesuffix(_X) in self._vectors else name: column
                 for name, column in found.items() if name.removesuffix(_Y) not in self._vectors}  # fmt: skip
        for name in self._vectors:
            row[name] = found[name + _X] + 1j * found[name + _Y]
        return tuple({name: _single(column[k]) for name, column in row.items()} for k in range(len(places)))

    @checked
    def mechanism(self, row: int) -> Mechanism:
        """Return the mechanism of a row, by its number. Raises InvalidInput where there is none."""
        return self.study.mechanism_of(row)

    @checked
    def motion(self, row: int) -> Motion:
        """Return the motion of a row, by its number.

        Raises InvalidInput where there is none, NotAssembled where it has no pose at all.
        """
        return self.study.motion_of(row)

    def table(self, *names: str) -> Table:
        """Return columns as a table, to be saved.

        All but courses where none is named. Raises UnknownName, InvalidInput for courses.
        """
        chosen = names or tuple(name for name, column in self._named.items() if not column.width)
        found = [part for name in chosen for part in self._quantity(name).components]
        return Table(self.study.mechanism.title, tuple(found))

    def _quantity(self, name: str) -> Quantity:
        values = self[name]
        if values.ndim > 1:
            raise InvalidInput(Problem(name, "it has a value at every pose: no column of a table", "leave it out"))
        if values.dtype == object:
            values = np.array(["" if one is None else one for one in values], dtype=str)
        column = self._named.get(name) or self._named[name + _X]
        return Quantity(name, column.unit, values)

    def to_pandas(self) -> Any:
        """Return it as a pandas DataFrame, angles in radians.

        A course is an array in each row. Its `attrs` hold the title, the units and how angles are counted.
        Raises InvalidInput where pandas is not installed.
        """
        columns = {name: self.rows.column(name) for name in self.names}
        units = {name: column.unit for name, column in self._named.items() if column.unit}
        listed = {name: values if values.ndim == 1 else list(values) for name, values in columns.items()}
        return data_frame(self.study.mechanism.title, listed, units)

    def plot(self, *names: str, **options: Any) -> Any:
        """Plot columns against each other."""
        return display_function("study_plot")(self, *names, **options)

    def __repr__(self) -> str:
        there = f"{len(self):,}" if self.is_complete else f"{len(self):,} of {len(self.study):,}"
        return f"StudyResult({self.study.mechanism.title!r}: {there} rows of {count_phrase(len(self.names), 'column')})"


def _single(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


# So many values are sorted at once. Ranges with more of them are counted first, in so many classes each, of which there
# are no more in all than these.
MOST_SORTED, CLASSES, MOST_CLASSES = 2**22, 2**16, 2**22
# So many values are laid by columns at once.
MOST_LAID = 2**20


def percentiles_of(pieces: Callable[[], Iterable[Number]], shares: Sequence[float]) -> list[float]:
    """Return percentiles of finite values that come in pieces, each time they are asked for; nothing without values.

    >>> values = np.arange(10.0) ** 2
    >>> percentiles_of(lambda: np.split(values, 2), [0.0, 25.0, 100.0]), np.percentile(values, 25.0).item()
    ([0.0, 5.25, 81.0], 5.25)
    """
    found = percentiles_by_column(lambda: (piece[:, None] for piece in pieces()), 1, shares)[:, 0]
    return [] if np.isnan(found).any() else found.tolist()


def percentiles_by_column(pieces: Callable[[], Iterable[Number]], columns: int, shares: Sequence[float]) -> Number:
    """Return percentiles of the finite values of each column, (shares, columns), NaN where there are none.

    Values (rows, columns) come in pieces, each time they are asked for. Percentiles are those of `numpy.percentile`:
    between two neighbours in order, linear. Of very many values, the ranges in which these neighbours lie are narrowed
    by counting, those of all columns at once: pieces are read three or four times, seldom six, and memory does not grow
    with the rows.

    >>> values = np.array([[0.0, np.nan], [1.0, np.nan], [4.0, np.nan]])
    >>> percentiles_by_column(lambda: [values[:1], values[1:]], 2, [50.0]).tolist()
    [[1.0, nan]]
    """
    sizes, low, high = np.zeros(columns, dtype=int), np.full(columns, np.inf), np.full(columns, -np.inf)
    for values in _by_columns(pieces):
        known = np.isfinite(values)
        sizes += np.count_nonzero(known, axis=1)
        low = np.minimum(low, values.min(axis=1, initial=np.inf, where=known))
        high = np.maximum(high, values.max(axis=1, initial=-np.inf, where=known))
    places = (np.maximum(sizes, 1) - 1) * (np.reshape(shares, (-1, 1)) / 100.0)
    before = places.astype(int)
    after = np.minimum(before + 1, np.maximum(sizes, 1) - 1)
    wanted = [np.unique([before[:, column], after[:, column]]) for column in range(columns)]
    ranges = [
        _SoughtRange(column, float(low[column]), float(high[column]), int(sizes[column]), 0, wanted[column])
        for column in np.flatnonzero(sizes).tolist()
    ]
    ordered: dict[tuple[int, int], float] = {}
    while ranges:
        ranges = _narrowed(pieces, ranges, ordered)
    result = np.full(places.shape, np.nan)
    for share, column in np.ndindex(*result.shape):
        if sizes[column]:
            low_end, high_end = (ordered[column, int(k[share, column])] for k in (before, after))
            part = float(places[share, column] - before[share, column])
            result[share, column] = _between_neighbours(low_end, high_end, part)
    return result


class _SoughtRange(NamedTuple):
    """The values of a column from `low` to `high`, of which there are so many; `before` others are less.

    `wanted` are places in the order of the whole column that lie in it.
    """

    column: int
    low: float
    high: float
    size: int
    before: int
    wanted: Number

    def of(self, values: Number) -> Number:
        """Return those of some values (columns, n) that are in it."""
        own = values[self.column]
        return own[(own >= self.low) & (own <= self.high)]

    @property
    def ends(self) -> tuple[int, int]:
        """The places of its ends in the order of all numbers."""
        return int(_places_of_floats(self.low)), int(_places_of_floats(self.high))

    def shift(self, count: int) -> int:
        """Return how many of the last bits of places numbers of a class share, of which there are so many at most."""
        first, last = self.ends
        return max(0, (last - first).bit_length() - (count.bit_length() - 1))

    def classes(self, values: Number, count: int) -> Number:
        """Return the classes of some of its values: none is in a higher one than a greater one."""
        first, _ = self.ends
        # differences of places may take all bits: they are counted without a sign
        beyond = _places_of_floats(values).view(np.uint64) - np.int64(first).view(np.uint64)
        return (beyond >> np.uint64(self.shift(count))).view(np.int64)

    def parts(self, sizes: Number) -> Iterator[_SoughtRange]:
        """Yield the classes of it in which wanted places lie, by the sizes of all."""
        before = self.before + np.concatenate([[0], np.cumsum(sizes)])
        owners = np.searchsorted(before, self.wanted, side="right") - 1
        (first, last), shift = self.ends, self.shift(len(sizes))
        for k in np.unique(owners).tolist():
            low, high = first + (k << shift), min(first + ((k + 1) << shift) - 1, last)
            wanted = self.wanted[owners == k]
            yield _SoughtRange(self.column, _float_at(low), _float_at(high), int(sizes[k]), int(before[k]), wanted)


def _narrowed(
    pieces: Callable[[], Iterable[Number]], ranges: Sequence[_SoughtRange], ordered: dict[tuple[int, int], float]
) -> list[_SoughtRange]:
    """Read all pieces once: note the values at places of small ranges, return narrower ones in place of the others."""
    for one in ranges:
        if one.low == one.high:
            ordered.update(((one.column, k), one.low) for k in one.wanted.tolist())
    going = [one for one in ranges if one.low < one.high]
    if not going:
        return []
    few = max(1, MOST_SORTED // len(going))
    small, large = [one for one in going if one.size <= few], [one for one in going if one.size > few]
    classes = max(2, min(CLASSES, MOST_CLASSES // max(1, len(large))))
    kept, filled, sizes = [np.empty(one.size) for one in small], [0] * len(small), np.zeros((len(large), classes), int)
    for values in _by_columns(pieces):
        for k, one in enumerate(small):
            own = one.of(values)
            kept[k][filled[k] : filled[k] + len(own)] = own
            filled[k] += len(own)
        for k, one in enumerate(large):
            sizes[k] += np.bincount(one.classes(one.of(values), classes), minlength=classes)
    for one, own in zip(small, kept, strict=True):
        own.sort()
        ordered.update(((one.column, k), float(own[k - one.before])) for k in one.wanted.tolist())
    return [part for one, own in zip(large, sizes, strict=True) for part in one.parts(own)]


def _by_columns(pieces: Callable[[], Iterable[Number]]) -> Iterator[Number]:
    """Yield the values of pieces by columns, (columns, n)."""
    for piece in pieces():
        step = max(1, MOST_LAID // max(1, piece.shape[1]))
        for first in range(0, len(piece), step):
            yield np.ascontiguousarray(piece[first : first + step].T)


def _places_of_floats(values: Number) -> Number:
    """Return the places of numbers in the order of all: zero, and those of the negative ones below it."""
    bits = np.asarray(values, dtype=np.float64).view(np.int64)
    return np.where(bits < 0, -(bits & ALL_BUT_SIGN), bits)


def _float_at(place: int) -> float:
    """Return the number at a place in the order of all.

    >>> [_float_at(int(_places_of_floats(one))) for one in (0.5, -2.0)]
    [0.5, -2.0]
    """
    bits = place if place >= 0 else -place | int(~ALL_BUT_SIGN)
    return float(np.int64(bits).view(np.float64))


# The bits of a number in memory without that of its sign.
ALL_BUT_SIGN = np.int64(2**63 - 1)


def _between_neighbours(one: float, other: float, share: float) -> float:
    """Return the value at a share of the way from one to the other, rounded as `numpy.percentile` does."""
    step = other - one
    return one + step * share if share < 0.5 else other - step * (1.0 - share)


def pareto_rows(first: Number, second: Number) -> Number:
    """Return the Pareto-optimal rows of two minimised objectives.

    A row is dominated by one that is less in one objective and not greater in the other; equal rows stay together. The
    indices are in the order of the first objective. Rows with NaN are left out. Source: H. T. Kung,
    F. Luccio, F. P. Preparata, On finding the maxima of a set of vectors (1975).

    >>> pareto_rows(np.array([1.0, 2.0, 2.0, 3.0, np.nan]), np.array([5.0, 3.0, 4.0, 3.0, 0.0])).tolist()
    [0, 1]
    """
    known = np.flatnonzero(np.isfinite(first) & np.isfinite(second))
    if not len(known):
        return known
    order = known[np.lexsort((second[known], first[known]))]
    a, b = first[order], second[order]
    # rows of equal first objectives, of which those with the least second one come first
    begins = np.flatnonzero(np.concatenate([[True], a[1:] != a[:-1]]))
    least = b[begins]
    before = np.concatenate([[np.inf], np.minimum.accumulate(least)[:-1]])
    best = np.repeat(np.where(least < before, least, np.nan), np.diff([*begins, len(a)]))
    return order[b == best]
