"""What has quantities: the points, links, pairs and drivers of a motion, and what a name asks of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.kinematics.derived import FIGURES
from compoundkin.kinematics.derived.contract import HasQuantities, Lack
from compoundkin.model.attributes import (
    ALIASES,
    CATALOGUE,
    DERIVED,
    PARTS,
    Attribute,
    Dimension,
    Kind,
    coordinate_dimension,
    vector_and_part,
)


def known_owners(motion: HasQuantities) -> list[str]:
    """List what has quantities: points, links, pairs and drivers, each once."""
    return list(dict.fromkeys(name for kind in CATALOGUE for name in getattr(motion, kind)))


def owner_and_part(motion: HasQuantities, name: str) -> tuple[Owner, str, str]:
    """Return the owner that a name asks, its attribute, and the part.

    Raises UnknownName.
    """
    try:
        return (*_asked(motion, name), "")
    except UnknownName:
        vector, _, part = name.rpartition(".")
        if not vector_and_part(name)[1] and not _is_known(motion, vector):
            raise
    return (*_asked(motion, vector), part)


def check_part(name: str, part: str, is_vector: bool) -> None:
    """Raise UnknownName where what a name asks for has no such part."""
    vector = name.removesuffix(f".{part}")
    if not is_vector:
        raise UnknownName(Problem(name, f"{vector} is no vector", f"leave .{part} out"))
    if part not in PARTS:
        raise UnknownName(Problem(name, f"{vector} has no {part!r}", suggestion(part, list(PARTS))))


def _is_known(motion: HasQuantities, name: str) -> bool:
    """Tell whether a name is that of an owner with one of its attributes."""
    owner, _, word = name.rpartition(".")
    return any(owner in getattr(motion, k) and owner_of(motion, k, owner).has(word) for k in CATALOGUE)


def _asked(motion: HasQuantities, name: str) -> tuple[Owner, str]:
    """Return the owner and the attribute of a name that means no part."""
    owner, dot, word = name.rpartition(".") if "." in name else (name, "", "")
    found = [owner_of(motion, kind, owner) for kind in CATALOGUE if owner in getattr(motion, kind)]
    if not found:
        what = f"there is no point, link, pair or driver {owner!r}"
        raise UnknownName(Problem(name, what, suggestion(owner, known_owners(motion))))
    for one in found:
        if not dot or one.has(word):
            return one, word if dot else next(iter(one.attributes))
    for lack in filter(None, (one.lack(word) for one in found)):
        raise UnknownName(Problem(name, f"{owner!r} has no {word!r}: {lack.reason}", lack.remedy))
    words = list(dict.fromkeys(word for one in found for word in one.words))
    others = ", ".join(kind for kind in DERIVED if word in DERIVED[kind])
    what = f"{owner!r} has no {word!r}{f', which only {others} have' if others else ''}"
    raise UnknownName(Problem(name, what, _nearest(owner, word, words)))


class Owner(NamedTuple):
    """A point, link, pair or driver of a motion. Its name, the attributes it has, the unit of each order."""

    name: str
    kind: Kind
    whole: HasQuantities
    dimension: Dimension
    attributes: Mapping[str, Attribute]

    def has(self, word: str) -> bool:
        """Tell whether it has an attribute, or what is derived of such an owner."""
        return word in self.attributes or (word in DERIVED[self.kind] and self.lack(word) is None)

    def lack(self, word: str) -> Lack | None:
        """Return why it has not what is derived of others. None where there is no reason."""
        return FIGURES[self.kind][word].lack(self.whole, self.name) if word in DERIVED[self.kind] else None

    @property
    def words(self) -> list[str]:
        """All that it has."""
        return [word for word in (*self.attributes, *DERIVED[self.kind]) if self.has(word)]


def owner_of(motion: HasQuantities, kind: Kind, name: str) -> Owner:
    """Return a point, link, pair or driver as the owner of quantities."""
    if kind not in ("pairs", "drives"):
        return Owner(name, kind, motion, "length" if kind == "points" else "angle", CATALOGUE[kind])
    dimension = coordinate_dimension(getattr(motion, kind)[name].is_angle)
    return Owner(name, kind, motion, dimension, {**CATALOGUE[kind], **ALIASES[dimension]})


def _nearest(owner: str, word: str, known: list[str]) -> str:
    remedy = suggestion(word, known)
    return f"did you mean '{owner}.{remedy.split(chr(39))[1]}'?" if remedy.startswith("did") else remedy
