"""Every choice of frame and drivers as a table, and which of them make a mechanism dyadic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compoundkin.base.errors import InvalidInput
from compoundkin.model.elements import FRAME
from compoundkin.structure import Structure, roman
from compoundkin.synthesis.alternatives import MOST_CHOICES, Alternative, alternatives
from compoundkin.view.report.report_data import Column, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted

# Of more ways to the same end a reader needs the first only.
LISTED = 4
_NONE = "By count it has no freedom, so that there is nothing to drive."


def alternatives_section(structure: Structure) -> Section:
    """All choices of frame and drivers; of a large mechanism those with its present frame."""
    try:
        found, about = alternatives(structure), "Every link as the frame, every pair as the driven one"
    except InvalidInput:
        found, about = _with_present_frame(structure), "The frame as it is, every pair as the driven one"
    return Section("alternatives", "Alternatives", tuple(_blocks(structure, found, about)))


def _with_present_frame(structure: Structure) -> tuple[Alternative, ...]:
    try:
        return alternatives(structure, [FRAME])
    except InvalidInput:
        return ()


def _blocks(structure: Structure, found: Sequence[Alternative], about: str) -> Iterator[Paragraph | TableBlock]:
    if not found:
        many = f"There are more than {MOST_CHOICES} choices: too many for a table."
        yield Paragraph(_NONE if structure.mobility.freedoms < 1 else many)
        return
    total = sum(choice.alike for choice in found)
    text = f"{about}: {counted(total, 'choice')}, {len(found)} of them different."
    yield Paragraph(f"{text} What is found holds for generic dimensions; * marks the present choice.")
    yield from (Paragraph(sentence) for sentence in _sentences(found))
    columns = (Column("frame"), Column("driven"), Column("name"), Column("groups"), Column("class"),
               Column("configurations", style="each"), Column("closed form"),
               Column("alike", style="each"))  # fmt: skip
    yield TableBlock(columns, tuple(_row(choice) for choice in found))


def _sentences(found: Sequence[Alternative]) -> Iterator[str]:
    """What to drive or to fix instead where the present choice is not dyadic."""
    present = next((choice for choice in found if choice.present), None)
    if present is not None and present.dyadic:
        yield "The mechanism is dyadic as it is."
        return
    dyadic = [choice for choice in found if choice.dyadic]
    drives = ["; ".join(map(str, choice.drivers)) for choice in dyadic if choice.frame == FRAME]
    if drives:
        yield f"Drive {_or(drives)} instead and the mechanism becomes dyadic."
    elif dyadic:
        ways = [f"fix {choice.frame} and drive {'; '.join(map(str, choice.drivers))}" for choice in dyadic]
        yield f"With this frame no driver makes the mechanism dyadic, but {_or(ways)} and it becomes so."
    else:
        yield "No choice makes the mechanism dyadic."


def _or(texts: Sequence[str]) -> str:
    more = f" (or {len(texts) - LISTED} others)" if len(texts) > LISTED else ""
    return ", or ".join(texts[:LISTED]) + more


def _row(choice: Alternative) -> tuple[str | int | None, ...]:
    drivers = "; ".join(map(str, choice.drivers)) + (" *" if choice.present else "")
    if choice.faults:
        return choice.frame, drivers, choice.title, "not determined", "-", None, "-", choice.alike
    groups = ", ".join(name for name, _, _ in choice.groups)
    closed = "yes" if choice.closed else "no"
    return (choice.frame, drivers, choice.title, groups or "-", roman(choice.class_), choice.configurations, closed,
            choice.alike)  # fmt: skip
