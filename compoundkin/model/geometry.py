"""Points and numbers as they are written, and dimensions made of them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, planar_numbers, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, LikelySlip, Problem, warn
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant

# The link that stands still.
FRAME = "frame"


@dataclass(frozen=True, repr=False)
class Geometry(ShortRepr):
    """The points of links in their own frames, and the poses that are drawn.

    `points[link][name]` is complex, a number or an array; `drawn[link]` is a `Pose` of order 0.
    `as_drawn` names the links whose dimensions were read off the drawing.
    """

    points: Mapping[str, Mapping[str, Number]]
    drawn: Mapping[str, Pose]
    as_drawn: frozenset[str]
    sketch: Mapping[str, Number]
    profiles: float = 0.0  # the size of the largest profile

    @property
    def size(self) -> float:
        """The length scale, the greatest distance on a link or size of a profile; that of the greatest design."""
        return float(np.max(self.sizes))

    @cached_property
    def sizes(self) -> Number:
        """The length scale of each design, an array over their axes with a last one of 1; a number if all share it."""
        found = spans_of(points.values() for points in (*self.points.values(), self.sketch))
        found = np.maximum(found, self.profiles) if np.ndim(found) else max(found, self.profiles)
        if not np.ndim(found):
            return found or 1.0
        found = np.where(found > 0.0, found, 1.0)
        return found if np.any(found != found.flat[0]) else found.item(0)


def spans_of(many: Iterable[Collection[Number]]) -> Number:
    """Return the greatest diagonal of the boxes around points, over the axes of designs."""
    spans = [_span(list(points)) for points in many]
    return reduce(np.maximum, spans, 0.0) if any(map(np.ndim, spans)) else max(spans, default=0.0)


def _span(points: list[Number]) -> Number:
    """Return the diagonal of the box around some points of each design, along the whole motion."""
    if len(points) < 2:
        return 0.0
    if all(isinstance(p, complex) for p in points):
        # without arrays: a mechanism may have tens of thousands of links
        across, up = [p.real for p in points], [p.imag for p in points]
        return float(np.hypot(max(across) - min(across), max(up) - min(up)))
    wide, high = (_extent([part(p) for p in points]) for part in (np.real, np.imag))
    found = np.hypot(wide, high)
    return found.item() if found.ndim < 2 else found


def _extent(values: list[Number]) -> Number:
    """Return how far apart numbers of each design are. The last axis is the motion."""
    whole = [np.atleast_1d(value) for value in values]
    greatest = reduce(np.maximum, (np.max(value, axis=-1, keepdims=True) for value in whole))
    return greatest - reduce(np.minimum, (np.min(value, axis=-1, keepdims=True) for value in whole))


def link_from_drawing(letters: tuple[str, ...], sketch: Mapping[str, Number]) -> tuple[Pose | None, dict[str, Number]]:
    """Return a link's drawn pose, and its points in its own frame.

    The origin is the first letter; the x axis points to the second. A single letter has no direction, so no pose.
    """
    if len(letters) == 1:
        return None, {letters[0]: 0j}
    origin = sketch[letters[0]]
    line = sketch[letters[1]] - origin
    turned = line / np.abs(line)
    back = np.conjugate(turned)
    points: dict[str, Number] = {}
    for letter in letters:
        p = back * (sketch[letter] - origin)
        points[letter] = complex(p) if np.ndim(p) == 0 else p
    # the second letter defines the axis: keep rounding out of it
    points[letters[1]] = points[letters[1]].real + 0j
    return Pose(constant(origin), constant(turned)), points


# Points nearer to each other than this have no direction: products of their coordinates are no normal numbers.
TINY = 1e-150


def _apart(p: Number, q: Number) -> bool:
    return bool(np.all(np.abs(p - q) > TINY))


def pose_from_points(points: Mapping[str, Number], sketch: Mapping[str, Number]) -> Pose | None:
    """Return the pose of a link drawn at two points or more, or None."""
    drawn = [name for name in points if name in sketch]
    if len(drawn) < 2:
        return None
    a = drawn[0]
    b = next((k for k in drawn[1:] if _apart(sketch[k], sketch[a]) and _apart(points[k], points[a])), None)
    if b is None:
        return None
    turned = (sketch[b] - sketch[a]) * np.conjugate(points[b] - points[a])
    turned = turned / np.abs(turned)
    return Pose(constant(sketch[a] - turned * points[a]), constant(turned))


@checked
def deg(angle: Any) -> Number:
    """Return degrees as radians: a number, a list, a range or an array.

    >>> round(deg(180), 6)
    3.141593
    """
    value = np.deg2rad(real_numbers("angle", angle))
    return float(value) if value.ndim == 0 else value


@checked
def polar(radius: Any, angle: Any) -> Number:
    """Return the planar vector of a length and an angle (radians).

    A complex number or array. Raises InvalidInput for infinite numbers, which have no place.

    >>> polar(2.0, 0.0)
    (2+0j)
    """
    length, turned = real_numbers("radius", radius), real_numbers("angle", angle)
    for where, numbers in (("radius", length), ("angle", turned)):
        if np.isinf(numbers).any():
            raise InvalidInput(Problem(where, "infinite numbers give no vector", "give finite ones"))
    value = length * (np.cos(turned) + 1j * np.sin(turned))
    return complex(value) if value.ndim == 0 else value


def vector(where: str, value: Any) -> Number:
    """Return a planar vector written as complex or as (x, y), numbers or arrays.

    Raises InvalidMechanism naming `where`.

    >>> vector("A", (1, [2, 3])).tolist()
    [(1+2j), (1+3j)]
    """
    try:
        out = _planar(where, value)
    except InvalidMechanism as error:
        raise InvalidMechanism(replace(p, remedy="write (x, y) or a complex number") for p in error.problems) from None
    return complex(out) if out.ndim == 0 else _read_only(out)


def _planar(where: str, value: Any) -> Any:
    if isinstance(value, tuple | list) and len(value) == 2:
        x, y = (real_numbers(where, v, InvalidMechanism) for v in value)
        if isinstance(value, list) and x.shape == y.shape == (1,):
            text = f"{where}: {value} is read as x = {x[0]:g}, y = {y[0]:g} of one design"
            warn(f"{text}; two designs are written ({value}, 0)", LikelySlip)
        try:
            with np.errstate(invalid="ignore"):  # infinite coordinates are reported where they have no meaning
                return x + 1j * y
        except ValueError:
            raise _point_error(where, value) from None
    if value is None or isinstance(value, tuple | list | str):
        raise _point_error(where, value)
    return planar_numbers(where, value, InvalidMechanism)


def _point_error(where: str, value: Any) -> InvalidMechanism:
    return InvalidMechanism(Problem(where, f"{short_repr(value)} is not a point"))


def _read_only(array: Any) -> Any:
    out = np.array(array)
    out.setflags(write=False)
    return out


def real(where: str, value: Any) -> Number:
    """Return a number, or an array that cannot be written to; None stays None. Raises InvalidMechanism naming `where`.

    >>> real("time", [0, 1]).tolist()
    [0.0, 1.0]
    """
    if value is None:
        return None
    out = real_numbers(where, value, InvalidMechanism)
    return float(out) if out.ndim == 0 else _read_only(out)


def single_point(value: Any, where: str = "profile") -> complex:
    """Return a point written as (x, y) or as a complex number. Raises InvalidMechanism for anything else."""
    try:
        if isinstance(value, str):  # Python reads "1+2j" as a number
            raise ValueError
        return complex(value) if np.ndim(value) == 0 else complex(*(float(v) for v in value))
    except (TypeError, ValueError, OverflowError):
        raise InvalidMechanism(Problem(where, f"{value!r} is not a point", "write (x, y)")) from None


def single_number(value: Any, where: str) -> float:
    """Return one real number; raises InvalidMechanism naming `where` for anything else."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InvalidMechanism(
            Problem(where, f"{value!r} is not one number", "give one; one profile for each design")
        ) from None
