"""GeoGebra, written: a construction as a .ggb file or as commands, with notes on what it leaves out.

The construction has sliders for the drivers, then goes group by group.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import BytesIO
from typing import Any, ClassVar
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined, Problem
from compoundkin.files.exchange.contract import Exported, Writable
from compoundkin.files.exchange.geogebra.dragged_construction import (
    Angle,
    Construction,
    PolarSum,
    SliderRange,
    in_degrees,
)
from compoundkin.files.exchange.geogebra.geogebra_xml import add_shapes, window_of, xml_of
from compoundkin.files.exchange.geogebra.group_constructions import (
    CONSTRUCTIONS,
    DyadParts,
    add_mounted,
    add_train,
    inside_body,
    is_constructed,
    is_driven_constructed,
    is_train,
)
from compoundkin.files.exchange.geogebra.pair_sides import (
    ChosenSides,
    InsideBody,
    PairSides,
    PlacedBodies,
    link_points,
    steps_of,
)
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from compoundkin.kinematics import Motion
from compoundkin.kinematics.groups import GroupSolver, as_dyad
from compoundkin.kinematics.nearest_pose import turned_within
from compoundkin.kinematics.solution import quietly_solved

_TABLE = "write a table of its positions instead: `compoundkin solve NAME -o positions.csv`"


def construction_of(shown: PosedMechanism) -> Construction:
    """Return the construction. Raises InvalidInput listing all that cannot be constructed."""
    motion = ranged_motion(shown)
    build = Construction()
    sliders = build.driven
    begun, build.beyond = slider_values(shown, motion)
    for name in motion.drives:
        sliders[name] = _slider(build, motion, name, begun[name])
    chosen = ChosenSides(build, motion, sliders)
    problems = [*_problems(motion, chosen)]
    if problems:
        raise InvalidInput(problems, heading=f"{shown.mechanism.title!r} cannot be constructed as a whole")
    placed = _constructed(build, motion, shown, sliders, chosen)
    add_shapes(build, shown, placed.points, sliders)
    return build


def ranged_motion(shown: PosedMechanism) -> Motion:
    """Return the motion over the drivers' own ranges."""
    motion = shown.motion
    if motion is not None and motion.inputs.poses > 1:
        return motion
    try:
        found = quietly_solved(shown.structure)
    except (InvalidInput, NotAssembled, NotDetermined) as error:
        what = f"it cannot be solved: {error.problems[0].what}"
        raise InvalidInput(Problem(shown.mechanism.title, what, "drive it where it can be assembled")) from None
    # of drivers without a range the pose asked for is all there is
    return found if found.inputs.poses > 1 or motion is None else motion


def _slider(build: Construction, motion: Motion, name: str, value: float) -> str:
    """Add the slider of a driver; a number where its range is a single value. Return its name."""
    values, is_angle = np.ravel(motion.drives[name].value), motion.structure.driven_angles[name]
    if is_angle:
        values, value = np.round(np.rad2deg(values), 9), in_degrees(value)
    stem, caption = ("φ", f"{name}, degrees") if is_angle else ("s", name)
    low, high = float(values.min()), float(values.max())
    if low == high:
        return build.dimension(stem, name, low, caption)
    return build.slide(stem, name, SliderRange(min(max(value, low), high), low, high, steps_of(values)), caption)


def _problems(motion: Motion, chosen: ChosenSides) -> Iterator[Problem]:
    """Yield all that no construction of circles, lines and ratios says."""
    for body in motion.structure.bodies:
        for driven in body.driven:
            if not is_driven_constructed(driven):
                yield Problem(driven.pair.name, f"a driven {driven.pair.title} has no construction", _TABLE)
    free: set[str] = set()  # links whose turns no driver tells
    for solver in motion.solving_order.solvers:
        if as_dyad(solver):
            free.update(solver.group.links)
            if not chosen.is_told(solver.index):
                what = "it passes to its other mode, and several drivers say when"
                yield Problem(_called(solver), what, _TABLE)
        elif not is_constructed(solver) and not is_train(solver):
            yield Problem(_called(solver), _why_not(solver), _TABLE)
        else:
            for link in sorted({name for pair in solver.group.outer for name in pair.members} & free):
                if not chosen.can_count(link):
                    yield Problem(link, "its full turns cannot be counted by the driver's", _TABLE)


def _called(solver: GroupSolver) -> str:
    return f"the group of {', '.join(solver.group.links)}"


def _why_not(solver: GroupSolver) -> str:
    """Say why a group has no construction here."""
    group = solver.group
    pairs = (*group.inner, *group.outer)
    kinds = sorted({pair.title for pair in pairs if pair.held == 1 and not as_dyad(solver)})
    if len(group.bodies) > 1 and not kinds:
        return f"it is of class {group.class_}: no circles and lines give it one after the other"
    return f"there is no construction for {', '.join(kinds) or 'its pairs'} of this kind"


def _constructed(
    build: Construction, motion: Motion, shown: PosedMechanism, sliders: Mapping[str, str], chosen: ChosenSides
) -> PlacedBodies:
    """Add all links, the driven ones of the frame first."""
    order, size = motion.solving_order, motion.size
    links = {name: link_points(build, name, own) for name, own in shown.points.items()}
    pairs = (*shown.mechanism.written_pairs, *order.pairs.values())
    sides = PairSides(build, links, motion.followed.given.ends, pairs, size)
    placed = PlacedBodies(build, links)
    for body in motion.structure.bodies:
        placed.join(body, inside_body(build, body, sides, sliders))
    placed.hold(motion.structure.ground, None)
    for solver in order.solvers:
        _add_group(placed, sides, solver, chosen)
    return placed


def _add_group(placed: PlacedBodies, sides: PairSides, solver: GroupSolver, chosen: ChosenSides) -> None:
    dyad = as_dyad(solver)
    if dyad is None:
        add = add_train if is_train(solver) else add_mounted
        add(placed, sides, solver, lambda link: chosen.counted(link, placed.angle(link)))
        for link in solver.group.links:
            chosen.note_counted(placed.angle(link))
        return
    for body in dyad.bodies:
        if body not in solver.group.bodies:
            placed.join(body, {body.links[0]: InsideBody(PolarSum(), Angle())})
    index = dyad.letters[1]
    mode = chosen.mode(solver.index, index) if dyad.modes == 2 else ""
    CONSTRUCTIONS[dyad.name](DyadParts(placed, sides, dyad, index, mode))


# What rounding leaves of values, as a part of their range: one at its end seems beyond it by so much.
_ROUNDING = 1e-9


# Points nearer to each other than this part of the size are one.
_SAME = 1e-9


def slider_values(shown: PosedMechanism, motion: Motion) -> tuple[Mapping[str, float], tuple[str, ...]]:
    """Return where sliders begin, and the drivers whose ranges end before that.

    Values are by driver, radians or lengths. An angle beyond its range is told by another one that differs by whole
    turns and is the same pose, which it is not where wheels turn with it. Any other value beyond becomes that end of
    the range which is nearest.
    """
    rows = {name: np.ravel(drive.value) for name, drive in motion.drives.items()}
    wanted = {name: shown.values.get(name, float(row[0])) for name, row in rows.items()}
    lifted = {name: turned_within(value, rows[name]) if motion.structure.driven_angles[name] else value
              for name, value in wanted.items()}  # fmt: skip
    if lifted != wanted and not _is_visible(shown, lifted):
        lifted = wanted
    found = {name: float(np.clip(value, rows[name].min(), rows[name].max())) for name, value in lifted.items()}
    return found, tuple(
        name for name, value in found.items() if abs(value - lifted[name]) > _ROUNDING * np.ptp(rows[name])
    )


def _is_visible(shown: PosedMechanism, values: Mapping[str, float]) -> bool:
    """Return whether the pose at values is the one that is shown."""
    try:
        other = posed_mechanism(shown.mechanism, values)
    except (InvalidInput, NotAssembled):
        return False
    size = shown.mechanism.geometry.size
    return all(
        abs(shown.place(link, letter) - other.place(link, letter)) <= _SAME * size
        for link, own in shown.points.items()
        for letter in own
    )


# The day that every file in the archive bears, so that the same mechanism makes the same bytes: the earliest there is.
_DAY = (1980, 1, 1, 0, 0, 0)


class GeogebraFile(Writable):
    """An archive with the construction in it."""

    name: ClassVar[str] = "geogebra"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra file"
    suffix: ClassVar[str] = ".ggb"

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput listing all groups that have no construction."""
        build = construction_of(shown)
        text = xml_of(build, shown.mechanism.title, window_of(ranged_motion(shown)))
        content = BytesIO()
        with ZipFile(content, "w") as archive:
            entry = ZipInfo("geogebra.xml", _DAY)
            entry.compress_type = ZIP_DEFLATED
            archive.writestr(entry, text)
        return Exported(content.getvalue(), self.name, notes_of(shown, build))


FORMAT = GeogebraFile()


class GeogebraCommands(Writable):
    """The list of commands."""

    name: ClassVar[str] = "geogebra-commands"
    program: ClassVar[str] = "GeoGebra"
    title: ClassVar[str] = "GeoGebra commands"

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the commands. Raises InvalidInput listing all groups that have no construction."""
        build = construction_of(shown)
        text = "\n".join(build.lines) + "\n"
        return Exported(text.encode(), self.name, notes_of(shown, build))


COMMANDS = GeogebraCommands()


def notes_of(shown: PosedMechanism, build: Construction) -> tuple[str, ...]:
    """Return what does not come across."""
    return tuple(_notes(shown, build))


def _notes(shown: PosedMechanism, build: Construction) -> Iterator[str]:
    mechanism = shown.mechanism
    loads = len(mechanism.loads) + len(mechanism.frictions) + len(mechanism.pretensions)
    kinds = ((len(mechanism.masses), "mass", "masses"), (loads, "load", ""), (len(mechanism.outlines), "outline", ""))
    if left := ", ".join(count_phrase(count, one, many) for count, one, many in kinds if count):
        yield f"left out: {left}"
    for lead in mechanism.prescribed_motions.values():
        yield f"what leads {lead.name} is not in the construction: its coordinates have sliders of their own"
    changing = [step.name for step in build.steps if step.look == "helper" and step.caption and "mode" in step.caption]
    for name in changing:
        yield f"{name} changes where the links are in line, as the motion does: with other lengths set it to 1 or -1"
    for name in build.beyond:
        yield f"{name} begins at the end of its range: the pose that is asked for, or drawn, lies beyond"
    for name, slider in build.driven.items():
        if not build.is_slider(slider):
            yield f"{name} has a single value: it is a number to be changed"
