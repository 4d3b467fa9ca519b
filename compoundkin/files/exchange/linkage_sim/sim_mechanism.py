"""From what a file of linkage_sim says to a mechanism: links by coordinates, pins, slides, drivers, masses."""

from __future__ import annotations

import cmath
import math
import warnings
from collections.abc import Iterator, Mapping

import numpy as np

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import CompoundkinError, LikelySlip
from compoundkin.files.exchange.linkage_sim.fixed_bodies import ROUNDING, Placed, fixed_bodies, size_of
from compoundkin.files.exchange.linkage_sim.sim_loads import SimLoads
from compoundkin.files.exchange.linkage_sim.sim_points import SimPoints
from compoundkin.files.exchange.linkage_sim.sim_records import GROUND, SimDriver, SimFile
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.elements import Drive, Item, drawn, drive, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import slide
from compoundkin.model.pairs.cylinder import cylinder
from compoundkin.structure import decompose

_UNITS = {"length": "m", "mass": "kg", "force": "N"}
# So many steps have a turn, and the way of a length, which goes over such a part of the size.
_STEPS, _TRAVEL = 72, 0.1


def sim_mechanism(file: SimFile, problems: Problems, title: str) -> tuple[Mechanism, list[str]]:
    """Return the mechanism of a file, and what has to be said of it. Raises InvalidInput with all problems."""
    placed = fixed_bodies(file, problems)
    problems.raise_if_any()
    points = SimPoints(file, placed, problems)
    notes: list[str] = []
    items: list[Item] = [*_slides(file, placed, points, problems)]
    items += _drivers(file, placed, points, problems, notes)
    problems.raise_if_any()
    loads = SimLoads(file, placed, points)
    problems.raise_if_any()
    items += loads.items
    notes += (
        [f"left out: {', '.join(count_phrase(many, what) for what, many in loads.left_out.items())}"]
        if loads.left_out
        else []
    )
    items = [*(link(points.link[h], **own) for h, own in points.of.items()), *items]
    as_drawn = _drawn(file, points)
    if as_drawn:
        notes.append("the axes of all bodies agree in the file, which is taken as the pose drawn")
        return _made(title, [*items, drawn(**as_drawn)], notes), notes
    mechanism = _made(title, items, notes)
    return mechanism, [*notes, _modes(mechanism)]


def _made(title: str, items: list[Item], notes: list[str]) -> Mechanism:
    """Return a mechanism. What is odd in another program's file is told with what else is told of it."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", LikelySlip)
        made = Mechanism(title, *items, units=_UNITS)
    notes += [str(one.message) for one in said]
    return made


def _slides(file: SimFile, placed: Mapping[str, Placed], points: SimPoints, problems: Problems) -> Iterator[Item]:
    """Yield the prismatic joints: the second body slides on the first, turned against it by a given angle."""
    for joint in file.joints:
        on, moving = (placed[key] for key in joint.bodies)
        if joint.kind == "prismatic" and on.host == moving.host:
            problems.add(joint.where, "it joins two bodies that fixed joints make one")
        elif joint.kind == "prismatic":
            through, at = (points.letter[spot] for spot in zip(joint.bodies, joint.points, strict=True))
            along = cmath.phase(joint.axis)
            yield slide(
                points.link[moving.host],
                on=points.link[on.host],
                at=at,
                through=through,
                angle=along + on.turn,
                offset=0.0,
                turn=joint.turn - moving.turn - along,
                name=joint.key,
            )


def _drivers(
    file: SimFile, placed: Mapping[str, Placed], points: SimPoints, problems: Problems, notes: list[str]
) -> Iterator[Item]:
    """Yield the drivers, from their values at time zero; one of a length with its cylinder."""
    pinned = {frozenset(placed[key].host for key in joint.bodies) for joint in file.joints if joint.kind == "revolute"}
    for one in file.drivers:
        hosts = [placed[key].host for key in one.bodies]
        if one.places is not None:
            yield from _cylinder(one, points, size_of(file), notes)
        elif frozenset(hosts) not in pinned or hosts[0] == hosts[1]:
            what = f"it turns {one.bodies[1]!r} against {one.bodies[0]!r}, and no revolute joint joins them"
            problems.add(one.where, what, "give it bodies that are joined")
        else:
            yield _turned(one, placed, points)
    if not file.drivers:
        marked = f" ({file.markers} of them are marked)" if file.markers else ""
        notes.append(f"no driver is in the file{marked}: the Python program does not save them; add one")


def _turned(one: SimDriver, placed: Mapping[str, Placed], points: SimPoints) -> Drive:
    on, moving = (placed[key] for key in one.bodies)
    start, rate = one.start + on.turn - moving.turn, one.rate
    if moving.host == GROUND:
        on, moving, start, rate = moving, on, -start, -rate
    values = start + np.linspace(0.0, math.tau, _STEPS + 1)
    made = drive(points.link[moving.host], on=points.link[on.host], values=values, speed=rate, name=one.key)
    assert isinstance(made, Drive)
    return made


def _cylinder(one: SimDriver, points: SimPoints, size: float, notes: list[str]) -> Iterator[Item]:
    """Yield a cylinder and its driver, in the direction in which the length goes."""
    assert one.places is not None
    ends = [
        points.added(body, place, f"{one.key} {k}")
        for k, (body, place) in enumerate(zip(one.bodies, one.places, strict=True), 1)
    ]
    name = points.names.give(one.key, "cylinder")
    way = math.copysign(_TRAVEL * size, one.rate)
    yield cylinder(points.named(one.bodies[0]), ends[0], to=points.named(one.bodies[1]), at=ends[1], name=name)
    yield drive(name, values=one.start + np.linspace(0.0, way, _STEPS + 1), speed=one.rate)
    notes.append(f"{name} is driven from its length of {one.start:.6g} over {way:.4g}, for no way is told")


def _drawn(file: SimFile, points: SimPoints) -> dict[str, complex]:
    """Return where all points are if the axes of all bodies agree in one pose: the web app saves what it shows."""
    near = ROUNDING * size_of(file)
    found: dict[str, complex] = {}
    for (body, point), letter in points.letter.items():
        here = file.bodies[body].points[point]
        if abs(found.setdefault(letter, here) - here) > near:
            return {}
    for joint in file.joints:
        here, there = (file.bodies[b].points[p] for b, p in zip(joint.bodies, joint.points, strict=True))
        across = ((there - here) * joint.axis.conjugate()).imag / abs(joint.axis)
        if joint.kind == "prismatic" and (joint.turn or abs(across) > near):
            return {}
    return found


def _modes(mechanism: Mechanism) -> str:
    """Return the note on the modes: what nothing chooses is chosen by default, four-bar loops are open."""
    told = "no pose is in the file, and its mode is the default one"
    pins = sum(len(links) - 1 for links in mechanism.carriers.values())
    if 3 * (len(mechanism.links) - 1) - 2 * (pins + len(mechanism.written_pairs)) != len(mechanism.drives):
        # looking for what holds too much takes long, and is done when it is asked for
        return told
    try:
        groups = decompose(mechanism).groups
    except CompoundkinError:
        return told
    dyads = [group for group in groups if len(group.bodies) == 2]
    # of pins and slides, those with two slides have one mode, the others two
    two = sum(sum(not pair.free_is_angle for pair in (*group.inner, *group.outer)) < 2 for group in dyads)
    more = " and those of larger groups" if len(dyads) < len(groups) else ""
    return f"{told}: open loops, else +, of {2**two}{more}; all are found by configurations"
