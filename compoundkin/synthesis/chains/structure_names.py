"""Names of what `decompose` finds: of a whole mechanism, and of each of its Assur groups."""

from __future__ import annotations

from compoundkin.model.elements import FRAME
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.parts import Group
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS
from compoundkin.synthesis.chains.chain_names import chain_name
from compoundkin.synthesis.chains.joints import MOST_CHAINS, REVOLUTE, Joint, Joints
from compoundkin.synthesis.chains.mechanism_names import ChainName, named


def structure_name(structure: Structure) -> ChainName:
    """What a mechanism is called, with its frame and its drivers; a roller is a part of its follower.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.structure import decompose
    >>> structure_name(decompose(load_named("stephenson-iii"))).title
    'Stephenson III'
    """
    spun = {spin.link: spin.on for spin in structure.passive}
    return named(structure_joints(structure), FRAME, [spun.get(d.link, d.link) for d in structure.mechanism.drives])


def structure_joints(structure: Structure) -> Joints:
    """Its links and joints, rollers taken for a part of the links that carry them."""
    joints = Joints.of(structure.graph)
    for spin in structure.passive:
        joints = joints.merged(spin.link, spin.on)
    return joints


def group_truss(group: Group) -> tuple[str, ...]:
    """The Baranov trusses that a group is made of: what it is attached to taken for one link more.

    Several where multiple pins stand for several; none where no list has it. Higher pairs count as binary links.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.structure import decompose
    >>> group_truss(decompose(load_named("class-iii-six-bar")).groups[0])
    ('5-link truss 1',)
    """
    joints = group_joints(group)
    if len(joints.links) > MOST_LINKS or joints.number_of_chains > MOST_CHAINS:
        return ()
    names = dict.fromkeys(chain_name(chain) for chain in joints.chains() if chain.mobility == 0)
    return tuple(sorted(name for name in names if name))


def group_joints(group: Group) -> Joints:
    """A group's bodies by their first links, joined to each other and to one link for all that is known."""
    known = len(group.bodies)
    number = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    pins: dict[str, dict[int, None]] = {}
    joints: list[Joint] = []
    for pair in (*group.inner, *group.outer):
        links = tuple(dict.fromkeys(number.get(link, known) for link in pair.members[:2]))
        if pair.code == REVOLUTE:
            pins.setdefault(pair.letters[0], {}).update(dict.fromkeys(links))
        elif len(links) > 1:
            joints.append(Joint(links, pair.code, pair.held, None, pair.title))
    pinned = [Joint(tuple(sorted(links))) for links in pins.values() if len(links) > 1]
    return Joints((*(body.links[0] for body in group.bodies), "known links"), (*pinned, *joints))
