"""`StudyResult`: the rows of a study, one for each design, and the Pareto-optimal ones of two objectives."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase, display_function
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.percentiles import percentiles_of
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
