"""Which points are shown: those that carry something, and those of guides where they stand beside what is drawn."""

from __future__ import annotations

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.noted_numbers import as_place
from compoundkin.view.sketch.picture import Window
from compoundkin.view.sketch.scene import Scene

# A point that carries nothing is left out where it is nearer than this to another one, in picture units.
APART = 12.0
# It is beside a guide where it is no farther than this beyond the part that is used.
NEAR = 22.0


def shown_points(scene: Scene, window: Window) -> dict[str, complex]:
    """Return the places on the picture of all points that are shown."""
    shown = {letter: as_place(window.at(place)) for letter, place in scene.carried.items()}
    for letter, place in scene.letters.items():
        at = as_place(window.at(place))
        is_free = letter not in shown and all(abs(at - other) > APART for other in shown.values())
        if is_free and window.holds(at) and _is_beside(scene, window, letter, at):
            shown[letter] = at
    return shown


def _is_beside(scene: Scene, window: Window, letter: str, at: complex) -> bool:
    """Tell whether a point of the frame is beside what is drawn of each guide for which it stands."""
    for seen in scene.seen:
        mark = seen.mark
        if isinstance(mark, Sliding) and seen.members[0] == FRAME and letter in seen.pair.letters[1:]:
            low, high = (complex(window.at(mark.at + mark.along * s)) for s in (mark.low, mark.high))
            if abs(at - low) + abs(at - high) > abs(high - low) + 2.0 * NEAR:
                return False
    return True
