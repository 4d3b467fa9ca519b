"""How large blocks are drawn: in proportion to the links that carry them, within bounds."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.scene import Scene, Seen
from compoundkin.view.sketch.sketch_style import BLOCK, PIN

# A block is no longer than this part of the shortest link that carries one, but no smaller than this part of its size.
SHARE, SMALLEST = 0.6, 0.7
# A block within a block is so much smaller.
INNER = 0.7


def block_size(scene: Scene, scale: float, slides: Iterable[Seen]) -> tuple[float, float]:
    """Return the length and width of the blocks of some slides.

    They are in picture units, `scale` for a length unit.
    """
    links = {link for seen in slides for link in scene.mechanism.carriers[seen.pair.letters[0]]} - {FRAME}
    spans = [span for link in links if (span := _span(scene, link) * scale) > PIN]
    share = float(np.clip(SHARE * min(spans, default=np.inf) / BLOCK[0], SMALLEST, 1.0))
    return BLOCK[0] * share, BLOCK[1] * share


def share_of_block(scene: Scene, slide: Seen) -> float:
    """Return how large a block is of the usual size. One that swivels on a block of the frame is in it."""
    letter, guide = slide.pair.letters[0], slide.members[0]
    on_frame = [s for s in scene.seen if isinstance(s.mark, Sliding) and FRAME in s.members and s is not slide]
    return INNER if guide != FRAME and any(s.pair.letters[0] == letter for s in on_frame) else 1.0


def _span(scene: Scene, link: str) -> float:
    """The distance of the two points of a link that are farthest from each other."""
    own = [complex(p) for p in scene.points[link].values()]
    return max(abs(p - q) for p in own for q in own)
