"""What is asked of a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any


@dataclass(frozen=True, eq=False)
class Wishes:
    """What is asked of a picture besides its kind, as `draw` explains it."""

    at: Any = None
    pose: int | None = None
    design: int = 0
    ghosts: int = 0
    paths: str | Sequence[str] | bool = ()
    centres: bool = False
    vectors: str | Sequence[str] = ()
    labels: bool | str | Sequence[str] = True
    size: float | None = None

    def others(self, known: Sequence[str]) -> tuple[str, ...]:
        """Return the names of those that are given and not among some.

        >>> Wishes(at=0.5, ghosts=3).others(("at", "pose"))
        ('ghosts',)
        """
        return tuple(one.name for one in fields(self) if one.name not in known and self._is_given(one.name))

    def _is_given(self, name: str) -> bool:
        value, usual = getattr(self, name), getattr(Wishes, name)
        # without a comparison of arrays, which gives an array
        return type(value) is not type(usual) or bool(usual is not None and value != usual)
