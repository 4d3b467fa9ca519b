"""From what a file of pylinkage says to a drawing."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from itertools import combinations

from compoundkin.base.display import count_phrase
from compoundkin.files.exchange.drawings.drawn_elements import (
    Drawing,
    DrawnDriver,
    DrawnGuideway,
    DrawnLink,
    DrawnPoint,
)
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.pylinkage.pylinkage_records import PylinkageFile, PylinkageJoint, PylinkageLink
from compoundkin.files.exchange.pylinkage.rigid_bodies import RigidBodies
from compoundkin.model.geometry import FRAME

# Directions nearer than this are parallel, angles nearer are the same: a rounding of a few digits' arithmetic.
_ROUNDING = 1e-9


def pylinkage_drawing(file: PylinkageFile, problems: Problems, title: str) -> Drawing:
    """Return the drawing of a file. Raises InvalidInput with all that cannot be meant."""
    places = JointPlaces(file, problems)
    problems.raise_if_any()
    found = _Elements(file, places, problems)
    points, guides, drivers = tuple(found.points()), tuple(found.guides()), tuple(found.drivers())
    problems.raise_if_any()
    return Drawing(
        file.title or title,
        tuple(DrawnLink(body, *_called(body, parts)) for body, parts in found.bodies.parts.items()),
        points,
        guides,
        drivers=drivers,
        notes=(*_joined(found.bodies), *found.notes),
        dropped=(*file.unknown, ("joint of no link", len(file.joints) - len(points))),
    )


class JointPlaces:
    """Where joints are, which are the frame's, and which others tell.

    `told` has these in an order that finds them.
    """

    def __init__(self, file: PylinkageFile, problems: Problems) -> None:
        self._file, self._problems = file, problems
        self.fixed = dict.fromkeys(self._fixed())
        self.told: dict[str, PylinkageJoint] = {}
        joints = file.joints.values()
        waiting = {joint.key: joint for joint in joints if joint.is_told and joint.key not in self.fixed}
        self.of = {joint.key: joint.at for joint in joints if joint.key not in waiting}
        while ready := [joint for joint in waiting.values() if all(key in self.of for key in joint.references)]:
            for joint in ready:
                self.told[joint.key] = waiting.pop(joint.key)
                self.of[joint.key] = self._told_place(joint)
        for joint in waiting.values():
            problems.add(joint.where, "its reference joints follow from it, or are not there")

    def _fixed(self) -> Iterator[str]:
        """Yield the joints that are on the frame: their loader pins those, whatever their type."""
        links, joints = self._file.links.values(), self._file.joints.values()
        if "ground" not in {*(link.kind for link in links), *(joint.kind for joint in joints)}:
            self._problems.add("", "there is no ground", "give a link of type ground with the joints of the frame")
        yield from (joint.key for joint in joints if joint.kind == "ground")
        yield from (joint.key for joint in joints if joint.kind == "tracker" and not joint.is_told)
        yield from (key for link in links if link.kind == "ground" for key in link.joints)
        yield from (link.motor for link in links if link.is_driver)

    def _told_place(self, joint: PylinkageJoint) -> complex:
        first, second = (self.of[key] for key in joint.references)
        if first == second:
            self._problems.add(joint.where, "its reference joints are at one place, and give no direction")
        return first + cmath.rect(joint.polar[0], cmath.phase(second - first) + joint.polar[1])


class _Elements:
    """The elements of a drawing, made of those of a file."""

    def __init__(self, file: PylinkageFile, places: JointPlaces, problems: Problems) -> None:
        self.file, self.places, self.problems = file, places, problems
        self.notes: list[str] = []
        self.bodies = RigidBodies(file.links, places.fixed, places.of)
        self.at = {key: self.bodies.at(key) for key in file.joints}
        for joint in places.told.values():
            self._add_tracker(joint)
        away = {joint.name: abs(places.of[joint.key] - joint.at) for joint in places.told.values()}
        off = [f"{name} ({gap:.4g} away)" for name, gap in away.items() if gap > self.bodies.near]
        if off:
            self.notes.append(
                f"taken where distance and angle tell, as pylinkage does, not where drawn: {', '.join(off)}"
            )

    def _add_tracker(self, joint: PylinkageJoint) -> None:
        """Note the body of a tracker: the one that has both its reference joints."""
        first, second = joint.references
        both = [body for body in self.at[first] if body in self.at[second]]
        if not both:
            what = f"its reference joints {first!r} and {second!r} share no link"
            self.problems.add(joint.where, what, "a tracker is a point of the link that has both")
        self.at[joint.key] = tuple(dict.fromkeys((*self.at[joint.key], *both[:1])))

    def points(self) -> Iterator[DrawnPoint]:
        """Yield the joints as points; those of no link are left out.

        Those of drivers come first, so that a driver's value is the angle that it has in pylinkage.
        """
        driven = [link for link in self.file.links.values() if link.is_driver]
        first = [link.motor for link in driven] + [key for link in driven for key in link.joints]
        for joint in (self.file.joints[key] for key in dict.fromkeys((*first, *self.file.joints))):
            if self.at[joint.key]:
                place = self.places.of[joint.key]
                yield DrawnPoint(joint.key, place, self.at[joint.key], joint.name, joint.where)

    def guides(self) -> Iterator[DrawnGuideway]:
        """Yield the slots of the frame; a link with two of one direction slides."""
        left = {key: one for key, one in self.file.joints.items() if one.kind == "prismatic" and self.at[key]}
        off = [f"{joint.name} ({gap:.4g})" for joint in left.values() if (gap := self._off(joint))]
        if off:
            self.notes.append(f"drawn beside the lines on which pylinkage puts them: {', '.join(off)}")
        for joint in [joint for joint in left.values() if FRAME in self.at[joint.key]]:
            self.notes.append(f"{joint.name} is a joint of the ground, which makes it a pin")
            del left[joint.key]
        for body in self.bodies.parts:
            own = [joint for joint in left.values() if body in self.at[joint.key]]
            first = next((pair[0] for pair in combinations(own, 2) if self._slide(*pair)), None)
            if first is not None:
                alike = [joint for joint in own if joint is first or self._slide(first, joint)]
                names = " and ".join(joint.name for joint in alike)
                self.notes.append(f"{names} run in one direction, so that their link slides on the frame")
                yield self._guide(first, "slide", body)
                for joint in alike:
                    del left[joint.key]
        yield from (self._guide(joint, "slot", self.at[key][0]) for key, joint in left.items())

    def _slide(self, one: PylinkageJoint, two: PylinkageJoint) -> bool:
        """Return whether two joints of a link are on parallel lines, so that it cannot turn."""
        across = (one.axis.conjugate() * two.axis).imag / abs(one.axis) / abs(two.axis)
        apart = self.bodies.apart([one.key, two.key])
        return apart and abs(across) <= _ROUNDING and not self._off(one) and not self._off(two)

    def _off(self, joint: PylinkageJoint) -> float:
        """Return how far from its line a joint is drawn, nothing where that is rounding."""
        gap = ((self.places.of[joint.key] - joint.through) * joint.axis.conjugate()).imag / abs(joint.axis)
        return abs(gap) if abs(gap) > self.bodies.near else 0.0

    def _guide(self, joint: PylinkageJoint, kind: str, link: str) -> DrawnGuideway:
        angle = cmath.phase(joint.axis)
        return DrawnGuideway(
            f"{joint.key} guide",
            "slide" if kind == "slide" else "slot",
            link,
            FRAME,
            joint.key,
            joint.through,
            angle,
            where=joint.where,
        )

    def drivers(self) -> Iterator[DrawnDriver]:
        """Yield the drivers. Their speeds are in radians a step, and a step has no time."""
        driven = [link for link in self.file.links.values() if link.is_driver]
        for link in driven:
            body = next(body for body, parts in self.bodies.parts.items() if link in parts)
            if body == FRAME:
                self.problems.add(link.where, "it is driven, and two of its joints are on the ground", "leave it one")
            else:
                yield self._driver(link, body)
        if driven:
            speeds = ", ".join(f"{link.name} {link.speed:.6g} rad/s" for link in driven)
            self.notes.append(f"a step of pylinkage has no time, and is taken as a second: {speeds}")

    def _driver(self, link: PylinkageLink, body: str) -> DrawnDriver:
        tip = next(self.places.of[key] for key in link.joints if key != link.motor)
        shown = cmath.phase(tip - self.places.of[link.motor])
        shown += math.tau * round((link.start - shown) / math.tau)
        if abs(shown - link.start) > _ROUNDING:
            start = f"starts from {math.degrees(link.start):.6g} degrees in pylinkage"
            self.notes.append(f"{link.name} {start}, and is drawn at {math.degrees(shown):.6g}")
        if link.arc is None:
            return DrawnDriver(body, FRAME, link.motor, link.speed, where=link.where)
        low, high = (end - shown for end in link.arc)
        # where it is drawn at an end, it turns round at once
        at_end = high <= _ROUNDING if link.speed > 0.0 else low >= -_ROUNDING
        speed = -link.speed if at_end else link.speed
        return DrawnDriver(body, FRAME, link.motor, speed, (low, high), where=link.where)


def _called(body: str, parts: list[PylinkageLink]) -> tuple[str, str]:
    """Return the name of a body and where it is written: those of the link it is called by, which comes first."""
    return ("", "") if body == FRAME else (parts[0].name, parts[0].where)


def _joined(bodies: RigidBodies) -> Iterator[str]:
    for body, parts in bodies.joined():
        names = ", ".join(part.name for part in parts)
        if body == FRAME:
            yield f"two joints of the ground hold, and make a part of the frame: {names}"
        else:
            yield f"{count_phrase(len(parts), 'link')} are one rigid body, {parts[0].name}: {names}"
