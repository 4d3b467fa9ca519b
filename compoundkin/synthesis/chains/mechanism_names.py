"""What a mechanism is called by its structure. Its chain, its inversion, what it derives from, its symmetries."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from compoundkin.base.arguments import checked
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.synthesis.chains.chain_names import derived_names, has_rigid_part, variety_of
from compoundkin.synthesis.chains.coloured_graphs import assorted, ordinal
from compoundkin.synthesis.chains.joints import REVOLUTE, SLIDE, Joint, Joints
from compoundkin.synthesis.chains.slide_names import slider_name

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
