"""Which dimensions are angles, told by their names before anything is solved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compoundkin.model.fields import Key
from compoundkin.model.laws.law_numbers import SEGMENTS
from compoundkin.model.laws.motion_programs import ProgramSegment
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import pairs_among
from compoundkin.programs.dimensions import LAW

_ANGLES = ("angle", "turn", "sweep")


def is_angle_dimension(mechanism: Mechanism, driven_angles: Mapping[str, bool], name: str) -> bool:
    """Tell whether a dimension is an angle.

    Points and names that there are not are none.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> six_bar = load_named("six-bar")
    >>> [is_angle_dimension(six_bar, {"crank": True}, name) for name in ("slot.angle", "crank.D")]
    [True, False]
    """
    for owner, keys, angles in _owners(mechanism, driven_angles):
        if name.startswith(f"{owner}."):
            word = name.removeprefix(f"{owner}.")
            return any(key.kind in angles and word.split(".")[0] == key.name for key in keys)
    return False


def _owners(
    mechanism: Mechanism, driven_angles: Mapping[str, bool]
) -> Iterator[tuple[str, tuple[Key, ...], tuple[str, ...]]]:
    """Yield what has dimensions, its keys, and the kinds of them that are angles."""
    for drive in mechanism.drives:
        angles = ("coordinate",) if driven_angles.get(drive.name) else ()
        for index, _ in enumerate(getattr(drive.law, SEGMENTS, ())):
            yield f"{drive.name}.{LAW}.{SEGMENTS}.{index}", ProgramSegment.keys, angles
        if drive.law is not None:
            yield f"{drive.name}.{LAW}", drive.law.keys, angles
    for pair in pairs_among(mechanism.items):
        yield pair.name, pair.keys, _ANGLES
    for name, cylinder in mechanism.cylinders.items():
        yield name, cylinder.keys, _ANGLES
