"""What is known of a workspace from its drivers: which move the point, through which ranges, and places they reach."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.configurations.enumeration import AllModes
from compoundkin.configurations.led_point import LedPoint
from compoundkin.model.pairs.travel_limits import as_travel_limited
from compoundkin.structure.kinematic_structure import Structure

# So many values of each driver are tried to see about where the point gets, with two drivers and with three.
TRIED = {2: 40, 3: 12}
# A full turn is not tried at round angles, where poses are special.
SEAM = 0.123
# So many of the places that they reach are enough to tell configurations and extent.
ENOUGH = 3000


def given_ranges(structure: Structure, ranges: Mapping[str, Any] | None) -> dict[str, tuple[float, float]]:
    """Return the ranges of the drivers that have one. By a call, or by the ends of guides."""
    problems = [
        Problem(f"ranges.{name}", f"there is no driver {name!r}", suggestion(name, list(structure.driven)))
        for name in ranges or {}
        if name not in structure.driven
    ]
    if problems:
        raise InvalidInput(problems)
    found = {}
    for name, step in structure.driven.items():
        own = as_travel_limited(step.pair)
        if ranges and name in ranges:
            found[name] = _range(name, ranges[name])
        elif own is not None and np.all(
            np.isfinite([first_entry(b) for b in own.bounds(structure.mechanism.geometry)])
        ):
            low, high = own.bounds(structure.mechanism.geometry)
            found[name] = float(first_entry(low)), float(first_entry(high))
        elif not step.pair.free_is_angle:
            problems.append(Problem(f"ranges.{name}", "a slide has no end of its own", _example(structure, name)))
    if problems:
        raise InvalidInput(problems)
    # a full turn and more is no limit
    return {name: v for name, v in found.items() if not structure.driven_angles[name] or v[1] - v[0] < TURN}


def _range(name: str, value: Any) -> tuple[float, float]:
    try:
        low, high = (float(one) for one in value)
    except (TypeError, ValueError):
        raise InvalidInput(Problem(f"ranges.{name}", f"{value!r} is not a range", "give (low, high)")) from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise InvalidInput(Problem(f"ranges.{name}", f"{low:g} to {high:g} is not a range", "give (low, high)"))
    return low, high


def _example(structure: Structure, name: str) -> str:
    values = next(drive.values for drive in structure.mechanism.drives if drive.name == name)
    low, high = (float(np.min(values)), float(np.max(values))) if values is not None else (0.0, 0.0)
    if low == high:
        low, high = 0.0, structure.mechanism.geometry.size
    return f"say from where to where: ranges={{{name!r}: ({low:g}, {high:g})}}"


def free_drivers(structure: Structure, point: str, orientation: float | None) -> tuple[str, ...]:
    """Return the drivers that move a point, two or three. Raises UnknownName, and InvalidInput for another number."""
    carriers = structure.mechanism.carriers
    if point not in carriers:
        raise UnknownName(Problem(point, "there is no such point", suggestion(point, list(carriers))))
    moving = set(_drivers_of(structure, carriers[point][0]))
    free = tuple(name for name in structure.driven if name in moving)
    if len(free) in TRIED:
        if orientation is not None and len(free) == 2:
            link = carriers[point][0]
            what = f"two drivers leave {link} no choice of its angle where {point} is"
            raise InvalidInput(Problem("orientation", what, "leave it out"))
        return free
    if len(free) < 2:
        told = f"one driver ({free[0]}) moves {point}, on a curve" if free else f"no driver moves {point}"
        how = f'a curve is drawn by compoundkin.plots.paths(motion, "{point}"); name a point that more drivers move'
        raise InvalidInput(Problem("workspace", f"{told}: that is no region", how))
    what = f"{len(free)} drivers ({', '.join(free)}) move {point}, and a place and an angle are led by three at most"
    raise InvalidInput(Problem("workspace", what, "hold some: replace their drives by links of one piece"))


def _drivers_of(structure: Structure, link: str) -> Iterator[str]:
    """Yield the drivers that may move a link, some of them again."""
    group = next((group for group in structure.groups if link in group.links), None)
    if group is not None:
        yield from (step.drive.name for body in group.bodies for step in body.driven if not step.is_passive)
        for used in group.uses:
            yield from _drivers_of(structure, used)
        return
    for step in structure.ground.driven:
        if step.link == link:
            if not step.is_passive:
                yield step.drive.name
            yield from _drivers_of(structure, step.parent)


def reached_by_driving(led: LedPoint, ranges: Mapping[str, tuple[float, float]]) -> tuple[Number, Number]:
    """Return places (n,) that the point is driven to in any mode. The angles of its link too."""
    count = TRIED[len(led.free)]
    axes = [
        np.linspace(*ranges[name], count) if name in ranges else SEAM + TURN * np.arange(count) / count
        for name in led.free
    ]
    grid = [axis.ravel() for axis in np.meshgrid(*axes)]
    drives = {**led.given.drives, **{name: (values[None],) for name, values in zip(led.free, grid, strict=True)}}
    given = led.given.of_poses(grid[0].size).driven(drives)
    with np.errstate(all="ignore"):
        found = AllModes.of(led.driven, given)
        closed = np.asarray(found.block.failed) == 0
        z, angle, real = (found.full(array).ravel() for array in (*led.placed(found.block), closed))
    z, angle = z[real], angle[real]
    thin = slice(None, None, max(1, z.size // ENOUGH))
    return z[thin], angle[thin]
