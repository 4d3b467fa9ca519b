"""Forces: assumptions, masses and loads, reactions, drivers' efforts, shaking force, friction, free bodies.

Assumptions (units, gravity, inertia, speeds, friction) come before any number. Extremes lie between the poses too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import Field, dataclass, fields
from typing import Any

import numpy as np

from compoundkin.analysis.checks import verify
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import InvalidInput
from compoundkin.dynamics.driver_course import speed_text
from compoundkin.dynamics.force_analysis import passed_stops
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.motor_sizing import sizing
from compoundkin.dynamics.reactions.force_figures import frame_point, shaking_moment
from compoundkin.dynamics.reactions.link_forces import LinkForces
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Measure, extremes
from compoundkin.model.attributes import (
    EFFORT,
    FORCE,
    LENGTH,
    MOMENT,
    POWER,
    SHAKING_FORCE,
    with_unit,
)
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.amounts import LoadFunction, LoadTable
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.latch import as_latch
from compoundkin.model.loads.stop import as_stop
from compoundkin.model.units import customary_unit
from compoundkin.view.report.force_sheet import SHEET, SYMBOLS, ForceSheet
from compoundkin.view.report.outputs_section import extremes_columns, extremes_row
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.verification_sections import checks_table, outcome_of
from compoundkin.view.report.wording import counted, listed, number_text, point_text, range_text
from compoundkin.view.sketch.picture_options import pose_notes

BALANCES = "balances written anew by Newton and Euler, and virtual work"
MOTORS = (
    "Generic motors, each behind the gear with which it is warmed least. The use is its effective torque over the "
    "rated one, the reserve the least of its greatest torque over what is needed, the inertias are that of the load "
    "over that of the rotor:"
)
# At most so many singular poses, and stretches of self-locking or wedging, are listed.
MOST_SINGULAR, MOST_STRETCHES = 8, 6
# The speed of drivers of which none is stated.
NOMINAL = 1.0
# A free body of more poses than these is listed at the first pose only.
MOST_POSES = 8
# Keys of rows, by which a live page computes them again; what is as written stays.
RANGE_OF_FORCE, COURSE_OF_DRIVER, AS_WRITTEN = "force", "driver", "stays"
# A force below this part of the largest one, or a moment below that part of it times the size, is rounding.
FORCE_ROUNDING, NEGLIGIBLE = 1e-11, 1e-9


def forces_sections(forces: Forces, design: int = 0) -> tuple[Section, ...]:
    """Return the section on forces, the assumptions first, and that on the motors that drive the mechanism."""
    section = Section("forces", "Forces", tuple(_force_blocks(Sample(forces.motion, design), forces)))
    motors = tuple(block for name in forces.drives for block in _motor_blocks(forces, name, design))
    return (section, Section("motors", "Motors that drive it", motors)) if motors else (section,)


def forces_report(forces: Forces, design: int = 0, on: str = "") -> Report:
    """Report forces alone, or the free body of the link `on`. Raises UnknownName for an unknown link."""
    sections = (free_body_section(forces, on, design),) if on else forces_sections(forces, design)
    outcome = outcome_of(forces.motion, verify(forces))
    return Report(forces.motion.mechanism.title, sections, outcome, forces.motion, design=design)


@checked
def sheet(forces: Forces, at: Any = None, *, pose: int | None = None, design: int = 0) -> Report:
    """Return the sheet of forces at one pose: free bodies and equations of equilibrium, a page for each link.

    The pose is that of the drivers' values `at` (radians or lengths: a number, or several by name), or the one with the
    index `pose`; else the one nearest to the mechanism's drawing. Symbols are those of the pictures of free bodies. The
    report is a text, Markdown, or a page with pictures that is printed on A4. Raises InvalidInput, UnknownName and
    NotAssembled for a pose that does not exist.

    Source: free-body diagrams and three equations a body, any course of statics.

    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.force import force
    >>> from compoundkin.model.mechanism import Mechanism
    >>> parts = link("frame", A=0), link("arm", A=0, B=2), drive("arm"), force("arm", (0, -30), at="B", name="F")
    >>> arm = Mechanism("Arm", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> of_arm = sheet(force_analysis(solve(arm, [0.0]))).section("sheet-2")
    >>> [block.text for block in of_arm.blocks if hasattr(block, 'latex')][-2:]
    ['ΣM(A) = T₂ + (xB - xA)·F,y = 0', 'ΣM(A) = 60 + 2·(-30) = 0']
    """
    known = ForceSheet.at_pose(forces, at, pose, design)
    first = Section(SHEET, "Forces at one pose", tuple(_sheet_blocks(known)))
    links = [name for name in known.scene.legend if known.acting[name]]
    bodies = [Section(f"{SHEET}-{known.scene.numbers[name]}", f"{known.scene.numbers[name]} {name}",
                      tuple(known.page(name))) for name in links]  # fmt: skip
    outcome = Outcome(True, 1, 1)
    return Report(forces.mechanism.title, (first, *bodies), outcome, design=design, studied=known)


def _sheet_blocks(known: ForceSheet) -> Iterator[Block]:
    """Yield the pose, the assumptions, the meaning of the symbols, and the numbers of the links."""
    sample = Sample(known.forces.motion, known.scene.pose[0])
    yield Paragraph(f"Pose: {', '.join(pose_notes(known.scene))}.")
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, known.forces))}.")
    yield Paragraph(SYMBOLS)
    rows = tuple((number, name, len(known.acting[name])) for name, number in known.scene.legend.items())
    yield TableBlock((Column("no.", style="each"), Column("link"), Column("forces and moments", style="each")), rows)


def force_checks_sections(forces: Forces | None) -> tuple[Section, ...]:
    """Return the findings about forces as a section; none without forces."""
    if forces is None:
        return ()
    blocks = Paragraph(f"By {BALANCES}."), checks_table(forces.motion, verify(forces))
    return (Section("force-checks", "Checks of forces", blocks),)


def _force_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    mechanism = forces.motion.mechanism
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, forces))}.")
    if mechanism.masses:
        yield Paragraph("Masses, each mass centre in its link's own frame:")
        yield masses_table(forces)
        assumed = [f"{one.link}: {one.assumed}" for one in forces.mechanism.masses.values() if one.assumed]
        if assumed:
            yield Paragraph(f"Assumed, for it was left out: {'; '.join(assumed)}.")
    if mechanism.loads:
        yield Paragraph("Loads:")
        yield loads_table(forces)
    yield from _undetermined_blocks(forces)
    yield from _singular_blocks(sample, forces)
    yield from reactions_blocks(sample, forces)
    yield from drives_blocks(sample, forces)
    yield from _shaking_blocks(sample, forces)
    yield from _friction_blocks(sample, forces)
    yield Paragraph(f"Checks of the forces, {BALANCES}:")
    yield checks_table(forces.motion, verify(forces))


def _undetermined_blocks(forces: Forces) -> Iterator[Block]:
    """Yield the reactions that equilibrium does not determine."""
    found = forces.undetermined
    if found:
        parts = listed(f"{one.part} in {one.pair}" for one in found)
        freed = dict.fromkeys(str(dropped) for one in found for dropped in one.freed)
        remedy = f"they would be determined were {listed(freed)} left free" if freed else ""
        yield Alert(f"Equilibrium does not determine {parts}: they balance each other.", remedy)


def _singular_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the forces at change points and limit positions."""
    before = tuple(int(k) for k in np.unravel_index(sample.design, forces.shape[:-1] or (1,)))[: len(forces.shape) - 1]
    found = [one for one in forces.singular if one.pose[:-1] == before]
    parts = "; ".join(
        f"pose {one.pose[-1]}, {one.kind} of {listed(one.links)}: {one.forces}" for one in found[:MOST_SINGULAR]
    )
    more = f"; and {len(found) - MOST_SINGULAR} more" if len(found) > MOST_SINGULAR else ""
    if found:
        yield Paragraph(
            f"Forces at singular poses: {parts}{more}. Finite ones are what they come to from beside the pose."
        )


def free_body_section(forces: Forces, link: str, design: int = 0) -> Section:
    """Return all that acts on a link. Raises UnknownName for an unknown link."""
    blocks = _free_body_blocks(Sample(forces.motion, design), forces, forces.on(link))
    return Section("free-body", f"Forces on {link}", tuple(blocks))


def _free_body_blocks(sample: Sample, forces: Forces, own: LinkForces) -> Iterator[Block]:
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, forces))}.")
    what = "what the ground must hold" if own.link == FRAME else "which is zero in equilibrium"
    yield Paragraph(
        f"Each force at its point of attack, in the axes of the frame, its moment about that point; the sum, {what}."
    )
    column, values = sample.places
    shown = range(sample.poses) if sample.poses <= MOST_POSES else range(1)
    for pose in shown:
        more = "" if len(shown) == sample.poses else f", the first of {sample.poses} poses"
        yield Paragraph(f"At {column.name} {with_unit(number_text(float(values[pose])), column.unit)}{more}:")
        if not sample.assembled[pose]:
            yield Paragraph("It cannot be assembled there.")
            continue
        yield _free_body_table(sample, forces, own, pose)


def _free_body_table(sample: Sample, forces: Forces, own: LinkForces, pose: int) -> TableBlock:
    """Return what acts at a pose, a row each, and the sum."""
    rows: list[tuple[Cell, ...]] = []
    for one in own:
        place, force = complex(sample.of(one.place)[pose]), complex(sample.of(one.force)[pose])
        named = one.at or point_text(place)
        moment = float(sample.of(one.moment)[pose])
        rows.append((one.kind, one.name, one.by, named, (force.real, force.imag), abs(force), moment))
    whole, about = complex(sample.of(own.force)[pose]), float(sample.of(own.moment_about(0j))[pose])
    rows.append(("sum", "", "", "the origin", (whole.real, whole.imag), abs(whole), about))
    words = Column("kind"), Column("name"), Column("by"), Column("at")
    return TableBlock((*words, *_wrench_columns(forces)), tuple(rows), keys=2)


def _wrench_columns(forces: Forces) -> tuple[Column, ...]:
    """Return the columns of a force with its components, its size and its moment."""
    units, floor = forces.units, FORCE_ROUNDING * largest_force(forces)
    return (Column("force", units.force, "each", floor), Column("size", units.force, "each", floor),
            Column("moment", units.moment, "each", floor * forces.motion.size))  # fmt: skip


def assumptions(sample: Sample, forces: Forces) -> Iterator[str]:
    """Yield the assumptions behind the numbers, one clause each."""
    units, mechanism = forces.units, forces.motion.mechanism
    yield f"lengths in {units.length}, masses in {units.mass}, forces in {units.force}, moments in {units.moment}"
    free_fall = complex(first_entry(mechanism.gravity)) if np.ndim(mechanism.gravity) else complex(mechanism.gravity)
    yield f"gravity {point_text(free_fall)} m/s^2" if free_fall else "no gravity"
    massless = [name for name in mechanism.links if name not in mechanism.masses and name != FRAME]
    if mechanism.masses and massless:
        yield f"no mass on {listed(massless)}"
    yield "accelerations cause inertia forces" if forces.inertia else "statics: no inertia"
    if forces.motion.order:
        yield from (f"{name} {speed_text(forces.motion, name, sample.design)}" for name in forces.motion.drives)
    if holding := forces.motion.loading.get("holding"):
        yield f"{holding} holds in the drivers' place"
    yield _friction_clause(forces)
    loads = mechanism.loads
    for name, depth in passed_stops(forces.motion).items():
        stop = as_stop(loads[name])
        assert stop is not None
        yield f"{name} is passed by up to {stop.place_text(depth)}: a rigid stop holds in simulations alone"
    if latches := [name for name, load in loads.items() if as_latch(load) is not None]:
        yield f"nothing held by {listed(latches)}: latches hold in simulations alone"


def _friction_clause(forces: Forces) -> str:
    """Return the friction that is assumed, with coefficients and sizes."""
    frictions = forces.mechanism.frictions.values()
    if not frictions:
        return "no friction"
    parts = []
    for one in frictions:
        sizes = [f"{word} {number_text(_first_number(value))}" for word, value in
                 (("radius", one.radius), ("length", one.length)) if value is not None]  # fmt: skip
        told = one.coefficient if one.efficiency is None else one.efficiency
        word = "" if one.efficiency is None else "efficiency "
        parts.append(f"{one.pair} {word}{number_text(_first_number(told))}{f' ({listed(sizes)})' if sizes else ''}")
    return f"Coulomb friction against the motion, coupled to the reactions: {listed(parts)}; none elsewhere"


def masses_table(forces: Forces) -> TableBlock:
    """Return the masses as written, of several designs the first."""
    units, mechanism = forces.units, forces.motion.mechanism
    columns = (Column("link"), Column("mass", units.mass, "each"), Column("mass centre"),
               Column("inertia about it", f"{units.mass} {units.length}^2", "each"))  # fmt: skip
    rows = [
        (one.link, _first_number(one.mass), _place_text(one.at), _first_number(one.inertia))
        for one in mechanism.masses.values()
    ]
    assumed = any(one.assumed for one in mechanism.masses.values())
    return TableBlock(columns, tuple(rows), figures=() if assumed else ((AS_WRITTEN,),) * len(rows))


def loads_table(forces: Forces) -> TableBlock:
    """Return the loads as written: kind, links, numbers."""
    rows = [
        (one.name, one.title, ", ".join(one.links), _load_values(one)) for one in forces.motion.mechanism.loads.values()
    ]
    columns = (Column("load"), Column("kind"), Column("on"), Column("as written"))
    return TableBlock(columns, tuple(rows), figures=((AS_WRITTEN,),) * len(rows))


def _load_values(load: Load) -> str:
    """Return the numbers of a load that are not defaults, with their names."""
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
        return f"{range_text(value.values)}, a table{over}"
    values = np.ravel(np.asarray(value))
    return f"({range_text(values.real)}, {range_text(values.imag)})" if np.iscomplexobj(values) else range_text(values)


def _place_text(at: Any) -> str:
    if isinstance(at, str):
        return at
    return point_text(complex(_first_number(at)))


def _first_number(value: Any) -> Any:
    """Return the first number of an array, or the number itself."""
    return first_entry(value) if np.ndim(value) else value


def reactions_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the extremes of the forces in all pairs; at a single pose the forces themselves."""
    if not forces.pairs:
        return
    what = "Reactions, the force on the second link of each pair"
    if sample.poses == 1:
        yield Paragraph(f"{what}, its size, and its moment there:")
        rows: list[tuple[Cell, ...]] = []
        for name, one in forces.pairs.items():
            force, moment = complex(sample.of(one.force)[0]), float(sample.of(one.moment)[0])
            rows.append((name, one.pair.members[1], (force.real, force.imag), abs(force), moment))
        yield TableBlock((Column("pair"), Column("on"), *_wrench_columns(forces)), tuple(rows), keys=1)
        return
    figures = tuple(figure for name in forces.pairs for figure in _pair_figures(forces, name))
    yield Paragraph(f"{what}, between the poses too. Least and greatest:")
    columns = Column("pair"), Column("on"), Column("quantity"), Column("unit"), *extremes_columns(sample)
    yield TableBlock(columns, _extremes_rows(sample, forces, figures), keys=1, figures=_keys(figures))


def _pair_figures(forces: Forces, name: str) -> Iterator[ForceFigure]:
    """Yield the size of the force in a pair, and its moment unless a driver's effort or zero."""
    own, units = forces.pairs[name], forces.units
    on = own.pair.members[1]
    yield ForceFigure(
        (name, on, "force"), units.force, f"{name}.{FORCE}", lambda own: np.abs(own.pairs[name].force), True
    )
    is_driven = any(step.pair.name == name for step in forces.motion.structure.driven.values())
    if not (is_driven and own.pair.free_is_angle) and not _is_negligible(forces, own.moment):
        yield ForceFigure((name, on, "moment"), units.moment, f"{name}.{MOMENT}", lambda own: own.pairs[name].moment)


def _is_negligible(forces: Forces, moment: Number) -> bool:
    """Return whether a moment is rounding at every pose."""
    values = np.abs(np.asarray(moment))
    largest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    return largest <= NEGLIGIBLE * max(largest_force(forces) * forces.motion.size, 1e-300)


def drives_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the effort and the power of each driver: mean, root mean square, extremes."""
    figures = tuple(figure for name in forces.drives for figure in _drive_figures(forces, name))
    if not figures:
        return
    yield Paragraph("Drivers, the torque or thrust along the driver's own coordinate, positive where it drives it up:")
    rows, keys = list[tuple[Cell, ...]](), list[tuple[str, ...]]()
    for figure, row in zip(figures, _extremes_rows(sample, forces, figures), strict=True):
        values = np.asarray(figure.of(forces))
        root = float(np.sqrt(mean_over_motion(forces, values**2, sample.design)))
        mean = mean_over_motion(forces, values, sample.design)
        rows += _also_customary((*row[:3], 0.0 if abs(mean) <= NEGLIGIBLE * root else mean, root, *row[3:]), (3, 4))
        other = customary_unit(figure.unit)
        keys += [(COURSE_OF_DRIVER, figure.name), *([(COURSE_OF_DRIVER, figure.name, repr(other[1]))] if other else [])]
    first = Column("driver"), Column("quantity"), Column("unit")
    columns = (*first, Column("mean", style="each"), Column("rms", style="each"), *extremes_columns(sample))
    yield TableBlock(columns, tuple(rows), keys=1, figures=tuple(keys))


def _also_customary(row: tuple[Cell, ...], means: tuple[int, ...]) -> Iterator[tuple[Cell, ...]]:
    """Yield a row with the unit in its third cell, and the same row in the unit in which that is customary.

    `means` are the cells with means; extremes with their places are the last four.
    """
    yield row
    other = customary_unit(str(row[2]))
    if other is not None:
        numbers = (*means, len(row) - 4, len(row) - 2)
        name, size = other
        cells = (cell * size if k in numbers and isinstance(cell, float) else cell for k, cell in enumerate(row))
        yield tuple(name if k == 2 else cell for k, cell in enumerate(cells))


def _motor_blocks(forces: Forces, name: str, design: int) -> Iterator[Block]:
    """Yield what a driver needs and which motors give it, where it has a speed of its own and takes power."""
    if forces.motion.time is None and np.all(np.asarray(forces.motion.drives[name].rate) == NOMINAL):
        return
    try:
        found = sizing(forces, driver=name, design=design)
    except InvalidInput:  # of what has no accelerations, or poses without forces, there is nothing to say
        return
    if not float(np.mean(found.torques * found.speeds)) > NEGLIGIBLE * found.peak * found.speed:
        return
    yield Paragraph(f"What the driver {name} needs over the motion:")
    yield TableBlock((Column("quantity"), Column("value", style="each"), Column("unit")), found.needs)
    yield Paragraph(MOTORS)
    rows = tuple(
        (one.motor.name, *map(_to_three_digits, (one.gear, one.use, one.reserve, one.reflected)),
         "; ".join(one.reasons) or "does")
        for one in found.motors
    )  # fmt: skip
    numbers = (Column(word, style="each") for word in ("gear", "use", "reserve", "inertias"))
    yield TableBlock((Column("motor"), *numbers, Column("")), rows, keys=1)
    yield Paragraph(found.verdict)


def _to_three_digits(number: float) -> Cell:
    return float(f"{number:.3g}")


def _drive_figures(forces: Forces, name: str) -> Iterator[ForceFigure]:
    units, is_angle = forces.units, forces.motion.drives[name].is_angle
    what, unit = ("torque", units.moment) if is_angle else ("thrust", units.force)
    yield ForceFigure((name, what), unit, f"{name}.{EFFORT}", lambda own: own.drives[name].effort)
    if forces.motion.order:
        yield ForceFigure((name, "power"), units.power, f"{name}.{POWER}", lambda own: own.drives[name].power)


def _shaking_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the shaking force, and its moment about a point of the frame."""
    letter, units = frame_point(forces), forces.units
    whole = f"{FRAME}.{SHAKING_FORCE}"
    figures = (ForceFigure(("force",), units.force, whole, lambda own: np.abs(own.shaking.force), True),
               ForceFigure((f"moment about {letter or 'the origin'}",), units.moment, shaking_moment(letter),
                           lambda own: own.shaking.moment_about(letter or 0j)))  # fmt: skip
    yield Paragraph("The mechanism on its frame (shaking force), reactions of the drivers included:")
    columns = Column("on the frame"), Column("unit"), *extremes_columns(sample)
    yield TableBlock(columns, _extremes_rows(sample, forces, figures), keys=1, figures=_keys(figures))


def _friction_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield friction and its power in each pair, efficiency, self-locking and wedging."""
    if not forces.friction.pairs:
        return
    yield Paragraph("Friction, on the second link of each pair, and the power that it takes:")
    figures = tuple(figure for name in forces.friction.pairs for figure in _friction_figures(forces, name))
    means = [mean_over_motion(forces, figure.of(forces), sample.design) for figure in figures]
    extremes_of = _extremes_rows(sample, forces, figures)
    whole = [(*row[:3], mean, *row[3:]) for mean, row in zip(means, extremes_of, strict=True)]
    rows = [one for row in whole for one in _also_customary(row, (3,))]
    first = Column("pair"), Column("quantity"), Column("unit"), Column("mean", style="each")
    yield TableBlock((*first, *extremes_columns(sample)), tuple(rows), keys=1)
    yield from _efficiency_blocks(sample, forces)
    yield from _locking_blocks(sample, forces)


def _friction_figures(forces: Forces, name: str) -> Iterator[ForceFigure]:
    units, is_moment = forces.units, forces.friction.pairs[name].is_moment
    what, unit = ("moment", units.moment) if is_moment else ("force", units.force)
    yield ForceFigure((name, what), unit, "", lambda own: own.friction.pairs[name].friction)
    yield ForceFigure((name, "power"), units.power, "", lambda own: own.friction.pairs[name].power)


def _efficiency_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the efficiency over the whole motion, and the least at a pose."""
    whole = float(np.ravel(forces.efficiency.over_motion)[sample.design])
    at_poses = np.asarray(sample.of(forces.efficiency.at_poses))
    if not np.isfinite(whole):
        return
    worst = f"; at poses from {number_text(float(np.nanmin(at_poses)))} on" if np.isfinite(at_poses).any() else ""
    yield Paragraph(f"Efficiency over the motion, work out over work in: {number_text(whole)}{worst}.")


def _locking_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield where loads cannot move it, and where no forces or several satisfy Coulomb's law."""
    locked = [str(one) for one in forces.efficiency.self_locking_stretches if one.design == sample.design]
    if locked:
        more = len(locked) - MOST_STRETCHES
        shown = [*locked[:MOST_STRETCHES], *([f"and {counted(more, 'stretch')} more"] if more > 0 else [])]
        yield Paragraph(f"Self-locking, loads cannot move it: {'; '.join(shown)}.")
    for one in forces.friction.wedged[:MOST_STRETCHES]:
        yield Alert(f"It is {one}.")


@dataclass(frozen=True)
class ForceFigure:
    """A real figure of forces: the first cells of its row, its unit, its name, the function of forces that gives it."""

    labels: tuple[str, ...]
    unit: str
    name: str
    of: Callable[[Forces], Number]
    is_length: bool = False

    @property
    def key(self) -> tuple[str, ...]:
        """What a live page computes it again by: the quantity of forces, of a vector its length."""
        return (RANGE_OF_FORCE, f"{self.name}.{LENGTH}" if self.is_length else self.name)

    def finite(self, motion: Motion) -> Number:
        """Return the figure of a motion's forces, NaN where it is infinite."""
        values = np.asarray(self.of(motion.forces))
        return np.where(np.isfinite(values), values, np.nan)


def _keys(figures: Sequence[ForceFigure]) -> tuple[tuple[str, ...], ...]:
    return tuple(figure.key for figure in figures)


def _extremes_rows(sample: Sample, forces: Forces, figures: Sequence[ForceFigure]) -> tuple[tuple[Cell, ...], ...]:
    """Return labels, unit, and extremes of figures with their places, between the poses too."""
    if sample.poses > 1:
        largest, order = largest_force(forces), 2 if forces.inertia else 1
        found = extremes(forces.motion, *(
            Measure(" ".join(one.labels), one.unit, order, one.finite, one.is_length, largest) for one in figures
        ))  # fmt: skip
        rows = [extremes_row(sample, one, sample.design, FORCE_ROUNDING * largest) for one in found]
    else:
        rows = [_value_twice(sample, float(sample.of(one.of(forces))[0])) for one in figures]
    return tuple((*one.labels, one.unit, *row) for one, row in zip(figures, rows, strict=True))


def _value_twice(sample: Sample, value: float) -> tuple[Cell, ...]:
    """Return the value of a single pose as least and as greatest."""
    return (value, float(sample.places[1][0])) * 2 if np.isfinite(value) else (None,) * 4


def largest_force(forces: Forces) -> float:
    """Return the largest force in any pair at the median pose: next to singular poses forces grow without limit."""
    sizes = [np.broadcast_to(np.abs(one.force), forces.motion.failed.shape) for one in forces.wrenches.values()]
    at_poses = np.max([np.where(np.isfinite(one), one, 0.0) for one in sizes] or [np.zeros(1)], axis=0)
    return float(np.median(at_poses)) or float(np.max(at_poses))


def mean_over_motion(forces: Forces, values: Any, design: int) -> float:
    """Return the mean of an array over the time of a motion, or over the path of the only driver that moves."""
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
    """Return the times of a design, else the values of the only driver that moves, else the numbers of the poses."""
    rows = [motion.time] if motion.time is not None else [drive.value for drive in motion.drives.values()]
    full = [np.asarray(np.broadcast_to(row, motion.shape)).reshape(motion.inputs.designs, -1)[design] for row in rows]
    moving = [row for row in full if np.ptp(row) > 0]
    return moving[0] if len(moving) == 1 else np.arange(motion.inputs.poses, dtype=float)
