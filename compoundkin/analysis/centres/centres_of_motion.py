"""From a motion to its instant centres: the derivation, run over blocks of poses."""

from __future__ import annotations

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, diagram_of
from compoundkin.analysis.centres.derivation import Derivation, derive
from compoundkin.analysis.centres.derivation_steps import SolvedCentre
from compoundkin.analysis.centres.evaluation import Evaluation
from compoundkin.analysis.centres.homogeneous import OwnCoordinates, PrimaryCentres, norm
from compoundkin.analysis.centres.instant_centres import Centres
from compoundkin.analysis.centres.recomputation import recompute
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED, Pose
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.contract import Line

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
        scale = scale_of(motion)
        places = places_of(motion, derivation.diagram, scale)
        needed = motion.order > 0 and any(isinstance(rule, SolvedCentre) for rule in derivation.rules)
        solved = solved_twists(motion, scale) if needed else None
        units, spread, lines = _gathered(motion, derivation, places, solved)
    return Centres(motion, derivation, scale, places, units, spread, lines)


_Gathered = tuple[dict[Couple, Number], dict[Couple, Number], dict[Couple, tuple[Number, Number, Number]]]


def _gathered(motion: Motion, derivation: Derivation, places: PrimaryCentres, solved: Number | None) -> _Gathered:
    """Return all blocks in one."""
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
    units = [_cut(unit, block) for unit in places.units]
    rates = [_cut(rate, block) for rate in places.rates]
    part = Evaluation(derivation, units, rates)
    part.run(None if solved is None else solved[..., block])
    recompute(part)
    return part


def _cut(array: Number, block: slice) -> Number:
    return array if array.shape[-1] == 1 else array[..., block]


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


def scale_of(motion: Motion) -> OwnCoordinates:
    """Return own coordinates around the middle of the frame's points."""
    points = list(motion.mechanism.geometry.points[FRAME].values())
    middle = np.mean([np.mean(p) for p in points]) if points else 0.0
    return OwnCoordinates(complex(middle), motion.size)


def places_of(motion: Motion, diagram: Diagram, scale: OwnCoordinates) -> PrimaryCentres:
    """Return the primary centres at every pose, poses and designs in one axis."""
    units, lengths = [], []
    for primary in diagram.primaries:
        pair = motion.solving_order.pairs[primary.pair]
        first, second = (_still(motion.poses[name]) for name in pair.members[:2])
        centre = pair.centre(motion.inputs.ends[primary.pair], (first, second))
        assert centre is not None
        vector = _flat(motion, scale.own_line(centre) if isinstance(centre, Line) else scale.own(*centre))
        length = norm(vector)
        units.append(vector / length)
        lengths.append(length)
    rates = tuple(
        _flat(motion, np.asarray(motion.inputs.drives[d.driver][1], dtype=float)[None])[0] * lengths[d.primary] * d.sign
        for d in diagram.drives
    )
    return PrimaryCentres(tuple(units), rates)


def _still(pose: Pose) -> Pose:
    """Return the pose without its derivatives."""
    return pose if pose is FIXED else Pose.of(pose.z.c[0], pose.u.c[0])


def _flat(motion: Motion, vector: Number) -> Number:
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
    found = np.zeros((len(motion.mechanism.links), 3, count))
    for k, name in enumerate(motion.mechanism.links):
        pose = motion.poses[name]
        u, du = pose.u.derivative(0), pose.u.derivative(1)
        omega = np.imag(np.conjugate(u) * du)
        # i v0 is omega times the centre; v0 is the velocity of the link's point at the world's origin
        about = 1j * (pose.z.derivative(1) - 1j * omega * pose.z.derivative(0))
        parts = [np.broadcast_to(v, shape).ravel() for v in (np.real(about), np.imag(about), omega)]
        found[k] = scale.own(*parts)
    return found
