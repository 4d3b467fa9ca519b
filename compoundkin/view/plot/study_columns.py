"""Columns of a study as plots show them: angles in degrees, and the designs that are drawn of very many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.base.series import Number
from compoundkin.model.attributes import GREATEST
from compoundkin.model.component_names import component_names
from compoundkin.studies.runs.study_program import StudyColumn
from compoundkin.studies.runs.study_result import StudyResult
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.report.wording import counted

# More points than these are a blot, and their drawing takes long.
MOST_POINTS = 3000


@dataclass(frozen=True, eq=False, repr=False)
class StudyColumns(PrintsShort):
    """What plots read of a study: columns by name, and which designs are assembled."""

    found: StudyResult

    @property
    def title(self) -> str:
        """The title of its mechanism."""
        return self.found.study.mechanism.title

    @cached_property
    def columns(self) -> Mapping[str, StudyColumn]:
        """The columns of numbers by name: dimensions and outputs."""
        return {one.name: one for one in self.found.columns if one.kind != "state"}

    @cached_property
    def assembled(self) -> Number:
        """Which designs are assembled over the whole motion."""
        return np.asarray(self.found.assembled, dtype=bool)

    def told(self, drawn: int = 0, among: int = 0) -> str:
        """Say how many designs there are, and how many cannot be assembled.

        It says how many are drawn where those are fewer than those `among` which they were picked.
        """
        whole = len(self.assembled)
        missing = whole - int(np.count_nonzero(self.assembled))
        said = [counted(whole, "design"), f"{missing:,} cannot be assembled" if missing else ""]
        return ", ".join(filter(None, [*said, f"{drawn:,} are drawn" if drawn < among else ""]))

    def named(self, name: str) -> tuple[StudyColumn, ...]:
        """Return the columns of a name: two of a point or vector. Raises UnknownName with the nearest."""
        names = (name,) if name in self.columns else component_names(name)
        if names[0] not in self.columns:
            remedy = nearest(name, list(self.columns))
            raise UnknownName(Problem(name, "the study has no such column of numbers", remedy))
        return tuple(self.columns[one] for one in names)

    def figures(self, names: Sequence[str]) -> tuple[StudyColumn, ...]:
        """Return the columns of names with one number for each design.

        Of no names they are all that there are. Raises UnknownName, InvalidInput for courses.
        """
        if not names:
            return tuple(one for one in self.columns.values() if one.is_figure)
        found = [one for name in dict.fromkeys(names) for one in self.named(name)]
        for one in found:
            if one.width:
                remedy = f"name a figure of it as an output of the study, such as {one.name}.{GREATEST}"
                raise InvalidInput(Problem(one.name, "it has a value at every pose", remedy))
        return tuple(found)

    def figure(self, name: str) -> StudyColumn:
        """Return the column of a name. Raises InvalidInput for points and courses."""
        first, *others = self.figures([name])
        if others:
            raise InvalidInput(Problem(name, "it is a point", f"take {first.name} or {others[0].name}"))
        return first

    def courses(self, names: Sequence[str]) -> tuple[StudyColumn, ...]:
        """Return the columns of names with values at every pose.

        Of no names they are all that there are. Raises UnknownName, InvalidInput where there is none.
        """
        among = [one for name in names for one in self.named(name)] if names else self.columns.values()
        wrong = next((one for one in among if names and not one.width), None)
        if wrong is not None:
            remedy = "histogram() and scatter_matrix() draw it"
            raise InvalidInput(Problem(wrong.name, "it has one number for each design, none at the poses", remedy))
        found = tuple(one for one in among if one.width)
        if not found:
            what, remedy = "no output of the study has values at every pose", 'an output such as "G.position"'
            raise InvalidInput(Problem("quantities", what, remedy))
        return found

    def values(self, column: StudyColumn, rows: Number | None = None) -> Plotted:
        """Return a column as it is shown, or some rows of it."""
        own = np.asarray(self.found[column.name])
        return shown_of(column.name, column.unit, own if rows is None else own[rows])


def shown_of(name: str, unit: str, values: Number) -> Plotted:
    """Return values as they are shown, angles in degrees."""
    found = Plotted(name, unit, np.asarray(values, dtype=float)).shown
    known = np.abs(found.values[np.isfinite(found.values)])
    return Plotted(found.name, found.unit, found.values, scale=float(np.max(known, initial=0.0)))


def drawn_rows(rows: Number, most: int = MOST_POINTS) -> Number:
    """Return as many of the rows as can be drawn, the same every time.

    They are picked by chance: every n-th would show nothing but some levels of a grid.

    >>> len(drawn_rows(np.arange(10**6))), drawn_rows(np.array([4, 7])).tolist()
    (3000, [4, 7])
    """
    if len(rows) <= most:
        return rows
    return np.sort(np.random.default_rng(0).choice(rows, most, replace=False))


def headed(title: str, *said: str) -> str:
    """Return the title of a plot with what is said of its designs.

    >>> headed("Press", "", "9 designs")
    'Press: 9 designs'
    """
    return ": ".join(filter(None, (title, "; ".join(filter(None, said)))))
