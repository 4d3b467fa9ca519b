"""What is read of a document as far as it goes: what of it is a mechanism, what is set aside, where everything is.

Most of what is being drawn is no mechanism yet. What cannot be part of one is set aside with the problem that it has;
what has no place by a solution has that of the drawing, or the one to which the coordinates of its link lead.
"""

from __future__ import annotations

import cmath
import re
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from math import isfinite
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, InvalidInput, InvalidMechanism, Problem
from compoundkin.files.parsed_document import Syntax, parsed
from compoundkin.files.reader import read
from compoundkin.kinematics import Motion, solve
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose
from compoundkin.structure.decomposition import decompose_near_drawing
from compoundkin.studio.edited_document import Document, Placement

# A document may have so many links, a motion so many poses.
MOST_LINKS, MOST_POSES = 400, 721
# A driver that states a range, and one that turns fully, is solved at so many poses: as the window shows them.
POSES = 361
# So many times something is set aside before the rest is given up.
ROUNDS = 40


@dataclass(frozen=True)
class Reading:
    """A document, the mechanism of what of it goes together, and what was set aside with the problems that it has."""

    document: Document
    mechanism: Mechanism | None
    problems: tuple[Problem, ...]
    aside: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # names of links, `drives[1]` and the like
    # whether what is overconstrained is looked for everywhere, or near the drawing only, which takes no time
    is_searched: bool = False

    @cached_property
    def structure(self) -> Structure | None:
        """The mechanism taken apart."""
        if self.mechanism is None:
            return None
        return decompose(self.mechanism) if self.is_searched else decompose_near_drawing(self.mechanism)

    @cached_property
    def searched(self) -> Reading:
        """This reading, in which a motion of what is overconstrained is looked for everywhere."""
        return replace(self, is_searched=True) if self.may_move else self

    @property
    def may_move(self) -> bool:
        """Whether it holds too much near the drawing, and may move elsewhere."""
        if self.is_searched or self.structure is None or self.structure.mechanism.unplaced:
            return False
        return any(fault.kind == "over" for fault in self.structure.faults)

    @cached_property
    def letters(self) -> dict[str, tuple[str, ...]]:
        """The letters of all links that are written, those set aside included."""
        links = self.document.get("links")
        tables = links.items() if isinstance(links, dict) else ()
        points = ((name, table.get("points", ())) for name, table in tables if isinstance(table, dict))
        return {name: tuple(map(str, own)) for name, own in points if isinstance(own, list | dict)}

    @cached_property
    def motion(self) -> Motion | None:
        """The motion over the range of the drivers. None where there is none; raises as `solve`."""
        if self.structure is None or self.structure.faults or not self.structure.mechanism.drives:
            return None
        return solve(self.structure, driver_ranges(self.structure.mechanism), order=0)

    @cached_property
    def first_pose(self) -> Motion | None:
        """The first pose of the motion alone, which takes a fraction of the time. None where it is not assembled."""
        if self.structure is None or self.structure.faults or not self.structure.mechanism.drives:
            return None
        values = {drive.name: drive.values for drive in self.structure.mechanism.drives}
        angles = self.structure.driven_angles
        first = {
            name: 0.0 if v is None and angles[name] else v if v is None else np.ravel(v)[:1]
            for name, v in values.items()
        }
        if any(drive.law for drive in self.structure.mechanism.drives) or None in first.values():
            return None
        try:
            found = solve(self.structure, first, order=0)
        except CompoundkinError:
            return None
        return found if found.failed.size == 1 and not found.failed.any() else None


def syntax_of(text: str) -> Syntax:
    """Return the syntax of a document.

    >>> syntax_of(' {"title": "m"}'), syntax_of('title = "m"')
    ('json', 'toml')
    """
    return "json" if text.lstrip().startswith("{") else "toml"


# A document is made by an edit, asked for its structure, its motion, the next edit: it is parsed and read once.
@lru_cache(maxsize=4)
def document_of(text: str) -> Document:
    """Return the document of a text, which nobody changes. Raises InvalidMechanism for neither TOML nor JSON."""
    return parsed(text, syntax_of(text), "")


@lru_cache(maxsize=4)
def reading_of(text: str) -> Reading:
    """Read a document as far as it goes. Raises InvalidMechanism for a text that is neither TOML nor JSON."""
    whole = document_of(text)
    if isinstance(links := whole.get("links"), dict) and len(links) > MOST_LINKS:
        raise InvalidInput(
            Problem("links", f"there are more than {MOST_LINKS} links", "take the command line for them")
        )
    part, aside, found = deepcopy(whole), dict[str, list[str]](), list[Problem]()
    # of what is left of an array, the places in the whole
    kept = {name: list(range(len(array))) for name, array in whole.items() if isinstance(array, list)}
    for _ in range(ROUNDS):
        try:
            return Reading(whole, read(part, ""), tuple(found), {k: tuple(v) for k, v in aside.items()})
        except InvalidMechanism as error:
            problems = error.problems
        gone = [(one, _set_aside(part, one, kept)) for one in problems]
        for one, name in gone:
            sort, _, _ = name.partition("[")
            found.append(_at_its_place(one, name))
            aside.setdefault("links" if sort == name else sort, []).append(name)
        if not any(name for _, name in gone):
            break
        for name, places in kept.items():
            if name in part:
                part[name] = [one for one in part[name] if one is not _GONE]
                kept[name] = [place for place in places if place >= 0]
                if not part[name]:
                    del part[name]
    return Reading(whole, None, tuple(dict.fromkeys(found)), {k: tuple(v) for k, v in aside.items()})


# Stands in an array for what is set aside, until all problems have been looked at.
_GONE: Any = object()
INDEXED = re.compile(r"(\w+)\[(\d+)\]")


def _set_aside(part: Document, problem: Problem, kept: dict[str, list[int]]) -> str:
    """Take out of a document what has a problem, and return its name in the whole; "" where nothing could be."""
    head, _, rest = problem.where.partition(".")
    if indexed := INDEXED.match(head):
        name, place = indexed[1], int(indexed[2])
        if not isinstance(part.get(name), list) or place >= len(part[name]):
            return ""
        was = kept[name][place]
        part[name][place], kept[name][place] = _GONE, -1
        return f"{name}[{was}]" if was >= 0 else ""
    if head in ("format", "title") and not rest:
        part[head] = 1 if head == "format" else "Mechanism"
        return head
    if head == "links":
        link, _, key = rest.partition(".")
        if key and key != "points" and not key.startswith("points.") and isinstance(part["links"].get(link), dict):
            return f"links.{link}.{key}" if part["links"][link].pop(key, None) is not None else ""
        if link and link != FRAME and isinstance(part.get("links"), dict):
            return link if part["links"].pop(link, None) is not None else ""
        return ""
    holder = part.get(head) if rest else part
    key = rest or head
    return problem.where if isinstance(holder, dict) and holder.pop(key, None) is not None else ""


def _at_its_place(problem: Problem, name: str) -> Problem:
    """Return a problem at the place that it has in the whole document."""
    indexed = INDEXED.match(problem.where)
    return Problem(name + problem.where[indexed.end() :], problem.what, problem.remedy) if indexed and name else problem


def driver_ranges(mechanism: Mechanism) -> dict[str, Number] | None:
    """Return the values of drivers as finely as they are shown: of each from its first to its last, all together."""
    if not mechanism.drives or mechanism.prescribed_motions or any(drive.law is not None for drive in mechanism.drives):
        return None
    ranges = {drive.name: _values(mechanism, drive, len(mechanism.drives) > 1) for drive in mechanism.drives}
    known = {name: values for name, values in ranges.items() if values is not None}
    return known if len(known) == len(ranges) else None


def _values(mechanism: Mechanism, drive: Any, is_one_of_several: bool) -> Number | None:
    """Return the values of a driver; None where it has none that are known here."""
    if drive.values is None:
        pairs = {pair.name for pair in mechanism.written_pairs if not pair.free_is_angle}
        return None if pairs & set(mechanism.drivable(drive)) else np.deg2rad(np.arange(POSES, dtype=float))
    values = np.atleast_1d(np.asarray(drive.values, float))
    steps = np.diff(values)
    if values.ndim == 1 and len(values) > 2 and (np.all(steps > 0) or np.all(steps < 0)):
        return np.linspace(values[0], values[-1], POSES)
    if is_one_of_several:
        # values that go to and fro go with those of the others as they are written
        return None
    return np.asarray(values.reshape(-1, values.shape[-1])[0][:MOST_POSES])


# --- where everything is ------------------------------------------------------------------------------------


def drawing_of(reading: Reading, pose: int | None = None) -> Placement:
    """Return where points and links are: as drawn where all links take their dimensions off it, else at a pose.

    Without a `pose` it is the first that is assembled. What cannot be solved stands where the drawing has it, else
    where the coordinates of its link lead from what is known.
    """
    places, poses = dict[str, complex](), dict[str, tuple[complex, complex]]()
    mechanism = reading.mechanism
    if mechanism is not None and not mechanism.unplaced:
        if pose is None and is_as_drawn(mechanism):
            places = {k: complex(p) for k, p in mechanism.geometry.sketch.items() if not np.ndim(p)}
            known = mechanism.drawn_poses
            poses = {name: (complex(p.z.c[0]), complex(p.u.c[0])) for name, p in known.items() if not np.ndim(p.z.c[0])}
        else:
            places, poses = _solved(reading, pose)
    poses.setdefault(FRAME, (0j, 1 + 0j))
    _complete(reading.document, places, poses)
    return Placement(places, poses)


def _solved(reading: Reading, pose: int | None) -> tuple[dict[str, complex], dict[str, tuple[complex, complex]]]:
    motion = reading.first_pose if pose is None else None
    if motion is None:
        try:
            motion = reading.motion if pose is None else reading.searched.motion
        except CompoundkinError:
            motion = None
    if motion is None:
        return {}, {}
    whole = np.flatnonzero(motion.failed[0] == 0)
    if not whole.size:
        return {}, {}
    k = pose if pose is not None and 0 <= pose < motion.failed.shape[1] and motion.failed[0, pose] == 0 else whole[0]
    poses = {}
    for name, one in motion.poses.items():
        z, u = (np.broadcast_to(part.c[0], motion.failed.shape)[0, k] for part in (one.z, one.u))
        poses[name] = complex(z), complex(u)
    places = {letter: complex(np.atleast_2d(point.position)[0, k]) for letter, point in motion.points.items()}
    return places, poses


def is_as_drawn(mechanism: Mechanism) -> bool:
    """Return whether all moving links take their dimensions off the drawing."""
    return all(link.is_drawn or name == FRAME for name, link in mechanism.links.items())


def _complete(document: Document, places: dict[str, complex], poses: dict[str, tuple[complex, complex]]) -> None:
    """Add the points and links that are not known yet: from the drawing, then link by link from what is known."""
    for letter, place in _plain_places(document.get("drawn")).items():
        places.setdefault(letter, place)
    links = document.get("links")
    tables = links.items() if isinstance(links, dict) else ()
    points = {name: table.get("points") for name, table in tables if isinstance(table, dict)}
    written = {name: _plain_places(own) for name, own in points.items() if isinstance(own, dict)}
    for letter, place in written.get(FRAME, {}).items():
        places.setdefault(letter, place)
    left = [name for name in written if name not in poses and written[name]]
    while left:
        # the one of which most is known: two points or more show how it lies
        name = max(left, key=lambda one: min(2, sum(k in places for k in written[one])))
        left.remove(name)
        poses[name] = _pose(written[name], places)
    for name, own in written.items():
        origin, along = poses.get(name, (0j, 1 + 0j))
        for letter, p in own.items():
            places.setdefault(letter, origin + along * p)
    for name, letters in points.items():
        known = [places[k] for k in letters if k in places] if isinstance(letters, list) else []
        if name not in poses and len(known) > 1 and known[0] != known[1]:
            line = known[1] - known[0]
            poses[name] = known[0], line / abs(line)


def _plain_places(table: Any) -> dict[str, complex]:
    """Return the places that a table of a document writes, by letter."""
    own = table.items() if isinstance(table, dict) else ()
    return {str(letter): place for letter, value in own if (place := _plain_place(value)) is not None}


def _pose(points: Mapping[str, complex], places: Mapping[str, complex]) -> tuple[complex, complex]:
    """Return how a link lies by the first two of its points that have places; by one it is not turned."""
    known = [k for k in points if k in places]
    far = [k for k in known[1:] if points[k] != points[known[0]] and places[k] != places[known[0]]]
    along = 1 + 0j
    if far:
        along = (places[far[0]] - places[known[0]]) / (points[far[0]] - points[known[0]])
        along /= abs(along)
    return (places[known[0]] - along * points[known[0]] if known else 0j), along


def _plain_place(value: Any) -> complex | None:
    """Return the place that a document writes; None for what is none. Of several designs and poses it is the first."""
    try:
        if isinstance(value, dict):
            radius, angle = map(_first, value["polar"])
            place = cmath.rect(radius, np.deg2rad(angle))
        else:
            x, y = map(_first, value)
            place = complex(x, y)
    except (TypeError, ValueError, KeyError, IndexError, OverflowError):
        return None
    return place if isfinite(place.real) and isfinite(place.imag) else None


def _first(value: Any) -> float:
    while isinstance(value, list):
        value = value[0]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    return float(value)
