"""The workspace of a point of a mechanism with two or three drivers: the region it reaches, and its boundary.

Sources: J. J. Craig, Introduction to Robotics, section 4.2 (reachable workspace); J.-P. Merlet, Parallel Robots,
chapter 7; C. Gosselin and J. Angeles (1990) for its singular curves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.copies import CopiesFields
from compoundkin.base.display import display_function
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.configurations.driver_range import starting_values
from compoundkin.configurations.led_point import LedPoint
from compoundkin.configurations.own_modes import ROUNDING, OwnModes, posed, signs_in, within
from compoundkin.configurations.reach import Reach
from compoundkin.configurations.reach_of_drivers import free_drivers, given_ranges, reached_by_driving
from compoundkin.configurations.reach_singularities import condition, determinants
from compoundkin.configurations.region_boundary import Lattice, boundaries, lattice_of, signed_area
from compoundkin.kinematics import Motion
from compoundkin.kinematics.solution import solving_order_of
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure

# Cells along the longer side, beside the boundary: with two drivers each takes a microsecond, with three the angle of
# the point's link is looked for at each, and groups without a closed form take milliseconds.
CELLS, CELLS_OF_THREE, CELLS_OF_NUMBERED = 320, 128, 48
FEWEST, MOST = 8, 4096
# The region is looked for within the places that driving reaches, and this part of their extent around.
AROUND = 0.06
EVERY_MODE = "all"


@dataclass(frozen=True, eq=False, repr=False)
class Workspace(CopiesFields):
    """The region of the plane that a point reaches, to the mechanism's length unit.

    `outer` and `inner` are the closed curves (complex, the last point the first) around it and around its holes. Their
    points are on the boundary to rounding, the straight lines between them within `step`. `ranges` are those of the
    drivers (absent: a full turn), `orientation` is the angle of the point's link where it is fixed, `modes` says which
    assembly modes count, `pose` is one pose of the mechanism.
    """

    point: str
    drivers: tuple[str, ...]
    ranges: Mapping[str, tuple[float, float]]
    orientation: float | None
    modes: str
    outer: tuple[Number, ...]
    inner: tuple[Number, ...]
    lattice: Lattice
    reach: Reach
    pose: Motion

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism whose point it is."""
        return self.pose.mechanism

    @property
    def link(self) -> str:
        """The link whose angle counts, the first that carries the point."""
        return self.reach.led.carrier

    @property
    def step(self) -> float:
        """The width of the cells beside the boundary. Details below it, and holes below four of it, are not seen."""
        return self.lattice.step

    @property
    def area(self) -> float:
        """The area of the region, less its holes. It is that of the polygons."""
        return sum(signed_area(curve) for curve in (*self.outer, *self.inner))

    @property
    def places(self) -> Number:
        """A square lattice of places (rows, columns), complex."""
        return self.lattice.places

    @property
    def inside(self) -> Number:
        """Which of the `places` are reached."""
        return self.lattice.inside

    @cached_property
    def condition(self) -> Number:
        """The condition number of the Jacobian to the point, at the `places`.

        Lengths are parts of the size. The least of the configurations that lead there, by a dozen angles where the
        orientation is free; NaN outside, where none of these leads, and where groups have no closed form.
        """
        found = np.full(self.inside.shape, np.nan)
        if self.reach.live is not None:
            found[self.inside] = condition(self.reach, self.lattice)
        return found

    @cached_property
    def determinants(self) -> Number:
        """The determinants of the inverse Jacobian over the `places`, (configurations, rows, columns).

        Zero where the drivers lose their hold (singular of the second kind, parallel). Of every configuration that
        leads there, NaN elsewhere; none with three drivers where the orientation is free.
        """
        return determinants(self.reach, self.lattice)

    def contains(self, points: Any) -> Number:
        """Tell which places the point reaches, complex or an array of them. Asked of the mechanism, not of the curves.

        >>> from compoundkin.files.shipped_mechanisms import load_named
        >>> workspace(load_named("five-bar"), "P").contains([59 + 158j, 300 + 0j]).tolist()
        [True, False]
        """
        z = np.asarray(points)
        if z.dtype.kind not in "iufc":
            raise InvalidInput(Problem("points", f"{points!r} are no places", "give complex numbers x + 1j * y"))
        return (self.reach.at(z.astype(complex).ravel()).margin >= -ROUNDING).reshape(z.shape)

    def plot(self, **options: Any) -> Any:
        """Draw the region with its boundary, and the mechanism in one pose. `compoundkin.plots.workspace` of it."""
        return display_function("workspace")(self, **options)

    def __repr__(self) -> str:
        holes = f", {len(self.inner)} of them holes" if self.inner else ""
        parts = len(self.outer) + len(self.inner)
        unit = f" {self.mechanism.unit}^2" if self.mechanism.unit else ""
        told = f"{self.area:.6g}{unit}, {parts} boundary curve{'s' if parts > 1 else ''}{holes}"
        return f"Workspace({self.point} by {', '.join(self.drivers)}: {told}; {self.modes})"


@checked
def workspace(
    mechanism: Mechanism | Structure,
    point: str,
    ranges: Mapping[str, Any] | None = None,
    *,
    orientation: float | None = None,
    modes: Mapping[str, int] | str | None = None,
    cells: int | None = None,
) -> Workspace:
    """Return the region that a point reaches by two or three drivers.

    `ranges` of the drivers (low, high) are radians or lengths; a driver of a pin turns fully without one, a cylinder
    goes through its stroke, a slide needs one. With three drivers the point's link may have any angle, or that of
    `orientation`. The region is that of the assembly modes that `solve` takes, or those `modes` by link, whatever the
    solution of the inverse problem; of groups without signs, and with ``modes="all"`` of all, any mode counts. `cells`
    go along the longer side of the region. Dimensions are those of the first design.

    Each place is asked of the mechanism led there: reached where all its groups close within the ranges. So the
    boundary is exact; only what is finer than a cell may be missed.

    Raises UnknownName for a point that is not there; InvalidInput for one driver, four, ranges that lack, and where the
    drivers do not follow from the place; NotAssembled where nothing is reached.

    >>> from compoundkin.model.elements import drive, link
    >>> arm = Mechanism("Arm", link("frame", A=0), link("upper", A=0, B=2), link("fore", B=0, P=1), drive("upper"),
    ...                 drive("fore", on="upper"))
    >>> found = workspace(arm, "P")
    >>> round(found.area / np.pi, 2), len(found.outer), len(found.inner)
    (8.0, 1, 1)
    """
    if orientation is not None and not np.isfinite(orientation):
        raise InvalidInput(Problem("orientation", f"{orientation} is no angle", "give radians"))
    structure = solving_order_of(mechanism).structure
    known = given_ranges(structure, ranges)
    free = free_drivers(structure, point, orientation)
    started = starting_values(solving_order_of(structure), {}, "")
    values = {name: within(value, known.get(name)) for name, value in started.items()}
    led = LedPoint.of(structure.mechanism, point, free, {name: v for name, v in values.items() if name not in free})
    pose = posed(structure, values, None if modes == EVERY_MODE else modes)
    own = OwnModes({} if modes == EVERY_MODE else signs_in(pose))
    reach = Reach(led, {name: known[name] for name in free if name in known}, own, None, orientation)
    z, angle = reached_by_driving(led, known)
    met = reach.meets(z, angle) if len(z) else np.zeros(0, dtype=bool)
    if not met.any():
        raise _nothing(reach)
    lattice = _lattice(reach := reach.occurring(z[met], angle[met]), z[met], cells)
    curves = boundaries(reach, lattice)
    outer, inner = (tuple(c for c in curves if (signed_area(c) > 0.0) == is_outer) for is_outer in (True, False))
    told = "the assembly modes of solve" if own.signs else "every assembly mode"
    return Workspace(point, free, dict(known), orientation, told, outer, inner, lattice, reach, pose)


def _lattice(reach: Reach, z: Number, cells: int | None) -> Lattice:
    """Return the lattice over the region. Raises NotAssembled where it is empty."""
    usual = CELLS_OF_NUMBERED if reach.live is None else CELLS_OF_THREE if reach.seeks_angle else CELLS
    wide = usual if cells is None else cells
    if not FEWEST <= wide <= MOST:
        raise InvalidInput(Problem("cells", f"{wide} cells are no lattice", f"give {FEWEST} to {MOST}"))
    size = reach.led.driven.size
    if reach.angle is not None:
        # of all angles the drivers reach more: the region is looked for first
        first = lattice_of(reach, _box(z, size), CELLS_OF_THREE)
        z = first.places[first.inside]
        if not len(z):
            raise _nothing(reach)
    return lattice_of(reach, _box(z, size), wide)


def _nothing(reach: Reach) -> NotAssembled:
    what = f"{reach.led.point} reaches no region: the mechanism cannot be assembled in it within the ranges"
    return NotAssembled(Problem("workspace", what, 'widen the ranges, leave orientation out, or try modes="all"'))


def _box(z: Number, size: float) -> tuple[complex, complex]:
    low, high = complex(np.min(z.real), np.min(z.imag)), complex(np.max(z.real), np.max(z.imag))
    wide = AROUND * max((high - low).real, (high - low).imag) or size
    return low - complex(wide, wide), high + complex(wide, wide)
