"""Singular poses along a motion: where they are, of which kind, what opens there and which branches meet.

They are found and examined by the equations of all pairs, not by the closed forms of groups that solved the motion. A
pose can be singular only where the block of some group is.

At a singular pose the tangents of branches are the real zeros of quadratic forms, the second derivatives of the
equations in the null space, projected on the left null space. With two null vectors and one left one that is a
quadratic equation, of two, one or no real roots.
Source: E. L. Allgower and K. Georg, Numerical Continuation Methods, Springer 1990, chapter 8.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.characteristics.outputs import chosen_outputs, outputs_of
from compoundkin.analysis.motion_equations import (
    REST,
    ZERO,
    EquationsAtPose,
    GroupBlock,
    MotionEquations,
    equations_at,
    idle_motions,
    null_spaces,
    without_motions,
)
from compoundkin.analysis.singular_places import ONE, SingularPlace, singular_places
from compoundkin.analysis.singularity import (
    ARCHITECTURE,
    CHANGE,
    DEAD,
    LIMIT,
    SHAKY,
    STILL,
    PoseTangent,
    Singularities,
    Singularity,
    Twist,
)
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.errors import ChangePointWarning, InvalidInput, UnassembledPoses
from compoundkin.base.linear import one_thread, zeros_of_forms
from compoundkin.base.poses import FIXED
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.extremes.dead_points import dead_points
from compoundkin.kinematics.extremes.motion_between import inputs_between, times_between
from compoundkin.kinematics.extremes.stretches import SAME_PLACE, closed_cycles
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure

# Second derivatives (along unit vectors) below this are zero, and so are discriminants by this part of
# theirs: poses, and with them null spaces, are known to some 1e-10.
FLAT = 1e-7
# A branch is confirmed by a step of this length (radians, parts of the unit) both ways, corrected: it deviates from its
# tangent by the square, so by a small part of the step.
STEP, DEVIATES = 1e-3, 0.2
# Beside the pose (of a pose) the motion shows which branch it takes: so near that it has not yet turned by 0.1.
BESIDE, ALONG = 0.01, 0.9
# Limit positions are polished so often.
POLISHED = 4


@checked
@one_thread
def singularities(what: Motion | Mechanism | Structure, outputs: Sequence[str] = ()) -> Singularities:
    """Return the singular poses along a motion, between its poses too, and the branches that meet there.

    A mechanism is solved over its drivers' own ranges. Dead points are those of `outputs` that are places, angles or
    displacements by name; without any, of those that the mechanism names, else of its links without a driver. Poses of
    several drivers are singular for the path on which they move. Raises UnknownName for an unknown output, and what
    `solve` raises.

    Source: C. Gosselin and J. Angeles, Singularity analysis of closed-loop kinematic chains, IEEE Trans. Robotics and
    Automation 6 (1990); E. L. Allgower and K. Georg, Numerical Continuation Methods, Springer 1990, chapter 8.

    >>> from compoundkin.files import load
    >>> print(singularities(load("parallelogram"), ["follower.angle"]).text())
    1 crank 0° (pose 0): change point of coupler, follower; 2 branches meet
      branch 1 (followed): crank 1, coupler shifts 30, follower 1
      branch 2: crank 1, coupler -2, follower -3
    2 crank 180° (pose 36): change point of coupler, follower; 2 branches meet
      branch 1 (followed): crank 1, coupler shifts 30, follower 1
      branch 2: crank 1, coupler 0.666667, follower -0.333333
    """
    motion = what if isinstance(what, Motion) else _solved(what)
    given = tuple(outputs)
    own = outputs_of(motion, chosen_outputs(motion, given))
    names = [one.coordinate for one in own if not one.is_point and one.rate]
    return _numbered(motion, [*_of_equations(motion), *_of_outputs(motion, names, bool(given))])


@checked
@one_thread
def singular_poses(motion: Motion) -> Singularities:
    """Return the singular poses along a motion without the dead points of its outputs. See `singularities`."""
    return _numbered(motion, _of_equations(motion))


def _numbered(motion: Motion, found: list[Singularity]) -> Singularities:
    found.sort(key=lambda one: (one.design, one.place, one.kind == DEAD))
    return Singularities(motion, tuple(replace(one, number=k) for k, one in enumerate(found, start=1)))


def _solved(what: Mechanism | Structure) -> Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        warnings.simplefilter("ignore", ChangePointWarning)
        return solve(what)


def _of_equations(motion: Motion) -> list[Singularity]:
    """Return limit positions, change points and stretches that are singular, in order."""
    system, found = MotionEquations(motion), list[Singularity]()
    with np.errstate(all="ignore"):
        cyclic = closed_cycles(motion) if motion.inputs.poses > 1 else np.zeros(motion.inputs.designs, dtype=bool)
        for design in np.flatnonzero(np.any(motion.failed == 0, axis=1)).tolist():
            mine = []
            for spot in singular_places(system, design):
                one = _examined(system, design, spot)
                if one is not None:
                    mine.append(one)
            last = motion.inputs.poses - 1.0
            if len(mine) > 1 and cyclic[design] and mine[0].place < SAME_PLACE and mine[-1].until > last - SAME_PLACE:
                # the end of a cycle is its beginning
                mine = mine[:-1] if mine[-1].place > last - SAME_PLACE else mine
            found += mine
    return found


class _Opening(NamedTuple):
    """A singular pose: the drivers' values there, and what can move, in columns of unit vectors.

    `null` moves with the drivers on their path, and `left` are the forces that belong to it; `opened` moves though the
    drivers rest; `idle` are turns of links that move nothing else. `counts` tells in how many ways each group opens.
    """

    pose: EquationsAtPose
    values: dict[str, float]
    null: Number
    left: Number
    opened: Number
    idle: Number
    counts: tuple[int, ...]


class _Branches(NamedTuple):
    """What a pose is at which something opens, by the tangents of the branches through it with their multiplicities."""

    kind: str
    tangents: list[tuple[Number, int]]
    finite: bool = True
    turns: bool = False


def _examined(system: MotionEquations, design: int, spot: SingularPlace) -> Singularity | None:
    """Return what a pose is at which some block is singular. None where others hold it."""
    middle = 0.5 * (spot.place + spot.until)
    opening = _opening(system, design, middle, spot.is_end)
    if opening is None:
        return None
    found = _branches(opening, spot.is_end)
    motion, pose, kind, values = system.motion, opening.pose, found.kind, opening.values
    if spot.until > spot.place:
        values = _drivers_at(motion, design, spot.place)
        # else the drivers rest at a singular pose
        kind = kind if values == _drivers_at(motion, design, spot.until) else ARCHITECTURE
    ways, tangents = _ways_of_motion(pose, design, middle), list(found.tangents)
    for way in ways if not found.finite else ():
        if not any(_alike(way, other) for other, _ in tangents):
            tangents.append((way, 1))
    # at a limit position the motion turns into the only branch by the root of the distance
    branches = [
        replace(_tangent(pose, t), multiplicity=times, followed=kind == LIMIT or any(_alike(t, way) for way in ways))
        for t, times in tangents
    ]
    branches.sort(key=lambda one: not one.followed)
    groups = [group for group, count in zip(motion.structure.groups, opening.counts, strict=True) if count]
    return Singularity(
        0, kind, _design(motion, design), spot.place, spot.until, values, _time(motion, design, spot.place),
        tuple(group.name for group in groups), tuple(link for group in groups for link in group.links), "",
        tuple(_tangent(pose, one, number=k) for k, one in enumerate(opening.opened.T, start=1)),
        tuple(replace(one, number=k) for k, one in enumerate(branches, start=1)),
        found.finite, found.turns, pose.poses, motion,
    )  # fmt: skip


def _opening(system: MotionEquations, design: int, place: float, is_end: bool) -> _Opening | None:
    """Return what opens at a place, polished where it is a limit position. None where nothing does."""
    pose = equations_at(system, design, place)
    if not np.isfinite(pose.whole).all():
        return None
    idle, values = idle_motions(pose), _drivers_at(system.motion, design, place)
    null, left = null_spaces(pose.with_free_driver(pose.whole))
    null = without_motions(null, idle)
    opened = without_motions(null_spaces(pose.whole)[0], idle)
    if null.shape[1] == 1 and (opened.shape[1] or is_end):
        pose, values = _at_limit(pose, idle, values)
        opened = without_motions(null_spaces(pose.whole)[0], idle)
    counts = tuple(_nullity(system, pose, block) for block in system.blocks)
    # no more than in the blocks: links far away have levers that make whole singular values small
    opened = opened[:, max(opened.shape[1] - sum(counts), 0) :]
    return _Opening(pose, values, null, left, opened, idle, counts) if opened.shape[1] else None


def _branches(here: _Opening, is_end: bool) -> _Branches:
    """Return which branches meet where something opens: one smooth one, or the real zeros of quadratic forms."""
    pose, null = here.pose, here.null
    if null.shape[1] == 1:
        tangent = without_motions(null_spaces(pose.with_free_driver(pose.whole))[0], here.idle)[:, 0]
        return _Branches(LIMIT, [(tangent, 1)], turns=abs(_turning(pose, tangent)) > FLAT)
    roots, finite = zeros_of_forms(_forms(pose, null, here.left))
    tangents = [(null @ root, times) for root, times in roots if _leads_on(pose, null @ root)]
    if is_end and not tangents and here.opened.shape[1] == 1:
        # what seems to open besides is next to a pole of another group
        return _Branches(LIMIT, [(here.opened[:, 0], 1)], finite, turns=True)
    kind = CHANGE if sum(times for _, times in tangents) > 1 or not finite else SHAKY
    return _Branches(kind, tangents, finite)


def _nullity(system: MotionEquations, pose: EquationsAtPose, block: GroupBlock) -> int:
    """Return in how many directions a group moves though the links before it rest, idle links apart."""
    tables = system.tables(pose.poses, pose.ends, 1)
    values = np.linalg.svd(system.matrix(block.rows, block.links, tables)[0], compute_uv=False)
    return block.kept - int(np.sum(values[: block.kept] > ZERO))


def _design(motion: Motion, design: int) -> tuple[int, ...]:
    axes = motion.shape[:-1]
    return tuple(int(i) for i in np.unravel_index(design, axes)) if axes else ()


def _time(motion: Motion, design: int, place: float) -> float | None:
    if motion.time is None:
        return None
    return float(times_between(motion, np.array([design]), np.array([place]))[0])


def _drivers_at(motion: Motion, design: int, place: float) -> dict[str, float]:
    part = inputs_between(motion, np.array([design]), np.array([place]))
    return {name: float(np.ravel(values[0])[0]) for name, values in part.drives.items()}


def _turning(pose: EquationsAtPose, tangent: Number) -> float:
    """Return the second derivative of the drivers' path along a smooth branch."""
    held = pose.with_free_driver(pose.whole)
    bent = np.linalg.lstsq(held, -pose.second(tangent[None])[0], rcond=ZERO)[0]
    return float(pose.way.along @ pose.bending(tangent)) + pose.pace(bent)


def _at_limit(
    pose: EquationsAtPose, idle: Number, values: Mapping[str, float]
) -> tuple[EquationsAtPose, dict[str, float]]:
    """Return the pose at which the drivers stand still along a smooth branch, by Newton's method, and their values."""
    for _ in range(POLISHED):
        tangent = without_motions(null_spaces(pose.with_free_driver(pose.whole))[0], idle)[:, 0]
        pace, bend = pose.pace(tangent), _turning(pose, tangent)
        if abs(bend) < FLAT or abs(pace) < REST.exact:
            break
        state = pose.corrected(-pace / bend * tangent)
        if state is None or np.linalg.norm(state) > ONE:
            break
        change = pose.values(state, 0) - pose.start
        drives = [row for row in pose.system.rows if row.driver is not None]
        gone = {row.driver: float(v) for row, v in zip(drives, change[pose.driven], strict=True)}
        values = {name: v + _gone(pose.system, name, gone[name]) for name, v in values.items()}
        moved = pose.moved(state)
        pose = replace(pose, poses={name: one if one is FIXED else one.entry(()) for name, one in moved.items()})
    return pose, dict(values)


def _gone(system: MotionEquations, name: str, away: float) -> float:
    return float(wrapped(away)) if system.motion.drives[name].is_angle else away * system.unit


def _forms(pose: EquationsAtPose, null: Number, left: Number) -> Number:
    """Return the quadratic forms of the equations in the null space, (left null vectors, n, n)."""
    n = null.shape[1]
    i, j = np.triu_indices(n)
    states = np.where((i == j)[:, None], null.T[i], null.T[i] + null.T[j])
    values = pose.second(states) @ left
    forms = np.zeros((left.shape[1], n, n))
    own = {int(a): values[k] for k, (a, b) in enumerate(zip(i, j, strict=True)) if a == b}
    for k, (a, b) in enumerate(zip(i.tolist(), j.tolist(), strict=True)):
        forms[:, a, b] = forms[:, b, a] = own[a] if a == b else 0.5 * (values[k] - own[a] - own[b])
    return forms


def _leads_on(pose: EquationsAtPose, tangent: Number) -> bool:
    """Tell whether a corrected step along a tangent stays near it, in one sense at least."""
    for sense in (1.0, -1.0):
        state = pose.corrected(sense * STEP * tangent)
        if state is not None and np.linalg.norm(state - sense * STEP * tangent) < DEVIATES * STEP:
            return True
    return False


def _ways_of_motion(pose: EquationsAtPose, design: int, place: float) -> list[Number]:
    """Return the directions in which the motion comes to a pose and goes on, unit vectors."""
    system, last = pose.system, pose.system.motion.inputs.poses - 1.0
    places = np.array([p for p in (place - BESIDE, place + BESIDE) if 0.0 <= p <= last])
    if not len(places):
        return []
    there, found = system.at(design, places), []
    for k in np.flatnonzero(there.good):
        state = np.zeros(3 * len(system.links))
        for name, first in system.column.items():
            one, own = there.links[name].entry((int(k),)), pose.poses[name]
            shift = (one.z.c[0] - own.z.c[0]) / system.unit
            state[first : first + 3] = shift.real, shift.imag, float(np.angle(one.u.c[0] / own.u.c[0]))
        state = state - (idle := idle_motions(pose)) @ (idle.T @ state)
        if np.linalg.norm(state) > 0.0:
            found.append(state / np.linalg.norm(state))
    return found


def _alike(one: Number, other: Number) -> bool:
    return abs(float(one @ other)) > ALONG * float(np.linalg.norm(one) * np.linalg.norm(other))


def _tangent(pose: EquationsAtPose, state: Number, number: int = 0) -> PoseTangent:
    """Return a direction with its rates scaled."""
    system, motion = pose.system, pose.system.motion
    rates = pose.whole[pose.driven] @ state
    names = [row.driver for row in system.rows if row.driver is not None]
    units = np.array([1.0 if motion.drives[name].is_angle else system.unit for name in names])
    fastest = int(np.argmax(np.abs(rates))) if len(rates) else 0
    moves = bool(len(rates)) and abs(rates[fastest]) > STILL * float(np.max(np.abs(state)))
    by = rates[fastest] * units[fastest] if moves else state[int(np.argmax(np.abs(state)))]
    state = state / by
    drivers = {name: float(v) + 0.0 if moves else 0.0 for name, v in zip(names, rates * units / by, strict=True)}
    first = {name: system.column[name] for name in motion.mechanism.links if name in system.column}
    twists = {name: Twist(complex(state[k], state[k + 1]) * system.unit, float(state[k + 2]))
              for name, k in first.items()}  # fmt: skip
    velocities = {}
    for letter, links in motion.mechanism.carriers.items():
        link = links[0]
        if FRAME not in links:
            own = pose.poses[link]
            arm = own.at(pose.points[link][letter]).c[0] - own.z.c[0]
            velocities[letter] = complex(twists[link].velocity + 1j * twists[link].angular_velocity * arm)
    return PoseTangent(number, drivers, twists, velocities)


def _of_outputs(motion: Motion, names: Sequence[str], strict: bool) -> Iterator[Singularity]:
    """Yield the dead points of outputs. Raises InvalidInput where given ones have none, unless it is not strict."""
    system = MotionEquations(motion)
    for name in names:
        try:
            found = dead_points(motion, name)
        except InvalidInput:
            if strict:
                raise
            continue
        owner = name.rpartition(".")[0]
        pair = motion.solving_order.pairs.get(owner)
        links = (owner,) if pair is None or owner in motion.mechanism.links else pair.members[1:2]
        for design, place, until in zip(
            found.at.design.tolist(), found.at.place.tolist(), found.until.tolist(), strict=True
        ):
            pose = equations_at(system, design, place)
            null = without_motions(null_spaces(pose.with_free_driver(pose.whole))[0], idle_motions(pose))
            tangents = (_tangent(pose, null[:, 0], 1),) if null.shape[1] == 1 else ()
            groups = tuple(g.name for g in motion.structure.groups if not set(g.links).isdisjoint(links))
            yield Singularity(
                0, DEAD, _design(motion, design), place, until, _drivers_at(motion, design, place),
                _time(motion, design, place), groups, links, name, tangents,
                tuple(replace(one, followed=True) for one in tangents), True, False, pose.poses, motion,
            )  # fmt: skip
