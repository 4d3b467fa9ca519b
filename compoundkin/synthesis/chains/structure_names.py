"""Graphs, structures and Assur groups read as links and joints. Their names, and in how many ways they assemble."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING, Any

from compoundkin.base.arguments import checked
from compoundkin.kinematics.assembly.group_geometry import GroupGraph
from compoundkin.kinematics.assembly.mode_count import exact_count
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.parts import Group
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS
from compoundkin.synthesis.chains.chain_names import MOST_CHAINS, chain_name, derived_chains, number_of_derived_chains
from compoundkin.synthesis.chains.joints import LOWER_HOLDS, REVOLUTE, Joint, Joints
from compoundkin.synthesis.chains.mechanism_names import ChainName, named

if TYPE_CHECKING:
    import networkx as nx

# Counting takes a fifth of a second for a group of eight links, and some twelve times as long for each two more.
MOST_COUNTED = 8


@checked
def structure_name(structure: Structure) -> ChainName:
    """Return what a mechanism is called, with its frame and its drivers. A roller is a part of its follower.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.structure import decompose
    >>> structure_name(decompose(load_named("stephenson-iii"))).title
    'Stephenson III'
    """
    spun = {spin.link: spin.on for spin in structure.passive}
    return named(structure_joints(structure), FRAME, [spun.get(d.link, d.link) for d in structure.mechanism.drives])


def structure_joints(structure: Structure) -> Joints:
    """Return a structure's links and joints, rollers merged with their followers."""
    joints = joints_of(structure.graph)
    for spin in structure.passive:
        joints = joints.merged(spin.link, spin.on)
    return joints


@checked
def group_truss(group: Group) -> tuple[str, ...]:
    """Return the Baranov trusses that a group is made of. What it is attached to taken for one link more.

    Several where multiple pins stand for several; none where no list has it. Higher pairs count as binary links.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.structure import decompose
    >>> group_truss(decompose(load_named("class-iii-six-bar")).groups[0])
    ('5-link truss 1',)
    """
    joints = group_joints(group)
    if len(joints.links) > MOST_LINKS or number_of_derived_chains(joints) > MOST_CHAINS:
        return ()
    names = dict.fromkeys(chain_name(chain) for chain in derived_chains(joints) if chain.mobility == 0)
    return tuple(sorted(name for name in names if name))


def group_joints(group: Group) -> Joints:
    """Return a group's bodies and known links, joined as its pairs join them."""
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


@checked
def name_of(graph: nx.MultiGraph, frame: str | None = None, driver: str | Iterable[str] | None = None) -> ChainName:
    """Return the name of a mechanism from its kinematic graph.

    Edges are read as by `joints_of`. Raises UnknownName for a frame or driver that is not in the graph.

    >>> import networkx
    >>> stephenson = networkx.MultiGraph()
    >>> networkx.add_cycle(stephenson, ["frame", "crank", "plate", "rocker"])
    >>> networkx.add_path(stephenson, ["frame", "arm", "rod", "plate"])
    >>> name = name_of(stephenson, "frame", "crank")
    >>> name.title, name.assortment, name.equivalent_links
    ('Stephenson III', '4 binary, 2 ternary', (('frame', 'plate'), ('crank', 'rocker'), ('arm', 'rod')))
    """
    return named(joints_of(graph), frame, driver)


def joints_of(graph: nx.MultiGraph) -> Joints:
    """Read a graph of links and pairs. Edges of one pin have one attribute `pin`, or pairs with one letter.

    Of the edges' other attributes `code` is read ("R" where it is missing), and the `pair` where there is
    one, or else `held`: how much the pair holds (2 where it is missing).
    """
    number = {link: k for k, link in enumerate(graph)}
    pins: dict[object, list[int]] = {}
    joints: list[Joint] = []
    for first, second, data in graph.edges(data=True):
        ends = [number[first], number[second]]
        pin = _pin(data)
        if pin is None:
            joints.append(_joint(ends, data, number))
        else:
            pins.setdefault(pin, []).extend(ends)
    pinned = [Joint(tuple(sorted(set(ends)))) for ends in pins.values()]
    return Joints(tuple(str(link) for link in graph), (*pinned, *joints))


def _pin(data: Mapping[str, Any]) -> object:
    """Return what edges of one pin have in common. None for a pair of its own."""
    if data.get("code", REVOLUTE) != REVOLUTE:
        return None
    pair = data.get("pair")
    return data.get("pin", pair.letters[0] if pair is not None else None)


def _joint(ends: Sequence[int], data: Mapping[str, Any], number: Mapping[str, int]) -> Joint:
    pair = data.get("pair")
    code = data.get("code", REVOLUTE)
    if pair is None:
        return Joint(tuple(ends), code, data.get("held", LOWER_HOLDS))
    # the contract of pairs: the member that carries the reference comes first
    return Joint(tuple(ends), code, pair.held, number[pair.members[0]], pair.title)


def group_count(group: Group) -> int | None:
    """Return the number of complex configurations of a group for generic dimensions. None with slides, or where large.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.structure import decompose
    >>> group_count(decompose(load_named("class-iii-six-bar")).groups[0])
    6
    """
    if len(group.bodies) > MOST_COUNTED:
        return None
    if any(not pair.is_simple or not pair.free_is_angle for pair in (*group.inner, *group.outer)):
        return None
    code = group_joints(group).canonical().code
    if code not in _COUNTS:
        _COUNTS[code] = exact_count(_connections(group))
    return _COUNTS[code]


# By the code of the truss: which of its links is known makes no difference.
_COUNTS: dict[str, int | None] = {}


def _connections(group: Group) -> GroupGraph:
    """Return the group's pins between its bodies. Letters tell which pins of a body coincide."""
    body = {link: k for k, one in enumerate(group.bodies) for link in one.links}
    pairs: tuple[Pair, ...] = (*group.inner, *group.outer)
    bodies = tuple((body.get(pair.members[0]), body.get(pair.members[1])) for pair in pairs)
    seen: dict[int | None, list[str]] = {}
    pins = []
    for pair, ends in zip(pairs, bodies, strict=True):
        sides = []
        for end in ends:
            letters = seen.setdefault(end, [])
            if pair.letters[0] not in letters:
                letters.append(pair.letters[0])
            sides.append(letters.index(pair.letters[0]))
        pins.append((sides[0], sides[1]))
    return GroupGraph(len(group.bodies), bodies, (False,) * len(pairs), tuple(pins))


def configurations_of(structure: Structure) -> tuple[int | None, bool]:
    """Count the ways to assemble all groups, and tell whether all are closed forms."""
    order = SolvingOrder(structure)
    numbers = [solver.modes or group_count(solver.group) for solver in order.solvers]
    known = [number for number in numbers if number is not None]
    return prod(known) if len(known) == len(numbers) else None, not order.numbered
