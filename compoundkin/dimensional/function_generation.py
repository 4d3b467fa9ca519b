"""Function generators, crank-rockers and slider-cranks by their dead centres, crank-shapers.

The input and the output turn about known places, so that the pose of the output is known as the input sees it: the
coupler is a dyad between both, an RR dyad of a four-bar, and Burmester's theory finds it for up to five pairs of
values. The frame is such a dyad too, which leaves three of the four. With angles from the line of pivots Freudenstein's
equation

    K1 cos(psi) - K2 cos(phi) + K3 = cos(phi - psi),   K1 = d / a, K2 = d / c, K3 = (a^2 - b^2 + c^2 + d^2) / (2 a c)

is linear for three pairs. More pairs are approached: by least squares of the output's error, or by its least maximum, a
sequence of linear programs.

Sources: F. Freudenstein, Approximate synthesis of four-bar linkages, Trans. ASME 77 (1955) 853-861; J. M. McCarthy and
G. S. Soh, Geometric Design of Linkages, 2nd ed., Springer 2011, chapter 4; H. Alt, Zur Synthese der ebenen Mechanismen,
ZAMM 1 (1921) 373-398, and VDI 2130 (crank-rockers by dead centres, the best transmission angle).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number, wrapped
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dimensional.candidates import COUPLER, Candidates, Linkage, of_dyads
from compoundkin.dimensional.dyad_equations import PR, RP, RR, Dyad
from compoundkin.dimensional.dyads import Dyads, dyads_of
from compoundkin.dimensional.task_words import chebyshev_spacing
from compoundkin.dimensional.tasks import (
    INPUT,
    OUTPUT,
    FunctionTask,
    PoseTask,
    StrokeTask,
    SwingTask,
)
from compoundkin.model.elements import link
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.prismatic import slide

# Equations are singular below this part of their size.
SINGULAR = 1e-10
# Dyads of coupler and frame nearer to each other than this are the frame itself.
FRAME_ITSELF = 1e-6
# What does not assemble misses by so much, radians or travels of the slide; so many of the best fits are shown.
FAR, FITTED = 10.0, 3
# Fits so many times worse than the best are none.
POORER = 30.0
# Members of a family that are shown, and those among which the best is sought.
SHOWN, SOUGHT = 9, 2000
# The proportions of a crank-shaper: the pivots' distance and the rod, in parts of the lever and of the stroke.
PIVOTS, ROD = 0.55, 0.7


# --- function generators --------------------------------------------------------------------------------------


def exact_function(task: FunctionTask) -> Candidates:
    """Return all linkages for three to five pairs, whose zeros of input and output are free but for `absolute` ones."""
    if task.absolute:
        return _absolute(task)
    relative = _as_seen_by_input(task)
    found = dyads_of(relative)
    chosen = [dyad for dyad in found if dyad.kind == (RP if task.linkage == "inverted" else RR)]
    if found.freedom == 1:
        chosen += _of_curve(task, found)
    elif found.freedom > 1:
        chosen += _of_zeros(task, found)
    couplers = [dyad for dyad in chosen if not _is_frame(task, dyad)]
    most = {"four-bar": 3, "slider-crank": 3, "inverted": 1}[task.linkage]
    whole = f"{count_phrase(len(couplers), 'linkage')} of {most} at most"
    complete = whole if not found.freedom else f"{count_phrase(len(couplers), 'linkage')} of a family"
    made = [replace(_generator(task, dyad), error=_overlay(task, dyad)) for dyad in couplers]
    return Candidates(made, complete, found.note, nearest="" if made else found.note, is_family=found.freedom > 0)


def _as_seen_by_input(task: FunctionTask) -> PoseTask:
    """Return the poses of the output as the input sees them: the frame turned back by the input's angles.

    The input turns about zero; the output turns about 1, or slides along the x axis.
    """
    back = np.exp(-1j * task.inputs)
    if task.linkage == "slider-crank":
        return PoseTask(OUTPUT, back * task.outputs, back)
    return PoseTask(OUTPUT, back, back * np.exp(1j * task.outputs))


def _unit(linkage: str, outputs: Number) -> float:
    """Return the length by which a generator is measured: the travel of its slide, else its frame."""
    return float(np.ptp(outputs)) if linkage == "slider-crank" else 1.0


def _is_frame(task: FunctionTask, dyad: Dyad) -> bool:
    """Return whether a dyad joins both pivots, which are always at one distance."""
    return task.linkage != "slider-crank" and abs(dyad.fixed) + abs(dyad.moving) < FRAME_ITSELF


def _of_curve(task: FunctionTask, found: Dyads) -> list[Dyad]:
    """Return some dyads of the curve of four pairs."""
    curve = found.curve
    size = _unit(task.linkage, task.outputs)
    with np.errstate(invalid="ignore"):
        near = np.maximum.reduce([np.abs(curve.centres), np.abs(curve.points), curve.lengths]) < 8.0 * size
        good = np.flatnonzero(near & (np.abs(curve.centres) > 0.05 * size))
    if task.linkage == "inverted" or not len(good):
        return []
    return [curve[int(k)] for k in good[np.linspace(0, len(good) - 1, 4 * SHOWN).round().astype(int)]]


def _of_zeros(task: FunctionTask, found: Dyads) -> list[Dyad]:
    """Return some dyads of three pairs: joints of the input on a grid of directions and lengths, or guides' angles."""
    if task.linkage == "inverted":
        return _guides(found)
    size = _unit(task.linkage, task.outputs)
    arms = [size * r * np.exp(1j * t) for r in (0.3, 0.6, 1.0) for t in np.arange(12) * TURN / 12]
    made = []
    for arm in arms:
        try:
            dyad = found.with_centre(arm)
        except InvalidInput:
            continue
        if dyad.kind == RR:
            made.append(dyad)
    return made


def _guides(found: Dyads) -> list[Dyad]:
    """Return the guides of three pairs in directions of the output all around."""
    made = []
    for angle in np.arange(4 * SHOWN) * np.pi / (4 * SHOWN):
        try:
            made.append(found.with_line(float(angle), RP))
        except InvalidInput:
            continue
    return made


def _generator(task: FunctionTask, dyad: Dyad) -> Linkage:
    """Return the linkage of a coupler, a dyad between input and output."""
    turn = np.exp(1j * task.inputs)
    joint = turn * dyad.fixed
    title = f"{task.linkage.capitalize()} function generator"
    crank = Dyad(RR, 0j, 0j, None, abs(dyad.fixed))
    phase = float(np.angle(dyad.fixed))
    if task.linkage == "inverted":
        return _swinging_guide(task, dyad, title)
    if task.linkage == "slider-crank":
        end = task.outputs + dyad.moving
        slider = Dyad(PR, complex(end[0]), 0j, 1 + 0j)
        return _coupled(joint, end, crank, slider, title, phase, float(dyad.moving.real))
    end = 1.0 + np.exp(1j * task.outputs) * dyad.moving
    rocker = Dyad(RR, 1 + 0j, 0j, None, abs(dyad.moving))
    return _coupled(joint, end, crank, rocker, title, phase, float(np.angle(dyad.moving)))


def _coupled(
    joint: Number, end: Number, crank: Dyad, output: Dyad, title: str, phase: float, other_phase: float
) -> Linkage:
    """Return the linkage of a crank and an output with the joints of the coupler at all positions."""
    u = (end - joint) / np.abs(end - joint)
    length = float(np.mean(np.abs(end - joint)))
    second = replace(output, moving=complex(length))
    made = next(of_dyads(joint, u, [(crank, second)], COUPLER), None)
    if made is None:
        what = "crank and output would have their joints in one place"
        raise InvalidInput(Problem("pairs", what, "both turn alike: a parallelogram or a pair of gears does that"))
    zero = np.rad2deg(phase)
    other = f"{np.rad2deg(other_phase):.6g} degrees" if output.kind == RR else f"{other_phase:.6g}"
    source = f"Zero of the input: the crank is at {zero:.6g} degrees more; of the output: it is at {other} more."
    return replace(made.driven_by(INPUT), title=title, source=source)


def _swinging_guide(task: FunctionTask, dyad: Dyad, title: str) -> Linkage:
    """Return the crank whose pin slides on a guide of the output, which swings about 1."""
    assert dyad.direction is not None
    turn, swung = np.exp(1j * task.inputs), np.exp(1j * task.outputs)
    joint = turn * dyad.fixed
    crank = np.abs(dyad.fixed)
    places = {"A0": 0j, "B0": 1 + 0j, "A": complex(joint[0]), "B": complex(1.0 + swung[0] * dyad.moving)}
    links = (
        link(FRAME, A0=(0, 0), B0=(1, 0)),
        link(INPUT, A0=(0, 0), A=(float(crank), 0)),
        link("block", A=(0, 0)),
        link(OUTPUT, B0=(0, 0), B=(float(dyad.moving.real), float(dyad.moving.imag))),
    )
    guide = slide("block", on=OUTPUT, at="A", through="B", angle=float(np.angle(dyad.direction)), name="guide")
    still = np.zeros(len(turn), complex)
    z = {FRAME: still, INPUT: still, "block": joint, OUTPUT: still + 1.0}
    arm = dyad.fixed / crank
    u = {FRAME: still + 1.0, INPUT: turn * arm, "block": swung * dyad.direction, OUTPUT: swung}
    drivers = {INPUT: np.angle(u[INPUT])}
    source = f"Zero of the input: the crank is at {np.rad2deg(np.angle(dyad.fixed)):.6g} degrees more."
    return Linkage(title, links, (guide,), places, z, u, drivers, (0j, 1 + 0j), (float(crank),), source=source)


def _absolute(task: FunctionTask) -> Candidates:
    """Return the linkage for three pairs from the line of pivots: one linear equation each."""
    phi, psi = task.inputs, task.outputs
    if task.linkage == "inverted" or len(phi) != 3:
        what = f"{count_phrase(len(phi), 'pair')} of absolute values do not determine a {task.linkage} linkage"
        raise InvalidInput(Problem("pairs", what, "give three of a four-bar or slider-crank, or leave absolute out"))
    if task.linkage == "slider-crank":
        # s^2 = 2 a s cos(phi) + 2 a e sin(phi) + b^2 - a^2 - e^2
        unit = _unit(task.linkage, psi)
        s = psi / unit
        k = _solved(np.stack([s * np.cos(phi), np.sin(phi), np.ones(3)], axis=-1), s**2, 1)
        a, e = unit * float(k[0] / 2.0), unit * float(k[1] / k[0])
        if k[2] * unit**2 + a**2 + e**2 <= 0.0:
            return Candidates((), "no linkage of 1", nearest="the rod's length would be imaginary")
        end = psi + 1j * e
        joint = a * np.exp(1j * phi)
        made = _coupled(joint, end, Dyad(RR, 0j, 0j, None, abs(a)), Dyad(PR, complex(end[0]), 0j, 1 + 0j),
                        "Slider-crank function generator", 0.0 if a > 0 else np.pi, 0.0)  # fmt: skip
        return Candidates((made,), "1 linkage of 1")
    k = _solved(_freudenstein_rows(phi, psi), np.cos(phi - psi), 2)
    a, c = (float(1.0 / value) for value in k[:2])
    square = a**2 + c**2 + 1.0 - 2.0 * a * c * k[2]
    if square <= 0.0:
        return Candidates((), "no linkage of 1", nearest="the coupler's length would be imaginary")
    end = 1.0 + c * np.exp(1j * psi)
    made = _coupled(a * np.exp(1j * phi), end, Dyad(RR, 0j, 0j, None, abs(a)), Dyad(RR, 1 + 0j, 0j, None, abs(c)),
                    "Four-bar function generator", 0.0 if a > 0 else np.pi, 0.0 if c > 0 else np.pi)  # fmt: skip
    return Candidates((made,), "1 linkage of 1")


def _freudenstein_rows(phi: Number, psi: Number) -> Number:
    return np.stack([np.cos(psi), -np.cos(phi), np.ones(len(phi))], axis=-1)


def _solved(rows: Number, right: Number, count: int) -> Number:
    """Return the solution of three equations whose first numbers, so many, are not zero. Raises InvalidInput."""
    sizes = np.linalg.svd(rows, compute_uv=False)
    found: Number = np.linalg.lstsq(rows, right, rcond=None)[0]
    if sizes[-1] < SINGULAR * sizes[0] or np.min(np.abs(found[:count])) < SINGULAR:
        what = "the three pairs do not determine a linkage: a link would be endless or nothing"
        raise InvalidInput(Problem("pairs", what, "move one of them a little"))
    return found


# --- overlay: the error over the whole range, least squares and minimax ------------------------------------------


class _Generator(NamedTuple):
    """A generator in numbers: its kind, `x` and which of the two ways to assemble it.

    `x` is (crank, coupler, rocker, zero of the input, of the output) of a four-bar, (crank, rod, offset, zeros) of a
    slider-crank, (crank, offset of the guide, zeros) of an inverted one.
    """

    linkage: str
    x: Number
    sign: float

    def outputs(self, phi: Number) -> Number:
        """Return the output for input angles, NaN where it does not assemble."""
        x = self.x
        joint = x[0] * np.exp(1j * (phi + x[-2]))
        with np.errstate(invalid="ignore"):
            if self.linkage == "slider-crank":
                found = joint.real + self.sign * np.sqrt(x[1] ** 2 - (x[2] - joint.imag) ** 2)
            elif self.linkage == "four-bar":
                arm = joint - 1.0
                cosine = (np.abs(arm) ** 2 + x[2] ** 2 - x[1] ** 2) / (2.0 * x[2] * np.abs(arm))
                found = np.angle(arm) + self.sign * np.arccos(cosine)
            else:
                arm = joint - 1.0
                swung = np.arcsin(x[1] / np.abs(arm))
                found = np.angle(arm) - (swung if self.sign > 0.0 else np.pi - swung)
        given: Number = found - x[-1]
        return given

    def errors(self, phi: Number, wanted: Number) -> Number:
        """Return by how much the output misses what is wanted."""
        off = self.outputs(phi) - wanted
        return off if self.linkage == "slider-crank" else wrapped(off)

    def in_unit(self, unit: float) -> _Generator:
        """Return the generator with the lengths of a slider-crank, and its zero of the slide, so many times as long."""
        if self.linkage != "slider-crank":
            return self
        return self._replace(x=self.x * [unit, unit, unit, 1.0, unit])


def _as_generator(task: FunctionTask, dyad: Dyad) -> _Generator:
    """Return the generator of a coupler, assembled as it is at most of the positions."""
    crank, zero = abs(dyad.fixed), float(np.angle(dyad.fixed))
    if task.linkage == "slider-crank":
        x = [crank, dyad.length, dyad.moving.imag, zero, dyad.moving.real]
    elif task.linkage == "four-bar":
        x = [crank, dyad.length, abs(dyad.moving), zero, float(np.angle(dyad.moving))]
    else:
        assert dyad.direction is not None
        way = dyad.direction
        x = [crank, -(np.conj(way) * dyad.moving).imag, zero, float(np.angle(way))]
        x[1] = -x[1]
    both = [_Generator(task.linkage, np.array(x, dtype=float), sign) for sign in (1.0, -1.0)]
    misses = [np.median(np.nan_to_num(np.abs(one.errors(task.inputs, task.outputs)), nan=np.inf)) for one in both]
    return both[int(np.argmin(misses))]


def _overlay(task: FunctionTask, dyad: Dyad) -> float:
    """Return the greatest error over the whole range of a function, 0 of pairs alone."""
    if task.whole is None:
        return 0.0
    off = np.abs(_as_generator(task, dyad).errors(task.whole[:, 0], task.whole[:, 1]))
    return float(np.max(np.nan_to_num(off, nan=np.inf)))


def approached_function(task: FunctionTask) -> Candidates:
    """Return the linkages with the least error over many pairs: in the mean square, and the greatest."""
    from scipy.optimize import least_squares

    wanted = np.stack([task.inputs, task.outputs], axis=-1) if task.whole is None else task.whole
    phi, given = wanted.T
    unit = _unit(task.linkage, given)
    psi = given / unit
    starts = list(_starts(task, phi, psi))
    free = slice(None, -2) if task.absolute else slice(None)
    ends = []
    for start in starts:

        def errors(x: Number, start: _Generator = start) -> Number:
            return np.nan_to_num(_moved(start, x, free).errors(phi, psi), nan=FAR)

        if np.max(np.abs(errors(start.x[free]))) < FAR:
            found = least_squares(errors, start.x[free], x_scale="jac", max_nfev=200)
            ends.append((float(np.sqrt(np.mean(found.fun**2))), _moved(start, found.x, free)))
    ends.sort(key=lambda end: end[0])
    best = [end for k, end in enumerate(ends) if all(abs(end[0] - other[0]) > 1e-6 * end[0] for other in ends[:k])]
    made = []
    for _, one in [end for end in best if end[0] < POORER * best[0][0]][:FITTED]:
        least = _minimax(one, phi, psi, free)
        for fit, how in ((one, "least squares"), (least, "minimax")):
            made.append(_fitted(task, fit.in_unit(unit), phi, given, how))
    complete = f"the best {len(made) // 2} of {count_phrase(len(starts), 'start')}, each by least squares and minimax"
    return Candidates(made, complete, "" if made else "no start assembles over the whole range", is_family=True)


def _moved(start: _Generator, x: Number, free: slice) -> _Generator:
    numbers = start.x.copy()
    numbers[free] = x
    return start._replace(x=numbers)


def _starts(task: FunctionTask, phi: Number, psi: Number) -> Iterator[_Generator]:
    """Yield generators that meet some of the pairs, those next to Chebyshev's places, exactly."""
    if task.absolute:
        few = _nearest_pairs(phi, 3)
        for one in _absolute(replace(task, inputs=phi[few], outputs=psi[few], whole=None)).linkages:
            end = one.dyads[1]
            u = np.exp(1j * one.drivers[INPUT])
            x = [one.lengths[0] * np.sign((u * np.exp(-1j * phi[few])).real[0]), one.lengths[-1]]
            joint = one.z[COUPLER] + one.u[COUPLER] * end.moving
            x += [float(joint[0].imag)] if task.linkage == "slider-crank" else [
                float(((joint[0] - 1.0) * np.exp(-1j * psi[few][0])).real)]  # fmt: skip
            yield from (_Generator(task.linkage, np.array([*x, 0.0, 0.0]), sign) for sign in (1.0, -1.0))
        return
    for count in (5, 4, 3):
        few = _nearest_pairs(phi, count)
        part = replace(task, inputs=phi[few], outputs=psi[few], whole=None)
        found = dyads_of(_as_seen_by_input(part))
        wanted = RP if task.linkage == "inverted" else RR
        chosen = [dyad for dyad in found if dyad.kind == wanted]
        chosen += _of_curve(part, found) if found.freedom == 1 else _of_zeros(part, found) if found.freedom else []
        yield from (_as_generator(part, dyad) for dyad in chosen if not _is_frame(part, dyad))


def _nearest_pairs(phi: Number, count: int) -> Number:
    """Return the indices of pairs next to Chebyshev's places, in order."""
    places = chebyshev_spacing(float(np.min(phi)), float(np.max(phi)), count)
    return np.unique(np.argmin(np.abs(phi[:, None] - places), axis=0))


def _minimax(start: _Generator, phi: Number, psi: Number, free: slice) -> _Generator:
    """Return the generator with the least greatest error: linear programs with a shrinking bound on the steps."""
    from scipy.optimize import linprog

    x, room = start.x[free].copy(), 0.05
    worst = float(np.max(np.abs(start.errors(phi, psi))))
    scale = np.maximum(np.abs(x), 0.1)
    for _ in range(40):
        here = _moved(start, x, free).errors(phi, psi)
        steps = 1e-7 * scale
        slopes = np.stack([(_moved(start, x + step, free).errors(phi, psi) - here) / size
                           for step, size in zip(np.diag(steps), steps, strict=True)], axis=-1)  # fmt: skip
        ones = np.ones((len(phi), 1))
        if not np.isfinite(slopes).all():
            break
        bound = [(-room * s, room * s) for s in scale]
        found = linprog([0.0] * len(x) + [1.0], np.block([[slopes, -ones], [-slopes, -ones]]),
                        np.concatenate([-here, here]), bounds=[*bound, (0.0, None)])  # fmt: skip
        if found.x is None:
            break
        off = _moved(start, x + found.x[:-1], free).errors(phi, psi)
        then = float(np.max(np.nan_to_num(np.abs(off), nan=np.inf)))
        if then < worst:
            x, gain, worst = x + found.x[:-1], worst - then, then
            if gain < 1e-10 * worst:
                break
        else:
            room /= 4.0
            if room < 1e-9:
                break
    return _moved(start, x, free)


def _fitted(task: FunctionTask, one: _Generator, phi: Number, psi: Number, how: str) -> Linkage:
    """Return the linkage of a fitted generator at some positions, with its error over all pairs."""
    worst = float(np.max(np.abs(one.errors(phi, psi))))
    few = np.linspace(0, len(phi) - 1, min(len(phi), 9)).round().astype(int)
    x, at = one.x, phi[few]
    there = one.outputs(at)
    turn = np.exp(1j * (at + x[-2]))
    title = f"{task.linkage.capitalize()} function generator, {how}"
    if task.linkage == "inverted":
        guide = np.exp(1j * x[-1])
        dyad = Dyad(RP, complex(x[0] * np.exp(1j * x[-2])), complex(1j * x[1] * guide), complex(guide))
        made = _swinging_guide(replace(task, inputs=at, outputs=there), dyad, title)
    elif task.linkage == "slider-crank":
        end = there + x[-1] + 1j * x[2]
        slider = Dyad(PR, complex(end[0]), 0j, 1 + 0j)
        made = _coupled(x[0] * turn, end, Dyad(RR, 0j, 0j, None, abs(x[0])), slider, title, x[-2], x[-1])
    else:
        end = 1.0 + x[2] * np.exp(1j * (there + x[-1]))
        rocker = Dyad(RR, 1 + 0j, 0j, None, abs(x[2]))
        made = _coupled(x[0] * turn, end, Dyad(RR, 0j, 0j, None, abs(x[0])), rocker, title, x[-2], x[-1])
    return replace(made, error=worst)


# --- dead centres ---------------------------------------------------------------------------------------------


def crank_rocker(task: SwingTask) -> Candidates:
    """Return crank-rockers by swing and time ratio, the one with the best transmission angle first."""
    turn = TURN * task.time_ratio / (1.0 + task.time_ratio)
    best, family = _crank_rockers(task.angle, turn)
    made = (_at_dead_centres(a, b, c, theta, turn) for a, b, c, theta, _ in (best, *family))
    note = "the crank's direction at a dead centre is free: the first has the family's best transmission angle"
    return Candidates(made, f"the best of a family and {count_phrase(len(family), 'other')}", note, is_family=True)


def _crank_rockers(swing: float, turn: float) -> tuple[tuple[float, ...], list[tuple[float, ...]]]:
    """Return (a, b, c, crank angle at the far dead centre, sense) of the best crank-rocker, and of some of the family.

    The frame is 1. Raises InvalidInput where no crank turns fully.
    """
    theta = (np.arange(SOUGHT) + 0.5) * TURN / SOUGHT
    parts = [_dead_centre_family(theta, swing, turn, sense) for sense in (1.0, -1.0)]
    quality = np.stack([part[3] for part in parts])
    if not np.isfinite(quality).any():
        what = f"no crank-rocker swings by {np.rad2deg(swing):.4g} degrees while its crank turns {np.rad2deg(turn):.4g}"
        raise InvalidInput(Problem("swing", what, "give a lesser time ratio, or a wider swing"))
    k, i = np.unravel_index(int(np.nanargmax(quality)), quality.shape)
    sense = (1.0, -1.0)[int(k)]
    step = TURN / SOUGHT
    best = float(theta[i])
    for _ in range(12):
        near = best + step * np.linspace(-1.0, 1.0, 21)
        values = _dead_centre_family(near, swing, turn, sense)[3]
        best, step = float(near[int(np.nanargmax(values))]), step / 8.0
    chosen = [(float(t), sense) for t in _spread_over(theta, quality[int(k)])]
    numbers = [(*(float(v[0]) for v in _dead_centre_family(np.array([t]), swing, turn, s)[:3]), t, s)
               for t, s in ((best, sense), *chosen)]  # fmt: skip
    return numbers[0], numbers[1:]


def _spread_over(theta: Number, quality: Number) -> Number:
    """Return directions spread over those that have a quality."""
    good = np.flatnonzero(np.isfinite(quality))
    chosen: Number = theta[good[np.linspace(0, len(good) - 1, SHOWN + 2).round().astype(int)[1:-1]]]
    return chosen


def _dead_centre_family(theta: Number, swing: float, turn: float, sense: float) -> tuple[Number, ...]:
    """Return crank, coupler, rocker and least transmission angle by the crank's direction at the far dead centre.

    There the rocker's joint is at b + a, at the near one at b - a in the direction opposite to the crank's: two linear
    equations in these two. NaN where it is no crank-rocker.
    """
    far, near = np.exp(1j * theta), np.exp(1j * (theta + turn - np.pi))
    turned = np.exp(1j * sense * swing)
    # q near - 1 = turned (p far - 1)
    columns = near, -turned * far
    matrix = np.stack([np.stack([v.real for v in columns], -1), np.stack([v.imag for v in columns], -1)], -2)
    right = 1.0 - turned
    with np.errstate(all="ignore"):
        determinant = matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0]
        q = (right.real * matrix[:, 1, 1] - right.imag * matrix[:, 0, 1]) / determinant
        p = (matrix[:, 0, 0] * right.imag - matrix[:, 1, 0] * right.real) / determinant
        a, b = (p - q) / 2.0, (p + q) / 2.0
        c = np.abs(p * far - 1.0)
        cosines = [(b**2 + c**2 - (1.0 + s * a) ** 2) / (2.0 * b * c) for s in (1.0, -1.0)]
        angles = [np.arccos(np.clip(v, -1.0, 1.0)) for v in cosines]
        least = np.minimum.reduce([*angles, *(np.pi - angle for angle in angles)])
        longest = np.maximum.reduce([b, c, np.ones(len(a))])
        # a crank-rocker's rocker stays on one side of the line of pivots
        good = (a > 0.0) & (b > a) & (a < c) & (a < 1.0) & (a + longest < b + c + 1.0 - longest)
        good &= (p * far).imag * (q * near).imag > 0.0
    return a, b, c, np.where(good & np.isfinite(least), least, np.nan)


def _at_dead_centres(a: float, b: float, c: float, theta: float, turn: float) -> Linkage:
    """Return the crank-rocker with its two dead centres as positions, in the sense of the longer time."""
    crank = np.exp(1j * np.array([theta, theta + turn]))
    ends = np.array([(b + a) * crank[0], -(b - a) * crank[1]])
    made = _coupled(a * crank, ends, Dyad(RR, 0j, 0j, None, a), Dyad(RR, 1 + 0j, 0j, None, c), "Crank-rocker", 0.0, 0.0)
    return replace(made, source="")


def stroke_linkage(task: StrokeTask) -> Candidates:
    """Return slider-cranks or a crank-shaper by stroke and time ratio."""
    if task.linkage == "crank-shaper":
        return _crank_shaper(task)
    turn = TURN * task.time_ratio / (1.0 + task.time_ratio)
    alpha, s = turn - np.pi, task.length
    if task.offset is not None and (alpha < 1e-12) != (task.offset == 0.0):
        what = f"an offset of {task.offset:g} and a time ratio of {task.time_ratio:g} do not go together"
        raise InvalidInput(Problem("offset", what, "in line both strokes take the same time, else they do not"))
    if alpha < 1e-12:
        rods = s * np.array([1.5, 1.0, 0.75, 2.0, 3.0])
        made = [_slider_crank(s / 2.0, float(rod), 0.0, s) for rod in rods]
        note = "in line every rod longer than the crank does"
        return Candidates(made, f"{len(made)} of a family", note, is_family=True)
    if task.offset is not None:
        numbers = _by_offset(np.array([task.offset]), s, alpha)
        if not np.isfinite(numbers[2][0]):
            what = f"no slider-crank with the offset {task.offset:g} has that stroke and time ratio"
            raise InvalidInput(Problem("offset", what, f"give less than {_greatest_offset(s, alpha):.6g}"))
        made = [_slider_crank(float(numbers[0][0]), float(numbers[1][0]), task.offset, s)]
        return Candidates(made, "1 linkage of 1")
    offsets = _greatest_offset(s, alpha) * (np.arange(SOUGHT) + 0.5) / SOUGHT
    a, b, quality = _by_offset(offsets, s, alpha)
    if not np.isfinite(quality).any():
        what = f"no slider-crank has the time ratio {task.time_ratio:g} and turns fully"
        raise InvalidInput(Problem("time_ratio", what, "give a lesser one, or take a crank-shaper"))
    best = int(np.nanargmax(quality))
    chosen = [best, *np.flatnonzero(np.isfinite(quality))[:: max(1, int(np.isfinite(quality).sum()) // SHOWN)].tolist()]
    made = [_slider_crank(float(a[k]), float(b[k]), float(offsets[k]), s) for k in chosen]
    note = "the offset of the guide is free: the first has the best transmission angle"
    return Candidates(made, f"the best of a family and {len(made) - 1} others", note, is_family=True)


def _greatest_offset(s: float, alpha: float) -> float:
    """Return the offset at which crank's pivot and both dead centres are on the highest circle of the angle."""
    return float(s / (2.0 * np.tan(alpha / 2.0)))


def _by_offset(e: Number, s: float, alpha: float) -> tuple[Number, Number, Number]:
    """Return crank, rod and least transmission angle by the offset: the triangle of the pivot and both dead centres."""
    product = s * e / np.sin(alpha)
    with np.errstate(all="ignore"):
        both = s**2 + 2.0 * product * np.cos(alpha)
        plus, minus = np.sqrt(both + 2.0 * product), np.sqrt(both - 2.0 * product)
        a, b = minus / 2.0, plus / 2.0
        # the slide's normal and the rod
        least = np.arccos((a + e) / b)
    # both dead centres are on one side of the crank's pivot: the slide does not pass below it
    good = np.isfinite(a) & np.isfinite(least) & (a > 0.0) & (b > a + e) & ((a + b) ** 2 - e**2 > s**2)
    return a, b, np.where(good, least, np.nan)


def _slider_crank(a: float, b: float, e: float, s: float) -> Linkage:
    """Return the slider-crank with its dead centres as positions; the guide is above the crank's pivot by `e`."""
    far = float(np.sqrt((b + a) ** 2 - e**2))
    ends = np.array([far, far - s]) + 1j * e
    crank = np.array([ends[0] / abs(ends[0]), -ends[1] / abs(ends[1])])
    slider = Dyad(PR, complex(ends[0]), 0j, 1 + 0j)
    made = _coupled(a * crank, ends, Dyad(RR, 0j, 0j, None, a), slider, "Slider-crank", 0.0, 0.0)
    return replace(made, source="")


def _crank_shaper(task: StrokeTask) -> Candidates:
    """Return the crank-shaper: the lever swings by the angle by which the crank's turns differ from a half turn."""
    swing = np.pi * (task.time_ratio - 1.0) / (task.time_ratio + 1.0)
    if swing < 1e-9:
        raise InvalidInput(Problem("time_ratio", "a crank-shaper with equal times does not swing", "give more than 1"))
    half, s = swing / 2.0, task.length
    lever = s / (2.0 * np.sin(half))
    pivots = PIVOTS * lever
    crank, rod = pivots * np.sin(half), ROD * s
    high = lever * (1.0 + np.cos(half)) / 2.0
    turned = np.array([-half, np.pi + half]) + 0j
    pin = 1j * pivots + crank * np.exp(1j * turned.real)
    arm = pin / np.abs(pin)
    tip = lever * arm
    ram = tip.real + np.sqrt(rod**2 - (high - tip.imag) ** 2) + 1j * high
    links = (
        link(FRAME, A0=(0, float(pivots)), B0=(0, 0), D0=(0, float(high))),
        link(INPUT, A0=(0, 0), A=(float(crank), 0)), link("block", A=(0, 0)),
        link("lever", B0=(0, 0), C=(float(lever), 0)), link("rod", C=(0, 0), D=(float(rod), 0)), link("ram", D=(0, 0)),
    )  # fmt: skip
    pairs = (slide("block", on="lever", at="A", through="B0", angle=0.0, name="slot"),
             slide("ram", on=FRAME, at="D", through="D0", angle=0.0, name="guide"))  # fmt: skip
    places = {"A": complex(pin[0]), "C": complex(tip[0]), "D": complex(ram[0])}
    still = np.zeros(2, complex)
    z = {FRAME: still, INPUT: still + 1j * pivots, "block": pin, "lever": still, "rod": tip, "ram": ram}
    u = {FRAME: still + 1.0, INPUT: np.exp(1j * turned.real), "block": arm, "lever": arm,
         "rod": (ram - tip) / rod, "ram": still + 1.0}  # fmt: skip
    made = Linkage("Crank-shaper", links, pairs, places, z, u, {INPUT: turned.real}, (1j * pivots, 0j),
                   (float(crank), float(lever), float(rod)), outputs=("guide.value",))  # fmt: skip
    note = f"the pivots are {PIVOTS:g} of the lever apart, the rod is {ROD:g} of the stroke: both are free"
    return Candidates((made,), "1 linkage of a family", note, is_family=True)
