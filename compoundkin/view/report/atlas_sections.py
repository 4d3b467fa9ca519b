"""Lists of kinematic chains, trusses and groups; every other choice of frame and drivers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.geometry import FRAME
from compoundkin.structure import Structure, roman
from compoundkin.synthesis.alternatives import MOST_CHOICES, Alternative, alternatives
from compoundkin.synthesis.chains import AssurGroup, Chain, assur_groups, chain_name, chains, inversions, trusses
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS
from compoundkin.view.report.report_data import NOT_SOLVED, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import counted

# The longest lists: eleven links take some seconds, twelve half a minute.
MOST_MADE = 12
# A group has one link less than its truss; those with more links are not listed.
MOST_IN_GROUP = 8
_FEWEST = 3
_MOST_MOBILITY = 3
# At most so many alternatives are listed.
LISTED = 4
_NO_FREEDOM = "By count it has no freedom, so that there is nothing to drive."


def atlas_report(
    links: int, mobility: int = 1, with_inversions: bool = False, with_trusses: bool = False, with_groups: bool = False
) -> Report:
    """Report the chains with a number of links and a mobility, with inversions, trusses and groups.

    With `with_trusses` or `with_groups` these are listed instead of chains, unless inversions are requested too. Raises
    InvalidInput for numbers of links without a list.

    >>> report = atlas_report(6)
    >>> [section.key for section in report.sections], len(report.sections[0].blocks[1].rows)
    (['chains'], 2)
    """
    _check_numbers(links, mobility, with_groups)
    sections = []
    if with_inversions or not (with_trusses or with_groups):
        sections.append(Section("chains", "", tuple(_chains(chains(links, mobility, patient=True), links, mobility))))
    if with_inversions:
        sections.append(Section("inversions", "Inversions", tuple(_inversions(links, mobility))))
    if with_trusses:
        sections.append(Section("trusses", "Baranov trusses", tuple(_trusses(links))))
    if with_groups:
        sections.append(Section("assur_groups", "Assur groups", tuple(_groups(links))))
    return Report(f"Atlas: {links} links", tuple(sections), NOT_SOLVED)


def _check_numbers(links: int, mobility: int, with_groups: bool) -> None:
    if not _FEWEST - with_groups <= links <= MOST_MADE:
        what = f"there is no list of chains with {links} links"
        raise InvalidInput(Problem("--links", what, f"give {_FEWEST} to {MOST_MADE}; up to {MOST_LINKS} are at hand"))
    if not 0 <= mobility <= _MOST_MOBILITY:
        what = f"there is no list of chains of mobility {mobility}"
        raise InvalidInput(Problem("--mobility", what, f"give 0 (trusses) to {_MOST_MOBILITY}"))
    if with_groups and not 2 <= links <= MOST_IN_GROUP:
        what = f"there is no list of Assur groups with {links} links"
        raise InvalidInput(Problem("--links", what, f"give an even number from 2 to {MOST_IN_GROUP}"))


def _chains(found: Sequence[Chain], links: int, mobility: int) -> Iterator[Block]:
    yield Paragraph(
        f"{counted(len(found), 'chain')} of {links} links and mobility {mobility}.{_parity(links, mobility, found)}"
    )
    yield from _table(found)


def _parity(links: int, mobility: int, found: Sequence[Chain]) -> str:
    odd = (3 * (links - 1) - mobility) % 2
    return f" F = 3 (n - 1) - 2 p leaves no whole number of pairs for n = {links}." if odd and not found else ""


def _trusses(links: int) -> Iterator[Block]:
    found = trusses(links)
    yield Paragraph(
        f"{counted(len(found), 'truss').replace('trusss', 'trusses')} of {links} links.{_parity(links, 0, found)}"
    )
    yield from _table(found)


def _table(found: Sequence[Chain]) -> Iterator[TableBlock]:
    if found:
        columns = (Column("number", style="each"), Column("name"), Column("links by pairs"),
                   Column("symmetry", style="each"), Column("inversions", style="each"), Column("graph6"),
                   Column("pairs"))  # fmt: skip
        yield TableBlock(columns, tuple(_row(k, chain) for k, chain in enumerate(found, 1)))


def _row(k: int, chain: Chain) -> tuple[Cell, ...]:
    name = chain_name(chain) or f"{chain.links}-link chain"
    pairs = " ".join(f"{first}-{second}" for first, second in chain.pairs)
    return k, name, chain.assortment_text, chain.symmetries, len(chain.inversions), chain.graph6, pairs


def _inversions(links: int, mobility: int) -> Iterator[Block]:
    found = inversions(links, mobility, patient=True)
    yield Paragraph(f"{counted(len(found), 'inversion')}: links that symmetry makes alike are fixed once.")
    columns = Column("name"), Column("graph6"), Column("frame, link", style="each"), Column("its pairs", style="each")
    rows = tuple((chain_name(one.chain, one.frame), one.chain.graph6, one.frame, one.chain.degrees[one.frame])
                 for one in found)  # fmt: skip
    if rows:
        yield TableBlock(columns, rows)


def _groups(links: int) -> Iterator[Block]:
    found = assur_groups(links) if links % 2 == 0 else ()
    odd = " A group of pins has an even number of links." if links % 2 else ""
    yield Paragraph(f"{counted(len(found), 'Assur group')} of {links} links and revolute pairs.{odd}")
    columns = (Column("name"), Column("order", style="each"), Column("truss"), Column("less link", style="each"),
               Column("pairs; outer ones by their link"))  # fmt: skip
    rows = tuple(_group_row(k, group) for k, group in enumerate(found, 1))
    if rows:
        yield TableBlock(columns, rows)


def _group_row(k: int, group: AssurGroup) -> tuple[Cell, ...]:
    pairs = _group_pairs(group.truss, group.removed)
    return f"{group.links}-link group {k}", group.outer, chain_name(group.truss), group.removed, pairs


def _group_pairs(truss: Chain, removed: int) -> str:
    """Return the pairs of a group, its links numbered from 0 in the order in which `Composer.attach` names them."""
    number = {link: k for k, link in enumerate(link for link in range(truss.links) if link != removed)}
    inner = [f"{number[a]}-{number[b]}" for a, b in truss.pairs if removed not in (a, b)]
    outer = [str(number[link]) for link in truss.neighbours[removed]]
    return f"{' '.join(inner)}; {' '.join(outer)}"


def alternatives_section(structure: Structure) -> Section:
    """Return all choices of frame and drivers. A large mechanism keeps its present frame."""
    try:
        found, about = alternatives(structure), "Every link as the frame, every pair as the driven one"
    except InvalidInput:
        found, about = _with_present_frame(structure), "The frame as it is, every pair as the driven one"
    return Section("alternatives", "Alternatives", tuple(_alternative_blocks(structure, found, about)))


def _with_present_frame(structure: Structure) -> tuple[Alternative, ...]:
    try:
        return alternatives(structure, [FRAME])
    except InvalidInput:
        return ()


def _alternative_blocks(
    structure: Structure, found: Sequence[Alternative], about: str
) -> Iterator[Paragraph | TableBlock]:
    if not found:
        many = f"There are more than {MOST_CHOICES} choices: too many for a table."
        yield Paragraph(_NO_FREEDOM if structure.mobility.freedoms < 1 else many)
        return
    total = sum(choice.alike for choice in found)
    text = f"{about}: {counted(total, 'choice')}, {len(found)} of them different."
    yield Paragraph(f"{text} What is found holds for generic dimensions; * marks the present choice.")
    yield from (Paragraph(sentence) for sentence in _sentences(found))
    columns = (Column("frame"), Column("driven"), Column("name"), Column("groups"), Column("class"),
               Column("configurations", style="each"), Column("closed form"),
               Column("alike", style="each"))  # fmt: skip
    yield TableBlock(columns, tuple(_choice_row(choice) for choice in found))


def _sentences(found: Sequence[Alternative]) -> Iterator[str]:
    """Yield which driver or frame would make the mechanism dyadic."""
    present = next((choice for choice in found if choice.present), None)
    if present is not None and present.dyadic:
        yield "The mechanism is dyadic as it is."
        return
    dyadic = [choice for choice in found if choice.dyadic]
    drives = ["; ".join(map(str, choice.drivers)) for choice in dyadic if choice.frame == FRAME]
    if drives:
        yield f"Drive {_joined_by_or(drives)} instead and the mechanism becomes dyadic."
    elif dyadic:
        ways = [f"fix {choice.frame} and drive {'; '.join(map(str, choice.drivers))}" for choice in dyadic]
        yield f"With this frame no driver makes the mechanism dyadic, but {_joined_by_or(ways)} and it becomes so."
    else:
        yield "No choice makes the mechanism dyadic."


def _joined_by_or(texts: Sequence[str]) -> str:
    more = f" (or {len(texts) - LISTED} others)" if len(texts) > LISTED else ""
    return ", or ".join(texts[:LISTED]) + more


def _choice_row(choice: Alternative) -> tuple[str | int | None, ...]:
    drivers = "; ".join(map(str, choice.drivers)) + (" *" if choice.present else "")
    if choice.faults:
        return choice.frame, drivers, choice.title, "not determined", "-", None, "-", choice.alike
    groups = ", ".join(name for name, _, _ in choice.groups)
    closed = "yes" if choice.closed else "no"
    return (choice.frame, drivers, choice.title, groups or "-", roman(choice.class_), choice.configurations, closed,
            choice.alike)  # fmt: skip
