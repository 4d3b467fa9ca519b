"""From the records of a share string to a drawing."""

from __future__ import annotations

from cmath import phase
from collections import Counter
from collections.abc import Iterator
from math import pi, remainder

from compoundkin.base.arrays import TURN
from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnDriver, DrawnGuideway, DrawnLink
from compoundkin.files.exchange.pmks_plus.rigid_links import RigidLinks
from compoundkin.files.exchange.pmks_plus.shared_loads import forces_of, masses_of
from compoundkin.files.exchange.pmks_plus.shared_points import SharedPoints
from compoundkin.files.exchange.pmks_plus.shared_records import GRAVITY, UNITS, SharedJoint, SharedMechanism
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.written_quantities import RPM
from compoundkin.model.geometry import FRAME

# Angles are written to so much: one that is within it of a quarter turn may have been meant as that.
_ROUNDED = 0.0005


def drawing_of_shared(shared: SharedMechanism, title: str, problems: Problems) -> Drawing:
    """Return the drawing of a share string. What cannot be meant is noted as a problem."""
    rigid = RigidLinks(shared)
    notes = [*shared.notes]
    points = SharedPoints(shared, rigid)
    guides = tuple(_guides(shared, rigid, points, notes, problems))
    drivers = tuple(_drivers(shared, rigid, points, notes, problems))
    masses, forces = tuple(masses_of(shared, rigid)), tuple(forces_of(shared, rigid, problems))
    loaded = bool(masses or forces)
    dropped = Counter(shared.dropped)
    dropped["loose joint"] += sum(not joint.slides and joint not in points for joint in shared.joints)
    settings = shared.settings
    return Drawing(
        title,
        (DrawnLink(FRAME), *(DrawnLink(body, name, f"link {body}") for body, name in rigid.names())),
        tuple(points.all()),
        guides,
        drivers=drivers,
        masses=masses,
        forces=forces,
        outputs=tuple(dict.fromkeys(points.key(one) for one in shared.joints if one.has_curve and one in points)),
        unit=settings.unit,
        units=UNITS[settings.length] if loaded else None,
        gravity=complex(0.0, -GRAVITY) if settings.has_gravity and masses else None,
        source="PMKS+",
        notes=(*notes, *rigid.notes),
        dropped=tuple(dropped.items()),
    )


def _guides(
    shared: SharedMechanism, rigid: RigidLinks, points: SharedPoints, notes: list[str], problems: Problems
) -> Iterator[DrawnGuideway]:
    for joint in shared.joints:
        pin = rigid.pin(joint)
        if not joint.slides:
            continue
        if pin is None:
            problems.add(joint.where, "it slides and is of no block", "make a link of type P of it and its pin")
            continue
        body, carrier = rigid.at(joint)[0], _carrier(joint, rigid)
        if body == carrier:
            problems.add(joint.where, f"link {body!r} slides on itself: a weld makes it one with its guide")
            continue
        at = points.key(joint if points.stands_apart(joint) else pin)
        if joint.slot is None:
            notes.extend(_said_of_angle(joint))
            angle = remainder(joint.angle, TURN)
            yield DrawnGuideway(_key(joint), "slide", body, carrier, at, joint.at, angle, where=joint.where)
        else:
            start, end = (rigid.joints[id_] for id_ in joint.slot[1:])
            angle, ends = phase(end.at - start.at), (points.key(start), points.key(end))
            yield DrawnGuideway(_key(joint), "slide", body, carrier, at, start.at, angle, ends, where=joint.where)


def _key(joint: SharedJoint) -> str:
    return f"slide at {joint.id}"


def _carrier(joint: SharedJoint, rigid: RigidLinks) -> str:
    return rigid.body(joint.slot[0]) if joint.slot else FRAME


def _said_of_angle(joint: SharedJoint) -> Iterator[str]:
    """Yield what is to be known of a guide on the frame: that its angle was rounded, that nothing grounds it."""
    quarters = round(joint.angle / (pi / 2.0))
    off = abs(joint.angle - quarters * pi / 2.0)
    if 0.0 < off <= _ROUNDED:
        yield (
            f"the guide of {joint.id} is at {joint.angle:g} rad, as written: the program rounds angles to 0.001 rad, "
            f"and may have meant {quarters * 90 % 360} degrees"
        )
    if not joint.is_grounded:
        yield f"{joint.id} slides on nothing that is told: on the frame, as the program takes it"


def _drivers(
    shared: SharedMechanism, rigid: RigidLinks, points: SharedPoints, notes: list[str], problems: Problems
) -> Iterator[DrawnDriver]:
    settings = shared.settings
    sense = -1.0 if settings.clockwise else 1.0
    for joint in shared.joints:
        if not joint.is_input:
            continue
        if joint.slides:
            linear = None if settings.linear_speed is None else sense * settings.linear_speed
            if rigid.pin(joint) is not None:
                speed = joint.speed or linear
                if speed is None:
                    notes.append(f"{joint.id} has no speed there: it slides by 1 {settings.unit}/s here")
                yield DrawnDriver(rigid.at(joint)[0], _carrier(joint, rigid), _key(joint), speed, where=joint.where)
            continue
        bodies = rigid.at(joint)
        if len(bodies) < 2 or (len(bodies) > 2 and FRAME not in bodies):
            what = f"it is driven and joins {len(bodies)} links" if bodies else "it is driven and no link has it"
            problems.add(joint.where, what, "a driver turns one link against one other")
            continue
        if len(bodies) > 2:
            notes.append(f"at {joint.id} the frame holds several links: {bodies[1]}, the first, is driven")
        turn = joint.speed or sense * settings.rpm
        if not turn:
            notes.append(f"{joint.id} has no speed there: it turns at 1 rad/s here")
        yield DrawnDriver(bodies[1], bodies[0], points.key(joint), turn * RPM if turn else None, where=joint.where)
