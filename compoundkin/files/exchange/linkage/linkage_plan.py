"""A drawing laid out as elements of a Linkage file: which connector stands for which point of which link."""

from __future__ import annotations

from dataclasses import replace
from math import degrees

import numpy as np

from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnDriver, DrawnPoint
from compoundkin.files.exchange.linkage.input_drivers import CLOCKWISE
from compoundkin.files.exchange.linkage.linkage_elements import WrittenConnector, WrittenLink, WrittenRatio
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.files.written_quantities import RPM
from compoundkin.model.geometry import FRAME

# An end of a range is the pose written that is nearer to it than this part of the range.
_AT_REST = 1e-9


class LinkagePlan:
    """Elements as far as they are laid out. `links` are in the order of the file, by their keys.

    `gone` are links that others stand for: blocks, barrels and rods.
    """

    def __init__(self, shown: ShownMechanism, drawing: Drawing, problems: Problems) -> None:
        self.shown, self.drawing, self.problems = shown, drawing, problems
        self.size = shown.mechanism.geometry.size
        self.connectors: list[WrittenConnector] = []
        self.links: dict[str, WrittenLink] = {}
        self.extra: list[WrittenLink] = []
        self.ratios: list[WrittenRatio] = []
        self.notes: list[str] = []
        self.gone: set[str] = set()
        self._held: dict[tuple[str, str], WrittenConnector] = {}
        self._frame_links: dict[tuple[int, ...], WrittenLink] = {}

    def lay_out(self, drivers: dict[str, list[DrawnDriver]]) -> None:
        """Make the links, and a connector for each point. Links that are driven have their own."""
        for key in _in_order(self.drawing):
            if key not in self.gone and key != FRAME:
                self.links[key] = WrittenLink(len(self.links), name=self.drawing_name(key))
        for point in self.drawing.points:
            links = [link for link in point.links if link not in self.gone]
            for driver in drivers.get(point.key, ()):
                self._drive(point, driver, links)
            if links:
                self._hold(point.key, self.connector(point.at, links, point.called), links)

    def connector(self, at: complex, links: list[str], name: str = "") -> WrittenConnector:
        """Make a connector of some links; one of the frame is an anchor."""
        made = WrittenConnector(len(self.connectors), at, name, FRAME in links)
        self.connectors.append(made)
        for link in self.links:
            if link in links:
                self.links[link].connectors.append(made.id)
        return made

    def link(self, connectors: list[int], name: str = "") -> WrittenLink:
        """Make a link that the mechanism does not have."""
        made = WrittenLink(len(self.links) + len(self.extra), connectors, name)
        self.extra.append(made)
        return made

    def of(self, point: str, link: str) -> WrittenConnector:
        """Return the connector that stands for a point of a link."""
        return self._held[point, link]

    def frame_link(self, *connectors: int) -> WrittenLink:
        """Return a link of anchors. Limits and wheels that are fixed need one there."""
        found = self._frame_links.get(connectors)
        if found is None:
            found = self._frame_links[connectors] = self.link([*connectors])
        return found

    def drawing_name(self, key: str) -> str:
        """Return what a link is called."""
        return next(link.called for link in self.drawing.links if link.key == key)

    def places(self, link: str, on: str, at: complex) -> np.ndarray:
        """Return where a place of one link goes on another over the motion."""
        motion, poses = self.shown.motion, self.shown.poses
        if motion is None:
            return np.array([at])
        here = (at - poses[link].z.c[0]) / poses[link].u.c[0]
        with np.errstate(invalid="ignore"):  # poses that cannot be assembled are NaN
            way = np.ravel(motion.poses[link].at(complex(here)).c[0])
            place = (way - np.ravel(motion.poses[on].z.c[0])) / np.ravel(motion.poses[on].u.c[0])
            found = np.ravel(poses[on].at(place).c[0])
        found = found[np.isfinite(found)]
        return found if found.size else np.array([at])

    def _hold(self, point: str, made: WrittenConnector, links: list[str]) -> None:
        for link in links:
            self._held.setdefault((point, link), made)

    def _drive(self, point: DrawnPoint, driver: DrawnDriver, links: list[str]) -> None:
        """Make a connector for two links at a pin that is driven; those beside them do not turn with them."""
        turned = driver if driver.link != FRAME else _reversed(driver)
        made = self.connector(point.at, [turned.on, turned.link], point.called)
        made.rpm = CLOCKWISE * (turned.speed or 0.0) / RPM
        self._hold(point.key, made, [turned.link])
        links.remove(turned.link)
        if links == [turned.on]:
            self._hold(point.key, made, [turned.on])
            links.clear()
        if turned.travel is not None:
            low, high = turned.travel
            start, end = (low, high) if (turned.speed or 0.0) > 0 else (high, low)
            if abs(start) <= _AT_REST * abs(end):
                made.range = degrees(abs(end))
            else:
                self.notes.append(f"{driver.link} makes full turns there: its range does not begin at the pose written")


def _reversed(driver: DrawnDriver) -> DrawnDriver:
    """Return a driver that turns the frame as one that turns the link against it."""
    travel = None if driver.travel is None else (-driver.travel[1], -driver.travel[0])
    return replace(driver, link=driver.on, on=FRAME, speed=-(driver.speed or 0.0), travel=travel)


def _in_order(drawing: Drawing) -> list[str]:
    """Return the keys of the links, those before others that are driven against them."""
    keys = [link.key for link in drawing.links]
    for _ in drawing.drivers:
        for driver in drawing.drivers:
            one, two = keys.index(driver.on), keys.index(driver.link)
            if one > two:
                keys.insert(two, keys.pop(one))
    return keys
