"""The pin in a circular slot: a point of one link keeps its distance from a point of another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.model.fields import constructor, link_key, point_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import FrictionContact, Touch, passing_rates
from compoundkin.model.pairs.contract import Ends, Equivalent, Guided, Osculation, Poses
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.symbols import Groove, Mark, Stud, arc_line, known_range
from compoundkin.model.pairs.travel_limits import Reach, TravelLimitedArc, reach_key


@dataclass(frozen=True, eq=False)
class ArcSlot(FrictionContact, Guided, TravelLimitedArc):
    """A point of `link` that runs along a circular slot in the link `on`.

    The point is `at`, the circle of `radius` about `centre_at`.

    A roller on a round disc is the same with the sum of both radii. Held: the distance of the pin from the circle.
    Free: the angle at which the pin is seen from the centre, from the x axis of `on`, and the angle between the links.

    >>> arc("rocker", on="frame", at="B", centre_at="C", radius=40).letters
    ('B', 'C')
    """

    link: str = field(metadata=link_key("The link with the pin."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link with the circular slot."))
    at: str = field(
        default="", metadata=point_key("link", "The pin's point; may be left out if its link has one point.")
    )
    centre_at: str = field(metadata=point_key("on", "The point of the slotted link about which the slot is curved."))
    radius: Number = field(metadata=value_key("length", "Radius of the circle on which the middle of the pin runs."))
    reach: Reach = field(default=None, metadata=reach_key("sweep", "From where counterclockwise to where it is cut."))

    code: ClassVar[str] = "A"
    title: ClassVar[str] = "pin-in-arc pair"
    free: ClassVar[tuple[str, ...]] = ("direction", "angle")
    free_is_angle: ClassVar[bool] = True
    table: ClassVar[str] = "arcs"
    takes: ClassVar[tuple[str, ...]] = ("effort", "friction")

    @property
    def letters(self) -> tuple[str, ...]:
        """The pin and the centre of its circle."""
        return self.at, self.centre_at

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, and an invalid radius."""
        yield from super().problems(links, where)
        if not np.all(np.asarray(self.radius) > 0):
            yield Problem(f"{where}.radius", f"{self.radius!r} is not a positive length")
        yield from self.reach_problems(links, where)

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find travel limits that leave the arc no length."""
        yield from self.reach_misfits(geometry, where)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the centre with the radius; the pin."""
        centre = geometry.points[self.on][self.centre_at]
        return End(centre, 1 + 0j, self.radius), End(geometry.points[self.link][self.at])

    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """Return the contact at the pin, in the direction from the centre."""
        pin = poses[1].at(ends[1].point)
        arm = pin - poses[0].at(ends[0].point)
        length = arm.abs2().sqrt()
        return Touch(pin, arm / length, length - ends[0].measure)

    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """Return the row of the pin along the circle. It goes by the pin's distance from the centre."""
        pin = poses[1].at(ends[1].point).c[0]
        arm = pin - poses[0].at(ends[0].point).c[0]
        return passing_rates(poses, pin, 1j * arm / np.abs(arm) ** 2)

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the direction from the centre to the pin."""
        arm = poses[1].at(ends[1].point) - poses[0].at(ends[0].point)
        return (arm.unit() * poses[0].carry(ends[0]).along.conj()).angle()

    def equivalent(self, ends: Ends) -> Equivalent:
        """Return a bar from the centre to the pin."""
        bar = f"{self.name} (bar)"
        pairs = (
            Revolute(f"{self.name} (centre)", self.centre_at, self.on, bar),
            Revolute(f"{self.name} (pin)", self.at, bar, self.link),
        )
        far = End(ends[0].measure + 0j)
        return Equivalent(bar, pairs, {pairs[0].name: (End(ends[0].point), End(0j)), pairs[1].name: (far, ends[1])})

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """Return the middle of the circle, and the pin."""
        centre, pin = (pose.at(end.point).c[0] for pose, end in zip(poses, ends, strict=True))
        return Osculation(centre, pin, (pin - centre) / np.abs(pin - centre))

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw a random circle with the pin somewhere on it."""
        centre, arm = complex(*rng.standard_normal(2)), complex(*rng.standard_normal(2))
        return End(centre, 1 + 0j, abs(arm)), End(centre + arm)

    def round_at(self, link: str) -> str | None:
        """Return the pin, or the middle of the slot. The pin may turn in the slot, and the slot about its centre."""
        return self.at if link == self.link else self.centre_at

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return a groove as long as the pin's way, and the pin."""
        way = known_range(np.unwrap(np.ravel(self.coordinate(ends, poses).c[0])))
        return Groove(0, arc_line(ends[0].point, ends[0].measure, *way)), Stud(1, ends[1].point)

    def with_ends(
        self, marks: tuple[Mark, ...], bounds: tuple[Number, Number], ends: Ends, poses: Poses
    ) -> tuple[Mark, ...]:
        """Return the whole groove, and the pin."""
        low, high = (float(bound) for bound in bounds)
        return (Groove(0, arc_line(ends[0].point, ends[0].measure, low, high), (True, True)), *marks[1:])


arc = constructor("arc", ArcSlot)
