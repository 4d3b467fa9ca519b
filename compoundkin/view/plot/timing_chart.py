"""`timing_chart`: when each driver or cam follower of a machine rises, falls and dwells, one row each over one axis."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.base.series import Series
from compoundkin.files.document import is_angle
from compoundkin.model.attributes import DEGREES, TIME
from compoundkin.model.laws import Law, as_law
from compoundkin.model.laws.law_numbers import derivative_jumps
from compoundkin.model.laws.motion_programs import Program, turn_problems
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.model.profiles.synthesised import Synthesised
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import value_text
from compoundkin.view.plot.plot_style import GREY, INK, SHADE, SMALL_PRINT, Plot
from compoundkin.view.plot.plotted_rows import CONSTANT, Plotted

# Heights in inches.
FIRST, EACH = 1.1, 1.35
# Parts of the height of a row: the strip that names phases, and the room above and below the curve.
STRIP, BELOW, ABOVE = 0.17, 0.10, 0.12
# A character of small print takes this part of an inch, and this much of the width is not axes.
CHARACTER, MARGINS = 0.075, 1.1
# Times of events nearer to each other than this part of the width would be written over each other.
NEAR = 0.055
# More levels than these would crowd the vertical axis.
MOST_LEVELS = 5
# Levels nearer than this part of the range are one.
SAME_LEVEL = 0.12
SHADES: Mapping[int, str] = MappingProxyType({1: "#9ecae8", -1: "#f3c19b", 0: SHADE})
CURVE, TINT, DWELL = "#0072B2", "#eaf3f9", "#f4f4f4"


@checked
def timing_chart(
    what: Mechanism | Mapping[str, Any],
    *,
    over: Literal["time", "rotation"] | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw when each driver, or cam's follower, rises, falls and dwells.

    One row for each driver with a law, over the time; or, of a mechanism whose drivers have none, and with
    ``over="rotation"``, one for each cam made for a motion program, over a turn of the cam. Laws and programs may also
    be given by name, without a mechanism: their values are then as they are. Where something begins or ends, a line
    goes through all rows. The range is that of the mechanism's times, else of all laws. `size` is in inches.

    Raises InvalidInput where there is nothing to draw or nothing tells for how long, over the rotation for a program
    that does not take a turn, or without Matplotlib.

    >>> from compoundkin.model.laws import dwell, fall, program, rise
    >>> clamp, feed = program(rise(2, over=1), dwell(2), fall(2, over=1)), program(dwell(1), rise(30, over=2), dwell(1))
    >>> picture = timing_chart({"clamp": clamp, "feed": feed})
    >>> [axes.get_ylabel() for axes in picture.figure.axes]
    ['clamp', 'feed']
    """
    plot_style.require_matplotlib()
    along, shown = timing_rows(what, over)
    low, high = min(row.between[0] for row in shown), max(row.between[1] for row in shown)
    text = what.title if isinstance(what, Mechanism) and title is None else title or ""
    wide = size or (canvas.WIDTH, FIRST + EACH * len(shown))
    with plot_style.styled():
        figure, axes = canvas.panels(len(shown), text, wide, sharex=True)
        axes[0].set_xlim(low, high)
        for one, row in zip(axes, shown, strict=True):
            _draw(one, row, (wide[0] - MARGINS) / (high - low), "°" if along != TIME else " s")
        _events(axes, shown)
        across = Plotted(*(("time", "s") if along == TIME else ("rotation of the cam", DEGREES)), np.array([low, high]))
        axes[-1].set_xlabel(across.label)
        canvas.set_round_ticks(axes[-1].xaxis, across.is_angle, canvas.ACROSS)
        figure.align_ylabels(axes)
        return canvas.finished(figure, [])


def _draw(axes: Any, row: TimingRow, inches: float, unit: str) -> None:
    """A row: its dwells shaded, its curve, its levels, and the strip with its phases."""
    x, values = row.curve
    low, high = float(values.min()), float(values.max())
    span = high - low or abs(high) or 1.0
    height = span / (1.0 - STRIP - BELOW - ABOVE)
    bottom = low - (STRIP + BELOW) * height
    axes.set_ylim(bottom, bottom + height)
    axes.grid(visible=False)
    axes.fill_between(x, low, values, color=TINT, linewidth=0, zorder=1)
    axes.plot(x, values, color=CURVE, zorder=3)
    for phase in row.phases:
        if not phase.sense:
            axes.axvspan(phase.begin, phase.end, STRIP, 1.0, color=DWELL, linewidth=0, zorder=0.5)
        _name(axes, phase, bottom + STRIP * height / 2.0, inches, unit)
    levels = _levels(row, values)
    axes.hlines(levels, x[0], x[-1], color=SHADE, linewidth=0.6, zorder=1.5)
    axes.set_yticks(levels, [value_text(level, span) for level in levels])
    label = Plotted(row.name, row.unit, values).label
    axes.set_ylabel("\n[".join(label.rsplit(" [", 1)), fontsize=None if len(label) <= canvas.PANEL else SMALL_PRINT)


def _name(axes: Any, phase: Phase, y: float, inches: float, unit: str) -> None:
    """A part of the strip, with as much of "rise 0.75 s" as it has room for."""
    axes.axvspan(phase.begin, phase.end, 0.0, STRIP, facecolor=SHADES[phase.sense], edgecolor="white",
                 linewidth=0.8, zorder=2)  # fmt: skip
    span = value_text(phase.end - phase.begin)
    room = (phase.end - phase.begin) * inches / CHARACTER
    text = next((text for text in (f"{phase.word} {span}{unit}", f"{span}{unit}", span) if len(text) <= room), "")
    axes.text((phase.begin + phase.end) / 2.0, y, text, ha="center", va="center", fontsize=SMALL_PRINT, color=INK,
              zorder=4, clip_on=True)  # fmt: skip


def _levels(row: TimingRow, values: Any) -> list[float]:
    """The values between phases, the highest and the lowest first; those too near to another one are left out."""
    low, high = row.between
    inside = np.array([x for x in row.breaks if low < x < high])
    # between the pieces of a law it need not pause
    pauses = inside[np.abs(row.moved(inside)[1]) <= row.still] if inside.size else inside
    places = np.array([low, high, *(phase.begin for phase in row.phases), *pauses])
    ends = row.moved(places)[0] * row.scale
    least = SAME_LEVEL * float(np.ptp(values))
    found: list[float] = []
    for value in [float(values.min()), float(values.max()), *(float(end) for end in ends)]:
        if len(found) < MOST_LEVELS and all(abs(value - other) > least for other in found):
            found.append(value)
    return sorted(found)


def _events(axes: Sequence[Any], shown: Iterable[TimingRow]) -> None:
    """Lines through all rows where something begins or ends, with their places on top."""
    low, high = axes[0].get_xlim()
    ends = [phase.end for row in shown for phase in row.phases[:-1]]
    places = sorted({float(np.round(x, 12)) for x in ends})
    for one in axes:
        for x in places:
            one.axvline(x, STRIP, color=GREY, linewidth=0.6, linestyle=(0, (1.5, 2.5)), zorder=2.5)
    last = low
    for x in places:
        if x - last > NEAR * (high - low):
            axes[0].annotate(value_text(x), (x, 1.0), (0, 3), xycoords=("data", "axes fraction"),
                             textcoords="offset points", ha="center", fontsize=SMALL_PRINT, color=GREY)  # fmt: skip
            last = x


# Places examined in every phase of a program, and all along any other law.
IN_PHASE, IN_LAW = 60, 1500
# Halvings that find where a law begins to dwell, to the last digit that is shown.
HALVINGS = 40
ROTATION = "rotation"


@dataclass(frozen=True)
class Phase:
    """A part of a row. In it the value rises (`sense` 1), falls (-1) or dwells (0)."""

    begin: float
    end: float
    sense: int

    @property
    def word(self) -> str:
        """Its name."""
        return ("dwell", "rise", "fall")[self.sense]


@dataclass(frozen=True, eq=False)
class TimingRow:
    """One row: its name, unit, range, and motion.

    `moved` returns the value and its rate at places; `breaks` are where phases may begin, empty if unknown.
    """

    name: str
    unit: str
    between: tuple[float, float]
    moved: Callable[[Number], tuple[Number, Number]]
    breaks: tuple[float, ...] = ()

    @property
    def scale(self) -> float:
        """The factor to display units: angles are in degrees."""
        return float(np.rad2deg(1.0)) if self.unit == DEGREES else 1.0

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """Its phases, one after another. Neighbours of one sense are one."""
        joints = self._joints
        senses = self._senses(0.5 * (joints[:-1] + joints[1:]))
        first = [0, *(np.flatnonzero(np.diff(senses)) + 1)]
        ends = [self._refined(k, senses, joints) for k in first[1:]]
        bounds = zip([joints[0], *ends], [*ends, joints[-1]], senses[first], strict=True)
        return tuple(Phase(float(a), float(b), int(sense)) for a, b, sense in bounds)

    @cached_property
    def curve(self) -> tuple[Number, Number]:
        """Places and values, close enough to be drawn."""
        each = [
            np.linspace(a, b, IN_PHASE, endpoint=False) for a, b in zip(self._joints, self._joints[1:], strict=False)
        ]
        x = np.append(np.concatenate(each), self._joints[-1]) if self.breaks else self._joints
        return x, self.moved(x)[0] * self.scale

    @cached_property
    def _joints(self) -> Number:
        low, high = self.between
        if not self.breaks:
            return np.linspace(low, high, IN_LAW + 1)
        return np.array([low, *(x for x in sorted(set(self.breaks)) if low < x < high), high])

    @cached_property
    def still(self) -> float:
        """The rate that counts as zero: rounding of the greatest, or of the values."""
        values, rates = self.moved(self._joints)
        return CONSTANT * max(float(np.max(np.abs(rates))), float(np.ptp(values)) / (self.between[1] - self.between[0]))

    def _senses(self, x: Number) -> Number:
        rates = self.moved(x)[1]
        return np.where(np.abs(rates) <= self.still, 0, np.sign(rates)).astype(int)

    def _refined(self, k: int, senses: Number, joints: Number) -> float:
        """Where the sense changes: at a break, else between two places examined."""
        if self.breaks:
            return float(joints[k])
        before = senses[k - 1]
        low, high = 0.5 * (joints[k - 1] + joints[k]), 0.5 * (joints[k] + joints[k + 1])
        return float(bisect_brackets(lambda x: self._senses(x) == before, low, high, HALVINGS)[0])


def timing_rows(what: Mechanism | Mapping[str, Any], over: str | None) -> tuple[str, tuple[TimingRow, ...]]:
    """Return the horizontal axis, "time" or "rotation", and the rows.

    Raises InvalidInput where there is nothing to draw.
    """
    if over not in (None, TIME, ROTATION):
        raise InvalidInput(
            Problem("over", f"{over!r} is nothing to draw over", suggestion(str(over), [TIME, ROTATION]))
        )
    if not isinstance(what, Mechanism):
        laws = {str(name): law for name, law in what.items()}
        return (ROTATION, tuple(_of_programs(laws))) if over == ROTATION else (TIME, tuple(_of_laws(laws)))
    if over in (None, TIME):
        laws = {drive.name: drive.law for drive in what.drives if drive.law is not None}
        if laws:
            units = {d.name: DEGREES if is_angle(what, d) else what.unit for d in what.drives}
            return TIME, tuple(_of_laws(laws, units, what.time))
    if over in (None, ROTATION):
        found = tuple(_of_cams(what))
        if found:
            return ROTATION, found
    missing = {TIME: "no driver has a law", ROTATION: "no cam is made for a motion program"}
    problem = missing[over] if over else " and ".join(missing.values())
    raise InvalidInput(
        Problem("timing chart", problem, "write drive(..., law=laws.program(...)), or give the laws by name")
    )


def _of_laws(
    laws: Mapping[str, Any], units: Mapping[str, str] | None = None, times: Number | None = None
) -> Iterator[TimingRow]:
    known = {name: _law(name, law) for name, law in laws.items()}
    first, last = _range(known, times)
    for name, law in known.items():
        # a table tells nothing outside of its range
        ends = law.span if law.span and not isinstance(law, Program) and not getattr(law, "repeat", False) else None
        low, high = (max(first, ends[0]), min(last, ends[1])) if ends else (first, last)
        breaks = tuple(map(float, derivative_jumps(law, low, high))) if isinstance(law, Program) else ()
        yield TimingRow(name, (units or {}).get(name, ""), (low, high), _moved(law), breaks)


def _law(name: str, given: Any) -> Law:
    law = as_law(f"laws.{name}", given)
    if law is None:
        raise InvalidInput(Problem(f"laws.{name}", "None is not a law", "write laws.program(...), or leave it out"))
    return law


def _range(laws: Mapping[str, Law], times: Number | None) -> tuple[float, float]:
    """From the first to the last time of a mechanism, else of all laws."""
    spans = [law.span for law in laws.values() if law.span] if times is None else [(np.min(times), np.max(times))]
    low, high = min((a for a, _ in spans), default=0.0), max((b for _, b in spans), default=0.0)
    if not high > low:
        what = "the time over which the drivers move is not given" if laws else "there is no law"
        raise InvalidInput(Problem("timing chart", what, "give Mechanism(..., time=...), or a law with a span"))
    return float(low), float(high)


def _moved(law: Law) -> Callable[[Number], tuple[Number, Number]]:
    def moved(x: Number) -> tuple[Number, Number]:
        value, rate = (np.broadcast_arrays(part, np.atleast_1d(x))[0] for part in law.coordinate(x, 1).c)
        if value.size != np.size(x) or rate.size != np.size(x):
            raise InvalidInput(Problem("timing chart", "a law has several designs", "give one for a single design"))
        return value.reshape(np.shape(x)), rate.reshape(np.shape(x))

    return moved


def _of_programs(programs: Mapping[str, Any]) -> Iterator[TimingRow]:
    for name, program in programs.items():
        if not isinstance(program, Program):
            what = f"{program!r} is not a motion program"
            raise InvalidInput(Problem(f"laws.{name}", what, "write laws.program(...), or draw laws over time"))
        wrong = list(turn_problems(program.period, f"laws.{name}"))
        if wrong:
            raise InvalidInput(wrong)
        yield _laid_round(name, "", program, 0.0)


def _of_cams(mechanism: Mechanism) -> Iterator[TimingRow]:
    for pair in filter(None, map(as_profile_contact, mechanism.written_pairs)):
        made = pair.profile
        if isinstance(made, Synthesised):
            unit = DEGREES if made.oscillates else mechanism.unit
            start = -made.start if made.clockwise else made.start
            yield _laid_round(pair.name, unit, made.program, start)


def _laid_round(name: str, unit: str, program: Program, start: float) -> TimingRow:
    """Return the row of a program that begins at an angle of the cam, over a turn in degrees."""
    degree = TURN / 360.0

    def moved(x: Number) -> tuple[Number, Number]:
        q = np.asarray(x, dtype=float) * degree - start
        value, rate = program.at(Series((q, degree)), repeat=True).c
        return value, np.broadcast_to(rate, np.shape(x))

    begins = np.mod(np.rad2deg(program.breaks + start), 360.0)
    return TimingRow(name, unit, (0.0, 360.0), moved, tuple(float(x) for x in begins.round(9)))
