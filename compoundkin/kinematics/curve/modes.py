"""Assembly modes at the reference pose: stated by a call or a drawing, by default, or out of all configurations."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, suggestion
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series, as_series, constant
from compoundkin.kinematics.block import Block, size_in
from compoundkin.kinematics.configuration import BETWEEN, ONLY, Configuration, label
from compoundkin.kinematics.curve.closed_states import COMPARED, ClosedStates, every_state
from compoundkin.kinematics.curve.driver_path import DriverPath, first_of
from compoundkin.kinematics.curve.group_paths import Followed
from compoundkin.kinematics.driver_values import fit
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.solving_order import SolvingOrder, residual
from compoundkin.model.geometry import vector
from compoundkin.structure.four_bars import FourBarLoops, Place

# What chose an assembly mode, in words.
CHOSEN_BY = {
    "sign": "chosen by sign",
    "drawing": "nearest to the drawing",
    "hint": "nearest to the hint",
    "default": "taken by default",
    "redundant": "in which the redundant pairs close",
    "number": "chosen by number",
    "configuration": "that of the configuration given",
    "only one": "the only one",
}


@dataclass(frozen=True)
class GroupMode:
    """The assembly mode of a group in a motion, and what chose it.

    `sign` is that at the first pose, +1 or -1, an array of them for several designs, None where a group has one mode
    or its modes have no sign.
    """

    links: tuple[str, ...]
    sign: int | Number | None
    chosen: str

    def __repr__(self) -> str:
        signs = np.unique(self.sign) if self.sign is not None else ()
        told = " or ".join(f"{int(sign):+d}" for sign in signs)
        return f"GroupMode({', '.join(self.links[:2])}: {f'{told}, ' if told else ''}{self.chosen})"


def modes_of(
    solving_order: SolvingOrder,
    chosen_by: Mapping[int, str],
    sign: Callable[[int, Number, Number], Number],
    shape: tuple[int, ...],
) -> dict[str, GroupMode]:
    """Return the mode of every group by its name in configurations. Designs are in a shape."""
    rows = np.arange(int(np.prod(shape)))[:, None]
    found = {}
    for solver in solving_order.solvers:
        signs = None
        if solver.modes == 2:
            each = np.broadcast_to(sign(solver.index, rows, np.zeros((1, 1))), rows.shape)
            signs = each.astype(int).reshape(shape)[()]
        chosen = CHOSEN_BY.get(chosen_by.get(solver.index, ""), "found")
        found[label(solving_order.structure, solver.index)] = GroupMode(solver.group.links, signs, chosen)
    return found


def signs_of(
    solving_order: SolvingOrder, modes: Mapping[str, int] | str | Configuration | None = None
) -> dict[int, int]:
    """Return the modes chosen by sign, by group. Those of the call go before those of the mechanism."""
    mechanism = solving_order.structure.mechanism
    if isinstance(modes, Configuration):
        return {}
    if isinstance(modes, str):
        written = {link: mode.sign for mode in mechanism.modes for link in mode.links}
        return {**_by_group(solving_order, written), **read_name(solving_order, modes)}
    called, written = dict(modes or {}), {link: mode.sign for mode in mechanism.modes for link in mode.links}
    return {**_by_group(solving_order, written), **_by_group(solving_order, called)}


def branches_of(solving_order: SolvingOrder, branch: Mapping[str, Any] | None) -> dict[int, tuple[float, ...]]:
    """Return at which driver values groups go over to their other branch. Raises InvalidInput for what is none."""
    where = {link: solver for solver in solving_order.solvers for link in solver.group.links}
    found: dict[int, tuple[float, ...]] = {}
    for name, values in (branch or {}).items():
        solving_order.structure.mechanism.link(name)
        if name not in where or not where[name].modes_may_meet:
            raise InvalidInput(Problem(f"branch.{name}", "the group of this link has no change points"))
        numbers = np.ravel(real_numbers(f"branch.{name}", values))
        if not np.isfinite(numbers).all():
            raise InvalidInput(Problem(f"branch.{name}", "a driver value is not finite"))
        k = where[name].index
        found[k] = (*found.get(k, ()), *numbers.tolist())
    return found


def _by_group(solving_order: SolvingOrder, modes: Mapping[str, int]) -> dict[int, int]:
    signs: dict[int, int] = {}
    where = {link: solver.index for solver in solving_order.solvers for link in solver.group.links}
    for name, sign in modes.items():
        solving_order.structure.mechanism.link(name)
        if name not in where:
            raise InvalidInput(Problem(f"modes.{name}", "this link is driven or fixed: it has no assembly mode"))
        if sign not in (1, -1) and not (
            solving_order.solvers[where[name]].is_numbered and isinstance(sign, int) and sign > 0
        ):
            raise InvalidInput(Problem(f"modes.{name}", f"an assembly mode is +1 or -1, not {sign!r}"))
        if signs.setdefault(where[name], sign) != sign:
            raise InvalidInput(Problem(f"modes.{name}", "another link of its group has the opposite mode"))
    return signs


def read_name(solving_order: SolvingOrder, name: str) -> dict[int, int]:
    """Return the signs and numbers that a name gives to groups. Raises InvalidInput for parts that name none."""
    return (
        dict(_read(solving_order, part.strip()) for part in name.split(BETWEEN.strip())) if name.strip() != ONLY else {}
    )


def _read(solving_order: SolvingOrder, part: str) -> tuple[int, int]:
    known = dict(_labels(solving_order))
    for text, k in known.items():
        mode = _mode(solving_order.solvers[k], part.removeprefix(text)) if part.startswith(text) else None
        if mode is not None:
            return k, mode
    what = f"{part!r} is no configuration of a group"
    raise InvalidInput(Problem("modes", what, suggestion(part, list(known)) + " with +, - or a number from 1"))


def _labels(solving_order: SolvingOrder) -> Iterator[tuple[str, int]]:
    for solver in solving_order.solvers:
        if solver.modes != 1:
            yield label(solving_order.structure, solver.index), solver.index


def _mode(solver: GroupSolver, text: str) -> int | None:
    if solver.is_numbered:
        return int(text) if text.strip().isdecimal() and int(text) > 0 else None
    return {"+": 1, "-": -1}.get(text)


@dataclass(frozen=True)
class StatedModes:
    """Where a mechanism is shown, to which the nearest mode is chosen.

    `source` is what shows it: `configuration`, `hint` or `drawing`. The drivers' values at which it is shown are read
    off the `poses` of links, else off the points `beside` them.
    """

    source: str
    points: Mapping[str, Number]
    poses: Mapping[str, Pose]
    beside: Mapping[str, Number]


def stated_by(
    solving_order: SolvingOrder,
    modes: Mapping[str, int] | str | Configuration | None = None,
    hint: Mapping[str, object] | None = None,
) -> StatedModes:
    """Return where a call shows the mechanism, else its drawing. A name of modes is one at the motion's first pose.

    Raises InvalidInput for a configuration of another mechanism, and for hints that do not fit.
    """
    mechanism, relaxation = solving_order.structure.mechanism, solving_order.structure.relaxation
    if isinstance(modes, Configuration) and list(modes.structure.mechanism.links) != list(mechanism.links):
        raise InvalidInput(Problem("modes", "the configuration is one of another mechanism"))
    hinted = read_hint(solving_order, hint)
    if isinstance(modes, Configuration):
        return StatedModes("configuration", modes.points, modes.poses, modes.points)
    if hinted:
        return StatedModes("hint", hinted, {}, {})
    places, placed = _relaxed(solving_order)
    points = {**places, **mechanism.sketch}
    if isinstance(modes, str):
        return StatedModes("drawing", points, {}, {})
    poses = placed if relaxation and not mechanism.sketch else mechanism.drawn_poses
    return StatedModes("drawing", points, poses, mechanism.geometry.sketch)


def _relaxed(solving_order: SolvingOrder) -> tuple[Mapping[str, Number], Mapping[str, Pose]]:
    """Return where what is redundant in an overconstrained mechanism was found: places of points, poses of links.

    They are those of the first design. Of designs of other sizes only a drawing shows where their points are, or else
    the first design, as large as they are.
    """
    relaxation, geometry = solving_order.structure.relaxation, solving_order.structure.mechanism.geometry
    sizes = geometry.sizes
    if relaxation is None or (np.ndim(sizes) and solving_order.structure.mechanism.sketch):
        return {}, {}
    if not np.ndim(sizes):
        return relaxation.places, relaxation.poses
    ratio = sizes / sizes.flat[0]
    poses = {name: pose if pose is FIXED else Pose(constant(pose.z.c[0] * ratio), pose.u, pose.theta)
             for name, pose in relaxation.poses.items()}  # fmt: skip
    return {letter: place * ratio for letter, place in relaxation.places.items()}, poses


def read_hint(solving_order: SolvingOrder, hint: Mapping[str, object] | None) -> dict[str, Number]:
    """Return a hint as planar vectors. Raises InvalidInput for points that the mechanism does not have."""
    letters = solving_order.structure.mechanism.carriers
    wrong = [
        Problem(f"hint.{k}", f"there is no point {k!r}", suggestion(k, list(letters)))
        for k in hint or {}
        if k not in letters
    ]
    if wrong:
        raise InvalidInput(wrong)
    found = {k: vector(f"hint.{k}", v) for k, v in (hint or {}).items()}
    if not all(np.isfinite(v).all() for v in found.values()):
        raise InvalidInput(Problem("hint", "a point of the hint is not finite"))
    return found


# Twice a triangle's area below this part of the product of two sides is none: both modes close polygons of one area.
TIE = 1e-12


# Where the modes tie they are told apart by the first derivative of the area that is not zero, up to this one.
HIGHEST = 3


# The modes of a dyad meet where its margin is below this: a change point, but for rounding.
FLAT = 1e-12


# Configurations whose determinants differ by less than this part are mirror images but for rounding.
EVEN = 1e-9


# Stands for the largest of no heights at all.
TINY = 1e-300


class AtHome(Followed, Protocol):
    """What chooses the modes: the curve, its signs so far, the pose of the motion that is nearest to home."""

    @property
    def signs(self) -> dict[int, Number]:
        """The signs at home."""

    @property
    def pose_at_home(self) -> int:
        """The index of the pose at home."""


def default_sign(curve: AtHome, k: int, block: Block) -> Number:
    """Return the sign that a dyad has where nothing chooses. All before it is assembled in a block."""
    loops = curve.solving_order.four_bars.get(k)
    return 1 if loops is None else _open_sign(curve, k, loops, block)


def _open_sign(curve: AtHome, k: int, loops: FourBarLoops, block: Block) -> Number:
    """Return the sign with which a dyad's four-bar loop has the larger area.

    The polygon of a loop A, B, C, D has the area of half the vector product of its diagonals, so that its two modes, C
    on one or on the other side of BD, differ in how A lies beside BD: C lies opposite. Where A is on BD, it is where A
    will be that counts.
    """
    sides = _sides(curve, loops, block)[0]
    if np.size(sides) == 1 and (side := sides.item()):
        # of many links every check of an array counts
        return -1.0 if side < 0.0 else 1.0
    # higher derivatives change nothing of the first, which most often tells
    for order in (1, HIGHEST):
        if np.any(sides == 0.0):
            for rate in _sides(curve, loops, _ahead(curve, k, order))[1:]:
                sides = np.where(sides == 0.0, rate, sides)
    if np.any(sides == 0.0):
        first, second = (_at(curve, place, block).c[0] for place in (loops.first, loops.second))
        sides = np.where(sides == 0.0, _upward(second - first), sides)
    signs = np.where(sides < 0.0, -1.0, 1.0)
    alike = signs.size == 1 or np.all(signs == signs[0, 0])
    return float(signs.flat[0]) if alike else signs


def _ahead(curve: AtHome, k: int, order: int) -> Block:
    """Return what is solved before a group, with derivatives by increasing drivers. It is at the drawn pose.

    At a change point of the group a mode is that of the side to which the path goes: its drivers may decrease.
    """
    first, designs = curve.path.at_home(), np.arange(curve.path.designs)
    at = np.full((1, 1), curve.path.home), designs[:, None]
    sense = _senses(curve.path, designs)
    if any(np.any(one < 0.0) for one in sense.values()):
        curve.signs[k] = 1
        margin = curve.run(first, 0, *at, upto=k + 1).margins[k]
        sense = {name: np.where(margin < FLAT, one, 1.0) for name, one in sense.items()}
    rates = {name: curve.solving_order.unit_in(first.ends, name) * sense[name] for name in first.drives}
    part = first.driven({name: (v[0], rates[name]) for name, v in first.drives.items()})
    return curve.run(part, order, *at, upto=k)


def regularity(solver: GroupSolver, state: Number, block: Block) -> Number:
    """Return how far configurations of a group are from being singular.

    They are closed in `block`, and compared with each other only. It is the determinant of the group's equations, of
    which another choice of unknowns changes a factor that all configurations share. Of two that are mirror images it is
    a little larger for the one that stands higher.
    """
    determinant = np.abs(np.linalg.det(equations_of(solver).matrix(state, block)))
    places = [block.world[link].z.c[0] for link in solver.group.links]
    middle = sum(places[1:], places[0]) / len(places)
    heights = middle.imag + EVEN * middle.real
    return determinant * (1.0 + EVEN * heights / np.nanmax(np.abs(heights), initial=TINY))


def _senses(path: DriverPath, designs: Number) -> dict[str, Number]:
    """Return in which sense each driver goes on from home, +1 or -1. It is +1 for one that rests."""
    home = np.full(len(designs), path.home)
    # from the end of a path it goes back
    back = path.home == path.ends[1] != path.ends[0]
    part = path.behind(designs, home) if back else path.pick(designs, home)
    return {name: np.where((-v[1] if back else v[1]) < 0.0, -1.0, 1.0) for name, v in part.drives.items()}


def _sides(curve: AtHome, loops: FourBarLoops, block: Block) -> list[Number]:
    """Return on which side of the line through the outer pins the opposite pin lies, with derivatives; 0 for none.

    Of several opposite pins it is the one that makes the largest area.
    """
    first, second = _at(curve, loops.first, block), _at(curve, loops.second, block)
    line = second - first
    found: list[Number] = [0.0] * (block.order + 1)
    most: Number = 0.0
    for place in loops.opposite:
        arm = _at(curve, place, block) - first
        area = line.cross(arm)
        scale = TIE * np.abs(line.c[0]) * np.abs(arm.c[0])
        values = [np.where(np.abs(c) > scale, c, 0.0) for c in (*area.c, *[0.0] * (block.order - area.order))]
        if len(loops.opposite) == 1:
            return values
        largest = np.abs(area.c[0]) > most
        found = [np.where(largest, value, kept) for value, kept in zip(values, found, strict=True)]
        most = np.fmax(most, np.abs(area.c[0]))
    return found


def _at(curve: AtHome, place: Place, block: Block) -> Series:
    """Return where a point is, its place on its link being that of the pose at home."""
    mechanism = curve.solving_order.structure.mechanism
    point = fit(curve.path.knots.shape)(mechanism.geometry.points[place.link][place.letter])
    varies = np.ndim(point) > 0 and point.shape[1] > 1
    return as_series(block.world[place.link].at(point[:, [curve.pose_at_home]] if varies else point))


def _upward(line: Number) -> Number:
    """Return the sign with which the inner pin is the higher of the two, or else the one farther right."""
    return np.where(line.real != 0.0, -line.real, line.imag)


# Newton is given more steps here than when tracking: a random start is far away.
STEPS = 40


# and no step longer than this (of the size, or radians): from near a limit position it would lead anywhere.
LONGEST = 0.3


# What the orientation of a link of one drawn point counts (a radian by so many squared sizes): it decides where points
# are where they are drawn in either mode, and nothing else.
TURNED = 1e-6


# Squared distances that differ by less than this part of them, or of the squared size, are rounding.
TIED = 1e-9, 1e-24


# What is drawn within this part of the size of an outer contact is drawn there; an inner one must be nearer by as much.
NEARER = 1e-6


Letters = list[tuple[str, str]]


def drawn_letters(solving_order: SolvingOrder, solver: GroupSolver, shown: StatedModes) -> Letters:
    """Return the letters that are shown on a group's links, with their links."""
    links = solving_order.structure.mechanism.links
    return [(link, letter) for link in solver.group.links for letter in links[link].points if letter in shown.points]


def distance(solving_order: SolvingOrder, letters: Letters, shown: StatedModes, block: Block) -> Number:
    """Return the summed squared distances of a group's points from where they are shown.

    Where only one point of a link is shown, but its orientation is told, that counts a little too.
    """
    points = solving_order.structure.mechanism.geometry.points
    total: Number = 0.0
    for link, letter in letters:
        gap = block.world[link].at(first_of(points[link][letter])).c[0] - first_of(shown.points[letter])
        total = total + np.abs(gap) ** 2
    links = [link for link, _ in letters if link in shown.poses]
    for link in links:
        if links.count(link) == 1:
            gap = block.world[link].u.c[0] - first_of(shown.poses[link].u.c[0])
            total = total + TURNED * (size_in(block.ends, solving_order.size) * np.abs(gap)) ** 2
    return total


def nearest_sign(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: StatedModes, default: Callable[[], Number]
) -> tuple[Number, bool]:
    """Return the sign of a dyad nearest to what is shown.

    It is a number, or an array (designs, 1), and the default one where both are alike; whether they are not is told
    too. Where the dyad closes redundant pairs, these choose.
    """
    letters, closing, cost = drawn_letters(solving_order, solver, shown), solving_order.closing(solver), []
    for sign in (1, -1):
        trial = block.copy()
        solver.close(trial, sign)
        cost.append(
            residual(closing, trial, solving_order.size) if closing else distance(solving_order, letters, shown, trial)
        )
    rounding = 0.0 if closing else TIED[1] * size_in(block.ends, solving_order.size) ** 2
    tied = np.abs(cost[1] - cost[0]) <= TIED[0] * np.maximum(*cost) + rounding
    best = np.where(cost[1] < cost[0], -1.0, 1.0)
    if np.any(tied) and not closing:
        best = np.where(tied, default(), best)
    if best.size == 1:
        return best.item(), bool(closing) or not tied.item()
    chosen = float(best.flat[0]) if np.all(best == best.flat[0]) else np.atleast_2d(best)
    return chosen, bool(closing) or not np.all(tied)


def first_state(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: StatedModes, number: int | None
) -> tuple[Number, str]:
    """Find a closed state of a group at a single pose, and its chooser.

    It is (designs, 1, width), NaN for designs without.

    With `number` it is that of the real configurations in their order, counted from 1. Raises NotAssembled where no
    design has any.
    """
    if number is not None:
        return _numbered(solver, block, number), "number"
    best, least, by = _nearest_state(solving_order, solver, block, shown)
    if not np.isfinite(least).any():
        raise NotAssembled(_unfound(solver))
    return best, by


def shows_inner(solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: StatedModes) -> bool:
    """Tell whether a configuration without a sign is the nearest to what is shown.

    All groups before are assembled in the block; of several designs it is so for one.
    """
    followed, letters = solver.followed(), drawn_letters(solving_order, solver, shown)
    if followed is None or not letters:
        return False
    outer: Number = np.inf
    for sign in (1, -1):
        trial = block.copy()
        solver.close(trial, sign)
        outer = np.fmin(outer, np.sqrt(distance(solving_order, letters, shown, trial)))
    nearer = NEARER * size_in(block.ends, solving_order.size)
    if np.all(outer < nearer):
        return False
    inner = np.sqrt(_nearest_state(solving_order, followed, block, shown)[1])
    return bool(np.any(inner < outer - nearer))


def _nearest_state(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: StatedModes
) -> tuple[Number, Number, str]:
    """Return the closed states nearest to what is shown, what they cost (inf where there are none), and the chooser."""
    letters, designs, count = drawn_letters(solving_order, solver, shown), block.shape[0], 0
    search = ClosedStates(solving_order, solver, block, shown.points, drawn=bool(letters))
    best, least = np.full((designs, 1, search.equations.width), np.nan), np.full((designs, 1), np.inf)
    for batch in search.batches():
        found = search.equations.newton(batch, block, STEPS, LONGEST)
        trial = block.copy()
        solver.close(trial, found.state)
        count += 1 if designs > 1 else len(batch)
        cost = distance(solving_order, letters, shown, trial) if letters else -regularity(solver, found.state, trial)
        state, cost = found.state, np.where(found.closed, cost, np.inf)
        if designs == 1:
            first = int(np.argmin(cost))
            state, cost = state[first : first + 1], cost[first : first + 1]
        best = np.where((cost < least)[..., None], state, best)
        least = np.minimum(cost, least)
        enough = (letters and search.complete and count == 1) or count >= COMPARED
        if enough and np.isfinite(least).all():
            break
    return best, least, "drawing" if letters else "default"


def _numbered(solver: GroupSolver, block: Block, number: int) -> Number:
    every = every_state(solver, block)
    links = ", ".join(solver.group.links)
    if every is None:
        what = "its configurations are not known one by one, so that none has a number"
        raise InvalidInput(Problem(f"group of {links}", what, "draw its points, or give a hint"))
    if number > len(every):
        remedy = "configurations() lists them"
        raise NotAssembled(Problem(f"group of {links}", f"it has {len(every)} configurations, not {number}", remedy))
    return every[number - 1]


def _unfound(solver: GroupSolver) -> Problem:
    return Problem(
        f"group of {', '.join(solver.group.links)}",
        "no assembled pose was found from the drawing or from random starts",
        "draw its points near an assembled pose, or give a hint",
    )
