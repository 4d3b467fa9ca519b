"""Names of mechanisms, structures and Assur groups by their graphs: chain, inversion, derivation, symmetries.

Loops of four links with slides have names by their letters and their frame. Source: F. Reuleaux, The Kinematics of
Machinery, 1876, ch. VIII (chains of three turning pairs and a sliding pair, of two and two, and their inversions);
J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and Mechanisms, on inversions.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import TYPE_CHECKING, Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.kinematics.assembly.elimination import exact_count
from compoundkin.kinematics.assembly.loop_closure import GroupGraph
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import Group
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS
from compoundkin.synthesis.chains.chain_names import (
    MOST_CHAINS,
    chain_name,
    derived_chains,
    derived_names,
    has_rigid_part,
    number_of_derived_chains,
    variety_of,
)
from compoundkin.synthesis.chains.coloured_graphs import assorted, ordinal
from compoundkin.synthesis.chains.joints import LOWER_HOLDS, REVOLUTE, SLIDE, Joint, Joints

if TYPE_CHECKING:
    import networkx as nx

_PINS = {2: "double pin", 3: "triple pin"}
# The fewest links that slides alone can join into a loop that moves.
_WEDGE = 3
# More names than these are counted instead of written out.
_MANY = 4
# Half a second; the work grows with about the cube of the links.
MOST_COMPARED = 120


@dataclass(frozen=True, repr=False)
class ChainName:
    """What is known of a mechanism from its graph alone.

    `title` is the name; `also` are well-known mechanisms of that structure; `chain` is the name without a
    frame; `driven` says which kind of link is driven. `derived_from` are the chains of revolute pairs between
    two links, with their inversions, that slides, multiple pins and higher pairs derive it from (none if it is one
    itself). `parts` are the names of what a fractionated chain falls apart into at the links and pins
    `fractionated_at`. `equivalent_links` and `equivalent_pairs` are carried into each other by the
    `symmetries` (their number) of the chain without frame. `variety` is the degree of variety, where all chains it
    derives from have the same one. `code` is equal exactly for mechanisms of the same structure, letters of pairs,
    frame and driver. Above `MOST_COMPARED` links parts, symmetries and code are not worked out: they are empty and 0.

    All of it is by count. A structure of mobility 0 is called a truss or a structure; where it moves, as a
    parallelogram with two couplers does, that is due to its dimensions, of which nothing is known here.
    """

    title: str
    mobility: int
    assortment: str
    chain: str
    also: tuple[str, ...] = ()
    driven: str = ""
    derived_from: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()
    fractionated_at: tuple[str, ...] = ()
    symmetries: int = 0
    variety: int | None = None
    equivalent_links: tuple[tuple[str, ...], ...] = ()
    equivalent_pairs: tuple[tuple[str, ...], ...] = ()
    code: str = ""

    def __str__(self) -> str:
        return self.title

    def __repr__(self) -> str:
        return f"ChainName({self.title!r}: {self.assortment}, mobility {self.mobility})"


@checked
def named(joints: Joints, frame: str | None = None, driver: str | Iterable[str] | None = None) -> ChainName:
    """Return the name of a mechanism given by its links and joints.

    >>> named(Joints(("frame", "crank", "rod"), (Joint((0, 1)), Joint((1, 2)), Joint((0, 2))))).title
    '3-link truss 1'
    """
    fixed = None if frame is None else _number(joints, frame)
    given = (driver,) if isinstance(driver, str) else () if driver is None else driver
    drivers = [_number(joints, link) for link in given]
    kinds = ", ".join(_driven(joints, fixed, link) for link in drivers)
    name = replace(_titled(joints, fixed, drivers[0] if drivers else None), driven=kinds)
    return _compared(name, joints, fixed, drivers) if len(joints.links) <= MOST_COMPARED else name


def _compared(name: ChainName, joints: Joints, frame: int | None, drivers: Sequence[int]) -> ChainName:
    """Return the name with what follows from comparing links: parts, symmetries, code."""
    marks = {**dict.fromkeys(drivers, "driver"), **({} if frame is None else {frame: "frame"})}
    form, links, blocks = joints.canonical(), len(joints.links), joints.blocks()
    parts = () if blocks == (tuple(range(links)),) else blocks
    return replace(
        name,
        parts=tuple(_part_name(joints, block, frame) for block in parts),
        fractionated_at=joints.names(_shared(joints, parts)),
        symmetries=form.symmetries,
        variety=variety_of(joints),
        equivalent_links=tuple(joints.names(orbit) for orbit in form.orbits if orbit[0] < links),
        equivalent_pairs=tuple(joints.names(orbit) for orbit in form.orbits if orbit[0] >= links),
        code=joints.canonical(marks).code,
    )


def titled(joints: Joints, frame: int | None = None, driver: int | None = None) -> str:
    """Return the name alone, of links by their numbers, without what takes comparing.

    >>> titled(Joints(tuple("abcd"), tuple(Joint((k, (k + 1) % 4)) for k in range(4))), 0)
    'four-bar'
    """
    return _titled(joints, frame, driver).title


def _titled(joints: Joints, frame: int | None, driver: int | None) -> ChainName:
    """Return the name with what counting and looking up give."""
    if joints.has_loop_of_slides:
        return _with_loop_of_slides(joints)
    derived, chains, changed = derived_names(joints, frame), derived_names(joints, None), _changes(joints)
    plain = ChainName(_described(joints), joints.mobility, assorted(joints.degrees), _described(joints))
    if not changed:
        plain = replace(plain, title=plain.title.rstrip(","), chain=plain.chain.rstrip(","))
        return replace(plain, title=derived[0], chain=chains[0]) if derived else plain
    plain = replace(plain, derived_from=derived)
    slider = slider_name(joints, frame, driver)
    if slider:
        return replace(plain, title=slider.title, chain=slider.chain, also=slider.also)
    if len(derived) == 1 and not joints.multiple and not any(joint.is_higher for joint in joints.joints):
        name, comma, inversion = derived[0].partition(",")
        return replace(plain, title=f"{name} with {changed}{comma}{inversion}", chain=f"{chains[0]} with {changed}")
    bare = f"{plain.title} with {changed}"
    return replace(plain, title=f"{bare}, {_derivation(derived)}" if derived else bare, chain=bare)


def _with_loop_of_slides(joints: Joints) -> ChainName:
    """Return a name that promises nothing.

    A slide in a loop of slides is no pin at infinity, and the count is too low.
    """
    if len(joints.links) == len(joints.joints) == _WEDGE and all(joint.code == SLIDE for joint in joints.joints):
        title = "wedge mechanism (3 slides)"
    else:
        title = f"{len(joints.links)}-link chain with {_changes(joints)}, some of them a loop of slides alone"
    return ChainName(title, joints.mobility, assorted(joints.degrees), title)


def _changes(joints: Joints) -> str:
    """Say what a mechanism has that simple chains of revolute pairs lack."""
    texts = []
    for pairs in sorted({joint.pairs for joint in joints.multiple}):
        number = sum(joint.pairs == pairs for joint in joints.multiple)
        texts.append(_counted(number, _PINS.get(pairs, f"pin of {pairs + 1} links")))
    kinds = [_kind(joint) for joint in joints.joints if joint.code != REVOLUTE]
    texts += [_counted(kinds.count(kind), kind) for kind in dict.fromkeys(sorted(kinds))]
    return " and ".join(texts)


def _kind(joint: Joint) -> str:
    if joint.code == SLIDE:
        return "slide"
    return joint.kind or ("higher pair" if joint.is_higher else f"pair {joint.code}")


def _described(joints: Joints) -> str:
    """Return a name from the numbers alone, for what is in no list."""
    blocks, pieces = joints.blocks(), joints.pieces
    if pieces > 1:
        return f"{len(joints.links)} links in {pieces} separate pieces"
    if not blocks:
        return "open chain"
    loose = sum(degree == 1 for degree in joints.degrees)
    open_ = f", {_counted(loose, 'link')} of it loose," if loose else ""
    kind = "chain" if joints.mobility > 0 else "structure"
    fractionated = "fractionated " if len(blocks) > 1 else ""
    mobility = f" of mobility {joints.mobility}" if joints.mobility != 1 else ""
    rigid = " with a rigid part" if has_rigid_part(joints) else ""
    return f"{fractionated}{len(joints.links)}-link {kind}{mobility}{rigid}{open_}"


def _part_name(joints: Joints, block: tuple[int, ...], frame: int | None) -> str:
    """Return the name of a part. Its frame is the frame, or the link that is nearest to it."""
    part = joints.part(block)
    own = None if frame is None else block.index(min(block, key=lambda link: joints.distances(frame)[link]))
    return _titled(part, own, None).title


def _shared(joints: Joints, blocks: tuple[tuple[int, ...], ...]) -> list[int]:
    """Return the links and joints that two parts have in common."""
    links = [k for k in range(len(joints.links)) if sum(k in block for block in blocks) > 1]
    # a part that has two links of a joint has the joint
    held = [sum(len({*joint.links} & {*block}) > 1 for block in blocks) for joint in joints.joints]
    return [*links, *(len(joints.links) + k for k, number in enumerate(held) if number > 1)]


def _driven(joints: Joints, frame: int | None, driver: int) -> str:
    """Say which kind of link is driven, and whether next to the frame."""
    kind = f"{ordinal(joints.degrees[driver])} link"
    if frame is None:
        return kind
    joined = any({frame, driver} <= set(joint.links) for joint in joints.joints)
    return f"{kind} {'next to' if joined else 'away from'} the frame"


def _number(joints: Joints, link: str) -> int:
    if link not in joints.links:
        raise UnknownName(Problem(link, "the graph has no such link", suggestion(link, joints.links)))
    return joints.links.index(link)


def _derivation(names: tuple[str, ...]) -> str:
    if len(names) > _MANY:
        return f"derived from {len(names)} inversions of simple-jointed chains"
    return f"derived from {' or '.join(names)}"


def _counted(number: int, word: str) -> str:
    count = "one" if number == 1 else str(number)
    return f"{count} {word}{'' if number == 1 else 's'}"


FOUR = 4
SLIDER_CRANK, INVERTED = "slider-crank", "inverted slider-crank"
# By the letters around the loop, then by those of the frame: the slide's own link, or the pins' link.
_NAMES = {
    ("RRRP", "RP"): SLIDER_CRANK,
    ("RRRP", "RR"): INVERTED,
    ("RRPP", "PP"): "elliptic trammel",
    ("RRPP", "RR"): "Oldham coupling",
    ("RRPP", "RP"): "Scotch yoke",
    ("RPRP", "RP"): "Rapson slide",
}
_CHAINS = {"RRRP": "slider-crank chain", "RRPP": "double slider chain", "RPRP": "crossed slider chain"}


def loop_letters(joints: Joints) -> str:
    """Return the letters around the only loop, those with R first.

    That is from where and in the direction in which they come first.
    "" where the links do not form one loop.

    >>> from compoundkin.synthesis.chains.joints import Joint
    >>> loop = [Joint((0, 1)), Joint((1, 2), "P"), Joint((2, 3)), Joint((3, 0))]
    >>> loop_letters(Joints(("a", "b", "c", "d"), tuple(loop)))
    'RRRP'
    """
    if any(joint.pairs > 1 for joint in joints.joints) or set(joints.degrees) != {2}:
        return ""
    link, passed = 0, [k for k, joint in enumerate(joints.joints) if 0 in joint.links][:1]
    while len(passed) < len(joints.joints):
        first, second = joints.joints[passed[-1]].links
        link = second if first == link else first
        onward = [k for k, joint in enumerate(joints.joints) if link in joint.links and k not in passed]
        if not onward:
            return ""
        passed.append(onward[0])
    letters = "".join(joints.joints[k].code for k in passed)
    turned = [text[k:] + text[:k] for text in (letters, letters[::-1]) for k in range(len(letters))]
    return min(turned, key=lambda text: [letter != REVOLUTE for letter in text])


@dataclass(frozen=True)
class SliderName:
    """The name of a four-link loop with slides, and of its chain."""

    title: str
    chain: str
    also: tuple[str, ...] = ()


def slider_name(joints: Joints, frame: int | None, driver: int | None) -> SliderName | None:
    """Return the name of a four-link loop with slides; None for any other mechanism.

    A pump's lever is a connecting rod: the slider-crank driven there is distinguished. Which link of a slide is
    the block and which one carries the guide is a matter of design, not of motion; where it is known it tells
    a lever with a slot (or a cylinder) that turns on the frame from a block that does.
    """
    letters = loop_letters(joints) if len(joints.links) == FOUR else ""
    if SLIDE not in letters or not set(letters) <= {REVOLUTE, SLIDE}:
        return None
    chain = _CHAINS.get(letters, f"four-link chain {letters}")
    if frame is None:
        return SliderName(chain, chain)
    own = _letters_of(joints, frame)
    name = _NAMES.get((letters, own), f"{chain}, frame {own}")
    detail, also = _detail(joints, frame, driver, name)
    return SliderName(name + detail, chain, also)


def _detail(joints: Joints, frame: int, driver: int | None, name: str) -> tuple[str, tuple[str, ...]]:
    guide = next(joint.guide for joint in joints.joints if joint.code == SLIDE)
    if name == SLIDER_CRANK:
        if driver is not None and _is_connecting_rod(joints, frame, driver):
            return " driven at the connecting rod", ("hand pump",)
        return (" with fixed block", ("hand pump",)) if guide not in (None, frame) else ("", ())
    if name == INVERTED and guide is not None:
        if any({frame, guide} <= set(joint.links) for joint in joints.joints):
            return " with turning or oscillating guide", (
                "Whitworth",
                "crank and slotted lever",
                "oscillating cylinder",
            )
        return " with swinging block", ("oscillating block",)
    return "", ()


def _is_connecting_rod(joints: Joints, frame: int, link: int) -> bool:
    joined = any({frame, link} <= set(joint.links) for joint in joints.joints)
    return not joined and link != frame


def _letters_of(joints: Joints, link: int) -> str:
    """Return the letters of a link's joints, R first."""
    return "".join(sorted((joint.code for joint in joints.joints if link in joint.links), reverse=True))


# Counting takes a fifth of a second for a group of eight links, and some twelve times as long for each two more.
MOST_COUNTED = 8


@checked
def structure_name(structure: Structure) -> ChainName:
    """Return what a mechanism is called, with its frame and its drivers. A roller is a part of its follower.

    >>> from compoundkin.files import load
    >>> from compoundkin.structure import decompose
    >>> structure_name(decompose(load("stephenson-iii"))).title
    'Stephenson III'
    """
    spun = {spin.link: spin.on for spin in structure.passive}
    return named(structure_joints(structure), FRAME, [spun.get(d.link, d.link) for d in structure.mechanism.drives])


def structure_joints(structure: Structure) -> Joints:
    """Return a structure's links and joints, rollers merged with their followers."""
    joints = _joints(structure.mechanism.links, _edges(structure))
    for spin in structure.passive:
        joints = joints.merged(spin.link, spin.on)
    return joints


@checked
def group_truss(group: Group) -> tuple[str, ...]:
    """Return the Baranov trusses that a group is made of. What it is attached to taken for one link more.

    Several where multiple pins stand for several; none where no list has it. Higher pairs count as binary links.

    >>> from compoundkin.files import load
    >>> from compoundkin.structure import decompose
    >>> group_truss(decompose(load("class-iii-six-bar")).groups[0])
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
    return _joints(graph, graph.edges(data=True))


def _edges(structure: Structure) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
    """Yield the edges of the kinematic graph in its order, which is by their first links."""
    beside: dict[str, dict[str, list[Pair]]] = {name: {} for name in structure.mechanism.links}
    for pair in structure.pairs:
        first, second = pair.members[:2]
        between = beside[first].setdefault(second, [])
        between.append(pair)
        beside[second][first] = between
    done: set[str] = set()
    for first, others in beside.items():
        for second, between in others.items():
            yield from ((first, second, {"pair": pair, "code": pair.code}) for pair in between if second not in done)
        done.add(first)


def _joints(links: Collection[Any], edges: Iterable[tuple[Any, Any, Mapping[str, Any]]]) -> Joints:
    number = {link: k for k, link in enumerate(links)}
    pins: dict[object, list[int]] = {}
    joints: list[Joint] = []
    for first, second, data in edges:
        ends = [number[first], number[second]]
        pin = _pin(data)
        if pin is None:
            joints.append(_joint(ends, data, number))
        else:
            pins.setdefault(pin, []).extend(ends)
    pinned = [Joint(tuple(sorted(set(ends)))) for ends in pins.values()]
    return Joints(tuple(str(link) for link in links), (*pinned, *joints))


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

    >>> from compoundkin.files import load
    >>> from compoundkin.structure import decompose
    >>> group_count(decompose(load("class-iii-six-bar")).groups[0])
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
