"""An Assur group of a mechanism, at a block of poses, as an assembly of plain numbers."""

from __future__ import annotations

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Number, Series
from compoundkin.kinematics.assembly.group_geometry import Assembly, Connection
from compoundkin.kinematics.block import Block
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import Group


def from_group(group: Group, block: Block, size: float) -> Assembly:
    """The group as it is attached in a block, at all its poses; body k is the group's body k.

    A composite body is taken in the frame of its base link, `links[0]`, with its shape at each pose. Raises
    `InvalidInput` where the group holds higher pairs, whose configurations are not finitely many rotations.
    """
    where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    connections = tuple(_connection(pair, where, block) for pair in (*group.inner, *group.outer))
    return Assembly(len(group.bodies), connections, size)


def _connection(pair: Pair, where: dict[str, int], block: Block) -> Connection:
    if pair.held != 2 or len(pair.members) != 2:
        what = f"all configurations are known for groups of lower pairs only, not with a {pair.title}"
        raise InvalidInput(Problem(pair.name, what))
    first, second = (
        _in_body(link, end, where, block) for link, end in zip(pair.members, block.ends[pair.name], strict=True)
    )
    bodies = where.get(pair.members[0]), where.get(pair.members[1])
    points = _leading(first.point), _leading(second.point)
    directions = None if pair.free_is_angle else (_leading(first.direction), _leading(second.direction))
    return Connection(bodies, points, directions)


def _in_body(link: str, end: End, where: dict[str, int], block: Block) -> End:
    """A link's side of a pair in its composite body, or in the world where it is known."""
    frame = block.local.get(link) if link in where else block.world[link]
    return end if frame is None else frame.carry(end)


def _leading(value: Series | Number) -> Number:
    return value.c[0] if isinstance(value, Series) else value
