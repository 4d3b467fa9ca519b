"""Six-bars: a dyad added to a linkage that is found, so that a second output takes angles, or dwells twice.

The second output turns about a given pivot, so that the coupler of the linkage sees its poses: a bar between both is a
dyad again. For dwells the coupler point goes along two arcs of circles of one radius: a bar of that length from the
point has its other end at rest in the centre of either arc, and an output that swings between both centres rests there.

Source: R. L. Norton, Design of Machinery, section 3.9 (dwells by coupler arcs).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput
from compoundkin.dimensional.candidates import COUPLER, Candidates, Linkage, of_dyads
from compoundkin.dimensional.dyad_equations import RR, Dyad
from compoundkin.dimensional.dyads import dyads_of
from compoundkin.dimensional.motion_generation import spread_over_curve
from compoundkin.dimensional.tasks import INPUT, Conditions, DwellTask, OutputTask, PoseTask
from compoundkin.model.attributes import ANGLE
from compoundkin.model.elements import link
from compoundkin.model.geometry import FRAME

BAR, SECOND = "bar", "second output"
# Points of the coupler are tried on a grid of so many each way, poses of the crank are so many in a turn.
GRID, POSES = 17, 72
# So many pairs of arcs are made better, of each linkage at most so many.
STARTS, OF_EACH = 36, 8
# Crank-rockers with a crank of 1 that are tried: coupler, rocker, frame.
FOUR_BARS = (
    (2.0, 2.0, 2.0),
    (2.5, 2.5, 2.5),
    (3.0, 2.5, 2.0),
    (2.5, 3.0, 3.5),
    (3.5, 3.0, 3.0),
    (2.0, 2.5, 2.5),
    (3.0, 3.0, 2.0),
)


def added_output(task: OutputTask) -> Candidates:
    """Return six-bars whose second output takes angles at the positions of a linkage: all of five, some of fewer."""
    base: Linkage = task.base.candidate
    body = base.links[-1].name
    z, u = base.z[body], base.u[body]
    seen = PoseTask(
        SECOND, np.conj(u) * (task.pivot - z), np.conj(u) * np.exp(1j * task.angles), conditions=Conditions()
    )
    found = dyads_of(seen)
    dyads = [dyad for dyad in found if dyad.kind == RR]
    if found.freedom == 1:
        dyads += spread_over_curve(seen, found)
    elif found.freedom > 1:
        size = base.span / 4.0
        for arm in (size * r * np.exp(1j * t) for r in (0.5, 1.0) for t in np.arange(12) * TURN / 12):
            try:
                dyads.append(found.with_centre(arm))
            except InvalidInput:
                continue
    dyads = [dyad for dyad in dyads if dyad.kind == RR and dyad.length > 0.0 and abs(dyad.moving) > 0.0]
    made = [extended(base, dyad.fixed, dyad.moving, dyad.length, task.pivot, task.angles) for dyad in dyads]
    whole = f"{count_phrase(len(made), 'six-bar')} of {'a family' if found.freedom else '4 at most'}"
    return Candidates(made, whole, found.note, found, is_family=found.freedom > 0)


def extended(base: Linkage, near: complex, far: complex, length: float, pivot: complex, angles: Number) -> Linkage:
    """Return a linkage with a bar from the point `near` of its coupler to the point `far` of an output at a pivot."""
    *others, body = base.links
    frame = next(item for item in others if item.name == FRAME)
    ends = {"C": near, "E": far, "F0": pivot}
    turn = np.exp(1j * angles)
    start = base.z[body.name] + base.u[body.name] * near
    end = pivot + turn * far
    links = (
        link(FRAME, **{**frame.points, "F0": ends["F0"]}), *(item for item in others if item is not frame),
        link(BAR, C=0j, E=complex(length)), link(SECOND, F0=0j, E=far), link(body.name, **{**body.points, "C": near}),
    )  # fmt: skip
    still = np.full(len(turn), pivot)
    return replace(
        base, title=f"{base.title} with a dyad", links=links,
        places={**base.places, "F0": pivot, "C": complex(start[0]), "E": complex(end[0])},
        z={**base.z, BAR: start, SECOND: still}, u={**base.u, BAR: (end - start) / np.abs(end - start), SECOND: turn},
        pivots=(*base.pivots, pivot), lengths=(*base.lengths, length, abs(far)),
        outputs=(*base.outputs, f"{SECOND}.{ANGLE}"),
    )  # fmt: skip


# --- double dwells --------------------------------------------------------------------------------------------


class _Arcs(NamedTuple):
    """Two arcs of one radius on the curve of a coupler point: the poses of their middles, and their centres."""

    lengths: tuple[float, float, float]
    point: complex
    middles: tuple[int, int]
    centres: tuple[complex, complex]
    radius: float
    error: float


def double_dwell(task: DwellTask) -> Candidates:
    """Return six-bars whose output swings by an angle and rests at both ends while the crank turns by two others."""
    widths = [max(round(width / TURN * POSES), 3) for width in task.dwells]
    found = [arcs for lengths in FOUR_BARS for arcs in _arcs(lengths, widths, task.swing)]
    found.sort(key=lambda one: one.error)
    better = sorted((_better(arcs, task.dwells) for arcs in found[:STARTS]), key=lambda one: one.error)
    made = [one for arcs in better for one in [_with_swing(arcs, task)] if one is not None]
    made.sort(key=lambda one: one.error)
    note = "approached: the error is the greatest angle by which the output moves while it should rest"
    complete = f"{count_phrase(len(made), 'six-bar')} out of {len(FOUR_BARS)} crank-rockers"
    nearest = "" if made else "no pair of arcs was found: shorter dwells have some"
    return Candidates(made, complete, note, nearest=nearest, is_family=True)


def _coupler(lengths: tuple[float, float, float], phi: Number) -> tuple[Number, Number]:
    """Return origins and orientations of the coupler of a crank-rocker with a crank of 1."""
    b, c, d = lengths
    joint = np.exp(1j * phi)
    arm = d - joint
    u = (
        arm
        / np.abs(arm)
        * np.exp(1j * np.arccos(np.clip((np.abs(arm) ** 2 + b**2 - c**2) / (2 * b * np.abs(arm)), -1, 1)))
    )
    return joint, u


def _arcs(lengths: tuple[float, float, float], widths: list[int], swing: float) -> Iterator[_Arcs]:
    """Yield the best pairs of arcs of points of a coupler on a grid: each window's circle by linear least squares."""
    z, u = _coupler(lengths, np.arange(POSES) * TURN / POSES)
    reach = np.linspace(-1.5, 1.5, GRID) * lengths[0]
    grid = (lengths[0] / 2 + reach[:, None] + 1j * reach[None]).ravel()
    path = z + grid[:, None] * u
    centres, radii, off = zip(*(_circles(path, width) for width in widths), strict=True)
    first, second = centres[0][:, :, None], centres[1][:, None, :]
    apart = np.abs(np.arange(POSES)[:, None] - np.arange(POSES)[None])
    apart = np.minimum(apart, POSES - apart)
    bad = off[0][:, :, None] + off[1][:, None, :] + np.abs(radii[0][:, :, None] - radii[1][:, None, :])
    allowed = (apart > sum(widths) / 2 + POSES / 24) & (np.abs(first - second) > 0.2)
    allowed &= (radii[0][:, :, None] < 8.0) & _one_mode(path, first, second, swing)
    quality = np.where(allowed, bad / np.maximum(np.abs(first - second), 1e-9), np.inf).reshape(len(grid), -1)
    best = np.argmin(quality, axis=1)
    for k in np.argsort(quality[np.arange(len(grid)), best])[:OF_EACH]:
        i, j = divmod(int(best[k]), POSES)
        radius = float(radii[0][k, i] + radii[1][k, j]) / 2.0
        ends = complex(centres[0][k, i]), complex(centres[1][k, j])
        if np.isfinite(quality[k, best[k]]):
            yield _Arcs(lengths, complex(grid[k]), (i, j), ends, radius, float(quality[k, best[k]]))


def _one_mode(path: Number, first: Number, second: Number, swing: float) -> Number:
    """Return whether the added dyad has one mode in both dwells, its pivot on either side (points, poses, poses)."""
    found = np.zeros(np.broadcast_shapes(first.shape, second.shape), dtype=bool)
    one, other = path[:, :, None], path[:, None, :]
    for side in (1.0, -1.0):
        pivot = (first + second) / 2.0 + side * 0.5j * (second - first) / np.tan(swing / 2.0)
        modes = [(np.conj(pivot - p) * (centre - p)).imag for p, centre in ((one, first), (other, second))]
        found |= modes[0] * modes[1] > 0.0
    return found


def _circles(path: Number, width: int) -> tuple[Number, Number, Number]:
    """Return centre, radius and mean deviation of the circle through each window of a closed path (points, poses)."""
    window = np.arange(-(width // 2), width - width // 2)
    w = path[:, (np.arange(POSES)[:, None] + window) % POSES]
    middle = w.mean(axis=-1, keepdims=True)
    v = w - middle
    square = np.abs(v) ** 2
    xx, yy, xy = (np.mean(one, axis=-1) for one in (v.real**2, v.imag**2, v.real * v.imag))
    right = np.mean(square[..., None] * np.stack([v.real, v.imag], -1), axis=-2) / 2.0
    with np.errstate(all="ignore"):
        determinant = xx * yy - xy**2
        x = (right[..., 0] * yy - right[..., 1] * xy) / determinant
        y = (right[..., 1] * xx - right[..., 0] * xy) / determinant
        radius = np.sqrt(np.mean(square, axis=-1) + x**2 + y**2)
        off = np.sqrt(np.mean((np.abs(v - (x + 1j * y)[..., None]) - radius[..., None]) ** 2, axis=-1))
    good = np.isfinite(off)
    return middle[..., 0] + np.where(good, x + 1j * y, 0), np.where(good, radius, 1e9), np.where(good, off, 1e9)


def _windows(arcs: _Arcs, dwells: tuple[float, float]) -> list[Number]:
    """Return the crank's angles in both dwells."""
    pairs = zip(arcs.middles, dwells, strict=True)
    return [middle * TURN / POSES + np.linspace(-width / 2.0, width / 2.0, 25) for middle, width in pairs]


def _better(arcs: _Arcs, dwells: tuple[float, float]) -> _Arcs:
    """Return arcs with the least deviation: the point, the lengths, the centres and the radius change."""
    from scipy.optimize import least_squares

    windows = _windows(arcs, dwells)

    def errors(x: Number) -> Number:
        moved = _moved(arcs, x)
        paths = [z + u * moved.point for z, u in (_coupler(moved.lengths, phi) for phi in windows)]
        swing = abs(moved.centres[0] - moved.centres[1])
        return np.concatenate([np.abs(p - c) - moved.radius for p, c in zip(paths, moved.centres, strict=True)]) / swing

    start = [*arcs.lengths, *(v for p in (arcs.point, *arcs.centres) for v in (p.real, p.imag)), arcs.radius]
    low = [*(0.8 * np.array(arcs.lengths)), *np.array(start[3:]) - 2.0]
    high = [*(1.25 * np.array(arcs.lengths)), *np.array(start[3:]) + 2.0]
    found = least_squares(errors, start, bounds=(low, high), max_nfev=60)
    return _moved(arcs, found.x)._replace(error=float(np.max(np.abs(found.fun))))


def _moved(arcs: _Arcs, x: Number) -> _Arcs:
    b, c, d, px, py, ax, ay, bx, by, radius = (float(v) for v in x)
    return arcs._replace(
        lengths=(b, c, d), point=complex(px, py), centres=(complex(ax, ay), complex(bx, by)), radius=radius
    )


def _with_swing(arcs: _Arcs, task: DwellTask) -> Linkage | None:
    """Return the six-bar whose output swings by an angle between both centres; None where it has no such mode."""
    first, second = arcs.centres
    made = []
    for side in (1.0, -1.0):
        pivot = complex((first + second) / 2.0 + side * 0.5j * (second - first) / np.tan(task.swing / 2.0))
        long = abs(first - pivot)
        dense = [_coupler(arcs.lengths, phi) for phi in _windows(arcs, task.dwells)]
        points = [z + u * arcs.point for z, u in dense]
        ends = [_closed(p, arcs.radius, pivot, long, c) for p, c in zip(points, arcs.centres, strict=True)]
        modes = [np.sign((np.conj(pivot - p) * (end - p)).imag) for p, end in zip(points, ends, strict=True)]
        off = [np.angle((end - pivot) / (c - pivot)) for end, c in zip(ends, arcs.centres, strict=True)]
        error = float(np.max(np.abs(np.concatenate(off))))
        # of both dwells the dyad has one mode, else it would have to be taken apart between them
        if np.isfinite(error) and len(np.unique(np.concatenate(modes))) == 1:
            made.append((error, pivot, long, dense, ends))
    if not made:
        return None
    error, pivot, long, dense, ends = min(made, key=lambda one: one[0])
    order = (0, 1) if arcs.middles[0] < arcs.middles[1] else (1, 0)
    z, u, end = (np.concatenate([part[k][::12] for k in order]) for part in
                 ([one[0] for one in dense], [one[1] for one in dense], ends))  # fmt: skip
    b, c, d = arcs.lengths
    pair = Dyad(RR, 0j, 0j, None, 1.0), Dyad(RR, complex(d), complex(b), None, c)
    base = next(of_dyads(z, u, [pair], COUPLER, arcs.point)).driven_by(INPUT)
    swung = extended(base, arcs.point, complex(long), arcs.radius, pivot, np.angle(end - pivot))
    return replace(swung, title="Double-dwell six-bar", error=error)


def _closed(start: Number, radius: float, pivot: complex, long: float, near: complex) -> Number:
    """Return the joints at two distances from `start` and `pivot`, those nearer to a place; NaN where none is."""
    arm = start - pivot
    with np.errstate(invalid="ignore"):
        turn = np.arccos((np.abs(arm) ** 2 + long**2 - radius**2) / (2.0 * long * np.abs(arm)))
        both = [pivot + long * arm / np.abs(arm) * np.exp(sign * 1j * turn) for sign in (1.0, -1.0)]
        found: Number = np.where(np.abs(both[0] - near) <= np.abs(both[1] - near), *both)
    return found
