"""The components of points and vectors, by name."""

from __future__ import annotations

from compoundkin.model.attributes import PARTS

# The parts of a vector that make it up; its length does not.
AXES = tuple(PARTS)[:2]


def component_names(name: str) -> tuple[str, ...]:
    """Return the names of both components of a point or vector.

    >>> component_names("G.position")
    ('G.position.x', 'G.position.y')
    """
    return tuple(f"{name}.{axis}" for axis in AXES)
