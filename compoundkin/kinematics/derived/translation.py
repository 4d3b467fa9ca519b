"""Links that cannot turn: only slides join them to the frame."""

from __future__ import annotations

from compoundkin.model.elements import FRAME
from compoundkin.structure.kinematic_structure import Structure


def translating_links(structure: Structure) -> dict[str, str]:
    """Return the links that only translate, each with its slide. The frame has none.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.structure import decompose
    >>> translating_links(decompose(load_named("slider-crank")))
    {'frame': '', 'piston': 'stroke'}
    """
    found = {FRAME: ""}
    slides = [pair for pair in structure.pairs if pair.is_simple and not pair.free_is_angle]
    while reached := [pair for pair in slides if len(found.keys() & set(pair.members)) == 1]:
        for pair in reached:
            found.update({name: pair.name for name in pair.members if name not in found})
    return found
