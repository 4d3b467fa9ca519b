"""Numbers that pairs read off the drawing where they are not stated: offsets and turns of guides, phases of wheels."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Pair


class DrawnNumbers(Pair):
    """A pair that may read some of its numbers off the drawing."""

    @abstractmethod
    def read_off(self, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
        """Return the fields that are drawn and not stated, by the pair's sides."""


class DrawnGuide(DrawnNumbers):
    """A guide whose offset and whose block's turn may be drawn."""

    link: str
    on: str
    through: str

    def read_off(self, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
        """Return the drawn offset and turn, as far as they are not stated."""
        if not ({self.on, self.link} <= geometry.as_drawn and self.on in geometry.drawn):
            return {}
        guide, block = ends
        away = np.conjugate(guide.along.c[0]) * (guide.point - geometry.points[self.on][self.through])
        found = {"offset": away.imag, "turn": 0.0 - np.angle(block.along.c[0])}
        return {name: value for name, value in found.items() if getattr(self, name) is None}


class DrawnPhase(DrawnNumbers):
    """A pair of wheels whose phase may be drawn. It is on their carrier, else on the first member."""

    def read_off(self, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
        """Return the drawn phase, unless it is stated."""
        is_drawn = all(name in geometry.drawn for name in self.members)
        return {"phase": ends[2 % len(ends)].measure} if getattr(self, "phase", 0.0) is None and is_drawn else {}


def read_off(pair: Pair, ends: Ends, geometry: Geometry) -> Mapping[str, Number]:
    """Return what a pair reads off the drawing, by its fields."""
    return pair.read_off(ends, geometry) if isinstance(pair, DrawnNumbers) else {}
