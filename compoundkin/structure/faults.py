"""Over- and under-constrained parts, named. Which links, by how much, and what to add or remove."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from compoundkin.model.elements import Drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_drivable
from compoundkin.structure.composites import GROUND, spanned
from compoundkin.structure.cycles import find
from compoundkin.structure.matching import Matching
from compoundkin.structure.mobility_count import Body, DrivenPair, Fault
from compoundkin.structure.rank import Deficiency, RankTest, Subsystem
from compoundkin.structure.system import POINT_FREEDOMS, Constraint, System, constraining_pairs

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
        excess = _number(amount, "constraint")
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
        excess = _number(found.redundant, "constraint")
        text = f"{_listed(links)} {_are(links)} kept from turning by {excess} too many, in loops of slides alone"
        return Fault("over", links, found.redundant, text, "nothing has to be changed: they move all the same")
    text = f"{_listed(links)} {_are(links)} held by {_number(found.redundant, 'constraint')} too many"
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
    text = f"{_listed(links)} {_are(links)} left with {_number(found.free, 'freedom')}"
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
        return f"hold {_number(amount, 'freedom')} by further pairs"
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
        return f"{'the ' + word if word == 'driver' else _number(amount, word) + ' of the pair'} {names[0]}"
    count = "one" if amount == 1 else str(amount)
    return f"{count} {among} {_listed(names)}"


def _either(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"one of {_listed(names)}"


def _are(links: Sequence[str]) -> str:
    return "is" if len(links) == 1 else "are"


def _number(amount: int, word: str) -> str:
    return f"{amount} {word}{'' if amount == 1 else 's'}"
