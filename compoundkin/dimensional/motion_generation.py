"""Linkages that guide a body through three, four or five poses, and a point at given crank angles.

Pairs of dyads on the body are linkages. Of the curve of dyads through four poses, and of the plane of them through
three, some are taken: those with given fixed pivots, else places spread over the curve or over the region.

A path with timing is a motion: of a body that turns like the crank and whose point goes through the points. A four-bar
that guides that body has two cognates whose cranks turn like it (S. Roberts, On three-bar motion in plane space, Proc.
London Math. Soc. 7 (1875) 14-23; J. M. McCarthy and G. S. Soh, Geometric Design of Linkages, section 4.5).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput
from compoundkin.dimensional.candidates import Candidates, Linkage, of_dyads, pairs_of
from compoundkin.dimensional.cognates import crank_cognates
from compoundkin.dimensional.dyad_equations import PR, RR, Dyad
from compoundkin.dimensional.dyads import Dyads, circle_through, dyads_of
from compoundkin.dimensional.tasks import Conditions, PoseTask, TimedPointTask, extent

# So many dyads of a curve are paired, of those whose crank passes the poses in order or that may be driven.
OF_CURVE = 16
# Of the pairs of a family so many are tried at most, spread over all.
MOST_PAIRS = 96
# Poses that cannot be met are approached from so many starts, and so many of the nearest linkages are told.
STARTS, TOLD = 12, 6
# Linkages whose pivots and joints differ by less than this part of them are one.
ALIKE = 1e-3
_MANY = "so many poses are approached: the error is a length, of places and of angles by the extent of the poses"
# Fixed pivots are tried on a grid of so many places each way.
GRID = 4
# Without a region pivots are sought so many extents of the poses around their middle.
AROUND = 1.5
# Dyads with longer links, in extents of the poses, are of no use.
LONGEST = 20.0
# A pivot is a given one within this part of the extent of the poses.
GIVEN = 1e-9


def five_poses(task: PoseTask) -> Candidates:
    """Return all linkages through five poses: pairs of the four dyads at most."""
    found = dyads_of(task)
    if found.freedom and not len(found):
        return _family(task, found)
    pairs = pairs_of(found.found)
    of = "a family" if found.freedom else "4"
    complete = f"{count_phrase(len(found), 'real dyad')} of {of}, {count_phrase(len(pairs), 'linkage')}"
    made = of_dyads(task.z, task.u, pairs, task.link)
    if len(task.z) < task.count or (pairs and not task.tolerance):
        return Candidates(made, complete, found.note, found, is_family=found.freedom > 0)
    # none is exact, or others are near enough: those that come nearest, and which tolerance would do
    note = found.note if pairs else "no linkage takes these poses exactly"
    return Candidates([*made, *islice(nearest_linkages(task), TOLD)], complete, note, found)


def four_poses(task: PoseTask) -> Candidates:
    """Return linkages through four poses: pairs of dyads spread over the curve, and of the two sliders."""
    found = dyads_of(task)
    if found.freedom != 1:
        return _family(task, found)
    given = task.conditions.ground
    at = [_nearest(found, place) for place in given]
    others = [] if len(given) > 1 else [*found, *spread_over_curve(task, found)]
    pairs = _some([pair for pair in pairs_of([*at, *others]) if _uses(pair, at)])
    chosen = len(at) + max(len(others) - len(found), 0)
    complete = f"{chosen} dyads of a curve with 2 sliders, {count_phrase(len(pairs), 'linkage')}"
    note = "the dyads through four poses form a curve: any two of it are a linkage"
    return Candidates(of_dyads(task.z, task.u, pairs, task.link), complete, note, found, is_family=True)


def many_poses(task: PoseTask) -> Candidates:
    """Return the four-bars and slider-cranks that come nearest to more poses than can be met, in the mean square."""
    return Candidates(list(nearest_linkages(task)), f"the best of {STARTS} starts at most", _MANY, is_family=True)


def nearest_linkages(task: PoseTask) -> Iterator[Linkage]:
    """Yield linkages that come nearest to poses, the nearest first.

    Of each start, two dyads through some of the poses, the sum of squares of the distances from all is least: how far
    the body is from a pose that both dyads allow, lengths and angles by the extent of the poses together. `error` is
    the greatest of these.
    """
    from scipy.optimize import least_squares

    # everything is in parts of that extent
    size = extent(task.z)
    z, u = task.z / size, task.u
    found = []
    for pair in _starts(PoseTask(task.link, z, u)):
        start = np.concatenate([_numbers(dyad) for dyad in pair])

        def distances(x: Number, pair: tuple[Dyad, Dyad] = pair) -> Number:
            return _distances(z, u, _with_numbers(pair, x))

        def slopes(x: Number, pair: tuple[Dyad, Dyad] = pair) -> Number:
            return _slopes(z, u, pair, x)

        best = least_squares(distances, start, slopes, x_scale="jac", max_nfev=120)
        dyads = _with_numbers(pair, best.x)
        there = _allowed(z, u, dyads)
        if there is not None:
            w, v = there
            error = float(np.max(np.hypot(np.abs(w - z), np.abs(np.angle(v / u)))))
            found.append((error, dyads, w, v))
    found.sort(key=lambda one: one[0])
    taken = list[Number]()
    for error, dyads, w, v in found:
        ordered = sorted(dyads, key=lambda dyad: (dyad.kind, dyad.fixed.real))
        ends = np.array([place for dyad in ordered for place in (dyad.fixed, dyad.moving)])
        spread = max(extent(ends), *(dyad.length for dyad in dyads))
        if spread < LONGEST and all(np.max(np.abs(ends - other)) > ALIKE * spread for other in taken):
            taken.append(ends)
            whole = dyads[0].scaled(size), dyads[1].scaled(size)
            yield from of_dyads(size * w, v, [whole], task.link, error=size * error)


def _starts(task: PoseTask) -> list[tuple[Dyad, Dyad]]:
    """Return pairs of dyads through some of the poses, those with the least distances from all.

    Lengths are in parts of the poses' extent, here and below.
    """
    count = len(task.z)
    indices = np.arange(count)
    chosen = [np.unique(np.linspace(0, count - 1, 4).round().astype(int))]
    chosen += [np.delete(indices, k) for k in indices] if count == 5 else []
    dyads = list[Dyad]()
    for some in chosen:
        part = PoseTask(task.link, task.z[some], task.u[some])
        found = dyads_of(part)
        if found.freedom == 1 and found.basis.shape[0] != found.basis.shape[1]:
            dyads += [*found, *spread_over_curve(part, found)]
    good = [dyad for dyad in dyads if dyad.kind != "RP" and np.max(np.abs(dyad.residual(task.z, task.u))) < 1.0]
    good.sort(key=lambda dyad: float(np.sum(dyad.residual(task.z, task.u) ** 2)))
    pairs = [pair for pair in pairs_of(good[: 2 * STARTS]) if {dyad.kind for dyad in pair} != {PR}]
    pairs.sort(key=lambda pair: float(np.sum(_distances(task.z, task.u, pair) ** 2)))
    return pairs[:STARTS]


def _numbers(dyad: Dyad) -> Number:
    """Return the numbers of a dyad that may change: of a slider the line's angle in the place of the length."""
    last = dyad.length if dyad.direction is None else float(np.angle(dyad.direction))
    return np.array([dyad.fixed.real, dyad.fixed.imag, dyad.moving.real, dyad.moving.imag, last])


def _with_numbers(pair: tuple[Dyad, Dyad], x: Number) -> tuple[Dyad, Dyad]:
    made = []
    for dyad, (a, b, c, d, last) in zip(pair, x.reshape(2, 5), strict=True):
        fixed, moving = complex(a, b), complex(c, d)
        if dyad.direction is None:
            made.append(Dyad(RR, fixed, moving, None, float(abs(last))))
        else:
            made.append(Dyad(dyad.kind, fixed, moving, complex(np.exp(1j * last))))
    return made[0], made[1]


def _closure(z: Number, u: Number, pair: tuple[Dyad, Dyad]) -> tuple[Number, Number]:
    """Return by how much both dyads are open at poses (n, 2), and the slopes by x, y and the angle (n, 2, 3).

    The numbers of dyads may be columns, of several pairs at once.
    """
    values, slopes = [], []
    for dyad in pair:
        arm = u * dyad.moving
        off = z + arm - dyad.fixed
        if dyad.direction is None:
            way = off / np.maximum(np.abs(off), 1e-300)
            values.append(np.abs(off) - dyad.length)
        else:
            way = np.broadcast_to(1j * dyad.direction, off.shape)
            values.append((np.conj(dyad.direction) * off).imag)
        slopes.append(np.stack([way.real, way.imag, (np.conj(way) * 1j * arm).real], axis=-1))
    return np.stack(values, axis=-1), np.stack(slopes, axis=-2)


def _distances(z: Number, u: Number, pair: tuple[Dyad, Dyad]) -> Number:
    """Return the distances of poses from those that two dyads allow, to first order: two for each pose."""
    values, slopes = _closure(z, u, pair)
    gram = slopes @ np.swapaxes(slopes, -1, -2) + 1e-12 * np.eye(2)
    found: Number = np.linalg.solve(np.linalg.cholesky(gram), values[..., None])
    return found.reshape(*values.shape[:-2], -1)


def _slopes(z: Number, u: Number, pair: tuple[Dyad, Dyad], x: Number) -> Number:
    """Return the slopes of the distances by the numbers of both dyads, by differences of all of them at once."""
    steps = np.sqrt(np.finfo(float).eps) * np.where(x < 0.0, -1.0, 1.0) * np.maximum(1.0, np.abs(x))
    moved = x + np.diag(steps)
    made = []
    for dyad, numbers in zip(pair, np.hsplit(np.vstack([x, moved]), 2), strict=True):
        a, b, c, d, last = (column[:, None] for column in numbers.T)
        crank = dyad.direction is None
        made.append(Dyad(dyad.kind, a + 1j * b, c + 1j * d, None if crank else np.exp(1j * last), np.abs(last)))
    here, *there = _distances(z, u, (made[0], made[1]))
    return np.transpose(np.array([one - here for one in there]) / (np.diag(moved) - x)[:, None])


def _allowed(z: Number, u: Number, pair: tuple[Dyad, Dyad]) -> tuple[Number, Number] | None:
    """Return the nearest poses that two dyads allow, exactly; None where there is none near."""
    start = z, u
    for _ in range(60):
        values, slopes = _closure(z, u, pair)
        # what remains along the allowed motion is taken back, so that the nearest is found
        back = np.stack([(start[0] - z).real, (start[0] - z).imag, np.angle(start[1] / u)], axis=-1)
        turned = np.linalg.pinv(slopes)
        step = np.einsum("nij,nj->ni", turned, -values - np.einsum("nij,nj->ni", slopes, back)) + back
        z = z + step[:, 0] + 1j * step[:, 1]
        u = u * np.exp(1j * step[:, 2])
        if np.max(np.abs(step)) < 1e-14:
            break
    for _ in range(4):
        values, slopes = _closure(z, u, pair)
        step = np.einsum("nij,nj->ni", np.linalg.pinv(slopes), -values)
        z, u = z + step[:, 0] + 1j * step[:, 1], u * np.exp(1j * step[:, 2])
    values, _ = _closure(z, u, pair)
    return (z, u) if np.isfinite(z).all() and np.max(np.abs(values)) < 1e-12 else None


def three_poses(task: PoseTask) -> Candidates:
    """Return linkages through three poses: pairs of dyads with given pivots, or pivots on a grid over the region."""
    return _family(task, dyads_of(task))


def few_poses_with_timing(task: TimedPointTask) -> Candidates:
    """Return four-bars and slider-cranks whose coupler point is at points when the crank has turned by angles."""
    turned = PoseTask("coupler", task.points, np.exp(1j * task.angles), conditions=Conditions())
    count = len(task.points)
    found = dyads_of(turned)
    if found.freedom:
        dyads = list(found) + (spread_over_curve(turned, found) if found.freedom == 1 else _of_grid(turned, found))
    else:
        dyads = list(found)
    # a slider has a cognate too, but two sliders have no crank
    pairs = [pair for pair in pairs_of(dyads) if {dyad.kind for dyad in pair} in ({RR}, {RR, PR})]
    made = [
        one for pair in (_some(pairs)[::2] if count < 5 else pairs) for one in crank_cognates(turned.z, turned.u, *pair)
    ]
    of = "4" if count == 5 else "a family"
    complete = f"{count_phrase(len(dyads), 'dyad')} of {of}, {count_phrase(len(made), 'linkage')}"
    note = found.note if count == 5 else f"{count} points with timing leave a family, of which some are tried"
    return Candidates(_same_crank(made), complete, note, found, is_family=count < 5)


def _same_crank(made: list[Linkage]) -> Iterator[Linkage]:
    """Yield linkages that their crank alone drives, for the angles are its."""
    for one in made:
        name = next(iter(one.drivers))
        yield one.driven_by(name)


def _family(task: PoseTask, found: Dyads) -> Candidates:
    """Return some linkages of a family of two freedoms in each dyad, or of a body that only shifts or turns."""
    if found.freedom == 1:
        dyads = [*found, *spread_over_curve(task, found)]
    elif found.basis.shape[0] == found.basis.shape[1]:
        return _of_special(task, found)
    else:
        dyads = _of_grid(task, found)
    at = [dyad for dyad in dyads if dyad.kind != PR and _is_given(dyad.fixed, task)]
    pairs = _some([pair for pair in pairs_of(dyads) if _uses(pair, at)])
    complete = f"{count_phrase(len(dyads), 'dyad')} of a family, {count_phrase(len(pairs), 'linkage')}"
    note = found.note or "every fixed pivot has a dyad through three poses: any two of them are a linkage"
    return Candidates(of_dyads(task.z, task.u, pairs, task.link), complete, note, found, is_family=True)


def _of_special(task: PoseTask, found: Dyads) -> Candidates:
    """Return parallel cranks for a body that only shifts on a circle; nothing is needed but one pair for others."""
    circle = circle_through(task.z)
    if "parallel cranks" not in found.note or circle is None:
        return Candidates((), "no linkage of two dyads", found.note, found, nearest=found.note)
    centre, radius, _ = circle
    arms = (0j, radius * 1j, complex(radius), radius * (1 + 1j)) if not task.conditions.ground else tuple(
        complex((place - centre) / task.u[0]) for place in task.conditions.ground)  # fmt: skip
    dyads = [Dyad(RR, complex(centre + task.u[0] * arm), arm, None, radius) for arm in arms]
    pairs = pairs_of(dyads)
    complete = f"{count_phrase(len(dyads), 'crank')} of a family, {count_phrase(len(pairs), 'parallelogram')}"
    return Candidates(of_dyads(task.z, task.u, pairs, task.link), complete, found.note, found, is_family=True)


def _is_given(place: complex, task: PoseTask) -> bool:
    """Return whether a fixed pivot is one of those that are given."""
    return any(abs(place - given) < GIVEN * extent(task.z) for given in task.conditions.ground)


def _uses(pair: tuple[Dyad, Dyad], at: list[Dyad]) -> bool:
    """Return whether a pair has as many of the dyads at given pivots as it can."""
    return sum(dyad in at for dyad in pair) >= min(len(at), 2)


def _some(pairs: list[tuple[Dyad, Dyad]]) -> list[tuple[Dyad, Dyad]]:
    """Return no more than `MOST_PAIRS`, spread evenly."""
    if len(pairs) <= MOST_PAIRS:
        return pairs
    return [pairs[int(k)] for k in np.linspace(0, len(pairs) - 1, MOST_PAIRS).round()]


def _nearest(found: Dyads, place: complex) -> Dyad:
    """Return the dyad of a curve whose fixed centre is nearest to a place."""
    try:
        return found.with_centre(place)
    except InvalidInput:
        apart = np.abs(found.curve.centres - place)
        return found.curve[int(np.nanargmin(np.where(np.isfinite(apart), apart, np.inf)))]


def spread_over_curve(task: PoseTask, found: Dyads) -> list[Dyad]:
    """Return dyads spread over the curve: within the conditions and of sensible lengths, by the arc of the centres."""
    curve, size = found.curve, extent(task.z)
    middle = complex(np.mean(task.z))
    with np.errstate(invalid="ignore"):
        good = (np.abs(curve.centres - middle) < LONGEST * size) & (curve.lengths < LONGEST * size)
        good &= (np.abs(curve.points) < LONGEST * size + np.abs(middle)) & (curve.lengths > 1e-3 * size)
    if task.conditions.region is not None:
        good &= np.array([task.conditions.holds(complex(c)) for c in curve.centres])
    if task.conditions.lengths is not None:
        low, high = task.conditions.lengths
        good &= (curve.lengths >= low) & (curve.lengths <= high)
    indices = np.flatnonzero(good)
    if not len(indices):
        return []
    # far centres count less: the arc of the curve seen from the middle of the poses
    seen = (curve.centres[indices] - middle) / (size + np.abs(curve.centres[indices] - middle))
    steps = np.abs(np.diff(seen)) * (np.diff(indices) == 1)
    along = np.append(0.0, np.cumsum(steps))
    places = (np.arange(OF_CURVE) + 0.5) * along[-1] / OF_CURVE
    chosen = np.unique(indices[np.clip(np.searchsorted(along, places), 0, len(indices) - 1)])
    return [curve[int(k)] for k in chosen]


def _of_grid(task: PoseTask, found: Dyads) -> list[Dyad]:
    """Return the dyads of given pivots, or of those on a grid over the region."""
    conditions, size = task.conditions, extent(task.z)
    middle = complex(np.mean(task.z))
    if conditions.region is None:
        low, high = middle - AROUND * size * (1 + 1j), middle + AROUND * size * (1 + 1j)
    else:
        low = complex(np.min(conditions.region.real), np.min(conditions.region.imag))
        high = complex(np.max(conditions.region.real), np.max(conditions.region.imag))
    steps = (np.arange(GRID) + 0.5) / GRID
    grid = [complex(low.real + s * (high - low).real, low.imag + t * (high - low).imag) for s in steps for t in steps]
    places = [*conditions.ground, *(place for place in grid if conditions.holds(place) and len(conditions.ground) < 2)]
    dyads = []
    for place in places:
        try:
            dyads.append(found.with_centre(place))
        except InvalidInput:
            continue
    for angle in (0.0, np.pi / 2) if len(conditions.ground) < 2 else ():
        for kind in (PR, "RP"):
            try:
                dyads.append(found.with_line(float(angle), kind))
            except InvalidInput:
                continue
    good = [dyad for dyad in dyads if dyad.length < LONGEST * size]
    if conditions.lengths is not None:
        low_length, high_length = conditions.lengths
        good = [dyad for dyad in good if dyad.kind != RR or low_length <= dyad.length <= high_length]
    return good
