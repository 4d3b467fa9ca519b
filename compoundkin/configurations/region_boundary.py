"""The boundary of a region of the plane where a margin is zero: a lattice refined beside it, with exact crossings.

Source of the tracing: W. Lorensen and H. Cline, Marching cubes (1987), in the plane; opposite inside
corners of a cell are joined where the margin in its middle is positive.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number, cross

# Width of the first cells in widths of those beside the boundary.
COARSE = 4
# A lattice grows by this part of its size on the sides that the region crosses, at most so often.
GROWTH, GROWN = 0.3, 12
# A closed curve around fewer cells is dropped.
TIP = 4.0
# Offsets of the lattice from the box, in cells: special places do not lie on its lines.
OFF = (0.6180339887, 0.4142135624)


class Depths(NamedTuple):
    """How far places are inside (negative outside), with the angle of the link and the configuration."""

    margin: Number
    angle: Number
    number: Number


class Region(Protocol):
    """A region of the plane."""

    def at(self, z: Number) -> Depths:
        """Return how far places (n,) are inside, negative outside."""

    def boundary(self, inside: Number, outside: Number, angles: Number) -> Number:
        """Return the places between pairs where it ends. `angles` (2, n) are those at both."""


@dataclass(frozen=True)
class Lattice:
    """Places on a square lattice and how far they are inside a region."""

    places: Number
    margin: Number
    angle: Number
    number: Number

    @property
    def inside(self) -> Number:
        """Which places are inside."""
        return self.margin >= 0.0

    @property
    def step(self) -> float:
        """The distance of neighbours."""
        return float(self.places[0, 1].real - self.places[0, 0].real)


def lattice_of(region: Region, box: tuple[complex, complex], cells: int) -> Lattice:
    """Return the lattice over a box, grown until the region ends within it. `cells` go along its longer side."""
    low, high = box
    for _ in range(GROWN):
        found = _lattice(region, low, high, cells)
        edges = found.inside[:, 0], found.inside[:, -1], found.inside[0], found.inside[-1]
        left, right, below, above = (GROWTH * float(np.any(edge)) for edge in edges)
        if not left + right + below + above:
            break
        size = high - low
        low -= complex(left * size.real, below * size.imag)
        high += complex(right * size.real, above * size.imag)
    return found


def _lattice(region: Region, low: complex, high: complex, cells: int) -> Lattice:
    size = high - low
    step = max(size.real, size.imag) / cells
    columns, rows = (COARSE * int(np.ceil(side / step / COARSE) + 1) + 1 for side in (size.real, size.imag))
    x, y = low.real - OFF[0] * step + step * np.arange(columns), low.imag - OFF[1] * step + step * np.arange(rows)
    places = x[None] + 1j * y[:, None]
    margin, angle, number = (np.zeros(places.shape, dtype=kind) for kind in (float, float, int))
    known = np.zeros(places.shape, dtype=bool)
    wide = COARSE
    while wide:
        wanted = np.zeros(places.shape, dtype=bool)
        wanted[::wide, ::wide] = True
        if wide < COARSE:
            wanted &= _beside(margin >= 0.0, 2 * wide)
        wanted &= ~known
        found = region.at(places[wanted])
        margin[wanted], angle[wanted], number[wanted] = found
        known |= wanted
        _spread((margin, angle, number), known, wide)
        wide //= 2
    return Lattice(places, margin, angle, number)


def _beside(inside: Number, wide: int) -> Number:
    """Return whether places are in or next to coarse cells whose corners differ."""
    corners = inside[::wide, ::wide]
    cells = _corner_sum(corners)
    mixed = np.pad((cells > 0) & (cells < 4), 1)
    # the cells around a mixed one too: a boundary may leave a cell and come back
    rows, columns = mixed.shape
    around = np.zeros((rows - 2, columns - 2), dtype=bool)
    for i in range(3):
        for j in range(3):
            around |= mixed[i : i + rows - 2, j : j + columns - 2]
    out = np.zeros(inside.shape, dtype=bool)
    for i in range(wide + 1):
        for j in range(wide + 1):
            part = out[i : i + wide * around.shape[0] : wide, j : j + wide * around.shape[1] : wide]
            part |= around
    return out


def _corner_sum(inside: Number) -> Number:
    whole = inside.astype(int)
    return whole[:-1, :-1] + whole[1:, :-1] + whole[:-1, 1:] + whole[1:, 1:]


def _spread(arrays: tuple[Number, ...], known: Number, wide: int) -> None:
    """Copy the values of the coarse place below and to the left to places without values."""
    rows, columns = (np.arange(n) // wide * wide for n in known.shape)
    for array in arrays:
        coarse = array[rows][:, columns]
        array[~known] = coarse[~known]


def boundaries(region: Region, lattice: Lattice) -> list[Number]:
    """Return the closed curves that bound a region, complex. The region is on their left.

    Their points are on the lattice's lines, exactly on the boundary; the last is the first.
    """
    inside = lattice.inside
    starts: list[int] = []
    ends: list[int] = []
    for (i, j), links in _links(region, lattice).items():
        for a, b in links:
            starts.append(_edge(inside.shape, i, j, a))
            ends.append(_edge(inside.shape, i, j, b))
    if not starts:
        return []
    edges = np.unique(starts)
    points = dict(zip(edges.tolist(), _crossings(region, lattice, edges), strict=True))
    onward = dict(zip(starts, ends, strict=True))
    curves = []
    while onward:
        at = next(iter(onward))
        curve = [at]
        while at in onward:
            at = onward.pop(at)
            curve.append(at)
        curves.append(np.array([points[k] for k in curve]))
    # a curve smaller than the cells is a cut-off tip, if there is a larger one
    areas = [abs(signed_area(curve)) for curve in curves]
    return [c for c, area in zip(curves, areas, strict=True) if area > TIP * lattice.step**2 or area == max(areas)]


# The sides of a cell are counted: below, right, above, left. By which corners are inside (1 below left, 2 below right,
# 4 above right, 8 above left), from which side to which its boundary runs, the inside on its left.
BELOW, RIGHT, ABOVE, LEFT = range(4)
CELL_EDGES = {
    1: ((BELOW, LEFT),), 2: ((RIGHT, BELOW),), 3: ((RIGHT, LEFT),), 4: ((ABOVE, RIGHT),), 6: ((ABOVE, BELOW),),
    7: ((ABOVE, LEFT),), 8: ((LEFT, ABOVE),), 9: ((BELOW, ABOVE),), 11: ((RIGHT, ABOVE),), 12: ((LEFT, RIGHT),),
    13: ((BELOW, RIGHT),), 14: ((LEFT, BELOW),),
    # opposite corners: apart, or joined through the middle
    5: ((BELOW, LEFT), (ABOVE, RIGHT)), 10: ((RIGHT, BELOW), (LEFT, ABOVE)),
}  # fmt: skip
JOINED = {5: ((BELOW, RIGHT), (ABOVE, LEFT)), 10: ((RIGHT, ABOVE), (LEFT, BELOW))}


def _links(region: Region, lattice: Lattice) -> dict[tuple[int, int], tuple[tuple[int, int], ...]]:
    """Return how the boundary runs through each cell that it meets."""
    on = lattice.inside.astype(int)
    case = on[:-1, :-1] + 2 * on[:-1, 1:] + 4 * on[1:, 1:] + 8 * on[1:, :-1]
    cells = np.argwhere((case > 0) & (case < 15))
    found = {(int(i), int(j)): CELL_EDGES[int(case[i, j])] for i, j in cells}
    facing = [at for at in found if case[at] in JOINED]
    if facing:
        middles = np.array([(lattice.places[at] + lattice.places[at[0] + 1, at[1] + 1]) / 2.0 for at in facing])
        for at, margin in zip(facing, region.at(middles).margin, strict=True):
            if margin >= 0.0:
                found[at] = JOINED[int(case[at])]
    return found


def _edge(shape: tuple[int, ...], i: int, j: int, side: int) -> int:
    """Return the number of a side of a cell: of the place it begins at, twice, and one more where it goes up."""
    row, column = (i + (side == ABOVE), j + (side == RIGHT))
    return 2 * (row * shape[1] + column) + (side in (LEFT, RIGHT))


def _crossings(region: Region, lattice: Lattice, edges: Number) -> Number:
    """Return where the boundary crosses sides of cells."""
    start, up = np.divmod(edges, 2)
    stop = start + np.where(up, lattice.places.shape[1], 1)
    flat, inside, angle = (array.ravel() for array in (lattice.places, lattice.inside, lattice.angle))
    one, other = np.where(inside[start], start, stop), np.where(inside[start], stop, start)
    return region.boundary(flat[one], flat[other], angle[np.array([one, other])])


def signed_area(curve: Number) -> float:
    """Return the area on the left of a closed curve, negative of a hole.

    >>> signed_area(np.array([0, 1, 1 + 1j, 1j, 0]))
    1.0
    """
    return float(np.sum(cross(curve[:-1], curve[1:])) / 2.0)
