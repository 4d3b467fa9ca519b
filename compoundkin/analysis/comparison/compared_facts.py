"""What is said of the structures of two mechanisms."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from compoundkin.analysis.comparison.comparison_findings import ComparedFact
from compoundkin.structure import Structure, roman


def compared_facts(one: Structure, other: Structure) -> tuple[ComparedFact, ...]:
    """Return what there is to say of both structures, in words.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.structure import decompose
    >>> compared_facts(*[decompose(load_named(name)) for name in ("crank-rocker", "six-bar")])[1]
    ComparedFact(what='pairs', one='4 R', other='6 R + 1 P')
    """
    return tuple(ComparedFact(what, tell(one), tell(other)) for what, tell in _FACTS.items())


def _pairs(structure: Structure) -> str:
    return " + ".join(f"{count.number} {count.code}" for count in structure.mobility.pairs)


def _groups(structure: Structure) -> str:
    return ", ".join(group.name for group in structure.groups) or "none"


def _class(structure: Structure) -> str:
    return roman(max((group.class_ for group in structure.groups), default=1))


def _drivers(structure: Structure) -> str:
    return ", ".join(structure.driven) or "none"


_FACTS: Mapping[str, Callable[[Structure], str]] = {
    "links": lambda structure: str(len(structure.mechanism.links)),
    "pairs": _pairs,
    "mobility": lambda structure: str(structure.mobility.freedoms),
    "independent loops": lambda structure: str(len(structure.loops)),
    "drivers": _drivers,
    "Assur groups": _groups,
    "class": _class,
    "unit of length": lambda structure: structure.mechanism.unit or "none",
}
