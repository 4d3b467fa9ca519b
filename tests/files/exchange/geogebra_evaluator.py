"""An evaluator of GeoGebra's input-bar commands, as far as constructions use them; over arrays of slider values.

Written from GeoGebra's manual, and knows nothing of mechanisms: numbers are floats, points and vectors complex.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

NAME = r"[^\W\d_][^\W_]*'*(?:_\{[^}]+\}|_\w)?"
TOKEN = re.compile(rf"\s*(?:(\d+(?:\.\d*)?(?:E[+-]?\d+)?)|({NAME})|(∧|[-+*/^(),;<°]))")


def tokens(text: str) -> list[tuple[str, str]]:
    found, at = [], 0
    while at < len(text.rstrip()):
        match = TOKEN.match(text, at)
        assert match, f"{text!r} at {at}"
        kind = ("number", "name", "sign")[next(k for k in range(3) if match[k + 1])]
        found.append((kind, match[0].strip()))
        at = match.end()
    return [*found, ("end", "")]


class Line:
    def __init__(self, start: Any, end: Any) -> None:
        self.start, self.along = start, (end - start) / np.abs(end - start)

    def closest(self, point: Any) -> Any:
        return self.start + self.along * (np.conj(self.along) * (point - self.start)).real

    def meets(self, other: Line) -> Any:
        sine = (np.conj(self.along) * other.along).imag
        gap = other.start - self.start
        return self.start + self.along * ((np.conj(gap) * other.along).imag / sine)


class Shape:
    def __init__(self, kind: str, parts: tuple[Any, ...]) -> None:
        self.kind, self.parts = kind, parts


def number(value: Any) -> Any:
    assert not np.iscomplexobj(value), "a number was wanted"
    return value


def point(value: Any) -> Any:
    assert np.iscomplexobj(value), "a point was wanted"
    return value


FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "atan2": lambda y, x: np.arctan2(number(y), number(x)),
    "acos": lambda v: np.arccos(number(v)),
    "sqrt": lambda v: np.sqrt(number(v)),
    "abs": lambda v: np.abs(number(v)),
    "sgn": lambda v: np.sign(number(v)),
    "floor": lambda v: np.floor(number(v)),
    "cos": lambda v: np.cos(number(v)),
    "sin": lambda v: np.sin(number(v)),
    "x": lambda p: point(p).real,
    "y": lambda p: point(p).imag,
    "If": lambda test, yes, no: np.where(test, yes, no),
    "Distance": lambda a, b: np.abs(point(a) - point(b)),
    "Length": lambda v: np.abs(point(v)),
    "Line": lambda a, b: Line(point(a), point(b)),
    "ClosestPoint": lambda line, p: line.closest(point(p)),
    "Intersect": lambda one, two: one.meets(two),
    "Segment": lambda *p: Shape("segment", tuple(map(point, p))),
    "Polygon": lambda *p: Shape("polygon", tuple(map(point, p))),
    "Circle": lambda p, r: Shape("circle", (point(p), number(r))),
    "Locus": lambda p, slider: Shape("locus", (point(p), slider)),
}


class Reading:
    """One expression, read from left to right."""

    def __init__(self, text: str, known: Mapping[str, Any]) -> None:
        self.tokens, self.at, self.known = tokens(text), 0, known

    def value(self) -> Any:
        found = self.both()
        assert self.tokens[self.at][0] == "end", self.tokens[self.at]
        return found

    def next_is(self, *signs: str) -> str:
        kind, text = self.tokens[self.at]
        if kind == "sign" and text in signs:
            self.at += 1
            return text
        return ""

    def both(self) -> Any:
        found = self.compared()
        while self.next_is("∧"):
            found = found & self.compared()
        return found

    def compared(self) -> Any:
        found = self.sum()
        return found < self.sum() if self.next_is("<") else found

    def sum(self) -> Any:
        found = -self.product() if self.next_is("-") else self.product()
        while sign := self.next_is("+", "-"):
            other = self.product()
            assert np.iscomplexobj(found) == np.iscomplexobj(other), "a number and a point are added"
            found = found + other if sign == "+" else found - other
        return found

    def product(self) -> Any:
        found = self.power()
        while sign := self.next_is("*", "/"):
            other = self.power()
            found = found * other if sign == "*" else found / other
        return found

    def power(self) -> Any:
        found = self.primary()
        while self.next_is("°"):
            found = number(found) * (np.pi / 180.0)
        return found ** self.power() if self.next_is("^") else found

    def primary(self) -> Any:
        kind, text = self.tokens[self.at]
        self.at += 1
        if kind == "number":
            return float(text)
        if kind == "name":
            return self.called(text) if self.tokens[self.at][1] == "(" else self.known[text]
        if text == "°":
            return np.pi / 180.0
        if text == "-":
            return -self.power()
        assert text == "(", text
        found = self.both()
        if sign := self.next_is(",", ";"):
            other = number(self.both())
            found = number(found) + 1j * other if sign == "," else number(found) * np.exp(1j * other)
        assert self.next_is(")")
        return found

    def called(self, name: str) -> Any:
        self.at += 1
        arguments = [self.both()]
        while self.next_is(","):
            arguments.append(self.both())
        assert self.next_is(")")
        return FUNCTIONS[name](*arguments)


COMMAND = re.compile(rf"({NAME}) = (.*)")
SLIDER = re.compile(r"Slider\(([^,]+), ([^,]+), ([^,]+)\)")


def evaluated(lines: list[str], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return all objects by their names; `given` are the values of sliders and free numbers that differ."""
    known: dict[str, Any] = {}
    for line in lines:
        if line.startswith("SetValue("):
            name, value = line[9:-1].rsplit(", ", 1)
            known[name] = given.get(name, float(value))
            continue
        match = COMMAND.fullmatch(line)
        assert match, line
        name, text = match.groups()
        assert name not in known, f"{name} is there twice"
        slider = SLIDER.fullmatch(text)
        if slider:
            low, high, step = map(float, slider.groups())
            assert low < high, line
            assert 0 < step <= high - low, line
            known[name] = given.get(name, low)
        else:
            known[name] = given[name] if name in given else Reading(text, known).value()
    return known
