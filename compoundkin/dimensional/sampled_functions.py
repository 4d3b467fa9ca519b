"""Functions that are sampled: linkages whose output follows many pairs of values, with dwells, strokes or even speed.

The steps are those of drawn curves. Outputs of many designs over a turn are kept as they are; of one the correlation
with the wanted function over all begins is a transform, which also knows where nothing is wanted. The nearest are
refined by Levenberg's steps with exact slopes of their programs.

Outputs are a link that swings about a fixed pivot, or a slide on the frame: of a four-bar, of a slider-crank, or of a
dyad that a point of the coupler or the rocker leads, as dwells by arcs of coupler curves are made (K. Hain, Applied
Kinematics, McGraw-Hill 1967, chapter 18).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.dimensional.candidates import COUPLER, Candidates, Linkage
from compoundkin.dimensional.curve_chains import (
    CRANK,
    FOUR_BAR,
    GUIDE,
    LEVER,
    OFFSETS,
    ROCKER,
    ROD,
    SLIDER,
    SLIDER_CRANK,
    ChainPlan,
    CurveChain,
    FreeNumber,
    Laying,
    base_items,
    length_number,
    place_numbers,
    turn,
)
from compoundkin.dimensional.curve_conditions import keeps_transmission
from compoundkin.dimensional.design_refinement import (
    GIVEN,
    FittedDesigns,
    RefinementPlan,
    best_designs,
    different_verdicts,
    ranked,
)
from compoundkin.dimensional.task_words import NEXT
from compoundkin.dimensional.tasks import FunctionTask
from compoundkin.model.attributes import ANGLE, VALUE
from compoundkin.model.elements import drive, link, mode
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.compiled_path import CompiledPath, compile
from compoundkin.studies.samples.random_samples import SobolSample

RAM, WAY = "ram", "way"
# Designs of the atlas, poses of a turn of which an output is made, designs that are drawn at once, and draws at most
# for each that is kept.
DESIGNS, GRID, BLOCK, DRAWS = 60_000, 64, 4096, 400
# A link that swings by less, in radians, is at rest; a slide travels by this part of the greatest number at least, as
# others would be huge.
LEAST_SWING, LEAST_TRAVEL = 0.05, 0.15
# Numbers of designs stay within their ranges, wider by so many times.
WIDER = 0.5
# Poses of a turn at which designs are followed when they are refined.
FINE = 96
# Of more pairs so many are compared.
MOST_PAIRS = 400
# Between inputs farther apart than this part of a turn nothing is wanted.
GAP = 1.0 / 12.0
# Designs of a chain that are refined, the best of all that are refined to the end, steps of both, and rounds in which
# the best are moved.
STARTED, BEST, FIRST_STEPS, STEPS, ROUNDS = 16, 24, 15, 60, 2
# Positions at which a refined linkage is handed on.
POSITIONS = 12


@dataclass(frozen=True, eq=False, repr=False)
class FunctionChain(CurveChain):
    """A chain whose `output` is an angle of a link on the frame, or the value of a slide there."""

    output: str

    @property
    def links(self) -> int:
        """How many links it has, the frame among them."""
        return len(self.mechanism.links)

    @property
    def is_angle(self) -> bool:
        """Whether the output is an angle."""
        return self.output.endswith(ANGLE)

    @cached_property
    def program(self) -> CompiledPath:
        """Its program: the output for dimensions and the crank's angle."""
        some = self.dimensions(np.zeros((1, len(self.numbers))))
        return compile(self.mechanism, [self.output], free=list(some))

    def values(self, designs: Number, angles: Number) -> tuple[Number, Number]:
        """Return the output of designs at angles of the crank, (designs, poses), and which are clear of limits."""
        found, clear = self.program.programs.unscreened(Call({CRANK: angles}, self.dimensions(designs)))
        return self._even(np.broadcast_to(found[self.output], (len(designs), np.shape(angles)[-1]))), clear

    def value_slopes(self, designs: Number, angles: Number) -> tuple[Number, Number, Number, Number]:
        """Return outputs, their slopes by the designs' numbers and by the crank, and which designs are clear."""
        found, clear = self.program.sensitivities.unscreened(Call({CRANK: angles}, self.dimensions(designs)))
        shape = (len(designs), np.shape(angles)[-1])
        by = [np.broadcast_to(found[self.output, one.name], shape) for one in self.numbers]
        by = [slope * np.exp(designs[:, [k]]) if one.is_length else slope
              for k, (one, slope) in enumerate(zip(self.numbers, by, strict=True))]  # fmt: skip
        value = self._even(np.broadcast_to(found[self.output, ""], shape))
        return value, np.array(by), np.broadcast_to(found[self.output, CRANK], shape), clear

    def _even(self, value: Number) -> Number:
        """Return outputs without jumps by whole turns."""
        if not self.is_angle:
            return value
        turns = np.round(np.diff(value, axis=-1) / TURN)
        return value - TURN * np.cumsum(np.pad(turns, ((0, 0), (1, 0))), axis=-1)

    def is_drawn(self, designs: Number, values: Number) -> Number:
        """Return which designs are no extremes: near the ranges that are drawn, and their outputs (designs, n) move."""
        low, high = np.array([[np.log(one[1:3]) if one.is_length else one[1:3]] for one in self.numbers]).T
        room = WIDER * (high - low)[0]
        within = np.all((designs > low[0] - room) & (designs < high[0] + room), axis=1)
        least = LEAST_SWING if self.is_angle else LEAST_TRAVEL * self.size(designs)
        return within & (np.ptp(values, axis=1) > least)

    def _laid_pairs(self, dimensions: dict[str, Number], laying: Laying, u: dict[str, Number]) -> Iterator[Item]:
        """Yield the slides where they lie; by a negative scale they are turned, but not their directions."""
        for name, own, at in ((GUIDE, SLIDER, "C"), (WAY, RAM, "G")):
            if f"{name}.offset" in dimensions:
                direction = laying.as_seen(np.exp(1j * float(dimensions.get(f"{name}.{ANGLE}", 0.0))))
                offset = float(dimensions[f"{name}.offset"]) * laying.scale.real * (-1.0 if laying.mirrored else 1.0)
                yield _slide(name, own, at, float(np.angle(direction)), offset)


def _slide(name: str, own: str, at: str, angle: float, offset: float) -> Item:
    return slide(own, on=FRAME, at=at, through="A", angle=angle, offset=offset, name=name)


@cache
def function_chains(links: int = 6) -> tuple[FunctionChain, ...]:
    """Return the chains of at most so many links, four or six.

    >>> [len(function_chains(links)) for links in (4, 6)]
    [2, 14]
    """
    found = [_chain(FOUR_BAR), _chain(SLIDER_CRANK)]
    if links >= 6:
        found += [_chain(base, first, end, sign) for base in (FOUR_BAR, SLIDER_CRANK) for end in (LEVER, RAM)
                  for first in ((COUPLER, ROCKER) if base == FOUR_BAR else (COUPLER,)) for sign in (1, -1)]  # fmt: skip
    return tuple(found)


# Of the second link that a dyad leads, what the linkage is called.
_TITLES = {
    (FOUR_BAR, COUPLER, LEVER): "Stephenson III",
    (FOUR_BAR, ROCKER, LEVER): "Watt II",
    (FOUR_BAR, COUPLER, RAM): "Four-bar, coupler and ram",
    (FOUR_BAR, ROCKER, RAM): "Four-bar, rocker and ram",
    (SLIDER_CRANK, COUPLER, LEVER): "Slider-crank and lever",
    (SLIDER_CRANK, COUPLER, RAM): "Slider-crank and ram",
}


def _chain(base: str, first: str = "", end: str = "", sign: int = 1) -> FunctionChain:
    """Return a chain: a four-bar or a slider-crank, and a dyad that its link `first` leads, with a lever or a slide."""
    extra: dict[str, dict[str, complex]] = {first: {"E": 1.0 + 1.0j}} if first else {}
    if end == LEVER:
        extra[FRAME] = {"F": 0.5 + 1.5j}
    plan = ChainPlan(base, (), COUPLER)
    items, numbers = base_items(plan, extra)
    output, title = f"{GUIDE}.{VALUE}" if base == SLIDER_CRANK else f"{ROCKER}.{ANGLE}", base
    if first:
        title = _TITLES[base, first, end]
        items += [link(ROD, E=0, G=2.5), link(end, G=0) if end == RAM else link(end, F=0, G=2.5), mode(sign, end)]
        numbers += [*place_numbers(first, "E"), length_number("rod.G.x")]
        if end == RAM:
            items.append(_slide(WAY, RAM, "G", 0.4, 0.3))
            numbers += [FreeNumber(f"{WAY}.{ANGLE}", -np.pi / 2, np.pi / 2, False)]
            numbers += [FreeNumber(f"{WAY}.offset", *OFFSETS, False)]
            output = f"{WAY}.{VALUE}"
        else:
            numbers += [*place_numbers(FRAME, "F"), length_number("lever.G.x")]
            output = f"{LEVER}.{ANGLE}"
    return FunctionChain(plan, title, Mechanism(title, *items, drive(CRANK)), tuple(numbers), output)


# --- the atlas of outputs -------------------------------------------------------------------------------------


class ChainOutputs(NamedTuple):
    """Designs of a chain, (designs, numbers), and their outputs over a turn, (designs, GRID)."""

    chain: FunctionChain
    designs: Number
    values: Number


@lru_cache(maxsize=4)
def chain_outputs(links: int, count: int, is_angle: bool) -> tuple[ChainOutputs, ...]:
    """Return so many designs whose crank turns fully, of chains with such outputs, always the same."""
    chains = [one for one in function_chains(links) if one.is_angle == is_angle]
    return tuple(_outputs(chain, -(-count // len(chains)), k) for k, chain in enumerate(chains))


def _outputs(chain: FunctionChain, count: int, seed: int) -> ChainOutputs:
    sample = SobolSample(min(1 << max(count * DRAWS, BLOCK).bit_length(), 1 << 29), seed)
    designs, values, kept = list[Number](), list[Number](), 0
    for first in range(0, sample.count, BLOCK):
        if kept >= count:
            break
        drawn = chain.designs(sample.units(len(chain.numbers), range(first, first + BLOCK)))
        found, clear = chain.values(drawn, np.append(turn(GRID), TURN))
        # what turns fully itself does not swing
        clear = clear & (np.abs(found[:, -1] - found[:, 0]) < 1.0) if chain.is_angle else clear
        drawn, found = drawn[clear], found[clear, :-1]
        seen = chain.is_drawn(drawn, found)
        designs.append(drawn[seen])
        values.append(found[seen].astype(np.float32))
        kept += int(seen.sum())
    return ChainOutputs(chain, np.concatenate(designs)[:count], np.concatenate(values)[:count])


class WantedFunction(NamedTuple):
    """A function as it is looked for: `inputs` (n,) increasing, `outputs`, whether they go all around.

    On the atlas' grid, from the first input on, it is `values` (GRID,) where it is `wanted` (0 or 1). `transmission` is
    the least transmission angle.
    """

    inputs: Number
    outputs: Number
    is_whole: bool
    values: Number
    wanted: Number
    transmission: float = 0.0

    @property
    def course(self) -> Number:
        """The inputs with others between them: whether designs are clear is known where steps are small."""
        low, high = self.inputs[[0, -1]]
        return np.union1d(np.linspace(low, high, 2 + int((high - low) / TURN * FINE)), self.inputs)

    @classmethod
    def of(cls, task: FunctionTask) -> WantedFunction:
        """Return the function of a task."""
        pairs = np.stack([task.inputs, task.outputs], axis=-1) if task.whole is None else task.whole
        pairs = pairs[np.argsort(pairs[:, 0], kind="stable")]
        inputs, outputs = pairs[np.unique(np.linspace(0, len(pairs) - 1, MOST_PAIRS).astype(int))].T
        around = np.append(inputs, inputs[0] + TURN)
        grid = inputs[0] + turn(GRID)
        after = np.clip(np.searchsorted(around, grid, side="right"), 1, len(inputs))
        # what is sampled sparsely and evenly has no gaps
        steps = np.diff(around)
        gap = max(GAP * TURN, NEXT * float(np.median(steps)))
        wanted = (steps[after - 1] <= gap) | np.isclose(grid, around[after - 1])
        values = np.interp(grid, around, np.append(outputs, outputs[0]))
        is_whole = bool(steps.max() <= gap)
        return cls(inputs, outputs, is_whole, values, wanted.astype(float), task.conditions.transmission)


def nearest_outputs(
    values: Number, wanted: WantedFunction, is_angle: bool, mirrored: bool
) -> tuple[Number, Number, Number]:
    """Return the sums of squares by which outputs (designs, GRID) miss a function, from which place, by which factor.

    They are the least over the begin, the output's zero and, of displacements, the size and sense: running sums and
    correlations are transforms.
    """
    own = values[:, (-np.arange(GRID)) % GRID] if mirrored else values
    own = -own if mirrored and is_angle else own
    own = own - own.mean(axis=1, keepdims=True)
    weight, count = np.fft.rfft(wanted.wanted), wanted.wanted.sum()
    middle = float((wanted.values * wanted.wanted).sum() / count)
    g = (wanted.values - middle) * wanted.wanted

    def sums(of: Number, spectrum: Number) -> Number:
        return np.fft.irfft(np.fft.rfft(of, axis=1) * np.conj(spectrum), GRID, axis=1)

    spread = np.maximum(sums(own**2, weight) - sums(own, weight) ** 2 / count, 0.0)
    across, square = sums(own, np.fft.rfft(g)), float((g**2).sum())
    if is_angle:
        missed, factor = spread + square - 2.0 * across, np.ones_like(across)
    else:
        room = np.maximum(spread, (LEAST_TRAVEL * np.ptp(own, axis=1, keepdims=True)) ** 2)
        missed, factor = square - across**2 / room, across / room
    start = missed.argmin(axis=1)
    rows = np.arange(len(own))
    return np.maximum(missed[rows, start], 0.0), start, factor[rows, start]


# --- refinement -----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class FittedFunctions(FittedDesigns):
    """Designs of one chain that are refined together to a function, (designs, numbers + 2), of one sense.

    After the designs' numbers stand the crank's angle at the first input and the logarithm of the scale.
    """

    chain: FunctionChain
    sense: float
    wanted: WantedFunction

    def angles(self, x: Number, inputs: Number) -> Number:
        """Return the angles of the chain's crank at inputs, (designs, inputs)."""
        around = x[:, [-2]] + (inputs - self.wanted.inputs[0])
        return -around if self.mirrored else around

    def residuals(self, x: Number) -> tuple[Number, Number, Number]:
        """Return what outputs miss at the inputs but for a zero, slopes, and which designs are clear."""
        n, is_angle = len(self.chain.numbers), self.chain.is_angle
        double = np.repeat(x, 2, axis=0) if len(x) == 1 else x  # for one design other programs would be made
        value, by, by_crank, clear = self.chain.value_slopes(double[:, :n], self.angles(double, self.wanted.course))
        at = np.searchsorted(self.wanted.course, self.wanted.inputs)
        value, by, by_crank = (each[..., at] for each in (value, by, by_crank))
        whole, turns = self.chain.values(double[:, :n], turn(GRID))
        clear = clear & turns & self.chain.is_drawn(double[:, :n], whole)
        clear = clear & keeps_transmission(self.chain, double[:, :n], self.wanted.transmission)
        if not clear.all():  # what is not clear means nothing, and is not taken
            value, by, by_crank = (np.where(clear[:, None], each, 1.0) for each in (value, by, by_crank))
        sign = -1.0 if self.mirrored else 1.0
        factor = np.full((len(double), 1), sign) if is_angle else self.sense * np.exp(double[:, [-1]])
        scaled = factor * value
        by_scale = np.zeros_like(scaled) if is_angle else scaled
        j = np.concatenate([factor * by, [sign * factor * by_crank, by_scale]])
        r, j = scaled - self.wanted.outputs, np.moveaxis(j, 0, 2)
        r, j = r - r.mean(axis=1, keepdims=True), j - j.mean(axis=1, keepdims=True)
        return r[: len(x)], j[: len(x)], clear[: len(x)]

    def linkage(self, k: int) -> Linkage:
        """Return one of them as a linkage at positions from the first input to the last, or all around."""
        x, inputs = self.x[k], self.wanted.inputs
        r = self.residuals(x[None])[0][0]
        is_angle = self.chain.is_angle
        scale = 1.0 if is_angle else self.sense * float(np.exp(x[-1]))
        positions = (
            inputs[0] + turn(POSITIONS) if self.wanted.is_whole else np.linspace(inputs[0], inputs[-1], POSITIONS)
        )
        laying = Laying(complex(scale), 0j, self.mirrored)
        found = self.chain.linkage(x[: len(self.chain.numbers)], laying, self.angles(x[None], positions)[0])
        crank = float(np.angle(found.u[CRANK][0]) - inputs[0])
        return replace(
            found,
            error=float(np.ptp(r)) / 2.0,
            outputs=(self.chain.output,),
            source=f"Zero of the input: the crank is at {np.rad2deg(crank) % 360.0:.6g} degrees more.",
        )


def sampled_function(task: FunctionTask) -> Candidates:
    """Return the linkages of at most `task.links` links whose output comes nearest to a task's pairs."""
    wanted, is_angle = WantedFunction.of(task), task.linkage != "slider-crank"
    parts = chain_outputs(task.links, DESIGNS, is_angle)
    begun = (one for part in parts for one in _begun(part, wanted))
    found = best_designs(begun, RefinementPlan(FIRST_STEPS, BEST, STEPS, ROUNDS))
    verdicts = different_verdicts((part.linkage(k) for part, k in ranked(found)), task, GIVEN)
    designs = sum(len(part.designs) for part in parts)
    complete = f"the best {len(verdicts)} of {designs} designs of {len(parts)} chains, refined"
    return Candidates([one.candidate for one in verdicts], complete, is_family=True, verdicts=tuple(verdicts))


def _begun(part: ChainOutputs, wanted: WantedFunction) -> Iterator[FittedFunctions]:
    """Yield the designs of a chain whose outputs are nearest, mirrored or not, by their senses."""
    is_angle = part.chain.is_angle
    both = [nearest_outputs(part.values, wanted, is_angle, mirrored) for mirrored in (False, True)]
    allowed = keeps_transmission(part.chain, part.designs, wanted.transmission)
    missed = np.concatenate([np.where(allowed, one[0], np.inf) for one in both])
    chosen = np.argsort(missed, kind="stable")[: min(STARTED, 2 * allowed.sum())]
    start, factor = (np.concatenate([one[k] for one in both])[chosen] for k in (1, 2))
    count = len(part.designs)
    for mirrored in (False, True):
        for sense in (1.0,) if is_angle else (1.0, -1.0):
            own = ((chosen >= count) == mirrored) & (np.sign(factor) == sense)
            if not own.any():
                continue
            designs = part.designs[chosen[own] % count]
            begin = start[own] * (TURN / GRID)
            x = np.hstack([designs, begin[:, None], np.log(np.abs(factor[own]))[:, None]])
            yield FittedFunctions(part.chain, mirrored, x, np.full(len(x), np.inf), sense, wanted)
