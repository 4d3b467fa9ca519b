"""`tolerance`: the effect of errors of dimensions and of loose pins on outputs of a mechanism.

A pin's clearance moves one link's copy of the point on a circle at an unknown angle; a slot or a guide has an offset to
either flank, which is stated as zero so that it can have errors.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.display import ShortRepr, count_phrase, short_repr
from compoundkin.base.errors import (
    FewDigits,
    InvalidInput,
    NotAssembled,
    Problem,
    UnassembledPoses,
    UnknownName,
    suggestion,
    suppress_pose_warnings,
    warn,
)
from compoundkin.base.linear import one_thread
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.attributes import AXES, PARTS, RADIANS
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import pairs_among
from compoundkin.programs.dimensions import StatedDimensions
from compoundkin.studies.responses import Designs, Response, StudiedPath, studied_path
from compoundkin.studies.responses.assembled_range import assembled_range, failure, is_misfit
from compoundkin.studies.responses.designs import design_blocks, name_freeing_argument
from compoundkin.studies.samples.random_samples import RandomSample
from compoundkin.studies.tolerances.error_sources import (
    ErrorSource,
    ErrorSpec,
    error_sources,
    free_dimension_names,
    tolerance_specs,
)
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance, SampledOutput
from compoundkin.studies.tolerances.tolerance_analysis import Chances, ToleranceAnalysis


def clearance_specs(mechanism: Mechanism, clearances: Mapping[str, Any]) -> list[ErrorSpec]:
    """Return the error sources of clearances of pins, slots and guides.

    Pins are named "C", or "plate.C" where the plate has clearance; slots and guides by their names. Raises UnknownName
    for unknown names, InvalidInput for an ambiguous link and an invalid clearance.
    """
    return [_clearance(mechanism, name, given) for name, given in clearances.items()]


def _clearance(mechanism: Mechanism, name: str, given: Any) -> ErrorSpec:
    half = _half(name, given)
    if name in straight_guides(mechanism):
        return ErrorSpec(
            f"{name}.{OFFSET}", lambda numbers, unit, own: FlankClearance(f"clearance {name}", numbers, unit, half)
        )
    point = clearance_point(mechanism, name)
    return ErrorSpec(point, lambda numbers, unit, own: PinClearance(f"clearance {name}", numbers, unit, half))


def _half(name: str, given: Any) -> float:
    where = f"clearance.{name}"
    found = real_numbers(where, given)
    if found.shape != () or not np.isfinite(found) or found < 0:
        raise InvalidInput(Problem(where, f"{short_repr(given)} is not a clearance", "give half the play, 0.02"))
    return float(found)


def clearance_point(mechanism: Mechanism, name: str) -> str:
    """Return the name of the point that the clearance of a pin moves, on a link where no other pair uses it."""
    where, pins = f"clearance.{name}", mechanism.real_pins
    link, _, letter = name.rpartition(".")
    if letter not in pins or (link and link not in pins[letter]):
        known = [*pins, *straight_guides(mechanism), *(f"{one}.{pin}" for pin, links in pins.items() for one in links)]
        raise UnknownName(Problem(where, "there is no such pin, slot or guide", suggestion(name, known)))
    able = [one for one in reversed(pins[letter]) if _is_alone(mechanism, one, letter)]
    if link and link not in able:
        what = f"another pair is at {letter} on {link}, and would be moved too"
        raise InvalidInput(Problem(where, what, _others(able, letter)))
    if not link and len(pins[letter]) > 2:
        what = f"{count_phrase(len(pins[letter]), 'link')} meet there, and it is ambiguous which has clearance"
        raise InvalidInput(Problem(where, what, _others(able, letter)))
    if not able:
        raise InvalidInput(Problem(where, "other pairs are at this point on each of its links", _others(able, letter)))
    return f"{link or able[0]}.{letter}"


def _is_alone(mechanism: Mechanism, link: str, letter: str) -> bool:
    """Return whether a pin is the only pair at a point of a rigid link."""
    pairs = mechanism.written_pairs
    return link in mechanism.rigid_links and not any(link in one.members and letter in one.letters for one in pairs)


def _others(able: list[str], letter: str) -> str:
    if not able:
        return "leave it out, and give tolerances of dimensions there instead"
    return f"name them, as {f'{able[0]}.{letter}'!r}; there may be {', '.join(f'{one}.{letter}' for one in able)}"


@dataclass(frozen=True)
class PinClearance(ErrorSource):
    """One link's copy of a pinned point, displaced by the radial clearance in any direction.

    The pin touches the hole, so each coordinate has the variance of a cosine, half the square of the clearance. Source:
    S. J. Lee, B. J. Gilmore, Trans. ASME J. Mech. Des. 113 (1991) 84-90, the effective length of loose links.
    """

    radius: float

    @property
    def limits(self) -> tuple[float, float]:
        """The clearance to either side."""
        return -self.radius, self.radius

    @property
    def columns(self) -> int:
        """One: the angle of contact."""
        return 1

    def errors(self, units: Number) -> Number:
        """Return places on the circle, uniformly distributed."""
        angle = 2.0 * np.pi * units[:, 0]
        return self.radius * np.array([np.cos(angle), np.sin(angle)])

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the clearance times the steepest slope of all directions."""
        return np.hypot(*slopes) * self.radius

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return half the square of the clearance times that of the steepest slope."""
        return np.sum(np.square(slopes), axis=0) * self.radius**2 / 2


@dataclass(frozen=True)
class FlankClearance(ErrorSource):
    """The offset of a slot or guide, displaced by half the play to either side with equal probability.

    A block does not tilt by it: its angle has a tolerance of its own.
    """

    half: float

    @property
    def limits(self) -> tuple[float, float]:
        """Half the play to either side."""
        return -self.half, self.half

    def errors(self, units: Number) -> Number:
        """Return one of the two for each design."""
        return self.half * np.where(units < 0.5, -1.0, 1.0).T

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the slope times half the play."""
        return np.abs(slopes[0]) * self.half

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return the square of slope times half the play."""
        return (slopes[0] * self.half) ** 2


# The dimension of slots and guides that their clearance changes.
OFFSET = "offset"


def straight_guides(mechanism: Mechanism) -> dict[str, Any]:
    """Return the straight guides and slots that are written out, by name."""
    found = {pair.name: pair for pair in pairs_among(mechanism.items)}
    return {name: pair for name, pair in found.items() if any(key.name == OFFSET for key in pair.keys)}


def with_stated_offsets(mechanism: Mechanism, names: Sequence[str]) -> Mechanism:
    """Return the mechanism with the named offsets stated; one neither written nor read off the drawing is 0.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.pairs.prismatic import slide
    >>> way = slide("block", on="frame", through="O", at="B", name="way")
    >>> press = Mechanism("m", link("frame", O=0), link("block", B=0), way, drive("block"))
    >>> with_stated_offsets(press, ["way.offset"]).written_pairs[0].offset
    0.0
    """
    asked = {name: pair for name, pair in straight_guides(mechanism).items() if f"{name}.{OFFSET}" in names}
    if not asked:
        return mechanism
    ends = {pair.name: pair.ends(mechanism.geometry) for pair in mechanism.written_pairs}
    known = StatedDimensions(mechanism, ends).known
    lacking = [pair for name, pair in asked.items() if f"{name}.{OFFSET}" not in known]
    return mechanism.replace(*(replace(pair, offset=0.0) for pair in lacking))


@checked
@one_thread
def tolerance(
    mechanism: Mechanism,
    tolerances: Mapping[str, Any],
    outputs: str | Sequence[str],
    *,
    clearance: Mapping[str, Any] | None = None,
    values: Any = None,
    speed: Any = None,
    acceleration: Any = None,
    jerk: Any = None,
    time: Any = None,
    modes: Mapping[str, int] | str | Configuration | None = None,
    count: int = 4096,
    seed: int = 0,
    sigmas: float = 3.0,
    percentiles: Sequence[float] = (0.135, 50.0, 99.865),
) -> ToleranceAnalysis:
    """Return the effect of tolerances of dimensions and of clearances on outputs of a mechanism.

    `tolerances` are by the names of dimensions, as those that `compile` frees: 0.05 to either side, of a point in each
    coordinate; deviations (-0.02, 0.05); or a variation of the whole dimension, `around` a value or a distribution of
    scipy.stats. Lengths are in the mechanism's unit, angles in radians. Limits lie `sigmas` standard deviations from
    the middle. `clearance` is half the play of pins, slots and guides by their names; a pin of more than two links is
    named "plate.C" for each link with clearance. `outputs` are quantities at every pose, or figures of the motion
    ("ram.stroke"), for which a pin stays at its place in the link; of vectors both components. Motion and modes are
    those of `solve`. Results are to first order from exact slopes, and statistical from `count` random designs with
    `percentiles`. Raises UnknownName and InvalidInput for invalid arguments, and what `solve` raises; warns
    UnassembledPoses of designs that cannot be assembled.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
    >>> found = tolerance(crank, {"crank.B.x": 0.03}, "B.y", values=[0.0, 0.5236], clearance={"A": 0.01})
    >>> found["B.y"].worst.round(4).tolist(), found["B.y"].deviation.round(4).tolist()
    ([0.01, 0.025], [0.0071, 0.0087])
    >>> found["B.y"].sample.percentiles.round(2).tolist()
    [[-0.01, 0.98], [-0.0, 1.0], [0.01, 1.02]]
    """
    names = (outputs,) if isinstance(outputs, str) else tuple(dict.fromkeys(outputs))
    chances = Chances.of(count, seed, percentiles, sigmas)
    given = [*tolerance_specs(tolerances, chances.sigmas), *clearance_specs(mechanism, clearance or {})]
    _check_tolerances(names, given)
    rates = {"speed": speed, "acceleration": acceleration, "jerk": jerk, "time": time}
    with name_freeing_argument("tolerances"):
        free = free_dimension_names([one.dimension for one in given])
        path, responses = studied_path(with_stated_offsets(mechanism, free), free, names, values, modes=modes, **rates)
        sources = error_sources(path, given)
    designs = TolerancedDesigns(path, sources, chances.sample)
    found, left_out = output_tolerances(designs, responses, chances.percentiles)
    return ToleranceAnalysis(path.reference, sources, found, chances, left_out)


def _check_tolerances(names: Sequence[str], given: Sequence[ErrorSpec]) -> None:
    if not names:
        raise InvalidInput(Problem("outputs", "no output is named", 'tolerance(..., outputs=["ram.stroke"])'))
    if not given:
        raise InvalidInput(Problem("tolerances", "nothing has a tolerance", 'tolerance(..., {"crank.B": 0.05})'))


def output_tolerances(
    designs: TolerancedDesigns, responses: Sequence[Response], percents: tuple[float, ...]
) -> tuple[dict[str, OutputTolerance], int]:
    """Return the outputs by name, and the number of random designs left out.

    A vector is two outputs. Raises NotAssembled where the mechanism itself or too many random designs are not assembled
    over the whole motion; warns UnassembledPoses of some.
    """
    _check_nominal(designs)
    values, failed = designs.values(responses)
    assembled = failed == 0
    _report_progress(assembled, _misfits(designs, failed))
    outputs: dict[str, OutputTolerance] = {}
    for response in responses:
        for one in _outputs(designs, response, values[response.name][assembled], percents):
            outputs[one.name] = one
            _report_slopes(one)
    return outputs, int(np.count_nonzero(~assembled))


def _outputs(
    designs: TolerancedDesigns, response: Response, sampled: Number, percents: tuple[float, ...]
) -> Iterator[OutputTolerance]:
    nominal = designs.nominal
    shape = (designs.path.reference.inputs.poses,) if response.is_course else ()
    values = np.broadcast_to(response.values(nominal), (1, *shape))[0]
    coordinates = designs.path.coordinates
    slopes = np.broadcast_to(response.slopes(nominal), (len(coordinates), 1, *shape))[:, 0]
    for axis in AXES if response.is_vector else ("",):
        part = PARTS.get(axis, np.real)
        name = f"{response.name}.{axis}" if axis else response.name
        by = dict(zip(coordinates, part(slopes), strict=True))
        near = SampledOutput(_near(name, part(sampled), part(values), response.unit), percents)
        yield OutputTolerance(name, response.unit, response.dimension, part(values), by, designs.sources, near)


def _near(name: str, values: Number, nominal: Number, unit: str) -> Number:
    """Return the values of designs that have one wherever the mechanism has; angles in the nominal turn."""
    has = ~(np.isnan(values) & ~np.isnan(nominal)).reshape(len(values), -1).any(axis=1)
    if np.count_nonzero(has) < 2:
        what = f"it has no value in {np.count_nonzero(~has)} of {len(has)} random designs"
        raise NotAssembled(Problem(f"outputs.{name}", what, "give closer tolerances, or leave it out"))
    values = values if has.all() else values[has]
    return values - whole_turns(values - nominal) if unit == RADIANS else values


def _report_slopes(one: OutputTolerance) -> None:
    lacking = np.isnan(one.deviation) & ~np.isnan(one.nominal)
    if lacking.any():
        where = f" at {np.count_nonzero(lacking)} of {lacking.size} poses" if one.is_course else ""
        what = f"{one.name} has no slopes{where}, at a limit position or a change point; use the random designs there"
        warn(what, FewDigits)


def _check_nominal(designs: TolerancedDesigns) -> None:
    with suppress_pose_warnings():
        missing = int(np.count_nonzero(~designs.nominal.outputs.assembled))
    if missing:
        what = f"{count_phrase(missing, 'pose')} of the mechanism itself cannot be assembled"
        raise NotAssembled(Problem("values", what, "give values at which it can, gaps(solve(...)) tells where"))


def _misfits(designs: TolerancedDesigns, failed: Number) -> str:
    """Return in how many designs which wheels do not fit, in words."""
    motion = designs.path.reference
    counted = zip(*np.unique(failed, return_counts=True), strict=True)
    found = [f"{failure(motion, k)} in {count}" for k, count in counted if k and is_misfit(motion, k)]
    return f" ({', '.join(found)})" if found else ""


def _report_progress(assembled: Number, misfits: str) -> None:
    missing, count = np.count_nonzero(~assembled), len(assembled)
    if count - missing < 2:
        what = f"{missing} of {count} random designs cannot be assembled over the whole motion{misfits}"
        raise NotAssembled(
            Problem("tolerances", what, "give closer tolerances, or values that are farther from limits")
        )
    if missing:
        told = f"{missing} of {count} random designs cannot be assembled over the whole motion{misfits}; "
        warn(told + "percentiles are those of the others", UnassembledPoses)


# The greatest number of values in memory: a gibibyte.
MOST_VALUES = 2**27


@dataclass(frozen=True, eq=False, repr=False)
class TolerancedDesigns(ShortRepr):
    """The original mechanism, and random designs within the tolerances."""

    path: StudiedPath
    sources: tuple[ErrorSource, ...]
    sample: RandomSample

    @cached_property
    def own(self) -> dict[str, Number]:
        """The dimensions without errors, (1,) each."""
        stated = self.path.compiled.programs.stated
        return {one.name: np.reshape(stated.own(one), 1) for one in self.path.compiled.programs.dimensions}

    @cached_property
    def nominal(self) -> Designs:
        """The one design without errors."""
        return self.path.designs(self.own)

    def values(self, responses: Sequence[Response]) -> tuple[dict[str, Number], Number]:
        """Return the values of responses by name, and by what each design fails: 0 for one that assembles."""
        self._check_memory(responses)
        parts: dict[str, list[Number]] = {one.name: [] for one in responses}
        failed = []
        for rows in design_blocks(self.sample.count, self.path.reference.inputs.poses):
            with suppress_pose_warnings():
                designs = self.designs(rows)
                found = assembled_range(designs)
                failed.append(np.maximum(found.failed.max(axis=1), found.between))
                for one in responses:
                    shape = (designs.number, designs.poses)[: 1 + one.is_course]
                    parts[one.name].append(np.broadcast_to(one.values(designs), shape))
        return {name: np.concatenate(part) for name, part in parts.items()}, np.concatenate(failed)

    def _check_memory(self, responses: Sequence[Response]) -> None:
        """Raise InvalidInput where the values of all designs do not fit in memory."""
        poses = self.path.reference.inputs.poses
        each = sum((poses if one.is_course else 1) * (1 + one.is_vector) for one in responses)
        if self.sample.count * each > MOST_VALUES:
            what = f"{self.sample.count} designs of {each} values each do not fit in memory"
            raise InvalidInput(
                Problem("count", what, f"at most {MOST_VALUES // each}; a study stores more in a folder")
            )

    def designs(self, rows: range) -> Designs:
        """Return some random designs."""
        errors = self._errors(rows)
        found = {}
        for one in self.path.compiled.programs.dimensions:
            parts = [errors[name] for name in one.coordinates]
            found[one.name] = self.own[one.name] + (parts[0] + 1j * parts[1] if one.is_vector else parts[0])
        return self.path.designs(found)

    def _errors(self, rows: range) -> dict[str, Number]:
        """Return the errors of all coordinates, (designs,) each."""
        units = self.sample.units(sum(source.columns for source in self.sources), rows)
        found, column = {name: np.zeros(len(rows)) for name in self.path.coordinates}, 0
        for source in self.sources:
            errors = source.errors(units[:, column : column + source.columns])
            for name, error in zip(source.coordinates, errors, strict=True):
                found[name] = found[name] + error
            column += source.columns
        return found
