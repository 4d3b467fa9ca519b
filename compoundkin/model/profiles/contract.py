"""What every profile answers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

from compoundkin.base.copies import CopiesFields
from compoundkin.base.curves import Curve
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.model.fields import Key

# A closed profile with less area than this part of its size squared is a line but for rounding.
NO_AREA = 1e-9


class Profile(CopiesFields, ABC):
    """A profile. Kinds are frozen dataclasses with the keys that a file holds for them."""

    kind: ClassVar[str]  # what it is called in a file
    keys: ClassVar[tuple[Key, ...]]  # none: it cannot be written to a file

    @property
    def oscillates(self) -> bool:
        """Whether what is said of its follower are angles."""
        return False

    @cached_property
    def curve(self) -> Curve:
        """The curve, in the coordinates of its link. Raises InvalidMechanism for what is no curve."""
        return self._made()

    @abstractmethod
    def _made(self) -> Curve: ...

    @property
    def circle(self) -> tuple[complex, float] | None:
        """Middle and radius of a profile that is a circle all round."""
        return None

    def problems(self, where: str) -> Iterator[Problem]:
        """Find what makes it no profile: points too few, a curve that crosses itself."""
        try:
            found = self.curve.crosses_itself()
        except InvalidMechanism as error:
            yield from (replace(p, where=".".join(filter(None, (where, p.where)))) for p in error.problems)
            return
        if found:
            place = found[0].point
            what = f"the profile crosses itself at ({place.real:.6g}, {place.imag:.6g})"
            yield Problem(where, what, self._without_loop())
        elif self.curve.closed and abs(self.curve.samples.area) <= NO_AREA * self.curve.size**2:
            yield Problem(where, "the profile encloses no area: it runs back over itself", "say it is open")

    def _without_loop(self) -> str:
        """Return how to get rid of a loop."""
        return "change the points that make the loop"


def side_of(curve: Curve) -> float:
    """Return +1 where the normal of a closed curve points outward, -1 where inward. An open curve has +1."""
    return 1.0 if not curve.closed or curve.is_counterclockwise else -1.0
