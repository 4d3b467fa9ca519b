"""What is wrong among the records of a share string: ids, blocks, slots, inputs, links that name what is not there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from compoundkin.files.exchange.pmks_plus.shared_records import SharedJoint, SharedLink, SharedMechanism
from compoundkin.files.exchange.problems import Problems


def note_problems(shared: SharedMechanism, problems: Problems) -> None:
    """Note all that is wrong between the records."""
    joints = {joint.id: joint for joint in shared.joints}
    links = {link.id: link for link in shared.links}
    wholes = {id_ for link in shared.links if link.is_root for id_ in (link.id, *link.parts)}
    for what, ids in (("joint", [j.id for j in shared.joints]), ("link", [k.id for k in shared.links])):
        for id_, count in Counter(ids).items():
            if count > 1 and id_:
                problems.add(f"{what} {id_}", f"{count} {what}s have this id")
    if not any(link.is_root for link in shared.links):
        problems.add("", "it has no links", "share it again once something is drawn")
    elif not any(joint.is_grounded for joint in shared.joints):
        problems.add("", "no joint is grounded: it has no frame", "ground a joint at least")
    for link in shared.links:
        _note_link(link, joints, links, problems)
    blocks = Counter(id_ for link in shared.links if link.is_root and link.is_block for id_ in link.joints)
    for joint in shared.joints:
        _note_slot(joint, joints, links, problems)
        if joint.slides and blocks[joint.id] > 1:
            problems.add(joint.where, "it is of two blocks", "each block has a sliding joint of its own")
        if joint.slot and joint.slot[0] in links and joint.slot[0] not in wholes:
            problems.add(joint.where, f"its slot is on {joint.slot[0]!r}, a part that no link has")
    for force in shared.forces:
        if force.link not in links or force.link not in wholes:
            problems.add(force.where, f"it is on a link {force.link!r} that is not there")
        if force.size < 0.0:
            problems.add(force.where, f"its size {force.size:g} is negative")


def _note_link(
    link: SharedLink, joints: dict[str, SharedJoint], links: dict[str, SharedLink], problems: Problems
) -> None:
    unknown = [id_ for id_ in link.joints if id_ not in joints]
    for id_ in unknown:
        problems.add(link.where, f"it names a joint {id_!r} that is not there")
    for id_ in link.parts:
        if id_ not in links:
            problems.add(link.where, f"it names a part {id_!r} that is not there")
    if not link.joints and link.is_root:
        problems.add(link.where, "it has no joint")
    if len(set(link.joints)) < len(link.joints):
        problems.add(link.where, "it names a joint twice")
    if unknown or not link.is_root:
        return
    sliding = [id_ for id_ in link.joints if joints[id_].slides]
    if link.is_block and (len(link.joints), len(sliding)) != (2, 1):
        problems.add(link.where, "it is a block and has not one pin and one sliding joint")
    if sliding and not link.is_block:
        problems.add(link.where, f"it has the sliding joint {sliding[0]!r} and is no block")


def _note_slot(
    joint: SharedJoint, joints: dict[str, SharedJoint], links: dict[str, SharedLink], problems: Problems
) -> None:
    if joint.is_sealed and (not joint.slides or joint.slot is None):
        problems.add(joint.where, "it is of a cylinder and does not slide on a link")
    if joint.slot is None:
        return
    for what in _slot_problems(joint, joints, links):
        problems.add(joint.where, what)


def _slot_problems(joint: SharedJoint, joints: dict[str, SharedJoint], links: dict[str, SharedLink]) -> Iterable[str]:
    carrier, *ends = joint.slot or ("", "", "")
    if not all((carrier, *ends)):
        yield "its slot lacks one of carrier and two joints"
        return
    if not joint.slides:
        yield "it has a slot and does not slide"
    if joint.is_grounded:
        yield f"it slides both on the frame and on the link {carrier!r}"
    if ends[0] == ends[1]:
        yield f"its slot is through the joint {ends[0]!r} twice"
    if joint.id in ends:
        yield "its slot is through itself"
    for end in ends:
        if end not in joints:
            yield f"its slot is through a joint {end!r} that is not there"
    if carrier not in links:
        yield f"its slot is on a link {carrier!r} that is not there"
    elif missing := [end for end in ends if end in joints and end not in links[carrier].joints]:
        yield f"its slot is through {' and '.join(map(repr, missing))}, not of its carrier {carrier!r}"
    elif joint.id in links[carrier].joints:
        yield f"it slides on the link {carrier!r} and is one of its joints"
    elif all(end in joints for end in ends) and joints[ends[0]].at == joints[ends[1]].at and ends[0] != ends[1]:
        yield f"its slot has no direction: {ends[0]!r} and {ends[1]!r} are at one place"
