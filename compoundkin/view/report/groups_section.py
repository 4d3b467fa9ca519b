"""Drivers and Assur groups in solving order: what each group uses and yields, its assembly mode, the drivers' laws."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import singledispatchmethod
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.kinematics import Motion
from compoundkin.kinematics.curve.modes import CHOSEN_BY
from compoundkin.kinematics.driver_values import FULL_TURN
from compoundkin.kinematics.groups import DYADS
from compoundkin.model.attributes import (
    ACCELERATION,
    DEGREES,
    PER_SECOND,
    RATES,
    VELOCITY,
    coordinate_dimension,
    unit_of,
    with_unit,
)
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import ConstantAcceleration, ConstantSpeed, FunctionLaw, Law, MotionTable, PathCoordinate
from compoundkin.model.laws.motion_programs import LIMITS, Program, ProgramSegment
from compoundkin.model.laws.table_laws import TimeTable
from compoundkin.model.prescribed_paths import CurvePath, FunctionPath, LinePath, Path, TimedPlaces
from compoundkin.model.units import ANGULAR_VELOCITY, customary_unit, with_customary
from compoundkin.structure import Body, DrivenPair, Group, Structure, roman
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Block, Cell, Column, Paragraph, Section, StepBlock, TableBlock
from compoundkin.view.report.wording import counted, listed, number_text

DERIVATIVES = ("coordinate", VELOCITY, ACCELERATION)


def drivers_section(structure: Structure, sample: Sample | None) -> Section:
    """Report each driver with its range and rates, angles and lengths in separate tables."""
    steps = structure.driven
    kinds: dict[bool, list[tuple[Cell, ...]]] = {}
    led = _prescribed_coordinates(structure)
    for drive in structure.mechanism.drives:
        step = steps.get(drive.name)
        is_angle = step is None or step.pair.free_is_angle
        what = led.get(drive.name) or f"{drive.link} on {drive.on}" + (f", {step.pair.name}" if step else "")
        kinds.setdefault(is_angle, []).append((drive.name, what, *_driver_range(drive, sample, is_angle)))
    tables = tuple(_driver_table(structure, is_angle, rows) for is_angle, rows in kinds.items())
    return Section("drivers", "Drivers", (*tables, *_law_paragraphs(structure)) or (Paragraph("There is no driver."),))


def _prescribed_coordinates(structure: Structure) -> dict[str, str]:
    """Return what drivers prescribe of points and links, "x of G", by their names."""
    leads = structure.mechanism.prescribed_motions.values()
    return {
        name: f"{word} of {item.point or item.link}{f' on {item.on}' if item.on != FRAME else ''}"
        for item in leads
        for word, name in item.drivers.items()
    }


def _law_paragraphs(structure: Structure) -> Iterator[Paragraph]:
    """Yield how each driver with a law moves."""
    steps, unit = structure.driven, unit_of(structure.mechanism.unit, "length")
    for lead in structure.mechanism.prescribed_motions.values():
        if lead.along is not None:
            yield Paragraph(f"{lead.point} is led {PathText(unit).path(lead.along)}.")
    for drive in structure.mechanism.drives:
        if drive.law is not None and not isinstance(drive.law, PathCoordinate):
            is_angle = drive.name not in steps or steps[drive.name].pair.free_is_angle
            yield Paragraph(f"{drive.name} moves {LawText(is_angle, unit).law(drive.law)}.")


def _driver_table(structure: Structure, is_angle: bool, rows: list[tuple[Cell, ...]]) -> TableBlock:
    length, dimension = structure.mechanism.unit, coordinate_dimension(is_angle)
    unit = DEGREES if is_angle else unit_of(length, dimension)
    speed, second = (Column(RATES[k - 1], unit_of(length, dimension, k), "each") for k in (1, 2))
    span = Column("from", unit, "each"), Column("to", unit, "each"), Column("poses", style="each")
    rates, other = [speed, second], customary_unit(speed.unit)
    if other is not None:
        rates.insert(1, Column(speed.name, other[0], "each", follows=True))
        rows = [(*row[:6], row[5] * other[1] if isinstance(row[5], float) else None, *row[6:]) for row in rows]
    return TableBlock((Column("driver"), Column("drives"), *span, *rates), tuple(rows))


def _driver_range(drive: Drive, sample: Sample | None, is_angle: bool) -> tuple[Cell, ...]:
    """Return first and last value, number of poses, speed and acceleration."""
    values, speed, acceleration = _driver_values(drive, sample)
    if sample is None and drive.law is not None:
        return None, None, None, None, None
    if values is None and not is_angle:
        return None, None, None, speed, acceleration
    values = FULL_TURN if values is None else values
    ends = float(values[0]), float(values[-1])
    return (*(degrees(ends).tolist() if is_angle else ends), len(values), speed, acceleration)


def _driver_values(drive: Drive, sample: Sample | None) -> tuple[Any, Cell, Cell]:
    """Return a driver's values, speed and acceleration at the first pose; before solving those of the mechanism."""
    if sample is None:
        values = None if drive.values is None else np.atleast_1d(drive.values)
        return values, float(np.ravel(drive.speed)[0]), float(np.ravel(drive.acceleration)[0])
    motion = sample.motion
    rates = [np.reshape(sample.of(_in_motion_shape(sample, v)), -1)[0] for v in motion.inputs.drives[drive.name][1:3]]
    return np.reshape(sample.of(motion.drives[drive.name].value), -1), float(rates[0]), float(rates[1])


def _in_motion_shape(sample: Sample, value: Any) -> Any:
    inputs = sample.motion.inputs
    return np.broadcast_to(value, (inputs.designs, inputs.poses)).reshape(inputs.shape)


def solving_section(structure: Structure, motion: Motion | None, design: int = 0) -> Section:
    """Report the frame with its driven links, then every group."""
    known = _letters(structure, structure.ground.links)
    steps = [_ground_step(structure, structure.ground, known)]
    for k, group in enumerate(structure.groups):
        new = [letter for letter in _letters(structure, group.links) if letter not in known]
        known.update(dict.fromkeys(new))
        mode = _mode_facts(motion, k, design) if motion else ()
        steps.append(StepBlock(f"{k + 1}  {_title(group)}", (*_group_facts(structure, group, new), *mode)))
    blocks: tuple[Block, ...] = Paragraph(_summary(structure)), *_redundant_paragraphs(structure), *steps
    return Section("groups", "Groups in solving order", blocks)


def _redundant_paragraphs(structure: Structure) -> Iterator[Paragraph]:
    """Yield the redundant pairs, and the pairs that replace them."""
    for part in structure.relaxation.dropped if structure.relaxation else ():
        instead = f", with {part.kept.name} in its place" if part.kept else ""
        yield Paragraph(f"Left out is {part}{instead}: other pairs hold it, which is checked along the motion.")


def _summary(structure: Structure) -> str:
    if not structure.groups:
        return "No part of it can be solved." if structure.faults else "The driven links are all there is."
    highest = roman(max(group.class_ for group in structure.groups))
    if structure.faults:
        return f"{counted(len(structure.groups), 'group')} can be solved in what is determined."
    return f"{counted(len(structure.groups), 'group')} after the driven links; the mechanism is of class {highest}."


def _letters(structure: Structure, links: Iterable[str]) -> dict[str, None]:
    return {letter: None for link in links for letter in structure.mechanism.links[link].points}


def _title(group: Group) -> str:
    return f"{group.name} {'dyad' if group.name in DYADS else 'group'}: {listed(group.links)}"


def _ground_step(structure: Structure, ground: Body, letters: Iterable[str]) -> StepBlock:
    led = _prescribed_coordinates(structure)
    driven = tuple(("driver", _driven_text(step, led)) for step in ground.driven if not step.is_passive)
    title = "0  The frame and its driven links" if driven else "0  The frame"
    links = [name for name in ground.links if name not in structure.mechanism.auxiliary_links]
    return StepBlock(title, (*driven, ("yields", _yield_text(links, letters))))


def _driven_text(step: DrivenPair, led: Mapping[str, str]) -> str:
    drive, pair = step.drive, step.pair
    if drive.name in led:
        return led[drive.name]
    name = f"{drive.name}: " if drive.name != drive.link else ""
    return f"{name}{drive.link} on {drive.on}, the {' and '.join(pair.free)} of {pair.title} {pair.name}"


def _group_facts(structure: Structure, group: Group, new: list[str]) -> Iterator[tuple[str, str]]:
    yield "class", f"{roman(group.class_)}, order {group.order}"
    inner = f"; inner {', '.join(pair.name for pair in group.inner)}" if group.inner else ""
    yield "pairs", f"outer {', '.join(pair.name for pair in group.outer)}{inner}"
    for body in group.bodies:
        driven = [step for step in body.driven if not step.is_passive]
        passive = [step for step in body.driven if step.is_passive]
        if passive:
            yield "passive", "; ".join(f"{step.drive.link} may turn about {step.pair.letters[0]}" for step in passive)
        if driven:
            yield "driven", "; ".join(_driven_text(step, _prescribed_coordinates(structure)) for step in driven)
            yield "body", f"{listed(body.links)} are one link of changing shape"
    yield "uses", "; ".join(_attachment_points(structure, group))
    yield "yields", _yield_text(group.links, new)


def _attachment_points(structure: Structure, group: Group) -> Iterator[str]:
    """Yield the points of known links to which a group is attached."""
    own = set(group.links)
    for pair in group.outer:
        for link in pair.members:
            if link not in own:
                points = structure.mechanism.links[link].points
                letters = [letter for letter in pair.letters if letter in points]
                if link in structure.mechanism.auxiliary_links:
                    link = "what leads it"
                prefix = "" if pair.name.startswith(pair.letters[0]) else f"{pair.name}: "
                yield f"{prefix}{', '.join(letters)}{' on ' if letters else ''}{link}"


def _yield_text(links: Iterable[str], letters: Iterable[str]) -> str:
    letters = list(letters)
    points = f"; {'point' if len(letters) == 1 else 'points'} {', '.join(letters)}" if letters else ""
    return f"{', '.join(links)}{points}"


def _mode_facts(motion: Motion, k: int, design: int) -> Iterator[tuple[str, str]]:
    """Yield the assembly mode of a group, its meaning, and what chose it."""
    why = CHOSEN_BY.get(motion.chosen_by.get(k, ""), "")
    solver = motion.solving_order.solvers[k]
    if solver.is_numbered:
        yield "mode", f"{why or 'found'}, by iteration, and followed along the motion"
    elif solver.modes == 1:
        yield "mode", "the only one"
    else:
        sign = motion.sign(k, design)
        meaning = solver.sign_means if sign > 0 else f"the other one; in +1, {solver.sign_means}"
        yield "mode", f"{sign:+d}, {why} ({meaning}){_change_points_text(motion, k, design)}"


def _change_points_text(motion: Motion, k: int, design: int) -> str:
    places = motion.change_points.get(k)
    if places is None:
        return ""
    # a motion that returns from a change point as it came is there twice
    _, times = np.unique(places[design][np.isfinite(places[design])], return_counts=True)
    count = int(np.count_nonzero(times % 2))
    return f"; it changes at {counted(count, 'change point')}" if count else ""


@dataclass(frozen=True)
class LawText:
    """The words for a coordinate: an angle, or a length in a unit.

    >>> LawText(True, "mm").law(ConstantSpeed(2.0))
    'at a constant 2 rad/s (19.0986 rpm) from 0° at time 0'
    """

    is_angle: bool
    unit: str

    @singledispatchmethod
    def law(self, law: Law) -> str:
        """Return a law as the end of a sentence that begins with "it moves"."""
        raise NotImplementedError

    @law.register
    def _(self, law: ConstantSpeed) -> str:
        return f"at a constant {self._speed(law.speed)} from {self._value(law.start)} at time 0"

    @law.register
    def _(self, law: ConstantAcceleration) -> str:
        start = f"from {self._value(law.start)} at {self._speed(law.speed)} at time 0"
        return f"at a constant {self._rate(law.acceleration, 2)}, {start}"

    @law.register
    def _(self, law: TimeTable) -> str:
        first, last = law.span
        again = ", repeated" if law.repeat else ""
        spline = f"a spline of degree {law.degree} through {counted(len(law.times), 'value')}"
        return f"along {spline} from {number_text(first)} to {number_text(last)} s{again}"

    @law.register
    def _(self, law: MotionTable) -> str:
        first, last = law.span
        columns = f"a table of values, speeds and accelerations at {counted(len(law.times), 'time')}"
        return f"by {columns} from {number_text(first)} to {number_text(last)} s"

    @law.register
    def _(self, law: FunctionLaw) -> str:
        return "by a Python function of time"

    @law.register
    def _(self, law: Program) -> str:
        period = f"a program of {number_text(law.period)} s{', repeated' if law.repeat else ''}"
        segments = "; ".join(self._segment(segment) for segment in law.segments)
        return f"by {period}, from {self._value(law.start)}: {segments}.{''.join(self._jumps(law))}".rstrip(".")

    def _segment(self, segment: ProgramSegment) -> str:
        over = f"over {number_text(segment.over)} s"
        if segment.law == "dwell":
            return f"dwell {over}"
        way = "rise" if segment.rise >= 0.0 else "fall"
        return f"{segment.law} {way} by {self._value(abs(segment.rise))} {over}{self._limits(segment)}"

    def _limits(self, segment: ProgramSegment) -> str:
        """Return the limits of a segment, if any."""
        given = [(getattr(segment, name), order) for order, name in enumerate(LIMITS, 1)]
        limits = [self._rate(value, order) for value, order in given if value is not None]
        return f" within {listed(limits)}" if limits else ""

    def _jumps(self, law: Program) -> Iterator[str]:
        """Yield a sentence on jumps of the velocity, and one on jumps of the acceleration."""
        found = law.discontinuities(law.repeat)
        for order in (1, 2):
            places = [number_text(one.place) for one in found if one.order == order]
            if places:
                yield f" Its {DERIVATIVES[order]} jumps at {listed(places)} s."

    def _value(self, value: Any) -> str:
        shown = degrees(value) if self.is_angle else value
        return with_unit(_range_text(shown), DEGREES if self.is_angle else self.unit)

    def _speed(self, value: Any) -> str:
        """Return a speed, a single one in rpm as well."""
        if np.ptp(value) > 0.0:
            return self._rate(value, 1)
        return with_customary(
            float(np.min(value)), ANGULAR_VELOCITY if self.is_angle else f"{self.unit}{PER_SECOND[1]}"
        )

    def _rate(self, value: Any, order: int) -> str:
        return f"{_range_text(value)} {'rad' if self.is_angle else self.unit}{PER_SECOND[order]}"


def _range_text(value: Any) -> str:
    """A number; of an array of designs the least and the greatest."""
    low, high = float(np.min(value)), float(np.max(value))
    return number_text(low) if low == high else f"{number_text(low)} to {number_text(high)}"


@dataclass(frozen=True)
class PathText:
    """The words for a path, lengths in a unit.

    >>> PathText("mm").path(TimedPlaces([0.0, 2.0], (0j, 1j)))
    'through 2 places from 0 to 2 s, by a spline of degree 5'
    """

    unit: str

    @singledispatchmethod
    def path(self, path: Path) -> str:
        """Return a path as the end of a sentence that begins with "it is guided"."""
        raise NotImplementedError

    @path.register
    def _(self, path: TimedPlaces) -> str:
        first, last = path.span
        again = ", again and again" if path.repeat else ""
        places = f"through {len(path.places)} places from {number_text(first)} to {number_text(last)} s"
        return f"{places}, by a spline of degree {path.degree}{again}"

    @path.register
    def _(self, path: LinePath) -> str:
        start, end = (f"({number_text(p.real)}, {number_text(p.imag)})" for p in path.places)
        return f"along the line from {start} to {end}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: CurvePath) -> str:
        round_ = "closed " if path.curve.closed else ""
        return f"along a {round_}curve of {number_text(path.length)} {self.unit}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: FunctionPath) -> str:
        return "by a Python function of time"

    def _law(self, path: LinePath | CurvePath) -> str:
        return LawText(False, self.unit).law(path.law)
