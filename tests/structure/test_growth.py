"""That building and taking apart are linear in the links, counted in executed instructions instead of seconds."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from compoundkin.model.elements import drive, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from compoundkin.structure import decompose


def slider_cranks(count: int) -> list[Any]:
    """Cranks, rods and sliding blocks side by side; the composite of the frame and the cranks grows with them."""
    frame: dict[str, complex] = {}
    items: list[Any] = []
    for k in range(count):
        frame |= {f"A{k}": 10j * k, f"S{k}": 10j * k + 1, f"T{k}": 10j * k + 5}
        items += [link(f"crank{k}", **{f"A{k}": 0, f"B{k}": 1}), link(f"rod{k}", **{f"B{k}": 0, f"C{k}": 3})]
        items += [link(f"block{k}", **{f"C{k}": 0}), drive(f"crank{k}")]
        items.append(slide(f"block{k}", on="frame", at=f"C{k}", through=f"S{k}", toward=f"T{k}"))
    return [link("frame", **frame), *items]


def instructions(count: int) -> int:
    """How many instructions of Python it takes to build and decompose so many slider-cranks."""
    items, executed = slider_cranks(count), 0

    def trace(frame: Any, event: str, _: Any) -> Any:
        nonlocal executed
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        executed += event == "opcode"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        structure = decompose(Mechanism("m", *items))
    finally:
        sys.settrace(before)
    assert (len(structure.groups), structure.faults) == (count, ())
    return executed


@pytest.mark.skipif(sys.gettrace() is not None, reason="a debugger or coverage is tracing")
def test_four_times_the_links_take_about_four_times_the_instructions():
    instructions(1)  # imports and caches
    # between 4 for linear work and 16 for quadratic
    assert instructions(120) < 4.4 * instructions(30)
