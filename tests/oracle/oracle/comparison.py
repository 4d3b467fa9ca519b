"""What differs between two records: numbers beyond a tolerance, anything else at all."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from itertools import zip_longest
from typing import Any

import numpy as np

from tests.oracle.record import SLOW, Line

# Relative to the largest number of an array: of places, and of what derivatives and conditioning magnify.
EXACT, MAGNIFIED, JERKED, POOR = 1e-12, 1e-9, 1e-8, 1e-6
TOLERANCES = {
    **dict.fromkeys(("position", "angle", "value", "points", "directions"), EXACT),
    **dict.fromkeys(("jerk", "angular_jerk", "third"), JERKED),
    "conditioning": POOR,
}
# An array of smaller numbers is held against this.
LEAST = 1e-3
# In texts smaller numbers are rounding.
ROUNDING = 1e-8
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?(?![\w.])", re.IGNORECASE)
SHOWN = 160

Difference = tuple[str, str]


class Comparison:
    """Counts equal cases by part and prints the differences of the others as they come."""

    def __init__(self, looser: float = 1.0, most: int = 8) -> None:
        self.looser, self.most = looser, most
        self.equal: dict[str, int] = {}
        self.different: dict[str, int] = {}
        self.undecided = 0

    def compare(self, before: Iterable[Line], now: Iterable[Line], partly: bool) -> None:
        """Compare lines in any order; `partly` where the second ones are only some of the first."""
        known = {(line.case, line.part): line.found for line in before}
        for line in now:
            key = (line.case, line.part)
            self._told(line, known.pop(key)) if key in known else self._missing(line.case, line.part, "only now")
        for case, part in () if partly else known:
            self._missing(case, part, "only before")

    def summary(self) -> str:
        """How many cases are equal, part by part."""
        parts = dict.fromkeys([*self.equal, *self.different])
        lines = [f"{p:16}{self.equal.get(p, 0):6} equal{self.different.get(p, 0):6} different" for p in parts]
        return "\n".join([*lines, *([f"{self.undecided} undecided: too slow once"] if self.undecided else [])])

    def _told(self, line: Line, before: Any) -> None:
        if SLOW in (before, line.found) and before != line.found:
            self.undecided += 1
            return
        found = list(self._differences(before, line.found, "", MAGNIFIED)) if before != line.found else []
        counts = self.different if found else self.equal
        counts[line.part] = counts.get(line.part, 0) + 1
        for path, what in found[: self.most]:
            print(f"{line.case} {line.part}{path}: {what}", flush=True)
        if len(found) > self.most:
            print(f"{line.case} {line.part}: and {len(found) - self.most} more", flush=True)

    def _missing(self, case: str, part: str, where: str) -> None:
        self.different[part] = self.different.get(part, 0) + 1
        print(f"{case} {part}: {where}", flush=True)

    def _differences(self, a: Any, b: Any, path: str, limit: float) -> Iterator[Difference]:
        if isinstance(a, dict) and isinstance(b, dict):
            for key in dict.fromkeys([*a, *b]):
                yield from self._of_key(a, b, key, path, TOLERANCES.get(key, limit))
        elif _is_numeric(a) and _is_numeric(b):
            yield from self._of_numbers(a, b, path, limit)
        elif isinstance(a, list) and isinstance(b, list):
            for k, (one, other) in enumerate(zip_longest(a, b, fillvalue="(nothing)")):
                yield from self._differences(one, other, f"{path}[{k}]", limit)
        elif isinstance(a, str) and isinstance(b, str):
            yield from _of_texts(a, b, path)
        elif a != b:
            yield path, f"{_short(a)} -> {_short(b)}"

    def _of_key(self, a: Any, b: Any, key: str, path: str, limit: float) -> Iterator[Difference]:
        if key not in a or key not in b:
            yield f"{path}.{key}", "only now" if key in b else "only before"
        elif key != "hash":
            yield from self._differences(a[key], b[key], f"{path}.{key}", limit)

    def _of_numbers(self, a: Any, b: Any, path: str, limit: float) -> Iterator[Difference]:
        one, other = np.array(a, dtype=float), np.array(b, dtype=float)
        if one.shape != other.shape or not np.array_equal(np.isfinite(one), np.isfinite(other)):
            yield path, f"{_short(a)} -> {_short(b)}"
            return
        finite = np.isfinite(one)
        largest = float(np.max(np.abs(one[finite]), initial=0.0))
        gap = float(np.max(np.abs(one[finite] - other[finite]), initial=0.0))
        if gap > limit * self.looser * max(largest, LEAST):
            at = int(np.argmax(np.where(finite, np.abs(one - other), -1.0)))
            yield (
                path,
                f"{one.flat[at]:.15g} -> {other.flat[at]:.15g} at {at}, {gap / max(largest, LEAST):.1e} of largest",
            )


def _is_numeric(value: Any) -> bool:
    """Whether it is a float or an array with floats; ints and bools are compared exactly."""
    if isinstance(value, list):
        return bool(value) and all(_is_number(one) or _is_numeric(one) for one in value) and _has_float(value)
    return isinstance(value, float)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _has_float(value: Any) -> bool:
    return isinstance(value, float) or (isinstance(value, list) and any(map(_has_float, value)))


def _of_texts(a: str, b: str, path: str) -> Iterator[Difference]:
    """The first line in which two texts differ by more than numbers that are rounding."""
    if a == b:
        return
    for number, (one, other) in enumerate(zip_longest(a.splitlines(), b.splitlines(), fillvalue="(nothing)"), 1):
        if one != other and not _alike(one, other):
            start = next((k for k, (x, y) in enumerate(zip(one, other, strict=False)) if x != y), 0)
            cut = slice(max(0, start - 30), start + SHOWN)
            yield f"{path} line {number}", f"{one[cut]!r} -> {other[cut]!r}"
            return


def _alike(one: str, other: str) -> bool:
    """Whether two lines differ in numbers that are rounding, and in the width of their columns for it."""
    first, second = NUMBER.findall(one), NUMBER.findall(other)
    if len(first) != len(second) or _bare(one) != _bare(other):
        return False
    changed = [(x, y) for x, y in zip(first, second, strict=True) if x != y]
    return all(_tiny(x) and _tiny(y) for x, y in changed)


def _bare(line: str) -> str:
    """A line without numbers, and without what fills columns."""
    return re.sub(r"[\s─-]+", " ", NUMBER.sub("#", line))


def _tiny(number: str) -> bool:
    return math.fabs(float(number)) < ROUNDING


def _short(value: Any) -> str:
    text = str(value)
    return text if len(text) <= SHOWN else text[:SHOWN] + "..."
