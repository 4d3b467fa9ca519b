"""Instant centres as a textbook solution has them: primary ones, secondary ones with their lines, velocity ratios."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.analysis.centres import Centre, Centres, DerivationStep, instant_centres
from compoundkin.analysis.centres.circle_diagram import diagram_of
from compoundkin.analysis.centres.derivation import derive
from compoundkin.analysis.centres.instant_centres import LEAST_CONDITIONING
from compoundkin.base.arrays import degrees
from compoundkin.model.attributes import unit_of, with_unit
from compoundkin.structure import Structure
from compoundkin.view.report.pose_sample import ROUNDING, Sample
from compoundkin.view.report.report_data import Block, Cell, Column, FormulaBlock, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, listed, number_text

# A direction this close to 0 or 180 degrees is rounding.
NEARLY = 1e-9
# So many centres, pose by pose, are examined within a second.
MOST_CENTRES = 1_000_000


@dataclass(frozen=True, eq=False)
class CentresSample:
    """The centres of one pose of a design, the first one. They are in the order of the derivation."""

    sample: Sample
    given: Centres | None = None

    @cached_property
    def centres(self) -> Centres:
        """The centres of the motion."""
        return self.given or instant_centres(self.sample.motion)

    @cached_property
    def pose(self) -> tuple[int, ...]:
        """The pose, an index into the motion's shape."""
        shape = self.sample.motion.shape
        flat = self.sample.design * self.sample.poses
        return tuple(int(k) for k in np.unravel_index(flat, shape)) if shape else ()

    def of(self, values: Any) -> Any:
        """Tell what an array of the motion's shape holds at the pose."""
        return np.asarray(values)[self.pose]

    @cached_property
    def ordered(self) -> tuple[Centre, ...]:
        """All centres, in the order in which they are derived. Those without a step last."""
        steps = {frozenset(step.centre): k for k, step in enumerate(self.centres.derivation())}
        found = sorted(self.centres, key=lambda names: steps.get(frozenset(names), len(steps)))
        return tuple(self.centres[names] for names in found)

    @cached_property
    def kinds(self) -> Mapping[str, str]:
        """The kind of every step by its text, which a centre has as its derivation."""
        return {step.text: step.kind for step in self.centres.derivation()}

    @cached_property
    def primary(self) -> tuple[Centre, ...]:
        """The centres that a pair gives."""
        return tuple(centre for centre in self.ordered if self.kinds.get(centre.how) == "primary")

    @cached_property
    def secondary(self) -> tuple[Centre, ...]:
        """All other centres."""
        return tuple(centre for centre in self.ordered if self.kinds.get(centre.how) != "primary")


def centres_sections(sample: Sample) -> tuple[Section, ...]:
    """Return the sections on primary and secondary centres and angular velocities at the first pose of a motion.

    Raises NotDetermined where nothing moves, InvalidInput for a motion of order 0.
    """
    shown = CentresSample(sample)
    primary = Paragraph("Each is given by a pair."), _centres_table(shown, shown.primary, "pair")
    secondary = (
        (Paragraph(_kennedy_sentence(shown)), _centres_table(shown, shown.secondary, "lines"))
        if shown.secondary
        else ()
    )
    return (
        Section("centres", "Instant centres", (Paragraph(_pose_text(sample)), *_count_blocks(shown))),
        Section("primary", "Primary centres", primary),
        *([Section("secondary", "Secondary centres", secondary)] if secondary else []),
        _velocities(shown),
    )


def centre_blocks(found: Centres) -> tuple[Block, ...]:
    """Return the centres at the first pose, the primary ones first; of very many only their derivation."""
    sample = Sample(found.motion)
    if len(found) * found.motion.inputs.designs * sample.poses > MOST_CENTRES:
        return derivation_section(found.motion.structure).blocks
    shown = CentresSample(sample, found)
    tables = _centres_table(shown, shown.primary, "pair"), _centres_table(shown, shown.secondary, "lines")
    return (Paragraph(_pose_text(sample)), *_count_blocks(shown), *(table for table in tables if table.rows))


def derivation_section(structure: Structure) -> Section:
    """Return the order in which the circle diagram is completed. The same for all dimensions and poses.

    Raises NotDetermined where the drivers do not determine the motion.
    """
    steps = derive(diagram_of(structure)).steps
    columns = Column("step", style="each"), Column("centre"), Column("from")
    rows = tuple((k, _name(step.centre), _derived(step)) for k, step in enumerate(steps, 1))
    text = "The circle diagram, side by side, from links and pairs alone: it holds at every pose."
    return Section("derivation", "Derivation of the centres", (Paragraph(text), TableBlock(columns, rows)))


def _derived(step: DerivationStep) -> str:
    return _two_lines(step.text) if step.kind == "crossing" else step.text


def _pose_text(sample: Sample) -> str:
    at = [
        f"{d.name} {with_unit(number_text(float(d.values[0])), d.unit if d.unit != 'length' else '')}"
        for d in sample.drivers
    ]
    unit = sample.motion.mechanism.unit or "the unit of the file"
    return f"At {listed(at)}. Coordinates in {unit}, in the frame's axes." if at else f"Coordinates in {unit}."


def _kennedy_sentence(shown: CentresSample) -> str:
    text = "Three centres of three links lie on a line (Aronhold-Kennedy): each is where two such lines cross."
    if {"trial", "rates"} & set(shown.kinds.values()):
        text += " Where lines are lacking, trial positions or the drivers' rates help; the derivation has more."
    return text


def _count_blocks(shown: CentresSample) -> Iterator[Block]:
    n, primary, secondary = len(shown.sample.motion.mechanism.links), len(shown.primary), len(shown.secondary)
    yield FormulaBlock(f"N = n (n - 1) / 2 = {n} * {n - 1} / 2 = {len(shown.centres)}")
    yield Paragraph(f"{primary} of the {counted(len(shown.centres), 'centre')} are primary, {secondary} secondary.")


def _centres_table(shown: CentresSample, found: Sequence[Centre], how: str) -> TableBlock:
    """Return a row for each centre; directions and conditioning only where one has them."""
    unit = unit_of(shown.sample.motion.mechanism.unit, "length")
    floor = ROUNDING * shown.sample.motion.size
    columns = [Column("centre"), Column("x", unit, "each", floor), Column("y", unit, "each", floor, follows=True)]
    values: list[Iterable[Cell]] = [[_name(centre.links) for centre in found], *_coordinates(shown, found)]
    directions = [_direction(shown, centre) for centre in found]
    poor = [_low_conditioning(shown, centre) for centre in found]
    if any(value is not None for value in directions):
        columns.append(Column("at infinity, direction", "deg", "each", NEARLY))
        values.append(directions)
    if any(value is not None for value in poor):
        columns.append(Column("poor conditioning", style="brief"))
        values.append(poor)
    texts = [_at_pose(centre.how_at(*shown.pose)) for centre in found]
    return TableBlock((*columns, Column(how)), tuple(zip(*values, texts, strict=True)))


def _coordinates(shown: CentresSample, found: Sequence[Centre]) -> Iterator[list[Cell]]:
    points = [complex(shown.of(centre.point)) for centre in found]
    for parts in ([p.real for p in points], [p.imag for p in points]):
        yield [float(v) if np.isfinite(p) else None for v, p in zip(parts, points, strict=True)]


def _direction(shown: CentresSample, centre: Centre) -> float | None:
    """Return the direction of a centre at infinity, from 0 to below 180 degrees."""
    if not shown.of(centre.at_infinity):
        return None
    angle = float(degrees(np.angle(shown.of(centre.direction)))) % 180.0
    return 0.0 if 180.0 - angle < NEARLY else angle


def _low_conditioning(shown: CentresSample, centre: Centre) -> float | None:
    value = float(shown.of(centre.conditioning))
    return value if shown.of(centre.found) and value < LEAST_CONDITIONING else None


def _at_pose(how: str) -> str:
    """Return how a centre was derived, without the details of trial positions."""
    return _two_lines(how.partition(";")[0])


def _two_lines(text: str) -> str:
    """Return two lines of a derivation below each other, to fit a column."""
    return text.removeprefix("line ").replace(" x line ", "\nx ")


def _name(links: tuple[str, str]) -> str:
    return f"({links[0]} {links[1]})"


def _velocities(shown: CentresSample) -> Section:
    """Angular velocities of the links by centres alone and as solved, as ratios to the driver's where it has one."""
    motion = shown.sample.motion
    text, unit, scale = _reference(shown)
    rows = []
    thought = motion.mechanism.auxiliary_links
    for name in (name for name in motion.mechanism.links if name not in thought):
        by_centres = float(shown.of(shown.centres.velocities.angular_velocity(name))) / scale
        solved = float(shown.of(motion.links[name].angular_velocity)) / scale
        rows.append((name, by_centres, solved, abs(by_centres - solved)))
    floor = ROUNDING * max((abs(row[2]) for row in rows if np.isfinite(row[2])), default=0.0)
    columns = (Column("link"), Column("from centres", unit, "each", floor), Column("as solved", unit, "each", floor),
               Column("difference", unit, "brief"))  # fmt: skip
    return Section("velocities", "Angular velocities", (Paragraph(text), TableBlock(columns, tuple(rows))))


def _reference(shown: CentresSample) -> tuple[str, str, float]:
    """Return the reference of angular velocities: the speed of the only driver, if it turns, else rad/s."""
    drivers = list(shown.sample.motion.drives.items())
    speeds = [float(shown.of(drive.rate)) for _, drive in drivers]
    if len(drivers) == 1 and drivers[0][1].is_angle and speeds[0]:
        text = f"Ratios to the speed of the driver {drivers[0][0]}, by the centres alone and as solved from the pairs."
        return text, "", speeds[0]
    return "By the centres and the drivers' rates alone, and as solved from the pairs.", "rad/s", 1.0
