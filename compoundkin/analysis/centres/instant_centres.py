"""The instant centres of a motion: by geometry alone, run over blocks of poses, and the velocities they give.

Velocities from centres and the drivers' rates are independent of the solved ones, and verify them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple, diagram_of
from compoundkin.analysis.centres.derivation import Derivation, DerivationStep, SolvedCentre, crossing_text, derive
from compoundkin.analysis.centres.driver_rates import DriverRates, at_poses, or_infinite
from compoundkin.analysis.centres.evaluation import Evaluation, recompute
from compoundkin.analysis.centres.homogeneous import OwnCoordinates, PrimaryCentres, cross, dot, norm
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.poses import FIXED, Pose
from compoundkin.kinematics import Motion
from compoundkin.kinematics.driver_values import fit
from compoundkin.kinematics.finding import SLOWEST
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.contract import Line

# A centre farther away than this many times the mechanism's size is at infinity: rounding hides anything farther.
INFINITY = 1e13
# Below this conditioning fewer than four digits of a centre are left: it is not given.
NOTHING = 1e-12


class Status(IntEnum):
    """The status of a centre at a pose."""

    FOUND = 0
    NOT_ASSEMBLED = 1
    SINGULAR = 2  # every derivation degenerates at this pose
    AT_REST = 3  # the two links do not move relative to each other
    UNDETERMINED = 4  # geometry and rates do not give it


@dataclass(frozen=True, repr=False)
class Centre(ShortRepr):
    """The relative instant centre of two links. Arrays of the motion's shape, NaN where `status` is not FOUND.

    `homogeneous` (..., 3) is (x, y, w) in the user's length unit, a unit vector in the mechanism's own
    coordinates. `conditioning` is 1 where the centre is as exact as a pin, near 0 where rounding is magnified.
    `how` is its derivation, `how_at` that at a pose where other lines were better.
    """

    links: tuple[str, str]
    how: str
    homogeneous: Number
    conditioning: Number
    status: Number
    size: Number
    elsewhere: tuple[Number, tuple[str, ...]]

    @cached_property
    def at_infinity(self) -> Number:
        """Whether it is at infinity, a bool array."""
        x, y, w = np.moveaxis(self.homogeneous, -1, 0)
        with np.errstate(invalid="ignore"):
            return np.asarray(np.abs(w) * (INFINITY * self.size) <= np.hypot(x, y))

    @cached_property
    def point(self) -> Number:
        """Its place, a complex array; inf at infinity."""
        x, y, w = np.moveaxis(self.homogeneous, -1, 0)
        near = ~self.at_infinity
        with np.errstate(all="ignore"):
            return np.where(near, (x + 1j * y) / np.where(near, w, 1.0), complex(np.inf))

    @cached_property
    def direction(self) -> Number:
        """The direction in which it is at infinity, a unit vector of either sign. NaN where it is finite."""
        x, y, _ = np.moveaxis(self.homogeneous, -1, 0)
        with np.errstate(all="ignore"):
            return np.where(self.at_infinity, (x + 1j * y) / np.hypot(x, y), complex(np.nan, np.nan))

    @property
    def found(self) -> Number:
        """Whether it is determined, a bool array."""
        return np.asarray(self.status == Status.FOUND)

    def how_at(self, *pose: int) -> str:
        """Return its derivation at one pose, an index into the motion's shape. Raises InvalidInput outside it."""
        shape = np.shape(self.status)
        if len(pose) != len(shape) or any(not -n <= k < n for k, n in zip(pose, shape, strict=True)):
            raise InvalidInput(Problem("pose", f"{pose} is not a pose of a motion of shape {shape}"))
        flat = int(np.ravel_multi_index([k % n for k, n in zip(pose, shape, strict=True)], shape)) if shape else 0
        status = Status(int(np.ravel(self.status)[flat]))
        if status is not Status.FOUND:
            return status.name.lower().replace("_", " ")
        places, texts = self.elsewhere
        at = np.flatnonzero(places == flat)
        return texts[int(at[0])] if at.size else self.how


@dataclass(frozen=True, eq=False)
class CentreVectors:
    """The centres of a motion as unit vectors in own coordinates, by couples.

    `spread` is their magnification of errors, `lines` the two lines where other ones than the derivation's were taken.
    """

    motion: Motion
    plan: Derivation
    scale: OwnCoordinates
    places: PrimaryCentres
    units: dict[Couple, Number]
    spread: dict[Couple, Number]
    lines: dict[Couple, tuple[Number, Number, Number]]

    def trusted(self, c: Couple) -> Number:
        """Return a centre's unit vectors, NaN where it is ill-conditioned."""
        return np.where(self.spread[c] * LEAST_CONDITIONING <= 1.0, self.units[c], np.nan)


@dataclass(frozen=True, eq=False)
class Centres(CentreVectors, DisplaysHtml):
    """All n (n - 1) / 2 instant centres of a motion. ``centres["crank", "bar"]``, either link first."""

    def derivation(self) -> tuple[DerivationStep, ...]:
        """Return the steps in order. Primary centres first, then each secondary one with the lines that give it.

        Links that never move relative to each other have no centre and no step.
        """
        return self.plan.steps

    def __getitem__(self, links: tuple[str, str]) -> Centre:
        i, j = self._numbers(links)
        names = (self.plan.diagram.links[i], self.plan.diagram.links[j])
        c = couple(self.plan.body[i], self.plan.body[j])
        if c[0] == c[1]:
            nowhere = np.full((3, 1), np.nan)
            return self._centre(names, "at rest relative to each other", nowhere, np.full(1, np.inf), Status.AT_REST)
        how = self._how[c]
        return self._centre(names, how, self.units[c], self.spread[c], self._missing(c), self._elsewhere(c))

    def __iter__(self) -> Iterator[tuple[str, str]]:
        names = self.plan.diagram.links
        return ((names[i], names[j]) for i, j in self.plan.diagram.couples)

    def __len__(self) -> int:
        return len(self.plan.diagram.couples)

    def _numbers(self, links: Any) -> Couple:
        names = self.plan.diagram.links
        if not isinstance(links, tuple) or len(links) != 2:
            raise InvalidInput(Problem("centre", f"{links!r} are not two links", 'centres["crank", "bar"]'))
        for name in links:
            if name not in names:
                raise UnknownName(Problem(str(name), "there is no such link", suggestion(str(name), names)))
        if links[0] == links[1]:
            raise InvalidInput(Problem("centre", f"{links[0]!r} has no centre relative to itself", "name two links"))
        return names.index(links[0]), names.index(links[1])

    def __repr__(self) -> str:
        return f"Centres({len(self)} of {len(self.plan.diagram.links)} links)"

    @cached_property
    def velocities(self) -> Velocities:
        """Every link's velocity from the centres and the drivers' rates alone."""
        return velocities_of(self)

    def velocity_check(self, motion: Motion | None = None) -> VelocityCheck:
        """Compare solved velocities with those from centres.

        Raises InvalidInput for a motion of order 0.
        """
        motion = motion or self.motion
        motion.grid.require(1)
        return velocity_check(self.velocities, motion)

    def collinearity(self) -> dict[tuple[str, str, str], Number]:
        """Return the deviation of three links' centres from one line, 0 to 1, NaN where one is ill-conditioned."""
        return collinearity_of(self)

    @cached_property
    def _how(self) -> dict[Couple, str]:
        links = {name: k for k, name in enumerate(self.plan.diagram.links)}
        return {couple(links[step.centre[0]], links[step.centre[1]]): step.text for step in self.plan.steps}

    @cached_property
    def _at_rest(self) -> Number:
        """Where no driver moves; with several drivers, some centres need them to."""
        return np.all([rate == 0.0 for rate in np.broadcast_arrays(*self.places.rates)], axis=0)

    def _missing(self, c: Couple) -> Status:
        if self._how[c] == "solved velocities" and self.motion.order < 1:
            return Status.UNDETERMINED
        return Status.SINGULAR

    def _elsewhere(self, c: Couple) -> tuple[Number, tuple[str, ...]]:
        if c not in self.lines:
            return np.zeros(0, dtype=int), ()
        at, first, second = self.lines[c]
        texts = tuple(crossing_text(self.plan.diagram, c, (int(a), int(b))) for a, b in zip(first, second, strict=True))
        return at, texts

    def _centre(
        self,
        names: tuple[str, str],
        how: str,
        unit: Number,
        spread: Number,
        otherwise: Status,
        elsewhere: tuple[Number, tuple[str, ...]] = (np.zeros(0, dtype=int), ()),
    ) -> Centre:
        designs, poses = self.motion.inputs.designs, self.motion.inputs.poses
        count = designs * poses
        with np.errstate(all="ignore"):
            conditioning = np.broadcast_to(1.0 / spread, (count,))
        found = conditioning >= NOTHING
        failed = np.broadcast_to(self.motion.failed != 0, (designs, poses)).ravel()
        resting = np.broadcast_to(self._at_rest, (count,)) & (len(self.places.rates) > 1)
        status = np.select([failed, found, resting], [Status.NOT_ASSEMBLED, Status.FOUND, Status.AT_REST], otherwise)
        scale = self.scale.in_one_axis((designs, poses))
        point = np.where(status == Status.FOUND, scale.world(unit), np.nan)
        shape = self.motion.shape
        size = scale.size.reshape(shape) if np.ndim(scale.size) else scale.size
        shown = np.where(failed, np.nan, conditioning)
        return Centre(
            names, how, point.T.reshape(*shape, 3), shown.reshape(shape),
            status.astype(np.int8).reshape(shape), size, elsewhere,
        )  # fmt: skip


# Poses a block: temporaries of a few dozen arrays of this length stay in a second-level cache.
BLOCK = 4096


@checked
def instant_centres(motion: Motion) -> Centres:
    """Return all instant centres of a motion at every pose, by geometry alone.

    Pairs give the primary centres; the others follow as crossings of two lines on which three centres of three
    links lie, in an order that depends on the graph only; where that stalls, by trial positions or, with several
    drivers, by their rates. Where two lines nearly coincide, others are taken.

    Raises NotDetermined where nothing moves or the drivers do not determine the motion.

    >>> import compoundkin as ck
    >>> four_bar = ck.Mechanism(
    ...     "Four-bar", ck.link("frame", A=(0, 0), D=(4, 0)), ck.link("crank", A=(0, 0), B=(1, 0)),
    ...     ck.link("coupler", B=(0, 0), C=(3, 0)), ck.link("rocker", D=(0, 0), C=(3, 0)), ck.drive("crank"))
    >>> centre = instant_centres(ck.solve(four_bar, {"crank": ck.deg([0, 90])}))["frame", "coupler"]
    >>> centre.how
    'line (frame crank)(crank coupler) x line (frame rocker)(rocker coupler)'
    >>> centre.point[1].round(6).item().real
    0.0
    """
    with np.errstate(all="ignore"):
        derivation = derive(diagram_of(motion.structure))
        scale = centred_coordinates(motion)
        places = primary_centres(motion, derivation.diagram, scale)
        needed = motion.order > 0 and any(isinstance(rule, SolvedCentre) for rule in derivation.rules)
        solved = solved_twists(motion, scale) if needed else None
        units, spread, lines = _concatenated(motion, derivation, places, solved)
    return Centres(motion, derivation, scale, places, units, spread, lines)


_BlockResult = tuple[dict[Couple, Number], dict[Couple, Number], dict[Couple, tuple[Number, Number, Number]]]


def _concatenated(
    motion: Motion, derivation: Derivation, places: PrimaryCentres, solved: Number | None
) -> _BlockResult:
    """Return the centres of all blocks in one."""
    count = motion.inputs.designs * motion.inputs.poses
    blocks = [slice(start, min(start + BLOCK, count)) for start in range(0, count, BLOCK)]
    parts = [_block(derivation, places, solved, block) for block in blocks]
    if len(parts) == 1:
        return parts[0].points, parts[0].spread, parts[0].lines
    points: dict[Couple, Number] = {}
    spread: dict[Couple, Number] = {}
    for c in parts[0].points:
        points[c] = _joined([part.points[c] for part in parts], blocks)
        spread[c] = _joined([part.spread[c] for part in parts], blocks)
    return points, spread, _lines(parts, blocks)


def _block(derivation: Derivation, places: PrimaryCentres, solved: Number | None, block: slice) -> Evaluation:
    units = [at_poses(unit, block) for unit in places.units]
    rates = [at_poses(rate, block) for rate in places.rates]
    part = Evaluation(derivation, units, rates)
    part.run(None if solved is None else solved[..., block])
    recompute(part)
    return part


def _joined(parts: list[Number], blocks: list[slice]) -> Number:
    """Return one array of all poses. One column where it is the same at all."""
    if all(part.shape[-1] == 1 for part in parts) and blocks[0].stop > 1:
        return parts[0]
    full = [np.broadcast_to(p, (*p.shape[:-1], b.stop - b.start)) for p, b in zip(parts, blocks, strict=True)]
    return np.concatenate(full, axis=-1)


def _lines(parts: list[Evaluation], blocks: list[slice]) -> dict[Couple, tuple[Number, Number, Number]]:
    found: dict[Couple, tuple[Number, Number, Number]] = {}
    for c in dict.fromkeys(c for part in parts for c in part.lines):
        own = [(part.lines[c], b.start) for part, b in zip(parts, blocks, strict=True) if c in part.lines]
        first, second = (np.concatenate([lines[k] for lines, _ in own]) for k in (1, 2))
        found[c] = np.concatenate([lines[0] + start for lines, start in own]), first, second
    return found


def centred_coordinates(motion: Motion) -> OwnCoordinates:
    """Return own coordinates around the middle of the frame's points."""
    points = list(motion.mechanism.geometry.points[FRAME].values())
    middle = np.mean([np.mean(p) for p in points]) if points else 0.0
    if not np.ndim(motion.sizes):
        return OwnCoordinates(complex(middle), motion.size)
    own = [np.mean(np.atleast_2d(fit(motion.shape)(p)), axis=1, keepdims=True) for p in points]
    return OwnCoordinates(sum(own) / max(len(own), 1), motion.sizes)


def primary_centres(motion: Motion, diagram: Diagram, scale: OwnCoordinates) -> PrimaryCentres:
    """Return the primary centres at every pose, poses and designs in one axis."""
    units, lengths = [], []
    for primary in diagram.primaries:
        pair = motion.solving_order.pairs[primary.pair]
        first, second = (_without_derivatives(motion.poses[name]) for name in pair.members[:2])
        centre = pair.centre(motion.inputs.ends[primary.pair], (first, second))
        assert centre is not None
        vector = _flattened(motion, scale.own_line(centre) if isinstance(centre, Line) else scale.own(*centre))
        length = norm(vector)
        units.append(vector / length)
        lengths.append(length)
    rates = tuple(
        _flattened(motion, np.asarray(motion.inputs.drives[d.driver][1], dtype=float)[None])[0]
        * lengths[d.primary]
        * d.sign
        for d in diagram.drives
    )
    return PrimaryCentres(tuple(units), rates)


def _without_derivatives(pose: Pose) -> Pose:
    """Return the pose without its derivatives."""
    return pose if pose is FIXED else Pose.of(pose.z.c[0], pose.u.c[0])


def _flattened(motion: Motion, vector: Number) -> Number:
    """(3, 1 or designs, 1 or poses) with the last two axes as one. One column where it never changes."""
    if vector[0].size == 1:
        return vector.reshape(-1, 1)
    shape = (len(vector), motion.inputs.designs, motion.inputs.poses)
    return np.ascontiguousarray(np.broadcast_to(vector, shape)).reshape(len(vector), -1)


def solved_twists(motion: Motion, scale: OwnCoordinates) -> Number:
    """Return every link's twist as solved, (links, 3, poses), in own coordinates.

    Raises InvalidInput for a motion of order 0.
    """
    motion.grid.require(1)
    count = motion.inputs.designs * motion.inputs.poses
    shape = (motion.inputs.designs, motion.inputs.poses)
    found, scale = np.zeros((len(motion.mechanism.links), 3, count)), scale.in_one_axis(shape)
    for k, name in enumerate(motion.mechanism.links):
        pose = motion.poses[name]
        u, du = pose.u.derivative(0), pose.u.derivative(1)
        omega = np.imag(np.conjugate(u) * du)
        # i v0 is omega times the centre; v0 is the velocity of the link's point at the world's origin
        about = 1j * (pose.z.derivative(1) - 1j * omega * pose.z.derivative(0))
        parts = [np.broadcast_to(v, shape).ravel() for v in (np.real(about), np.imag(about), omega)]
        found[k] = scale.own(*parts)
    return found


# Below this conditioning (rounding becomes 1e-10) a centre is given, but proves nothing to 1e-9.
LEAST_CONDITIONING = 1e-6


@dataclass(frozen=True, repr=False)
class Velocities(ShortRepr):
    """Velocities from the centres and the drivers' rates. Arrays of the motion's shape, NaN where undetermined.

    `twists[link]` (3, poses) in own coordinates relative to the frame; `conditioning[link]` is near 0 where rounding
    is magnified, relative to the fastest link.
    """

    centres: CentreVectors
    twists: Mapping[str, Number]
    conditioning: Mapping[str, Number]
    fastest: Number

    def angular_velocity(self, link: str) -> Number:
        """Return a link's angular velocity, rad/s."""
        return self.twists[link][2].reshape(self.centres.motion.shape)

    def at(self, link: str, position: Number) -> Number:
        """Return the velocity of a link's point at a place, complex, length/s."""
        x, y, w = self.twists[link]
        motion = self.centres.motion
        scale = self.centres.scale.in_one_axis((motion.inputs.designs, motion.inputs.poses))
        own = (np.broadcast_to(position, self.centres.motion.shape).reshape(-1) - scale.origin) / scale.size
        return (1j * (w * own - (x + 1j * y)) * scale.size).reshape(self.centres.motion.shape)


@dataclass(frozen=True, repr=False)
class VelocityCheck(ShortRepr):
    """Solved velocities against those from centres, relative to the fastest link, by link and by point.

    A link's is the larger of those of its angular velocity and of the velocity of its frame's origin. NaN where the
    comparison is not made: at poses without rates, and where conditioning is below LEAST_CONDITIONING.
    """

    links: Mapping[str, Number]
    points: Mapping[str, Number]

    @property
    def worst(self) -> float:
        """The largest disagreement; NaN if nothing was compared."""
        values = np.array([np.fmax.reduce(v, axis=None) for v in (*self.links.values(), *self.points.values())])
        return float(np.fmax.reduce(values)) if values.size else float("nan")

    @property
    def compared(self) -> float:
        """The part of all links and poses that was compared."""
        return float(np.mean([np.mean(~np.isnan(v)) for v in self.links.values()]))


def velocities_of(centres: CentreVectors) -> Velocities:
    """Return the velocities that follow from the drivers' rates by centres alone."""
    with np.errstate(all="ignore"):
        rates = DriverRates(centres.plan, centres.units, centres.spread)
        rates.run(centres.places.units, centres.places.rates)
        factor = centres.places.rates[0] if len(centres.places.rates) == 1 else np.ones(1)
        body = centres.plan.body
        numbers = {name: k for k, name in enumerate(centres.plan.diagram.links)}
        scale = rates.fastest()
        twists, conditioning = {}, {}
        for name, k in numbers.items():
            twist, error = rates.relative(body[numbers[FRAME]], body[k])
            twists[name] = twist * factor
            conditioning[name] = np.where(np.isfinite(error), scale / np.maximum(error, scale), 0.0)
    # a mechanism of one body has constants where others have a value a pose
    count = centres.motion.inputs.designs * centres.motion.inputs.poses
    return Velocities(
        centres,
        {name: np.broadcast_to(twist, (3, count)) for name, twist in twists.items()},
        {name: np.broadcast_to(value, (count,)) for name, value in conditioning.items()},
        np.broadcast_to(scale * np.abs(factor), (count,)),
    )


def velocity_check(found: Velocities, motion: Motion) -> VelocityCheck:
    """Compare a motion's velocities with those from centres, at a conditioning of LEAST_CONDITIONING or more."""
    shape = motion.shape
    regular = np.broadcast_to(motion.regular, (motion.inputs.designs, motion.inputs.poses)).reshape(shape)
    links, points = {}, {}
    size = motion.grid.shaped(motion.sizes) if np.ndim(motion.sizes) else motion.size
    usable = {n: regular & (c.reshape(shape) >= LEAST_CONDITIONING) for n, c in found.conditioning.items()}
    slowest = SLOWEST * float(np.max(found.fastest, where=np.all(list(usable.values()), axis=0).ravel(), initial=0.0))
    scale = np.maximum(found.fastest, slowest if slowest > 0.0 else 1.0).reshape(shape)
    with np.errstate(all="ignore"):
        for name in motion.mechanism.links:
            link = motion.links[name]
            turning = np.abs(found.angular_velocity(name) - link.angular_velocity)
            going = np.abs(found.at(name, np.asarray(link.origin.position)) - np.asarray(link.origin.velocity))
            gap = np.maximum(turning, going / size)
            links[name] = np.where(usable[name], or_infinite(gap / scale), np.nan)
        for letter, carriers in motion.mechanism.carriers.items():
            point = motion.points[letter]
            gap = np.abs(found.at(carriers[0], np.asarray(point.position)) - np.asarray(point.velocity))
            points[letter] = np.where(usable[carriers[0]], or_infinite(gap / (scale * size)), np.nan)
    return VelocityCheck(links, points)


def collinearity_of(centres: CentreVectors) -> dict[tuple[str, str, str], Number]:
    """Return the volume of the unit vectors of the three centres of three links, zero on one line.

    NaN where one of them is ill-conditioned.
    """
    body, names = centres.plan.body, centres.plan.diagram.links
    shape = centres.motion.shape
    found = {}
    for i, j, k in combinations(range(len(names)), 3):
        if len({body[i], body[j], body[k]}) < 3:
            continue
        sides = [couple(body[a], body[b]) for a, b in ((i, j), (j, k), (i, k))]
        p, q, r = (centres.trusted(c) for c in sides)
        volume = np.abs(dot(p, cross(q, r)))
        count = centres.motion.inputs.designs * centres.motion.inputs.poses
        found[names[i], names[j], names[k]] = np.broadcast_to(volume, (count,)).reshape(shape)
    return found
