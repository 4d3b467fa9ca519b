"""Inputs of pyslvs: pairs of joints, the base and one that is driven about it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from compoundkin.base.display import short_repr
from compoundkin.files.exchange.pmks.joint_record import MOST_JOINTS, JointDriver, JointRecord
from compoundkin.files.exchange.pmks.joint_sketch import held
from compoundkin.files.exchange.pmks.joint_text import is_short
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.geometry import FRAME

_INTEGER = re.compile(r"(?<![\w.])-?\d{1,9}(?![\w.])")
_BETWEEN = re.compile(r"[-\[\](),\s]*")


def input_pairs(text: str, problems: Problems) -> list[tuple[int, int]]:
    """Return the pairs of numbers in a list as Python or YAML writes it.

    >>> input_pairs("- - 0\\n  - 1\\n- [2, 2]", Problems())
    [(0, 1), (2, 2)]
    """
    if not is_short(text, problems):
        return []
    numbers = [int(found[0]) for found in _INTEGER.finditer(text)]
    if not _BETWEEN.fullmatch(_INTEGER.sub("", text)) or len(numbers) % 2:
        problems.add("input", f"{short_repr(text.strip()[:60])} are no pairs of joints", "such as [(0, 1)]")
        return []
    if len(numbers) > 2 * MOST_JOINTS:
        problems.add("input", f"there are more than {MOST_JOINTS} inputs", "is it the right file?")
        return []
    return list(dict.fromkeys(zip(numbers[::2], numbers[1::2], strict=True)))


def drivers_of(
    pairs: Sequence[tuple[int, int]], joints: Sequence[JointRecord | None], problems: Problems
) -> Iterator[JointDriver]:
    """Yield the drivers that pairs of joints mean; note what is wrong with them."""
    for pair in pairs:
        told = f"input {pair}"
        if not all(number in range(len(joints)) for number in pair):
            problems.add(told, "there is no such joint", f"joints are 0 to {len(joints) - 1}")
            continue
        base, driver = (joints[number] for number in pair)
        if base is None or driver is None:
            problems.add(told, "no link holds this point")
        elif pair[0] == pair[1]:
            if base.is_guide:
                yield JointDriver(pair[0])
            else:
                problems.add(told, "an R joint is driven by another joint of its link", "name the base and that joint")
        elif base.kind != "R" or FRAME not in base.links:
            problems.add(told, "the base is no R joint of the ground", "drive a link about a joint of the ground")
        else:
            links = sorted((held(base) & held(driver)) - {FRAME})
            if len(links) != 1:
                problems.add(told, "no link holds both joints" if not links else "several links hold both joints")
            else:
                yield JointDriver(pair[0], pair[1], link=links[0])


def first_driver(joints: Sequence[JointRecord | None], problems: Problems) -> tuple[JointDriver, ...]:
    """Return the driver without inputs: the first link pinned to the ground."""
    for k, record in enumerate(joints):
        if record is not None and record.kind == "R" and FRAME in record.links and len(record.links) > 1:
            return (JointDriver(k, link=next(name for name in record.links if name != FRAME)),)
    problems.add("", "no joint can drive", "give inputs, or pin a link to the ground")
    return ()
