"""A motion as data for the scripts of a page: poses, points, drivers, instant centres, quantities, forces, plots."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arrays import Number, ascending, degrees
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.extremes.motion_between import inputs_between
from compoundkin.kinematics.extremes.stretches import stretches_of
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import (
    ANGULAR_ACCELERATION,
    ANGULAR_VELOCITY,
    OF_FORCES,
    TIME,
    coordinate_dimension,
    derivative_order,
    unit_of,
)
from compoundkin.view.page.live.live_sketch import live_sketch
from compoundkin.view.page.markup import component_values, packed_doubles, packed_floats
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.sketch.kinematic_sketch import MovingSketch, moving_sketch
from compoundkin.view.sketch.vectors import KINDS_OF_VECTOR, SHORTEST

if TYPE_CHECKING:
    from compoundkin.analysis.centres import Centres
    from compoundkin.view.page.force_data import DrawnForces

# A page holds so many poses at most, fewer where there are many links: its data shall stay well below a megabyte.
MOST_POSES, FEWEST_POSES = 721, 121
MOST_NUMBERS = 90_000
# Of a link there are so many numbers at every pose.
OF_A_LINK = 9
# Of more links than these the instant centres are left out.
MOST_LINKS = 12
# How long a motion takes to play, in seconds: one that is not in time; one in time at least and at most.
CYCLE, QUICKEST, SLOWEST = 4.0, 1.0, 30.0
# Plots that a page makes by itself go to accelerations.
ORDERS = range(3)


@dataclass(frozen=True, eq=False)
class MotionData:
    """One design of a motion with its sketch, at the poses that a page holds.

    These are at most `most`, fewer where there are many links. Raises NotAssembled where no pose is assembled,
    InvalidInput where links change their dimensions along the motion.
    """

    sample: Sample
    outputs: tuple[str, ...] = ()
    most: int = MOST_POSES
    with_centres: bool = True

    @property
    def motion(self) -> Motion:
        """The motion."""
        return self.sample.motion

    @cached_property
    def sketch(self) -> MovingSketch:
        """Its sketch."""
        return moving_sketch(self.motion, self.sample.design)

    @cached_property
    def chosen(self) -> Number:
        """The indices of the poses that the page holds: all, or as many as there is room for and the initial one."""
        links = len(self.motion.mechanism.links)
        most = min(self.most, max(FEWEST_POSES, MOST_NUMBERS // (OF_A_LINK * links)))
        places = np.linspace(0, self.sample.poses - 1, min(most, self.sample.poses)).round().astype(int)
        return ascending(places, self.sketch.pose)

    @cached_property
    def start(self) -> int:
        """The index, among the poses of the page, of the initial one."""
        return int(np.searchsorted(self.chosen, self.sketch.pose))

    def of(self, values: Any) -> Number:
        """Return this design's part of an array at the page's poses. The array has the motion's shape."""
        return np.asarray(self.sample.of(values))[self.chosen]

    @cached_property
    def closes(self) -> bool:
        """Whether the last pose equals the first one, so that the motion can be repeated."""
        return bool(self.sample.assembled.all()) and self.sample.poses > 1 and self.sketch.scene.closes

    @property
    def data(self) -> dict[str, Any]:
        """All of it for a script, in the user's length unit, radians and seconds."""
        window, mechanism = self.sketch.window, self.motion.mechanism
        column, places = self.sample.places
        return {
            "title": mechanism.title,
            "unit": unit_of(mechanism.unit, "length"),
            "poses": len(self.chosen),
            "all": self.sample.poses,
            "indices": packed_doubles(self.chosen) if len(self.chosen) > 1 else 0.0,
            "start": self.start,
            "closes": self.closes,
            "seconds": self._seconds,
            "order": self.motion.order,
            "assembled": packed_doubles(self.sample.assembled[self.chosen].astype(float)),
            "window": {
                "scale": window.scale,
                "x": window.corner.real,
                "y": window.corner.imag,
                "width": window.width,
                "height": window.height,
            },
            "along": {
                "name": column.name,
                "unit": column.unit,
                "values": packed_doubles(np.asarray(places)[self.chosen]),
            },
            "drivers": [self._quantity(driver, packed_doubles) for driver in self.sample.drivers],
            "links": [self._link(name) for name in self.links],
            "points": [self._point(letter) for letter in self.sketch.scene.letters],
            "parts": self._parts,
            **self._overlays(),
            "outputs": [self._quantity(self.sample.quantity(name), packed_floats) for name in self.outputs],
            "live": live_sketch(self.sample, self.chosen, self.links, self.outputs, self.sketch, self.drawn_forces),
        }

    @cached_property
    def drawn_forces(self) -> DrawnForces | None:
        """The forces that are drawn, None where nothing acts."""
        if not (self.with_centres and self.motion.mechanism.has_loads):
            return None
        from compoundkin.view.page.force_data import drawn_forces

        return drawn_forces(self.motion, self.sketch)

    def _overlays(self) -> dict[str, Any]:
        """Return the vectors, instant centres and forces that the sketch can show."""
        return {"vectors": dict(self._vectors()), **self._centres(), **self._forces()}

    def _forces(self) -> dict[str, Any]:
        if self.drawn_forces is None:
            return {}
        from compoundkin.view.page.force_data import force_data

        return {"forces": force_data(self.sketch, self.drawn_forces, self._numbers, self.chosen)}

    @property
    def _seconds(self) -> float:
        return CYCLE if self.slowness is None else self.slowness * float(np.ptp(self.sample.times))

    @cached_property
    def slowness(self) -> float | None:
        """How many times slower than real time a motion in time is played; None for one that is not in time."""
        times = self.sample.times
        if times is None or np.ptp(times) == 0:
            return None
        lasts = float(np.ptp(times))
        return float(np.clip(lasts, QUICKEST, SLOWEST)) / lasts

    def _quantity(self, found: Quantity, packed: Any) -> dict[str, Any]:
        floor, values = self.sample.floor(found), np.asarray(found.values)[self.chosen]
        parts = {name: packed(part) for name, part in component_values(values, floor).items()}
        switched = {"switched": True} if found.dimension in OF_FORCES else {}
        return {
            "name": found.name,
            "unit": found.unit,
            "order": found.order,
            "floor": floor,
            "parts": parts,
            **switched,
        }

    @cached_property
    def _numbers(self) -> Mapping[str, int]:
        return {name: k for k, name in enumerate(self.links)}

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The visible links."""
        thought = self.motion.mechanism.auxiliary_links
        return tuple(name for name in self.motion.mechanism.links if name not in thought)

    def _link(self, name: str) -> dict[str, Any]:
        link, scene = self.motion.links[name], self.sketch.scene
        found: dict[str, Any] = {"name": name, "number": scene.numbers[name], "group": scene.groups[name]}
        z = self.of(link.origin.position)
        found |= {
            "x": packed_doubles(z.real),
            "y": packed_doubles(z.imag),
            "angle": packed_doubles(self.of(link.angle)),
        }
        for k, (rate, turning) in enumerate((("v", ANGULAR_VELOCITY), ("a", ANGULAR_ACCELERATION)), start=1):
            if k <= self.motion.order:
                z = self.of(link.origin.derivative(k))
                found[rate] = [
                    packed_floats(z.real),
                    packed_floats(z.imag),
                    packed_floats(self.of(getattr(link, turning))),
                ]
        return found

    def _point(self, letter: str) -> dict[str, Any]:
        link = self.motion.mechanism.carriers[letter][0]
        at = self.sketch.scene.points[link][letter]
        return {"name": letter, "link": self._numbers[link], "x": at.real, "y": at.imag}

    @property
    def _parts(self) -> list[list[float]]:
        """Of every part of the sketch: its link, the point that it is seen from, and whether it turns."""
        return [[self._numbers[p.link], p.at.real, p.at.imag, int(p.turns)] for p in self.sketch.parts]

    def _vectors(self) -> Iterator[tuple[str, Any]]:
        """Yield for each kind of vectors its scale, picture units for a unit of theirs, and its text."""
        for kind, (order, _) in KINDS_OF_VECTOR.items():
            scale = self.sketch.scale(kind) if order <= self.motion.order else None
            if scale is not None:
                yield kind, {"scale": scale.per_unit, "text": scale.text, "length": scale.amount * scale.per_unit,
                             "shortest": SHORTEST}  # fmt: skip

    def _centres(self) -> dict[str, Any]:
        """Return the instant centres in homogeneous coordinates, and the centres that determine each secondary one."""
        mechanism = self.motion.mechanism
        if not self.with_centres or len(mechanism.links) > MOST_LINKS or not mechanism.drives:
            return {"centres": [], "lines": []}
        from compoundkin.analysis.centres import instant_centres  # a page of many links has none

        centres = instant_centres(self.motion)
        couples = list(centres)
        found = [self._centre(centres, couple) for couple in couples]
        index = {tuple(sorted(couple)): k for k, couple in enumerate(couples)}
        return {"centres": found, "lines": list(_lines(centres, index))}

    def _centre(self, centres: Centres, couple: tuple[str, str]) -> dict[str, Any]:
        centre, size = centres[couple], self.motion.size
        shape = self.motion.shape
        xyw = [np.where(centre.found, centre.homogeneous[..., k], np.nan).reshape(shape) for k in range(3)]
        # (x, y, w) may be of any length: that of (x, y) in the mechanism's size, and w, together one
        length = np.sqrt((xyw[0] / size) ** 2 + (xyw[1] / size) ** 2 + xyw[2] ** 2)
        with np.errstate(invalid="ignore"):
            packed = [packed_floats(self.of(np.where(centre.at_infinity, 0.0, c) if k == 2 else c) / self.of(length))
                      for k, c in enumerate(xyw)]  # fmt: skip
        from compoundkin.view.sketch.centre_pictures import centre_number  # the same

        name = centre_number(self.sketch.scene, *couple)
        return {"name": name, "links": list(couple), "at": packed}


def _lines(centres: Centres, index: Mapping[tuple[str, ...], int]) -> Iterator[list[int]]:
    """For each line that gives a centre: the centre, and those known ones that it goes through."""
    names = {f"({a} {b})": index[tuple(sorted((a, b)))] for one, two in centres for a, b in ((one, two), (two, one))}
    for step in centres.derivation():
        for line in step.lines if step.kind != "primary" else ():
            known = [names[text] for text in line if text in names]
            if known:
                yield [index[tuple(sorted(step.centre))], *known]


def plot_data(moving: MotionData) -> dict[str, Any]:
    """Return the pace of the plots' axis, the jumps, and the bounds of rounding.

    The pace is at the page's poses, rounding of lengths and angles by the orders of their rates. A jump has its place,
    counted in the page's poses, whether it begins a smooth stretch, and the values of outputs and drivers.
    """
    return {"rate": _pace(moving), "jumps": _jumps(moving), "rounding": _rounding(moving)}


def _pace(moving: MotionData) -> Any:
    """Return the rate of what plots run along, by the second. None where there is none."""
    sample, motion = moving.sample, moving.motion
    name = sample.places[0].name
    if name == TIME:
        return 1.0
    if name not in motion.drives or not motion.order:
        return None
    rates, seconds = (sample.of(motion.inputs.drives[name][order])[moving.chosen] for order in (1, 2))
    # poses of one speed that all accelerate are no motion along the axis: rates do not change by their own rates there
    if np.any(seconds) and np.ptp(rates) == 0:
        return None
    return packed_doubles(degrees(rates) if motion.drives[name].is_angle else rates) if np.all(rates) else None


def _jumps(moving: MotionData) -> list[dict[str, Any]]:
    motion, design = moving.motion, moving.sample.design
    if motion.inputs.poses < 2:
        return []
    s = stretches_of(motion)
    mine = s.design == design
    begins, ends = (mine & (at < 0) & ~s.limits[:, k] for k, at in enumerate((s.first, s.last)))
    places = np.concatenate([s.low[begins], s.high[ends]])
    if not len(places):
        return []
    known = {name: _values_at(moving, name, places) for name in moving.outputs}
    parts = [{name: _finite_values(of, k) for name, of in known.items()} for k in range(len(places))]
    drives = _drives_at(moving, places)
    on_page = np.interp(places, moving.chosen, np.arange(len(moving.chosen)))
    return [
        {"place": float(place), "begins": bool(k < np.count_nonzero(begins)), "values": parts[k], "drives": drives[k]}
        for k, place in enumerate(on_page)
    ]


def _values_at(moving: MotionData, name: str, places: Number) -> dict[str, Number]:
    """Return the parts of an output at places of the motion."""
    with np.errstate(all="ignore"):
        there = between(moving.motion, moving.sample.design, places, max(moving.motion.order, derivative_order(name)))
        found = quantity(there, name).shown
    return component_values(np.ravel(found.values), moving.sample.floor(moving.sample.quantity(name)))


def _drives_at(moving: MotionData, places: Number) -> list[list[list[float]]]:
    """Return value, rate and second of each driver at places of the motion."""
    designs = np.full(len(places), moving.sample.design)
    found = inputs_between(moving.motion, designs, places, max(ORDERS)).drives.values()
    rows = [[np.broadcast_to(np.ravel(v), len(places)).tolist() for v in values[: len(ORDERS)]] for values in found]
    return [[[values[k] for values in row] for row in rows] for k in range(len(places))]


def _finite_values(parts: dict[str, Number], k: int) -> dict[str, float | None]:
    return {name: float(values[k]) if np.isfinite(values[k]) else None for name, values in parts.items()}


def _rounding(moving: MotionData) -> dict[str, list[float]]:
    """Return for lengths and angles, by the order of their rates, the bounds below which they are rounding."""
    kinds = [coordinate_dimension(is_angle) for is_angle in (False, True)]
    return {kind: [moving.sample.floor(Quantity("", "", np.zeros(1), k, kind)) for k in ORDERS] for kind in kinds}
