"""What a file of linkage_sim holds: bodies with points of their own, joints between them, drivers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from compoundkin.files.exchange.json_text import JsonRecord
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.attributes import VELOCITY

GROUND = "ground"
# Where bodies keep points: those of joints, those of springs, those that are traced.
_POINTS = ("attachment_points", "mount_points", "coupler_points")
_JOINTS = ("revolute", "fixed", "prismatic")
_SPEED = "constant_speed"
# All bodies together have so many points, at most.
_MOST_POINTS = 1000
# One of their keys is a word of ours.
_RATE = VELOCITY


@dataclass(frozen=True)
class SimBody:
    """A body: points by their names, and masses, all in its own axes.

    Each mass has a centre and an inertia about that.
    """

    key: str
    name: str
    points: Mapping[str, complex]
    masses: tuple[tuple[float, complex, float], ...]


@dataclass(frozen=True)
class SimJoint:
    """A joint of a point of a body with a point of another. `turn` is by how much the other is turned."""

    key: str
    kind: str
    bodies: tuple[str, str]
    points: tuple[str, str]
    axis: complex
    turn: float
    where: str


@dataclass(frozen=True)
class SimDriver:
    """An angle of a body against another, or a distance, in time.

    It is told by its value at time zero and its rate.
    """

    key: str
    bodies: tuple[str, str]
    start: float
    rate: float
    where: str
    places: tuple[complex, complex] | None = None


@dataclass(frozen=True)
class SimFile:
    """A whole file. `is_mounted` where gravity is meant in axes that are turned."""

    bodies: Mapping[str, SimBody]
    joints: tuple[SimJoint, ...]
    drivers: tuple[SimDriver, ...]
    forces: tuple[JsonRecord, ...]
    is_mounted: bool
    load_cases: int
    markers: int


def sim_file(data: Any, problems: Problems) -> SimFile:
    """Return what a document of linkage_sim says; what is wrong is noted."""
    record = JsonRecord(data, "", problems)
    version = record.text("schema_version", "1")
    if version.split(".")[0] != "1":
        problems.add("schema_version", f"{version!r} is not known", "1.0.0 and 1.1.0 are")
    bodies = {one.where.removeprefix("body "): one for one in record.records("bodies", "body")}
    if bodies and GROUND not in bodies:
        problems.add("bodies", "there is no body 'ground'", "the frame is called ground")
    joints = list(record.records("joints", "joint"))
    problems.raise_if_any()
    if not (bodies and joints):
        problems.add("", f"there are no {'joints' if bodies else 'bodies'}")
    markers = [one for one in joints if one.given.get("type") == "revolute_driver"]
    linear = (_linear(one, problems) for one in record.records("linear_drivers", "linear driver"))
    found = SimFile(
        {key: _body(key, one) for key, one in bodies.items()},
        tuple(_joint(one) for one in joints if one not in markers),
        (*(_driver(one) for one in record.records("drivers", "driver")), *linear),
        tuple(record.records("forces", "force")),
        bool(record.number("mounting_angle", 0.0)),
        len(list(record.records("load_cases", "load case"))),
        len(markers),
    )
    _check_names(found, problems)
    return found


def _body(key: str, record: JsonRecord) -> SimBody:
    points: dict[str, complex] = {}
    for word in _POINTS:
        table = record.given.get(word)
        if table is not None and not isinstance(table, Mapping):
            record.wrong(f"{word!r} is no table of points")
        elif table:
            inner = JsonRecord(table, f"{record.where}, {word}", record.problems)
            for name in list(table)[:_MOST_POINTS]:
                points.setdefault(str(name), inner.vector(name))
            if len(table) > _MOST_POINTS:
                record.wrong(f"{word!r} has {len(table):,} entries")
    word = "Izz_cg" if "Izz_cg" in record.given else "izz_cg"
    centre = record.vector("cg_local" if "cg_local" in record.given else "ch_local", 0j)
    masses = [(record.number("mass", 0.0), centre, record.number(word, 0.0))]
    added = record.records("point_masses", f"{record.where}, point mass")
    masses += [(one.number("mass"), one.vector("local_pos"), 0.0) for one in added]
    return SimBody(key, record.text("label", "") or key, points, tuple(one for one in masses if one[0]))


def _joint(record: JsonRecord) -> SimJoint:
    kind = record.text("type")
    if kind not in _JOINTS:
        remedy = "give the cam as a cam pair here" if kind == "cam_follower" else f"known: {', '.join(_JOINTS)}"
        record.wrong(f"joints of the type {kind!r} are not read", remedy)
    axis = record.vector("axis_local_i", None if kind == "prismatic" else 1 + 0j)
    if not axis:
        record.wrong("its axis has no direction")
    bodies = record.text("body_i"), record.text("body_j")
    points = record.text("point_i"), record.text("point_j")
    key = record.where.removeprefix("joint ")
    return SimJoint(key, kind, bodies, points, axis, record.angle("delta_theta_0", 0.0), record.where)


def _driver(record: JsonRecord) -> SimDriver:
    kind = record.text("type", _SPEED)
    if kind != _SPEED:
        what = f"a driver of the type {kind!r} is an expression in t, which is not evaluated"
        record.wrong(what, "give it a constant speed there, and a law here")
    bodies = record.text("body_i"), record.text("body_j")
    key = record.where.removeprefix("driver ")
    return SimDriver(key, bodies, record.angle("theta_0", 0.0), record.number("omega", 1.0), record.where)


def _linear(record: JsonRecord, problems: Problems) -> SimDriver:
    length = record.number("length_0")
    if length < 0.0:
        problems.add(record.where, "its length is negative")
    bodies, places = (
        (record.text("body_a"), record.text("body_b")),
        (record.vector("point_a"), record.vector("point_b")),
    )
    return SimDriver(record.text("id"), bodies, length, record.number(_RATE, 0.0), record.where, places)


def _check_names(file: SimFile, problems: Problems) -> None:
    """Note bodies and points that are not there, or too many."""
    if sum(len(body.points) for body in file.bodies.values()) > _MOST_POINTS:
        problems.add("bodies", f"they have more than {_MOST_POINTS:,} points")
    joined: list[SimJoint | SimDriver] = [*file.joints, *file.drivers]
    for one in joined:
        for key in (key for key in one.bodies if key not in file.bodies):
            problems.add(one.where, f"there is no body {key!r}")
        if one.bodies[0] == one.bodies[1]:
            problems.add(one.where, f"it joins the body {one.bodies[0]!r} to itself")
    for joint in file.joints:
        for body, point in zip(joint.bodies, joint.points, strict=True):
            if body in file.bodies and point not in file.bodies[body].points:
                known = ", ".join(list(file.bodies[body].points)[:8])
                problems.add(joint.where, f"the body {body!r} has no point {point!r}", f"it has {known}")
