"""What is asked of drivers, paths and labels, and how it is said; structure, and ends of pairs as drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

from compoundkin.base.argument_forms import is_finite_real
from compoundkin.base.arrays import degrees, first_entry
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.base.poses import End
from compoundkin.base.series import Number, Series
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import after_number
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure import Structure, decompose

LABELS = ("points", "links")

Drawable: TypeAlias = Motion | Mechanism | Structure


def structure_of(what: Drawable) -> Structure:
    """Return the structure of what is drawn."""
    if isinstance(what, Motion):
        return what.structure
    return what if isinstance(what, Structure) else decompose(what)


def by_name(structure: Structure, at: Any) -> dict[str, float]:
    """Return driver values by name, numbers. Raises InvalidInput or UnknownName for what does not fit."""
    names = [drive.name for drive in structure.mechanism.drives]
    if not isinstance(at, Mapping):
        if len(names) != 1:
            what = f"there are {len(names)} drivers" if names else "the mechanism has no driver"
            raise InvalidInput(Problem("at", what, "name them: at={'driver': value}"))
        at = {names[0]: at}
    for name, value in at.items():
        if name not in names:
            raise UnknownName(Problem(f"at.{name}", "there is no such driver", nearest(str(name), names)))
        if not is_finite_real(value):
            raise InvalidInput(Problem(f"at.{name}", f"{value!r} is not a number", "give the value at one pose"))
    return {name: float(value) for name, value in at.items()}


def value_note(structure: Structure, name: str, value: float) -> str:
    """Say which value a driver has."""
    is_angle = structure.driven_angles.get(name, False)
    shown = f"{round(float(degrees(value)), 9) + 0.0:.5g}" if is_angle else f"{value:.6g}"
    return f"{name} at {shown}{after_number(is_angle, structure.mechanism.unit)}"


def ends_of(structure: Structure) -> dict[str, Ends]:
    """Return the ends of all pairs, of the first design."""
    geometry = structure.mechanism.geometry
    return {pair.name: tuple(End(*map(_first_side, end)) for end in pair.ends(geometry)) for pair in structure.pairs}


def _first_side(value: Number) -> Number:
    return None if value is None else first_entry(value.c[0] if isinstance(value, Series) else value)


def asked_paths(mechanism: Mechanism, paths: Any) -> tuple[str, ...]:
    """Return the letters of points whose paths are asked for; raises UnknownName."""
    carriers = mechanism.carriers
    if paths is True:
        return tuple(letter for letter, links in carriers.items() if len(links) == 1 and "frame" not in links)
    names = (paths,) if isinstance(paths, str) else () if paths is False else tuple(paths)
    for name in names:
        if name not in carriers:
            raise UnknownName(Problem(str(name), "there is no such point", nearest(str(name), list(carriers))))
    return names


def asked_labels(labels: Any) -> tuple[str, ...]:
    """Tell what is to be labelled; raises InvalidInput for what cannot be."""
    if isinstance(labels, bool):
        return LABELS if labels else ()
    names = (labels,) if isinstance(labels, str) else tuple(labels)
    for name in names:
        if name not in LABELS:
            raise InvalidInput(Problem("labels", f"{name!r} cannot be labelled", nearest(str(name), list(LABELS))))
    return names
