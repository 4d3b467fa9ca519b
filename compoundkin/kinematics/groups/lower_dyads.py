"""The dyad that stands for one body on a higher pair: lower pairs, and a link between them."""

from __future__ import annotations

from collections.abc import Mapping

from compoundkin.model.pairs.contract import Ends, lower_equivalent
from compoundkin.structure.assur_groups import named_group
from compoundkin.structure.parts import Body, Group


def lower_dyad(group: Group, ends: Mapping[str, Ends]) -> tuple[Group, Mapping[str, Ends]]:
    """Return the dyad of a body and a link, and the ends of pairs.

    The link stands, with two lower pairs, for the body's higher pair. It is the group itself where that is no single
    body, or nothing stands for its pair.
    """
    if len(group.bodies) != 1 or len(group.outer) != 2:
        return group, {}
    lower, higher = sorted(group.outer, key=lambda pair: -pair.held)
    found = lower_equivalent(higher, ends[higher.name])
    if found is None:
        return group, {}
    own = next(j for j, name in enumerate(higher.members) if name in group.links)
    inner, outer = found.pairs[own], found.pairs[1 - own]
    return named_group([*group.bodies, Body((found.link,))], [inner], [lower, outer]), found.ends
