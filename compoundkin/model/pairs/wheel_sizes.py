"""The axes and sizes of two wheels: numbers of teeth or radii, that go together and fit the distance of the axes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidMechanism, Problem, nearest
from compoundkin.base.series import Number

Two = tuple[Number, Number]
Sizes = Sequence[Number] | None

# Radii fit a centre distance that they meet to this part of it: drawings are given to some five digits.
FITS = 1e-5


def two_of(key: str, value: Any) -> Two | None:
    """Return two sizes as numbers or arrays. Raises InvalidMechanism naming the key for anything else.

    >>> two_of("teeth", (20, 40))
    (20.0, 40.0)
    """
    if value is None:
        return None
    try:
        one, two = (np.asarray(size, dtype=float) for size in value)
    except (TypeError, ValueError):
        what = f"{value!r} are not two numbers"
        raise InvalidMechanism(Problem(key, what, f"write {key}=(20, 40)")) from None
    return one.item() if one.ndim == 0 else one, two.item() if two.ndim == 0 else two


def wheel_problems(
    links: Mapping[str, tuple[str, ...]], members: Sequence[str], axes: Sequence[str], where: str
) -> Iterator[Problem]:
    """Find unknown links, one link twice, and axes that are not shared."""
    named = dict(zip(("first", "second", "carrier"), members, strict=True))
    missing = [(key, name) for key, name in named.items() if name not in links]
    for key, name in missing:
        yield Problem(f"{where}.{key}", f"there is no link {name!r}", nearest(name, list(links)))
    if not missing and len(set(members)) < len(members):
        yield Problem(where, "the two wheels and their carrier are not three different links", "name three links")
    elif not missing:
        for key, axis in zip(("first", "second"), axes, strict=True):
            yield from _axis_problems(links, (named[key], named["carrier"]), axis, where, key)


def _axis_problems(
    links: Mapping[str, tuple[str, ...]], pinned: tuple[str, str], axis: str, where: str, key: str
) -> Iterator[Problem]:
    """Find an axis that a wheel and its carrier do not share. These are the links that are `pinned`."""
    name, carrier = pinned
    shared = [letter for letter in links[name] if letter in links[carrier]]
    if axis and axis not in shared:
        what = f"{name!r} and {carrier!r} do not share the point {axis!r}"
        yield Problem(f"{where}.{key}_at", what, nearest(axis, shared))
    elif not shared:
        what = f"{carrier!r} does not carry the axis of {name!r}: they share no point"
        yield Problem(f"{where}.carrier", what, "give both a point of one letter, or name another carrier")
    elif not axis:
        what = f"{name!r} and {carrier!r} share several points"
        yield Problem(f"{where}.{key}_at", what, f"name the axis: {', '.join(shared)}")


def size_problems(teeth: Sizes, radii: Sizes, where: str) -> Iterator[Problem]:
    """Find two sizes that are none, or do not go together. The latter are teeth and radii."""
    if teeth is None and radii is None:
        yield Problem(where, "it has no sizes", "give teeth = (20, 40) or radii = (10, 20)")
    for key, sizes in (("teeth", teeth), ("radii", radii)):
        if sizes is None:
            continue
        if not all(np.all(np.asarray(size) > 0) for size in sizes):
            yield Problem(f"{where}.{key}", f"{_shown(sizes)} are not two positive numbers")
        elif key == "teeth" and not all(np.all(np.asarray(size) == np.round(size)) for size in sizes):
            yield Problem(f"{where}.{key}", f"{_shown(sizes)} are not whole numbers", "give radii instead")
    if teeth is not None and radii is not None and not _proportional(teeth, radii):
        what = f"teeth {_shown(teeth)} and radii {_shown(radii)} have different ratios"
        yield Problem(where, what, "leave one of them out")


def distance_problems(axes: str, distance: Number, wanted: Number, where: str, said: str) -> Iterator[Problem]:
    """Find wheels whose sizes do not fit the distance of their axes. The axes are on the carrier."""
    off = np.abs(wanted - distance) > FITS * np.abs(distance)
    if np.any(off):
        at = int(np.argmax(np.ravel(np.broadcast_to(off, np.shape(off)))))
        a, b = (np.ravel(np.broadcast_to(value, np.shape(off)))[at] for value in (wanted, distance))
        what = f"{said} {a:.6g}, but {axes} are {b:.6g} apart"
        yield Problem(where, what, "change the sizes or move an axis; give teeth alone for a distance as it is")


def _proportional(one: Sequence[Number], two: Sequence[Number]) -> bool:
    return bool(np.all(np.abs(one[0] * two[1] - one[1] * two[0]) <= FITS * np.abs(one[0] * two[1])))


def _shown(sizes: Sequence[Number]) -> str:
    return " and ".join(f"{size:g}" if np.ndim(size) == 0 else str(np.asarray(size).tolist()) for size in sizes)


def pressure_problems(angle: Number, where: str) -> Iterator[Problem]:
    """Find a pressure angle that is none."""
    if np.ndim(angle) or not 0.0 <= angle < np.pi / 2.0:
        shown = f"{np.rad2deg(angle):g} degrees" if np.ndim(angle) == 0 else "an array"
        remedy = "give one angle from 0 up to 90 degrees, such as pressure_angle=ck.deg(20)"
        yield Problem(f"{where}.pressure_angle", f"{shown} is no pressure angle", remedy)


def radius_problems(where: str, key: str, radius: Number | None) -> Iterator[Problem]:
    """Find a radius, or another length or number, that is not positive."""
    if radius is not None and not np.all(np.asarray(radius) > 0):
        shown = f"{radius:g}" if np.ndim(radius) == 0 else str(np.asarray(radius).tolist())
        yield Problem(f"{where}.{key}", f"{shown} is not positive", "give the size of the wheel")
