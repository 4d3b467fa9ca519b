"""Data of studies and tolerance analyses for plots: columns in display units, toleranced outputs by name, bins."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.percentiles import percentiles_of
from compoundkin.kinematics.quantities import ASSEMBLED
from compoundkin.model.attributes import GREATEST, component_names, typeset_unit, with_unit
from compoundkin.studies.study_program import StudyColumn
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.plot import canvas
from compoundkin.view.plot.canvas import value_text
from compoundkin.view.plot.plotted_rows import Plotted, horizontal_axis
from compoundkin.view.report.wording import counted

# More points than these are a blot, and their drawing takes long.
MOST_POINTS = 3000


@dataclass(frozen=True, eq=False, repr=False)
class StudyColumns(ShortRepr):
    """The data of a study for plots: columns by name, and which designs are assembled."""

    result: StudyResult

    @property
    def title(self) -> str:
        """The title of its mechanism."""
        return self.result.study.mechanism.title

    @cached_property
    def columns(self) -> Mapping[str, StudyColumn]:
        """The columns of numbers by name: dimensions and outputs."""
        return {one.name: one for one in self.result.columns if one.kind != "state"}

    @cached_property
    def count(self) -> int:
        """How many designs are assembled over the whole motion."""
        return self.result.counts(ASSEMBLED)[True]

    def summary(self, drawn: int = 0, among: int = 0) -> str:
        """Return how many designs there are, and how many cannot be assembled.

        It says how many are drawn where those are fewer than those `among` which they were picked.
        """
        whole = len(self.result)
        missing = whole - self.count
        said = [counted(whole, "design"), f"{missing:,} cannot be assembled" if missing else ""]
        return ", ".join(filter(None, [*said, f"{drawn:,} are drawn" if drawn < among else ""]))

    def named(self, name: str) -> tuple[StudyColumn, ...]:
        """Return the columns of a name: two of a point or vector. Raises UnknownName with the nearest."""
        names = (name,) if name in self.columns else component_names(name)
        if names[0] not in self.columns:
            remedy = suggestion(name, list(self.columns))
            raise UnknownName(Problem(name, "the study has no such column of numbers", remedy))
        return tuple(self.columns[one] for one in names)

    def figures(self, names: Sequence[str]) -> tuple[StudyColumn, ...]:
        """Return the columns of names with one number for each design.

        Without names they are all of these. Raises UnknownName, InvalidInput for courses.
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

        Without names they are all of these. Raises UnknownName, InvalidInput without any.
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

    def values(self, column: StudyColumn, rows: Number) -> Plotted:
        """Return some rows of a column in display units."""
        return displayed_values(column.name, column.unit, self.result.rows.picked(rows, column.name)[column.name])

    def assembled(self, rows: Number) -> Number:
        """Return which of some designs are assembled over the whole motion."""
        return np.asarray(self.result.rows.picked(rows, ASSEMBLED)[ASSEMBLED], dtype=bool)

    def pieces(self, *columns: StudyColumn) -> Iterator[tuple[Number, tuple[Number, ...]]]:
        """Yield the places of the assembled designs in which figures are known, and these in display units."""
        start = 0
        for piece in self.result.rows.pieces(*(one.name for one in columns), ASSEMBLED):
            known = np.logical_and.reduce([piece[ASSEMBLED], *(np.isfinite(piece[one.name]) for one in columns)])
            own = (Plotted(one.name, one.unit, piece[one.name][known]).shown.values for one in columns)
            yield start + np.flatnonzero(known), tuple(own)
            start += len(known)

    def distribution(self, column: StudyColumn) -> FigureValues:
        """Return the values of a figure, of the designs that are assembled."""
        return FigureValues.of(column.name, column.unit, lambda: (own for _, (own,) in self.pieces(column)))


@dataclass(frozen=True, eq=False, repr=False)
class FigureValues(ShortRepr):
    """Finite values of a figure in display units, which come in `pieces`, each time they are asked for.

    `quantity` has their name, unit and scale; `ends` are the least and the greatest, of none there are none.
    """

    quantity: Plotted
    pieces: Callable[[], Iterable[Number]]
    ends: Number
    count: int

    @classmethod
    def of(cls, name: str, unit: str, pieces: Callable[[], Iterable[Number]]) -> FigureValues:
        """Return values with what is read of all of them."""
        sizes = [(len(piece), piece.min(), piece.max()) for piece in pieces() if len(piece)]
        ends = np.array([min(low for _, low, _ in sizes), max(high for *_, high in sizes)] if sizes else [])
        shown = Plotted(name, unit, np.empty(0)).shown
        scale = float(np.max(np.abs(ends), initial=0.0))
        return cls(replace(shown, scale=scale), pieces, ends, sum(size for size, *_ in sizes))

    def percentiles(self, shares: Sequence[float]) -> list[float]:
        """Return percentiles; nothing without values."""
        return percentiles_of(self.pieces, shares)

    @cached_property
    def bins(self) -> Number:
        """The edges of the bins of a histogram."""
        if not self.count:
            return np.array([0.0, 1.0])
        return bin_edges(self.ends, self.percentiles([25.0, 75.0]), self.count, self.quantity.scale)

    def counts(self) -> Number:
        """Return how many values are in each bin."""
        return np.sum([np.histogram(piece, self.bins)[0] for piece in self.pieces()], axis=0)


def displayed_values(name: str, unit: str, values: Number) -> Plotted:
    """Return values in display units, angles in degrees."""
    found = Plotted(name, unit, np.asarray(values, dtype=float)).shown
    known = np.abs(found.values[np.isfinite(found.values)])
    return Plotted(found.name, found.unit, found.values, scale=float(np.max(known, initial=0.0)))


def drawn_rows(count: int, most: int = MOST_POINTS) -> Number:
    """Return as many of so many rows as can be drawn, the same every time.

    They are picked by chance: every n-th would show nothing but some levels of a grid.

    >>> len(drawn_rows(10**9)), drawn_rows(2).tolist()
    (3000, [0, 1])
    """
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def title_with_summary(title: str, *said: str) -> str:
    """Return the title of a plot with what is said of its designs.

    >>> title_with_summary("Press", "", "9 designs")
    'Press: 9 designs'
    """
    return ": ".join(filter(None, (title, "; ".join(filter(None, said)))))


def toleranced_outputs(analysis: ToleranceAnalysis, name: str) -> list[OutputTolerance]:
    """Return the outputs of a name: both components of a vector. Raises UnknownName."""
    both = component_names(name)
    return [analysis[one] for one in (both if name not in analysis.outputs and both[0] in analysis.outputs else [name])]


def toleranced_output(analysis: ToleranceAnalysis, name: str) -> OutputTolerance:
    """Return the output of a name. Raises InvalidInput for a vector."""
    one, *others = toleranced_outputs(analysis, name)
    if others:
        raise InvalidInput(Problem(name, "it is a vector", f"take {one.name} or {others[0].name}"))
    return one


def toleranced_curves(analysis: ToleranceAnalysis, names: Sequence[str]) -> list[OutputTolerance]:
    """Return the outputs of names with values at every pose.

    Without names they are all of these. Raises UnknownName, InvalidInput without any.
    """
    among = [one for name in names for one in toleranced_outputs(analysis, name)] if names else list(analysis.values())
    wrong = next((one for one in among if names and not one.is_course), None)
    if wrong is not None:
        what, remedy = "it is one number of the whole motion", "contributions() and histogram() draw it"
        raise InvalidInput(Problem(wrong.name, what, remedy))
    courses = [one for one in among if one.is_course]
    if not courses:
        what = "no output of the analysis has values at every pose"
        raise InvalidInput(Problem("quantities", what, "contributions() and histogram() draw figures"))
    return courses


def checked_pose(one: OutputTolerance, pose: int | None) -> int | None:
    """Return the index of a pose.

    Without one it is that of the greatest deviation; of a figure it is None. Raises InvalidInput for an unknown pose.
    """
    if not one.is_course:
        if pose is not None:
            raise InvalidInput(Problem("pose", f"{one.name} is one number of the whole motion", "leave it out"))
        return None
    poses = len(one.nominal)
    if pose is None:
        known = np.isfinite(one.deviation)
        return int(np.argmax(np.where(known, one.deviation, -1.0)))
    if not 0 <= pose < poses:
        raise InvalidInput(Problem("pose", f"there is no pose {pose}", f"0 to {poses - 1}"))
    return pose


def value_at(values: Number, pose: int | None) -> float:
    """Return the value of a figure, or of a course at a pose."""
    return float(values if pose is None else np.asarray(values)[pose])


def place_words(analysis: ToleranceAnalysis, one: OutputTolerance, pose: int | None) -> str:
    """Return which output it is, and at which pose: "rocker.angle at crank 20°"."""
    if pose is None:
        return one.name
    x, _ = horizontal_axis(analysis.motion, None)
    return f"{one.name} at {x.name} {with_unit(value_text(float(x.values[0, pose]), x.scale), typeset_unit(x.unit))}"


def value_words(one: OutputTolerance, value: float) -> str:
    """Write a value of an output with its unit, angles in degrees."""
    shown = displayed_values(one.name, one.unit, np.array([value]))
    return with_unit(value_text(float(shown.values[0])), typeset_unit(shown.unit))


# Bins in a histogram of very many values, and of those with far outliers.
MOST_BINS = 60


def histogram_bins(values: Number, scale: float, most: int = MOST_BINS) -> Number:
    """Return the edges of bins by the rule of Freedman and Diaconis.

    Around constants there are three, of which the middle one holds all.

    Source: D. Freedman, P. Diaconis, On the histogram as a density estimator (1981).

    >>> histogram_bins(np.array([2.0, 2.0]), 2.0).tolist()
    [1.0, 1.6666666666666665, 2.333333333333333, 3.0]
    >>> len(histogram_bins(np.arange(10**6.0), 1e6)), len(histogram_bins(np.array([np.nan]), 0.0))
    (61, 2)
    """
    known = values[np.isfinite(values)]
    if not len(known):
        return np.array([0.0, 1.0])
    ends = np.array([known.min(), known.max()])
    return bin_edges(ends, np.percentile(known, [25.0, 75.0]), len(known), scale, most)


def bin_edges(ends: Number, quarters: Sequence[float], count: int, scale: float, most: int = MOST_BINS) -> Number:
    """Return the edges of bins of so many values, by their ends and the percentiles 25 and 75."""
    still = canvas.constant_limits(ends, scale)
    if still is not None:
        return np.linspace(*still, 4)
    width = 2.0 * (quarters[1] - quarters[0]) / count ** (1.0 / 3.0)
    wished = np.ptp(ends) / width if width > 0.0 else most
    return np.linspace(ends[0], ends[1], int(np.clip(np.ceil(wished), 1, most)) + 1)
