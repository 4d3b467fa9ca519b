"""The suite's own equations of every kind of pair, with the Jacobian by complex steps. Written from docs/pairs.md.

The unknowns are x, y, theta of every moving link, and one parameter of the profile for each contact on an oval; lengths
are divided by a power of two near the mechanism's size. `Equations.residual(x)` takes any leading axes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tests.stress.sketch import FRAME, Driver, Joint, Placed

# A step so small that its square is nothing: the derivative is exact to rounding (W. Squire and G. Trapp, 1998).
STEP = 1e-30
# The step in the direction of motion for second derivatives, of scaled unknowns: its square is nearly the rounding.
SECOND = 1e-5

Array = Any


def _at(v: Sequence[Array], p: Array) -> tuple[Array, Array]:
    """Where a point of a link is."""
    c, s = np.cos(v[2]), np.sin(v[2])
    return v[0] + c * p[0] - s * p[1], v[1] + s * p[0] + c * p[1]


def _pin(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    (x1, y1), (x2, y2) = _at(v[:3], n[0:2]), _at(v[3:6], n[2:4])
    return x2 - x1, y2 - y1


def _gaps(v: Sequence[Array], n: Array) -> tuple[Array, Array]:
    """How far the second link's point is along and to the left of the first one's line."""
    (x1, y1), (x2, y2) = _at(v[:3], n[0:2]), _at(v[3:6], n[2:4])
    c, s = np.cos(v[2] + n[4]), np.sin(v[2] + n[4])
    return c * (x2 - x1) + s * (y2 - y1), c * (y2 - y1) - s * (x2 - x1)


def away_from_line(v: Sequence[Array], n: Array) -> Array:
    """How far the second link's point is to the left of the first one's line."""
    return _gaps(v, n)[1]


def _slide(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    return _gaps(v, n)[1] - n[5], np.sin(v[5] - v[2] - n[4] - n[6])


def _slot(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    return (_gaps(v, n)[1] - n[5],)


def _arc(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    x, y = _pin(v, n)
    return ((x * x + y * y - n[4] * n[4]) / (2.0 * n[4]),)


def _rack(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    return (_gaps(v, n)[0] + n[5] * (v[5] - v[2]) - n[6],)


def _roll(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    along, away = _gaps(v, n)
    return away - n[5], along + n[5] * (v[5] - v[2]) - n[6]


def _around(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    x, y = _pin(v, n)
    direction = v[2] + (v[5] - v[2] - n[5]) / n[6]
    return x - n[4] * np.cos(direction), y - n[4] * np.sin(direction)


def _wheels(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    return (v[5] - v[8] + n[0] * (v[2] - v[8]) - n[1],)


def _oval(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    """Point, normal (not of unit length) of an oval in the world; numbers: middle, half axes, tilt."""
    c, s = np.cos(v[6]), np.sin(v[6])
    ct, st = np.cos(n[4]), np.sin(n[4])
    px, py, nx, ny = n[2] * c, n[3] * s, n[3] * c, n[2] * s
    x, y = _at(v[:3], (n[0] + ct * px - st * py, n[1] + st * px + ct * py))
    cw, sw = np.cos(v[2] + n[4]), np.sin(v[2] + n[4])
    return x, y, cw * nx - sw * ny, sw * nx + cw * ny


def _cam(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    x, y, nx, ny = _oval(v, n)
    px, py = _at(v[3:6], n[5:7])
    away = n[7] / np.sqrt(nx * nx + ny * ny)
    return px - x - away * nx, py - y - away * ny


def _face(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    x, y, nx, ny = _oval(v, n)
    px, py = _at(v[3:6], n[5:7])
    c, s = np.cos(v[5] + n[7]), np.sin(v[5] + n[7])
    # the profile lies across the face, whose direction is at right angles to the profile's normal
    return c * (y - py) - s * (x - px), (c * nx + s * ny) / n[8]


def _turned(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    return (n[0] * (v[5] - v[2]) - n[1],)


def _moved(v: Sequence[Array], n: Array) -> tuple[Array, ...]:
    return (_gaps(v, n)[0],)


# Residuals, how many there are, how many unknowns they have.
KINDS: dict[str, tuple[Callable[[Sequence[Array], Array], tuple[Array, ...]], int, int]] = {
    "R": (_pin, 2, 6),
    "P": (_slide, 2, 6),
    "S": (_slot, 1, 6),
    "A": (_arc, 1, 6),
    "K": (_rack, 1, 6),
    "L": (_roll, 2, 6),
    "O": (_around, 2, 6),
    "G": (_wheels, 1, 9),
    "C": (_cam, 2, 7),
    "F": (_face, 2, 7),
    "turned": (_turned, 1, 6),
    "moved": (_moved, 1, 6),
}


class Equations:
    """All equations of a placed sketch; the last rows are the drivers', which prescribe `value + rate * s`."""

    def __init__(self, placed: Placed) -> None:
        self.links = [link for link in placed.sketch.letters if link != FRAME]
        self.index = {link: k for k, link in enumerate(self.links)}
        self.unit = 2.0 ** round(np.log2(max(placed.sketch.size, 1e-300)))
        self.contacts = [j for j in placed.sketch.joints if j.kind in "CF"]
        self.unknowns = 3 * len(self.links) + len(self.contacts)
        self._rows, parts = 0, _Parts(self, placed)
        for kind, pair in parts.all():
            parts.take(kind, *pair)
        self.count = self._rows
        for driver in placed.sketch.drivers:
            parts.drive(driver)
        self.parts = parts.arrays()
        # rows of pairs that count full turns
        self.turning = sorted({row for _, _, rows in parts.of("KLOG") for row in rows})
        self.parts_of = parts.of
        self.size = self._rows
        self.drawn = self._state(placed)
        self.values = self.residual(self.drawn)[self.count :]
        self.lengths = np.array([d.kind in "PL" for d in placed.sketch.drivers])

    def rows(self, count: int) -> list[int]:
        self._rows += count
        return list(range(self._rows - count, self._rows))

    def columns(self, links: Sequence[str]) -> list[int]:
        """Where the unknowns of links are; the frame's are beyond all others, and zero."""
        starts = [3 * self.index[k] if k != FRAME else self.unknowns for k in links]
        return [start + k for start in starts for k in range(3)]

    def _state(self, placed: Placed) -> Array:
        x = np.zeros(self.unknowns)
        for link, k in self.index.items():
            z, angle = placed.poses[link]
            x[3 * k : 3 * k + 3] = z.real / self.unit, z.imag / self.unit, angle
        for k, joint in enumerate(self.contacts):
            x[3 * len(self.links) + k] = placed.joints[joint.name]["s"]
        return x

    def residual(self, x: Array) -> Array:
        """Return all residuals, with drivers' coordinates as they are: (..., size)."""
        full = np.concatenate((x, np.zeros((*x.shape[:-1], 3))), axis=-1)
        out = np.empty((*x.shape[:-1], self.size), dtype=x.dtype)
        for residuals, numbers, columns, rows in self.parts:
            v = full[..., columns]
            found = residuals([v[..., k] for k in range(v.shape[-1])], numbers)
            for k, part in enumerate(found):
                out[..., rows[:, k]] = part
        return out

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives of the residuals by the unknowns: (..., size, unknowns)."""
        full = np.concatenate((x, np.zeros((*x.shape[:-1], 3))), axis=-1)
        out = np.zeros((*x.shape[:-1], self.size, self.unknowns + 3))
        for residuals, numbers, columns, rows in self.parts:
            v = full[..., None, columns] + 1j * STEP * np.eye(columns.shape[1])[:, None, :]
            found = residuals([v[..., k] for k in range(v.shape[-1])], numbers)
            for k, part in enumerate(found):
                # part is (..., unknown, pair)
                out[..., rows[:, k][:, None], columns] = np.swapaxes(part.imag, -1, -2) / STEP
        return out[..., : self.unknowns]

    def bent(self, x: Array, v: Array) -> Array:
        """Return the second derivative of the residuals in a direction: (..., size)."""
        scale = np.maximum(np.max(np.abs(v), axis=-1, keepdims=True), 1e-300)
        w = v / scale
        ahead, behind = (self.residual(x + h * w + 1j * STEP * w).imag / STEP for h in (SECOND, -SECOND))
        return (ahead - behind) / (2.0 * SECOND) * scale**2

    def scaled(self, values: Array) -> Array:
        """Return drivers' values with lengths in the unit of the equations."""
        return np.where(self.lengths, values / self.unit, values)


class _Parts:
    """Pairs of one kind together: their numbers, columns and rows."""

    def __init__(self, equations: Equations, placed: Placed) -> None:
        self.equations, self.placed, self.unit = equations, placed, equations.unit
        self.found: dict[str, list[tuple[list[float], list[int], list[int]]]] = {}

    def all(self) -> list[tuple[str, Any]]:
        sketch = self.placed.sketch
        pins = [(letter, links[0], other) for letter, links in sketch.pins().items() for other in links[1:]]
        return [("R", pin) for pin in pins] + [(j.kind, (j,)) for j in sketch.joints]

    def take(self, kind: str, *pair: Any) -> None:
        if kind == "R":
            letter, first, second = pair
            links, numbers = [first, second], [*self._two(first, letter), *self._two(second, letter)]
        else:
            links, numbers = list(pair[0].links), self._numbers(pair[0])
        kind = "G" if kind == "B" else kind
        columns = self.equations.columns(links)
        if kind in "CF":
            columns = [*columns, 3 * len(self.equations.links) + self.equations.contacts.index(pair[0])]
        self._put(kind, numbers, columns)

    def drive(self, driver: Driver) -> None:
        if driver.kind == "R":
            columns = self.equations.columns((driver.on, driver.link))
            self._put("turned", [1.0, 0.0], columns)
            return
        joint = next(j for j in self.placed.sketch.joints if j.name == driver.pair)
        n, columns = self.placed.joints[joint.name], self.equations.columns(joint.links)
        if driver.kind == "O":
            self._put("turned", [driver.sign / n["turns"], driver.sign * n["phase"] / n["turns"]], columns)
        else:
            self._put("moved", self._line(n), columns)

    def _put(self, kind: str, numbers: list[float], columns: list[int]) -> None:
        self.found.setdefault(kind, []).append((numbers, columns, self.equations.rows(KINDS[kind][1])))

    def _two(self, link: str, letter: str) -> tuple[float, float]:
        return self._xy(self.placed.points[link][letter])

    def _xy(self, p: complex) -> tuple[float, float]:
        return p.real / self.unit, p.imag / self.unit

    def _line(self, n: dict[str, Any]) -> list[float]:
        return [*self._xy(n["start"]), *self._xy(n["point"]), n["angle"]]

    def _numbers(self, joint: Joint) -> list[float]:
        n, unit = self.placed.joints[joint.name], self.unit
        if joint.kind in "PS":
            return [*self._line(n), n["offset"] / unit, n.get("turn", 0.0)]
        if joint.kind in "KL":
            return [*self._line(n), n["side"] * n["radius"] / unit, n["phase"] / unit]
        if joint.kind in "GB":
            return [n["ratio"], n["phase"]]
        if joint.kind in "AO":
            ends = [*self._xy(n["centre"]), *self._xy(n["point"])]
            return [
                *ends,
                *([n["radius"] / unit] if joint.kind == "A" else [n["distance"] / unit, n["phase"], n["turns"]]),
            ]
        oval = n["oval"]
        shape = [*self._xy(oval.middle), oval.a / unit, oval.b / unit, oval.tilt]
        last = n["away"] / unit if joint.kind == "C" else n["angle"]
        return [*shape, *self._xy(n["point"]), last, max(oval.a, oval.b) / unit]

    def of(self, kinds: str) -> list[tuple[list[float], list[int], list[int]]]:
        return [part for kind in kinds for part in self.found.get(kind, [])]

    def arrays(self) -> list[tuple[Any, ...]]:
        found = []
        for kind, parts in self.found.items():
            numbers = np.array([p[0] for p in parts]).T
            found.append((KINDS[kind][0], numbers, np.array([p[1] for p in parts]), np.array([p[2] for p in parts])))
        return found
