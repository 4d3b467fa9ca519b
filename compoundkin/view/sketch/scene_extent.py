"""How far a scene goes: the places of points, wheels, grooves, profiles and guides that must be on its picture."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.pairs.symbols import Groove, Outline, Sliding, Strap, Track, Wheel
from compoundkin.view.sketch.geneva_shapes import around_genevas
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene
from compoundkin.view.sketch.slide_shapes import Painter


def extent(scene: Scene) -> Iterator[Number]:
    """Return places that must be on the picture, arrays of them."""
    yield np.array(list(scene.carried.values()))
    yield from around_genevas(scene)
    guides = Painter(scene, Window(1.0, 0j, 0.0, 0.0))
    for seen in scene.seen:
        mark = seen.mark
        if isinstance(mark, Wheel):
            rim = mark.radius * np.array([1, 1j, -1, -1j])
            yield scene.at(seen.members[mark.member], mark.at) + rim
        elif isinstance(mark, Groove | Strap | Outline):
            yield scene.here[seen.members[mark.member]].at(mark.line).c[0]
        elif isinstance(mark, Track):
            yield scene.here[seen.members[mark.member]].at(mark.at + mark.along * np.array([mark.low, mark.high])).c[0]
        elif isinstance(mark, Sliding):
            way = np.array([mark.low, mark.high])
            if guides.is_rod(seen):
                yield scene.here[seen.members[1]].at(mark.block - mark.turn * way).c[0]
            elif not guides.is_cylinder(seen):
                yield scene.here[seen.members[0]].at(mark.at + mark.along * way).c[0]
