"""What can be wrong with joints as a whole, and which of them is driven."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from compoundkin.files.exchange.pmks.joint_record import JointRecord
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.geometry import FRAME

_NUMBERS = {3: "three", 4: "four", 5: "five", 6: "six"}


def note_faults(records: Sequence[JointRecord], problems: Problems, ground: str = "no ground link") -> None:
    """Note what is wrong with the links of joints."""
    if not records and not problems.found:
        problems.add("", "there are no joints", "look whether it is the right file")
    # where a record could not be read, the ground may have been in it
    if records and not problems.found and not any(FRAME in record.links for record in records):
        problems.add("", ground, "call the link that stands still ground")
    for record in records:
        if not record.links:
            problems.add(record.where, f"this {record.kind} joint names no link")
        elif len(set(record.links)) < len(record.links):
            twice = next(name for name in record.links if record.links.count(name) > 1)
            problems.add(record.where, f"a joint of the link {twice.strip()!r} with itself", "name another link")
        elif record.kind in ("P", "G") and len(record.links) > 2:
            count = _NUMBERS.get(len(record.links), str(len(record.links)))
            problems.add(record.where, f"{count} links at a {record.kind} joint", "it joins two; add R joints")
        elif record.kind == "G" and len(record.links) < 2:
            problems.add(record.where, "one link at a gear contact", "it names the two wheels")


def drivers_of(
    records: Sequence[JointRecord], index: float | None, problems: Problems, several: bool = False
) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """Return the numbers of the joints that drive, and notes on them.

    It is the first of those that are marked, unless `several` may drive.
    """
    if index is not None:
        if index in range(len(records)):
            return _that_drive(records, [int(index)], problems), ()
        problems.add("d", f"there is no joint {index:g}", f"joints are 0 to {len(records) - 1}")
        return (), ()
    marked = [k for k, record in enumerate(records) if record.drives]
    if marked and (several or len(marked) == 1):
        return _that_drive(records, marked, problems), ()
    if marked:
        notes = (f"several joints are marked as driven, that of {records[marked[0]].where} is taken",)
        return _that_drive(records, marked[:1], problems), notes
    found = next(_could_drive(records), None)
    if found is None:
        if records:
            problems.add("", "no joint can drive", "an R or P joint of two links can")
        return (), ()
    return (found,), (f"no joint is marked as driven; the first that can be is taken, {records[found].where}",)


def _could_drive(records: Iterable[JointRecord]) -> Iterator[int]:
    return (k for k, record in enumerate(records) if record.kind in ("R", "P") and len(record.links) == 2)


def _that_drive(records: Sequence[JointRecord], numbers: Sequence[int], problems: Problems) -> tuple[int, ...]:
    """Return the numbers of joints that can drive; note why the others cannot."""
    found = []
    for number in numbers:
        what = _hindrance(records[number])
        if what:
            problems.add(records[number].where, what, "mark an R or P joint of two links")
        else:
            found.append(number)
    return tuple(found)


def _hindrance(record: JointRecord) -> str:
    if record.kind == "G":
        return "a gear contact cannot drive"
    if len(record.links) == 1:
        return "a tracer cannot drive"
    if record.kind == "RP":
        return "an RP joint cannot drive (two freedoms)"
    return "a pin of more than two links cannot drive: it does not tell which two" if len(record.links) > 2 else ""
