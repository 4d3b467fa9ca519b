"""Drivers and Assur groups in solving order: what each group uses and yields, its assembly mode, the drivers' laws."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
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
    RATES,
    VELOCITY,
    coordinate_dimension,
    unit_of,
)
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.units import customary_unit
from compoundkin.structure import Body, DrivenPair, Group, Structure, roman
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Block, Cell, Column, Paragraph, Section, StepBlock, TableBlock
from compoundkin.view.report.wording import counted, listed

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
    if any(drive.law is not None for drive in structure.mechanism.drives):
        from compoundkin.view.report.law_words import law_paragraphs

        yield from law_paragraphs(structure)


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


def solving_section(structure: Structure, motion: Motion | None) -> Section:
    """Report the frame with its driven links, then every group."""
    known = _letters(structure, structure.ground.links)
    steps = [_ground_step(structure, structure.ground, known)]
    for k, group in enumerate(structure.groups):
        new = [letter for letter in _letters(structure, group.links) if letter not in known]
        known.update(dict.fromkeys(new))
        mode = _mode_facts(motion, k) if motion else ()
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


def _mode_facts(motion: Motion, k: int) -> Iterator[tuple[str, str]]:
    """Yield the assembly mode of a group, its meaning, and what chose it."""
    why = CHOSEN_BY.get(motion.chosen_by.get(k, ""), "")
    solver = motion.solving_order.solvers[k]
    if solver.is_numbered:
        yield "mode", f"{why or 'found'}, by iteration, and followed along the motion"
    elif solver.modes == 1:
        yield "mode", "the only one"
    else:
        sign = motion.sign(k, 0)
        meaning = solver.sign_means if sign > 0 else f"the other one; in +1, {solver.sign_means}"
        yield "mode", f"{sign:+d}, {why} ({meaning}){_change_points_text(motion, k)}"


def _change_points_text(motion: Motion, k: int) -> str:
    places = motion.change_points.get(k)
    if places is None:
        return ""
    # a motion that returns from a change point as it came is there twice
    _, times = np.unique(places[0][np.isfinite(places[0])], return_counts=True)
    count = int(np.count_nonzero(times % 2))
    return f"; it changes at {counted(count, 'change point')}" if count else ""
