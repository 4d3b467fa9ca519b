"""Taking a mechanism apart. Driven links, then Assur groups in solving order, and what stands in the way.

Constraints are assigned to the unknowns they determine (a maximum matching); an unknown depends on the
other members of the constraints assigned to it; the strongly connected components of that dependency, in
order, are the groups. They are the fine blocks of Dulmage and Mendelsohn, whichever matching was found.
A matching alone can be fooled (s links may hold at most 3 s - 3 among themselves, loops of slides less than
they count), so each component is confirmed by the rank of its constraint Jacobian at a random generic pose.

Sources: A. L. Dulmage and N. S. Mendelsohn, Canad. J. Math. 10 (1958) 517; A. Sljoka, O. Shai and
W. Whiteley, Checking mobility and decomposition of linkages via pebble game algorithm, ASME DETC 2011.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from compoundkin.base.arguments import checked
from compoundkin.base.buffers import without_collection
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidMechanism
from compoundkin.base.linear import one_thread
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_drivable
from compoundkin.structure.assur_groups import Binder, all_pairs
from compoundkin.structure.composites import GROUND, composites, spanned
from compoundkin.structure.cycles import find
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.matching import (
    Matching,
    maximum_matching,
    overdetermined,
    solving_order,
    strong_components,
    underdetermined,
)
from compoundkin.structure.mobility_count import Body, DrivenPair, Fault, Group, Relaxation, mobility_of
from compoundkin.structure.rank import Deficiency, RankTest, Subsystem
from compoundkin.structure.system import POINT_FREEDOMS, Constraint, System, constraining_pairs, system_of


@checked
@one_thread
def decompose(mechanism: Mechanism) -> Structure:
    """Take a mechanism apart into driven links and Assur groups in solving order.

    Nothing is raised for a mechanism that is over- or under-constrained: `faults` name the links, by how
    much, and a remedy. One that moves though it is overconstrained is taken apart as it is solved, without what is
    redundant, which `relaxation` names; that alone depends on dimensions. The work grows about linearly with the number
    of links.

    >>> from compoundkin.model.elements import drive, link
    >>> four_bar = Mechanism(
    ...     "Four-bar",
    ...     link("frame", A=(0, 0), D=(4, 0)),
    ...     link("crank", A=(0, 0), B=(1, 0)),
    ...     link("coupler", B=(0, 0), C=(3, 0)),
    ...     link("rocker", D=(0, 0), C=(3, 0)),
    ...     drive("crank"),
    ... )
    >>> [(group.name, group.links) for group in decompose(four_bar).groups]
    [('RRR', ('coupler', 'rocker'))]
    """
    return _moving(mechanism, everywhere=True)


@one_thread
def decompose_near_drawing(mechanism: Mechanism) -> Structure:
    """Take a mechanism apart as `decompose` does, in a time that is bounded: for who asks at each step of a drawing.

    Whether it moves though it is overconstrained is only looked for near the drawing, where random starts may take
    seconds, most of all with cams.
    """
    return _moving(mechanism, everywhere=False)


def _moving(mechanism: Mechanism, everywhere: bool) -> Structure:
    with without_collection():
        structure = decomposed(mechanism)
    if not any(fault.kind == "over" for fault in structure.faults):
        return structure
    if mechanism.unplaced:
        return replace(structure, faults=tuple(map(_at_general_dimensions, structure.faults)))
    # what looks at dimensions is loaded for those few that need it
    from compoundkin.structure.redundancy.diagnosis import without_redundancy

    return without_redundancy(structure, decomposed, everywhere)


def _at_general_dimensions(fault: Fault) -> Fault:
    """Return a fault of a mechanism without dimensions, which say whether what is too much follows from the rest."""
    if fault.kind != "over":
        return fault
    return replace(fault, remedy=f"{fault.remedy}, or give dimensions at which it moves")


def without_leads(structure: Structure) -> Structure:
    """Return the structure of the mechanism itself, nothing led."""
    try:
        return (
            decompose(structure.mechanism.without_prescribed_motion())
            if structure.mechanism.prescribed_motions
            else structure
        )
    except InvalidMechanism:  # of links that nothing else joins
        return structure


def decomposed(mechanism: Mechanism, relaxation: Relaxation | None = None) -> Structure:
    """Take a mechanism apart whatever its dimensions, some parts of pairs left out."""
    dropped = relaxation.dropped if relaxation else ()
    bodies = composites(mechanism)
    system = system_of(mechanism, bodies, dropped)
    matching = maximum_matching(system.rows, system.freedoms)
    coarse = _Coarse(overdetermined(matching), underdetermined(matching))
    groups, faults = _groups(system, matching, coarse)
    faults = [*closed_drives(system), *counted_faults(system, matching, coarse.over, coarse.under), *faults]
    pairs = all_pairs(system, groups, [part.kept for part in dropped if part.kept is not None])
    mobility = mobility_of(mechanism, pairs, bodies.passive)
    found = tuple(groups), mobility, tuple(faults), bodies.passive
    return Structure(mechanism, pairs, bodies.ground, *found, relaxation)


@dataclass(frozen=True)
class _Coarse:
    """Which unknowns are overconstrained and which are left free. The others are well determined."""

    over: list[bool]
    under: list[bool]


def _groups(system: System, matching: Matching, coarse: _Coarse) -> tuple[list[Group], list[Fault]]:
    """Return the groups in solving order, and faults of components that only seem determined."""
    binder, test = Binder(system), RankTest(system)
    _locate_overdetermined(system, binder, coarse.over)
    groups: list[Group] = []
    faults: list[Fault] = []
    for part in _parts_in_order(system, matching, coarse):
        binder.locate(part.unknowns, part.constraints)
        if not system.is_body(part.unknowns[0]):
            continue
        found = test.deficiency(part)
        if found is None:
            groups.append(binder.group(part.unknowns, part.constraints))
        else:
            faults += rank_faults(system, part, found)
    return groups, faults


def _locate_overdetermined(system: System, binder: Binder, over: list[bool]) -> None:
    unknowns = [k for k, marked in enumerate(over) if marked]
    if unknowns:
        held = [c for c in system.constraints if c.unknowns and all(over[u] for u in c.unknowns)]
        binder.locate(unknowns, held)


def _parts_in_order(system: System, matching: Matching, coarse: _Coarse) -> list[Subsystem]:
    determined = [not (o or u) for o, u in zip(coarse.over, coarse.under, strict=True)]
    successors = [_depends_on(matching, u, determined) if yes else [] for u, yes in enumerate(determined)]
    components = [c for c in strong_components(successors) if determined[c[0]]]
    # a pin on its own is located the moment its body is
    rank = [c[0] if system.is_body(c[0]) else -1 for c in components]
    order = solving_order(components, successors, rank)
    return [_part(system, matching, components[k]) for k in order]


def _depends_on(matching: Matching, unknown: int, determined: Sequence[bool]) -> list[int]:
    members = [v for row in matching.owned[unknown] for v in matching.rows[row] if determined[v]]
    return [v for v in dict.fromkeys(members) if v != unknown]


def _part(system: System, matching: Matching, unknowns: Sequence[int]) -> Subsystem:
    numbers = sorted({system.constraint_of[row] for u in unknowns for row in matching.owned[u]})
    return Subsystem(tuple(unknowns), tuple([system.constraints[k] for k in numbers]))


# How many alternatives a remedy lists.
_LISTED = 6


def closed_drives(system: System) -> Iterator[Fault]:
    """Find composites that close on themselves. Driven pairs in a ring, or pairs across a driven chain."""
    body_of = system.bodies.body_of
    pairs: dict[int, list[Pair]] = {}
    for pair in constraining_pairs(system.mechanism, system.dropped):
        inside = {body_of[name] for name in pair.members}
        if len(inside) == 1:
            pairs.setdefault(inside.pop(), []).append(pair)
    drives: dict[int, list[Drive]] = {}
    for drive in system.bodies.closing:
        drives.setdefault(body_of[drive.link], []).append(drive)
    for index in range(GROUND, len(system.bodies.moving)):
        body = system.bodies.body(index)
        if len(body.links) > 1:
            yield from _closed(system, body, pairs.get(index, []), drives.get(index, []))


def _closed(system: System, body: Body, pairs: Sequence[Pair], drives_inside: Sequence[Drive]) -> Iterator[Fault]:
    in_tree = {step.pair.name for step in body.driven}
    across = dict(_letters_twice(system, body))
    across.update({_meant(system, p): (p.held, p.members) for p in pairs if p.name not in in_tree})
    closing = {drive.name: (1, (drive.on, drive.link)) for drive in drives_inside}
    if across or closing:
        extra = [*across.values(), *closing.values()]
        amount = sum(held for held, _ in extra)
        drives = spanned(body, [link for _, links in extra for link in links])
        links = tuple(dict.fromkeys(_between(drives))) or body.links
        excess = count_phrase(amount, "constraint")
        text = f"{_listed(links)}: driven links close on themselves, held by {excess} too many"
        names = [*(step.drive.name for step in drives if not step.is_passive), *closing]
        ways = [f"remove {_of(amount, names, 'driver')}"] if names else []
        remedy = " or ".join([*ways, *([f"take apart {_either(list(across))}"] if across else [])])
        yield Fault("over", links, amount, text, remedy)


def _meant(system: System, pair: Pair) -> str:
    """Return the name of the written pair that a pair is or stands for."""
    return next((part.name for part in system.dropped if part.kept is pair), pair.name)


def _letters_twice(system: System, body: Body) -> Iterator[tuple[str, tuple[int, tuple[str, ...]]]]:
    """Yield letters that links of a composite share without being driven there."""
    links: dict[str, list[str]] = {}
    for name in body.links:
        for letter in system.mechanism.links[name].points:
            links.setdefault(letter, []).append(name)
    driven_at: dict[str, list[DrivenPair]] = {}
    for step in body.driven:
        driven_at.setdefault(step.pair.letters[0], []).append(step)
    for letter, names in links.items():
        if len(names) == 1:
            continue
        leader = {name: name for name in names}
        for step in driven_at.get(letter, []):
            if step.link in leader and step.parent in leader:
                leader[find(leader, step.link)] = find(leader, step.parent)
        parts = sum(1 for name in names if find(leader, name) == name)
        if parts > 1:
            yield letter, (POINT_FREEDOMS * (parts - 1), tuple(names))


def counted_faults(system: System, matching: Matching, over: list[bool], under: list[bool]) -> Iterator[Fault]:
    """Find the parts that are overconstrained by count, and those left free."""
    touching: list[list[Constraint]] = [[] for _ in over]
    free = [unknown for unknown, yes in enumerate(under) if yes]
    owned_by_under = {system.constraint_of[row] for unknown in free for row in matching.owned[unknown]}
    for number, constraint in enumerate(system.constraints):
        over_held = bool(constraint.unknowns) and all(over[u] for u in constraint.unknowns)
        if over_held or number in owned_by_under:
            for unknown in constraint.unknowns:
                touching[unknown].append(constraint)
    for marked in (over, under):
        for unknowns in _connected(marked, touching):
            constraints = {id(c): c for u in unknowns for c in touching[u]}
            yield from _part_faults(system, Subsystem(tuple(unknowns), tuple(constraints.values())))


def _connected(marked: list[bool], touching: list[list[Constraint]]) -> Iterator[list[int]]:
    left = dict.fromkeys(u for u, yes in enumerate(marked) if yes)
    while left:
        first = next(iter(left))
        del left[first]
        part = [first]
        for unknown in part:
            for other in (v for c in touching[unknown] for v in c.unknowns if v in left):
                del left[other]
                part.append(other)
        yield sorted(part)


def _part_faults(system: System, part: Subsystem) -> Iterator[Fault]:
    yield from rank_faults(system, part, RankTest(system).analysed(part))


def rank_faults(system: System, part: Subsystem, found: Deficiency) -> Iterator[Fault]:
    """Find what is redundant and what is free in a part. Both where its pairs hold less than they count."""
    if found.redundant:
        yield _over(system, found)
    if found.free:
        yield _under(system, part, found)


def _between(drives: Iterable[DrivenPair]) -> list[str]:
    return [name for step in drives for name in (step.parent, step.link)]


def _over(system: System, found: Deficiency) -> Fault:
    touched = [link for constraint in found.tight for link in _links_of(system, constraint)]
    by_body: dict[int, list[str]] = {}
    for link in touched:
        by_body.setdefault(system.bodies.body_of[link], []).append(link)
    drives = [s for body, on_it in by_body.items() for s in spanned(system.bodies.body(body), on_it)]
    links = _in_input_order(system, [*touched, *_between(drives)])
    if found.turning and not any(step.pair.free_is_angle for step in drives):
        excess = count_phrase(found.redundant, "constraint")
        text = f"{_listed(links)} {_are(links)} kept from turning by {excess} too many, in loops of slides alone"
        return Fault("over", links, found.redundant, text, "nothing has to be changed: they move all the same")
    text = f"{_listed(links)} {_are(links)} held by {count_phrase(found.redundant, 'constraint')} too many"
    pairs = dict.fromkeys(c.letter or _meant(system, c.pair) for c in found.tight if not system.is_thought(c))
    return Fault("over", links, found.redundant, text, _over_remedy(system, found.redundant, drives, list(pairs)))


def _over_remedy(system: System, amount: int, drives: Sequence[DrivenPair], pairs: Sequence[str]) -> str:
    names = list(dict.fromkeys(step.drive.name for step in drives if not step.is_passive))
    free = f"free {_of(amount, pairs, 'coordinate', 'of the pairs')}"
    led = [k for k, item in system.mechanism.prescribed_motions.items() if len({*item.drivers.values()} & {*names}) > 1]
    drivers = _of(amount, names, "driver") + (f" (lead {_listed(led)} by x or y alone)" if led else "")
    return f"remove {drivers} or {free}" if names else f"{free} or take out a link"


def _under(system: System, part: Subsystem, found: Deficiency) -> Fault:
    bodies = [system.bodies.moving[u] for u in found.loose if system.is_body(u)]
    links = _in_input_order(system, [name for body in bodies for name in body.links])
    text = f"{_listed(links)} {_are(links)} left with {count_phrase(found.free, 'freedom')}"
    own = set(part.unknowns)
    if not any(side not in own for constraint in part.constraints for side in constraint.sides):
        remedy = f"join {_listed(links)} to the frame by a pair"
    else:
        moving = (constraint for constraint in found.moving if not system.is_thought(constraint))
        choices = [choice for constraint in moving for choice in _drivable(system, constraint)]
        remedy = _under_remedy(found.free, sorted(choices, key=lambda text: " on frame (" not in text))
    slips = system.mechanism.case_slips()
    asked = f"did you mean {slips[0][0]!r} and {slips[0][1]!r} to be one letter? else " if slips else ""
    return Fault("under", links, found.free, text, asked + remedy)


def _under_remedy(amount: int, choices: Sequence[str]) -> str:
    if not choices:
        return f"hold {count_phrase(amount, 'freedom')} by further pairs"
    wanted = "a driver on one of" if amount == 1 else f"{amount} drivers among"
    return f"add {wanted}: {_listed(choices)}"


def _drivable(system: System, constraint: Constraint) -> Iterator[str]:
    """Yield where a driver could be put: "crank on frame (pin A)"."""
    links = _links_of(system, constraint)
    if constraint.letter and len(links) == 1:
        other = system.neighbour(constraint.letter, constraint.sides[1])
        links = (system.carrier(constraint.letter, other), *links)
    if len(links) == 2 and as_drivable(constraint.pair):
        kind = "pin " if constraint.letter else ""
        yield f"{links[1]} on {links[0]} ({kind}{constraint.letter or constraint.pair.name})"


def _links_of(system: System, constraint: Constraint) -> tuple[str, ...]:
    if not constraint.letter:
        return constraint.pair.members
    bodies = [side for side in constraint.sides if side == GROUND or system.is_body(side)]
    return tuple(system.carrier(constraint.letter, body) for body in bodies)


def _in_input_order(system: System, links: Iterable[str]) -> tuple[str, ...]:
    """Return the links once each; the frame only if it is alone."""
    moving = set(links) - {FRAME, *system.mechanism.auxiliary_links}
    return tuple(sorted(moving, key=system.place_of.__getitem__)) or (FRAME,)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:_LISTED]) + (f" and {len(names) - _LISTED} more" if len(names) > _LISTED else "")


def _of(amount: int, names: Sequence[str], word: str, among: str = "") -> str:
    """Write "driver a" or "one of the drivers a, b", with their number."""
    among = among or f"of the {word}s"
    if len(names) == 1:
        return f"{'the ' + word if word == 'driver' else count_phrase(amount, word) + ' of the pair'} {names[0]}"
    count = "one" if amount == 1 else str(amount)
    return f"{count} {among} {_listed(names)}"


def _either(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"one of {_listed(names)}"


def _are(links: Sequence[str]) -> str:
    return "is" if len(links) == 1 else "are"
