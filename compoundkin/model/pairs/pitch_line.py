"""Racks and wheels on a straight line: no slip between a wheel and a line of another link."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import TURN, Number, cross, whole_turns
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import DimensionFit, DrawnPair, Ends, Point, Poses, StraightLine, TurnCounting
from compoundkin.model.pairs.geared import FITS
from compoundkin.model.pairs.symbols import Mark, Track, Wheel, known_range

Row = tuple[Number, ...]


class PitchLinePair(StraightLine, TurnCounting):
    """A wheel that rolls along a straight line of another link, which comes first."""

    free: ClassVar[tuple[str, ...]] = ("displacement",)
    free_is_angle: ClassVar[bool] = False

    side: int
    phase: Number | None

    @property
    @abstractmethod
    def size(self) -> Number:
        """The radius of the wheel."""

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, a line without direction, a wrong side."""
        yield from super().problems(links, where)
        if self.side not in (1, -1):
            what = f"{self.side!r} is not a side of the line"
            yield Problem(f"{where}.side", what, "write 1 for the left of its direction, -1 for the right")

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find two coincident points of the line."""
        return self.line_problems(geometry, where)

    def fits(self, geometry: Geometry) -> tuple[DimensionFit, ...]:
        """Return the radius, which fits a drawing with all dimensions."""
        seen = self._drawn_axis(geometry)
        if seen is None or not all(name in geometry.as_drawn or name == "frame" for name in geometry.points):
            return ()
        away = self.side * (np.conjugate(seen[1]) * seen[0]).imag
        room = FITS * np.abs(self.size) - np.abs(away - self.size)
        words = ("the radius is ", self.size, f", but {self.at} is drawn ", away, " from the line")
        remedy = "change the radius or move the axis"
        return (
            DimensionFit("radius", room, words, remedy + ("; or is it on the other side?" if np.any(away < 0) else "")),
        )

    def ends(self, geometry: Geometry) -> Ends:
        """Return the line with the phase; the axis with the radius.

        The line is a point and a direction; the radius is negative to the right.
        """
        start, along = self.line(geometry)
        across = self.side * self.size
        axis = geometry.points[self.members[1]][self.at]
        return End(start, along, self._phase(geometry, across)), End(axis, None, across)

    def _drawn_axis(self, geometry: Geometry) -> tuple[Number, Number] | None:
        """Return the vector from the line's point to the axis, and the line's direction, in the drawing, or None."""
        line, wheel = self.members
        if line not in geometry.drawn:
            return None
        if wheel in geometry.drawn:
            axis = geometry.drawn[wheel].at(geometry.points[wheel][self.at]).c[0]
        elif self.at in geometry.sketch:
            axis = geometry.sketch[self.at]
        else:
            return None
        start, along = self.line(geometry)
        return axis - geometry.drawn[line].at(start).c[0], geometry.drawn[line].u.c[0] * along

    def _phase(self, geometry: Geometry, across: Number) -> Number:
        """Return the phase of the drawing, a stated one moved within half a turn of it, or zero."""
        seen = self._drawn_axis(geometry)
        if seen is None or self.members[1] not in geometry.drawn:
            return 0.0 if self.phase is None else self.phase
        line, wheel = (geometry.drawn[name].angle.c[0] for name in self.members)
        drawn = (np.conjugate(seen[1]) * seen[0]).real + across * (wheel - line)
        if self.phase is None:
            return drawn
        # a phase by a turn of the wheel farther on is the same mechanism, its angle counted from another turn
        return self.phase + whole_turns(drawn - self.phase, TURN * across)

    def drawn_angle(self, seen: DrawnPair, own: int) -> Number | None:
        """Return the angle to which the wheel has rolled at its drawn axis; the line's does not follow."""
        ends, line, at = seen.ends, seen.poses[0], seen.sketch.get(self.at)
        if own == 0 or line is None or at is None:
            return None
        along = line.u.c[0] * ends[0].direction
        displacement = (np.conjugate(along) * (at - line.at(ends[0].point).c[0])).real
        return line.angle.c[0] + (ends[0].measure - displacement) / ends[1].measure

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """Return the ends with a drawn phase advanced by whole turns of line and wheel."""
        if any(name not in geometry.drawn for name in self.members):
            return ends
        line, wheel = ends
        return line._replace(measure=line.measure + wheel.measure * TURN * (turns[1] - turns[0])), wheel

    def slip(self, ends: Ends, poses: Poses) -> Series:
        """Return the slip: the displacement of the axis beyond the rolled length, zero without slip."""
        turned = poses[1].angle - poses[0].angle
        slip: Series = self.coordinate(ends, poses) + turned * ends[1].measure - ends[0].measure
        return slip

    def distance(self, ends: Ends, poses: Poses) -> Series:
        """Return the distance of the axis from the line less the radius."""
        line, axis = poses[0].carry(ends[0]), poses[1].at(ends[1].point)
        farther: Series = line.along.cross(axis - line.point) - ends[1].measure
        return farther

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the displacement of the axis along the line."""
        line, axis = poses[0].carry(ends[0]), poses[1].at(ends[1].point)
        return line.along.dot(axis - line.point)

    def rows(self, ends: Ends, poses: Poses) -> tuple[Row, Row, Row]:
        """Return the derivatives of distance, slip and displacement."""
        e = poses[0].carry(ends[0]).along.c[0]
        away = poses[1].at(ends[1].point).c[0] - poses[0].z.c[0]
        arm = poses[1].at(ends[1].point).c[0] - poses[1].z.c[0]
        along = (-e.real, -e.imag, -cross(away, e), e.real, e.imag, cross(arm, e))
        across = (e.imag, -e.real, -cross(away, 1j * e), -e.imag, e.real, cross(arm, 1j * e))
        m = ends[1].measure
        return across, (*along[:2], along[2] - m, *along[3:5], along[5] + m), along

    def pitch_point(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return where the wheel touches the line, and the line's direction."""
        e = poses[0].carry(ends[0]).along.c[0]
        return poses[1].at(ends[1].point).c[0] - 1j * e * ends[1].measure, e

    def centre(self, ends: Ends, poses: Poses) -> Point:
        """Return the pitch point, where the wheel touches the line."""
        m, (place, _) = ends[1].measure, self.pitch_point(ends, poses)
        return Point(-place.real / m, -place.imag / m, -1.0 / m)

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw a line in a random direction with a wheel somewhere on it."""
        angle = rng.uniform(0.0, TURN)
        along = complex(np.cos(angle), np.sin(angle))
        start, travel = complex(*rng.standard_normal(2)), rng.standard_normal()
        across = self.side * rng.uniform(0.5, 2.0)
        return End(start, along, travel), End(start + along * (travel + 1j * across), None, across)

    def pitch(self, radius: Number) -> Number:
        """Return the distance of teeth for a wheel of a radius. It is 0 where there are none."""
        return 0.0

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the part of the line on which the wheel rolls, and the wheel."""
        line, wheel = ends
        low, high = known_range(self.coordinate(ends, poses).c[0])
        radius = abs(wheel.measure)
        pitch = self.pitch(radius)
        track = Track(0, line.point, line.along.c[0], low, high, float(self.side), pitch)
        teeth = round(float(2.0 * np.pi * radius / pitch)) if pitch else 0
        return track, Wheel(1, wheel.point, radius, teeth)
