"""What a mechanism is called by its structure, and what follows from its graph alone."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.structure import Group, Structure
from compoundkin.synthesis.chains import ChainName, group_truss, structure_name
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS
from compoundkin.synthesis.chains.mechanism_names import MOST_COMPARED
from compoundkin.view.report.report_data import Section, StepBlock
from compoundkin.view.report.wording import counted, listed

# More classes of links or more names than these are counted instead of written out.
MANY = 8
_DYAD = 2
_LOWER = 2


def chain_section(structure: Structure) -> Section:
    """The kinematic chain: its name, driven link, assortment, variety, symmetry, and the trusses of larger groups."""
    name = structure_name(structure)
    return Section("chain", "Kinematic chain", (StepBlock(name.title, tuple(_facts(structure, name))),))


def _facts(structure: Structure, name: ChainName) -> Iterator[tuple[str, str]]:
    if name.also:
        yield "such as", listed(name.also)
    drives = structure.mechanism.drives
    if drives:
        kinds = name.driven.split(", ")
        yield "driven at", "; ".join(f"{drive.link}, a {kind}" for drive, kind in zip(drives, kinds, strict=True))
    yield "links", name.assortment
    if name.derived_from and len(name.derived_from) <= MANY:
        yield "derived from", " or ".join(name.derived_from)
    if name.variety is not None:
        yield "variety", f"degree {name.variety}{_variety(name.variety)}"
    if name.parts:
        yield (
            "parts",
            f"{'; '.join(name.parts)}"
            + (f"; joined at {', '.join(name.fractionated_at)}" if name.fractionated_at else ""),
        )
    yield from _symmetry(structure, name)
    yield from _trusses(structure)
    if name.mobility < 1 and not name.title.startswith("wedge"):
        yield "by count", "rigid: if it moves, its dimensions are special or slides alone close a loop"


def _unlisted(group: Group) -> str:
    """Why a group has no truss in the list; up to some links that is complete."""
    if len(group.bodies) < MOST_LINKS and all(pair.held == _LOWER for pair in (*group.inner, *group.outer)):
        return "no Baranov truss, for a part of it is rigid on its own, as a driver between moving links makes it"
    return "a truss that is in no list"


def _variety(degree: int) -> str:
    return ": no driver can be without effect on a loop" if degree == 0 else ""


def _symmetry(structure: Structure, name: ChainName) -> Iterator[tuple[str, str]]:
    if not name.symmetries:
        yield "symmetry", f"not looked for among more than {MOST_COMPARED} links"
        return
    classes = [links for links in name.equivalent_links if len(links) > 1]
    if not classes:
        yield "symmetry", "no two links are alike"
    elif len(classes) > MANY or sum(map(len, classes)) > 2 * MANY:
        yield "symmetry", f"{counted(name.symmetries, 'way')} to lay the chain upon itself"
    else:
        yield "symmetry", "alike are " + "; ".join(listed(links) for links in classes)


def _trusses(structure: Structure) -> Iterator[tuple[str, str]]:
    """The Baranov truss of each group larger than a dyad, groups numbered in solving order."""
    larger = [(k, group) for k, group in enumerate(structure.groups, 1) if len(group.bodies) > _DYAD]
    for k, group in larger[:MANY]:
        trusses = group_truss(group)
        yield f"group {k}", f"{group.name}: {' or '.join(trusses) or _unlisted(group)}"
    if len(larger) > MANY:
        yield "groups", f"{len(larger) - MANY} more are larger than dyads"
