"""Free dimensions by name: unknown ones and those that are named twice are told."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions


def free_dimensions(stated: StatedDimensions, names: Sequence[str]) -> tuple[FreeDimension, ...]:
    """Return the dimensions of some names; raises UnknownName, InvalidInput where one is named twice.

    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> free_dimensions(StatedDimensions(crank, solve(crank).inputs.ends), ["crank.B.x"])[0].word
    'B'
    """
    unknown = [_unknown(stated, name) for name in names if name not in stated.known]
    if unknown:
        raise UnknownName(unknown)
    found = [stated.known[name] for name in names]
    for k, one in enumerate(found):
        for other in found[:k]:
            if set(one.inputs) & set(other.inputs):
                raise InvalidInput(
                    Problem(f"free.{one.name}", f"it is named twice, as {other.name!r} before", "name it once")
                )
    return tuple(found)


def _unknown(stated: StatedDimensions, name: str) -> Problem:
    owner = name.partition(".")[0]
    own = [known for known in stated.known if known.partition(".")[0] == owner]
    what = "it has no such dimension, or it is not stated" if own else "there is no such dimension"
    return Problem(f"free.{name}", what, nearest(name, own or list(stated.known)))


def hold_one_design(stated: StatedDimensions, free: Sequence[FreeDimension]) -> None:
    """Raise InvalidInput where a dimension has several values and is not free."""
    freed = {given for one in free for given in one.inputs}
    several = [
        one.name
        for one in stated.known.values()
        if not (one.is_of_law or freed.issuperset(one.inputs)) and np.ndim(stated.own(one))
    ]
    if several:
        remedy = f"compile(..., free={[*(one.name for one in free), several[0]]!r})"
        raise InvalidInput(Problem(several[0], "it has several values: a program has one of what is not free", remedy))
