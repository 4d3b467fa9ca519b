"""The motions of one plot: each with what it runs along, its panels, its course and its events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.view.plot import canvas
from compoundkin.view.plot.marked_places import Events, events
from compoundkin.view.plot.plotted_rows import Plotted, all_of, along
from compoundkin.view.plot.solved_courses import PlottedCourse, PlottedExtreme, plotted_extremes


@dataclass(frozen=True, eq=False)
class Panel:
    """One axes: its curves, and what its vertical axis is called."""

    title: Plotted
    curves: tuple[Plotted, ...]


@dataclass(frozen=True, eq=False)
class PlottedMotion:
    """A motion as a plot has it. Its designs come behind `before` others."""

    motion: Motion
    panels: tuple[Panel, ...]
    is_input: bool
    happened: Events
    course: PlottedCourse
    before: int

    @property
    def x(self) -> Plotted:
        """What it runs along."""
        return self.course.x

    @cached_property
    def extremes(self) -> Mapping[str, Mapping[int, tuple[PlottedExtreme, ...]]]:
        """The highest and lowest values of all curves, by name and design."""
        found = plotted_extremes(self.motion, self.x, [curve for panel in self.panels for curve in panel.curves])
        return {name: dict(enumerate(rows)) for name, rows in found.items()}

    @property
    def designs(self) -> int:
        """How many designs it has."""
        return len(self.x.values)


def plotted(
    motions: Sequence[Motion], names: Sequence[str], against: str | None, stacked: bool
) -> tuple[PlottedMotion, ...]:
    """Return the motions of a plot.

    Raises UnknownName for names that one of them does not have, InvalidInput where their units differ.
    """
    if not motions:
        raise InvalidInput(Problem("motion", "there is none", "give one or several, as solve() returns them"))
    found: list[PlottedMotion] = []
    designs = sum(motion.inputs.designs for motion in motions)
    chosen = names or [one.name for one in all_of(motions[0], ())]
    for motion in motions:
        x, is_input = along(motion, against)
        panels = arranged(all_of(motion, chosen), designs, stacked)
        before = sum(one.designs for one in found)
        course = PlottedCourse.of(motion, x, [curve.name for panel in panels for curve in panel.curves])
        found.append(PlottedMotion(motion, panels, is_input, events(motion), course, before))
        _hold_units(found[0], found[-1])
    return tuple(found)


def arranged(shown: Sequence[Plotted], designs: int, stacked: bool) -> tuple[Panel, ...]:
    """Return the panels of quantities. One each, one for each unit, or with several designs one for each part."""
    if designs > 1:
        return tuple(Panel(part, (part,)) for one in shown for part in one.parts)
    if stacked:
        return tuple(Panel(one, one.parts) for one in shown)
    units = dict.fromkeys(one.unit for one in shown)
    found = []
    for unit in units:
        same = [one for one in shown if one.unit == unit]
        names = same[0].name if len(same) == 1 else ""
        parts = tuple(part for one in same for part in one.parts)
        found.append(Panel(Plotted(names, unit, same[0].values, scale=max(one.scale for one in same)), parts))
    return tuple(found)


def called(motions: Sequence[Motion], given: Sequence[str]) -> tuple[str, ...]:
    """Return what the curves are called: as given, else by mechanism and design. Raises InvalidInput."""
    designs = sum(motion.inputs.designs for motion in motions)
    if given and len(given) != designs:
        told = f"there are {designs} designs and {len(given)} names"
        raise InvalidInput(Problem("designs", told, "give one for each, or leave them out"))
    if given or len(motions) == 1:
        return canvas.design_names(motions[0].shape, given)
    titles = [motion.mechanism.title for motion in motions]
    if len(set(titles)) < len(titles):
        titles = [f"{title} ({k})" for k, title in enumerate(titles, start=1)]
    pairs = zip(motions, titles, strict=True)
    return tuple(
        title if motion.inputs.designs == 1 else f"{title}, {name}"
        for motion, title in pairs
        for name in canvas.design_names(motion.shape, ())
    )


def _hold_units(first: PlottedMotion, other: PlottedMotion) -> None:
    """Raise InvalidInput where another motion cannot be drawn in the panels of the first."""
    rows = [(first.x, other.x), *((a.title, b.title) for a, b in zip(first.panels, other.panels, strict=False))]
    for one, another in rows:
        if one.unit != another.unit:
            units = f"{one.unit or 'a number'} of one mechanism and {another.unit or 'a number'} of another"
            remedy = "give the mechanisms one unit of length, and draw quantities of one kind"
            raise InvalidInput(Problem(another.name, f"it would be in {units} on one axis", remedy))
    if len(first.panels) != len(other.panels):
        names = ", ".join(panel.title.name for panel in first.panels)
        raise InvalidInput(
            Problem(names, "they are vectors in one mechanism and numbers in another", "draw other ones")
        )
