"""What the commands and expressions of GeoGebra give, over arrays of poses: numbers, points, lines, circles.

Written from its manual. Numbers are arrays of floats, points and vectors arrays of complex ones.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arrays import TURN, Number


@dataclass(frozen=True)
class Straight:
    """A line, ray, segment or vector's line. `along` has length one; `length` is that of a segment."""

    start: Number
    along: Number
    length: Number | None = None


@dataclass(frozen=True)
class Circle:
    """A circle."""

    centre: Number
    radius: Number


@dataclass(frozen=True)
class Corners:
    """A polygon or a line of segments."""

    points: tuple[Number, ...]


# Numbers are arrays of floats, points and vectors arrays of complex ones.
Value = Any


class NotReadError(Exception):
    """An object has no value here; it says why."""


class NamedValues(Protocol):
    """The objects that an expression may name."""

    values: dict[str, Value]
    unread: dict[str, str]

    def whole(self, value: complex) -> Number:
        """Return a value at all poses."""

    def computed(self, text: str) -> Value:
        """Return the value of an expression. Raises NotReadError."""


def given_by(name: str, parts: Sequence[Value]) -> Value:
    """Return what a command gives. Raises NotReadError for one that is not known."""
    if name not in _COMMANDS:
        raise NotReadError(f"the command {name[:40]} is not read")
    try:
        found = _COMMANDS[name](*parts)
    except (TypeError, AttributeError, ValueError, IndexError):
        found = None
    if found is None:
        raise NotReadError(f"the command {name} is not read with what it is given here")
    return found


def is_number(value: Value) -> bool:
    """Return whether a value is a number."""
    return isinstance(value, np.ndarray) and not np.iscomplexobj(value)


def is_point(value: Value) -> bool:
    """Return whether a value is a point or a vector."""
    return isinstance(value, np.ndarray) and np.iscomplexobj(value)


def _point(value: Value) -> Number:
    if not is_point(value):
        raise ValueError
    return value


def _number(value: Value) -> Number:
    if not is_number(value):
        raise ValueError
    return value


def _unit(vector: Number) -> Number:
    return vector / np.abs(vector)


def _segment(start: Number, end: Number) -> Straight:
    return Straight(_point(start), _unit(_point(end) - start), np.abs(end - start))


def edges_of(points: Sequence[Number], *, closed: bool) -> Iterator[Value]:
    """Yield corners, then the sides of a polygon."""
    yield Corners(tuple(points))
    if closed:
        for k, start in enumerate(points):
            yield _segment(start, points[(k + 1) % len(points)])


def regular_polygon(first: Number, second: Number, count: int) -> list[Value]:
    """Return a regular polygon over a side, its sides, its other corners."""
    points = [_point(first), _point(second)]
    for _ in range(count - 2):
        points.append(points[-1] + (points[-1] - points[-2]) * np.exp(1j * TURN / count))
    return [*edges_of(points, closed=True), *points[2:]]


def meetings(one: Value, other: Value) -> list[Number]:
    """Return where two objects meet, in an order that their shapes alone tell. Raises NotReadError.

    Of two circles the first point is to the left of the way from the first centre to the second; of a line and a
    circle it is the one farther along.
    """
    if isinstance(one, Circle) and isinstance(other, Straight):
        one, other = other, one
    if isinstance(one, Straight) and isinstance(other, Straight):
        sine = (np.conj(one.along) * other.along).imag
        return [one.start + one.along * ((np.conj(other.start - one.start) * other.along).imag / sine)]
    if isinstance(one, Straight) and isinstance(other, Circle):
        foot = one.start + one.along * (np.conj(one.along) * (other.centre - one.start)).real
        half = np.sqrt(other.radius**2 - np.abs(foot - other.centre) ** 2)
        return [foot + one.along * half, foot - one.along * half]
    if isinstance(one, Circle) and isinstance(other, Circle):
        gap = other.centre - one.centre
        far = np.abs(gap)
        along = (one.radius**2 - other.radius**2 + far**2) / (2.0 * far)
        across = np.sqrt(one.radius**2 - along**2)
        return [one.centre + gap / far * (along + side * 1j * across) for side in (1.0, -1.0)]
    raise NotReadError("only lines and circles meet here")


def _line(start: Number, toward: Value) -> Straight:
    if isinstance(toward, Straight):
        return Straight(_point(start), toward.along)
    return Straight(_point(start), _unit(_point(toward) - start))


def _vector(start: Number, end: Number | None = None) -> Number:
    return _point(start) if end is None else _point(end) - _point(start)


def _across(start: Number, line: Value) -> Straight:
    return Straight(_point(start), 1j * (line.along if isinstance(line, Straight) else _unit(_point(line))))


def _bisector(one: Value, other: Value = None) -> Straight:
    start, end = (one.start, one.start + one.along * one.length) if other is None else (_point(one), _point(other))
    return Straight((start + end) / 2.0, 1j * _unit(end - start))


def _middle(one: Value, other: Value = None) -> Number:
    if isinstance(one, Circle):
        return one.centre
    return one.start + one.along * one.length / 2.0 if other is None else (_point(one) + _point(other)) / 2.0


def _circle(first: Number, second: Value, third: Value = None) -> Circle:
    a = _point(first)
    if third is None:
        if isinstance(second, Straight):
            return Circle(a, second.length)
        return Circle(a, np.abs(second - a) if is_point(second) else _number(second))
    b, c = _point(second) - a, _point(third) - a
    centre = (np.abs(b) ** 2 * c - np.abs(c) ** 2 * b) / (2j * (np.conj(b) * c).imag)
    return Circle(a + centre, np.abs(centre))


def _angle(one: Value, apex: Value = None, other: Value = None) -> Number:
    if apex is None:
        return np.angle(_point(one)) % TURN
    if isinstance(one, Straight) and isinstance(apex, Straight):
        return np.angle(apex.along * np.conj(one.along)) % TURN
    if other is None:
        return np.angle(_point(apex) * np.conj(_point(one))) % TURN
    return np.angle((_point(other) - _point(apex)) * np.conj(_point(one) - apex)) % TURN


def _moved(value: Value, way: Callable[[Number], Number], scale: Any = 1.0) -> Value:
    """Return an object moved by a way that keeps shapes."""
    if isinstance(value, Circle):
        return Circle(way(value.centre), value.radius * np.abs(scale))
    if isinstance(value, Corners):
        return Corners(tuple(way(point) for point in value.points))
    if isinstance(value, Straight):
        length = None if value.length is None else value.length * np.abs(scale)
        start = way(value.start)
        return Straight(start, _unit(way(value.start + value.along) - start), length)
    return way(_point(value))


def _rotate(value: Value, angle: Number, about: Number | None = None) -> Value:
    centre = 0j if about is None else _point(about)
    return _moved(value, lambda p: centre + (p - centre) * np.exp(1j * _number(angle)))


def _mirror(value: Value, by: Value) -> Value:
    if isinstance(by, Straight):
        return _moved(value, lambda p: by.start + by.along**2 * np.conj(p - by.start))
    return _moved(value, lambda p: 2.0 * _point(by) - p)


def _dilate(value: Value, factor: Number, about: Number | None = None) -> Value:
    centre = 0j if about is None else _point(about)
    return _moved(value, lambda p: centre + (p - centre) * _number(factor), factor)


def _closest(path: Value, point: Value) -> Number:
    if is_point(path):
        path, point = point, path
    if isinstance(path, Circle):
        return path.centre + path.radius * _unit(_point(point) - path.centre)
    return path.start + path.along * (np.conj(path.along) * (_point(point) - path.start)).real


def _distance(one: Value, other: Value) -> Number:
    if is_point(one) and is_point(other):
        return np.abs(one - other)
    line, point = (one, other) if isinstance(one, Straight) else (other, one)
    return np.abs((np.conj(line.along) * (_point(point) - line.start)).imag)


def _length(one: Value) -> Number:
    if isinstance(one, Straight):
        return one.length
    return np.abs(_point(one))


def _point_of(path: Value, way: Number) -> Number:
    if is_point(path):
        return path + _point(way)
    if isinstance(path, Straight) and path.length is not None:
        return path.start + path.along * path.length * _number(way)
    if isinstance(path, Circle):
        return path.centre + path.radius * np.exp(1j * TURN * _number(way))
    raise ValueError


_COMMANDS: Mapping[str, Callable[..., Value]] = {
    "Line": _line,
    "Ray": _line,
    "Segment": _segment,
    "OrthogonalLine": _across,
    "PerpendicularLine": _across,
    "LineBisector": _bisector,
    "AngularBisector": lambda a, b, c: Straight(_point(b), _unit(_unit(a - b) + _unit(c - b))),
    "Midpoint": _middle,
    "Center": _middle,
    "Circle": _circle,
    "Semicircle": lambda a, b: Circle((_point(a) + _point(b)) / 2.0, np.abs(b - a) / 2.0),
    "CircleArc": lambda centre, start, _: _circle(centre, _point(start)),
    "CircularArc": lambda centre, start, _: _circle(centre, _point(start)),
    "CircleSector": lambda centre, start, _: _circle(centre, _point(start)),
    "CircumcircleArc": _circle,
    "Vector": _vector,
    "UnitVector": lambda one: one.along if isinstance(one, Straight) else _unit(_point(one)),
    "Direction": lambda line: line.along,
    "OrthogonalVector": lambda one: 1j * (one.along if isinstance(one, Straight) else _point(one)),
    "UnitOrthogonalVector": lambda one: 1j * (one.along if isinstance(one, Straight) else _unit(_point(one))),
    "Intersect": lambda one, other: meetings(one, other)[0] if isinstance(other, Straight) else None,
    "Rotate": _rotate,
    "Translate": lambda value, way: _moved(value, lambda p: p + _point(way)),
    "Mirror": _mirror,
    "Reflect": _mirror,
    "Dilate": _dilate,
    "ClosestPoint": _closest,
    "Distance": _distance,
    "Length": _length,
    "Radius": lambda circle: circle.radius,
    "Angle": _angle,
    "Point": _point_of,
    "PointIn": lambda _: None,
    "If": lambda test, yes, no: np.where(test, yes, no),
}


_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "sin": lambda v: np.sin(_number(v)),
    "cos": lambda v: np.cos(_number(v)),
    "tan": lambda v: np.tan(_number(v)),
    "asin": lambda v: np.arcsin(_number(v)),
    "acos": lambda v: np.arccos(_number(v)),
    "atan": lambda v: np.arctan(_number(v)),
    "atan2": lambda y, x: np.arctan2(_number(y), _number(x)),
    "sqrt": lambda v: np.sqrt(_number(v)),
    "exp": lambda v: np.exp(_number(v)),
    "ln": lambda v: np.log(_number(v)),
    "abs": np.abs,
    "sgn": lambda v: np.sign(_number(v)),
    "floor": lambda v: np.floor(_number(v)),
    "ceil": lambda v: np.ceil(_number(v)),
    "round": lambda v: np.round(_number(v)),
    "mod": lambda a, b: np.mod(_number(a), _number(b)),
    "min": lambda a, b: np.minimum(_number(a), _number(b)),
    "max": lambda a, b: np.maximum(_number(a), _number(b)),
    "x": lambda p: _point(p).real,
    "y": lambda p: _point(p).imag,
}

# Other words for the same functions.
_ALSO = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "sign": "sgn", "arcTan2": "atan2"}

NAME = re.compile(r"[^\W\d_][^\W_]*'*(?:_\{[^}]*\}|_\w)?")

_TOKEN = re.compile(
    rf"\s*(?:(?P<number>\d+\.?\d*(?:E[+-]?\d+)?|\.\d+(?:E[+-]?\d+)?)|(?P<name>{NAME.pattern})|(?P<sign><=|>=|==|&&|.))"
)

# No expression that anybody wrote is as long, or has as many brackets in each other.
_LONGEST, _DEEPEST = 4000, 40

_COMPARED: Mapping[str, Callable[[Any, Any], Any]] = {
    "<": np.less, ">": np.greater, "<=": np.less_equal, ">=": np.greater_equal, "≤": np.less_equal,
    "≥": np.greater_equal, "==": np.equal, "≟": np.equal,
}  # fmt: skip


class ReadExpression:
    """An expression by its tokens, evaluated while it is read."""

    def __init__(self, text: str, objects: NamedValues) -> None:
        if len(text) > _LONGEST:
            raise NotReadError("its expression is too long")
        self._objects, self._at, self._depth = objects, 0, 0
        # a circle may be called C_{1}, an angle α; the sign of degrees stands behind a number
        self._tokens = [(str(found.lastgroup), found[0].strip()) for found in _TOKEN.finditer(text.strip())]
        self._tokens.append(("end", ""))
        self.value = self._logical()
        if self._sign != "":
            raise NotReadError(f"{self._sign!r} is not read in its expression")

    @property
    def _sign(self) -> str:
        return self._tokens[self._at][1]

    def _takes(self, *signs: str) -> str:
        if self._sign in signs and self._sign:
            self._at += 1
            return self._tokens[self._at - 1][1]
        return ""

    def _need(self, *signs: str) -> None:
        if not self._takes(*signs):
            raise NotReadError("its expression is not read")

    def _logical(self) -> Value:
        value = self._comparison()
        while sign := self._takes("∧", "∨", "&&"):
            other = self._comparison()
            value = np.logical_or(value, other) if sign == "∨" else np.logical_and(value, other)
        return value

    def _comparison(self) -> Value:
        value = self._sum()
        while sign := self._takes(*_COMPARED):
            value = _COMPARED[sign](_plain(value), _plain(self._sum()))
        return value

    def _sum(self) -> Value:
        sign = self._takes("+", "-")
        value = self._product()
        if sign == "-":
            value = -_plain(value)
        while sign := self._takes("+", "-"):
            other = _plain(self._product())
            value = _plain(value) + other if sign == "+" else _plain(value) - other
        return value

    def _product(self) -> Value:
        value = self._power()
        while True:
            if self._takes("*"):
                value = _times(value, self._signed_power())
            elif self._takes("/"):
                value = _plain(value) / _number_of(self._signed_power())
            elif self._tokens[self._at][0] in ("number", "name") or self._sign in ("(", "°"):
                value = _times(value, self._power())
            else:
                return value

    def _signed_power(self) -> Value:
        return -_plain(self._power()) if self._takes("-") else self._power()

    def _power(self) -> Value:
        value = self._atom()
        while sign := self._takes("^", "²", "³", "°"):
            if sign == "°":
                value = _number_of(value) * (pi / 180.0)
            elif sign == "^":
                value = _number_of(value) ** _number_of(self._signed_power())
            else:
                value = _number_of(value) ** (2 if sign == "²" else 3)
        return value

    def _atom(self) -> Value:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise NotReadError("its expression is nested too deeply")
        kind, word = self._tokens[self._at]
        self._at += 1
        if kind == "number":
            value: Value = self._objects.whole(float(word))
        elif kind == "name":
            value = self._named(word)
        elif word == "(":
            value = self._bracketed()
        elif word == "°":
            value = self._objects.whole(pi / 180.0)
        elif word == "|":
            value = np.abs(_plain(self._sum()))
            self._need("|")
        else:
            raise NotReadError(f"{word[:20]!r} is not read in its expression" if word else "its expression is cut off")
        self._depth -= 1
        return value

    def _bracketed(self) -> Value:
        """Return what is in brackets: a value, a place by its coordinates, or one by its length and angle."""
        first = self._logical()
        if self._takes(","):
            second = self._logical()
            self._need(")")
            return _number_of(first) + 1j * _number_of(second)
        if self._takes(";"):
            second = self._logical()
            self._need(")")
            return _number_of(first) * np.exp(1j * _number_of(second))
        self._need(")")
        return first

    def _named(self, word: str) -> Value:
        objects = self._objects
        if word in objects.values or word in objects.unread:
            return objects.computed(word)
        if word in ("π", "pi"):
            return objects.whole(pi)
        if word in ("ℯ", "e"):
            return objects.whole(float(np.e))
        if self._sign not in ("(", "["):
            raise NotReadError(f"{word[:40]} is not read")
        self._at += 1
        parts = [self._logical()]
        while self._takes(","):
            parts.append(self._logical())
        self._need(")", "]")
        word = _ALSO.get(word, word)
        if word not in _FUNCTIONS:
            return given_by(word, parts)
        try:
            return _FUNCTIONS[word](*parts)
        except (TypeError, ValueError):
            raise NotReadError(f"{word} is not read with what it is given here") from None


def _plain(value: Value) -> Number:
    """Return a number, point or vector; a segment stands for its length."""
    if isinstance(value, Straight) and value.length is not None:
        return value.length
    if not isinstance(value, np.ndarray):
        raise NotReadError("its expression reckons with what is neither number nor point")
    return value


def _number_of(value: Value) -> Number:
    found = _plain(value)
    if np.iscomplexobj(found):
        raise NotReadError("its expression reckons with a point where a number is wanted")
    return found


def _times(one: Value, other: Value) -> Number:
    first, second = _plain(one), _plain(other)
    if np.iscomplexobj(first) and np.iscomplexobj(second):  # the scalar product
        return (np.conj(first) * second).real
    return first * second
