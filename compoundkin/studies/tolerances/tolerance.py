"""`tolerance`: what errors of dimensions and loose pins do to chosen outputs of a mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.responses import studied_path
from compoundkin.studies.responses.freed_dimensions import freed_by
from compoundkin.studies.tolerances.chances import Chances
from compoundkin.studies.tolerances.found_outputs import found_outputs
from compoundkin.studies.tolerances.given_errors import GivenError, error_sources, freed, given_tolerances
from compoundkin.studies.tolerances.loose_pins import given_clearances
from compoundkin.studies.tolerances.stated_offsets import with_offsets
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.studies.tolerances.toleranced_designs import TolerancedDesigns


@checked
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
    """Return what tolerances of dimensions do to outputs of a mechanism.

    `tolerances` are by the names of dimensions, as those that `compile` frees: 0.05 to either side, of a point in each
    coordinate; deviations (-0.02, 0.05); or what the whole dimension may be, `around` a value or a distribution of
    scipy.stats. Lengths are in the mechanism's unit, angles in radians. Limits lie `sigmas` standard deviations from
    the middle. `clearance` is half the play of pins, slots and guides by their names; a pin of more than two links is
    named "plate.C", for each that is loose. `outputs` are quantities at every pose, or figures of the motion
    ("ram.stroke"), for which a pin stays at its place in the link; of vectors both components. Motion and modes are
    those of `solve`. All is found to first order from exact slopes, and beside it in `count` random designs, of which
    `percentiles` are told. Raises UnknownName and InvalidInput for what there is not, and what `solve` raises; warns
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
    given = [*given_tolerances(tolerances, chances.sigmas), *given_clearances(mechanism, clearance or {})]
    _hold(names, given)
    rates = {"speed": speed, "acceleration": acceleration, "jerk": jerk, "time": time}
    with freed_by("tolerances"):
        free = freed([one.dimension for one in given])
        path, responses = studied_path(with_offsets(mechanism, free), free, names, values, modes=modes, **rates)
        sources = error_sources(path, given)
    designs = TolerancedDesigns(path, sources, chances.sample)
    found, left_out = found_outputs(designs, responses, chances.percentiles)
    return ToleranceAnalysis(path.reference, sources, found, chances, left_out)


def _hold(names: Sequence[str], given: Sequence[GivenError]) -> None:
    if not names:
        raise InvalidInput(Problem("outputs", "no output is named", 'tolerance(..., outputs=["ram.stroke"])'))
    if not given:
        raise InvalidInput(Problem("tolerances", "nothing has a tolerance", 'tolerance(..., {"crank.B": 0.05})'))
