"""Forces: assumptions, masses and loads, reactions, drivers' efforts, shaking force, friction, free bodies.

Assumptions (units, gravity, inertia, speeds, friction) come before any number. Extremes lie between the poses too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import Field, dataclass, fields
from functools import partial
from typing import Any

import numpy as np

from compoundkin.analysis.checks import verify
from compoundkin.base.arrays import Number, first_entry
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.reactions.link_forces import LinkForces
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Extremes, Measure, extremes
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.amounts import LoadFunction, LoadTable
from compoundkin.model.loads.contract import Load
from compoundkin.view.report.outputs_section import extremes_columns, extremes_row
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.verification_sections import findings_table
from compoundkin.view.report.wording import counted, listed, number_text

BALANCES = "balances written anew by Newton and Euler, and virtual work"


# So many singular poses are told one by one.
MOST_SINGULAR = 8


def forces_section(forces: Forces, design: int = 0) -> Section:
    """Return all there is to say of forces, the assumptions first."""
    return Section("forces", "Forces", tuple(_force_blocks(Sample(forces.motion, design), forces)))


def forces_report(forces: Forces, design: int = 0, on: str = "") -> Report:
    """Report forces alone, or the free body of one link. Raises UnknownName for a link that there is not."""
    motion, check = forces.motion, verify(forces)
    poses, closed, count = motion.failed.size, np.count_nonzero(motion.failed == 0), len(check.findings)
    passed = count - len(check.failed)
    outcome = Outcome(True, int(poses), int(closed), count, passed, 0, 0, check.passed, check.verdict)
    section = free_body_section(forces, on, design) if on else forces_section(forces, design)
    return Report(motion.mechanism.title, (section,), outcome, motion, design=design)


def _force_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, forces))}.")
    mechanism = forces.motion.mechanism
    if mechanism.masses:
        yield Paragraph("Masses, each mass centre in its link's own frame:")
        yield masses_table(forces)
        yield from _assumed_masses(forces)
    if mechanism.loads:
        yield Paragraph("Loads:")
        yield loads_table(forces)
    yield from _undetermined_blocks(forces)
    yield from _singular_blocks(sample, forces)
    yield from reactions_blocks(sample, forces)
    yield from drives_blocks(sample, forces)
    yield from shaking_blocks(sample, forces)
    yield from friction_blocks(sample, forces)
    yield Paragraph(f"Checks of the forces, {BALANCES}:")
    yield findings_table(sample, verify(forces))


def force_checks_sections(sample: Sample, forces: Forces | None) -> tuple[Section, ...]:
    """Return the findings about forces as a section; none without forces."""
    if forces is None:
        return ()
    blocks = Paragraph(f"By {BALANCES}."), findings_table(sample, verify(forces))
    return (Section("force-checks", "Checks of forces", blocks),)


def _assumed_masses(forces: Forces) -> Iterator[Block]:
    """What of masses was left out, and is that of uniform bodies."""
    told = [f"{one.link}: {one.assumed}" for one in forces.mechanism.masses.values() if one.assumed]
    if told:
        yield Paragraph(f"Assumed, for it was left out: {'; '.join(told)}.")


def _undetermined_blocks(forces: Forces) -> Iterator[Block]:
    """What equilibrium leaves open."""
    found = forces.undetermined
    if found:
        told = listed(f"{one.part} in {one.pair}" for one in found)
        freed = dict.fromkeys(str(dropped) for one in found for dropped in one.freed)
        remedy = f"they would be determined were {listed(freed)} left free" if freed else ""
        yield Alert(f"Equilibrium does not determine {told}: they balance each other.", remedy)


def _singular_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """What becomes of forces at change points and limit positions."""
    before = tuple(int(k) for k in np.unravel_index(sample.design, forces.shape[:-1] or (1,)))[: len(forces.shape) - 1]
    found = [one for one in forces.singular if one.pose[:-1] == before]
    told = "; ".join(
        f"pose {one.pose[-1]}, {one.kind} of {listed(one.links)}: {one.forces}" for one in found[:MOST_SINGULAR]
    )
    more = f"; and {len(found) - MOST_SINGULAR} more" if len(found) > MOST_SINGULAR else ""
    if found:
        yield Paragraph(
            f"Forces at singular poses: {told}{more}. Finite ones are what they come to from beside the pose."
        )


# A free body is told at all of so many poses; of more at the first one.
MOST_POSES = 8


def free_body_section(forces: Forces, link: str, design: int = 0) -> Section:
    """Return all that acts on a link. Raises UnknownName for a link that there is not."""
    own = forces.on(link)
    return Section(
        "free-body", f"Forces on {link}", tuple(_free_body_blocks(Sample(forces.motion, design), forces, own))
    )


def _free_body_blocks(sample: Sample, forces: Forces, own: LinkForces) -> Iterator[Block]:
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, forces))}.")
    what = "what the ground must hold" if own.link == FRAME else "which is zero in equilibrium"
    yield Paragraph(
        f"Each force at its point of attack, in the axes of the frame, its moment about that point; the sum, {what}."
    )
    column, values = sample.places
    shown = range(sample.poses) if sample.poses <= MOST_POSES else range(1)
    for pose in shown:
        unit = f" {column.unit}" if column.unit else ""
        more = "" if len(shown) == sample.poses else f", the first of {sample.poses} poses"
        yield Paragraph(f"At {column.name} {number_text(float(values[pose]))}{unit}{more}:")
        if not sample.assembled[pose]:
            yield Paragraph("It cannot be assembled there.")
            continue
        yield _free_body_table(sample, forces, own, pose)


def _free_body_table(sample: Sample, forces: Forces, own: LinkForces, pose: int) -> TableBlock:
    """What acts at a pose, a row each, and their sum."""
    units, floor = forces.units, FORCE_ROUNDING * largest_force(forces)
    rows: list[tuple[Cell, ...]] = []
    for one in own:
        place, force = complex(sample.of(one.place)[pose]), complex(sample.of(one.force)[pose])
        named = one.at or f"({number_text(place.real)}, {number_text(place.imag)})"
        moment = float(sample.of(one.moment)[pose])
        rows.append((one.kind, one.name, one.by, named, (force.real, force.imag), abs(force), moment))
    whole, about = complex(sample.of(own.force)[pose]), float(sample.of(own.moment_about(0j))[pose])
    rows.append(("sum", "", "", "the origin", (whole.real, whole.imag), abs(whole), about))
    words = Column("kind"), Column("name"), Column("by"), Column("at")
    numbers = (Column("force", units.force, "each", floor), Column("size", units.force, "each", floor),
               Column("moment", units.moment, "each", floor * forces.motion.size))  # fmt: skip
    return TableBlock((*words, *numbers), tuple(rows), keys=2)


# Speeds that differ by less than this part of the greatest are constant.
STEADY = 1e-9


def assumptions(sample: Sample, forces: Forces) -> Iterator[str]:
    """Yield what the numbers stand on, one clause each."""
    units, mechanism = forces.units, forces.motion.mechanism
    yield f"lengths in {units.length}, masses in {units.mass}, forces in {units.force}, moments in {units.moment}"
    free_fall = complex(first_entry(mechanism.gravity)) if np.ndim(mechanism.gravity) else complex(mechanism.gravity)
    told = f"({number_text(free_fall.real)}, {number_text(free_fall.imag)}) m/s^2"
    yield f"gravity {told}" if free_fall else "no gravity"
    massless = [name for name in mechanism.links if name not in mechanism.masses and name != "frame"]
    if mechanism.masses and massless:
        yield f"no mass on {listed(massless)}"
    yield "accelerations cause inertia forces" if forces.inertia else "statics: no inertia"
    yield from _driver_speeds(sample)
    held = forces.motion.loading.get("holding")
    if held:
        yield f"{held} holds in the drivers' place"
    yield friction_text(forces)


def _driver_speeds(sample: Sample) -> Iterator[str]:
    """How each driver moves."""
    motion = sample.motion
    for name, drive in motion.drives.items() if motion.order else ():
        rates = np.asarray(sample.of(drive.rate))
        unit = "rad/s" if drive.is_angle else f"{motion.mechanism.unit}/s"
        low, high = float(np.nanmin(rates)), float(np.nanmax(rates))
        if high - low <= STEADY * max(abs(low), abs(high)):
            yield f"{name} at {number_text(low)} {unit}"
        else:
            yield f"{name} from {number_text(low)} to {number_text(high)} {unit}"


def masses_table(forces: Forces) -> TableBlock:
    """Return the masses as they are written, the first of several designs."""
    units, mechanism = forces.units, forces.motion.mechanism
    columns = (Column("link"), Column("mass", units.mass, "each"), Column("mass centre"),
               Column("inertia about it", f"{units.mass} {units.length}^2", "each"))  # fmt: skip
    rows = [
        (one.link, first_number(one.mass), _place_text(one.at), first_number(one.inertia))
        for one in mechanism.masses.values()
    ]
    return TableBlock(columns, tuple(rows))


def loads_table(forces: Forces) -> TableBlock:
    """Return the loads as written. What each is, on which links, with which numbers."""
    rows = [
        (one.name, one.title, ", ".join(one.links), _load_values(one)) for one in forces.motion.mechanism.loads.values()
    ]
    return TableBlock((Column("load"), Column("kind"), Column("on"), Column("as written")), tuple(rows))


def _load_values(load: Load) -> str:
    """The numbers of a load that are not as where nothing is said, by what they are called."""
    written = {key.name for key in load.keys} - {"name", *load.link_keys}
    own = [field for field in fields(load) if field.name in written]
    values = {
        field.name: _value_text(value) for field in own if not _is_default(value := getattr(load, field.name), field)
    }
    return ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in values.items() if value)


def _is_default(value: Any, field: Field[Any]) -> bool:
    return not np.ndim(value) and isinstance(value, type(field.default)) and bool(value == field.default)


def _value_text(value: Any) -> str:
    if value is None or isinstance(value, bool | str):
        return str(value or "")
    if isinstance(value, tuple):
        return f"({'; '.join(map(_value_text, value))})"
    if isinstance(value, LoadFunction):
        return "a function"
    if isinstance(value, LoadTable):
        over = f" over {value.over}" if value.over else ""
        return f"{_range_text(value.values)}, a table{over}"
    values = np.ravel(np.asarray(value))
    return (
        f"({_range_text(values.real)}, {_range_text(values.imag)})" if np.iscomplexobj(values) else _range_text(values)
    )


def _range_text(values: Number) -> str:
    low, high = float(np.min(values)), float(np.max(values))
    return number_text(low) if low == high else f"{number_text(low)} to {number_text(high)}"


def _place_text(at: Any) -> str:
    if isinstance(at, str):
        return at
    place = complex(first_number(at))
    return f"({number_text(place.real)}, {number_text(place.imag)})"


def first_number(value: Any) -> Any:
    """Return the first number of an array, or the number."""
    return first_entry(value) if np.ndim(value) else value


# What is below this part of the largest moment, by forces and the size of the mechanism, is rounding.
NEGLIGIBLE = 1e-9


def reaction_figures(forces: Forces) -> tuple[ForceFigure, ...]:
    """Return what is listed of pairs. The force, and its moment where there is one."""
    units = forces.units
    efforts = {driven.pair.name for driven in forces.motion.structure.driven.values()}
    found = []
    for name, own in forces.pairs.items():
        title = f"{name}, on {own.pair.members[1]}"
        found.append(ForceFigure(f"{title}|force", units.force, partial(_pair_force, name), True))
        turns = own.pair.free_is_angle if name in efforts else False
        if not turns and not _is_negligible(forces, own.moment):
            found.append(ForceFigure(f"{title}|moment", units.moment, partial(_pair_moment, name)))
    return tuple(found)


def _pair_force(name: str, forces: Forces) -> Number:
    return np.abs(forces.pairs[name].force)


def _pair_moment(name: str, forces: Forces) -> Number:
    found: Number = forces.pairs[name].moment
    return found


def _is_negligible(forces: Forces, moment: Number) -> bool:
    """Whether a moment is rounding at every pose."""
    values = np.abs(np.asarray(moment))
    largest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    return largest <= NEGLIGIBLE * max(largest_force(forces) * forces.motion.size, 1e-300)


def reactions_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the extremes of the forces in all pairs."""
    figures = reaction_figures(forces)
    if not figures:
        return
    if sample.poses == 1:
        yield Paragraph("Reactions, the force on the second link of each pair, its size, and its moment there:")
        yield _at_one_pose(sample, forces)
        return
    told = "Reactions, the force on the second link of each pair, between the poses too"
    yield Paragraph(f"{told}. Least and greatest:")
    rows = []
    for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True):
        (pair, _, on), _, what = figure.name.partition("|")[0].partition(", on "), "", figure.name.partition("|")[2]
        rows.append((pair, on, what, figure.unit, *row))
    columns = Column("pair"), Column("on"), Column("quantity"), Column("unit"), *extremes_columns(sample)
    yield TableBlock(columns, tuple(rows), keys=1)


def _at_one_pose(sample: Sample, forces: Forces) -> TableBlock:
    """The forces themselves."""
    rows: list[tuple[Cell, ...]] = []
    for name, one in forces.pairs.items():
        force, moment = complex(sample.of(one.force)[0]), float(sample.of(one.moment)[0])
        rows.append((name, one.pair.members[1], (force.real, force.imag), abs(force), moment))
    floor = FORCE_ROUNDING * largest_force(forces)
    units = forces.units
    numbers = (Column("force", units.force, "each", floor), Column("size", units.force, "each", floor),
               Column("moment", units.moment, "each", floor * forces.motion.size))  # fmt: skip
    return TableBlock((Column("pair"), Column("on"), *numbers), tuple(rows), keys=1)


def extremes_rows(sample: Sample, forces: Forces, figures: Sequence[ForceFigure]) -> list[tuple[Cell, ...]]:
    """Return the extremes of figures with their places; at a single pose its value."""
    floor = FORCE_ROUNDING * largest_force(forces)
    if sample.poses > 1:
        found: tuple[Extremes, ...] = force_extremes(forces, tuple(figures))
        return [extremes_row(sample, one, sample.design, floor) for one in found]
    return [_extremes_at_poses(sample, np.asarray(sample.of(figure.of(forces)))) for figure in figures]


def _extremes_at_poses(sample: Sample, values: Number) -> tuple[Cell, ...]:
    if not np.isfinite(values).any():
        return (None,) * 4
    places = sample.places[1]
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return float(values[low]), float(places[low]), float(values[high]), float(places[high])


def drives_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield what each driver does: its effort with mean and extremes, its power."""
    figures = tuple(figure for name in forces.drives for figure in _drive_figures(forces, name))
    if not figures:
        return
    yield Paragraph("Drivers, the torque or thrust along the driver's own coordinate, positive where it drives it up:")
    rows = []
    for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True):
        values = np.asarray(figure.of(forces))
        root = float(np.sqrt(mean_over_motion(forces, values**2, sample.design)))
        average = mean_over_motion(forces, values, sample.design)
        average = 0.0 if abs(average) <= NEGLIGIBLE * root else average
        rows.append((*figure.name.split("|"), figure.unit, average, root, *row))
    first = Column("driver"), Column("quantity"), Column("unit")
    columns = (*first, Column("mean", style="each"), Column("rms", style="each"), *extremes_columns(sample))
    yield TableBlock(columns, tuple(rows), keys=1)


def _drive_figures(forces: Forces, name: str) -> Iterator[ForceFigure]:
    units, is_angle = forces.units, forces.motion.drives[name].is_angle
    what, unit = ("torque", units.moment) if is_angle else ("thrust", units.force)
    yield ForceFigure(f"{name}|{what}", unit, partial(_drive_effort, name))
    if forces.motion.order:
        yield ForceFigure(f"{name}|power", units.power, partial(_drive_power, name))


def _drive_effort(name: str, forces: Forces) -> Number:
    found: Number = forces.drives[name].effort
    return found


def _drive_power(name: str, forces: Forces) -> Number:
    found: Number = forces.drives[name].power
    return found


def shaking_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the shaking force, and its moment about a point of the frame."""
    letter = frame_point(forces)
    units = forces.units
    about = letter or "the origin"
    figures = (ForceFigure("force", units.force, _shaking, True),
               ForceFigure(f"moment about {about}", units.moment, partial(_shaking_moment, letter)))  # fmt: skip
    yield Paragraph("The mechanism on its frame (shaking force), reactions of the drivers included:")
    rows = [(figure.name, figure.unit, *row)
            for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True)]  # fmt: skip
    yield TableBlock((Column("on the frame"), Column("unit"), *extremes_columns(sample)), tuple(rows), keys=1)


def frame_point(forces: Forces) -> str:
    """Return the point of the frame about which moments are told.

    It is that of the first driver, else the first one; nothing for a frame without points.
    """
    points = forces.mechanism.geometry.points[FRAME]
    letters = [driven.pair.letters[0] for driven in forces.motion.structure.driven.values()]
    return next((one for one in (*letters, *points) if one in points), "")


def _shaking(forces: Forces) -> Number:
    return np.abs(forces.shaking.force)


def _shaking_moment(letter: str, forces: Forces) -> Number:
    return forces.shaking.moment_about(letter or 0j)


def undetermined_sentence(names: Sequence[str]) -> str:
    """Return what equilibrium does not determine, in a sentence."""
    return f"Equilibrium does not determine {listed(names)}: the mechanism is held by more than it needs."


# So many stretches of poses are told one by one.
MOST_STRETCHES = 6


def friction_text(forces: Forces) -> str:
    """Return the friction that is assumed, in words."""
    frictions = forces.mechanism.frictions.values()
    if not frictions:
        return "no friction"
    told = []
    for one in frictions:
        sizes = [f"{word} {number_text(first_number(value))}" for word, value in
                 (("radius", one.radius), ("length", one.length)) if value is not None]  # fmt: skip
        told.append(f"{one.pair} {number_text(first_number(one.coefficient))}{f' ({listed(sizes)})' if sizes else ''}")
    return f"Coulomb friction against the motion, coupled to the reactions: {listed(told)}; none elsewhere"


def friction_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield sizes and losses of frictions, efficiency, and where it locks or wedges."""
    if not forces.friction.pairs:
        return
    yield Paragraph("Friction, on the second link of each pair, and the power that it takes:")
    figures = tuple(figure for name in forces.friction.pairs for figure in _friction_figures(forces, name))
    rows: list[tuple[Cell, ...]] = []
    for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True):
        average = mean_over_motion(forces, figure.of(forces), sample.design)
        rows.append((*figure.name.split("|"), figure.unit, average, *row))
    first = Column("pair"), Column("quantity"), Column("unit"), Column("mean", style="each")
    yield TableBlock((*first, *extremes_columns(sample)), tuple(rows), keys=1)
    yield from _efficiency_blocks(sample, forces)
    yield from _locking_blocks(sample, forces)


def _friction_figures(forces: Forces, name: str) -> Iterator[ForceFigure]:
    units, is_moment = forces.units, forces.friction.pairs[name].is_moment
    what, unit = ("moment", units.moment) if is_moment else ("force", units.force)
    yield ForceFigure(f"{name}|{what}", unit, partial(_friction_value, name))
    yield ForceFigure(f"{name}|power", units.power, partial(_friction_power, name))


def _friction_value(name: str, forces: Forces) -> Number:
    return forces.friction.pairs[name].friction


def _friction_power(name: str, forces: Forces) -> Number:
    return forces.friction.pairs[name].power


def _efficiency_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """How much comes out over the whole motion, and the least at a pose."""
    whole = float(np.ravel(forces.efficiency.over_motion)[sample.design])
    at_poses = np.asarray(sample.of(forces.efficiency.at_poses))
    if not np.isfinite(whole):
        return
    worst = f"; at poses from {number_text(float(np.nanmin(at_poses)))} on" if np.isfinite(at_poses).any() else ""
    yield Paragraph(f"Efficiency over the motion, work out over work in: {number_text(whole)}{worst}.")


def _locking_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Where loads cannot move it, and where no forces or several satisfy Coulomb's law."""
    locked = [str(one) for one in forces.efficiency.self_locking_stretches if one.design == sample.design]
    if locked:
        yield Paragraph(f"Self-locking, loads cannot move it: {_first_stretches(locked)}.")
    for one in forces.friction.wedged[:MOST_STRETCHES]:
        yield Alert(f"It is {one}.")


def _first_stretches(told: list[str]) -> str:
    more = [f"and {counted(len(told) - MOST_STRETCHES, 'stretch')} more"] if len(told) > MOST_STRETCHES else []
    return "; ".join([*told[:MOST_STRETCHES], *more])


# A force below this part of the largest one of all is rounding.
FORCE_ROUNDING = 1e-11


ForceFunction = Callable[[Forces], Number]


@dataclass(frozen=True)
class ForceFigure:
    """A real figure of forces. What it is called, its unit, how it is asked."""

    name: str
    unit: str
    of: ForceFunction
    is_length: bool = False


def _finite_values(of: ForceFunction, motion: Motion) -> Number:
    """A figure of a motion's forces; what is infinite is left out."""
    values = np.asarray(of(motion.forces))
    return np.where(np.isfinite(values), values, np.nan)


def force_extremes(forces: Forces, figures: tuple[ForceFigure, ...]) -> tuple[Extremes, ...]:
    """Return the least and the greatest value of figures, between the poses too."""
    largest = largest_force(forces)
    measures = [Measure(one.name, one.unit, 2 if forces.inertia else 1, partial(_finite_values, one.of), one.is_length,
                        largest) for one in figures]  # fmt: skip
    return extremes(forces.motion, *measures)


def largest_force(forces: Forces) -> float:
    """Return the largest force in any pair, beside which others are rounding.

    It is that of an ordinary pose: next to singular ones forces grow without limit.
    """
    sizes = [np.broadcast_to(np.abs(one.force), forces.motion.failed.shape) for one in forces.wrenches.values()]
    at_poses = np.max([np.where(np.isfinite(one), one, 0.0) for one in sizes] or [np.zeros(1)], axis=0)
    return float(np.median(at_poses)) or float(np.max(at_poses))


def mean_over_motion(forces: Forces, values: Any, design: int) -> float:
    """Return the mean of an array over the motion.

    It is that over the time, or over the way of the only driver that moves.
    """
    motion = forces.motion
    row = np.asarray(np.broadcast_to(values, motion.shape)).reshape(motion.inputs.designs, -1)[design]
    along = _path_coordinate(motion, design)
    known = np.isfinite(row)
    both = known[1:] & known[:-1]
    steps = np.abs(np.diff(along))[both]
    if not steps.sum() > 0:
        return float(np.mean(row[known])) if known.any() else float("nan")
    return float(np.sum((row[1:] + row[:-1])[both] / 2.0 * steps) / np.sum(steps))


def _path_coordinate(motion: Motion, design: int) -> Number:
    """The times of a design, else the values of the only driver that moves, else the numbers of the poses."""
    rows = [motion.time] if motion.time is not None else [drive.value for drive in motion.drives.values()]
    full = [np.asarray(np.broadcast_to(row, motion.shape)).reshape(motion.inputs.designs, -1)[design] for row in rows]
    moving = [row for row in full if np.ptp(row) > 0]
    return moving[0] if len(moving) == 1 else np.arange(motion.inputs.poses, dtype=float)
