"""What of a mechanism a construction does not show, in sentences."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.base.display import count_phrase
from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.shown_mechanism import ShownMechanism


def notes_of(shown: ShownMechanism, build: Construction) -> tuple[str, ...]:
    """Return what does not come across."""
    return tuple(_notes(shown, build))


def _notes(shown: ShownMechanism, build: Construction) -> Iterator[str]:
    mechanism = shown.mechanism
    loads = len(mechanism.loads) + len(mechanism.frictions) + len(mechanism.pretensions)
    kinds = ((len(mechanism.masses), "mass", "masses"), (loads, "load", ""), (len(mechanism.outlines), "outline", ""))
    if left := ", ".join(count_phrase(count, one, many) for count, one, many in kinds if count):
        yield f"left out: {left}"
    for lead in mechanism.prescribed_motions.values():
        yield f"what leads {lead.name} is not in the construction: its coordinates have sliders of their own"
    changing = [step.name for step in build.steps if step.look == "helper" and step.caption and "mode" in step.caption]
    for name in changing:
        yield f"{name} changes where the links are in line, as the motion does: with other lengths set it to 1 or -1"
    for name in build.beyond:
        yield f"{name} begins at the end of its range: the pose that is asked for, or drawn, lies beyond"
    for name, slider in build.driven.items():
        if not build.is_slider(slider):
            yield f"{name} has a single value: it is a number to be changed"
