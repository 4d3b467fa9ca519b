"""`tolerance`: what errors of dimensions and loose pins do to chosen outputs of a mechanism."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.attributes import PARTS
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.responses import Designs, Response, StudiedPath, studied_path
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.tolerances.given_tolerances import (
    coordinates_of,
    freed,
    given_limits,
    hold_once,
    told_of,
    tolerance_sources,
)
from compoundkin.studies.tolerances.loose_pins import given_clearances
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.pin_clearance import PinClearance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis

AXES = tuple(PARTS)[:2]


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
    sigmas: float = 3.0,
) -> ToleranceAnalysis:
    """Return what tolerances of dimensions do to outputs of a mechanism.

    `tolerances` are by the names of dimensions, as those that `compile` frees: 0.05 to either side, of a point in each
    coordinate, or deviations (-0.02, 0.05); lengths in the mechanism's unit, angles in radians. Limits lie `sigmas`
    standard deviations from the middle. `clearance` is half the play of pins, by their names: "C", or "plate.C" where
    more than two links meet, for each that is loose. `outputs` are quantities at every pose, or figures
    of the motion ("ram.stroke"); of vectors both components. Motion and modes are those of `solve`.
    Raises UnknownName and InvalidInput for what there is not, and what `solve` raises.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
    >>> found = tolerance(crank, {"crank.B.x": 0.03}, "B.y", values=[0.0, 0.5236], clearance={"A": 0.01})
    >>> found["B.y"].worst.round(4).tolist(), found["B.y"].deviation.round(4).tolist()
    ([0.01, 0.025], [0.0071, 0.0087])
    """
    names = (outputs,) if isinstance(outputs, str) else tuple(dict.fromkeys(outputs))
    limits, loose = given_limits(tolerances), given_clearances(mechanism, clearance or {})
    hold_once(tuple(limits))
    _hold(names, [*limits, *loose], sigmas)
    free = freed([*(point for point, _ in loose.values()), *limits])
    rates = {"speed": speed, "acceleration": acceleration, "jerk": jerk, "time": time}
    with told_of("tolerances"):
        path, responses = studied_path(mechanism, free, names, values, modes=modes, **rates)
    known = path.compiled.programs.stated.known
    pins = (PinClearance(f"clearance {name}", coordinates_of(known[at]), c) for name, (at, c) in loose.items())
    sources = (*tolerance_sources(known, limits, sigmas), *pins)
    found = [one for response in responses for one in _outputs(path, response, sources)]
    return ToleranceAnalysis(path.reference, sources, {one.name: one for one in found})


def _hold(names: Sequence[str], sources: Sequence[str], sigmas: float) -> None:
    if not names:
        raise InvalidInput(Problem("outputs", "no output is named", 'tolerance(..., outputs=["ram.stroke"])'))
    if not sources:
        raise InvalidInput(Problem("tolerances", "nothing has a tolerance", 'tolerance(..., {"crank.B": 0.05})'))
    if not (np.isfinite(sigmas) and sigmas > 0):
        raise InvalidInput(Problem("sigmas", f"{sigmas} is no number of standard deviations", "give 3"))


def _own(path: StudiedPath) -> Designs:
    """Return the one design that the mechanism is."""
    stated = path.compiled.programs.stated
    return path.designs({one.name: np.array([stated.own(one)]) for one in path.compiled.programs.dimensions})


def _outputs(path: StudiedPath, response: Response, sources: tuple[ErrorSource, ...]) -> Iterator[OutputTolerance]:
    """Yield what a response is: an output, or the two components of a vector."""
    designs = _own(path)
    values, slopes = response.values(designs)[0], response.slopes(designs)[:, 0]
    for axis in AXES if response.is_vector else ("",):
        part = PARTS.get(axis, np.real)
        by: Mapping[str, Number] = dict(zip(path.coordinates, part(slopes), strict=True))
        name = f"{response.name}.{axis}" if axis else response.name
        yield OutputTolerance(name, response.unit, response.dimension, part(values), by, sources)
