"""Solving: from a mechanism and driver values to a motion, block by block, with what it warns of."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import product
from math import factorial
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.buffers import keep_freed_memory, without_collection
from compoundkin.base.errors import (
    ChangePointWarning,
    DrawnBeyondEnd,
    FewDigits,
    InvalidInput,
    LikelySlip,
    NearChangePoint,
    NotAssembled,
    NotDetermined,
    Problem,
    UnassembledPoses,
    warn,
)
from compoundkin.base.linear import one_thread
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import BLOCK, Block, JoinedBlocks, blocks, places, poses_at, size_in
from compoundkin.kinematics.configuration import Configuration, dimensions_at, numbers_at, placed_at
from compoundkin.kinematics.curve.change_points import NEAR, near_groups, pass_through
from compoundkin.kinematics.curve.configuration_curve import leaping_groups
from compoundkin.kinematics.curve.double_roots import NEARLY, expanded
from compoundkin.kinematics.curve.driver_path import drawn_value
from compoundkin.kinematics.curve.followed_poses import FollowedPoses, follow
from compoundkin.kinematics.curve.modes import StatedModes, branches_of, signs_of, stated_by
from compoundkin.kinematics.driver_values import Inputs, by_name, inputs, times_of
from compoundkin.kinematics.motion import LinkErrors, Motion, errors_at
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import HIGHEST_ORDER
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import constraint_scales
from compoundkin.structure import decompose
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.redundancy import mobility_analysis
from compoundkin.structure.redundancy.constraint_equations import ROUNDED


@checked
@one_thread
def solve(
    mechanism: Mechanism | Structure,
    values: Any = None,
    *,
    time: Any = None,
    speed: Any = None,
    acceleration: Any = None,
    jerk: Any = None,
    order: int = 2,
    modes: Mapping[str, int] | str | Configuration | None = None,
    hint: Mapping[str, Any] | None = None,
    branch: Mapping[str, Any] | None = None,
) -> Motion:
    """Solve a mechanism group by group, for position and its derivatives. They go up to `order` (0 to 3).

    `values` gives each driver's coordinate (radians or lengths; arrays, the last axis the motion); `speed`,
    `acceleration`, `jerk` its rates, a number for a single driver or a mapping by name. What is not given
    comes from the mechanism's drives; a driver of a pin without values makes a full turn.

    In time: at the times `time` (seconds, any order; the last axis is the motion) drivers with a law are where it
    takes them, with its derivatives; others move from their single value (0 where they have none) by their speed,
    acceleration and jerk. Where `time` is not given, drivers with laws that are given no values move at the mechanism's
    own times, else over the range on which their laws agree.

    The assembly mode of each group is that of `modes` (a link of the group: +1 or -1, or its configuration's number),
    else the one nearest to `hint` (points near their places at the first pose), else nearest to the mechanism's
    drawing. By default a dyad that closes a four-bar loop of pins stands open at the first pose (the larger area of
    its loop), another has mode +1, a larger group the configuration farthest from being singular. `modes` may also be
    one of `configurations()`, from which the motion then starts, or the name of one at the first pose.

    Through a change point the motion goes on smoothly. `branch` names those at which a group goes over to its other
    branch instead, by a link of the group and the driver's value there, or several (within 2.5 degrees of a driver's
    angle, or 0.09 sizes): `branch={"rocker": np.pi}`. `singularities` lists them.

    A mechanism that moves though it is overconstrained is solved without what is redundant, which is then checked.

    Raises NotDetermined where the structure cannot be solved, InvalidInput for values that do not fit,
    NotAssembled where a group has no pose at all or a redundant pair opens; warns UnassembledPoses where some poses do
    not close, DrawnBeyondEnd where the drawing is beyond an end of a guide, ChangePointWarning where drivers rest
    exactly at a change point (the smooth motion goes on), NearChangePoint where a rounding of the dimensions decides
    which branch is taken, FewDigits where rates next to a limit position have fewer
    than three digits; those without any are NaN.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> solve(crank, {"crank": [0.0, np.pi / 2]}, speed=3.0).points["B"].velocity.xy.round(12).tolist()
    [[0.0, 6.0], [-6.0, 0.0]]
    """
    _check_order(order)
    solving_order = solving_order_of(mechanism)
    with np.errstate(all="ignore"):
        values = by_name(solving_order.structure.mechanism, values)
        times = times_of(solving_order.structure.mechanism, values, time)
        given = inputs(solving_order, values, speed, acceleration, jerk, times, order)
        signs, shown = signs_of(solving_order, modes), stated_by(solving_order, modes, hint)
        told = solved(solving_order, given, signs, shown, order, branches_of(solving_order, branch))
    motion = told.motion if times is None else replace(told.motion, time=times)
    if times is None:
        warn_of_degrees(motion.structure, given)
    _warn(motion, told.poor)
    return motion


def solved(
    solving_order: SolvingOrder,
    given: Inputs,
    signs: Mapping[int, int],
    shown: StatedModes,
    order: int,
    branches: Mapping[int, tuple[float, ...]] | None = None,
) -> Description:
    """Return the motion of some inputs. Raises as `solve`, and warns of nothing."""
    with diagnosing(solving_order.structure):
        followed = follow(solving_order, given, signs, shown, branches)
    told = without_imprecise_rates(*solve_all_blocks(followed, order))
    if solving_order.structure.relaxation:
        try:
            check_redundant(told.motion)
        except NotAssembled as error:
            closing = _closing_signs(told.motion.followed, signs)
            if closing is None:
                raise error
            followed = follow(solving_order, given, {**signs, **closing}, shown, branches)
            followed.curve.chosen_by.update(dict.fromkeys(closing, "redundant"))
            told = without_imprecise_rates(*solve_all_blocks(followed, order))
    if branches:
        _check_branches(told.motion)
    return told


# So many groups chosen by a drawing are tried in their other modes where redundant pairs open.
MOST_TRIED = 6


def _closing_signs(followed: FollowedPoses, signs: Mapping[int, int]) -> dict[int, int] | None:
    """Return other modes than the drawing's of as few groups as may be, in which all redundant pairs close.

    A drawing of other dimensions may lie nearer to a mode in which a pair that closes later opens. None where none do.
    """
    curve = followed.curve
    two = {solver.index for solver in curve.solving_order.solvers if solver.modes == 2}
    free = [k for k, by in curve.chosen_by.items() if by in ("drawing", "default") and k in two]
    asked = [k for k in free if np.ndim(curve.signs[k]) == 0][:MOST_TRIED]
    own = tuple(int(curve.signs[k]) for k in asked)
    every = (dict(zip(asked, one, strict=True)) for one in product((1, -1), repeat=len(asked)))
    for other in sorted(every, key=lambda one: sum(a != b for a, b in zip(one.values(), own, strict=True))):
        trial = follow(curve.solving_order, followed.given, {**signs, **other}, curve.shown)
        try:
            motion, _ = solve_all_blocks(trial, 0)
            check_redundant(motion)
        except NotAssembled:
            continue
        if np.any(motion.failed == 0):
            return other
    return None


def _check_branches(motion: Motion) -> None:
    """Raise InvalidInput where a motion has no change point at which it is to go over to another branch."""
    wrong = []
    curve = motion.followed.curve
    for k, (value, known) in curve.unknown_branches().items():
        link = motion.structure.groups[k].links[0]
        shown = [_shown(motion.structure, curve.path.moving[0], v) for v in (value, *known)]
        remedy = f"it has change points at {', '.join(shown[1:])}" if known else "it has none along this motion"
        wrong.append(Problem(f"branch.{link}", f"{shown[0]} is at no change point of its group", remedy))
    if wrong:
        raise InvalidInput(wrong)


def _shown(structure: Structure, driver: str, value: float) -> str:
    """Return a driver's value in words: degrees or a length."""
    is_angle = structure.driven_angles[driver]
    return f"{np.rad2deg(value) if is_angle else value:.6g}{' degrees' if is_angle else ''}"


def _warn(motion: Motion, poor: int) -> None:
    """Warn of poses not assembled, of rates with few digits, of rests at change points, of drawings beyond ends."""
    if motion.solving_order.guide_ends.pairs:
        _warn_of_drawing(motion.followed)
    if any(motion.followed.rests.values()):
        warn(_rest(motion), ChangePointWarning)
    for k, missed in motion.followed.curve.near_misses.items():
        for one in [one for one in missed if abs(one.least) < NOTED][:1]:
            warn(_near_miss(motion, k, one.design, one.place), NearChangePoint)
    missing = int(np.count_nonzero(motion.failed))
    if missing:
        how_many = f"{missing} of {motion.failed.size} poses cannot be assembled"
        warn(f"{how_many}: Motion.assembled masks them, gaps() explains", UnassembledPoses)
    if poor:
        how_many = f"rates at {poor} of {motion.failed.size} poses have fewer than three digits"
        warn(f"{how_many}, next to limit positions: Motion.error(order) tells where", FewDigits)


def _rest(motion: Motion) -> str:
    """Return where drivers rest at a change point for the first time, and which branch is taken from there."""
    group, (design, pose) = next((k, found[0]) for k, found in motion.followed.rests.items() if found)
    values = {
        name: np.broadcast_to(v[0], motion.failed.shape)[design, pose] for name, v in motion.inputs.drives.items()
    }
    told = (f"{name} = {_shown(motion.structure, name, v)}" for name, v in values.items())
    links = ", ".join(motion.structure.groups[group].links)
    where = f"at pose {pose}, {', '.join(told)}, the drivers rest at a change point of {links}"
    return f"{where}: either branch may go on from there, and the smooth motion is taken"


# Where a discriminant, in parts of its scale, or the distance of pins, of the size, is below this and not zero, the
# eighth digit of the dimensions decides.
NOTED = 1e-8


def _near_miss(motion: Motion, k: int, design: int, place: float) -> str:
    """Return where a group comes within rounding of a change point, and what follows."""
    part = motion.followed.curve.path.pick(np.array([design]), np.array([place]))
    told = (f"{name} = {_shown(motion.structure, name, float(np.ravel(v[0])[0]))}" for name, v in part.drives.items())
    links = ", ".join(motion.structure.groups[k].links)
    what = "within 1e-8 of a change point (the squared sine between its branches, or pins apart), and turns back"
    return f"at {', '.join(told)}, {links} comes {what}: a rounding of the dimensions decides which branch it takes"


def _warn_of_drawing(followed: FollowedPoses) -> None:
    """Warn where the pose drawn, at the driver values it shows, is beyond an end of a guide."""
    solving_order, curve = followed.solving_order, followed.curve
    shown, given = curve.shown, followed.given
    drivers = solving_order.structure.driven
    if any(drawn_value(solving_order, given, name, shown.poses, shown.beside) is None for name in drivers):
        return
    designs = np.arange(given.designs)[:, None]
    with np.errstate(all="ignore"):
        block = curve.run(curve.path.at_home(), 0, np.full((1, 1), curve.path.home), designs)
        failed = np.broadcast_to(block.failed, block.shape).ravel()
        passed = [solving_order.guide_ends.passed(int(index), block, k) for k, index in enumerate(failed)]
    for reason in dict.fromkeys(one.reason for one in passed if one):
        warn(f"as it is drawn, {reason}", DrawnBeyondEnd)


def _check_order(order: int) -> None:
    """Raise InvalidInput for what is no order of derivatives."""
    if isinstance(order, bool) or not isinstance(order, int) or order not in range(HIGHEST_ORDER + 1):
        remedy = "0 position, 1 velocity, 2 acceleration, 3 jerk"
        raise InvalidInput(Problem("order", f"{order!r} is not an order", remedy))


def solving_order_of(mechanism: Mechanism | Structure) -> SolvingOrder:
    """Return the solving order of a mechanism, made once and kept with it."""
    owner = mechanism.mechanism if isinstance(mechanism, Structure) else mechanism
    solving_order: SolvingOrder | None = owner.__dict__.get("_solving_order")
    if solving_order is None:
        structure = mechanism if isinstance(mechanism, Structure) else decompose(mechanism)
        if structure.faults:
            problems = [Problem("structure", fault.text, fault.remedy) for fault in structure.faults]
            raise NotDetermined(problems, heading=f"{owner.title!r} cannot be solved{rank_diagnosis(structure)}")
        with without_collection():
            solving_order = owner.__dict__["_solving_order"] = SolvingOrder(structure)
    return solving_order


def starting_configuration(
    solving_order: SolvingOrder, values: Mapping[str, float], design: int
) -> Configuration | None:
    """Return the configuration in which `solve` begins at these values. None where it does not close there."""
    given = inputs(solving_order, values, None, None, None)
    try:
        followed = follow(solving_order, given, signs_of(solving_order), stated_by(solving_order))
    except NotAssembled:
        return None
    if followed.lost:
        followed = replace(followed, curve=followed.curve.with_returns())
    block = followed.run(followed.given, 0, *places(slice(0, given.designs), slice(0, given.poses)))
    if np.broadcast_to(block.failed, block.shape)[design, 0]:
        return None
    return _picked(solving_order.structure, values, block.world, (design, 0))


def first_configuration(motion: Motion, design: int) -> Configuration | None:
    """Return the configuration of the first assembled pose of a motion, without its modes. None where it has none."""
    known = np.flatnonzero(motion.failed[design] == 0)
    if not known.size:
        return None
    at = design, int(known[0])
    values = numbers_at({name: v[0] for name, v in motion.inputs.drives.items()}, at)
    return _picked(motion.structure, values, motion.poses, at)


def _picked(
    structure: Structure, values: Mapping[str, float], poses: Mapping[str, Pose], at: tuple[int, int]
) -> Configuration:
    return Configuration(structure, dict(values), placed_at(poses, at), {}, {}, dimensions_at(structure, *at))


def quietly_solved(structure: Structure, values: Any = None, order: int = 1, speed: Any = None) -> Motion:
    """Return what `solve` does, without its warnings. Raises as it does."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return solve(structure, values, speed=speed, order=order)


# Up to so many poses are solved at once: gathering blocks would copy more than the caches save.
WHOLE = 65536


def solve_all_blocks(followed: FollowedPoses, order: int) -> tuple[Motion, Number]:
    """Solve until no further change point is found, and nothing more is reached.

    Return also the poses whose rates may have lost their digits.
    """
    while True:
        found = solve_blocks(followed, order)
        near = found.near if followed.is_dense else found.near | near_groups(followed.curve)
        searched = pass_through(followed.curve, near) if near else followed.curve
        curve = searched if searched.flips.keys() != followed.curve.flips.keys() else None
        leaping = leaping_groups(followed.curve) if curve is None else []
        if leaping:
            curve = followed.curve.with_followed(leaping)
        if curve is None and followed.lost and not followed.curve.has_returns:
            curve = followed.curve.with_returns()
        if curve is not None:
            followed = replace(followed, curve=curve)
            continue
        return with_expanded(found, replace(followed, curve=searched), order)


def with_expanded(found: SolvedBlocks, followed: FollowedPoses, order: int) -> tuple[Motion, Number]:
    """Return a motion with its poses at change points and next to them, and the poses whose rates are doubtful."""
    if not found.nearly:
        return replace(found.motion, followed=followed), found.doubtful
    followed, (designs, index, poses) = expanded(followed, found.nearly, order)
    found.doubtful[designs, index] = False
    return replace(found.motion, followed=followed).mended(designs, index, poses), found.doubtful


class SolvedBlocks(NamedTuple):
    """A motion in the configuration of a curve.

    Also the groups near limit positions, those so near that they may need their double root, and the poses whose rates
    are doubtful.
    """

    motion: Motion
    near: set[int]
    nearly: set[int]
    doubtful: Number


def solve_blocks(followed: FollowedPoses, order: int) -> SolvedBlocks:
    """Solve block by block and gather."""
    keep_freed_memory()
    solving_order, given = followed.solving_order, followed.given
    structure, designs, poses = solving_order.structure, given.designs, given.poses
    near: set[int] = set()
    nearly: set[int] = set()
    where = np.zeros((designs, poses), dtype=bool)
    parts = list(blocks(designs, poses, WHOLE if designs * poses <= WHOLE else BLOCK))
    if len(parts) == 1:
        block = followed.run(given, order, *places(slice(0, designs), slice(0, poses)))
        failed = np.broadcast_to(block.failed, (designs, poses))
        near = _near(block)
        where |= doubtful(solving_order, given, block, near)
        motion = Motion(structure, order, given, dict(block.world), failed, followed)
        return SolvedBlocks(motion, near, _nearly(block) if near else near, where)
    store = JoinedBlocks(designs, poses)
    for d, m in parts:
        part = given.cut(d, m)
        block = followed.run(part, order, *places(d, m))
        store.take(block, d, m)
        here = _near(block)
        near |= here
        nearly |= _nearly(block) if here else here
        where[d, m] |= doubtful(solving_order, part, block, here)
    motion = Motion(structure, order, given, store.poses(), store.failed, followed)
    return SolvedBlocks(motion, near, nearly, where)


def _near(block: Block) -> set[int]:
    # of many links every check of an array counts
    near = ((k, margin < NEAR) for k, margin in block.margins.items())
    return {k for k, here in near if (here if np.size(here) == 1 else here.any())}


def _nearly(block: Block) -> set[int]:
    return {k for k, margin in block.margins.items() if np.any((margin >= 0.0) & (margin < NEARLY))}


# Whole numbers up to two turns may be radians that somebody counts; nobody counts beyond.
COUNTED = 4.0 * np.pi


# From here on every floating number is whole.
ALL_WHOLE = 2.0**52


# A motion in steps of half a radian, 29 degrees, shows next to nothing.
COARSE = 0.5


def warn_of_degrees(structure: Structure, given: Inputs) -> None:
    """Warn of drivers of angles whose values look like degrees."""
    for name, (values, *_) in given.drives.items():
        if structure.driven_angles[name] and look_like_degrees(values):
            told = f"{name!r} is driven in radians, and its values look like degrees"
            warn(f"{told}; write compoundkin.deg(values)", LikelySlip)


def look_like_degrees(values: Number) -> bool:
    """Tell whether radians are whole numbers far apart, as degrees are.

    >>> look_like_degrees(np.arange(0.0, 361.0, 5.0)), look_like_degrees(np.linspace(0.0, 20.0 * np.pi, 721))
    (True, False)
    >>> look_like_degrees(35.0), look_like_degrees(np.linspace(0.0, 100.0, 1001))
    (True, False)
    """
    ends = (values,) if np.ndim(values) == 0 else (values.flat[0], values.flat[-1])
    if not all(float(end).is_integer() for end in ends) or not COUNTED < max(map(abs, ends)) < ALL_WHOLE:
        return False
    return np.size(values) == 1 or bool(np.mean(np.abs(np.diff(np.ravel(values)))) >= COARSE)


def rank_diagnosis(structure: Structure) -> str:
    """Say what the dimensions make of an overconstrained mechanism. The words are to be added to a heading."""
    if not any(fault.kind == "over" for fault in structure.faults):
        return ""
    found = mobility_analysis(structure)
    return f" ({found.verdict})" if found.finite is not None or found.gap else ""


@contextmanager
def diagnosing(structure: Structure) -> Iterator[None]:
    """Raise NotDetermined with the reason where a group has no pose. Its dimensions are special there."""
    try:
        yield
    except NotAssembled as error:
        found = mobility_analysis(structure)
        if found.finite is None or found.finite == found.gruebler:
            raise error
        heading = f"{structure.mechanism.title!r} cannot be solved"
        raise NotDetermined(Problem("structure", found.verdict), heading=heading) from None


def check_redundant(motion: Motion) -> None:
    """Raise NotAssembled, naming them, unless every redundant pair is closed at all assembled poses."""
    opened = [(pair, opening(motion, pair)) for pair in motion.structure.redundant]
    wrong = [_problem(motion, pair, gap) for pair, gap in opened if np.any(gap > ROUNDED.closed * motion.sizes)]
    if wrong:
        raise NotAssembled(wrong, heading=f"{motion.mechanism.title!r} does not move like this")


def opening(motion: Motion, pair: Pair) -> Number:
    """Return the residual of a redundant pair at each pose (designs x poses).

    It is a length in the user's unit, an angle the arc of it at the mechanism's size; 0 where not assembled.
    """
    poses = tuple(motion.poses[name] for name in pair.members)
    held = pair.closure(motion.inputs.ends[pair.name], poses)
    parts = [one.c[0] / scale for one, scale in zip(held, constraint_scales(pair, motion.sizes), strict=True)]
    squares = sum(np.abs(np.broadcast_to(part, motion.failed.shape)) ** 2 for part in parts)
    return np.where(motion.failed == 0, np.sqrt(squares) * motion.sizes, 0.0)


def _problem(motion: Motion, pair: Pair, gap: Number) -> Problem:
    at = int(np.nanargmax(gap)) % max(motion.inputs.poses, 1)
    what = f"the pair opens by {float(np.nanmax(gap)):.6g} at pose {at}: other pairs do not hold it there"
    remedy = "the dimensions or the assembly mode do not allow this motion: draw an assembled pose"
    return Problem(pair.name, what, remedy)


# Where the margin, a squared sine, is above this rates have digits enough: a third derivative loses most, at a change
# point, where rounding is divided by the margin squared.
DOUBTFUL = 1e-6


# A group that tells no margin comes to a limit position where it is so many times as fast as the drivers: by the square
# root of the distance, so that it loses digits only far nearer.
FAST = 1e4


# Rates of which no more than this part is uncertain have three digits.
UNCERTAIN = 1e-3


class Description(NamedTuple):
    """A motion without lost rates, and at how many poses they have few digits."""

    motion: Motion
    poor: int


def doubtful(solving_order: SolvingOrder, part: Inputs, block: Block, near: Iterable[int]) -> Number:
    """Return the poses of a block whose rates may have lost digits.

    `near` are the groups with small margins.
    """
    found: Number = np.zeros((1, 1), dtype=bool)
    if not block.order:
        return found
    for k in near:
        found = found | (block.margins[k] < DOUBTFUL)
    silent = [solver for solver in solving_order.solvers if not solver.tells_margin]
    fast = FAST * _pace(solving_order, part) if silent else 0.0
    for name in (body.links[0] for solver in silent for body in solver.group.bodies):
        pose = block.world[name]
        for series, size in ((pose.u, 1.0), (pose.z, size_in(part.ends, solving_order.size))):
            found = found | (np.abs(series.c[1]) > fast * size) if series.order else found
    return found


def _pace(solving_order: SolvingOrder, part: Inputs) -> Number:
    """Return the speed of the fastest driver: radians, or parts of the size, per second."""
    fastest: Number = 0.0
    for name, values in part.drives.items():
        speed = values[1] if len(values) > 1 else 0.0
        fastest = np.maximum(fastest, np.abs(speed) / solving_order.unit_in(part.ends, name))
    return fastest


def without_imprecise_rates(motion: Motion, where: Number) -> Description:
    """Return a motion whose rates without digits are no numbers.

    Return also at how many poses they have fewer than three.

    `where` are the poses that may have such, (designs, poses).
    """
    designs, index = np.nonzero(where & (motion.failed == 0))
    if not len(designs) or not motion.order:
        return Description(motion, 0)
    part, s = motion.inputs.pick(designs, index.astype(float)), index[:, None].astype(float)
    with np.errstate(all="ignore"):
        errors = errors_at(motion.followed, part, motion.order, s, designs[:, None])
        poses = poses_at(motion.poses, motion.failed.shape, designs, index)
        allowed = _natural(poses, motion.order, size_in(part.ends, motion.size))
        lost = {name: [~(e <= a) for e, a in zip(found, allowed, strict=True)] for name, found in errors.items()}
        few = _any(errors, [UNCERTAIN * a for a in allowed]) & ~_any(errors, allowed)
    if not any(np.any(one) for found in lost.values() for one in found[1:]):
        return Description(motion, int(np.count_nonzero(few)))
    kept = {name: _accepted(pose, lost[name]) if name in lost else pose for name, pose in poses.items()}
    return Description(motion.mended(designs, index, kept), int(np.count_nonzero(few)))


def uncertain(motion: Motion) -> Number:
    """Return the poses at which some rates have fewer than three digits, (designs, poses)."""
    found: Number = np.zeros(motion.failed.shape, dtype=bool)
    with np.errstate(all="ignore"):
        allowed = _natural(motion.poses, motion.order, motion.sizes)
        for k in range(1, motion.order + 1):
            error = motion.error(k).reshape(motion.failed.shape)
            found = found | (np.isfinite(error) & ~(error <= UNCERTAIN * allowed[k]))
    return found


def _any(errors: LinkErrors, allowed: list[Number]) -> Number:
    """Return the poses at which any link's rates are more uncertain than is allowed."""
    found: Number = np.zeros((1, 1), dtype=bool)
    for link in errors.values():
        for error, most in zip(link[1:], allowed[1:], strict=True):
            found = found | ~(error <= most)
    return found


def _natural(poses: Mapping[str, Pose], order: int, size: Number) -> list[Number]:
    """Return the largest derivative of any link at each pose, in each order; no less than speeds to that power."""
    found, speed = list[Number](), 0.0
    for k in range(order + 1):
        largest: Number = 0.0
        for pose in poses.values():
            for series, unit in ((pose.z, 1.0), (pose.u, size)):
                value = np.abs(series.c[k]) * factorial(k) * unit if k < len(series.c) else 0.0
                largest = np.fmax(largest, np.where(np.isfinite(value), value, 0.0))
        speed = largest / size if k == 1 else speed
        found.append(np.maximum(largest, size * speed**k) if k else largest)
    return found


def _accepted(pose: Pose, lost: list[Number]) -> Pose:
    """Return a pose with what is lost, and all higher derivatives, no numbers."""

    def part(series: Series) -> Series:
        kept, gone = [series.c[0]], np.zeros((1, 1), dtype=bool)
        for k, here in enumerate(lost[1:], start=1):
            gone = gone | here
            kept.append(np.where(gone, np.nan, series.c[k] if k < len(series.c) else 0.0))
        return Series(tuple(kept))

    return pose.mapped(part)
